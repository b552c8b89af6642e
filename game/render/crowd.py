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
# Hair and cloth of passers-by: a colour for the hair, a turn of the clothes' hue, how grey they are.
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


@dataclass(frozen=True, eq=False)
class CrowdMesh:
    """position, normal: (v, 3); joint: (v,); face_uv: (v, 2), −1 where there is no face; lit, shade: (v, 3) as
    modelled; dress: (v,) 0 skin, 1 hair, 2 clothes; triangle: (t, 3)."""

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
        dress=np.concatenate([np.full(len(part.position), _dress(part)) for part in parts]),
        triangle=np.concatenate(
            [part.triangle.astype(np.int32) + at for part, at in zip(parts, first[:-1].tolist(), strict=True)]
        ).astype(np.int32),
    )


def dressed(mesh: CrowdMesh, who: int) -> CrowdLook:
    """The mesh as the ``who``-th passer-by wears it."""
    draw = np.random.default_rng([0xD2E55, who]).random(4)
    hair = _HAIR[who % len(_HAIR)]
    # Each person's hue is well away from the next one's; the golden angle spreads any number of them.
    turn = _hue_turn(2.39996 * (who + 1), 0.62 + 0.25 * draw[0])
    colours = []
    for given, dark in ((mesh.lit, 1.0), (mesh.shade, 0.62)):
        colour = np.where((mesh.dress == 2)[:, None], given @ turn.T, given)
        colour = np.where((mesh.dress == 1)[:, None], hair * dark, colour)
        colours.append(grade(np.clip(colour, 0.0, 1.0)))
    return CrowdLook(mesh, colours[0], colours[1])


def _hue_turn(angle_rad: float, saturation: float) -> Floats:
    """(3, 3) turns hues about the grey axis and scales how far colours are from it."""
    c, s, third = np.cos(angle_rad), np.sin(angle_rad), 1.0 / 3.0
    root = np.sqrt(third)
    cross = root * np.array([[0.0, -1.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 1.0, 0.0]])
    turn = c * np.eye(3) + s * cross + (1.0 - c) * third
    grey = np.full((3, 3), third)
    return np.asarray(grey + (turn - grey) * saturation)


def _dress(part: Part) -> int:
    return {"skin": 0, "face": 0, "hair": 1}.get(part.material.kind, 2)


def _main_joint(part: Part) -> NDArray[np.uint8]:
    assert part.joint is not None
    assert part.weight is not None
    return np.take_along_axis(part.joint, part.weight.argmax(axis=1)[:, None], axis=1)[:, 0]


def _face_uv(part: Part) -> Floats:
    if part.material.kind != "face" or part.extra is None:
        return np.full((len(part.position), 2), -1.0, np.float32)
    return np.where(part.extra[:, 2:3] > 0.0, part.extra[:, :2], -1.0).astype(np.float32)
