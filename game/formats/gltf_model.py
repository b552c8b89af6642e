"""What a checked glTF document holds: immutable Python data and read-only NumPy arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput, Where
from game.formats.gltf_buffers import Buffers

__all__ = [
    "GltfAnimation",
    "GltfChannel",
    "GltfFile",
    "GltfImage",
    "GltfMaterial",
    "GltfMesh",
    "GltfNode",
    "GltfPrimitive",
    "GltfSkin",
    "topological",
]

Array = NDArray[Any]
Floats = NDArray[np.float64]

_LARGEST = 1e15


@dataclass(frozen=True, eq=False)
class GltfNode:
    """One node; parent -1 for a root. matrix: (4, 4) local, column vectors."""

    index: int
    name: str
    parent: int
    children: tuple[int, ...]
    translation: Floats
    rotation: Floats
    scale: Floats
    matrix: Floats
    mesh: int | None
    skin: int | None
    extras: Any
    extensions: Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class GltfPrimitive:
    """attributes: semantic -> (V, …): POSITION, NORMAL, TANGENT, TEXCOORD_n, COLOR_n and WEIGHTS_n float32,
    JOINTS_n uint16, custom ones (``_OUTLINE``) as stored. indices: (I,) uint32 or None; mode: GL's (4 = triangles).
    targets: morph targets, semantic -> (V, 3) float32 displacements.
    """

    attributes: Mapping[str, Array]
    indices: NDArray[np.uint32] | None
    mode: int
    material: int | None
    targets: tuple[Mapping[str, Array], ...]
    extras: Any


@dataclass(frozen=True, eq=False)
class GltfMesh:
    """weights: default morph weights; target_names: from extras.targetNames where given."""

    name: str
    primitives: tuple[GltfPrimitive, ...]
    weights: tuple[float, ...]
    target_names: tuple[str, ...]
    extras: Any


@dataclass(frozen=True, eq=False)
class GltfSkin:
    """joints: node indices; inverse_bind: (J, 4, 4) mesh space -> joint space at bind time."""

    name: str
    joints: tuple[int, ...]
    inverse_bind: Floats
    skeleton: int | None


@dataclass(frozen=True, eq=False)
class GltfMaterial:
    """base_color: (4,) linear RGBA; extras and extensions as stored."""

    name: str
    base_color: tuple[float, ...]
    alpha_mode: str
    double_sided: bool
    extras: Any
    extensions: Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class GltfImage:
    """The encoded bytes (PNG, JPEG, …) as they are, never decoded here."""

    name: str
    mime_type: str
    data: bytes


@dataclass(frozen=True, eq=False)
class GltfAnimation:
    """Channels of one animation; two never drive the same property."""

    name: str
    channels: tuple[GltfChannel, ...]

    @property
    def length_s(self) -> float:
        """The last key's time."""
        return max((float(channel.times_s[-1]) for channel in self.channels), default=0.0)


@dataclass(frozen=True, eq=False)
class GltfChannel:
    """One animated property of a node. values: (K, n), for CUBICSPLINE (K, 3, n) in-tangent, value, out-tangent."""

    node: int
    path: str
    times_s: Floats
    values: Floats
    interpolation: str


@dataclass(frozen=True, eq=False)
class GltfFile:
    """A checked glTF document. Arrays are read-only."""

    path: Path
    json: Mapping[str, Any]
    nodes: tuple[GltfNode, ...]
    meshes: tuple[GltfMesh, ...]
    skins: tuple[GltfSkin, ...]
    animations: tuple[GltfAnimation, ...]
    materials: tuple[GltfMaterial, ...]
    images: tuple[GltfImage | None, ...]
    findings: list[str] = field(default_factory=list)
    buffers: Buffers | None = None

    def accessor(self, index: int) -> Array:
        """Accessor by index, see Buffers.accessor."""
        assert self.buffers is not None
        return self.buffers.accessor(index)

    @property
    def extensions(self) -> Mapping[str, Any]:
        """The document's own extensions (VRM, VRMC_vrm, …)."""
        extensions: Mapping[str, Any] = self.json.get("extensions", {})
        return extensions

    @property
    def extras(self) -> Any:
        """The document's own extras."""
        return self.json.get("extras")

    @cached_property
    def node_index(self) -> dict[str, int]:
        """Name -> first node of that name."""
        return {node.name: node.index for node in reversed(self.nodes)}

    @cached_property
    def order(self) -> NDArray[np.intp]:
        """All node indices, parents first."""
        return np.array(topological([node.parent for node in self.nodes]), dtype=np.intp)

    @cached_property
    def node_model(self) -> Floats:
        """(N, 4, 4) model-space matrices of the rest pose."""
        return self.to_model(np.array([node.matrix for node in self.nodes]).reshape(-1, 4, 4))

    def to_model(self, local: Floats) -> Floats:
        """Local matrices (..., N, 4, 4) -> model-space matrices. Raises BadInput where scales run away."""
        model = np.array(local)
        with np.errstate(all="ignore"):
            for index in self.order.tolist():
                parent = self.nodes[index].parent
                if parent >= 0:
                    model[..., index, :, :] = model[..., parent, :, :] @ local[..., index, :, :]
        if not np.all(np.abs(model) < _LARGEST):
            raise BadInput("node positions beyond all bounds", where=Where(self.path, pointer="/nodes"))
        return np.asarray(np.where(np.abs(model) < 1.0 / _LARGEST, 0.0, model))


def topological(parents: Sequence[int]) -> list[int]:
    """Indices depth first, every parent before its children; shorter than the input where parents form a cycle."""
    children: list[list[int]] = [[] for _ in parents]
    stack: list[int] = []
    for index, parent in enumerate(parents):
        (children[parent] if parent >= 0 else stack).append(index)
    stack.reverse()
    order: list[int] = []
    while stack:
        order.append(stack.pop())
        stack.extend(reversed(children[order[-1]]))
    return order
