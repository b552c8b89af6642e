"""Two-bone inverse kinematics for all four limbs at once, as corrections of the pose that is already there.

The clip's own elbow and knee directions are kept: the limb is opened or closed about its present hinge and then
swung to the target, so a target where the limb already ends changes nothing.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import bilinear as bl

__all__ = ["REACH_FULL", "REACH_SOFT", "LimbFix", "solve_limbs"]

Floats = NDArray[np.floating[Any]]

REACH_SOFT, REACH_FULL = 0.93, 0.985
"""Shares of a limb's length between which its reach is softly clamped (MOTION.md, contacts)."""
STRAIGHTEST = 0.9995
"""No limb is ever opened further than this share of its length."""
_HINGE_SHARE = 1.5e-3
"""m²: how much of the rest hinge is added to the bent limb's own normal, which vanishes in a straight limb."""

LimbFix = tuple[Floats, Floats, Floats]


def _unit(v: Floats) -> tuple[Floats, Floats]:
    length = np.sqrt((v * v).sum(-1, keepdims=True)) + np.float32(1e-9)
    return v / length, length


def _about(axis: Floats, angle: Floats) -> Floats:
    half = np.float32(0.5) * angle
    q = np.empty((*half.shape[:-1], 4), dtype=np.float32)
    np.multiply(axis, np.sin(half), out=q[..., :3])
    q[..., 3:] = np.cos(half)
    return q


def _cross(a: Floats, b: Floats) -> Floats:
    # (y, z, x) rolls: half the cost of np.cross on tiny arrays.
    return np.asarray((a * b[..., _ROLL] - a[..., _ROLL] * b)[..., _ROLL])


_ROLL = np.array([1, 2, 0])
_ROLL.setflags(write=False)


def solve_limbs(
    root: Floats, joint: Floats, end: Floats, target: Floats, hinge: Floats, soft: NDArray[np.bool_] | None = None
) -> LimbFix:
    """Move the ends of limbs (n, K, 3) to targets.

    root, joint, end: shoulder, elbow and wrist (hip, knee, ankle) as they are; hinge: unit axis that bends a
    straight limb; soft: (K,) limbs whose reach is softly clamped. All in model space.
    -> rotation of the upper bone (n, K, 4), further rotation of the lower bone about the elbow (n, K, 4), applied
    first, and the reached ends (n, K, 3).
    """
    upper, lower, way = joint - root, end - joint, end - root
    wanted = target - root
    limbs = np.stack([upper, lower, way, wanted])
    lengths = np.sqrt((limbs * limbs).sum(-1, keepdims=True)) + np.float32(1e-9)
    a, b, present, distance = lengths
    full = a + b
    reach = np.minimum(distance, STRAIGHTEST * full)
    if soft is not None:
        knee, most = REACH_SOFT * full, REACH_FULL * full
        over = np.maximum(distance - knee, 0.0)
        clamped = np.minimum(distance, knee + (most - knee) * (1.0 - np.exp(-over / (most - knee))))
        reach = np.where(soft[:, None], np.minimum(clamped, reach), reach)
    reach = np.maximum(reach, np.abs(a - b) + np.float32(1e-4))
    sides = np.stack([present, reach])
    # Law of cosines before and after: the angle at the root, and the one inside the elbow.
    at_root = (a * a + sides * sides - b * b) / (2.0 * a * sides)
    at_joint = (a * a + b * b - sides * sides) / (2.0 * a * b)
    angles = np.arccos(np.clip(np.stack([at_root, at_joint]), -1.0, 1.0))
    bend = angles[:, 1] - angles[:, 0]
    normal, _ = _unit(_cross(way, upper) + np.float32(_HINGE_SHARE) * hinge)
    open_root, open_joint = _about(normal, bend)
    both = bl.multiply(open_root, open_joint)
    parts = bl.rotation_matrix(np.stack([open_root, both]))
    reached = (parts[0] @ upper[..., None] + parts[1] @ lower[..., None])[..., 0]
    swing = _between(reached / (np.sqrt((reached * reached).sum(-1, keepdims=True)) + 1e-9), wanted / distance)
    return bl.multiply(swing, open_root), open_joint, root + wanted * (reach / distance)


def _between(a: Floats, b: Floats) -> Floats:
    """Smallest rotation from unit a to unit b (not opposite), (..., 3) each."""
    q = np.empty((*a.shape[:-1], 4), dtype=np.float32)
    q[..., :3] = _cross(a, b)
    q[..., 3] = 1.0 + (a * b).sum(-1)
    q[..., 3] = np.maximum(q[..., 3], 1e-4)
    return bl.normalize(q)
