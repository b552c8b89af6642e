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

__all__ = ["HINGE_WEIGHT_M", "REACH_FULL", "REACH_SOFT", "Limbs", "limbs_of", "solve_limbs"]

Floats = NDArray[np.floating[Any]]

REACH_SOFT, REACH_FULL = 0.93, 0.985
"""Shares of an arm's length between which its reach is softly clamped (MOTION.md, contacts)."""
STRAIGHT_SOFT, STRAIGHT_FULL = 0.999, 0.9998
"""The same for legs, which stand straight at rest."""
HINGE_WEIGHT_M = 1.5e-3
"""How much of the rest hinge is added to the bent limb's own normal (metres, upper bone × direction), which vanishes
in a straight limb."""

# Cross products: both factors' components in the orders y z x and z x y.
_CYCLES = np.array([1, 2, 0, 2, 0, 1])
# Sums over the last axis as products: a reduction of three numbers costs NumPy three times as much.
_SUM = np.ones(3, dtype=np.float32)
_SUM_TO_COLUMN = np.ones((3, 1), dtype=np.float32)
# From the interior angles (root before and after, joint before and after) to half the turns of the upper bone, of the
# joint, and of the lower bone, which does both: all about the limb's normal.
_HALVES = np.array([[-0.5, 0.5, 0, 0], [0, 0, -0.5, 0.5], [-0.5, 0.5, -0.5, 0.5]], dtype=np.float32)
for _table in (_CYCLES, _SUM, _SUM_TO_COLUMN, _HALVES):
    _table.setflags(write=False)


@dataclass(frozen=True, eq=False)
class Limbs:
    """Constants of K limbs. knee, room: (K,) where the clamp of the reach begins and how far it lets through, metres;
    steep: −1 / room. least: (K,) shortest reach. For the law of cosines over (root, joint) × before and after: square,
    (2, K), and divide, (2, 1, K): see _angles."""

    knee: Floats
    room: Floats
    steep: Floats
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
        steep=(-1.0 / (most - knee)).astype(np.float32),
        least=(np.abs(upper_m - lower_m) + 1e-3).astype(np.float32),
        square=np.stack([upper_m**2 - lower_m**2, upper_m**2 + lower_m**2]).astype(np.float32),
        divide=np.stack([0.5 / upper_m, -0.5 / (upper_m * lower_m)])[:, None].astype(np.float32),
    )


def solve_limbs(limbs: Limbs, points: Floats, hinge: Floats) -> tuple[Floats, Floats]:
    """Move the ends of limbs to targets.

    points: (n, 4, K, 3) root, joint and end as they are (shoulder, elbow, wrist), and the target; hinge: (n, K, 3)
    axis that bends a straight limb, as long as it shall count. Model space, metres.
    -> (n, 2, K, 4) rotations in model space that take the upper and the lower bone to their new directions, and
    (n, K, 4) the joint's own share in the latter: the lower bone's is the upper bone's, and before it this.
    """
    n, _, k, _ = points.shape
    # Upper bone, then the present and the wanted way to the end.
    ways = points[:, 1:] - points[:, :1]
    far = ways[:, 1:]
    reach = np.sqrt((far * far) @ _SUM)
    reach += 1e-6
    far /= reach[..., None]
    # Both reaches as the law of cosines sees them; the wanted one is clamped.
    wanted = reach[:, 1]
    clamped = np.expm1(np.maximum(wanted - limbs.knee, 0.0) * limbs.steep)
    clamped *= limbs.room
    np.maximum(np.minimum(wanted, limbs.knee) - clamped, limbs.least, out=wanted)
    half = _HALVES @ _angles(limbs, reach).reshape(n, 4, k)
    crosses = _crosses(ways)
    normal = crosses[:, 0]
    normal += hinge
    normal /= np.sqrt((normal * normal) @ _SUM_TO_COLUMN) + 1e-9
    opened = np.empty((n, 3, k, 4), dtype=np.float32)
    np.multiply(normal[:, None], np.sin(half)[..., None], out=opened[..., :3])
    np.cos(half, out=opened[..., 3])
    # Opening leaves the end on the way where it was: what is left is to swing that way to the wanted one.
    swing = np.empty((n, k, 4), dtype=np.float32)
    swing[..., :3] = crosses[:, 1]
    # Just above 1: opposite directions leave a rotation to normalise.
    np.add((far[:, 0] * far[:, 1]) @ _SUM, 1.0001, out=swing[..., 3])
    return bl.multiply(bl.normalize(swing)[:, None], opened[:, ::2]), opened[:, 1]


def _crosses(ways: Floats) -> Floats:
    """ways: (n, 3, K, 3) -> (n, 2, K, 3) the second across the first and across the third."""
    cycles = ways.take(_CYCLES, axis=-1)
    a, b = cycles[:, 1:2], cycles[:, ::2]
    product = a[..., :3] * b[..., 3:]
    product -= a[..., 3:] * b[..., :3]
    return np.asarray(product)


def _angles(limbs: Limbs, reach: Floats) -> Floats:
    """reach: (n, 2, K) -> (n, 2, 2, K) interior angles at root and joint, before and after."""
    square = reach * reach
    cosine = np.empty((len(reach), 2, *reach.shape[1:]), dtype=np.float32)
    np.divide(square + limbs.square[0], reach, out=cosine[:, 0])
    np.subtract(square, limbs.square[1], out=cosine[:, 1])
    cosine *= limbs.divide
    np.minimum(cosine, 1.0, out=cosine)
    np.maximum(cosine, np.float32(-1.0), out=cosine)
    return np.asarray(np.arccos(cosine, out=cosine))
