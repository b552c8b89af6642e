"""The looks of passers-by: coarse meshes of the shopkeepers' models in other colours, rigid to one joint a vertex."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.render.assets import character_parts
from game.render.coarse import coarser
from game.render.grading import grade
from game.render.model import Part

__all__ = ["CrowdLook", "CrowdMesh", "CrowdView", "dressed", "load_crowd_mesh"]

Floats = NDArray[np.floating[Any]]

CELL_M = 0.05
DRESS = ("skin", "hair", "top", "legs", "shoes", "hat")
_ANKLE_M, _WAIST_M, _NECK_M = 0.10, 0.50, 1.20
# Hair, skin and cloth of passers-by.
_HAIR = np.array(
    [
        (0.26, 0.20, 0.20),
        (0.45, 0.29, 0.20),
        (0.72, 0.58, 0.40),
        (0.16, 0.15, 0.20),
        (0.58, 0.33, 0.22),
        (0.70, 0.68, 0.66),
    ]
)
_SKIN = np.array([(1.0, 1.0, 1.0), (0.93, 0.86, 0.80), (1.0, 0.98, 0.97), (0.72, 0.60, 0.53), (0.97, 0.92, 0.88)])
"""Shares of the model's own skin."""
_TOP = np.array(
    [
        (0.79, 0.42, 0.36), (0.37, 0.52, 0.66), (0.90, 0.72, 0.40), (0.46, 0.60, 0.45),
        (0.93, 0.88, 0.80), (0.56, 0.43, 0.58), (0.83, 0.57, 0.52), (0.30, 0.40, 0.50),
    ]
)  # fmt: skip
_LEGS = np.array([(0.33, 0.38, 0.50), (0.62, 0.53, 0.43), (0.28, 0.27, 0.32), (0.50, 0.47, 0.44), (0.43, 0.33, 0.32)])
_SHOES = np.array([(0.38, 0.27, 0.22), (0.90, 0.87, 0.82), (0.25, 0.24, 0.28)])
_PLAIN = 0.16  # the saturation from which on cloth is taken to have a colour; white and grey cloth stays as it is


@dataclass(frozen=True, eq=False)
class CrowdMesh:
    """position, normal: (v, 3); joint: (v,); face_uv: (v, 2), −1 where there is no face; lit, shade: (v, 3) as
    modelled; dress: (v,) what it is, as DRESS; triangle: (t, 3)."""

    position: Floats
    normal: Floats
    joint: NDArray[np.uint8]
    face_uv: Floats
    lit: Floats
    shade: Floats
    dress: NDArray[np.intp]
    triangle: NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class CrowdLook:
    """One passer-by: a mesh in their own colours, lit and shade (v, 3) graded."""

    mesh: CrowdMesh
    lit: Floats
    shade: Floats


@dataclass(frozen=True, eq=False)
class CrowdView:
    """Passers-by of one frame. matrices: one (K, 4, 4) skin matrix array each, model to world included; place:
    (n, 3) where they stand; tall_m: (n,) their height."""

    matrices: Sequence[NDArray[np.float32]]
    place: Floats
    tall_m: Floats


def load_crowd_mesh(vrm: Path) -> CrowdMesh:
    """The coarsest level of detail beside a character file, made coarser still. Raises BadInput."""
    parts = [coarser(part, CELL_M) for part in character_parts(vrm)]
    first = np.cumsum([0, *(len(part.position) for part in parts)])
    return CrowdMesh(
        position=np.concatenate([part.position for part in parts]),
        normal=np.concatenate([part.normal for part in parts]),
        joint=np.concatenate([_main_joint(part) for part in parts]),
        face_uv=np.concatenate([_face_uv(part) for part in parts]),
        lit=np.concatenate([np.tile(part.material.lit, (len(part.position), 1)) for part in parts]),
        shade=np.concatenate([np.tile(part.material.shade, (len(part.position), 1)) for part in parts]),
        dress=np.concatenate([_dress(part) for part in parts]),
        triangle=np.concatenate(
            [part.triangle.astype(np.int32) + at for part, at in zip(parts, first[:-1].tolist(), strict=True)]
        ).astype(np.int32),
    )


def dressed(mesh: CrowdMesh, who: int) -> CrowdLook:
    """The mesh as the ``who``-th passer-by wears it."""
    draw = np.random.default_rng([0xD2E55, who]).random(4)
    # Neighbours in the row of people never wear the same: the first choice goes round, the others are drawn.
    own = {
        "hair": _HAIR[who % len(_HAIR)],
        "top": _TOP[(who * 3) % len(_TOP)],
        "hat": _TOP[(who * 3 + 4) % len(_TOP)],
        "legs": _LEGS[int(draw[0] * len(_LEGS))],
        "shoes": _SHOES[int(draw[1] * len(_SHOES))],
    }
    skin = _SKIN[int(draw[2] * len(_SKIN))]
    colours = []
    for given, dark in ((mesh.lit, 1.0), (mesh.shade, 0.66)):
        colour = given * np.where((mesh.dress == DRESS.index("skin"))[:, None], skin, 1.0)
        for name, wanted in own.items():
            part = mesh.dress == DRESS.index(name)
            colour[part] = wanted * dark if name in ("hair", "shoes") else _recoloured(mesh.lit[part], wanted) * dark
        colours.append(grade(np.clip(colour, 0.0, 1.0)))
    return CrowdLook(mesh, colours[0], colours[1])


def _recoloured(given: Floats, wanted: Floats) -> Floats:
    """Cloth (v, 3) in another colour: as light or dark against the rest as it was, white where it was white."""
    if not len(given):
        return given
    light, span = given.mean(axis=1), np.ptp(given, axis=1)
    coloured = span > _PLAIN
    usual = float(np.median(light[coloured])) if coloured.any() else 1.0
    new = wanted * np.clip(light / max(usual, 1e-3), 0.6, 1.25)[:, None]
    return np.where(coloured[:, None], new, given)


def _dress(part: Part) -> NDArray[np.intp]:
    """(v,) what every vertex of a part is, told by its material and by how high it stands."""
    kind = {"skin": "skin", "face": "skin", "hair": "hair"}.get(part.material.kind)
    if kind is not None:
        return np.full(len(part.position), DRESS.index(kind))
    height = part.position[:, 1]
    cloth = "legs" if float(height.mean()) < _WAIST_M else "top"
    names = np.full(len(height), DRESS.index(cloth))
    names[height < _ANKLE_M], names[height > _NECK_M] = DRESS.index("shoes"), DRESS.index("hat")
    return names


def _main_joint(part: Part) -> NDArray[np.uint8]:
    assert part.joint is not None
    assert part.weight is not None
    return np.take_along_axis(part.joint, part.weight.argmax(axis=1)[:, None], axis=1)[:, 0]


def _face_uv(part: Part) -> Floats:
    if part.material.kind != "face" or part.extra is None:
        return np.full((len(part.position), 2), -1.0, np.float32)
    return np.where(part.extra[:, 2:3] > 0.0, part.extra[:, :2], -1.0).astype(np.float32)
