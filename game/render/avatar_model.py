"""A foreign avatar as the renderer wants it: one mesh, its materials and pictures, its morph targets as slots."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.core.errors import Where
from game.formats import AvatarGeometry, GltfFile, ToonMaterial
from game.render.avatar_textures import decode_images
from game.render.model import joint_boxes

__all__ = ["AvatarLook", "AvatarModel", "AvatarRun", "build_avatar", "plain_material"]

Floats = NDArray[np.float32]


@dataclass(frozen=True)
class AvatarRun:
    """Triangles of one material, side by side in the index buffer."""

    material: int
    first: int
    count: int


@dataclass(frozen=True, eq=False)
class AvatarLook:
    """What the face does in one frame. morph: (M,) weights of the model's slots; colours: (material, what) -> linear
    RGBA; shifts: material -> scale and offset (4,) of its texture coordinates."""

    morph: Floats
    colours: Mapping[tuple[int, str], tuple[float, ...]]
    shifts: Mapping[int, tuple[float, float, float, float]]


@dataclass(frozen=True, eq=False)
class AvatarModel:
    """V vertices, M morph slots. materials: one more than the file's, the last for parts without one.

    width: (V,) factor of the outline's width; slots: (mesh, target) -> slot; moved: per slot the vertices and their
    displacements of place and normal (m, 6). runs in the order of drawing.
    """

    name: str
    geometry: AvatarGeometry
    materials: tuple[ToonMaterial, ...]
    pictures: Mapping[int, NDArray[np.uint8]]
    runs: tuple[AvatarRun, ...]
    width: Floats
    slots: Mapping[tuple[int, int], int]
    moved: tuple[tuple[NDArray[np.int32], Floats], ...]
    joint_box: Floats
    notes: tuple[str, ...]

    @property
    def joint_count(self) -> int:
        """Skin columns."""
        return len(self.geometry.column_node)

    def still(self) -> AvatarLook:
        """The face as the file has it."""
        return AvatarLook(np.zeros(len(self.moved), np.float32), {}, {})


def plain_material() -> ToonMaterial:
    """Of parts that have none."""
    return ToonMaterial("plain", "pbr", shade=(0.42, 0.38, 0.46), outline_mode="world", outline_width=0.0016)


def build_avatar(
    name: str, file: GltfFile, geometry: AvatarGeometry, materials: tuple[ToonMaterial, ...], scale: float
) -> AvatarModel:
    """scale: of the figure; outline widths in metres grow with it. Raises BadInput for too large pictures."""
    every = (*materials, plain_material())
    used = {
        texture.image
        for run in geometry.runs
        for texture in (
            every[run[0]].lit_texture,
            every[run[0]].shade_texture,
            every[run[0]].emissive_texture,
            every[run[0]].outline_texture,
        )
        if texture is not None
    }
    pictures, notes = decode_images(file.images, frozenset(used), Where(file.path, pointer="/images"))
    runs = [AvatarRun(m if m >= 0 else len(materials), first, count) for m, first, count in geometry.runs]
    rank = {"opaque": 0, "mask": 1, "blend": 2}
    runs.sort(key=lambda r: (rank.get(every[r.material].alpha, 0), every[r.material].queue, r.material))
    slots = {key: at for at, key in enumerate(geometry.morphs)}
    moved = []
    for parts in geometry.morphs.values():
        vertex = np.concatenate([part.vertex for part in parts])
        way = np.concatenate([np.hstack([part.position, part.normal]) for part in parts])
        moved.append((vertex, way.astype(np.float32)))
    for run in runs:
        notes += [f"{every[run.material].name}: {note}" for note in every[run.material].notes]
    joint_count = len(geometry.column_node)
    return AvatarModel(
        name=name,
        geometry=geometry,
        materials=every,
        pictures=pictures,
        runs=tuple(runs),
        width=_widths(geometry, runs, every, pictures, scale),
        slots=slots,
        moved=tuple(moved),
        joint_box=joint_boxes(geometry.position, geometry.joint, geometry.weight, joint_count),
        notes=(*geometry.notes, *dict.fromkeys(notes)),
    )


def _widths(
    geometry: AvatarGeometry,
    runs: list[AvatarRun],
    materials: tuple[ToonMaterial, ...],
    pictures: Mapping[int, NDArray[np.uint8]],
    scale: float,
) -> Floats:
    """(V,) the material's width times what its width texture says at the vertex."""
    width = np.zeros(len(geometry.position), dtype=np.float32)
    corners = geometry.triangle.reshape(-1)
    for run in runs:
        material = materials[run.material]
        if material.outline_mode == "none":
            continue
        vertex = np.unique(corners[run.first : run.first + run.count])
        own = material.outline_width * (scale if material.outline_mode == "world" else 1.0)
        width[vertex] = own
        texture = material.outline_texture
        if texture is not None and texture.image in pictures:
            picture = pictures[texture.image]
            uv = np.mod(np.clip(geometry.uv[vertex], -1e4, 1e4), 1.0)
            x = np.minimum((uv[:, 0] * picture.shape[1]).astype(int), picture.shape[1] - 1)
            y = np.minimum((uv[:, 1] * picture.shape[0]).astype(int), picture.shape[0] - 1)
            width[vertex] *= picture[y, x, 1] / 255.0
    return width
