"""Skinning matrices of many characters: every matrix element is an array over the crowd.

NumPy multiplies thousands of small matrices one by one; multiplying the elements as long arrays is several times
faster. The crowd is cut into pieces that stay in the cache.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation.skin_plan import SkinPlan

__all__ = ["PIECE", "crowd_matrices"]

Floats = NDArray[np.floating[Any]]

PIECE = 128
"""Characters per piece."""


def crowd_matrices(plan: SkinPlan, rotation: Floats, root: Floats) -> Floats:
    """rotation: (n, M, 4) of the plan's joints, root: (n, 3) local translation of the hips -> (n, K, 4, 4) skin
    matrices."""
    n, columns = len(rotation), len(plan.column)
    result = np.empty((n, columns, 16), dtype=np.float32)
    for start in range(0, n, PIECE):
        piece = slice(start, min(start + PIECE, n))
        quaternion = np.ascontiguousarray(rotation[piece].transpose(2, 1, 0))
        turn, place = _model(plan, quaternion, root[piece].T)
        skin = _skinned(plan, turn, place)
        # In two steps: whole matrices of 64 bytes are moved in the second.
        rows = np.ascontiguousarray(skin.reshape(16, -1).T)
        result[piece] = rows.reshape(columns, -1, 16).transpose(1, 0, 2)
    return result.reshape(n, columns, 4, 4)


def _model(plan: SkinPlan, q: Floats, root: Floats) -> tuple[Floats, Floats]:
    """q: (4, M, m) local, root: (3, m) -> model-space rotations (3, 3, M, m) and positions (3, M, m)."""
    turn = _turns(q)
    place = np.empty((3, *q.shape[1:]), dtype=np.float32)
    place[:] = plan.shift.T[:, :, None]
    place[:, plan.hips] = root
    for level, parent in plan.chains.levels:
        above, here, offset = turn.take(parent, axis=2), turn[:, :, level], place[:, level]
        product, moved = above[:, 0, None] * here[None, 0], above[:, 0] * offset[0]
        for k in (1, 2):
            product += above[:, k, None] * here[None, k]
            moved += above[:, k] * offset[k]
        turn[:, :, level] = product
        np.add(place.take(parent, axis=1), moved, out=place[:, level])
    return turn, place


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


def _skinned(plan: SkinPlan, turn: Floats, place: Floats) -> Floats:
    """Model-space (3, 3, J, m), (3, J, m) -> (4, 4, K, m) skin matrices."""
    turn = turn.take(plan.column, axis=2)
    skin = np.empty((4, 4, *turn.shape[2:]), dtype=np.float32)
    top = np.multiply(turn[:, 0, None], plan.by_element[None, 0], out=skin[:3])
    for k in (1, 2):
        top += turn[:, k, None] * plan.by_element[None, k]
    top[:, 3] += place.take(plan.column, axis=1)
    skin[3, :3], skin[3, 3] = 0.0, 1.0
    return skin
