"""Figures of a take: how lively, how still, how smooth, how deep anything enters anything."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import Clip
from game.core import quaternion as quat
from game.core.humanoid import PART_JOINTS, REFERENCE
from game.tools.perform import contact
from game.tools.perform.arms import SIDES

__all__ = ["Figures", "measure"]

Floats = NDArray[np.floating[Any]]
_BODY = ("hips", "spine", "chest", "neck", "head") + tuple(
    f"{side}{part}" for side in SIDES for part in ("UpperArm", "LowerArm", "Hand")
)
_STILL_DEG_PER_S = 8.0


@dataclass(frozen=True)
class Figures:
    """speed: mean over trunk, head and arm joints, degrees per second; still: share of time with that mean below 8;
    wrists_m: mean distance between the wrists; peak_joint_deg_per_s2 and peak_wrist_m_per_s2: largest accelerations;
    hand_depth_m, forearm_depth_m: deepest a hand (wrist, palm, fingers) or a forearm's middle enters trunk, head or
    table; feet_drift_m: how far a toe joint ever moves."""

    speed_deg_per_s: float
    still: float
    wrists_m: float
    peak_joint_deg_per_s2: float
    peak_wrist_m_per_s2: float
    hand_depth_m: float
    forearm_depth_m: float
    feet_drift_m: float


def joint_speeds(clip: Clip) -> Floats:
    """Local angular speeds (F - 1, J), radians per second."""
    turn = quat.multiply(quat.conjugate(clip.rotation[:-1]), clip.rotation[1:])
    return np.asarray(np.linalg.norm(quat.log(turn), axis=-1) / clip.frame_time_s)


def measure(clip: Clip) -> Figures:
    """All figures of a take on the reference humanoid."""
    index = REFERENCE.index
    body = [index[name] for name in _BODY]
    moving = [index[name] for part in PART_JOINTS.values() for name in part]
    mean = np.degrees(joint_speeds(clip)[:, body]).mean(1)
    turn = quat.log(quat.multiply(quat.conjugate(clip.rotation[:-1]), clip.rotation[1:])) / clip.frame_time_s
    turning = np.linalg.norm(np.diff(turn, axis=0), axis=-1)[:, moving] / clip.frame_time_s
    position, rotation = clip.to_model()
    wrists = position[:, [index["leftHand"], index["rightHand"]]]
    jerked = np.linalg.norm(np.diff(wrists, n=2, axis=0), axis=-1) / clip.frame_time_s**2
    hand, forearm = 0.0, 0.0
    for side in SIDES:
        points, radii = contact.arm_points(position, rotation, side)
        depth = np.maximum(contact.body_depth(points, radii, position, rotation), contact.table_depth(points, radii))
        hand = max(hand, float(depth[:, : contact.HAND_POINTS].max()))
        forearm = max(forearm, float(depth[:, contact.HAND_POINTS : -1].max()))
    toes = position[:, [index["leftToes"], index["rightToes"]]]
    return Figures(
        float(mean.mean()),
        float((mean < _STILL_DEG_PER_S).mean()),
        float(np.linalg.norm(wrists[:, 0] - wrists[:, 1], axis=-1).mean()),
        float(np.degrees(turning.max())),
        float(jerked.max()),
        hand,
        forearm,
        float(np.linalg.norm(toes - toes[0], axis=-1).max()),
    )
