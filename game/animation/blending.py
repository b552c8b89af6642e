"""Layers into one row, and transitions that never pop (SPEC 6).

The posture moves the whole body; a gesture and a mannerism replace the parts they own and add a trace to torso and
head. Whenever the source of a part changes, the difference between what was shown and what is wanted is kept and
dies away along a minimum-jerk curve (inertialisation after Bollo, GDC 2018): place and velocity stay continuous,
and the acceleration starts and ends at 0. The curve is closed-form, so the frame rate does not matter.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import bilinear as bl
from game.animation import channels as ch
from game.animation.collision import TABLE_BACK_Z_M
from game.animation.motion_bank import MotionBank
from game.animation.playback import Playback
from game.core.humanoid import TABLE_TOP_M

__all__ = ["Blend", "advance_blend", "compose", "start_blend", "switch"]

Floats = NDArray[np.floating[Any]]
Bools = NDArray[np.bool_]

SHORTEST_S, LONGEST_S = 0.2, 1.4
"""Limits of a transition's length."""
GROWTH = (0.6, 0.7)
"""A transition lasts base·(a + b·√(turn / 90°)): far moves take longer (Fitts)."""
STROKE_SHARE = 0.85
"""A gesture's preparation must be free of the past before its stroke: at most this share of the time up to it."""
MOMENTUM = 0.55
"""Speed left over from the old source is braked within min(span, this / speed): it carries a joint at most 0.2 × this
(half radians) too far, a wrist at most 0.2 × this × an arm's length."""
SHORTEST_BRAKE_S = 0.12
ARC = np.array([[0.55, 0.5, 0.65], [-0.55, 0.5, 0.65]], dtype=np.float32)
"""A hand's way bows out, up and forward by the emotion's arc times its length (MOTION.md, hands)."""
LONGEST_ARC_M = 0.12
ARC_PACE = 1.3
"""A bowed way takes at least this times √(bow in metres) seconds: higher bows need time."""
EDGE_LIFT_M, EDGE_CLEAR_M = 0.05, 0.13
"""Between below and above the table a hand goes round its edge: it bows up by this and what it lacks of this height."""
ARM_M = 0.42

# Quintic Hermite basis on [0, 1]: value 1 → 0 and slope 1 → 0, everything else vanishing at both ends; with slopes.
_VALUE = np.array([[1, 0], [0, 0], [0, -30], [-10, 60], [15, -30], [-6, 0]], dtype=np.float32)
_SLOPE = np.array([[0, 1], [1, 0], [0, -18], [-6, 32], [8, -15], [-3, 0]], dtype=np.float32)
_POWERS = np.arange(6, dtype=np.float32)
for _table in (_VALUE, _SLOPE, _POWERS):
    _table.setflags(write=False)

_TOUCHED = np.array([part in ("spine", "head", "left_arm", "right_arm") for part in ch.PARTS])
_TOUCHED.setflags(write=False)
_PART_JOINTS = tuple(np.flatnonzero(p == ch.PART_OF_JOINT) for p in range(len(ch.PARTS)))
_ARMS = [ch.PARTS.index("left_arm"), ch.PARTS.index("right_arm")]


@dataclass(frozen=True, eq=False)
class Blend:
    """n characters. gate: (n, L, CHANNELS) share of each layer. owned: (n, L, PARTS) what each layer's unit owns.
    frame: (n, 2) contact frame of the hands. offset, offset_speed:
    (n, CHANNELS) at the last switch, the latter times brake_s. arc: (n, 2, 3) how far the hands' ways bow, metres in
    their contact frames. age_s, span_s, brake_s: (n, PARTS). row, speed:
    (n, CHANNELS) shown at the last tick. known: (n,) False before the first tick."""

    gate: Floats
    owned: Bools
    frame: NDArray[np.intp]
    offset: Floats
    offset_speed: Floats
    arc: Floats
    age_s: Floats
    span_s: Floats
    brake_s: Floats
    row: Floats
    speed: Floats
    known: Bools


def start_blend(n: int, layers: int) -> Blend:
    """Before the first tick: whatever comes is taken as it is."""
    parts = len(ch.PARTS)
    zero = np.zeros((n, ch.CHANNELS), dtype=np.float32)
    return Blend(
        gate=np.zeros((n, layers, ch.CHANNELS), dtype=np.float32),
        owned=np.zeros((n, layers, parts), dtype=bool),
        frame=np.zeros((n, 2), dtype=np.intp),
        offset=zero,
        offset_speed=zero,
        arc=np.zeros((n, 2, 3), dtype=np.float32),
        age_s=np.ones((n, parts), dtype=np.float32),
        span_s=np.ones((n, parts), dtype=np.float32),
        brake_s=np.ones((n, parts), dtype=np.float32),
        row=zero,
        speed=zero,
        known=np.zeros(n, dtype=bool),
    )


def compose(value: Floats, gate: Floats) -> tuple[Floats, Floats]:
    """Layer values (n, L, 2, CHANNELS) and gate -> the wanted row and its change per second, (n, CHANNELS) each."""
    both = (value * gate[:, :, None]).sum(axis=1)
    return both[:, 0], both[:, 1]


def switch(
    bank: MotionBank,
    state: Blend,
    playback: Playback,
    events: Bools,
    value: Floats,
    base_s: Floats,
    arc: Floats,
    contact_frames: Floats,
    posture_layer: int,
    dt_s: float,
) -> Blend:
    """Take up new sources. events: (n, L) layers whose source jumped; base_s: (n,) length of a middling transition;
    arc: (n,) bow of the hands' ways; contact_frames: (n, 4, 4, 4) matrices of CONTACT_FRAMES as last shown."""
    layers = events.shape[1]
    owned = bank.owned[playback.unit] & playback.active[:, :, None]
    touched = owned | state.owned | (_TOUCHED & (np.arange(layers) != posture_layer)[:, None])
    changed = (touched & events[:, :, None]).any(axis=1)
    gate, frame = _gates(bank, playback, owned, posture_layer)
    goal, goal_speed = compose(value, gate)
    row, speed = _in_frames(state, frame, contact_frames)
    row = row + speed * np.float32(dt_s)
    row, speed = _same_side(row, speed, goal)
    offset, offset_speed = row - goal, speed - goal_speed
    arcs = _arcs(row, goal, arc, contact_frames[np.arange(len(row))[:, None], frame])
    span = _spans(offset, base_s)
    span[:, _ARMS] = np.maximum(span[:, _ARMS], ARC_PACE * np.sqrt(np.linalg.norm(arcs, axis=-1)))
    span = np.minimum(span, _until_stroke(bank, playback, owned))
    fresh = changed & state.known[:, None]
    span = np.where(fresh, span, state.span_s)
    brake = np.where(fresh, np.minimum(_brakes(offset_speed), span), state.brake_s)
    per_channel = fresh[:, ch.PART_OF_CHANNEL]
    brake_of_channel = brake[:, ch.PART_OF_CHANNEL]
    return replace(
        state,
        gate=gate,
        owned=owned,
        frame=frame,
        offset=np.where(per_channel, offset, state.offset),
        offset_speed=np.where(per_channel, offset_speed * brake_of_channel, state.offset_speed),
        arc=np.where(fresh[:, _ARMS, None], arcs, state.arc),
        age_s=np.where(fresh, np.float32(0.0), state.age_s),
        span_s=span,
        brake_s=brake,
    )


def advance_blend(state: Blend, value: Floats, dt_s: float) -> Blend:
    """The row now shown, the transitions' remains included."""
    row, speed = compose(value, state.gate)
    if np.count_nonzero(state.age_s < state.span_s):
        ends = np.stack([state.span_s, state.brake_s])
        powers = np.minimum(state.age_s / ends, 1.0)[..., None] ** _POWERS
        curves = np.concatenate([powers[0] @ _VALUE, powers[1] @ _SLOPE], axis=-1)
        curves[..., 1] /= state.span_s
        curves[..., 3] /= state.brake_s
        a, da, b, db = curves.transpose(2, 0, 1).take(ch.PART_OF_CHANNEL, axis=2)
        row = row + state.offset * a + state.offset_speed * b
        speed = speed + state.offset * da + state.offset_speed * db
        _bow(state, row, speed)
    return replace(state, row=row, speed=speed, age_s=state.age_s + np.float32(dt_s), known=np.ones_like(state.known))


def _gates(bank: MotionBank, playback: Playback, owned: Bools, posture_layer: int) -> tuple[Floats, NDArray[np.intp]]:
    """Layer shares per channel and contact frames of the hands."""
    n, layers, parts = owned.shape
    free = np.ones((n, parts), dtype=bool)
    gate = np.zeros((n, layers, parts), dtype=np.float32)
    unit = np.zeros((n, 2), dtype=np.intp)
    for layer in [k for k in range(layers) if k != posture_layer] + [posture_layer]:
        gate[:, layer] = free & (playback.active[:, layer, None] | (layer == posture_layer))
        taken = free & owned[:, layer]
        unit = np.where(taken[:, _ARMS], playback.unit[:, layer, None], unit)
        free = free & ~taken
    return gate[:, :, ch.PART_OF_CHANNEL], bank.frame[unit, np.arange(2)]


def _in_frames(state: Blend, frame: NDArray[np.intp], contact_frames: Floats) -> tuple[Floats, Floats]:
    """The last row and speed with the hands expressed in their new contact frames."""
    row, speed = state.row, state.speed
    if np.array_equal(frame, state.frame):
        return row, speed
    who = np.arange(len(frame))[:, None]
    old, new = contact_frames[who, state.frame], contact_frames[who, frame]
    back = new[..., :3, :3].swapaxes(-1, -2)
    turn = back @ old[..., :3, :3]
    shift = back @ (old[..., :3, 3:] - new[..., :3, 3:])
    turn_quat = bl.from_matrix(turn)
    row, speed = row.copy(), speed.copy()
    for array, moved in ((row, shift[..., 0]), (speed, np.float32(0.0))):
        wrist = array[:, ch.WRIST].reshape(-1, 2, 3)
        palm = array[:, ch.PALM].reshape(-1, 2, 4)
        array[:, ch.WRIST] = ((turn @ wrist[..., None])[..., 0] + moved).reshape(-1, 6)
        array[:, ch.PALM] = bl.multiply(turn_quat, palm).reshape(-1, 8)
    return row, speed


def _same_side(row: Floats, speed: Floats, goal: Floats) -> tuple[Floats, Floats]:
    """Quaternions of row turned to the goal's hemisphere (the same rotations)."""
    row, speed = row.copy(), speed.copy()
    for part in (ch.ROTATION, ch.PALM):
        mine = row[:, part].reshape(len(row), -1, 4)
        wanted = goal[:, part].reshape(len(row), -1, 4)
        sign = np.where((mine * wanted).sum(-1, keepdims=True) < 0.0, np.float32(-1.0), np.float32(1.0))
        row[:, part] = (mine * sign).reshape(len(row), -1)
        speed[:, part] = (speed[:, part].reshape(mine.shape) * sign).reshape(len(row), -1)
    return row, speed


def _arcs(row: Floats, goal: Floats, arc: Floats, frames: Floats) -> Floats:
    """(n, 2, 3) how far each hand's way from row to goal bows, in its contact frame; frames: (n, 2, 4, 4)."""
    start, end = (r[:, ch.WRIST].reshape(-1, 2, 3) for r in (row, goal))
    length = np.linalg.norm(end - start, axis=-1, keepdims=True)
    bow = ARC * np.clip(arc[:, None, None] * length, -LONGEST_ARC_M, LONGEST_ARC_M)
    ways = np.stack([start, end], axis=2)
    model = ways @ frames[..., :3, :3].swapaxes(-1, -2) + frames[:, :, None, :3, 3]
    behind = model[..., 2] < TABLE_BACK_Z_M
    height = model[..., 1].mean(axis=-1) - TABLE_TOP_M
    crosses = (behind[..., 0] != behind[..., 1]) & (model[..., 1].min(axis=-1) < TABLE_TOP_M + EDGE_LIFT_M)
    lift = np.where(crosses, EDGE_LIFT_M + np.clip(EDGE_CLEAR_M - height, 0.0, EDGE_CLEAR_M), 0.0)
    # The second row of a frame's rotation is model space's up as the frame sees it.
    return np.asarray(bow + lift[..., None] * frames[..., 1, :3], dtype=np.float32)


def _bow(state: Blend, row: Floats, speed: Floats) -> None:
    """Add the hands' arcs: a bump that starts and ends with no speed and no acceleration."""
    span = state.span_s[:, _ARMS]
    u = np.minimum(state.age_s[:, _ARMS] / span, 1.0)
    rest = u * (1.0 - u)
    height, slope = 64.0 * rest**3, 192.0 * rest * rest * (1.0 - 2.0 * u) / span
    row[:, ch.WRIST] += (state.arc * height[..., None]).reshape(-1, 6)
    speed[:, ch.WRIST] += (state.arc * slope[..., None]).reshape(-1, 6)


def _spans(offset: Floats, base_s: Floats) -> Floats:
    """(n, PARTS) seconds a transition takes: longer for far moves."""
    span = base_s[:, None] * (GROWTH[0] + GROWTH[1] * np.sqrt(_largest(offset) * (4.0 / np.pi)))
    return np.array(np.clip(span, SHORTEST_S, LONGEST_S), dtype=np.float32)


def _brakes(offset_speed: Floats) -> Floats:
    """(n, PARTS) seconds in which the old source's speed is braked."""
    return np.asarray(np.maximum(MOMENTUM / np.maximum(_largest(offset_speed), 1e-3), SHORTEST_BRAKE_S))


def _largest(rows: Floats) -> Floats:
    """(n, PARTS) the largest change of a joint, half radians; a wrist's way counts as the arm's turn."""
    n = len(rows)
    turn = np.linalg.norm(rows[:, ch.ROTATION].reshape(n, ch.JOINTS, 4), axis=-1)
    most = np.stack([turn[:, joints].max(axis=1) for joints in _PART_JOINTS], axis=1)
    way = np.linalg.norm(rows[:, ch.WRIST].reshape(n, 2, 3), axis=-1) * (0.5 / ARM_M)
    most[:, _ARMS] = np.maximum(most[:, _ARMS], way)
    return np.asarray(most)


def _until_stroke(bank: MotionBank, playback: Playback, owned: Bools) -> Floats:
    """(n, PARTS) the longest a transition may take where a gesture is on its way to its stroke."""
    left = STROKE_SHARE * playback.to_stroke_s
    bound = owned & (left > 0.0)[:, :, None]
    limit = np.where(bound, np.maximum(left, SHORTEST_S)[:, :, None], np.inf)
    return np.asarray(limit.min(axis=1), dtype=np.float32)
