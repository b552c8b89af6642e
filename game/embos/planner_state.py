"""What goes into the planner and what comes out: signal, state, decisions, factors. All frozen."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.compiled import Block, Machine

__all__ = [
    "TICK_S",
    "CharacterKind",
    "Characters",
    "Course",
    "Decisions",
    "Factors",
    "Habit",
    "PlannerSignal",
    "PlannerState",
    "Told",
]

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
class CharacterKind:
    """Where the records of one planner's characters are kept, and how they are laid out.

    record: struct Character of plan.h and what follows it, field by field as PlannerState names them, and next_s: when
    the decision may change by time alone; calm: no end of a word can change it; settled: (7,) the emotion that waits
    were last drawn for; untried: (P,) where a slot's wait was drawn rather than earned; order: see feeling.c.
    """

    machine: Machine
    record: np.dtype[Any]
    gestures: int

    @classmethod
    def of(cls, machine: Machine, slots: int, gestures: int) -> CharacterKind:
        """For P slots and G gestures."""
        record = [
            ("key", "<u8"), ("next_s", "<f8"), ("emotion", "<f8", 7), ("settled", "<f8", 7),
            ("running", "<i8", 3), ("starts", "<i8", 3), ("unit", "<i8", 3),
            ("marks_s", "<f8", (3, 2)), ("numbers", "<f8", (3, 11)),
            ("started", "?", 3), ("calm", "?"), ("unused", "u1", 4),
            ("wait_s", "<f8", slots), ("phi_state", "<f8", slots), ("words", "<f8", gestures),
            ("order", "<i2", slots), ("untried", "?", slots), ("room", "u1", -3 * slots % 8),
        ]  # fmt: skip
        return cls(machine, np.dtype(record), gestures)

    def room(self, count: int) -> Characters:
        """Room for so many, not cleared."""
        return Characters(self, self.machine.block((count, self.record.itemsize // 8), np.float64))


@dataclass(frozen=True, eq=False)
class Characters:
    """The records of n characters."""

    kind: CharacterKind
    block: Block

    @cached_property
    def fields(self) -> NDArray[Any]:
        """(n,) by field name, to be written to."""
        return np.asarray(self.block.data.view(self.kind.record)[:, 0])

    @cached_property
    def seen(self) -> NDArray[Any]:
        """The same, read-only."""
        seen = self.fields[:]
        seen.setflags(write=False)
        return seen

    @cached_property
    def decisions(self) -> Decisions:
        return Decisions(self.seen["unit"], self.seen["started"], self.seen["numbers"])

    @cached_property
    def last(self) -> tuple[Floats, Floats]:
        """(n, 7) emotion that eq. 1 last saw, and (n, G) words of the last tick."""
        return self.seen["emotion"], self.seen["words"]


@dataclass(frozen=True, eq=False)
class PlannerState:
    """Where n characters stand; never changed in place (but for who spends it), so that it can be kept or compared.

    soonest_s: when somebody's decision may change by time alone; starting: whether anybody has started anything in the
    last tick. By character: key: (n,) uint64 of its draws. running: (n, L) slots. marks_s: (n, L, 2) end of the running
    unit's duration, and until when it may not be given up. wait_s: (n, P) end of each slot's waiting time, −inf if it
    never ran. starts: (n, L) how often the layer has started a unit. emotion: (n, 7) and phi_state: (n, P) as last
    computed. words: (n, G) of the last tick. decisions: the last tick's.
    """

    characters: Characters
    soonest_s: float
    starting: bool

    def __len__(self) -> int:
        return len(self.characters.block.data)

    @property
    def decisions(self) -> Decisions:
        return self.characters.decisions

    @property
    def key(self) -> NDArray[np.uint64]:
        return np.asarray(self.characters.seen["key"])

    @property
    def running(self) -> Ints:
        return np.asarray(self.characters.seen["running"])

    @property
    def marks_s(self) -> Floats:
        return np.asarray(self.characters.seen["marks_s"])

    @property
    def wait_s(self) -> Floats:
        return np.asarray(self.characters.seen["wait_s"])

    @property
    def starts(self) -> Ints:
        return np.asarray(self.characters.seen["starts"])

    @property
    def emotion(self) -> Floats:
        return self.characters.last[0]

    @property
    def phi_state(self) -> Floats:
        return np.asarray(self.characters.seen["phi_state"])

    @property
    def words(self) -> Floats:
        return self.characters.last[1]

    def standing(self, *, spend: bool) -> PlannerState:
        """The tick in which nothing starts."""
        if not self.starting:
            return self
        state = self if spend else self.copied()
        state.characters.fields["started"] = False
        return PlannerState(state.characters, self.soonest_s, False)

    def copied(self) -> PlannerState:
        """The same in records of its own."""
        characters = self.characters.kind.room(len(self))
        characters.block.data[...] = self.characters.block.data
        return PlannerState(characters, self.soonest_s, self.starting)

    def of(self, rows: Ints) -> PlannerState:
        """Some of the characters, in the order of ``rows``; each goes on as it would have among all."""
        few = self.characters.kind.room(len(rows))
        few.block.data[...] = self.characters.block.data[rows]
        return PlannerState(few, float(few.seen["next_s"].min(initial=np.inf)), bool(few.seen["started"].any()))


@dataclass(frozen=True, eq=False)
class Factors:
    """Eq. 1 for R characters. continuity, linkage, time, state and their product, score: (R, L, M). chosen: (R, L)
    slots. within: (R, L) the running unit is inside its duration."""

    continuity: Floats
    linkage: Floats
    time: Floats
    state: Floats
    score: Floats
    chosen: Ints
    within: Bools


@dataclass(frozen=True, eq=False)
class Course:
    """Ticks of R characters, each on a clock of its own, where all that reaches them is known beforehand.

    emotion: (R, T, 7) felt in the ticks; tick: (R,) number of the first, length: (R,) how many there are, at most T.
    cue, cue_s: (R, C) columns of library.gestures and moments of the words that are said, inf where there are no
    more. told: (R,) bool, of whom the first tick is told whatever happens in it. habit: what they do anyway.
    """

    emotion: Floats
    tick: Ints
    length: Ints
    cue: Ints
    cue_s: Floats
    told: Bools
    habit: Habit | None = None


@dataclass(frozen=True, eq=False)
class Told:
    """E ticks in which somebody started something, or that were to be told of; one character's stand in order.

    row: (E,) of the course. decisions: of the E. signal: what the tick brought, to each at its own time. before: the
    characters as they were, where they were to be kept; whoever started nothing is undefined.
    """

    row: Ints
    decisions: Decisions
    signal: PlannerSignal
    before: Characters
