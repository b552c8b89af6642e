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
from game.animation.playback import Layered, Playback, of_some
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

# Polynomials in u of the two curves and of their slopes (_add_remains): coefficients by (power, 0 | slope, curve).
_CURVES = np.array([[[1, 0], [0, 1]], [[3, 1], [0, 2]], [[6, 3], [-30, -15]]], dtype=np.float32)[..., None, None]
_CURVES.setflags(write=False)

_TOUCHED = np.array([part in ("spine", "head", "left_arm", "right_arm") for part in ch.PARTS])
_TOUCHED.setflags(write=False)
_PART_JOINTS = tuple(np.flatnonzero(p == ch.PART_OF_JOINT) for p in range(len(ch.PARTS)))
_ARMS = [ch.PARTS.index("left_arm"), ch.PARTS.index("right_arm")]


@dataclass(frozen=True, eq=False)
class Source:
    """What n characters' rows are made of since their last switch. gate: (n, L, CHANNELS) share of each layer. owned:
    (n, L, PARTS) what each layer's unit owns. frame: (n, 2) contact frame of the hands. attention: (n,) 0 where a unit
    moves the gaze itself, else 1. offset: (2, n, CHANNELS) how far what was shown lay from what was wanted, and how
    much faster it moved, the latter times brake_s. arc: (n, 2, 3) how far the hands' ways bow, metres in their contact
    frames. ends_s: (2, n, PARTS) how long offset and speed take to vanish (span and brake)."""

    gate: Floats
    owned: Bools
    frame: NDArray[np.intp]
    attention: Floats
    offset: Floats
    arc: Floats
    ends_s: Floats


@dataclass(frozen=True, eq=False)
class Blend:
    """n characters. age_s: (n, PARTS) since the last switch. row, speed: (n, CHANNELS) shown at the last tick.
    known: False before the first."""

    source: Source
    age_s: Floats
    row: Floats
    speed: Floats
    known: bool = True


def start_blend(n: int, layers: int) -> Blend:
    """Before the first tick: whatever comes is taken as it is."""
    parts = len(ch.PARTS)
    source = Source(
        gate=np.zeros((n, layers, ch.CHANNELS), dtype=np.float32),
        owned=np.zeros((n, layers, parts), dtype=bool),
        frame=np.zeros((n, 2), dtype=np.intp),
        attention=np.ones(n),
        offset=np.zeros((2, n, ch.CHANNELS), dtype=np.float32),
        arc=np.zeros((n, 2, 3), dtype=np.float32),
        ends_s=np.ones((2, n, parts), dtype=np.float32),
    )
    zero = np.zeros((n, ch.CHANNELS), dtype=np.float32)
    return Blend(source, np.ones((n, parts), dtype=np.float32), zero, zero, known=False)


def compose(values: Layered, gate: Floats) -> tuple[Floats, Floats]:
    """What the layers say through their gates (n, L, CHANNELS): the wanted row and its change per second, (n, CHANNELS)
    each."""
    layer, _, value = values[0]
    both = value * gate[:, layer, None]
    for layer, who, value in values[1:]:
        if who is None:
            both += value * gate[:, layer, None]
        else:
            both[who] += value * gate[who, layer, None]
    return both[:, 0], both[:, 1]


def switch(
    bank: MotionBank,
    state: Blend,
    playback: Playback,
    events: Bools,
    values: Layered,
    base_s: Floats,
    arc: Floats,
    contact_frames: Floats,
    posture_layer: int,
    dt_s: float,
) -> Blend:
    """Take up new sources. events: (n, L) layers whose source jumped; base_s: (n,) length of a middling transition;
    arc: (n,) bow of the hands' ways; contact_frames: (n, 4, 4, 4) matrices of CONTACT_FRAMES as last shown."""
    who = np.flatnonzero(events.any(axis=1))
    if len(who) == len(events):
        return _switched(bank, state, playback, events, values, base_s, arc, contact_frames, posture_layer, dt_s)
    some = _switched(
        bank,
        _some(state, who),
        playback.of(who),
        events[who],
        of_some(values, who, len(events)),
        base_s[who],
        arc[who],
        contact_frames[who],
        posture_layer,
        dt_s,
    )
    source, age_s = {}, state.age_s.copy()
    for name, old in vars(state.source).items():
        source[name] = old.copy()
        source[name][_at(name, who)] = getattr(some.source, name)
    age_s[who] = some.age_s
    return replace(state, source=Source(**source), age_s=age_s)


def _at(name: str, who: NDArray[np.intp]) -> Any:
    """Where characters stand in an array of Source."""
    return (slice(None), who) if name in ("offset", "ends_s") else who


def _some(state: Blend, who: NDArray[np.intp]) -> Blend:
    source = Source(**{name: array[_at(name, who)] for name, array in vars(state.source).items()})
    return Blend(source, state.age_s[who], state.row[who], state.speed[who], state.known)


def _switched(
    bank: MotionBank,
    state: Blend,
    playback: Playback,
    events: Bools,
    values: Layered,
    base_s: Floats,
    arc: Floats,
    contact_frames: Floats,
    posture_layer: int,
    dt_s: float,
) -> Blend:
    """switch, of characters who all have an event."""
    layers, old = events.shape[1], state.source
    owned = bank.owned[playback.unit] & playback.active[:, :, None]
    gate, frame = _gates(bank, playback, owned, posture_layer)
    looks = (bank.looks[playback.unit] & playback.active).any(axis=1)
    source = replace(old, gate=gate, owned=owned, frame=frame, attention=np.where(looks, 0.0, 1.0))
    if not state.known:
        return replace(state, source=source)
    touched = owned | old.owned | (_TOUCHED & (np.arange(layers) != posture_layer)[:, None])
    fresh = (touched & events[:, :, None]).any(axis=1)
    goal, goal_speed = compose(values, gate)
    row, speed = _in_frames(state.row, state.speed, old.frame, frame, contact_frames)
    row = row + speed * np.float32(dt_s)
    row, speed = _same_side(row, speed, goal)
    offset, offset_speed = row - goal, speed - goal_speed
    arcs = _arcs(row, goal, arc, contact_frames[np.arange(len(row))[:, None], frame])
    span = _spans(offset, base_s)
    span[:, _ARMS] = np.maximum(span[:, _ARMS], ARC_PACE * np.sqrt(np.linalg.norm(arcs, axis=-1)))
    span = np.minimum(span, _until_stroke(bank, playback, owned))
    brake = np.minimum(_brakes(offset_speed), span)
    offset_speed *= brake[:, ch.PART_OF_CHANNEL]
    source = replace(
        source,
        offset=np.where(fresh[:, ch.PART_OF_CHANNEL], np.stack([offset, offset_speed]), old.offset),
        arc=np.where(fresh[:, _ARMS, None], arcs, old.arc),
        ends_s=np.where(fresh, np.stack([span, brake]), old.ends_s),
    )
    return replace(state, source=source, age_s=np.where(fresh, 0.0, state.age_s))


def advance_blend(state: Blend, values: Layered, dt_s: float) -> Blend:
    """The row now shown, the transitions' remains included."""
    source, age = state.source, state.age_s
    row, speed = compose(values, source.gate)
    if np.count_nonzero(age < source.ends_s[0]):
        _add_remains(source, age, row, speed)
    return Blend(source, age + dt_s, row, speed)


def _add_remains(source: Source, age_s: Floats, row: Floats, speed: Floats) -> None:
    """What is left of the transitions, added to row and speed.

    Quintic Hermite curves on u in [0, 1], v = 1 − u: value 1 → 0 is v³·(1 + 3u + 6u²), slope 1 → 0 is v³·(u + 3u²);
    whatever else they have vanishes at both ends. Their slopes are −30·u²v² and v²·(1 + 2u − 15u²).
    """
    u = np.minimum(age_s / source.ends_s, 1.0)
    v = 1.0 - u
    square = v * v
    curves = _CURVES[0] + u * (_CURVES[1] + u * _CURVES[2])
    curves[0] *= square * v
    curves[1] *= square / source.ends_s
    remains = curves.take(ch.PART_OF_CHANNEL, axis=-1)
    remains *= source.offset
    for shown, (of_offset, of_speed) in ((row, remains[0]), (speed, remains[1])):
        shown += of_offset
        shown += of_speed
    # The hands' arcs: a bump that starts and ends with no speed and no acceleration.
    u, v = u[0].take(_ARMS, axis=-1), v[0].take(_ARMS, axis=-1)
    rest = u * v
    square = rest * rest
    height, slope = 64.0 * square * rest, 192.0 * square * (v - u) / source.ends_s[0].take(_ARMS, axis=-1)
    row[:, ch.WRIST] += (source.arc * height[..., None]).reshape(-1, 6)
    speed[:, ch.WRIST] += (source.arc * slope[..., None]).reshape(-1, 6)


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


def _in_frames(
    row: Floats, speed: Floats, before: NDArray[np.intp], frame: NDArray[np.intp], contact_frames: Floats
) -> tuple[Floats, Floats]:
    """Row and speed with the hands expressed in their new contact frames; before, frame: (n, 2)."""
    if np.array_equal(frame, before):
        return row, speed
    who = np.arange(len(frame))[:, None]
    old, new = contact_frames[who, before], contact_frames[who, frame]
    back = new[..., :3, :3].swapaxes(-1, -2)
    turn = back @ old[..., :3, :3]
    shift = back @ (old[..., :3, 3:] - new[..., :3, 3:])
    turn_quat = bl.from_matrix(turn)
    row, speed = row.copy(), speed.copy()
    for array, moved in ((row, shift[..., 0]), (speed, 0.0)):
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
