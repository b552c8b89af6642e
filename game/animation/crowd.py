"""Skinning matrices of many characters: every matrix element is an array over the crowd.

NumPy multiplies thousands of small matrices one by one; multiplying the elements as long arrays is several times
faster. The crowd is cut into pieces that stay in the cache.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from game.animation.pose import Pose

if TYPE_CHECKING:
    from game.animation.skinning import Rig

__all__ = ["crowd_matrices"]

Floats = NDArray[np.floating[Any]]

PIECE = 128
"""Characters per piece."""


def crowd_matrices(rig: Rig, pose: Pose) -> Floats:
    """(n, K, 4, 4) skin matrices, springs at rest; the same as rig.skin_matrices(rig.joint_matrices(pose))."""
    n, columns = len(pose), len(rig.skin_joint)
    result = np.empty((n, columns, 4, 4), dtype=np.float32)
    rotation, root = rig.local_rotations(pose), rig.root_translation(pose)
    for start in range(0, n, PIECE):
        piece = slice(start, min(start + PIECE, n))
        quaternion = np.ascontiguousarray(rotation[piece].transpose(2, 1, 0))
        turn, place = _model(rig, quaternion, root[piece].T)
        result[piece] = _skinned(rig, turn, place).transpose(3, 2, 0, 1)
    return result


def _model(rig: Rig, q: Floats, root: Floats) -> tuple[Floats, Floats]:
    """q: (4, J, m) local, root: (3, m) -> model-space rotations (3, 3, J, m) and positions (3, J, m)."""
    local = _turns(q)
    skeleton = rig.skeleton
    turn = np.empty_like(local)
    place = np.empty((3, *q.shape[1:]), dtype=np.float32)
    shift = skeleton.rest_translation.T.astype(np.float32)[:, :, None]
    hips = rig.hips
    for level in skeleton.levels:
        parent = skeleton.parents[level]
        if parent[0] < 0:
            turn[:, :, level] = local[:, :, level]
            place[:, level] = root[:, None] if hips in level else shift[:, level]
            continue
        above, here = turn[:, :, parent], local[:, :, level]
        product = above[:, 0, None] * here[None, 0]
        for k in (1, 2):
            product += above[:, k, None] * here[None, k]
        turn[:, :, level] = product
        offset = shift[:, level]
        if hips in level:
            offset = np.repeat(offset, root.shape[1], axis=2)
            offset[:, np.flatnonzero(level == hips)[0]] = root
        moved = above[:, 0] * offset[0]
        for k in (1, 2):
            moved += above[:, k] * offset[k]
        place[:, level] = place[:, parent] + moved
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


def _skinned(rig: Rig, turn: Floats, place: Floats) -> Floats:
    """Model-space (3, 3, J, m), (3, J, m) -> (4, 4, K, m) skin matrices."""
    bind = rig.inverse_bind.transpose(1, 2, 0)[..., None]
    turn, place = turn[:, :, rig.skin_joint], place[:, rig.skin_joint]
    skin = np.empty((4, 4, *place.shape[1:]), dtype=np.float32)
    top = skin[:3]
    np.multiply(turn[:, 0, None], bind[None, 0], out=top)
    for k in (1, 2):
        top += turn[:, k, None] * bind[None, k]
    top[:, 3] += place
    skin[3] = np.array([0.0, 0.0, 0.0, 1.0], dtype=np.float32)[:, None, None]
    return skin
