"""Two-bone inverse kinematics for all four limbs at once, as corrections of the pose that is already there.

The clip's own elbow and knee directions are kept: the limb is opened or closed about its present hinge and then
swung to the target, so a target where the limb already ends changes nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["ARM", "HINGE_WEIGHT_M", "STRAIGHT", "Limbs", "limbs_of", "solve_limbs"]

Floats = NDArray[np.floating[Any]]

ARM = (0.93, 0.985)
"""Shares of an arm's length between which its reach is softly clamped (MOTION.md, contacts)."""
STRAIGHT = (0.999, 0.9998)
"""The same for legs, which stand straight at rest."""
HINGE_WEIGHT_M = 1.5e-3
"""How much of the rest hinge is added to the bent limb's own normal (metres, upper bone × direction), which vanishes
in a straight limb."""

# From the interior angles (root before and after, joint before and after) to half the turns of the upper bone, of the
# joint, and of the lower bone, which does both: all about the limb's normal.
_HALVES = np.array([[-0.5, 0.5, 0, 0], [0, 0, -0.5, 0.5], [-0.5, 0.5, -0.5, 0.5]], dtype=np.float32)


def _bilinear_tables() -> tuple[Floats, Floats]:
    """(42, 12), (9, 21): a limb's four points -> the left and the right factors of 21 products -> what a solution needs
    of them: squared reach before and after, way to the end across the upper bone and across the way to the target, dot
    product of these two ways."""
    upper, now, goal = range(3)
    across = [(1, 2), (2, 0), (0, 1)]
    # (row, sign, way, axis, way, axis)
    terms = [(row, 1, way, i, way, i) for row, way in ((0, now), (1, goal)) for i in range(3)]
    for row, way in ((2, upper), (5, goal)):
        terms += [(row + k, 1, now, i, way, j) for k, (i, j) in enumerate(across)]
        terms += [(row + k, -1, now, j, way, i) for k, (i, j) in enumerate(across)]
    terms += [(8, 1, now, i, goal, i) for i in range(3)]
    factors = np.zeros((2, len(terms), 3, 4), dtype=np.float32)
    sums = np.zeros((9, len(terms)), dtype=np.float32)
    for term, (row, sign, left, i, right, j) in enumerate(terms):
        sums[row, term] = sign
        for side, way, axis in ((0, left, i), (1, right, j)):
            factors[side, term, axis, way + 1] += 1
            factors[side, term, axis, 0] -= 1
    return factors.reshape(-1, 12), sums


def _norms() -> Floats:
    """(7, 7): squares of a vector and a quaternion -> the squared norm of each beside each of its components."""
    table = np.zeros((7, 7), dtype=np.float32)
    table[:3, :3] = table[3:, 3:] = 1.0
    return table


_FACTORS, _SUMS = _bilinear_tables()
_NORMS = _norms()
_TERMS = _SUMS.shape[1]
# NumPy is slower with Python's numbers.
_NONE, _ONE, _LEAST_COSINE = (np.array(x, dtype=np.float32) for x in (0.0, 1.0, -1.0))
_LEAST_M = np.array(1e-6, dtype=np.float32)
_JUST_ABOVE_1 = np.array(1.0001, dtype=np.float32)
for _table in (_HALVES, _FACTORS, _SUMS, _NORMS, _NONE, _ONE, _LEAST_COSINE, _LEAST_M, _JUST_ABOVE_1):
    _table.setflags(write=False)


@dataclass(frozen=True, eq=False)
class Limbs:
    """Constants of K limbs. knee, room: (K, 1) where the clamp of the reach begins and how far it lets through, metres;
    steep: −1 / room. least: (K, 1) shortest reach. For the law of cosines at root and joint, before and after: more:
    (2, K, 1), both: (2, K, 1), divide: (2, 2, K, 1); see _angles."""

    knee: Floats
    room: Floats
    steep: Floats
    least: Floats
    more: Floats
    both: Floats
    divide: Floats


def limbs_of(upper_m: Floats, lower_m: Floats, reach: Floats) -> Limbs:
    """upper_m, lower_m: (K,) bone lengths; reach: (K, 2) shares of both together, where a limb begins to give way and
    where it is as long as it gets."""
    knee, most = (upper_m + lower_m) * reach.T
    more, both = upper_m**2 - lower_m**2, upper_m**2 + lower_m**2
    divide = np.stack([0.5 / upper_m, 0.5 / (upper_m * lower_m)])
    return Limbs(
        knee=_columns(knee),
        room=_columns(most - knee),
        steep=_columns(-1.0 / (most - knee)),
        least=_columns(np.abs(upper_m - lower_m) + 1e-3),
        more=_columns(np.stack([more, more])),
        both=_columns(np.stack([both, both])),
        divide=_columns(np.stack([divide, divide], axis=1)),
    )


def _columns(array: Floats) -> Floats:
    return np.ascontiguousarray(array[..., None], dtype=np.float32)


def solve_limbs(limbs: Limbs, points: Floats, hinge: Floats) -> tuple[Floats, Floats]:
    """Move the ends of limbs to targets.

    points: (3, 4, K, n) root, joint and end as they are (shoulder, elbow, wrist), and the target; hinge: (3, K, n)
    axis that bends a straight limb, as long as it shall count. Model space, metres.
    -> (4, 3, K, n) turns about the limb's normal of the upper bone, of the joint, and of the lower bone, which does
    both; and (4, K, n) the turn after it that swings the opened limb to the target, all in model space.
    """
    k, n = points.shape[2:]
    factors = _FACTORS @ points.reshape(12, -1)
    found = _SUMS @ (factors[:_TERMS] * factors[_TERMS:])
    reach = np.sqrt(found[:2])
    reach += _LEAST_M
    # Opening leaves the end on the way where it was: what is left is to swing that way to the wanted one. Just above 1:
    # opposite directions leave a rotation to normalise.
    over = reach[0] * reach[1]
    over *= _JUST_ABOVE_1
    found[8] += over
    found[2:5] += (hinge * reach[0].reshape(k, n)).reshape(3, -1)
    turns = found[2:]
    turns /= np.sqrt(_NORMS @ (turns * turns))
    reach = reach.reshape(2, k, n)
    reach[1] = _clamped(limbs, reach[1])
    half = _HALVES @ _angles(limbs, reach).reshape(4, -1)
    opened = np.empty((4, 3, k * n), dtype=np.float32)
    np.multiply(turns[:3, None], np.sin(half), out=opened[:3])
    np.cos(half, out=opened[3])
    return opened.reshape(4, 3, k, n), turns[3:].reshape(4, k, n)


def _clamped(limbs: Limbs, reach: Floats) -> Floats:
    """(K, n) as far as a limb reaches, softly."""
    over = reach - limbs.knee
    np.maximum(over, _NONE, out=over)
    over *= limbs.steep
    np.expm1(over, out=over)
    over *= limbs.room
    clamped = np.minimum(reach, limbs.knee)
    clamped -= over
    return np.maximum(clamped, limbs.least, out=clamped)


def _angles(limbs: Limbs, reach: Floats) -> Floats:
    """reach: (2, K, n) -> (2, 2, K, n) interior angles at root and joint, before and after."""
    cosine = np.empty((2, *reach.shape), dtype=np.float32)
    square = np.multiply(reach, reach, out=cosine[1])
    root = np.add(square, limbs.more, out=cosine[0])
    root /= reach
    np.subtract(limbs.both, square, out=square)
    cosine *= limbs.divide
    np.minimum(cosine, _ONE, out=cosine)
    np.maximum(cosine, _LEAST_COSINE, out=cosine)
    return np.asarray(np.arccos(cosine, out=cosine))
