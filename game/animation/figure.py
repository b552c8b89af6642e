"""Model-space matrices of the joints that contacts, limbs and the gaze need: torso, head, arms and legs to the elbow
and the knee."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import bilinear as bl
from game.core.humanoid import REFERENCE

__all__ = [
    "BONES",
    "BONE_LENGTHS",
    "ENDS",
    "FEET_WORLD",
    "FIGURE",
    "HINGE",
    "LOWER",
    "SHOULDERS",
    "UPPER",
    "WHERE",
    "figure_matrices",
]

Floats = NDArray[np.floating[Any]]

_LEVELS = (
    ("hips",),
    ("spine", "leftUpperLeg", "rightUpperLeg"),
    ("chest", "leftLowerLeg", "rightLowerLeg"),
    ("neck", "leftShoulder", "rightShoulder"),
    ("head", "leftUpperArm", "rightUpperArm"),
    ("leftLowerArm", "rightLowerArm"),
)
_NAMES = tuple(name for level in _LEVELS for name in level)

WHERE = {name: i for i, name in enumerate(_NAMES)}
"""Joint name -> place in figure_matrices."""
FIGURE: NDArray[np.intp] = np.array([REFERENCE.index[name] for name in _NAMES])
"""(15,) the joints in REFERENCE."""

_LIMBS = ("leftArm", "rightArm", "leftLeg", "rightLeg")
_UPPER_NAMES = ("leftUpperArm", "rightUpperArm", "leftUpperLeg", "rightUpperLeg")
_LOWER_NAMES = ("leftLowerArm", "rightLowerArm", "leftLowerLeg", "rightLowerLeg")
_END_NAMES = ("leftHand", "rightHand", "leftFoot", "rightFoot")
UPPER = np.array([WHERE[n] for n in _UPPER_NAMES])
LOWER = np.array([WHERE[n] for n in _LOWER_NAMES])
BONES = np.concatenate([UPPER, LOWER])
"""(8,) upper bones, then lower bones of the two arms and two legs."""
SHOULDERS = np.array([WHERE[n] for n in ("leftShoulder", "rightShoulder", "hips", "hips")])
"""Parents of the four upper bones."""
ENDS = np.array([[REFERENCE.index[n] for n in names] for names in (_UPPER_NAMES, _LOWER_NAMES, _END_NAMES)])
"""(3, 4) upper bone, lower bone and end of the two arms and two legs, in REFERENCE."""
HINGE = np.array([[0, 1, 0], [0, -1, 0], [-1, 0, 0], [-1, 0, 0]], dtype=np.float32)
"""Axis, in the upper bone's frame, about which a straight limb opens: elbows bend forward, knees backward."""

_OFFSET = REFERENCE.rest_translation[FIGURE].astype(np.float32)
_END_OFFSET = REFERENCE.rest_translation[ENDS[2]].astype(np.float32)
BONE_LENGTHS = np.linalg.norm(REFERENCE.rest_translation[ENDS[1:]], axis=-1)
"""(2, 4) metres: upper and lower bones."""
FEET_WORLD = REFERENCE.rest_model[ENDS[2, 2:], :3, 3].astype(np.float32)
"""(2, 3) where the ankles stand."""


def _plan() -> tuple[tuple[slice, NDArray[np.intp]], ...]:
    plan, at = [], 1
    for level in _LEVELS[1:]:
        parents = [REFERENCE.names[REFERENCE.parents[REFERENCE.index[name]]] for name in level]
        plan.append((slice(at, at + len(level)), np.array([WHERE[p] for p in parents])))
        at += len(level)
    return tuple(plan)


_PLAN = _plan()
for _array in (FIGURE, BONES, BONE_LENGTHS, UPPER, LOWER, SHOULDERS, ENDS, HINGE, _OFFSET, _END_OFFSET, FEET_WORLD):
    _array.setflags(write=False)


def figure_matrices(
    rotation: Floats, root: Floats, offset: Floats = _OFFSET, end_offset: Floats = _END_OFFSET
) -> tuple[Floats, Floats]:
    """rotation (n, 41, 4), root (n, 3) -> (n, 15, 4, 4) in model space and the four limbs' ends (n, 4, 3).

    offset: (15, 3) or (n, 15, 3) rest translations, end_offset: (4, 3) or (n, 4, 3): the reference's unless given.
    """
    local = bl.affine(rotation.take(FIGURE, axis=1))
    local[:, :, :3, 3] = offset
    local[:, 0, :3, 3] = root
    for level, parents in _PLAN:
        local[:, level] = local.take(parents, axis=1) @ local[:, level]
    lower = local.take(LOWER, axis=1)
    return local, lower[..., :3, 3] + (lower[..., :3, :3] @ end_offset[..., None])[..., 0]
