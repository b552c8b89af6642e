"""Meshes of a glTF document whose shape has been checked: attribute formats, counts, indices, morph targets."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.formats.gltf_buffers import Buffers
from game.formats.gltf_model import Array, GltfMesh, GltfPrimitive
from game.formats.gltf_shape import COMPONENTS
from game.formats.json_shape import Report

__all__ = ["build_meshes"]

Pointer = tuple[str | int, ...]

_SEMANTIC = re.compile(r"(POSITION|NORMAL|TANGENT)|(TEXCOORD|COLOR|JOINTS|WEIGHTS)_(0|[1-9][0-9]?)")
_TYPES = {
    "POSITION": ("VEC3",),
    "NORMAL": ("VEC3",),
    "TANGENT": ("VEC4",),
    "TEXCOORD": ("VEC2",),
    "COLOR": ("VEC3", "VEC4"),
    "JOINTS": ("VEC4",),
    "WEIGHTS": ("VEC4",),
}
_QUANTISED = {"POSITION": "biBI", "NORMAL": "bi", "TANGENT": "bi", "TEXCOORD": "biBI"}
_KEPT_TARGETS = ("POSITION", "NORMAL", "TANGENT")


def build_meshes(document: Mapping[str, Any], buffers: Buffers, report: Report) -> tuple[GltfMesh, ...]:
    """All meshes, decoded. Raises BadInput where a primitive cannot be drawn as declared."""
    builder = _MeshBuilder(document, buffers, report)
    return tuple(builder.mesh(index, source) for index, source in enumerate(document.get("meshes", [])))


class _MeshBuilder:
    def __init__(self, document: Mapping[str, Any], buffers: Buffers, report: Report) -> None:
        self.accessors = document.get("accessors", [])
        self.views = document.get("bufferViews", [])
        self.quantised = "KHR_mesh_quantization" in document.get("extensionsUsed", [])
        self.nodes = document.get("nodes", [])
        self.buffers = buffers
        self.report = report
        # One accessor may serve many primitives: converted once, so that memory follows the file's size.
        self.converted: dict[tuple[int, str], Array] = {}

    def mesh(self, index: int, source: Mapping[str, Any]) -> GltfMesh:
        pointer: Pointer = ("meshes", index)
        primitives = tuple(
            self.primitive(item, (*pointer, "primitives", at)) for at, item in enumerate(source["primitives"])
        )
        targets = {len(primitive.targets) for primitive in primitives}
        if len(targets) > 1:
            self.report.refuse((*pointer, "primitives"), "primitives with different numbers of morph targets")
        count = max(targets, default=0)
        weights = tuple(map(float, source.get("weights", [0.0] * count)))
        if len(weights) != count:
            self.report.refuse((*pointer, "weights"), expected=f"{count} weights", seen=len(weights))
        for at, node in enumerate(self.nodes):
            if node.get("mesh") == index and len(node.get("weights", weights)) != count:
                self.report.refuse(("nodes", at, "weights"), expected=f"{count} weights", seen=len(node["weights"]))
        extras = source.get("extras")
        names = extras.get("targetNames", []) if isinstance(extras, dict) else []
        if not (isinstance(names, list) and all(isinstance(name, str) for name in names)):
            names = []
        return GltfMesh(source.get("name", ""), primitives, weights, tuple(names), extras)

    def primitive(self, source: Mapping[str, Any], pointer: Pointer) -> GltfPrimitive:
        attributes: dict[str, Array] = {}
        count = -1
        for name, index in source["attributes"].items():
            at: Pointer = (*pointer, "attributes", name)
            self.check_format(name, index, at)
            length = self.accessors[index]["count"]
            if count not in (-1, length):
                self.report.refuse(at, expected=f"{count} vertices like the other attributes", seen=length)
            count = length
            attributes[name] = self.attribute(name, index)
        self.check_names(set(attributes), (*pointer, "attributes"))
        extensions = source.get("extensions")
        if extensions and any("compression" in name for name in extensions):
            self.report.note(pointer, "compressed data ignored")
        indices = None
        if "indices" in source:
            indices = self.indices(source["indices"], max(count, 0), (*pointer, "indices"))
        targets = tuple(
            self.target(target, count, source["attributes"], (*pointer, "targets", at))
            for at, target in enumerate(source.get("targets", []))
        )
        mode = source.get("mode", 4)
        return GltfPrimitive(attributes, indices, mode, source.get("material"), targets, source.get("extras"))

    def check_format(self, name: str, index: int, pointer: Pointer) -> None:
        match = _SEMANTIC.fullmatch(name)
        if match is None:
            if not name.startswith("_"):
                self.report.note(pointer, "an attribute name that is neither known nor starts with '_'")
            return
        semantic = match.group(1) or match.group(2)
        accessor = self.accessors[index]
        code = np.dtype(COMPONENTS[accessor["componentType"]])
        letter = {"i1": "b", "i2": "i", "u1": "B", "u2": "I"}.get(code.str[1:], code.kind)
        normalised = accessor.get("normalized", False)
        if semantic == "JOINTS":
            fits = letter in "BI" and not normalised
        else:
            fits = letter == "f" or (letter in "BI" and normalised and semantic in ("TEXCOORD", "COLOR", "WEIGHTS"))
            fits |= self.quantised and letter in _QUANTISED.get(semantic, "")
        if semantic == "POSITION" and not {"min", "max"} <= accessor.keys():
            self.report.note(pointer, "positions without min and max")
        if not fits or accessor["type"] not in _TYPES[semantic]:
            seen = f"{accessor['type']} of {code.name}{' normalised' if normalised else ''}"
            self.report.refuse(pointer, expected=f"a format allowed for {semantic}", seen=seen)

    def check_names(self, names: set[str], pointer: Pointer) -> None:
        joints = {name[7:] for name in names if name.startswith("JOINTS_")}
        weights = {name[8:] for name in names if name.startswith("WEIGHTS_")}
        if joints != weights:
            self.report.refuse(pointer, "JOINTS and WEIGHTS that do not come in pairs")
        for semantic in ("TEXCOORD", "COLOR", "JOINTS", "WEIGHTS"):
            found = {name for name in names if name.startswith(f"{semantic}_")}
            if found != {f"{semantic}_{number}" for number in range(len(found))}:
                self.report.note(pointer, f"{semantic} numbers with gaps")

    def attribute(self, name: str, index: int) -> Array:
        semantic = name.partition("_")[0]
        key = (index, semantic if semantic in _TYPES else "")
        if key not in self.converted:
            data = self.buffers.accessor(index)
            if semantic == "JOINTS":
                data = data.astype(np.uint16)
            elif semantic in _TYPES:
                data = data.astype(np.float32)
            data.setflags(write=False)
            self.converted[key] = data
        return self.converted[key]

    def indices(self, index: int, count: int, pointer: Pointer) -> NDArray[np.uint32]:
        accessor = self.accessors[index]
        if accessor["type"] != "SCALAR" or accessor["componentType"] not in (5121, 5123, 5125):
            self.report.refuse(pointer, expected="SCALAR of unsigned integers", seen=accessor["type"])
        strided = "bufferView" in accessor and "byteStride" in self.views[accessor["bufferView"]]
        if accessor.get("normalized") or strided:
            self.report.refuse(pointer, "indices may be neither normalised nor strided")
        key = (index, "indices")
        if key not in self.converted:
            self.converted[key] = self.buffers.accessor(index).astype(np.uint32)
            self.converted[key].setflags(write=False)
        data = self.converted[key]
        if data.max() == np.iinfo(COMPONENTS[accessor["componentType"]]).max:
            self.report.note(pointer, "an index that means primitive restart")
        if data.max() >= count:
            self.report.refuse(pointer, expected=f"indices below {count}", seen=int(data.max()))
        return data

    def target(
        self, source: Mapping[str, int], count: int, base: Mapping[str, int], pointer: Pointer
    ) -> Mapping[str, Array]:
        kept: dict[str, Array] = {}
        for name, index in source.items():
            at: Pointer = (*pointer, name)
            if name not in base:
                self.report.note(at, "a morph target of an attribute that the primitive lacks")
                continue
            accessor = self.accessors[index]
            if accessor["count"] != count:
                self.report.refuse(at, expected=f"{count} vertices", seen=accessor["count"])
            if name in _KEPT_TARGETS:
                quantised = self.quantised and accessor["componentType"] in (5120, 5122)
                if accessor["type"] != "VEC3" or not (accessor["componentType"] == 5126 or quantised):
                    self.report.refuse(at, expected="VEC3 of floats", seen=accessor["type"])
                kept[name] = self.attribute(name, index)
        return kept
