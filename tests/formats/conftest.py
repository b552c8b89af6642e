"""A small but complete character, built byte by byte, that the glTF tests read and damage."""

from __future__ import annotations

import copy
import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest


class SmallModel:
    """A glTF document with its binary chunk; `write` stores it as GLB."""

    def __init__(self) -> None:
        self.binary = b""
        self.document: dict[str, Any] = {
            "asset": {"version": "2.0"},
            "bufferViews": [],
            "accessors": [],
            "scene": 0,
            "scenes": [{"nodes": [0, 3]}],
            "nodes": [
                {"name": "hips", "translation": [0, 1, 0], "children": [1]},
                {"name": "spine", "translation": [0, 0.25, 0], "rotation": [0, 0, 0, 1], "children": [2]},
                {"name": "tip", "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.5, 0, 1]},
                {"name": "body", "mesh": 0, "skin": 0, "extras": {"lod": 8000}},
            ],
        }
        positions = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
        attributes = {
            "POSITION": self.accessor(positions, "VEC3", min=[0, 0, 0], max=[1, 1, 1]),
            "NORMAL": self.accessor(np.tile(np.float32([0, 0, 1]), (4, 1)), "VEC3"),
            "JOINTS_0": self.accessor(np.array([[0, 1, 0, 0]] * 4, np.uint8), "VEC4"),
            "WEIGHTS_0": self.accessor(np.array([[255, 0, 0, 0]] * 4, np.uint8), "VEC4", normalized=True),
            "_OUTLINE": self.accessor(np.linspace(0.4, 1.1, 4).astype(np.float32), "SCALAR"),
        }
        indices = self.accessor(np.array([0, 1, 2, 0, 2, 3], np.uint16), "SCALAR")
        target = self.accessor(np.full((4, 3), 0.1, np.float32), "VEC3")
        bind = np.tile(np.eye(4, dtype=np.float32), (2, 1, 1))
        bind[:, 3, 1] = (-1, -1.25)
        self.document["skins"] = [{"joints": [0, 1], "inverseBindMatrices": self.accessor(bind, "MAT4")}]
        primitive = {"attributes": attributes, "indices": indices, "material": 0, "targets": [{"POSITION": target}]}
        self.document["meshes"] = [{"primitives": [primitive], "extras": {"targetNames": ["smile"]}}]
        self.document["materials"] = [
            {
                "name": "skin",
                "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.25, 1]},
                "extras": {"class": "skin"},
            }
        ]
        times = self.accessor(np.array([0, 0.5, 1], np.float32), "SCALAR", min=[0], max=[1])
        turn = np.array([[0, 0, 0, 1], [0, 0, 0.5**0.5, 0.5**0.5], [0, 0, 1, 0]], np.float32)
        self.document["animations"] = [
            {
                "name": "turn",
                "samplers": [{"input": times, "output": self.accessor(turn, "VEC4")}],
                "channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}],
            }
        ]

    def accessor(self, data: np.ndarray, kind: str, **more: Any) -> int:
        """Append data and its view; the new accessor's index."""
        self.binary += b"\0" * (-len(self.binary) % 4)
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": data.nbytes}
        self.document["bufferViews"].append(view)
        self.binary += data.tobytes()
        code = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}[data.dtype.str[1:]]
        self.document["accessors"].append(
            {
                "bufferView": len(self.document["bufferViews"]) - 1,
                "componentType": code,
                "count": len(data),
                "type": kind,
                **more,
            }
        )
        return len(self.document["accessors"]) - 1

    def copy(self) -> SmallModel:
        """A model of its own, to be damaged."""
        return copy.deepcopy(self)

    def to_glb(self) -> bytes:
        """The file's bytes."""
        self.document.setdefault("buffers", [{"byteLength": len(self.binary)}])
        text = json.dumps(self.document).encode()
        text += b" " * (-len(text) % 4)
        binary = self.binary + b"\0" * (-len(self.binary) % 4)
        length = 12 + 8 + len(text) + 8 + len(binary)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
        return b"glTF" + struct.pack("<II", 2, length) + chunks


_BONES = (
    *("hips", "spine", "head"),
    *(
        f"{side}{bone}"
        for side in ("left", "right")
        for bone in ("UpperLeg", "LowerLeg", "Foot", "UpperArm", "LowerArm", "Hand")
    ),
)


def _make_vrm(model: SmallModel) -> SmallModel:
    nodes = model.document["nodes"]
    first = len(nodes)
    nodes.extend({"name": bone, "translation": [0, 0.1, 0]} for bone in _BONES)
    nodes[first]["children"] = [first + at for at in range(1, len(_BONES))]
    model.document["extensionsUsed"] = ["VRMC_vrm", "VRMC_springBone"]
    model.document["extensions"] = {
        "VRMC_vrm": {
            "specVersion": "1.0",
            "meta": {
                "name": "Small",
                "authors": ["nobody"],
                "licenseUrl": "https://example.org/",
                "modification": "prohibited",
            },
            "humanoid": {"humanBones": {bone: {"node": first + at} for at, bone in enumerate(_BONES)}},
            "expressions": {
                "preset": {
                    "happy": {"morphTargetBinds": [{"node": 3, "index": 0, "weight": 1.0}], "overrideBlink": "block"}
                },
                "custom": {"grin": {"isBinary": True}},
            },
            "lookAt": {"type": "bone", "rangeMapVerticalUp": {"inputMaxValue": 90, "outputScale": 8}},
            "firstPerson": {"meshAnnotations": [{"node": 3, "type": "both"}]},
        },
        "VRMC_springBone": {
            "specVersion": "1.0",
            "colliders": [{"node": 0, "shape": {"sphere": {"offset": [0, 0.1, 0], "radius": 0.2}}}],
            "colliderGroups": [{"colliders": [0]}],
            "springs": [
                {
                    "name": "hair",
                    "joints": [{"node": 0, "stiffness": 2.0, "hitRadius": 0.02}, {"node": 1}, {"node": 2}],
                    "colliderGroups": [0],
                }
            ],
        },
    }
    return model


@pytest.fixture
def model() -> SmallModel:
    """A skinned, animated mesh with a morph target and a custom attribute."""
    return SmallModel()


@pytest.fixture
def vrm_model() -> SmallModel:
    """The same as a VRM 1.0 character."""
    return _make_vrm(SmallModel())


@pytest.fixture(scope="session")
def vrm_bytes() -> bytes:
    """That character as a file."""
    return _make_vrm(SmallModel()).to_glb()


@pytest.fixture
def store(tmp_path: Path) -> Callable[..., Path]:
    """Write a model (or bytes) into a folder of the test's own; the path."""

    def write(content: SmallModel | bytes | str, name: str = "small.glb") -> Path:
        path = tmp_path / name
        if isinstance(content, SmallModel):
            content = content.to_glb()
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return write
