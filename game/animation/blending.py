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
from game.animation.playback import Layered, Playback, of_some, speeds
from game.core.humanoid import TABLE_TOP_M

__all__ = ["Blend", "advance_blend", "compose", "shown_speed", "start_blend", "switch"]

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


def _shapes() -> Floats:
    """(2, 4, 3, 1, PARTS): coefficients of v⁰ … v³ in the three curves (_add_remains) and in their slopes."""
    curves = np.array([[10, 4, 64], [-15, -7, -192], [6, 3, 192], [0, 0, -64]], dtype=np.float32)
    slopes = curves * -np.arange(3, 7, dtype=np.float32)[:, None]
    both = np.stack([curves, slopes])[..., None, None]
    both = np.ascontiguousarray(np.broadcast_to(both, (2, 4, 3, 1, len(ch.PARTS))))
    both.setflags(write=False)
    return both


_CURVES, _SLOPES = _shapes()
_TOUCHED = np.array([part in ("spine", "head", "left_arm", "right_arm") for part in ch.PARTS])
_TOUCHED.setflags(write=False)
_NONE = np.zeros((), dtype=np.float32)
_NONE.setflags(write=False)
_PART_JOINTS = tuple(np.flatnonzero(p == ch.PART_OF_JOINT) for p in range(len(ch.PARTS)))
_ARMS = [ch.PARTS.index("left_arm"), ch.PARTS.index("right_arm")]


@dataclass(frozen=True, eq=False)
class Source:
    """What n characters' rows are made of since their last switch. gate: (n, L, CHANNELS) share of each layer. owned:
    (n, L, PARTS) what each layer's unit owns. frame: (n, 2) contact frame of the hands. attention: (n,) 0 where a unit
    moves the gaze itself, else 1. remains: (3, n, CHANNELS) how far what was shown lay from what was wanted, how much
    faster it moved, the latter times its brake, and how far the hands' ways bow in their contact frames. pace: (3, n,
    PARTS) what of them dies away per second: 1 / span, 1 / brake, 1 / span."""

    gate: Floats
    owned: Bools
    frame: NDArray[np.intp]
    attention: Floats
    remains: Floats
    pace: Floats


@dataclass(frozen=True, eq=False)
class Blend:
    """n characters. left: (3, n, PARTS) of the transitions 1 when they begin .. 0; busy_s: until the last of them ends.
    row: (n, CHANNELS) shown at the last tick. speed: how fast that changed, where it does not follow from the rest.
    known: False before the first."""

    source: Source
    left: Floats
    busy_s: float
    row: Floats
    speed: Floats | None = None
    known: bool = True


def start_blend(n: int, layers: int) -> Blend:
    """Before the first tick: whatever comes is taken as it is."""
    parts = len(ch.PARTS)
    source = Source(
        gate=np.zeros((n, layers, ch.CHANNELS), dtype=np.float32),
        owned=np.zeros((n, layers, parts), dtype=bool),
        frame=np.zeros((n, 2), dtype=np.intp),
        attention=np.ones(n),
        remains=np.zeros((3, n, ch.CHANNELS), dtype=np.float32),
        pace=np.ones((3, n, parts), dtype=np.float32),
    )
    left, row = np.zeros((3, n, parts), dtype=np.float32), np.zeros((n, ch.CHANNELS), dtype=np.float32)
    return Blend(source, left, 0.0, row, known=False)


def compose(values: Layered, gate: Floats) -> Floats:
    """What the layers say through their gates (n, L, CHANNELS), together (n, CHANNELS)."""
    layer, _, value = values[0]
    row = value * gate[:, layer]
    for layer, who, value in values[1:]:
        if who is None:
            value *= gate[:, layer]
            row += value
        else:
            row[who] += value * gate[who, layer]
    return row


def shown_speed(bank: MotionBank, state: Blend, playback: Playback, posture_layer: int) -> Floats:
    """(n, CHANNELS) how fast the row last shown was changing, per second; playback: as it was at that tick."""
    if state.speed is not None:
        return state.speed
    if not state.known:
        return np.zeros_like(state.row)
    speed = compose(speeds(bank, playback, posture_layer), state.source.gate)
    if state.busy_s > 0.0:
        square = state.left * state.left
        square *= state.source.pace
        _add_remains(state.source, square, _polynomial(_SLOPES, state.left), speed)
    return speed


def switch(
    bank: MotionBank,
    state: Blend,
    before: Playback,
    playback: Playback,
    events: Bools,
    values: Layered,
    base_s: Floats,
    arc: Floats,
    contact_frames: Floats,
    posture_layer: int,
    dt_s: float,
) -> Blend:
    """Take up new sources. before, playback: at the last tick and now; events: (n, L) layers whose source jumped;
    base_s: (n,) length of a middling transition; arc: (n,) bow of the hands' ways; contact_frames: (n, 4, 4, 4)
    matrices of CONTACT_FRAMES as last shown."""
    who = np.flatnonzero(events.any(axis=1))
    if len(who) == len(events):
        return _switched(
            bank, state, before, playback, events, values, base_s, arc, contact_frames, posture_layer, dt_s
        )
    some = _switched(
        bank,
        _some(state, who),
        before.of(who),
        playback.of(who),
        events[who],
        of_some(values, who, len(events)),
        base_s[who],
        arc[who],
        contact_frames[who],
        posture_layer,
        dt_s,
    )
    source, left = {}, state.left.copy()
    for name, old in vars(state.source).items():
        source[name] = old.copy()
        source[name][_at(name, who)] = getattr(some.source, name)
    left[:, who] = some.left
    return replace(state, source=Source(**source), left=left, busy_s=max(state.busy_s, some.busy_s))


def _at(name: str, who: NDArray[np.intp]) -> Any:
    """Where characters stand in an array of Source."""
    return (slice(None), who) if name in ("remains", "pace") else who


def _some(state: Blend, who: NDArray[np.intp]) -> Blend:
    source = Source(**{name: array[_at(name, who)] for name, array in vars(state.source).items()})
    speed = None if state.speed is None else state.speed[who]
    return Blend(source, state.left[:, who], state.busy_s, state.row[who], speed, state.known)


def _switched(
    bank: MotionBank,
    state: Blend,
    before: Playback,
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
    goal = compose([(layer, some, value.copy()) for layer, some, value in values], gate)
    goal_speed = compose(speeds(bank, playback, posture_layer), gate)
    speed = shown_speed(bank, state, before, posture_layer)
    row, speed = _in_frames(state.row, speed, old.frame, frame, contact_frames)
    row = row + speed * np.float32(dt_s)
    row, speed = _same_side(row, speed, goal)
    offset, offset_speed = row - goal, speed - goal_speed
    arcs = _arcs(row, goal, arc, contact_frames[np.arange(len(row))[:, None], frame])
    span = _spans(offset, base_s)
    span[:, _ARMS] = np.maximum(span[:, _ARMS], ARC_PACE * np.sqrt(np.linalg.norm(arcs, axis=-1)))
    span = np.minimum(span, _until_stroke(bank, playback, owned))
    brake = np.minimum(_brakes(offset_speed), span)
    offset_speed *= brake[:, ch.PART_OF_CHANNEL]
    bows = np.zeros_like(offset)
    bows[:, ch.WRIST] = arcs.reshape(len(row), -1)
    now = fresh[:, ch.PART_OF_CHANNEL]
    source = replace(
        source,
        remains=np.where(now, np.stack([offset, offset_speed, bows]), old.remains),
        pace=np.where(fresh, 1.0 / np.stack([span, brake, span]), old.pace),
    )
    # The tick that comes now takes its share of what is left: it shows the beginning.
    left = np.where(fresh, 1.0 + source.pace * np.float32(dt_s), state.left)
    return replace(state, source=source, left=left, busy_s=max(state.busy_s, float(span.max()) + 2.0 * dt_s))


def advance_blend(state: Blend, values: Layered, dt_s: float) -> Blend:
    """The row now shown, the transitions' remains included."""
    row = compose(values, state.source.gate)
    if state.busy_s <= 0.0:
        return Blend(state.source, state.left, 0.0, row)
    left = state.left - state.source.pace * np.float32(dt_s)
    np.maximum(left, _NONE, out=left)
    cube = left * left
    cube *= left
    _add_remains(state.source, cube, _polynomial(_CURVES, left), row)
    return Blend(state.source, left, state.busy_s - dt_s, row)


def _polynomial(shapes: Floats, left: Floats) -> Floats:
    """shapes: (4, 3, 1, PARTS) coefficients; left: (3, n, PARTS) -> (3, n, PARTS)."""
    lowest, linear, square, cubic = shapes
    sums = cubic * left
    for coefficient in (square, linear):
        sums += coefficient
        sums *= left
    sums += lowest
    return np.asarray(sums)


def _add_remains(source: Source, power: Floats, curve: Floats, shown: Floats) -> None:
    """Add what is left of the transitions to shown.

    With v in [1, 0] what is left of their time and u = 1 − v: quintic Hermite curves of value 1 → 0,
    v³·(1 + 3u + 6u²), and of slope 1 → 0, v³·(u + 3u²), which have no speed and acceleration but this at either end;
    and for the hands' bows a bump of height 1 with neither, 64·u³v³. power: v³, or v² of their slopes.
    """
    curve *= power
    remains = curve.take(ch.PART_OF_CHANNEL, axis=-1)
    remains *= source.remains
    for part in remains:
        shown += part


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
