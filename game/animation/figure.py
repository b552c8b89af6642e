"""The joints that contacts, limbs, the gaze and the fit need: torso, head, arms and legs, parents first."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from game.core.humanoid import REFERENCE

__all__ = ["BONES", "BONE_LENGTHS", "ENDS", "FEET_WORLD", "FIGURE", "PARENTS", "WHERE"]

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
"""Joint name -> place in FIGURE."""
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
PARENTS = np.array([-1, *(_NAMES.index(REFERENCE.names[REFERENCE.parents[joint]]) for joint in FIGURE[1:])])
"""(19,) each joint's parent in FIGURE."""
for _array in (FIGURE, BONES, BONE_LENGTHS, ENDS, FEET_WORLD, PARENTS):
    _array.setflags(write=False)
