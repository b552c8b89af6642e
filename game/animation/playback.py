"""Where every running unit stands in its clip, and what the mixed variants say at that moment (EMBOS eq. 5)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import pace
from game.animation.motion_bank import FPS, MotionBank
from game.animation.pace import Stretch, next_stretch

__all__ = ["Layered", "Playback", "advance_playback", "begin", "of_some", "speeds", "start"]

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
PIECE = 128
"""Characters whose rows are gathered at a time: what is mixed next is still in the cache."""

_THIS_AND_NEXT = np.array([[0], [1]])
_SUM = np.ones((7, 7), dtype=np.float32)
_NONE, _LEAST = np.zeros((), dtype=np.float32), np.array(LEAST_WEIGHT, dtype=np.float32)
for _table in (_THIS_AND_NEXT, _SUM, _NONE, _LEAST):
    _table.setflags(write=False)

Layered = list[tuple[int, Ints | None, Floats]]
"""What layers say: layer, the characters in whom it runs (None: all), and for them (m, CHANNELS). The posture's comes
first."""


@dataclass(frozen=True, eq=False)
class Playback:
    """n characters, L layers.

    unit: (n, L). first: (n, L, 2, 7) rows of the chosen variants, and the next ones. lap_frames: (n, L, 7) frames a
    posture's loops take, ∞ for what is played once; before_last: (n, L, 7) the last frame but one. weight: (n, L, 7) of
    eq. 5, as mixed. held: (n, 7) the posture's before the least were left out, which drift. timing: (10, n, L) of
    game.animation.pace. elapsed_s: (n, L) since the unit started (a posture: position in its loops). lap: (n, L)
    repeats already made. active: (n, L) False once a unit has played to its end; running: in how many, by layer.
    calm_s: all units go on at an even pace for so long. index: (n, L, 2, 7) rows last shown.
    """

    unit: Ints
    first: Floats
    lap_frames: Floats
    before_last: Floats
    weight: Floats
    held: Floats
    timing: Floats
    elapsed_s: Floats
    lap: Floats
    active: Bools
    running: tuple[int, ...]
    stretch: Stretch
    calm_s: float
    index: Ints

    @property
    def to_stroke_s(self) -> Floats:
        """(n, L) seconds until the stroke, negative after it."""
        return np.asarray(self.timing[pace.BEFORE_S] - self.elapsed_s)

    def of(self, who: Ints) -> Playback:
        """Some of the characters."""
        arrays = {name: array[:, who] if name == "timing" else array[who] for name, array in _arrays(self)}
        stretch = Stretch(**{name: array[who] for name, array in _arrays(self.stretch)})
        return Playback(**arrays, running=_running(arrays["active"]), stretch=stretch, calm_s=self.calm_s)


def _arrays(state: Playback | Stretch) -> list[tuple[str, NDArray[Any]]]:
    return [(name, value) for name, value in vars(state).items() if isinstance(value, np.ndarray)]


def _running(active: Bools) -> tuple[int, ...]:
    return tuple(np.count_nonzero(active, axis=0).tolist())


def of_some(values: Layered, who: Ints, n: int) -> Layered:
    """What the layers say of some of n characters."""
    place = np.full(n, -1, dtype=np.intp)
    place[who] = np.arange(len(who))
    some: Layered = []
    for layer, running, value in values:
        if running is None:
            some.append((layer, None, value[who]))
            continue
        here = place[running]
        some.append((layer, here[here >= 0], value[here >= 0]))
    return some


def start(n: int, layers: int) -> Playback:
    """Nothing runs yet: unit −1 everywhere, so the first decisions begin everything."""
    shape = (n, layers)
    return Playback(
        unit=np.full(shape, -1, dtype=np.intp),
        first=np.zeros((*shape, 2, 7), dtype=np.float32),
        lap_frames=np.ones((*shape, 7), dtype=np.float32),
        before_last=np.zeros((*shape, 7), dtype=np.float32),
        weight=np.zeros((*shape, 7), dtype=np.float32),
        held=np.zeros((n, 7), dtype=np.float32),
        timing=np.zeros((10, *shape), dtype=np.float32),
        elapsed_s=np.zeros(shape, dtype=np.float32),
        lap=np.zeros(shape, dtype=np.float32),
        active=np.zeros(shape, dtype=bool),
        running=(0,) * layers,
        stretch=pace.unknown(shape),
        calm_s=0.0,
        index=np.zeros((*shape, 2, 7), dtype=np.intp),
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
    loops = who[1] == posture_layer
    timing = np.empty((10, len(u)), dtype=np.float32)
    # A posture never comes to its stroke or its end.
    timing[pace.BEFORE_S], timing[pace.LAST] = np.where(loops, np.inf, before), np.where(loops, np.inf, last)
    timing[pace.LEAD_RATE], timing[pace.AFTER_RATE] = np.where(loops, FPS, stroke / np.maximum(before, 1e-6)), rate
    timing[pace.HOLD_FIRST], timing[pace.HOLD_LENGTH] = stroke + HOLD_START * (last - stroke), room + held
    timing[pace.HELD], timing[pace.LOOP_FIRST], timing[pace.LOOP_FRAMES] = (
        np.where(loops, 0.0, held),
        bank.loop_first[u],
        loop_frames,
    )
    timing[pace.LOOP_TIMES] = np.where(loop_frames > 0, np.round(extra / np.maximum(loop_frames, 1.0)), 0.0)
    # Postures come in anywhere in their loop, so that the same one does not look the same twice.
    phase = np.where(loops, np.modf(pick[who] * 7.31)[0] * (w * length).sum(-1) / FPS, 0.0)

    def put(old: NDArray[Any], new: Any) -> NDArray[Any]:
        out = old.copy()
        out[who] = new
        return out

    timings = state.timing.copy()
    timings[:, who[0], who[1]] = timing
    held_weight = state.held.copy()
    held_weight[who[0][loops]] = w[loops]
    active = put(state.active, bank.count[u].any(axis=-1))
    return Playback(
        unit=put(state.unit, u),
        first=put(state.first, first[:, None] + _THIS_AND_NEXT),
        lap_frames=put(state.lap_frames, np.where(loops[:, None], length, np.inf)),
        before_last=put(state.before_last, length - 1.0),
        weight=put(state.weight, _shares(w)),
        held=held_weight,
        timing=timings,
        elapsed_s=put(state.elapsed_s, phase - dt_s),
        lap=put(state.lap, 0.0),
        active=active,
        running=_running(active),
        stretch=replace(state.stretch, until_s=put(state.stretch.until_s, -np.inf)),
        calm_s=0.0,
        index=state.index,
    )


def _shares(weight: Floats) -> Floats:
    """Weights (..., 7) as they are mixed: the least left out, the sum 1."""
    shares = weight - _LEAST
    np.maximum(shares, _NONE, out=shares)
    total = shares @ _SUM
    # All are at most the least only where there is no variant at all.
    shares /= np.maximum(total, _LEAST, out=total)
    return np.asarray(shares)


def _drifted(bank: MotionBank, weight: Floats, unit: Ints, emotion: Floats, gain: Floats) -> Floats:
    """The held postures' weights (n, 7) drawn toward the present emotion's mix, slowly enough never to flicker.

    Eq. 5's exponent is −(|i'|² − 2·i'_k·i_k + i_k²)/r²; what is the same for all k cancels in the shares.
    """
    goal = bank.mix_slope.take(unit, axis=0)
    goal *= emotion.astype(np.float32)
    goal += bank.mix_level.take(unit, axis=0)
    if bank.steep:
        goal -= np.maximum.reduce(goal, axis=1, keepdims=True)
    np.exp(goal, out=goal)
    goal /= goal @ _SUM
    goal -= weight
    goal *= gain
    goal += weight
    return goal


@lru_cache(maxsize=16)
def _step(dt_s: float) -> tuple[Floats, Floats]:
    """A tick's length and how far a posture's weights drift in it, as arrays: NumPy is slower with Python's numbers."""
    made = np.array([dt_s, 1.0 - 2.0 ** (-dt_s / DRIFT_HALF_LIFE_S)], dtype=np.float32)
    made.setflags(write=False)
    return made[0, ...], made[1, ...]


def advance_playback(
    bank: MotionBank, state: Playback, emotion: Floats, posture_layer: int, dt_s: float
) -> tuple[Layered, Playback, Bools | None]:
    """Time passes for everything that runs.

    -> what the running layers say; the state; jumped (n, L): True where a unit went back to repeat its middle, or came
    to its end, None where none did.
    """
    step, gain = _step(dt_s)
    elapsed, stretch, calm_s = state.elapsed_s + step, state.stretch, state.calm_s - dt_s
    active, running, lap, jumped = state.active, state.running, state.lap, None
    if calm_s <= 0.0:
        due = elapsed >= stretch.until_s
        stretch, lap, ended = next_stretch(stretch, due, active, state.timing, state.lap_frames, elapsed, lap)
        jumped = ended | (lap != state.lap)
        if np.count_nonzero(ended):
            active = active & ~ended
            running = _running(active)
        calm_s = float((stretch.until_s - elapsed).min())
    at = elapsed * stretch.rate
    at += stretch.base
    frame = at[:, :, None] - stretch.wrapped
    held = _drifted(bank, state.held, state.unit[:, posture_layer], emotion, gain)
    weight = state.weight.copy()
    weight[:, posture_layer] = _shares(held)
    # Where every variant is in its clip: the frame before and the share of the way to the next.
    low = np.trunc(frame)
    np.minimum(low, state.before_last, out=low)
    frame -= low
    index = (low[:, :, None] + state.first).astype(np.intp)
    mix = np.empty((*weight.shape[:2], 2, 7), dtype=np.float32)
    after = np.multiply(weight, frame, out=mix[:, :, 1])
    np.subtract(weight, after, out=mix[:, :, 0])
    state = Playback(
        state.unit, state.first, state.lap_frames, state.before_last, weight, held,
        state.timing, elapsed, lap, active, running, stretch, calm_s, index,
    )  # fmt: skip
    values = _mixed(bank, state, mix, posture_layer)
    return values, state, jumped


def speeds(bank: MotionBank, state: Playback, posture_layer: int) -> Layered:
    """How fast what the running layers say changes, per second."""
    mix = np.empty((*state.weight.shape[:2], 2, 7), dtype=np.float32)
    after = np.multiply(state.weight, state.stretch.rate[:, :, None], out=mix[:, :, 1])
    np.negative(after, out=mix[:, :, 0])
    return _mixed(bank, state, mix, posture_layer)


@lru_cache(maxsize=16)
def _order(posture_layer: int, layers: int) -> tuple[int, ...]:
    return posture_layer, *(layer for layer in range(layers) if layer != posture_layer)


def _mixed(bank: MotionBank, state: Playback, mix: Floats, posture_layer: int) -> Layered:
    """Rows at the state's index, mixed (n, L, 2, 7)."""
    n = len(mix)
    values: Layered = []
    for layer in _order(posture_layer, len(state.running)):
        who, running = None, state.running[layer]
        if running == 0:
            continue
        frames, shares = state.index[:, layer], mix[:, layer]
        if running < n:
            who = np.flatnonzero(state.active[:, layer])
            frames, shares = frames.take(who, axis=0), shares.take(who, axis=0)
        frames, shares = frames.reshape(running, -1), shares.reshape(running, 1, -1)
        values.append((layer, who, _sums(bank.rows, frames, shares)))
    return values


def _sums(rows: Floats, frames: Ints, shares: Floats) -> Floats:
    """rows: (R, CHANNELS) at frames (m, k), added up by shares (m, 1, k)."""
    if len(frames) <= PIECE:
        return (shares @ rows.take(frames, axis=0))[:, 0]
    total = np.empty((len(frames), 1, rows.shape[1]), dtype=np.float32)
    for first in range(0, len(frames), PIECE):
        some = slice(first, first + PIECE)
        np.matmul(shares[some], rows.take(frames[some], axis=0), out=total[some])
    return total[:, 0]
