"""The ticks ahead of many bodies: how each feels, and when the words of its line are said, up to its next line.

Between two lines nothing from outside reaches a body, so its feelings and the moments of its words are known for all
those ticks at once, and the planner goes through them at one go. Each body has a clock of its own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from game.app.step import FELT_HALF_LIFE_S, SHOWN_HALF_LIFE_S, leaked_emotion
from game.app.world import TICK_S
from game.core.springs import damper_fraction
from game.embos import Course, GestureCues, Habit
from game.emotion import Temperament

__all__ = ["TICKS", "Ahead", "first_tick_after"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

TICKS = 64
"""So many are looked at together, at most."""
_SHARE = np.repeat([damper_fraction(FELT_HALF_LIFE_S, TICK_S), damper_fraction(SHOWN_HALF_LIFE_S, TICK_S)], 6)
_SHARE.setflags(write=False)


def first_tick_after(time_s: float) -> int:
    """The first tick whose time lies beyond a moment."""
    tick = math.floor(time_s / TICK_S) - 1
    while not time_s < tick * TICK_S:
        tick += 1
    return tick


@dataclass(eq=False)
class Ahead:
    """N bodies. Feelings: six felt, then six shown, (N, 12) as they stand after the ticks ahead, and their target.

    burst_s: (N,) peak of the present reaction. cue, cue_s: (N, C) gesture columns and moments of the present line's
    words, inf where there are no more.
    """

    person: Temperament
    feeling: Floats
    target: Floats
    burst_s: Floats
    cue: Ints
    cue_s: Floats

    @staticmethod
    def start(n: int, person: Temperament) -> Ahead:
        """Nothing is felt, shown or said yet."""
        return Ahead(
            person,
            feeling=np.zeros((n, 12)),
            target=np.zeros((n, 12)),
            burst_s=np.full(n, -1e9),
            cue=np.zeros((n, 8), dtype=np.intp),
            cue_s=np.full((n, 8), np.inf),
        )

    def keep(self, rows: Ints) -> None:
        """Only these bodies, in this order."""
        for name in (each.name for each in fields(self)):
            value = getattr(self, name)
            if isinstance(value, np.ndarray):
                setattr(self, name, value[rows])

    def say(self, row: int, cues: GestureCues | None) -> None:
        """A line begins, or nothing is said any more."""
        self.cue_s[row] = np.inf
        if cues is None:
            return
        count = len(cues.gesture)
        if count > self.cue.shape[1]:
            more = ((0, 0), (0, count - self.cue.shape[1]))
            self.cue, self.cue_s = np.pad(self.cue, more), np.pad(self.cue_s, more, constant_values=np.inf)
        self.cue[row, :count], self.cue_s[row, :count] = cues.gesture, cues.time_s

    def leaked(self, rows: Ints, time_s: Floats) -> Floats:
        """(R, 7) what drives posture and mannerism at the rows' present feelings."""
        feeling = self.feeling[rows]
        return leaked_emotion(self.person, feeling[:, :6], feeling[:, 6:], time_s - self.burst_s[rows])

    def look(self, rows: Ints, tick: NDArray[np.int64], length: Ints, told: Bools, habit: Habit | None) -> Course:
        """``length`` (R,) ticks from ``tick`` (R,) on; told: (R,) of whom the first is told whatever happens in it."""
        longest = int(length.max())
        feeling, target = self.feeling[rows], self.target[rows]
        course = np.empty((longest, len(rows), 12))
        for at in range(longest):  # as game.core.springs.damp, tick by tick
            step = np.subtract(target, feeling, out=course[at])
            step *= _SHARE
            step += feeling
            feeling = step
        self.feeling[rows] = course[length - 1, np.arange(len(rows))]
        time_s: Floats = np.asarray((tick[:, None] + np.arange(longest)) * TICK_S, dtype=np.float64)
        course = course.transpose(1, 0, 2)
        emotion = leaked_emotion(self.person, course[..., :6], course[..., 6:], time_s - self.burst_s[rows, None])
        return Course(emotion, tick, length, self.cue[rows], self.cue_s[rows], told, habit)
