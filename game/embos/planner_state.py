"""What goes into the planner and what comes out: signal, state, decisions, factors. All frozen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["TICK_S", "Decisions", "Factors", "Habit", "PlannerSignal", "PlannerState"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

TICK_S = 1.0 / 30.0
"""The simulation's step."""


@dataclass(frozen=True, eq=False)
class Habit:
    """Units that somebody shows whatever they feel. slots: of those units; share: φ_state they have at least, 0..1."""

    slots: Ints
    share: float


@dataclass(frozen=True, eq=False)
class PlannerSignal:
    """What a tick brings. emotion: (n, 7) felt; words: (n, G) word factor per gesture unit, 1 at its word's moment,
    else 0 (columns as library.gestures); time_s: the moment of this tick, or (n,) each character's own; habit: what
    these characters do anyway."""

    emotion: Floats
    words: Floats
    time_s: float | Floats
    habit: Habit | None = None

    def of(self, rows: Ints) -> PlannerSignal:
        """What it brings some of the characters."""
        time_s = self.time_s[rows] if isinstance(self.time_s, np.ndarray) else self.time_s
        return PlannerSignal(self.emotion[rows], self.words[rows], time_s, self.habit)


@dataclass(frozen=True, eq=False)
class Decisions:
    """One unit per layer, columns in the order of the planner's layers.

    unit: (n, L) index into library.units. started: (n, L) bool, True in the tick a unit starts (again).
    numbers: (n, L, 11), named by the properties: start_time_s, duration_s (n, L), 0 for a rest unit; variant_pick
    (n, L) in [0, 1); stroke_s (n, L) seconds from the start to the stroke of the mixed variants (gestures; 0
    elsewhere); emotion_weights (n, L, 7) normalised weights of eq. 5 at the start, all 0 for rest.
    """

    unit: Ints
    started: Bools
    numbers: Floats

    @property
    def start_time_s(self) -> Floats:
        return self.numbers[..., 0]

    @property
    def duration_s(self) -> Floats:
        return self.numbers[..., 1]

    @property
    def variant_pick(self) -> Floats:
        return self.numbers[..., 2]

    @property
    def stroke_s(self) -> Floats:
        return self.numbers[..., 3]

    @property
    def emotion_weights(self) -> Floats:
        return self.numbers[..., 4:]


@dataclass(frozen=True, eq=False)
class PlannerState:
    """Where n characters stand; never changed in place (but for who spends it), so that it can be kept or compared.

    key: (n,) uint64 of each character's draws. running: (n, L) slots. marks_s: (n, L, 2) end of the running
    unit's duration, and until when it may not be given up. wait_s: (n, P) end of each slot's waiting time, −inf
    if it never ran; untried: (n, P) bool, True where that wait was drawn rather than earned. starts: (n, L) how
    often the layer has started a unit. emotion: (n, 7) and phi_state: (n, P) as last computed; settled: (n, 7) the
    emotion that waits were last drawn for. words: (n, G) of the last tick. next_s: (n,) when the decision may
    change by time alone, soonest_s the least of them; calm: (n,) bool, no end of a word can change it. decisions:
    the last tick's.
    """

    key: NDArray[np.uint64]
    running: Ints
    marks_s: Floats
    wait_s: Floats
    untried: Bools
    starts: NDArray[np.int64]
    emotion: Floats
    settled: Floats
    phi_state: Floats
    words: Floats
    next_s: Floats
    calm: Bools
    soonest_s: float
    decisions: Decisions

    def __len__(self) -> int:
        return len(self.key)

    def renewed(self, **changes: Any) -> PlannerState:
        """A state with some fields replaced (dataclasses.replace, without its overhead)."""
        return PlannerState(**{**vars(self), **changes})

    def fresh(self) -> Bools:
        """(n,) bool: before the first tick."""
        return np.asarray((self.starts == 0).all(axis=1))

    def copied(self) -> PlannerState:
        """The same in arrays of its own."""
        own = {name: value.copy() for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        decisions = Decisions(*(value.copy() for value in vars(self.decisions).values()))
        return PlannerState(**own, soonest_s=self.soonest_s, decisions=decisions)

    def standing(self) -> PlannerState:
        """The tick in which nothing starts."""
        old = self.decisions
        return self.renewed(decisions=Decisions(old.unit, np.zeros_like(old.started), old.numbers))

    def of(self, rows: Ints) -> PlannerState:
        """Some of the characters, in the order of ``rows``; each goes on as it would have among all."""
        kept = {name: value[rows] for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        decisions = Decisions(**{name: value[rows] for name, value in vars(self.decisions).items()})
        return PlannerState(**kept, soonest_s=float(kept["next_s"].min(initial=np.inf)), decisions=decisions)


@dataclass(frozen=True, eq=False)
class Factors:
    """Eq. 1 for R characters. continuity, time, state, score: (R, L, M); linkage: per layer (R, M), or None where
    no layer is above. chosen: (R, L) slots. within: (R, L) the running unit is inside its duration. started: (R, L)
    another unit won, or the running one after its waiting time. next_s: (R,) when the decision may change by time
    alone; calm: (R,) whether no end of a word can change it."""

    continuity: Floats
    time: Floats
    state: Floats
    linkage: list[Floats | None]
    score: Floats
    chosen: Ints
    within: Bools
    started: Bools
    next_s: Floats
    calm: Bools

    def of(self, row: int) -> Factors:
        """The factors of one of the R characters."""
        if len(self.chosen) == 1:
            return self
        one = slice(row, row + 1)
        linkage = [None if link is None else link[one] for link in self.linkage]
        arrays = {name: value[one] for name, value in vars(self).items() if name != "linkage"}
        return Factors(linkage=linkage, **arrays)
