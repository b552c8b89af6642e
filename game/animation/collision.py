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
DEEPEST_M = 0.12
"""Points further inside than this, by the shortest way, are left to the clip."""

BODY_JOINTS = tuple(joint for joint, _, _ in BODY)
_INVERSE = np.array([np.divide(1.0, r) for _, _, r in BODY], dtype=np.float32)
_SUMS = np.stack([np.ones_like(_INVERSE), _INVERSE * _INVERSE], axis=1)
_MIDDLE = np.array([np.subtract(_REST[j], c) / r for j, c, r in BODY], dtype=np.float32)[..., None]
_REACH = np.tile(POINT_RADII - TOLERANCE_M, 2)
_TALLEST = float(POINT_RADII.max()) + TABLE_CLEARANCE_M
for _array in (POINT_RADII, TOLERANCE_M, _INVERSE, _SUMS, _MIDDLE, _REACH):
    _array.setflags(write=False)


def body_frames(frames: Floats) -> Floats:
    """(n, 6, 4, 4) matrices of the joints BODY hangs on -> (n, 6, 3, 4) maps into each ellipsoid's unit sphere."""
    maps = np.empty((len(frames), len(BODY), 3, 4), dtype=np.float32)
    turn = np.multiply(frames[..., :3, :3].swapaxes(-1, -2), _INVERSE[:, :, None], out=maps[..., :3])
    np.subtract(_MIDDLE, turn @ frames[..., :3, 3:], out=maps[..., 3:])
    return maps


def body_distance(maps: Floats, points: Floats) -> tuple[Floats, Floats]:
    """Signed distance (n, 6, P) of points (n, P, 3) from each ellipsoid, metres, and its unit gradient (n, 6, 3, P)."""
    at, distance, slope = _distance(maps, points)
    return distance, _away(maps, at, slope)


def _distance(maps: Floats, points: Floats) -> tuple[Floats, Floats, Floats]:
    """Points in the unit spheres' frames (n, 6, 3, P), distance and slope (n, 6, P)."""
    at = maps[..., :3] @ points.swapaxes(-1, -2)[:, None] + maps[..., 3:]
    square = at * at
    norms = np.sqrt(_SUMS @ square + np.float32(1e-12))
    norm, slope = norms[:, :, 0], norms[:, :, 1]
    # Quílez' estimate for an ellipsoid; exact on the surface.
    return at, norm * (norm - np.float32(1.0)) / slope, slope


def _away(maps: Floats, at: Floats, slope: Floats) -> Floats:
    # maps hold rotation / radius, so their transpose takes position / radius to the gradient in model space.
    return np.asarray(maps[..., :3].swapaxes(-1, -2) @ (at / slope[:, :, None]))


def push_out(maps: Floats, points: Floats) -> Floats:
    """points: (n, 2, 7, 3) of both hands in model space -> push (n, 2, 3), metres; 0 where all is clear."""
    push = np.zeros((len(points), 2, 3), dtype=np.float32)
    for _ in range(PASSES):
        # Contacts that pull apart leave something inside: what is left is pushed again.
        if not _push_from_body(maps, points + push[:, :, None], push):
            break
    if points[..., 1].min() < TABLE_TOP_M + _TALLEST:
        up, back = _table(points)
        push[..., 1] += np.maximum(up - np.maximum(push[..., 1], 0.0), 0.0)
        push[..., 2] -= back
    return push


def _push_from_body(maps: Floats, points: Floats, push: Floats) -> bool:
    """Add to push (n, 2, 3) what the points' contacts with the body ask for; False where nothing is near it."""
    n = len(points)
    at, distance, slope = _distance(maps, points.reshape(n, 14, 3))
    depth = _REACH - distance
    if depth.max() <= -SOFTNESS_M:
        return False
    depth = _soft(depth)
    away = _away(maps, at, slope)
    cubed = (depth * depth * depth).reshape(n, len(BODY), 2, 7)
    # The deepest contact leads, others join in as they come near: no switching.
    weight = cubed / np.maximum(cubed.sum(axis=(1, 3), keepdims=True), np.float32(1e-15))
    amount = (weight * depth.reshape(cubed.shape))[:, :, None] * away.reshape(n, len(BODY), 3, 2, 7)
    push += amount.sum(axis=(1, 4)).swapaxes(-1, -2)
    return True


def _soft(depth: Floats) -> Floats:
    """Smooth max(depth, 0): starts SOFTNESS_M before the touch."""
    s = np.float32(SOFTNESS_M)
    ramp = np.clip(depth + s, 0.0, 2.0 * s)
    return np.asarray(ramp * ramp / (4.0 * s) + np.maximum(depth - s, 0.0))


def _table(points: Floats) -> tuple[Floats, Floats]:
    """(n, 2) how far up, and how far back, the deepest point of each hand must go to be clear of the table."""
    y, z = points[..., 1], points[..., 2]
    radius = POINT_RADII + np.float32(TABLE_CLEARANCE_M)
    up = np.clip(TABLE_TOP_M + radius - y, 0.0, None)
    back = np.clip(z - (TABLE_BACK_Z_M - radius), 0.0, None)
    inside = (up > 0.0) & (back > 0.0) & (z < TABLE_FRONT_Z_M + 0.04) & (np.minimum(up, back) < DEEPEST_M)
    # Near the edge the short way out is backward, elsewhere upward; where both are as short, both are gone.
    share = 2.0 * back * back / np.maximum(back * back + up * up, np.float32(1e-12))
    return (
        np.where(inside, up * np.minimum(share, 1.0), 0.0).max(axis=-1),
        np.where(inside, back * np.minimum(2.0 - share, 1.0), 0.0).max(axis=-1),
    )
