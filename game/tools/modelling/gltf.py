"""A small glTF 2.0 binary writer: typed accessors in one buffer, the rest plain JSON values in a fixed order."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.tools.modelling.spec import Swatch

__all__ = ["Gltf", "linear_rgb", "material_json", "srgb", "unit_normals"]

_GENERATOR = "mental-communication-game modelling"
_COMPONENT = {"float32": 5126, "uint8": 5121, "uint16": 5123, "uint32": 5125}
_SHAPE = {(): "SCALAR", (2,): "VEC2", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}
_VERTICES, _INDICES = 34962, 34963


class Gltf:
    """Collects accessors, nodes, meshes and materials; ``save`` writes the .glb."""

    def __init__(self) -> None:
        self.root: dict[str, Any] = {"asset": {"version": "2.0", "generator": _GENERATOR}, "scene": 0}
        self.nodes: list[dict[str, Any]] = []
        self.meshes: list[dict[str, Any]] = []
        self.materials: list[dict[str, Any]] = []
        self._accessors: list[dict[str, Any]] = []
        self._views: list[dict[str, Any]] = []
        self._blob = bytearray()

    def accessor(
        self, array: NDArray[Any], *, target: int | None = None, bounds: bool = False, normalized: bool = False
    ) -> int:
        """Append an array of float32, uint8, uint16 or uint32; -> its accessor index."""
        data = np.ascontiguousarray(array)
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self._blob), "byteLength": data.nbytes}
        if target is not None:
            view["target"] = target
        self._views.append(view)
        self._blob += data.tobytes()
        self._blob += b"\0" * (-len(self._blob) % 4)
        entry: dict[str, Any] = {
            "bufferView": len(self._views) - 1,
            "componentType": _COMPONENT[data.dtype.name],
            "count": len(data),
            "type": _SHAPE[data.shape[1:]],
        }
        if normalized:
            entry["normalized"] = True
        if bounds:
            entry["min"] = [float(v) for v in np.atleast_1d(data.min(0))]
            entry["max"] = [float(v) for v in np.atleast_1d(data.max(0))]
        self._accessors.append(entry)
        return len(self._accessors) - 1

    def vertices(self, array: NDArray[Any], **options: bool) -> int:
        return self.accessor(array, target=_VERTICES, **options)

    def indices(self, triangle: NDArray[Any], vertex_count: int) -> int:
        kind = np.uint16 if vertex_count < 65535 else np.uint32
        return self.accessor(triangle.astype(kind).ravel(), target=_INDICES)

    def picture(self, png: bytes, name: str, *, repeat: bool = False) -> int:
        """Append an embedded PNG, clamped at its edges or repeated; -> its texture index."""
        self._views.append({"buffer": 0, "byteOffset": len(self._blob), "byteLength": len(png)})
        self._blob += png + b"\0" * (-len(png) % 4)
        images, textures = self.root.setdefault("images", []), self.root.setdefault("textures", [])
        wrap, smaller = (10497, 9987) if repeat else (33071, 9729)
        sampler = {"magFilter": 9729, "minFilter": smaller, "wrapS": wrap, "wrapT": wrap}
        samplers = self.root.setdefault("samplers", [])
        if sampler not in samplers:
            samplers.append(sampler)
        images.append({"name": name, "mimeType": "image/png", "bufferView": len(self._views) - 1})
        textures.append({"source": len(images) - 1, "sampler": samplers.index(sampler)})
        return len(textures) - 1

    def node(self, **content: Any) -> int:
        self.nodes.append(content)
        return len(self.nodes) - 1

    def to_bytes(self) -> bytes:
        root = dict(self.root)
        root["nodes"] = self.nodes
        if self.meshes:
            root["meshes"] = self.meshes
        if self.materials:
            root["materials"] = self.materials
        root["accessors"] = self._accessors
        root["bufferViews"] = self._views
        root["buffers"] = [{"byteLength": len(self._blob)}]
        text = json.dumps(root, separators=(",", ":"), ensure_ascii=False).encode()
        text += b" " * (-len(text) % 4)
        total = 12 + 8 + len(text) + 8 + len(self._blob)
        return b"".join(
            [
                struct.pack("<4sII", b"glTF", 2, total),
                struct.pack("<I4s", len(text), b"JSON"),
                text,
                struct.pack("<I4s", len(self._blob), b"BIN\0"),
                bytes(self._blob),
            ]
        )

    def save(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(self.to_bytes())


def srgb(colour: str) -> list[float]:
    """ "#rrggbb" -> three values 0..1, still sRGB-encoded."""
    return [round(int(colour[i : i + 2], 16) / 255, 6) for i in (1, 3, 5)]


def linear_rgb(colour: str) -> list[float]:
    """ "#rrggbb" -> linear light 0..1 (IEC 61966-2-1), as glTF stores factors."""
    return [round(c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4, 6) for c in srgb(colour)]


def material_json(name: str, swatch: Swatch, *, toon: bool) -> dict[str, Any]:
    """A material by palette entry; ``toon`` adds VRMC_materials_mtoon for other VRM programs."""
    material: dict[str, Any] = {
        "name": name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*linear_rgb(swatch.lit), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.9,
        },
        "extras": {
            "palette": name,
            "class": swatch.kind,
            "lit_srgb": swatch.lit,
            "shade_srgb": swatch.shade,
            "deep_srgb": swatch.deep,
            "lit": srgb(swatch.lit),
            "shade": srgb(swatch.shade),
            "deep": srgb(swatch.deep),
        },
    }
    if toon:
        # A terminator of half-Lambert .482-.518 is one of N.L = -.036...036: a nearly hard MToon edge.
        material["extensions"] = {
            "VRMC_materials_mtoon": {
                "specVersion": "1.0",
                "shadeColorFactor": linear_rgb(swatch.shade),
                "shadingShiftFactor": 0.0,
                "shadingToonyFactor": 0.95,
                "giEqualizationFactor": 0.9,
                "parametricRimColorFactor": [0.10, 0.08, 0.06],
                "parametricRimFresnelPowerFactor": 4.0,
                "outlineWidthMode": "worldCoordinates",
                "outlineWidthFactor": 0.0016,
                "outlineColorFactor": [
                    round(c * k, 6) for c, k in zip(linear_rgb(swatch.deep), (0.2, 0.13, 0.17), strict=True)
                ],
                "outlineLightingMixFactor": 0.0,
            }
        }
    return material


def unit_normals(normal: NDArray[np.float64]) -> NDArray[np.float32]:
    """(n, 3) float32 of length 1, as glTF demands; one without direction (the pole of a lathe) points up."""
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return np.where(length > 1e-6, normal / np.maximum(length, 1e-6), (0.0, 1.0, 0.0)).astype(np.float32)
