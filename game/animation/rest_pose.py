"""The T-pose of a body whose rest pose may be another one: what the reference's identity rotations mean on it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import quaternion as quat
from game.core.humanoid import REFERENCE
from game.core.skeleton import Skeleton

__all__ = ["t_pose"]

Floats = NDArray[np.floating[Any]]

_REST = {name: REFERENCE.rest_model[i, :3, 3] for i, name in enumerate(REFERENCE.names)}
_LIMBS = (
    ("UpperArm", "LowerArm", 9.0),
    ("LowerArm", "Hand", 9.0),
    ("UpperLeg", "LowerLeg", 20.0),
    ("LowerLeg", "Foot", 20.0),
)
"""Bone, the bone its direction is read from, and from how many degrees on the rest pose counts as another one than the
T-pose: below that, files say T-pose and mean it (VRM does), and a person's legs may stand a little apart."""
_PALM_OFF_DEG = 35.0
"""A palm turned further than this from facing down is set right, half in the forearm, half at the wrist."""


def t_pose(skeleton: Skeleton, bones: Mapping[str, int]) -> tuple[Floats, Floats]:
    """skeleton: in metres, Y up, facing +Z; bones: VRM humanoid bone -> joint.

    -> model-space places (J, 3) and rotations (J, 4) with arms along ±X, palms down, legs below the hips.
    """
    place, turn = skeleton.to_model(skeleton.rest_rotation)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for bone, end, least_deg in _LIMBS:
            if side + bone in bones and side + end in bones:
                joint, child = bones[side + bone], bones[side + end]
                wanted = _REST[side + end] - _REST[side + bone]
                _swing(skeleton, place, turn, joint, place[child] - place[joint], wanted, least_deg)
        knuckle = f"{side}MiddleProximal"
        if f"{side}Hand" in bones and knuckle in bones:
            hand = bones[f"{side}Hand"]
            _swing(skeleton, place, turn, hand, place[bones[knuckle]] - place[hand], np.array([sign, 0.0, 0.0]), 25.0)
        _level_palm(skeleton, place, turn, bones, side)
    return place, turn


def _below(skeleton: Skeleton, joint: int) -> NDArray[np.intp]:
    """The joint and all that hangs on it."""
    inside = np.zeros(len(skeleton), dtype=bool)
    inside[joint] = True
    for at in range(joint + 1, len(skeleton)):
        parent = skeleton.parents[at]
        inside[at] = parent >= 0 and inside[parent]
    return np.flatnonzero(inside)


def _rotate(skeleton: Skeleton, place: Floats, turn: Floats, joint: int, by: Floats) -> None:
    """Turn a joint and all that hangs on it about its place; by: (4,) in model space."""
    group = _below(skeleton, joint)
    centre = place[joint].copy()
    place[group] = centre + quat.rotate(by, place[group] - centre)
    turn[group] = quat.multiply(by, turn[group])


def _swing(
    skeleton: Skeleton, place: Floats, turn: Floats, joint: int, way: Floats, wanted: Floats, least_deg: float
) -> None:
    lengths = np.linalg.norm(way), np.linalg.norm(wanted)
    if min(lengths) < 1e-6:
        return
    way, wanted = way / lengths[0], wanted / lengths[1]
    if np.rad2deg(np.arccos(np.clip(way @ wanted, -1.0, 1.0))) > least_deg:
        _rotate(skeleton, place, turn, joint, quat.between(way, wanted))


def _level_palm(skeleton: Skeleton, place: Floats, turn: Floats, bones: Mapping[str, int], side: str) -> None:
    """Palm down: the index finger's knuckle before the little finger's."""
    names = [f"{side}{bone}" for bone in ("LowerArm", "Hand", "IndexProximal", "LittleProximal")]
    if any(name not in bones for name in names):
        return
    lower, hand, index, little = (bones[name] for name in names)
    across = place[index] - place[little]
    angle = float(np.arctan2(across[1], across[2]))
    if np.hypot(across[1], across[2]) < 1e-6 or abs(np.rad2deg(angle)) < _PALM_OFF_DEG:
        return
    half = quat.from_axis_angle(np.array([1.0, 0.0, 0.0]), 0.5 * angle)
    _rotate(skeleton, place, turn, lower, half)
    _rotate(skeleton, place, turn, hand, half)
