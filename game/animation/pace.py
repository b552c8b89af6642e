"""How fast a unit goes through its clip: in stretches of even pace, whose ends are known beforehand.

Between them a frame is a product and a sum. A middle that is slowed down (held) has no even pace: there every tick is
a stretch of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Stretch", "next_stretch", "unknown"]

Floats = NDArray[np.floating[Any]]
Bools = NDArray[np.bool_]

EARLY_S = 1e-4
"""A stretch is left this long before its end, so that rounding never makes it last too long."""

(
    BEFORE_S,
    LEAD_RATE,
    AFTER_RATE,
    HOLD_FIRST,
    HOLD_LENGTH,
    HELD,
    LOOP_FIRST,
    LOOP_FRAMES,
    LOOP_TIMES,
    LAST,
) = range(10)
"""Rows of a timing (10, n, L): second of the stroke, frames per second before and after it, first frame, length and
added frames of a stretched middle, first frame, frames and times of a repeated one, last frame."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """Where n characters' units stand while they go on at an even pace: frame = elapsed_s·rate + base.

    rate: (n, L) frames per second; base: (n, L); wrapped: (n, L, 7) frames of the loops that are over; until_s: (n, L)
    the pace, a loop or the unit ends then (−∞: not known yet).
    """

    rate: Floats
    base: Floats
    wrapped: Floats
    until_s: Floats


def unknown(shape: tuple[int, int]) -> Stretch:
    """Of (n, L) units that have not begun."""
    return Stretch(
        rate=np.zeros(shape, dtype=np.float32),
        base=np.zeros(shape, dtype=np.float32),
        wrapped=np.zeros((*shape, 7), dtype=np.float32),
        until_s=np.full(shape, -np.inf, dtype=np.float32),
    )


def next_stretch(
    stretch: Stretch, due: Bools, active: Bools, timing: Floats, lap_frames: Floats, elapsed_s: Floats, lap: Floats
) -> tuple[Stretch, Floats, Bools]:
    """Where due (n, L) the next stretch begins. active: (n, L) what runs; lap_frames: (n, L, 7) as in Playback;
    elapsed_s: (n, L); lap: (n, L) repeats made so far. -> stretch, repeats, and where a unit has come to its end."""
    who = np.nonzero(due & active)
    of_who, elapsed_of_who, loops = timing[:, who[0], who[1]], elapsed_s[who], lap_frames[who]
    at, rate, laps, held = _played(of_who, elapsed_of_who)
    ends = at >= of_who[LAST]
    at = np.minimum(at, of_who[LAST])
    wrapped = at[:, None] - np.fmod(at[:, None], loops)
    until = _until(of_who, elapsed_of_who, at, rate, laps, (wrapped + loops).min(axis=-1))
    until = np.where(held, -np.inf, until)
    ended = np.zeros_like(due)
    ended[who] = ends
    going = Stretch(
        rate=_put(stretch.rate, who, rate),
        base=_put(stretch.base, who, at - elapsed_of_who * rate),
        wrapped=_put(stretch.wrapped, who, wrapped),
        # What does not run has nothing to wait for.
        until_s=_put(np.where(due, np.float32(np.inf), stretch.until_s), who, np.where(ends, np.inf, until)),
    )
    return going, _put(lap, who, laps), ended


def _put(old: Floats, who: tuple[NDArray[np.intp], ...], new: Floats) -> Floats:
    made = old.copy()
    made[who] = new
    return made


def _played(timing: Floats, elapsed_s: Floats) -> tuple[Floats, Floats, Floats, Bools]:
    """Frame (m,) units have come to, frames per second there, repeats made, and whether they are being held."""
    before, lead, after, hold_first, hold_length, held, loop_first, loop_frames, times, _ = timing
    past = elapsed_s - before
    at = np.minimum(elapsed_s, before) * lead
    at += np.maximum(past, 0.0) * after
    rate = np.where(past < 0.0, lead, after)
    lap = np.clip(np.floor((at - loop_first) / np.maximum(loop_frames, 1.0)), 0.0, times)
    at -= lap * loop_frames
    length = np.maximum(hold_length, 1e-6)
    share = (at - hold_first) / length
    u = (2.0 * np.pi) * np.minimum(np.maximum(share, 0.0), 1.0)
    at -= held * (u - np.sin(u)) * (0.5 / np.pi)
    rate *= 1.0 - held / length * (1.0 - np.cos(u))
    return at, rate, lap, (held > 0.0) & (share > 0.0) & (share < 1.0)


def _until(timing: Floats, elapsed_s: Floats, at: Floats, rate: Floats, lap: Floats, looped: Floats) -> Floats:
    """(m,) when the even pace of units that are not held ends; looped: the frame at which a loop is over."""
    before, _, _, hold_first, _, held, loop_first, loop_frames, times, last = timing
    ahead = np.where((held > 0.0) & (at < hold_first), hold_first, last)
    ahead = np.where(lap < times, np.minimum(ahead, loop_first + loop_frames), ahead)
    until = elapsed_s + (np.minimum(ahead, looped) - at) / np.maximum(rate, 1e-6)
    return np.asarray(np.where(elapsed_s < before, np.minimum(until, before), until) - np.float32(EARLY_S))
