"""Model-space matrices of the joints that contacts, limbs and the gaze need: torso, head, arms and legs."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.humanoid import REFERENCE

__all__ = ["BONES", "BONE_LENGTHS", "ENDS", "FEET_WORLD", "FIGURE", "WHERE", "figure_matrices"]

Floats = NDArray[np.floating[Any]]

_LEVELS = (
    ("hips",),
    ("spine", "leftUpperLeg", "rightUpperLeg"),
    ("chest", "leftLowerLeg", "rightLowerLeg"),
    ("neck", "leftShoulder", "rightShoulder", "leftFoot", "rightFoot"),
    ("head", "leftUpperArm", "rightUpperArm"),
    ("leftLowerArm", "rightLowerArm"),
    ("leftHand", "rightHand"),
)
_NAMES = tuple(name for level in _LEVELS for name in level)

WHERE = {name: i for i, name in enumerate(_NAMES)}
"""Joint name -> place in figure_matrices."""
FIGURE: NDArray[np.intp] = np.array([REFERENCE.index[name] for name in _NAMES])
"""(19,) the joints in REFERENCE."""

_UPPER_NAMES = ("leftUpperArm", "rightUpperArm", "leftUpperLeg", "rightUpperLeg")
_LOWER_NAMES = ("leftLowerArm", "rightLowerArm", "leftLowerLeg", "rightLowerLeg")
_END_NAMES = ("leftHand", "rightHand", "leftFoot", "rightFoot")
_ABOVE_NAMES = ("leftShoulder", "rightShoulder", "hips", "hips")
BONES = np.array([WHERE[n] for n in (*_ABOVE_NAMES, *_UPPER_NAMES, *_LOWER_NAMES, *_END_NAMES)])
"""(16,) of the two arms and two legs: what the upper bones hang on, upper bones, lower bones, ends."""
ENDS = np.array([[REFERENCE.index[n] for n in names] for names in (_UPPER_NAMES, _LOWER_NAMES, _END_NAMES)])
"""(3, 4) upper bone, lower bone and end of the two arms and two legs, in REFERENCE."""
BONE_LENGTHS = np.linalg.norm(REFERENCE.rest_translation[ENDS[1:]], axis=-1)
"""(2, 4) metres: upper and lower bones."""
FEET_WORLD = REFERENCE.rest_model[ENDS[2, 2:], :3, 3].astype(np.float32)
"""(2, 3) where the ankles stand."""


def _plan() -> tuple[tuple[int, NDArray[np.intp]], ...]:
    """Per pass: the first joint it moves on, and for it and all after it the joint they are still relative to.

    A pass doubles the way behind a joint's matrix (parent, then grandparent, ...): three passes where levels, one
    after the other, would be six, and a pass costs a call more than it costs matrices.
    """
    parent = np.array([-1, *(_NAMES.index(REFERENCE.names[REFERENCE.parents[j]]) for j in FIGURE[1:])])
    plan, relative = [], parent
    while relative.max() >= 0:
        first = int(np.argmax(relative >= 0))
        plan.append((first, relative[first:].copy()))
        relative = np.where(relative >= 0, relative[np.maximum(relative, 0)], -1)
    return tuple(plan)


_PLAN = _plan()
for _array in (FIGURE, BONES, BONE_LENGTHS, ENDS, FEET_WORLD, *(relative for _, relative in _PLAN)):
    _array.setflags(write=False)


def figure_matrices(local: Floats, first: int = 0) -> None:
    """(n, first + 19, 4, 4) float32 local matrices, FIGURE's after ``first`` others -> in place to model space."""
    for start, relative in _PLAN:
        moved = local[:, first + start :]
        moved[:] = local.take(relative + first, axis=1) @ moved
