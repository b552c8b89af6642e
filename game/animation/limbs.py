"""Two-bone inverse kinematics for all four limbs at once, as corrections of the pose that is already there.

The clip's own elbow and knee directions are kept: the limb is opened or closed about its present hinge and then
swung to the target, so a target where the limb already ends changes nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import bilinear as bl

__all__ = ["REACH_FULL", "REACH_SOFT", "Limbs", "limbs_of", "solve_limbs"]

Floats = NDArray[np.floating[Any]]

REACH_SOFT, REACH_FULL = 0.93, 0.985
"""Shares of an arm's length between which its reach is softly clamped (MOTION.md, contacts)."""
STRAIGHT_SOFT, STRAIGHT_FULL = 0.999, 0.9998
"""The same for legs, which stand straight at rest."""
_HINGE_SHARE = 1.5e-3
"""m²: how much of the rest hinge is added to the bent limb's own normal, which vanishes in a straight limb."""

# V = _WAYS @ points: upper bone, lower bone, present way, wanted way from the points root, joint, end, target.
_WAYS = np.array([[-1, 1, 0, 0], [0, -1, 1, 0], [-1, 0, 1, 0], [-1, 0, 0, 1]], dtype=np.float32)
# v @ _SKEW is the matrix that takes the cross product with v.
_SKEW = np.array([[0, 0, 0, 0, 0, -1, 0, 1, 0], [0, 0, 1, 0, 0, 0, -1, 0, 0], [0, -1, 0, 1, 0, 0, 0, 0, 0]], np.float32)
# Sums over the last axis as products: a reduction of three numbers costs NumPy three times as much.
_SUM = np.ones(3, dtype=np.float32)
_SUM_TO_COLUMN = np.ones((3, 1), dtype=np.float32)
for _table in (_WAYS, _SKEW, _SUM, _SUM_TO_COLUMN):
    _table.setflags(write=False)


@dataclass(frozen=True, eq=False)
class Limbs:
    """Constants of K limbs. knee, room: (K,) where the clamp of the reach begins and how far it lets through, metres.
    For the law of cosines over (root, joint) × before and after: see _angles."""

    knee: Floats
    room: Floats
    least: Floats
    square: Floats
    divide: Floats


def limbs_of(upper_m: Floats, lower_m: Floats, soft: NDArray[np.bool_]) -> Limbs:
    """upper_m, lower_m: (K,) bone lengths; soft: (K,) True for arms."""
    full = upper_m + lower_m
    knee = np.where(soft, REACH_SOFT, STRAIGHT_SOFT) * full
    most = np.where(soft, REACH_FULL, STRAIGHT_FULL) * full
    return Limbs(
        knee=knee.astype(np.float32),
        room=(most - knee).astype(np.float32),
        least=(np.abs(upper_m - lower_m) + 1e-3).astype(np.float32),
        square=np.stack([upper_m**2 - lower_m**2, upper_m**2 + lower_m**2]).astype(np.float32),
        divide=np.stack([0.5 / upper_m, -0.5 / (upper_m * lower_m)]).astype(np.float32),
    )


def solve_limbs(limbs: Limbs, points: Floats, hinge: Floats) -> Floats:
    """Move the ends of limbs to targets.

    points: (n, 4, K, 3) root, joint and end as they are (shoulder, elbow, wrist), and the target; hinge: (n, K, 3)
    unit axis that bends a straight limb. Model space, metres.
    -> (n, 2, K, 4) rotations in model space that take the upper and the lower bone to their new directions.
    """
    n, _, k, _ = points.shape
    ways = (_WAYS @ points.reshape(n, 4, 3 * k)).reshape(n, 4, k, 3)
    far = ways[:, 2:]
    reach = np.sqrt((far * far) @ _SUM) + np.float32(1e-6)
    along = far / reach[..., None]
    # Both reaches as the law of cosines sees them; the wanted one is clamped.
    over = np.maximum(reach[:, 1] - limbs.knee, np.float32(0.0)) / limbs.room
    wanted = np.minimum(reach[:, 1], limbs.knee) - limbs.room * np.expm1(-over)
    np.maximum(wanted, limbs.least, out=reach[:, 1])
    angles = _angles(limbs, reach)
    turn = np.empty((n, 3, k), dtype=np.float32)
    np.subtract(angles[:, :, 1], angles[:, :, 0], out=turn[:, :2])
    # The lower bone turns with the upper one and about the joint, both about the limb's normal.
    np.add(turn[:, 0], turn[:, 1], out=turn[:, 1])
    turn = turn[:, :2] * np.float32(0.5)
    crosses = (along[:, 0] @ _SKEW).reshape(n, k, 3, 3) @ _columns(ways[:, 0], along[:, 1])
    normal = crosses[..., 0] + np.float32(_HINGE_SHARE) * hinge
    normal /= np.sqrt((normal * normal) @ _SUM_TO_COLUMN) + np.float32(1e-9)
    opened = np.empty((n, 2, k, 4), dtype=np.float32)
    np.multiply(normal[:, None], np.sin(turn)[..., None], out=opened[..., :3])
    np.cos(turn, out=opened[..., 3])
    # Opening leaves the end on the way where it was: what is left is to swing that way to the wanted one.
    swing = np.empty((n, k, 4), dtype=np.float32)
    swing[..., :3] = crosses[..., 1]
    # Just above 1: opposite directions leave a rotation to normalise.
    np.add((along[:, 0] * along[:, 1]) @ _SUM, np.float32(1.0001), out=swing[..., 3])
    return bl.multiply(bl.normalize(swing)[:, None], opened)


def _columns(a: Floats, b: Floats) -> Floats:
    """Two vectors (n, K, 3) side by side, (n, K, 3, 2)."""
    both = np.empty((*a.shape, 2), dtype=np.float32)
    both[..., 0], both[..., 1] = a, b
    return both


def _angles(limbs: Limbs, reach: Floats) -> Floats:
    """reach: (n, 2, K) -> (n, 2, 2, K) interior angles at root and joint, before and after."""
    square = reach * reach
    cosine = np.empty((len(reach), 2, *reach.shape[1:]), dtype=np.float32)
    np.divide(square + limbs.square[0], reach, out=cosine[:, 0])
    np.subtract(square, limbs.square[1], out=cosine[:, 1])
    cosine *= limbs.divide[:, None]
    np.minimum(cosine, np.float32(1.0), out=cosine)
    np.maximum(cosine, np.float32(-1.0), out=cosine)
    return np.asarray(np.arccos(cosine))
