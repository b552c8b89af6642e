"""Hair, scarf and bow: spring bones with the meaning VRM gives them (VRMC_springBone 1.0), for many characters.

VRM defines a Verlet step per frame without saying how long a frame is; three-vrm and UniVRM run at 60 per second.
Here a step of any length has the damping and the terminal velocity of that many 60ths, so 30 and 60 ticks a second
hang and swing alike. All chains advance together, piece by piece from the root.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import bilinear as bl
from game.core.errors import BadInput
from game.core.skeleton import Skeleton

__all__ = ["SpringChain", "SpringCollider", "SpringSet", "SpringState", "advance_springs", "build_springs"]

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.intp]

VRM_STEP_S = 1.0 / 60.0
_PASSES = 3
"""Colliders are left one after the other, deepest first, at most so often a step."""


@dataclass(frozen=True)
class SpringChain:
    """joints: rig joints from root to tip, each the parent of the next; the other tuples have one value per piece
    (one fewer than joints). colliders: indices of what the chain may not enter. Units as in VRM, metres."""

    joints: tuple[int, ...]
    stiffness: tuple[float, ...]
    gravity_power: tuple[float, ...]
    gravity_dir: tuple[tuple[float, float, float], ...]
    drag: tuple[float, ...]
    hit_radius_m: tuple[float, ...]
    colliders: tuple[int, ...] = ()


@dataclass(frozen=True)
class SpringCollider:
    """A sphere on a rig joint, or with a tail a capsule; metres in the joint's frame."""

    joint: int
    offset: tuple[float, float, float]
    radius_m: float
    tail: tuple[float, float, float] | None = None


@dataclass(frozen=True, eq=False)
class _Depth:
    """The pieces of one depth: slice of the state, joints at their heads, ends and above, and their constants."""

    where: slice
    head: Ints
    end: Ints
    parent: Ints
    offset: Floats
    axis: Floats
    turn: Floats
    end_turn: Floats
    length: Floats
    pull: Floats
    weight: Floats
    keep: Floats
    hit: Floats
    meets: Floats


@dataclass(frozen=True, eq=False)
class SpringSet:
    """All chains of a rig, cut into depths. joints: every joint that the springs place."""

    depths: tuple[_Depth, ...]
    pieces: int
    joints: Ints
    collider_joint: Ints
    collider_start: Floats
    collider_way: Floats
    collider_radius: Floats


@dataclass(frozen=True, eq=False)
class SpringState:
    """tail: (n, S, 3) model space; speed: (n, S, 3) metres per second; known: False before the first step."""

    tail: Floats
    speed: Floats
    known: bool = False


def build_springs(
    skeleton: Skeleton, chains: tuple[SpringChain, ...], colliders: tuple[SpringCollider, ...]
) -> SpringSet:
    """Raises BadInput for a chain that is no line of joints or names an unknown collider."""
    for number, chain in enumerate(chains):
        _check(skeleton, chain, number, len(colliders))
    deepest = max((len(c.joints) - 1 for c in chains), default=0)
    depths, at = [], 0
    for depth in range(deepest):
        mine = [c for c in chains if len(c.joints) - 1 > depth]
        head = np.array([c.joints[depth] for c in mine], dtype=np.intp)
        end = np.array([c.joints[depth + 1] for c in mine], dtype=np.intp)
        along = skeleton.rest_translation[end]
        length = np.maximum(np.linalg.norm(along, axis=-1, keepdims=True), 1e-6)
        keep = np.clip([1.0 - c.drag[depth] for c in mine], 0.0, 1.0)
        pull = np.array([c.stiffness[depth] for c in mine])
        weight = np.array([np.multiply(c.gravity_dir[depth], c.gravity_power[depth]) for c in mine])
        meets = np.array([[i in c.colliders for i in range(len(colliders))] for c in mine], dtype=np.float32)
        depths.append(
            _Depth(
                where=slice(at, at + len(mine)),
                head=head,
                end=end,
                parent=skeleton.parents[head],
                offset=skeleton.rest_translation[head].astype(np.float32),
                axis=(along / length).astype(np.float32),
                turn=bl.affine(skeleton.rest_rotation[head].astype(np.float32)),
                end_turn=bl.affine(skeleton.rest_rotation[end].astype(np.float32)),
                length=length.astype(np.float32),
                pull=pull[:, None].astype(np.float32),
                weight=weight.astype(np.float32),
                keep=keep[:, None].astype(np.float32),
                hit=np.array([c.hit_radius_m[depth] for c in mine], dtype=np.float32)[:, None],
                meets=meets.reshape(len(mine), len(colliders)),
            )
        )
        at += len(mine)
    start = np.array([c.offset for c in colliders], dtype=np.float32).reshape(-1, 3)
    stop = np.array([c.tail if c.tail is not None else c.offset for c in colliders], dtype=np.float32).reshape(-1, 3)
    return SpringSet(
        depths=tuple(depths),
        pieces=at,
        joints=np.array(sorted({j for c in chains for j in c.joints}), dtype=np.intp),
        collider_joint=np.array([c.joint for c in colliders], dtype=np.intp),
        collider_start=start,
        collider_way=stop - start,
        collider_radius=np.array([c.radius_m for c in colliders], dtype=np.float32),
    )


def _check(skeleton: Skeleton, chain: SpringChain, number: int, colliders: int) -> None:
    pieces = len(chain.joints) - 1
    values = (chain.stiffness, chain.gravity_power, chain.gravity_dir, chain.drag, chain.hit_radius_m)
    if pieces < 1 or any(len(v) < pieces for v in values):
        raise BadInput(f"spring chain {number}", expected="two joints or more, values per piece", seen=chain.joints)
    for above, below in zip(chain.joints, chain.joints[1:], strict=False):
        if not 0 <= below < len(skeleton) or skeleton.parents[below] != above:
            raise BadInput(f"spring chain {number}", expected=f"a child of joint {above}", seen=below)
    if skeleton.parents[chain.joints[0]] < 0:
        raise BadInput(f"spring chain {number}", expected="a joint that hangs on another", seen=chain.joints[0])
    if any(not 0 <= c < colliders for c in chain.colliders):
        raise BadInput(f"spring chain {number}", expected=f"colliders below {colliders}", seen=chain.colliders)


def start_springs(springs: SpringSet, n: int) -> SpringState:
    """Before the first step: the first pose decides where everything hangs."""
    zero = np.zeros((n, springs.pieces, 3), dtype=np.float32)
    return SpringState(zero, zero)


def advance_springs(springs: SpringSet, state: SpringState, model: Floats, dt_s: float) -> SpringState:
    """One step. model: (n, J, 4, 4) joint matrices; those of the chains are rewritten in place."""
    if not springs.pieces:
        return state
    tail, speed = state.tail.copy(), state.speed.copy()
    steps = dt_s / VRM_STEP_S
    way, start = _colliders(springs, model)
    for depth in springs.depths:
        above = model.take(depth.parent, axis=1)
        rest = above @ depth.turn
        head = above[..., :3, 3] + (above[..., :3, :3] @ depth.offset[..., None])[..., 0]
        axis = (rest[..., :3, :3] @ depth.axis[..., None])[..., 0]
        if state.known and dt_s > 0.0:
            old = tail[:, depth.where]
            kept = depth.keep**steps
            grip = steps * (1.0 - kept) / np.maximum(1.0 - depth.keep, 1e-4) * VRM_STEP_S
            new = old + speed[:, depth.where] * (kept * dt_s) + (axis * depth.pull + depth.weight) * grip
            new = _reach(head, new, depth.length)
            if depth.meets.any():
                new = _leave(springs, depth, head, new, start, way)
            speed[:, depth.where] = (new - old) / dt_s
        elif state.known:
            new = _reach(head, tail[:, depth.where], depth.length)
        else:
            new = head + axis * depth.length
        tail[:, depth.where] = new
        swing = _between(axis, (new - head) / depth.length)
        placed = bl.affine(swing) @ rest
        placed[..., :3, 3] = head
        model[:, depth.head] = placed
        tip = placed @ depth.end_turn
        tip[..., :3, 3] = new
        model[:, depth.end] = tip
    return SpringState(tail, speed, True)


def _reach(head: Floats, tail: Floats, length: Floats) -> Floats:
    """The tail at its piece's length from the head."""
    way = tail - head
    return np.asarray(head + way * (length / (np.sqrt((way * way).sum(-1, keepdims=True)) + np.float32(1e-9))))


def _colliders(springs: SpringSet, model: Floats) -> tuple[Floats, Floats]:
    """Ways and starts (n, C, 3) of the colliders' segments in model space."""
    frames = model.take(springs.collider_joint, axis=1)
    turn = frames[..., :3, :3]
    start = frames[..., :3, 3] + (turn @ springs.collider_start[..., None])[..., 0]
    return (turn @ springs.collider_way[..., None])[..., 0], start


def _leave(springs: SpringSet, depth: _Depth, head: Floats, tail: Floats, start: Floats, way: Floats) -> Floats:
    """Tails (n, P, 3) out of the colliders they meet, still at their length from the head."""
    square = np.maximum((way * way).sum(-1), np.float32(1e-12))[:, None]
    clear = springs.collider_radius + depth.hit
    for _ in range(_PASSES):
        out = tail[:, :, None] - start[:, None]
        along = np.clip((out * way[:, None]).sum(-1) / square, 0.0, 1.0)
        out -= along[..., None] * way[:, None]
        distance = np.sqrt((out * out).sum(-1)) + np.float32(1e-9)
        inside = np.where(depth.meets > 0.0, clear - distance, np.float32(-1.0))
        worst = inside.argmax(axis=-1)[..., None]
        deep = np.take_along_axis(inside, worst, axis=-1)
        if deep.max() <= 1e-5:
            break
        direction = np.take_along_axis(out, worst[..., None], axis=2)[:, :, 0]
        direction = direction / np.take_along_axis(distance, worst, axis=-1)
        tail = _reach_outside(head, tail + direction * np.maximum(deep, 0.0), direction, deep, depth.length)
    return tail


def _reach_outside(head: Floats, tail: Floats, direction: Floats, deep: Floats, length: Floats) -> Floats:
    """_reach along the collider's surface: the length is restored without going back inside where that is possible.

    Among the points at the piece's length from the head, take the one in the plane of head, tail and collider that
    keeps the height over the collider gained by the push.
    """
    way = tail - head
    rise = (way * direction).sum(-1, keepdims=True)
    flat = way - rise * direction
    run = np.sqrt((flat * flat).sum(-1, keepdims=True)) + np.float32(1e-9)
    rise_kept = np.clip(rise, -length, length)
    run_kept = np.sqrt(np.maximum(length * length - rise_kept * rise_kept, 0.0))
    moved = head + direction * rise_kept + flat * (run_kept / run)
    return np.where(deep > 0.0, moved, tail).astype(np.float32)


def _between(a: Floats, b: Floats) -> Floats:
    """Smallest rotation from unit a to unit b; opposite directions turn about any axis across."""
    q = np.empty((*a.shape[:-1], 4), dtype=np.float32)
    q[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    q[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    q[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    q[..., 3] = np.maximum(1.0 + (a * b).sum(-1), np.float32(1e-3))
    return bl.normalize(q)
