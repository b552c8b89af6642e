"""glTF files that nobody here made: real models, and the Khronos validator's own cases as an oracle."""

from __future__ import annotations

import json
import time
from pathlib import Path

import numpy as np
import pytest

from game.core import BadInput
from game.formats import animation_clip, read_gltf, skeleton_of


def test_real_models_load(shared_data: Path):
    paths = sorted((shared_data / "gltf_skin_morph").glob("**/*.gl*"))
    assert paths
    for path in paths:
        file = read_gltf(path)
        assert file.findings == []
        rig = skeleton_of(file)
        np.testing.assert_allclose(
            rig.skeleton.rest_model[:, :3, 3],
            file.node_model[rig.nodes, :3, 3],
            atol=1e-9 * max(1, np.abs(file.node_model).max()),
        )
        if file.animations:
            assert np.isfinite(animation_clip(file).to_model()[0]).all()


# What the validator calls an error and this reader does not refuse: faults that cannot hurt it (bounds that
# disagree with the data, empty lists, faults in things it does not read such as cameras, images and extensions).
HARMLESS = {
    "ACCESSOR_ELEMENT_OUT_OF_MAX_BOUND",
    "ACCESSOR_ELEMENT_OUT_OF_MIN_BOUND",
    "ACCESSOR_INDEX_PRIMITIVE_RESTART",
    "ACCESSOR_INVALID_SIGN",
    "ACCESSOR_MAX_MISMATCH",
    "ACCESSOR_MIN_MISMATCH",
    "ACCESSOR_NON_CLAMPED",
    "ACCESSOR_VECTOR3_NON_UNIT",
    "ANIMATION_SAMPLER_INPUT_ACCESSOR_WITHOUT_BOUNDS",
    "BUFFER_VIEW_INVALID_BYTE_STRIDE",
    "CAMERA_XMAG_YMAG_ZERO",
    "CAMERA_ZFAR_LEQUAL_ZNEAR",
    "EMPTY_ENTITY",
    "IMAGE_BUFFER_VIEW_WITH_BYTESTRIDE",
    "IMAGE_DATA_INVALID",
    "INVALID_JSON",  # a byte order mark
    "MESH_PRIMITIVE_INDEXED_SEMANTIC_CONTINUITY",
    "MESH_PRIMITIVE_INVALID_ATTRIBUTE",
    "MESH_PRIMITIVE_MORPH_TARGET_NO_BASE_ACCESSOR",
    "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS",
    "NODE_SKIN_NO_SCENE",
    "UNDECLARED_EXTENSION",
    "UNSATISFIED_DEPENDENCY",
}


def test_the_validators_cases(shared_data: Path):
    """Base cases: errors that matter are refused, the rest loads; extensions are only held to "no crash"."""
    reports = sorted((shared_data / "gltf_malformed" / "validator").glob("**/*.report.json"))
    assert reports
    agree = noticed = total = 0
    for report in reports:
        model = report.with_name(report.name.removesuffix(".report.json"))
        issues = json.loads(report.read_text("utf-8"))["issues"]
        codes = {message["code"] for message in issues["messages"] if message["severity"] == 0}
        start = time.perf_counter()
        try:
            file = read_gltf(model)
            refused, findings = None, file.findings
            if file.nodes:
                skeleton_of(file)
        except BadInput as error:
            refused, findings = str(error), []
            assert "\n" not in refused
        assert time.perf_counter() - start < 5.0, model
        if "base" not in model.parts:
            continue
        total += 1
        agree += (refused is not None) == bool(codes)
        noticed += bool(refused or findings) or not codes
        if codes - HARMLESS:
            assert refused is not None, f"{model} was accepted in spite of {codes}"
        elif not codes and refused is not None:
            # Only data that is not there may be missed in a file without errors.
            assert "http://" in refused or "without data" in refused, f"{model}: {refused}"
    assert agree / total > 0.7
    # Of what is not refused most is at least noted.
    assert noticed / total > 0.9


def test_other_broken_models_are_refused_in_one_line(shared_data: Path):
    paths = sorted((shared_data / "gltf_malformed" / "assimp").glob("**/*.gltf"))
    assert paths
    for path in paths:
        if path.stem == "SceneWithoutNodes":
            assert read_gltf(path).nodes == ()
            continue
        with pytest.raises(BadInput) as caught:
            read_gltf(path)
        assert "\n" not in str(caught.value)
