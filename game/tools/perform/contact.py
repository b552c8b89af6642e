"""Where skin is: signed distances to trunk, head and table, and the pushes that keep hands and arms out of them.

Surfaces are ellipsoids and capsules fixed to joints, a little inside the clothes' outer hull, as in the character.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from game.core import quaternion as quat
from game.core.humanoid import HEAD_CENTRE_OFFSET, REFERENCE, TABLE_FRONT_Z_M, TABLE_TOP_M

__all__ = [
    "HAND_POINTS",
    "TABLE_BACK_Z_M",
    "arm_points",
    "arms_apart",
    "body_depth",
    "body_push",
    "spread_pushes",
    "table_depth",
]

Floats = NDArray[np.floating[Any]]
TABLE_BACK_Z_M = 0.16


class _Ellipsoid(NamedTuple):
    joint: str
    centre: tuple[float, float, float]  # from the joint, in its frame
    radii: tuple[float, float, float]
    is_trunk: bool


def _at(joint: str, x: float, y: float, z: float) -> tuple[float, float, float]:
    origin = REFERENCE.rest_model[REFERENCE.index[joint], :3, 3]
    return (x - float(origin[0]), y - float(origin[1]), z - float(origin[2]))


_HEAD = tuple(float(v) for v in HEAD_CENTRE_OFFSET)
_ELLIPSOIDS = (
    _Ellipsoid("chest", _at("chest", 0, 0.815, 0), (0.145, 0.145, 0.112), True),
    _Ellipsoid("chest", _at("chest", 0, 0.902, -0.008), (0.125, 0.062, 0.066), True),
    _Ellipsoid("spine", _at("spine", 0, 0.68, 0), (0.135, 0.14, 0.112), True),
    _Ellipsoid("hips", _at("hips", 0, 0.55, 0), (0.175, 0.12, 0.145), True),
    _Ellipsoid("head", (_HEAD[0], _HEAD[1] - 0.03, _HEAD[2] + 0.01), (0.150, 0.155, 0.150), False),
    _Ellipsoid("head", (_HEAD[0], _HEAD[1] + 0.02, _HEAD[2] - 0.015), (0.186, 0.178, 0.180), False),
)

HAND_POINTS = 8
"""The first eight of arm_points are the hand (wrist, palm, knuckles, tips); forearm and elbow follow."""
_RADII = np.array([0.027, 0.024, 0.012, 0.011, 0.012, 0.011, 0.012, 0.011, 0.036, 0.036, 0.045])


def arm_points(position: Floats, rotation: Floats, side: str) -> tuple[Floats, Floats]:
    """Model joint positions (F, J, 3) and rotations (F, J, 4) -> points (F, 11, 3) and radii (11,), metres.

    Wrist, palm, middle joint and tip of index, middle and little finger, two points of the forearm, elbow.
    """
    index = REFERENCE.index

    def of(name: str) -> Floats:
        return np.asarray(position[:, index[f"{side}{name}"]])

    wrist, elbow = of("Hand"), of("LowerArm")
    middle = of("MiddleProximal") - wrist
    points = [wrist, wrist + middle * (0.05 / np.linalg.norm(middle, axis=-1, keepdims=True))]
    for finger in ("Index", "Middle", "Little"):
        tip_joint = index[f"{side}{finger}Intermediate"]
        last = np.broadcast_to(REFERENCE.rest_translation[tip_joint], (len(position), 3))
        points += [of(f"{finger}Intermediate"), of(f"{finger}Intermediate") + quat.rotate(rotation[:, tip_joint], last)]
    points += [elbow + 0.66 * (wrist - elbow), elbow + 0.33 * (wrist - elbow), elbow]
    return np.stack(points, 1), _RADII


def _distances(points: Floats, position: Floats, rotation: Floats) -> tuple[Floats, Floats]:
    """Signed distances (F, K, 6) of points (F, K, 3) to the six surfaces and outward directions (F, K, 6, 3)."""
    depth, out = [], []
    for e in _ELLIPSOIDS:
        j = REFERENCE.index[e.joint]
        turn = rotation[:, None, j]
        local = quat.rotate(quat.conjugate(turn), points - position[:, None, j]) - np.array(e.centre)
        radii = np.array(e.radii)
        scaled = local / radii
        k0 = np.linalg.norm(scaled, axis=-1)
        k1 = np.linalg.norm(scaled / radii, axis=-1)
        # First-order distance to an ellipsoid (Quilez): exact on the surface, which is where it matters.
        depth.append(k0 * (k0 - 1.0) / np.maximum(k1, 1e-9))
        normal = scaled / radii
        out.append(quat.rotate(np.broadcast_to(turn, (*local.shape[:-1], 4)), normal / np.maximum(k1, 1e-9)[..., None]))
    return np.stack(depth, -1), np.stack(out, -2)


def _counts(points: int) -> NDArray[np.bool_]:
    """Which point is held against which surface: the elbow may touch the trunk's side, as elbows do."""
    counts = np.ones((points, len(_ELLIPSOIDS)), dtype=bool)
    counts[HAND_POINTS + 1 :, [e.is_trunk for e in _ELLIPSOIDS]] = False
    return counts


def body_depth(points: Floats, radii: Floats, position: Floats, rotation: Floats) -> Floats:
    """How deep (F, K) each point's sphere lies inside trunk or head, metres, 0 outside."""
    distance, _ = _distances(points, position, rotation)
    inside = np.where(_counts(points.shape[1]), radii[:, None] - distance, 0.0)
    return np.asarray(np.maximum(inside.max(-1), 0.0))


def _table(points: Floats, radii: Floats) -> tuple[Floats, Floats]:
    """Depth (F, K) of spheres below the table's top and behind its back edge; the table reaches the floor."""
    below = TABLE_TOP_M + radii - points[..., 1]
    beyond = points[..., 2] + radii - TABLE_BACK_Z_M
    inside = (below > 0.0) & (beyond > 0.0) & (points[..., 2] < TABLE_FRONT_Z_M)
    return np.where(inside, below, 0.0), np.where(inside, beyond, 0.0)


def table_depth(points: Floats, radii: Floats) -> Floats:
    """How deep (F, K) each point's sphere lies inside the table, metres, 0 outside: the nearer way out counts."""
    return np.asarray(np.minimum(*_table(points, radii)))


def body_push(points: Floats, radii: Floats, position: Floats, rotation: Floats) -> Floats:
    """The shift (F, 3) that a wrist needs so that its hand and forearm leave trunk, head and table.

    The deepest point decides; a point of the forearm moves less than the wrist does, so its push is larger.
    """
    distance, out = _distances(points, position, rotation)
    slack = np.full(len(radii), 0.004)
    slack[HAND_POINTS:] = 0.012
    gain = np.ones(len(radii))
    gain[HAND_POINTS:] = (1.3, 1.6, 1.0)
    inside = np.where(_counts(len(radii)), ((radii - slack)[:, None] - distance) * gain[:, None], 0.0)
    frames = np.arange(len(points))
    flat = inside.reshape(len(points), -1)
    deepest = flat.argmax(1)
    push = out.reshape(len(points), -1, 3)[frames, deepest] * np.maximum(flat[frames, deepest], 0.0)[:, None]
    below, beyond = _table(points[:, :-1] + push[:, None], radii[:-1] - 0.001)
    nearest = np.minimum(below, beyond)
    worst = nearest.argmax(1)
    up = below[frames, worst] <= beyond[frames, worst]
    push[:, 1] += np.where(up, nearest[frames, worst], 0.0)
    push[:, 2] -= np.where(up, 0.0, nearest[frames, worst])
    return np.asarray(push)


def arms_apart(mine: Floats, other: Floats, radii: Floats, direction: Floats) -> Floats:
    """How far (F,) one arm must go along a unit direction (F, 3) to lie on the other arm, not in it; metres, >= 0.

    mine, other: (F, 11, 3) points of the two arms. Flesh gives a little: 86 % of the radii.
    """
    way = mine[:, :, None] - other[:, None]
    along = np.einsum("fijc,fc->fij", way, direction)
    touch = 0.86 * (radii[:, None] + radii[None, :])
    inside = touch**2 - (way**2).sum(-1)
    # |way + t direction| = touch, solved for the t that leads out ahead.
    t = np.where(inside > 0.0, -along + np.sqrt(np.maximum(along**2 + inside, 0.0)), 0.0)
    return np.asarray(t.reshape(len(mine), -1).max(1))


def spread_pushes(push: Floats, half: int = 4) -> Floats:
    """Let pushes (F, 3) ramp in and out: each frame takes the largest neighbour under a Hann window."""
    frames = len(push)
    window = np.hanning(2 * half + 3)[1:-1]
    padded = np.pad(push, ((half, half), (0, 0)))
    neighbours = np.lib.stride_tricks.sliding_window_view(padded, 2 * half + 1, axis=0)
    weighted = neighbours * window
    best = np.linalg.norm(weighted, axis=1).argmax(-1)
    return np.asarray(weighted[np.arange(frames), :, best])
