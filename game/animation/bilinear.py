"""Quaternion products and matrices as constant bilinear maps: two array calls each, for one character or many.

Written for frames: float32, batch axes lead, no temporaries on Python's side. game.core.quaternion has the
same operations for everything that is not in the inner loop.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "affine",
    "back_and_forth",
    "conjugate",
    "from_matrix",
    "in_pairs",
    "multiply",
    "normalize",
    "product",
    "rotation_matrix",
]

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.intp]


def _left_table() -> Floats:
    """(4, 16): a @ table is the 4×4 matrix L(a) with L(a) b = a·b (x, y, z, w order)."""
    table = np.zeros((4, 4, 4), dtype=np.float32)
    x, y, z, w = range(4)
    for out, left, right, sign in (
        (x, w, x, 1), (x, x, w, 1), (x, y, z, 1), (x, z, y, -1),
        (y, w, y, 1), (y, x, z, -1), (y, y, w, 1), (y, z, x, 1),
        (z, w, z, 1), (z, x, y, 1), (z, y, x, -1), (z, z, w, 1),
        (w, w, w, 1), (w, x, x, -1), (w, y, y, -1), (w, z, z, -1),
    ):  # fmt: skip
        table[left, out, right] = sign
    return table.reshape(4, 16)


def _matrix_tables() -> tuple[Floats, Floats]:
    """(4, 20) and (10, 16): q @ the first are the left and the right factors of q's ten products, the products @ the
    second the 4×4 affine matrix of a unit quaternion, without translation."""
    x, y, z, w = range(4)
    pairs = ((x, x), (y, y), (z, z), (w, w), (x, y), (y, z), (z, x), (x, w), (y, w), (z, w))
    factors = np.zeros((4, 2, 10), dtype=np.float32)
    table = np.zeros((10, 4, 4), dtype=np.float32)
    for product, (left, right) in enumerate(pairs):
        factors[left, 0, product] = factors[right, 1, product] = 1
    for i, (j, k) in enumerate(((y, z), (z, x), (x, y))):
        # Homogeneous form: the diagonal is w² + i² − j² − k², so no constant term is needed.
        table[3, i, i] = table[i, i, i] = 1
        table[j, i, i] = table[k, i, i] = -1
        table[4 + i, i, j] = table[4 + i, j, i] = 2
        table[7 + k, i, j] = -2
        table[7 + k, j, i] = 2
    table[:4, 3, 3] = 1
    return factors.reshape(4, 20), table.reshape(10, 16)


def _candidates_table() -> tuple[Floats, Floats]:
    """(9, 16) and (16,): a rotation matrix @ table + constant is outer(q, q)·4, whose rows are all ±q scaled."""
    table = np.zeros((3, 3, 4, 4), dtype=np.float32)
    constant = np.eye(4, dtype=np.float32)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        table[i, i, i, i] = 1
        table[j, j, i, i] = table[k, k, i, i] = -1
        table[i, i, 3, 3] = 1
        table[i, j, i, j] = table[j, i, i, j] = table[i, j, j, i] = table[j, i, j, i] = 1
        table[k, j, i, 3] = table[k, j, 3, i] = 1
        table[j, k, i, 3] = table[j, k, 3, i] = -1
    return table.reshape(9, 16), constant.reshape(16)


_LEFT = _left_table()
# (4, 16): the products of two quaternions' components -> their product.
_PAIRS = np.ascontiguousarray(_LEFT.reshape(4, 4, 4).transpose(1, 0, 2)).reshape(4, 16)
_FACTORS, _MATRIX = _matrix_tables()
_CANDIDATES, _CANDIDATES_AT_ZERO = _candidates_table()
# Which components of a and of b the 16 products take.
_LEFT_OF_PAIR, _RIGHT_OF_PAIR = np.repeat(np.arange(4), 4), np.tile(np.arange(4), 4)


def _candidates_of_pairs() -> Floats:
    """(16, 28): from 27 products B_ij·F_ik, and 1, to outer(q, q)·4 of BᵀF."""
    sums = np.broadcast_to(np.eye(9, dtype=np.float32).reshape(9, 1, 9), (9, 3, 9)).reshape(9, 27)
    return np.concatenate([_CANDIDATES.T @ sums, _CANDIDATES_AT_ZERO[:, None]], axis=1)


_CANDIDATES_OF_PAIRS = _candidates_of_pairs()
_COMPONENTS = np.arange(4)[:, None]
_SUM = np.ones((4, 4), dtype=np.float32)
_CONJUGATE = np.array([-1, -1, -1, 1], dtype=np.float32)
for _table in (
    _LEFT,
    _PAIRS,
    _LEFT_OF_PAIR,
    _RIGHT_OF_PAIR,
    _CANDIDATES_OF_PAIRS,
    _COMPONENTS,
    _FACTORS,
    _MATRIX,
    _CANDIDATES,
    _CANDIDATES_AT_ZERO,
    _SUM,
    _CONJUGATE,
):
    _table.setflags(write=False)


def multiply(a: Floats, b: Floats) -> Floats:
    """a·b (b first), (..., 4) each."""
    left = (a @ _LEFT).reshape(*a.shape[:-1], 4, 4)
    return np.asarray((left @ b[..., None])[..., 0])


def conjugate(q: Floats) -> Floats:
    """The inverse of a unit quaternion."""
    return q * _CONJUGATE


def normalize(q: Floats) -> Floats:
    """(..., 4) -> unit length; q must not be zero."""
    return np.asarray(q / np.sqrt((q * q) @ _SUM))


def affine(q: Floats, out: Floats | None = None) -> Floats:
    """Unit quaternions (..., 4) -> (..., 4, 4) affine matrices with zero translation; out: (..., 16) to write to."""
    factors = q @ _FACTORS
    matrix = np.matmul(factors[..., :10] * factors[..., 10:], _MATRIX, out=out)
    return np.asarray(matrix.reshape(*q.shape[:-1], 4, 4))


def rotation_matrix(q: Floats) -> Floats:
    """Unit quaternions (..., 4) -> (..., 3, 3), a view of affine(q)."""
    return affine(q)[..., :3, :3]


def product(a: Floats, b: Floats) -> Floats:
    """a·b (b first), (4, ...) each, which broadcast: a component is a row over everything else."""
    pairs = a.take(_LEFT_OF_PAIR, axis=0) * b.take(_RIGHT_OF_PAIR, axis=0)
    return np.asarray((_PAIRS @ pairs.reshape(16, -1)).reshape(4, *pairs.shape[1:]))


def back_and_forth(elements: Floats, back: Ints, forth: Ints) -> Floats:
    """Unit quaternions (4, m, n), of either sign, of BᵀF. elements: (E, n) numbers; back, forth: (28, m) where among
    them B and F are (see in_pairs)."""
    candidates = _CANDIDATES_OF_PAIRS @ (elements.take(back, axis=0) * elements.take(forth, axis=0)).reshape(28, -1)
    best = candidates[::5].argmax(axis=0)
    # Any row of outer(q, q) is q up to scale; the one with the largest diagonal is the best conditioned.
    found = candidates[4 * best + _COMPONENTS, np.arange(len(best))]
    found /= np.sqrt(_SUM @ (found * found))
    return np.asarray(found.reshape(4, -1, elements.shape[1]))


def in_pairs(places: Ints, one: int) -> tuple[Ints, Ints]:
    """places: (3, 3, m) of matrices' elements -> (28, m) of the left and the right factors that back_and_forth asks
    for; one: place of a number that is 1."""
    m = places.shape[2]
    back = np.broadcast_to(places[:, :, None], (3, 3, 3, m)).reshape(27, m)
    forth = np.broadcast_to(places[:, None], (3, 3, 3, m)).reshape(27, m)
    ones = np.full((1, m), one)
    return np.concatenate([back, ones]), np.concatenate([forth, ones])


def from_matrix(matrix: Floats) -> Floats:
    """Rotation matrices (..., 3, 3) -> unit quaternions (..., 4); the sign is arbitrary."""
    rows = matrix.reshape(-1, 9) @ _CANDIDATES
    rows += _CANDIDATES_AT_ZERO
    # Any row of outer(q, q) is q up to scale; the one with the largest diagonal is the best conditioned.
    best = rows[:, ::5].argmax(axis=1)
    best += np.arange(0, 4 * len(rows), 4)
    return normalize(rows.reshape(-1, 4).take(best, axis=0)).reshape(*matrix.shape[:-2], 4)
