"""The ticks ahead of many bodies: how each feels and which words it says, up to its next line.

Between two lines nothing from outside reaches a body, so its feelings and the moments of its words are known for all
those ticks at once, and with them the next tick at which its planner may decide anew. Each body has a clock of its own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from game.app.step import FELT_HALF_LIFE_S, SHOWN_HALF_LIFE_S, leaked_emotion
from game.app.world import TICK_S
from game.core.springs import damper_fraction
from game.embos import GestureCues, Habit, Planner, PlannerSignal, PlannerState
from game.emotion import Temperament

__all__ = ["TICKS", "Ahead", "first_tick_after"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

TICKS = 24
"""So many are looked at together, at most."""
_ROUNDING_S = 1e-6


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
    words, inf where there are no more. emotion: (N, T, 7) and time_s: (N, T) of the ticks ahead; words: (N, T, G)
    bool; opened, changed: (N, T) a word comes, comes or goes. length: (N,) ticks ahead, at: (N,) those gone through.
    """

    planner: Planner
    person: Temperament
    feeling: Floats
    target: Floats
    burst_s: Floats
    cue: Ints
    cue_s: Floats
    emotion: Floats
    time_s: Floats
    words: Bools
    opened: Bools
    changed: Bools
    length: Ints
    at: Ints

    @staticmethod
    def start(n: int, planner: Planner, person: Temperament) -> Ahead:
        """Nothing is felt, shown or said yet."""
        gestures = len(planner.library.gestures)
        return Ahead(
            planner,
            person,
            feeling=np.zeros((n, 12)),
            target=np.zeros((n, 12)),
            burst_s=np.full(n, -1e9),
            cue=np.zeros((n, 8), dtype=np.intp),
            cue_s=np.full((n, 8), np.inf),
            emotion=np.zeros((n, TICKS, 7)),
            time_s=np.zeros((n, TICKS)),
            words=np.zeros((n, TICKS, gestures), dtype=bool),
            opened=np.zeros((n, TICKS), dtype=bool),
            changed=np.zeros((n, TICKS), dtype=bool),
            length=np.zeros(n, dtype=np.intp),
            at=np.zeros(n, dtype=np.intp),
        )

    def keep(self, rows: Ints) -> None:
        """Only these bodies, in this order."""
        for name in (each.name for each in fields(self)):
            value = getattr(self, name)
            if isinstance(value, np.ndarray):
                setattr(self, name, value[rows])

    def is_busy(self) -> Bools:
        """(N,) whether there are ticks ahead."""
        return np.asarray(self.at < self.length)

    def busy(self) -> Ints:
        """Those with ticks ahead."""
        return self.is_busy().nonzero()[0]

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

    def look(self, rows: Ints, tick: NDArray[np.int64], length: Ints) -> None:
        """Feelings and words of ``length`` (R,) ticks from ``tick`` (R,) on."""
        longest = int(length.max())
        share = np.repeat([damper_fraction(FELT_HALF_LIFE_S, TICK_S), damper_fraction(SHOWN_HALF_LIFE_S, TICK_S)], 6)
        feeling, target = self.feeling[rows], self.target[rows]
        course = np.empty((longest, len(rows), 12))
        for at in range(longest):  # as game.core.springs.damp, tick by tick
            step = np.subtract(target, feeling, out=course[at])
            step *= share
            step += feeling
            feeling = step
        self.feeling[rows] = course[length - 1, np.arange(len(rows))]
        time_s: Floats = np.asarray((tick[:, None] + np.arange(longest)) * TICK_S, dtype=np.float64)
        course = course.transpose(1, 0, 2)
        emotion = leaked_emotion(self.person, course[..., :6], course[..., 6:], time_s - self.burst_s[rows, None])
        self.emotion[rows, :longest], self.time_s[rows, :longest] = emotion, time_s
        self._listen(rows, emotion, time_s)
        self.length[rows], self.at[rows] = length, 0

    def _listen(self, rows: Ints, emotion: Floats, time_s: Floats) -> None:
        """Which words stand in which ticks, as GestureCues.factors gives them tick by tick."""
        library, longest = self.planner.library, time_s.shape[1]
        said = self.words[rows, self.length[rows] - 1] & (self.length[rows] > 0)[:, None]
        words = np.zeros((len(rows), longest, said.shape[1]), dtype=bool)
        half_s = 0.5 * self.planner.config.word_window_s
        least_s, most_s = self._leads_s
        cue, cue_s = self.cue[rows], self.cue_s[rows]
        some = np.flatnonzero(np.isfinite(cue_s).any(axis=0))
        if some.size:
            cue, cue_s = cue[:, : some[-1] + 1], cue_s[:, : some[-1] + 1]
            first, last = cue_s - most_s[cue] - half_s, cue_s - least_s[cue] + half_s
            near = (first[:, None] <= time_s[..., None]) & (last[:, None] >= time_s[..., None])
            who, at, which = near.nonzero()
            units = library.gestures[cue[who, which]]
            weights = library.mix_weights(emotion[who, at], units)
            lead_s = (weights * library.stroke_offset_s[units]).sum(axis=-1)
            stands = np.abs(time_s[who, at] - (cue_s[who, which] - lead_s)) <= half_s
            words[who[stands], at[stands], cue[who[stands], which[stands]]] = True
        before = np.concatenate([said[:, None], words[:, :-1]], axis=1)
        self.words[rows, :longest] = words
        self.changed[rows, :longest] = (words != before).any(axis=2)
        self.opened[rows, :longest] = (words & ~before).any(axis=2)

    @cached_property
    def _leads_s(self) -> tuple[Floats, Floats]:
        """(G,) least and most seconds from start to stroke of each gesture, whatever is felt, and a little more."""
        library = self.planner.library
        known, offset_s = library.exists[library.gestures], library.stroke_offset_s[library.gestures]
        least = np.where(known, offset_s, np.inf).min(axis=1)
        most = np.where(known, offset_s, -np.inf).max(axis=1)
        some = known.any(axis=1)
        return np.where(some, least, 0.0) - _ROUNDING_S, np.where(some, most, 0.0) + _ROUNDING_S

    def go_on(self, rows: Ints, state: PlannerState) -> Ints:
        """The rows (R,) go on to the next tick ahead in which their decision may change.

        -> (R,) its place, −1 where there is none and they have gone through all.
        """
        config, planner = self.planner.config, self.planner
        far = np.abs(self.emotion[rows] - state.emotion[rows, None]) > config.tolerance
        due = far.any(axis=2)
        due |= planner.moment(self.time_s[rows], TICK_S) > state.next_s[rows, None]
        due |= self.opened[rows] | (self.changed[rows] & ~state.calm[rows, None])
        place = np.arange(TICKS)
        due &= (place >= self.at[rows, None]) & (place < self.length[rows, None])
        found = due.any(axis=1)
        at = np.where(found, due.argmax(axis=1), -1)
        self.at[rows] = np.where(found, at + 1, self.length[rows])
        return at

    def signal(self, rows: Ints, at: Ints, habit: Habit | None) -> PlannerSignal:
        """What the ticks at places (R,) ahead bring, to each at its own time."""
        words = self.words[rows, at].astype(np.float64)
        return PlannerSignal(self.emotion[rows, at], words, self.time_s[rows, at], habit)
