"""Where every running unit stands in its clip, and what the mixed variants say at that moment (EMBOS eq. 5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation.motion_bank import FPS, MotionBank

__all__ = ["Playback", "advance_playback", "begin", "start"]

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


# Columns of Playback.timing.
(
    _BEFORE_S,
    _LEAD_RATE,
    _AFTER_RATE,
    _HOLD_FIRST,
    _HOLD_LENGTH,
    _HELD,
    _LOOP_FIRST,
    _LOOP_FRAMES,
    _LOOP_TIMES,
) = range(9)


@dataclass(frozen=True, eq=False)
class Playback:
    """n characters, L layers.

    unit: (n, L). first, length: (n, L, 7) rows of the chosen variants and their frames. weight: (n, L, 7) of eq. 5.
    timing: (n, L, 9) second of the stroke, frames per second before and after it, first frame, length
    and added frames of a stretched middle, first frame, frames and times of a repeated one. elapsed_s: (n, L) since
    the unit started (a posture: position in its loops). lap: (n, L) repeats already made. active: (n, L) False once
    a unit has played to its end.
    """

    unit: Ints
    first: NDArray[np.int32]
    length: Floats
    weight: Floats
    timing: Floats
    elapsed_s: Floats
    lap: Floats
    active: Bools

    @property
    def to_stroke_s(self) -> Floats:
        """(n, L) seconds until the stroke, negative after it."""
        return np.asarray(self.timing[..., _BEFORE_S] - self.elapsed_s)


def start(n: int, layers: int) -> Playback:
    """Nothing runs yet: unit −1 everywhere, so the first decisions begin everything."""
    shape = (n, layers)
    return Playback(
        unit=np.full(shape, -1, dtype=np.intp),
        first=np.zeros((*shape, 7), dtype=np.int32),
        length=np.ones((*shape, 7), dtype=np.float32),
        weight=np.zeros((*shape, 7), dtype=np.float32),
        timing=np.zeros((*shape, 9), dtype=np.float32),
        elapsed_s=np.zeros(shape, dtype=np.float32),
        lap=np.zeros(shape, dtype=np.float32),
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
    dt_s: float,
) -> Playback:
    """Start the units where fresh (n, L) is True; the other arguments are (n, L), weights (n, L, 7).

    Comes before the tick's advance_playback, which plays their first frame.
    """
    who = np.nonzero(fresh)
    u = unit[who]
    w = weights[who]
    slot = np.minimum((pick[who][:, None] * bank.count[u]).astype(np.intp), np.maximum(bank.count[u] - 1, 0))
    choice = (u[:, None], np.arange(7)[None, :], slot)
    first, length = bank.first[choice], bank.frames[choice]
    before = (w * bank.before_s[choice]).sum(-1)
    after = np.maximum((w * bank.after_s[choice]).sum(-1), 1.0 / FPS)
    stroke, last = bank.stroke[u], length[:, 0]
    # After the stroke the clip is stretched within limits, then a middle part is repeated or slowed.
    wanted = np.maximum(duration_s[who] - before, 1.0 / FPS)
    played = np.clip(wanted, after * SLOWEST, after * FASTEST)
    rate = (last - stroke) / played
    extra = np.maximum(wanted - played, 0.0) * rate
    loop_frames = bank.loop_frames[u]
    room = (HOLD_END - HOLD_START) * (last - stroke)
    held = np.where(loop_frames > 0, 0.0, np.minimum(extra, HOLD_MOST * room))
    timing = np.empty((len(u), 9), dtype=np.float32)
    timing[:, _BEFORE_S] = before
    timing[:, _LEAD_RATE], timing[:, _AFTER_RATE] = stroke / np.maximum(before, 1e-6), rate
    timing[:, _HOLD_FIRST], timing[:, _HOLD_LENGTH] = stroke + HOLD_START * (last - stroke), room + held
    timing[:, _HELD], timing[:, _LOOP_FIRST], timing[:, _LOOP_FRAMES] = held, bank.loop_first[u], loop_frames
    timing[:, _LOOP_TIMES] = np.where(loop_frames > 0, np.round(extra / np.maximum(loop_frames, 1.0)), 0.0)
    # Postures come in anywhere in their loop, so that the same one does not look the same twice.
    phase = np.where(who[1] == posture_layer, np.modf(pick[who] * 7.31)[0] * (w * length).sum(-1) / FPS, 0.0)

    def put(old: NDArray[Any], new: Any) -> NDArray[Any]:
        out = old.copy()
        out[who] = new
        return out

    return Playback(
        unit=put(state.unit, u),
        first=put(state.first, first),
        length=put(state.length, length),
        weight=put(state.weight, w),
        timing=put(state.timing, timing),
        elapsed_s=put(state.elapsed_s, phase - dt_s),
        lap=put(state.lap, 0.0),
        active=put(state.active, bank.count[u].any(axis=-1)),
    )


def _drifted(bank: MotionBank, state: Playback, emotion: Floats, posture_layer: int, dt_s: float) -> Floats:
    """Weights with the held posture's drawn toward the present emotion's mix, slowly enough never to flicker.

    Eq. 5's exponent is −(|i'|² − 2·i'_k·i_k + i_k²)/r²; what is the same for all k cancels in the shares.
    """
    unit = state.unit[:, posture_layer]
    exponent = emotion * bank.mix_slope[unit] + bank.mix_level[unit]
    goal = np.exp(exponent - exponent.max(axis=1, keepdims=True))
    goal /= goal.sum(axis=1, keepdims=True)
    weight = state.weight.copy()
    held = weight[:, posture_layer]
    held += (goal - held) * np.float32(1.0 - 2.0 ** (-dt_s / DRIFT_HALF_LIFE_S))
    return weight


def _played(state: Playback, elapsed_s: Floats) -> tuple[Floats, Floats, Floats]:
    """Frame (n, L) in a unit that plays once, frames per second there, and the repeats made so far."""
    if np.count_nonzero(state.active) == len(elapsed_s):
        # Only postures are running, and those loop.
        nothing = np.zeros_like(elapsed_s)
        return nothing, nothing.copy(), state.lap
    before, lead, after, hold_first, hold_length, held, loop_first, loop_frames, times = state.timing.transpose(2, 0, 1)
    past = elapsed_s - before
    at = np.minimum(elapsed_s, before) * lead + np.maximum(past, np.float32(0.0)) * after
    rate = np.where(past < 0.0, lead, after)
    lap = state.lap
    if np.count_nonzero(times):
        lap = np.clip(np.floor((at - loop_first) / np.maximum(loop_frames, 1.0)), 0.0, times)
        at = at - lap * loop_frames
    if np.count_nonzero(held):
        length = np.maximum(hold_length, 1e-6)
        u = np.float32(2.0 * np.pi) * np.clip((at - hold_first) / length, 0.0, 1.0)
        at = at - held * (u - np.sin(u)) * np.float32(0.5 / np.pi)
        rate = rate * (1.0 - held / length * (1.0 - np.cos(u)))
    return at, rate, lap


def advance_playback(
    bank: MotionBank, state: Playback, emotion: Floats, posture_layer: int, dt_s: float
) -> tuple[Floats, Playback, Bools]:
    """Time passes for everything that runs.

    -> values and their change per second of every layer (n, L, 2, CHANNELS); the state; jumped (n, L): True where a
    unit went back to repeat its middle, or came to its end.
    """
    n, layers = state.unit.shape
    elapsed = state.elapsed_s + np.float32(dt_s)
    at, rate, lap = _played(state, elapsed)
    last = state.length[:, :, 0]
    ended = state.active & (at >= last)
    ended[:, posture_layer] = False
    jumped = ended | (lap != state.lap)
    weight = _drifted(bank, state, emotion, posture_layer, dt_s)
    state = Playback(state.unit, state.first, state.length, weight, state.timing, elapsed, lap, state.active & ~ended)
    frame = np.empty((n, layers, 7), dtype=np.float32)
    frame[:] = np.minimum(at, last)[:, :, None]
    frame[:, posture_layer] = np.fmod(elapsed[:, posture_layer, None] * np.float32(FPS), state.length[:, posture_layer])
    rate[:, posture_layer] = FPS
    low = np.minimum(frame, state.length - 1).astype(np.int32)
    part = frame - low
    index = state.first + low
    weight = np.maximum(weight - np.float32(LEAST_WEIGHT), np.float32(0.0))
    weight /= np.maximum(weight.sum(axis=-1, keepdims=True), np.float32(1e-9))
    if n >= PRUNE_FROM:
        keep = max(int((weight > 0.0).sum(axis=-1).max()), 1)
        if keep < 7:
            best = np.argpartition(-weight, keep - 1, axis=-1)[..., :keep]
            index, weight, part = (np.take_along_axis(a, best, axis=-1) for a in (index, weight, part))
    return _mixed(bank, index, weight, part, rate), state, jumped


def _mixed(bank: MotionBank, index: NDArray[np.int32], weight: Floats, part: Floats, rate: Floats) -> Floats:
    """Rows at index and the next one, mixed by weight (n, L, k) and by part of the way -> (n, L, 2, CHANNELS)."""
    n, layers, kinds = weight.shape
    mix = np.empty((n, layers, 2, 2, kinds), dtype=np.float32)
    upper = np.multiply(weight, part, out=mix[:, :, 0, 1])
    np.subtract(weight, upper, out=mix[:, :, 0, 0])
    change = np.multiply(weight, rate[:, :, None], out=mix[:, :, 1, 1])
    np.negative(change, out=mix[:, :, 1, 0])
    both = np.empty((n, layers, 2, kinds), dtype=np.int32)
    both[:, :, 0] = index
    np.add(index, 1, out=both[:, :, 1])
    rows = bank.rows.take(both.reshape(n, layers, 2 * kinds), axis=0)
    return np.asarray(mix.reshape(n, layers, 2, 2 * kinds) @ rows)
