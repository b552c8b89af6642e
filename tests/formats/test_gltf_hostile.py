"""Files damaged at random: whatever happens, the reader answers with a file or with one line."""

from __future__ import annotations

import re
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from game.core import BadInput
from game.formats import animation_clip, build_vrm, read_gltf, skeleton_of

NUMBERS = ["-1", "0", "1", "2", "3", "7", "255", "0.5", "5121", "5126", "65536"]
NUMBERS += ["2147483648", "4294967295", "1e38", "1e308", "-1e9", "1e-320"]
OTHERS = ["null", "[]", "{}", "true", '""', '"VEC3"', '"MAT4"', "[0]", "[0,1,2,3]", "[{}]", '"..\\u0000"', '"hips"']


@settings(max_examples=250, deadline=None)
@given(st.data())
def test_damaged_files_load_or_are_refused(
    tmp_path_factory: pytest.TempPathFactory, vrm_bytes: bytes, data: st.DataObject
):
    raw = bytearray(vrm_bytes)
    json_bytes = vrm_bytes[20 : 20 + struct.unpack_from("<I", vrm_bytes, 12)[0]]
    kind = data.draw(st.sampled_from(["flip", "cut", "number", "number", "word", "word"]))
    if kind == "flip":
        for _ in range(data.draw(st.integers(1, 4))):
            raw[data.draw(st.integers(0, len(raw) - 1))] = data.draw(st.integers(0, 255))
    elif kind == "cut":
        del raw[data.draw(st.integers(0, len(raw) - 1)) :]
    else:
        # Damage that keeps the container whole reaches deeper: one word of the JSON is replaced by another.
        pattern = rb"-?[0-9]+(?:\.[0-9]+)?" if kind == "number" else rb'"[^"]*"|[0-9.]+|\[[^][]*\]|\{[^{}]*\}'
        words = list(re.finditer(pattern, json_bytes))
        word = words[data.draw(st.integers(0, len(words) - 1))]
        new = data.draw(st.sampled_from(NUMBERS if kind == "number" else NUMBERS + OTHERS)).encode()
        text = json_bytes[: word.start()] + new + json_bytes[word.end() :]
        text += b" " * (-len(text) % 4)
        rest = vrm_bytes[20 + len(json_bytes) :]
        raw = bytearray(
            b"glTF" + struct.pack("<IIII", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest
        )
    path = tmp_path_factory.getbasetemp() / "damaged.vrm"
    path.write_bytes(raw)
    message = ""
    try:
        file = read_gltf(path, max_bytes=4_000_000)
        rig = skeleton_of(file)
        assert np.isfinite(rig.skeleton.rest_model).all()
        if file.animations:
            assert np.isfinite(animation_clip(file, 0, 30.0, rig).to_model()[0]).all()
        if file.extensions:
            build_vrm(file)
    except BadInput as error:
        message = str(error)
    assert "\n" not in message
    assert len(message) < 700
