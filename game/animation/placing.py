"""Hands and feet to where they belong: the local rotations of arms and legs that a solved limb asks for."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import bilinear as bl
from game.animation import figure
from game.animation.limbs import HINGE_WEIGHT_M, Limbs, solve_limbs

__all__ = ["place_limbs"]

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.intp]

_AXIS = ((1, 1.0), (1, -1.0), (0, -1.0), (0, -1.0))
"""Axis of the upper bone's frame, and its sign, about which a straight limb opens: elbows bend forward, knees back."""


def _elements(rows: slice, columns: slice | int, slots: slice) -> Ints:
    """Places of matrices' elements in (20 · 16) numbers, (rows[, columns], slots)."""
    every = np.arange(20 * 16).reshape(20, 4, 4)[slots, rows, columns]
    return np.ascontiguousarray(np.moveaxis(every, 0, -1))


_POINTS = _elements(slice(3), 3, slice(4, 20)).reshape(3, 4, 4)
_HINGE = np.stack([_elements(slice(3), axis, slice(4, 8))[:, k] for k, (axis, _) in enumerate(_AXIS)], axis=-1)
_HINGE_M = np.tile(np.array([sign * HINGE_WEIGHT_M for _, sign in _AXIS], dtype=np.float32)[:, None], (3, 1, 1))
# A vector v of a correction in a bone's frame R is Rᵀv: nine products, R_ij·v_i by j and i.
_FRAMES = _elements(slice(3), slice(3), slice(12)).transpose(1, 0, 2).reshape(9, 12)
_SUM_OF_THREE = np.repeat(np.eye(3, dtype=np.float32), 3, axis=1)
# Turns are five for each limb: about its normal of upper bone, joint and lower bone, then the bones' swung as well.
_TURNS = np.arange(80).reshape(4, 5, 4)[:, [3, 1, 4]].reshape(4, 12)
_VECTORS = np.tile(_TURNS[:3], (3, 1))
_LOWER, _ = bl.in_pairs(_elements(slice(3), slice(3), slice(8, 12)), 15)
_, _WANTED = bl.in_pairs(_elements(slice(3), slice(3), slice(16, 20)), 15)
_ENDS = figure.ENDS.reshape(-1)
_LOCAL = 4 * _ENDS + np.arange(4)[:, None]
for _array in (_POINTS, _HINGE, _HINGE_M, _FRAMES, _SUM_OF_THREE, _TURNS, _VECTORS, _LOWER, _WANTED, _ENDS, _LOCAL):
    _array.setflags(write=False)


def place_limbs(limbs: Limbs, rotation: Floats, bones: Floats) -> None:
    """Arms to their hands, legs to their feet: rewrites the twelve joints of the limbs in rotation (n, 41, 4).

    bones: (n, 20, 4, 4) matrices of figure.BONES as they are, then of both hands and both feet as they shall be, all in
    model space.
    """
    # Here the characters are the last axis: what is done to all of them is done to long rows.
    n = len(rotation)
    elements = bones.reshape(n, -1).T
    hinge = elements.take(_HINGE, axis=0)
    hinge *= _HINGE_M
    opened, swing = solve_limbs(limbs, elements.take(_POINTS, axis=0), hinge)
    turns = np.empty((4, 5, 4, n), dtype=np.float32)
    turns[:, :3] = opened
    turns[:, 3:] = bl.product(swing[:, None], opened[:, ::2])
    # A correction c in model space is RᵀcR in a frame R. The upper bone's is seen from what it hangs on, the joint's
    # from the upper bone, the lower bone's from itself: the end has to take that one back.
    all_turns = turns.reshape(80, n)
    fix, vectors = all_turns.take(_TURNS, axis=0), all_turns.take(_VECTORS, axis=0)
    vectors *= elements.take(_FRAMES, axis=0)
    np.matmul(_SUM_OF_THREE, vectors.reshape(9, -1), out=fix[:3].reshape(3, -1))
    back = fix[3, 8:]
    np.negative(back, out=back)
    now = rotation.reshape(n, -1).T.take(_LOCAL, axis=0)
    now[:, 8:] = bl.back_and_forth(elements, _LOWER, _WANTED)
    rotation[:, _ENDS] = bl.product(fix, now).transpose(2, 1, 0)
