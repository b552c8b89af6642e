"""Hands stay out of the body and the table, softly: how far a wrist has to be pushed so that nothing is inside.

The body is a handful of ellipsoids on chest, spine, hips and head, the table a slab (MOTION.md, contacts). Depth
grows smoothly from before the touch and all contacts of a hand are weighed together, so the push has no jumps.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.humanoid import HEAD_CENTRE_OFFSET, REFERENCE, TABLE_FRONT_Z_M, TABLE_TOP_M

__all__ = ["BODY", "BODY_JOINTS", "POINT_RADII", "TABLE_BACK_Z_M", "body_distance", "body_frames", "push_out"]

Floats = NDArray[np.floating[Any]]

_REST = {name: REFERENCE.rest_model[i, :3, 3] for i, name in enumerate(REFERENCE.names)}
_HEAD = _REST["head"] + HEAD_CENTRE_OFFSET

BODY: tuple[tuple[str, tuple[float, float, float], tuple[float, float, float]], ...] = (
    ("chest", (0.0, 0.815, 0.0), (0.145, 0.145, 0.112)),
    ("chest", (0.0, 0.902, -0.008), (0.130, 0.060, 0.060)),
    ("spine", (0.0, 0.680, 0.0), (0.135, 0.140, 0.112)),
    ("hips", (0.0, 0.550, 0.0), (0.175, 0.120, 0.145)),
    ("head", (0.0, _HEAD[1] - 0.03, _HEAD[2] + 0.01), (0.150, 0.155, 0.150)),
    ("head", (0.0, _HEAD[1] + 0.02, _HEAD[2] - 0.015), (0.186, 0.178, 0.180)),
)
"""Joint, centre in the rest pose, radii: metres."""

POINT_RADII = np.array([0.027, 0.024, 0.012, 0.011, 0.011, 0.011, 0.036], dtype=np.float32)
"""Wrist, palm, middle knuckle, tips of middle, index and little finger, middle of the forearm: metres."""
TOLERANCE_M = np.array([0.006, 0.006, 0.006, 0.006, 0.006, 0.006, 0.020], dtype=np.float32)
"""How deep each may press into the (soft) body."""
TABLE_BACK_Z_M = 0.155
TABLE_CLEARANCE_M = 0.004
SOFTNESS_M = 0.006
"""The push begins this far before the touch."""
PASSES = 3
"""Each leaves about a third of what contacts that pull apart left inside."""
_LEAST = np.float32((4.0 * SOFTNESS_M) ** 3 * 1e-15)
DEEPEST_M = 0.12
"""Points further inside than this, by the shortest way, are left to the clip."""

BODY_JOINTS = tuple(joint for joint, _, _ in BODY)
_HANDS, _POINTS = 2, len(POINT_RADII)
_INVERSE = np.array([np.divide(1.0, r) for _, _, r in BODY], dtype=np.float32)
_MIDDLE = np.array([np.subtract(_REST[j], c) / r for j, c, r in BODY], dtype=np.float32)[..., None]
_REACH = np.tile(POINT_RADII - TOLERANCE_M, 2)
# Where the push's two ramps begin: their squares' difference over 4 × SOFTNESS_M is a smooth max(depth, 0).
_RAMPS = np.stack([_REACH + SOFTNESS_M, _REACH - SOFTNESS_M])[:, None].astype(np.float32)
_NEAR = (_REACH + SOFTNESS_M).astype(np.float32)
_TALLEST = float(POINT_RADII.max()) + TABLE_CLEARANCE_M
_TABLE_RADII = POINT_RADII + np.float32(TABLE_CLEARANCE_M)
# (height, depth) of a point × _TABLE_SIDE + _TABLE_EDGE: how far up and how far back the table's surfaces are.
_TABLE_SIDE = np.array([-1.0, 1.0], dtype=np.float32)
_TABLE_EDGE = np.stack([TABLE_TOP_M + _TABLE_RADII, _TABLE_RADII - TABLE_BACK_Z_M], axis=-1).astype(np.float32)


def _sums() -> Floats:
    """(12, 18): squares of x, y, z in six unit spheres -> six squared norms, then six squared slopes."""
    table = np.zeros((2, len(BODY), len(BODY), 3), dtype=np.float32)
    for body in range(len(BODY)):
        table[0, body, body] = 1.0
        table[1, body, body] = _INVERSE[body] ** 2
    return table.reshape(12, 18)


def _by_hand() -> Floats:
    """(14, 2): sums over the points of each hand."""
    return np.repeat(np.eye(_HANDS, dtype=np.float32), _POINTS, axis=0)


_SUMS, _BY_HAND = _sums(), _by_hand()
for _array in (POINT_RADII, TOLERANCE_M, _INVERSE, _SUMS, _MIDDLE, _REACH, _RAMPS, _NEAR, _BY_HAND, _TABLE_RADII):
    _array.setflags(write=False)
for _array in (_TABLE_SIDE, _TABLE_EDGE):
    _array.setflags(write=False)


def body_frames(frames: Floats) -> Floats:
    """(n, 6, 4, 4) matrices of the joints BODY hangs on -> (n, 6, 3, 4) maps into each ellipsoid's unit sphere."""
    maps = np.empty((len(frames), len(BODY), 3, 4), dtype=np.float32)
    turn = np.multiply(frames[..., :3, :3].swapaxes(-1, -2), _INVERSE[:, :, None], out=maps[..., :3])
    np.subtract(_MIDDLE, turn @ frames[..., :3, 3:], out=maps[..., 3:])
    return maps


def body_distance(maps: Floats, points: Floats) -> tuple[Floats, Floats]:
    """Signed distance (n, 6, P) of points (n, P, 4), homogeneous, from each ellipsoid, metres, and its unit gradient
    (n, 6, 3, P)."""
    at, distance, slope = _distance(maps, points)
    # maps hold rotation / radius, so their transpose takes position / radius to the gradient in model space.
    away = maps[..., :3].swapaxes(-1, -2) @ (at.reshape(len(points), len(BODY), 3, -1) / slope[:, :, None])
    return distance, np.asarray(away)


def _distance(maps: Floats, points: Floats) -> tuple[Floats, Floats, Floats]:
    """Points in the unit spheres' frames (n, 18, P), distance and slope (n, 6, P)."""
    at = maps.reshape(len(maps), 18, 4) @ points.swapaxes(-1, -2)
    squares = _SUMS @ (at * at)
    squares += 1e-12
    roots = np.sqrt(squares)
    slope = roots[:, 6:]
    # Quílez' estimate for an ellipsoid, norm · (norm − 1) / slope; exact on the surface.
    return at, (squares[:, :6] - roots[:, :6]) / slope, slope


def push_out(maps: Floats, points: Floats) -> Floats | None:
    """points: (n, 14, 4) of the left, then the right hand, homogeneous, model space -> push (n, 2, 3), metres; None
    where all is clear."""
    push = _push_from_body(maps, points)
    if np.minimum.reduce(points[..., 1], axis=None) >= TABLE_TOP_M + _TALLEST:
        return push
    lift = _table(points.reshape(len(points), _HANDS, _POINTS, 4))
    if lift is None:
        return push
    if push is None:
        push = np.zeros((len(points), _HANDS, 3), dtype=np.float32)
    push[..., 1] += np.maximum(lift[..., 0] - np.maximum(push[..., 1], 0.0), 0.0)
    push[..., 2] -= lift[..., 1]
    return push


def _push_from_body(maps: Floats, points: Floats) -> Floats | None:
    """Away from the body; None where nothing is near it."""
    n = len(points)
    push = np.zeros((n, _HANDS, 3), dtype=np.float32)
    seen = _distance(maps, points)
    close = seen[1] < _NEAR
    if not np.count_nonzero(close):
        return None
    # In a crowd few hands touch anything.
    near = np.flatnonzero(close.any(axis=(1, 2)))
    if len(near) == n:
        _push_again(maps, points.copy(), seen, push)
        return push
    some = push[near]
    at, distance, slope = seen
    _push_again(maps[near], points[near], (at[near], distance[near], slope[near]), some)
    push[near] = some
    return push


def _push_again(maps: Floats, points: Floats, seen: tuple[Floats, Floats, Floats], push: Floats) -> None:
    """Add to push (n, 2, 3), and to points, what contacts with the body ask for; seen: _distance of the points."""
    n = len(points)
    summing = _summing(maps)
    hands = points.reshape(n, _HANDS, _POINTS, 4)
    for again in range(PASSES):
        # Contacts that pull apart leave something inside: what is left is pushed again.
        at, distance, slope = _distance(maps, points) if again else seen
        ramps = np.maximum(_RAMPS - distance[:, None], 0.0)
        ramps *= ramps
        depth = ramps[:, 0] - ramps[:, 1]
        square = depth * depth
        # The deepest contact leads, others join in as they come near: no switching. Their weights are cubes of the
        # depth; the pushes are added up in the ellipsoids' frames, for each hand, and then turned to model space.
        parts = np.empty((n, 24, 14), dtype=np.float32)
        np.multiply(
            at.reshape(n, 6, 3, 14), (square * square / slope)[:, :, None], out=parts[:, :18].reshape(n, 6, 3, 14)
        )
        np.multiply(square, depth, out=parts[:, 18:])
        total = (parts @ _BY_HAND).swapaxes(-1, -2) @ summing
        step = total[..., :3] / np.maximum(total[..., 3:], _LEAST)
        push += step
        hands[..., :3] += step[:, :, None]


def _summing(maps: Floats) -> Floats:
    """(n, 24, 4): from 18 sums of pushes in the ellipsoids' frames and 6 of weights to push and weight. Depths come
    4 × SOFTNESS_M times too large."""
    table = np.zeros((len(maps), 24, 4), dtype=np.float32)
    np.divide(maps.reshape(len(maps), 18, 4)[..., :3], 4.0 * SOFTNESS_M, out=table[:, :18, :3])
    table[:, 18:, 3] = 1.0
    return table


def _table(points: Floats) -> Floats | None:
    """points: (n, 2, 7, 4) -> (n, 2, 2) how far up, and how far back, the deepest point of each hand must go to be
    clear of the table; None where all are."""
    depth = np.maximum(points[..., 1:3] * _TABLE_SIDE + _TABLE_EDGE, 0.0)
    short = np.minimum(depth[..., 0], depth[..., 1])
    inside = (short > 0.0) & (short < DEEPEST_M) & (points[..., 2] < TABLE_FRONT_Z_M + 0.04)
    if not np.count_nonzero(inside):
        return None
    # Near the edge the short way out is backward, elsewhere upward; where both are as short, both are gone.
    square = depth * depth
    share = 2.0 * square[..., 1] / np.maximum(square[..., 0] + square[..., 1], 1e-12)
    depth[..., 0] *= np.minimum(share, 1.0)
    depth[..., 1] *= np.minimum(2.0 - share, 1.0)
    return np.asarray((depth * inside[..., None]).max(axis=2))
