"""Where every running unit stands in its clip, and what the mixed variants say at that moment (EMBOS eq. 5)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation.motion_bank import FPS, MotionBank
from game.core.springs import damper_fraction
from game.embos import mix_weights

__all__ = ["Playback", "advance_clock", "begin", "refresh", "sample", "start"]

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

FASTEST, SLOWEST = 1.0 / 0.75, 1.0 / 1.35
"""Limits of the playback rate as stretch of the natural length: never slower than 0.75, never faster than 1.35."""
HOLD_START, HOLD_END = 0.2, 0.8
"""Share of the part after the stroke that may be held when a unit has to last longer."""
HOLD_MOST = 0.8
"""A hold adds at most this share of the held part's own length, so that it never stands still."""
DRIFT_HALF_LIFE_S = 0.9
"""How fast a held posture follows the emotion through its variants."""
LEAST_WEIGHT = 0.02
"""Variants below this share are left out; it is subtracted first, so nothing jumps when one comes in."""
PRUNE_FROM = 8
"""From this many characters on it pays to gather only the variants in use."""


@dataclass(frozen=True, eq=False)
class Playback:
    """n characters, L layers.

    unit: (n, L). elapsed_s: (n, L) since the unit started (a posture: position in its loops). first, length:
    (n, L, 7) rows of the chosen variants and their frames. weight: (n, L, 7) of eq. 5. stroke, before_s: (n, L)
    frame and second of the stroke; after_rate: (n, L) frames per second after it. hold: (n, L, 3) start, length
    (frames of the clip) and added frames of the stretched middle; loop: (n, L, 3) first frame, frames, times.
    lap: (n, L) repeats already made. active: (n, L) False once a unit has played to its end.
    """

    unit: Ints
    elapsed_s: Floats
    first: NDArray[np.int32]
    length: Floats
    weight: Floats
    stroke: Floats
    before_s: Floats
    after_rate: Floats
    hold: Floats
    loop: Floats
    lap: Floats
    active: Bools


def start(bank: MotionBank, n: int, layers: int) -> Playback:
    """Nothing runs yet: unit −1 everywhere, so the first decisions begin everything."""
    shape = (n, layers)
    zero = np.zeros(shape, dtype=np.float32)
    return Playback(
        unit=np.full(shape, -1, dtype=np.intp),
        elapsed_s=zero,
        first=np.zeros((*shape, 7), dtype=np.int32),
        length=np.ones((*shape, 7), dtype=np.float32),
        weight=np.zeros((*shape, 7), dtype=np.float32),
        stroke=zero,
        before_s=zero,
        after_rate=zero,
        hold=np.zeros((*shape, 3), dtype=np.float32),
        loop=np.zeros((*shape, 3), dtype=np.float32),
        lap=zero,
        active=np.zeros(shape, dtype=bool),
    )


def begin(
    bank: MotionBank,
    state: Playback,
    fresh: Bools,
    unit: Ints,
    duration_s: Floats,
    weights: Floats,
    pick: Floats,
    posture_layer: int,
) -> Playback:
    """Start the units where fresh (n, L) is True; the other arguments are (n, L), weights (n, L, 7)."""
    who = np.nonzero(fresh)
    u = unit[who]
    w = weights[who]
    # A posture may be wanted in an emotion whose weights the planner left empty (rest): then neutral's own.
    slot = np.minimum((pick[who][:, None] * bank.count[u]).astype(np.intp), np.maximum(bank.count[u] - 1, 0))
    choice = (u[:, None], np.arange(7)[None, :], slot)
    first, length = bank.first[choice], bank.frames[choice]
    before = (w * bank.before_s[choice]).sum(-1)
    after = np.maximum((w * bank.after_s[choice]).sum(-1), 1.0 / FPS)
    stroke, last = bank.stroke[u], length[:, 0]
    is_posture = who[1] == posture_layer
    # After the stroke the clip is stretched within limits, then a middle part is repeated or slowed.
    wanted = np.maximum(duration_s[who] - before, 1.0 / FPS)
    played = np.clip(wanted, after * SLOWEST, after * FASTEST)
    rate = (last - stroke) / played
    extra = np.maximum(wanted - played, 0.0) * rate
    loop_frames = bank.loop_frames[u]
    times = np.where(loop_frames > 0, np.round(extra / np.maximum(loop_frames, 1.0)), 0.0)
    room = (HOLD_END - HOLD_START) * (last - stroke)
    held = np.where(loop_frames > 0, 0.0, np.minimum(extra, HOLD_MOST * room))

    def put(old: NDArray[Any], new: Any) -> NDArray[Any]:
        out = old.copy()
        out[who] = new
        return out

    phase = np.where(is_posture, np.modf(pick[who] * 7.31)[0] * (w * length).sum(-1) / FPS, 0.0)
    hold = np.stack([stroke + HOLD_START * (last - stroke), room + held, held], axis=-1)
    return replace(
        state,
        unit=put(state.unit, u),
        elapsed_s=put(state.elapsed_s, phase),
        first=put(state.first, first),
        length=put(state.length, length),
        weight=put(state.weight, w),
        stroke=put(state.stroke, stroke),
        before_s=put(state.before_s, before),
        after_rate=put(state.after_rate, rate),
        hold=put(state.hold, hold),
        loop=put(state.loop, np.stack([bank.loop_first[u], loop_frames, times], axis=-1)),
        lap=put(state.lap, np.zeros(len(u))),
        active=put(state.active, bank.count[u].any(axis=-1)),
    )


def advance_clock(state: Playback, dt_s: float) -> Playback:
    """Time passes for everything that runs."""
    return replace(state, elapsed_s=state.elapsed_s + np.float32(dt_s))


def refresh(bank: MotionBank, state: Playback, emotion: Floats, posture_layer: int, dt_s: float) -> Playback:
    """A held posture drifts toward the present emotion's mix (eq. 5), slowly enough never to flicker."""
    unit = state.unit[:, posture_layer]
    goal = mix_weights(np.asarray(emotion, dtype=np.float64), bank.intensity[unit], bank.count[unit] > 0)
    weight = state.weight.copy()
    held = weight[:, posture_layer]
    held += (goal - held) * np.float32(damper_fraction(DRIFT_HALF_LIFE_S, dt_s))
    return replace(state, weight=weight)


def _played(state: Playback) -> tuple[Floats, Floats, Floats]:
    """Frame (n, L) in a unit that plays once, frames per second there, and the repeats made so far."""
    before = state.elapsed_s < state.before_s
    lead = state.stroke / np.maximum(state.before_s, 1e-6)
    past = state.elapsed_s - state.before_s
    at = np.where(before, state.elapsed_s * lead, state.stroke + past * state.after_rate)
    rate = np.where(before, lead, state.after_rate)
    loop_first, loop_frames, times = state.loop[..., 0], state.loop[..., 1], state.loop[..., 2]
    lap = np.clip(np.floor((at - loop_first) / np.maximum(loop_frames, 1.0)), 0.0, times)
    at = at - lap * loop_frames
    hold_first, hold_length, held = state.hold[..., 0], state.hold[..., 1], state.hold[..., 2]
    if held.any():
        length = np.maximum(hold_length, 1e-6)
        u = 2.0 * np.pi * np.clip((at - hold_first) / length, 0.0, 1.0)
        at = at - held * (u - np.sin(u)) / (2.0 * np.pi)
        rate = rate * (1.0 - held / length * (1.0 - np.cos(u)))
    return at.astype(np.float32), rate.astype(np.float32), lap


def sample(bank: MotionBank, state: Playback, posture_layer: int) -> tuple[Floats, Playback, Bools]:
    """What every layer says now.

    -> values and their change per second (n, L, 2, CHANNELS); the state with laps and ends noted; jumped (n, L):
    True where a unit went back to repeat its middle, or came to its end.
    """
    n, layers = state.unit.shape
    at, rate, lap = _played(state)
    last = state.length[:, :, 0]
    ended = state.active & (at >= last)
    ended[:, posture_layer] = False
    jumped = ended | (lap != state.lap)
    state = replace(state, lap=lap, active=state.active & ~ended)
    frame = np.repeat(np.clip(at, 0.0, last)[:, :, None], 7, axis=2)
    loops = state.length[:, posture_layer]
    frame[:, posture_layer] = np.fmod(state.elapsed_s[:, posture_layer, None] * np.float32(FPS), loops)
    rate[:, posture_layer] = FPS
    low = np.minimum(frame.astype(np.int32), (state.length - 1).astype(np.int32))
    part = frame - low
    index = state.first + low
    weight = np.maximum(state.weight - np.float32(LEAST_WEIGHT), 0.0)
    weight = weight / np.maximum(weight.sum(axis=-1, keepdims=True), np.float32(1e-9))
    if n >= PRUNE_FROM:
        keep = max(int((weight > 0.0).sum(axis=-1).max()), 1)
        if keep < 7:
            best = np.argpartition(-weight, keep - 1, axis=-1)[..., :keep]
            index, weight, part = (np.take_along_axis(a, best, axis=-1) for a in (index, weight, part))
    kinds = weight.shape[-1]
    mix = np.empty((n, layers, 2, 2, kinds), dtype=np.float32)
    np.multiply(weight, part, out=mix[:, :, 0, 1])
    np.subtract(weight, mix[:, :, 0, 1], out=mix[:, :, 0, 0])
    np.multiply(weight, rate[:, :, None], out=mix[:, :, 1, 1])
    np.negative(mix[:, :, 1, 1], out=mix[:, :, 1, 0])
    both = np.empty((n, layers, 2, kinds), dtype=np.int32)
    both[:, :, 0] = index
    np.add(index, 1, out=both[:, :, 1])
    rows = bank.rows.take(both.reshape(n, layers, 2 * kinds), axis=0)
    return mix.reshape(n, layers, 2, 2 * kinds) @ rows, state, jumped
