"""One pose per character, poses between ticks, and how hard a movement accelerates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import quaternion as quat

__all__ = ["Pose", "interpolate_pose", "joint_accelerations", "largest_joint_acceleration"]

Floats = NDArray[np.floating[Any]]


@dataclass(frozen=True, eq=False)
class Pose:
    """n characters on the reference skeleton.

    rotation: (n, 41, 4) local unit quaternions; root: (n, 3) translation of the hips, metres; gaze: (n, 2) eyes in
    [-1, 1], x to the character's left, y up; blink: (n,) 0 open .. 1 shut; breath: (n,) lungs 0 empty .. 1 full.
    """

    rotation: Floats
    root: Floats
    gaze: Floats
    blink: Floats
    breath: Floats

    def __len__(self) -> int:
        return len(self.rotation)


def interpolate_pose(a: Pose, b: Pose, t: float) -> Pose:
    """The pose at share t in [0, 1] of the way from a to b, for frames between two ticks."""

    def between(x: Floats, y: Floats) -> Floats:
        return np.asarray(x + (y - x) * np.asarray(t, dtype=x.dtype))

    return Pose(
        rotation=quat.nlerp(a.rotation, b.rotation, np.asarray(t, dtype=a.rotation.dtype)),
        root=between(a.root, b.root),
        gaze=between(a.gaze, b.gaze),
        blink=between(a.blink, b.blink),
        breath=between(a.breath, b.breath),
    )


def joint_accelerations(rotation: Floats, fps: float) -> Floats:
    """Angular accelerations of local rotations over time, (F, ..., 4) -> (F − 2, ...) rad/s²."""
    q = np.asarray(rotation, dtype=np.float64)
    step = quat.log(quat.multiply(quat.conjugate(q[:-1]), q[1:]))
    return np.asarray(np.linalg.norm(np.diff(step, axis=0), axis=-1) * fps * fps)


def largest_joint_acceleration(rotation: Floats, fps: float = 30.0) -> float:
    """The largest angular acceleration of any joint in a movement, rad/s²: what a pop shows up in."""
    return float(joint_accelerations(rotation, fps).max())
