"""Habits: mannerisms that somebody shows whatever they feel, so that they must be known before they are read.

Habits are largely independent of emotion (Wallbott 1998). In eq. 1 they are a floor under φ_state of their units;
waiting time, continuity and linkage hold for them as for all others.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from game.core.errors import BadInput
from game.embos.draws import uniform
from game.embos.library import UnitLibrary
from game.embos.planner import Planner
from game.embos.planner_state import Habit, PlannerState
from game.formats.yaml_source import nearest

__all__ = ["check_habit", "greet", "habit_of"]

GREETING_S = (0.6, 3.0)
"""A habit is seen so many seconds after somebody was met: what is learnt of them comes before what is read."""
_EVENT = -3


def check_habit(library: UnitLibrary, names: Sequence[str], who: str) -> None:
    """Raises BadInput for a name that is no mannerism of the library."""
    known = [unit.name for unit in library.units if unit.layer == "mannerism" and not unit.name.startswith("rest_")]
    for name in names:
        if name not in known:
            expected = "a mannerism of the motion library"
            raise BadInput(f"habit of {who}", expected=expected, seen=name, hint=nearest(name, known))


@lru_cache(maxsize=64)
def habit_of(planner: Planner, names: tuple[str, ...], share: float) -> Habit | None:
    """The habit of these units with this least φ_state; None where there is nothing to be seen of it."""
    units = [i for i, unit in enumerate(planner.library.units) if unit.name in names]
    if not units or share <= 0.0:
        return None
    return Habit(np.array([planner.tables.slot_of(unit) for unit in units], dtype=np.intp), share)


def greet(state: PlannerState, habit: Habit | None, time_s: float) -> PlannerState:
    """Somebody is met: their habits are due, each at a moment of its own."""
    if habit is None:
        return state
    who, which = np.indices((len(state), len(habit.slots))).reshape(2, -1)
    chance = uniform(state.key[who], habit.slots[which], np.full(len(who), _EVENT, dtype=np.int64), 1)
    due_s = time_s + GREETING_S[0] + (GREETING_S[1] - GREETING_S[0]) * chance.reshape(len(state), -1)
    met = state.copied()
    fields = met.characters.fields
    # From now on that wait is settled: what is drawn at the start or after a leap does not touch it.
    fields["wait_s"][:, habit.slots], fields["untried"][:, habit.slots] = due_s, False
    fields["next_s"] = np.minimum(fields["next_s"], due_s.min(axis=1))
    return PlannerState(met.characters, min(state.soonest_s, float(fields["next_s"].min())), state.starting)
