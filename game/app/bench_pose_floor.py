"""The floor of the pose benchmark: BENCH.md's work in NumPy, in the fewest array calls found and the best layout.

Three samples, a masked blend of three layers, local to model space, skinning matrices. Alone with matrices joint by
joint, in a crowd with every matrix element as an array over the characters, in pieces that stay in the cache.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.skeleton import Skeleton

__all__ = ["numpy_floor"]

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.intp]

_CROWD = 16
"""From this many characters on the number of matrices counts more than the number of calls."""
_PIECE = 128
"""Characters per piece."""


def numpy_floor(skeleton: Skeleton, clip: Floats, n: int) -> Callable[[], object]:
    """The work for n characters whose joints take their rotations from the joints of a clip (F, C, 4) in turn."""
    rng = np.random.default_rng(0)
    order = np.concatenate(skeleton.levels)
    count = len(order)
    rows = clip[:, order % clip.shape[1]].reshape(-1, 4 * count)
    frame = rng.integers(0, len(rows) - 2, (n, 3, 1)) + np.arange(2)
    part = rng.random((n, 3, 1)).astype(np.float32)
    mix = np.stack([1.0 - part, part], axis=-1)
    mask = np.repeat((rng.random((2, count)) < 0.4).astype(np.float32), 4, axis=1)
    gate = np.stack([(1.0 - mask[0]) * (1.0 - mask[1]), mask[0] * (1.0 - mask[1]), mask[1]])
    place = np.zeros(count, dtype=np.intp)
    place[order] = np.arange(count)
    parents = np.where(skeleton.parents[order] < 0, -1, place[skeleton.parents[order]])
    bind = np.linalg.inv(skeleton.rest_model)[order].astype(np.float32)
    shift = skeleton.rest_translation[order].astype(np.float32)
    passes, levels = _passes(parents), _levels(skeleton, parents)
    by_element = np.ascontiguousarray(bind[:, :3].transpose(1, 2, 0))[..., None]
    pieces = [slice(i, min(i + _PIECE, n)) for i in range(0, n, _PIECE)]

    def blended(some: slice) -> Floats:
        samples = (mix[some] @ rows.take(frame[some], axis=0))[:, :, 0]
        mixed = (samples * gate).sum(axis=1).reshape(-1, count, 4)
        return np.asarray(mixed / np.sqrt((mixed * mixed) @ _SUM))

    def alone() -> Floats:
        model = _affine(blended(slice(None)))
        model[:, :, :3, 3] = shift
        for joints, behind in passes:
            moved = model[:, joints]
            moved[:] = model.take(behind, axis=1) @ moved
        return np.asarray(model @ bind)

    def piece(some: slice) -> Floats:
        turn = _turns(np.ascontiguousarray(blended(some).transpose(2, 1, 0)))
        where = np.empty((3, *turn.shape[2:]), dtype=np.float32)
        where[:] = shift.T[:, :, None]
        for level, parent in levels:
            above, here, offset = turn.take(parent, axis=2), turn[:, :, level], where[:, level]
            product, moved = above[:, 0, None] * here[None, 0], above[:, 0] * offset[0]
            for k in (1, 2):
                product += above[:, k, None] * here[None, k]
                moved += above[:, k] * offset[k]
            turn[:, :, level] = product
            np.add(where.take(parent, axis=1), moved, out=where[:, level])
        return _skinned(turn, where, by_element)

    return alone if n < _CROWD else lambda: [piece(some) for some in pieces]


def _passes(parents: Ints) -> list[tuple[slice, Ints]]:
    """Pointer doubling: every pass doubles the way behind a joint's matrix (parent, then grandparent, ...)."""
    passes, relative = [], parents
    while relative.max() >= 0:
        first = int(np.argmax(relative >= 0))
        passes.append((slice(first, len(parents)), relative[first:]))
        relative = np.where(relative >= 0, relative[np.maximum(relative, 0)], -1)
    return passes


def _levels(skeleton: Skeleton, parents: Ints) -> list[tuple[slice, Ints]]:
    """Level by level: fewer matrices, more calls."""
    ends = np.cumsum([len(level) for level in skeleton.levels]).tolist()
    return [(slice(a, b), parents[a:b]) for a, b in pairwise(ends)]


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


_FACTORS, _MATRIX = _matrix_tables()
_SUM = np.ones((4, 4), dtype=np.float32)
for _table in (_FACTORS, _MATRIX, _SUM):
    _table.setflags(write=False)


def _affine(q: Floats) -> Floats:
    """(n, J, 4) -> (n, J, 4, 4)."""
    factors = q @ _FACTORS
    return np.asarray(((factors[..., :10] * factors[..., 10:]) @ _MATRIX).reshape(*q.shape[:-1], 4, 4))


def _turns(q: Floats) -> Floats:
    """(4, J, m) -> (3, 3, J, m)."""
    x, y, z, w = q
    twice = q + q
    xx, yy, zz = x * twice[0], y * twice[1], z * twice[2]
    xy, xz, yz = x * twice[1], x * twice[2], y * twice[2]
    wx, wy, wz = w * twice[0], w * twice[1], w * twice[2]
    turn = np.empty((3, 3, *x.shape), dtype=np.float32)
    one = np.float32(1.0)
    np.subtract(one - yy, zz, out=turn[0, 0])
    np.subtract(one - xx, zz, out=turn[1, 1])
    np.subtract(one - xx, yy, out=turn[2, 2])
    np.subtract(xy, wz, out=turn[0, 1])
    np.add(xz, wy, out=turn[0, 2])
    np.add(xy, wz, out=turn[1, 0])
    np.subtract(yz, wx, out=turn[1, 2])
    np.subtract(xz, wy, out=turn[2, 0])
    np.add(yz, wx, out=turn[2, 1])
    return turn


def _skinned(turn: Floats, place: Floats, bind: Floats) -> Floats:
    """Model-space (3, 3, J, m), (3, J, m), inverse bind matrices (3, 4, J, 1) -> (m, J, 16) skin matrices."""
    joints, many = turn.shape[2:]
    skin = np.empty((4, 4, joints, many), dtype=np.float32)
    top = np.multiply(turn[:, 0, None], bind[None, 0], out=skin[:3])
    for k in (1, 2):
        top += turn[:, k, None] * bind[None, k]
    top[:, 3] += place
    skin[3, :3], skin[3, 3] = 0.0, 1.0
    # In two steps: whole matrices of 64 bytes are moved in the second.
    rows = np.ascontiguousarray(skin.reshape(16, -1).T)
    return np.ascontiguousarray(rows.reshape(joints, many, 16).transpose(1, 0, 2))
