"""The planner: eq. 1 for every layer, for one character or for many.

Nothing in eq. 1 changes between two of these events: a unit's duration or waiting time ends, the emotion moves,
a word comes or goes. So a character is only judged anew when one of them has come that can change the decision; in
between it stands. The result is the same as judging every frame.

Who is due and what is chosen is worked out one character after the other in compiled loops: ``plan/*.c``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput
from game.embos.config import PlannerConfig
from game.embos.draws import character_keys
from game.embos.explain import Candidate, explain, explain_chosen
from game.embos.judging import Judge
from game.embos.library import UnitLibrary
from game.embos.planner_state import TICK_S, Course, Decisions, Factors, PlannerSignal, PlannerState, Told
from game.embos.tables import PlannerTables, build_tables

__all__ = ["Planner"]

Ints = NDArray[np.intp]


class Planner:
    """Chooses units from a library by eq. 1. All that changes is in the state; for one thread at a time."""

    def __init__(self, library: UnitLibrary, config: PlannerConfig | None = None) -> None:
        self.library = library
        self.config = config or PlannerConfig()
        self.tables: PlannerTables = build_tables(library, self.config)
        self._judge = Judge(self.tables, self.config)

    def start(self, n: int, rng_seed: int, first: int = 0) -> PlannerState:
        """n characters before their first tick: character first + i draws the same in any company."""
        return self.start_keyed(character_keys(rng_seed, first, n))

    def start_keyed(self, key: NDArray[np.uint64]) -> PlannerState:
        """Characters before their first tick. key: (n,) of their draws, see draws.character_keys."""
        t = self.tables
        characters = self._judge.kind.room(len(key))
        characters.block.data[...] = 0.0
        fields = characters.fields
        fields["key"], fields["next_s"], fields["marks_s"], fields["wait_s"] = key, -np.inf, -np.inf, -np.inf
        fields["emotion"] = fields["settled"] = -9.0
        fields["running"], fields["untried"], fields["order"] = t.initial, True, t.places
        fields["unit"] = np.where(t.initial < t.slots, t.unit[np.minimum(t.initial, t.slots - 1)], -1)
        return PlannerState(characters, -np.inf, False)

    def advance(
        self, state: PlannerState, signal: PlannerSignal, dt_s: float = TICK_S, *, spend: bool = False
    ) -> tuple[PlannerState, Decisions]:
        """One tick: eq. 1 where something has happened, the standing decision elsewhere.

        spend: the old state is needed no more, so that its records may be written to (a crowd's are large).
        Raises BadInput for a signal of the wrong shape, or a state of another planner.
        """
        self._check(state, signal, len(state))
        if self._stands(state, signal, dt_s):
            state = state.standing(spend=spend)
        else:
            state = self._judge.advance(state if spend else state.copied(), signal, dt_s)
        return state, state.decisions

    def follow(
        self, state: PlannerState, rows: Ints, course: Course, dt_s: float = TICK_S, *, before: bool = False
    ) -> Iterator[Told]:
        """Many ticks of the characters ``rows`` (R,), each at times of its own, told piece by piece.

        The state is spent: its records are written to, and all must be told before it is used again.
        """
        self._own(state)
        yield from self._judge.follow(state, rows, course, dt_s, before)

    def weigh(
        self, state: PlannerState, signal: PlannerSignal, characters: Ints, dt_s: float = TICK_S
    ) -> tuple[PlannerState, PlannerSignal, Factors]:
        """Eq. 1 for some characters (R,) in this tick, with all that was weighed; changes nothing.

        -> these characters as eq. 1 finds them (the emotion noted, whoever begins settled), what the tick brings
        them, the factors of all candidates.
        """
        few, own = state.of(characters), signal.of(characters)
        self._check(few, own, len(few))
        return few, own, self._judge.weigh(few, own, dt_s)

    def _check(self, state: PlannerState, signal: PlannerSignal, count: int) -> None:
        wanted = (count, self._judge.kind.gestures)
        if signal.emotion.shape != (count, 7) or signal.words.shape != wanted:
            raise BadInput(
                "planner signal",
                expected=f"emotion {(count, 7)} and words {wanted}",
                seen=f"{signal.emotion.shape} and {signal.words.shape}",
            )
        self._own(state)

    def _own(self, state: PlannerState) -> None:
        if state.characters.kind is not self._judge.kind:
            raise BadInput("planner state", expected="one that this planner started", seen="another planner's")

    def _stands(self, state: PlannerState, signal: PlannerSignal, dt_s: float) -> bool:
        """Whether nothing can happen in this tick: no moment has come, no word, no feeling."""
        time_s = float(signal.time_s)  # one for all here
        looking = self._looks(time_s, dt_s)
        if state.soonest_s < self.moment(time_s, dt_s) and (looking or state.soonest_s == -math.inf):
            return False
        if np.count_nonzero(signal.words != state.words):
            return False
        return not looking or bool(np.abs(signal.emotion - state.emotion).max(initial=0.0) <= self.config.tolerance)

    def moment(self, time_s: float, dt_s: float) -> float:
        """Thresholds before this moment count as passed: half a look ahead, so that lengths are right on average."""
        return time_s + 0.5 * max(self.config.look_s, dt_s)

    def _looks(self, time_s: float, dt_s: float) -> bool:
        """Whether times and emotions are looked at in this tick (config.look_s)."""
        look_s = self.config.look_s
        if look_s <= dt_s:
            return True
        return math.floor((time_s + 1e-6) / look_s) > math.floor((time_s - dt_s + 1e-6) / look_s)

    def explain(
        self, state: PlannerState, signal: PlannerSignal, character: int, dt_s: float = TICK_S
    ) -> list[list[Candidate]]:
        """Why: per layer all candidates with their factors and a reason, the chosen one first (see explain.py)."""
        return explain(self, state, signal, character, dt_s)

    def explain_chosen(
        self, state: PlannerState, signal: PlannerSignal, characters: Ints, dt_s: float = TICK_S
    ) -> list[list[Candidate]]:
        """Why, for several characters (R,) at once: the chosen candidate of each layer only."""
        return explain_chosen(self, state, signal, characters, dt_s)
