"""Why a unit plays: every candidate with its four factors, its score and a sentence."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from game.core.emotion_space import EMOTIONS

if TYPE_CHECKING:
    from game.embos.planner import Planner
    from game.embos.planner_state import Factors, PlannerSignal, PlannerState

__all__ = ["Candidate", "explain", "explain_chosen"]


@dataclass(frozen=True)
class Candidate:
    """One unit in one layer's competition. unit: index into library.units; the factors are those of eq. 1;
    source: take and span the unit's strongest variant comes from, "" for rest."""

    layer: str
    unit: int
    name: str
    continuity: float
    linkage: float
    time: float
    state: float
    score: float
    chosen: bool
    reason: str
    source: str


def explain(
    planner: Planner, state: PlannerState, signal: PlannerSignal, character: int, dt_s: float
) -> list[list[Candidate]]:
    """The decision ``planner.advance(state, signal, dt_s)`` takes for one character, layer by layer.

    The chosen candidate stands first in its layer, the others follow by score. Give the state from before the
    tick to learn why a unit started, the state after it to learn why it stays. Changes nothing.
    """
    t = planner.tables
    state, signal, factors = _judged(planner, state, signal, np.array([character]), dt_s)
    result: list[list[Candidate]] = []
    for at in range(len(t.layers)):
        candidates = [
            _candidate(planner, state, factors, 0, at, place, signal)
            for place in range(t.width)
            if t.unit[at * t.width + place] >= 0
        ]
        result.append(sorted(candidates, key=lambda c: (not c.chosen, -c.score)))
    return result


def explain_chosen(
    planner: Planner, state: PlannerState, signal: PlannerSignal, characters: NDArray[np.intp], dt_s: float
) -> list[list[Candidate]]:
    """For each of the characters (R,), what its layers chose in the tick and why; explain() without the losers."""
    t = planner.tables
    state, signal, factors = _judged(planner, state, signal, characters, dt_s)
    return [
        [
            _candidate(planner, state, factors, row, at, int(factors.chosen[row, at]) - at * t.width, signal)
            for at in range(len(t.layers))
        ]
        for row in range(len(characters))
    ]


def _judged(
    planner: Planner, state: PlannerState, signal: PlannerSignal, characters: NDArray[np.intp], dt_s: float
) -> tuple[PlannerState, PlannerSignal, Factors]:
    """State, signal and factors of these characters alone."""
    few, own = planner.prepared(state, signal, characters), signal.of(characters)
    now = planner.moment(np.full(len(characters), own.time_s), dt_s)
    return few, own, planner.evaluate(few, np.arange(len(characters)), own.words, now, own.habit)


def _candidate(
    planner: Planner,
    state: PlannerState,
    factors: Factors,
    row: int,
    at: int,
    place: int,
    signal: PlannerSignal,
) -> Candidate:
    """The unit at a place of a layer; row: the character's in state, signal and factors."""
    t = planner.tables
    slot = at * t.width + place
    unit = int(t.unit[slot])
    one = factors.of(row)
    return Candidate(
        layer=t.layers[at],
        unit=unit,
        name=planner.library.units[unit].name,
        continuity=float(one.continuity[0, at, place]),
        linkage=_link(one, at, place),
        time=float(one.time[0, at, place]),
        state=float(one.state[0, at, place]),
        score=float(one.score[0, at, place]),
        chosen=bool(slot == one.chosen[0, at]),
        reason=_reason(planner, state, one, row, at, place, signal),
        source=_source(planner, state, row, slot),
    )


def _link(factors: Factors, at: int, place: int) -> float:
    link = factors.linkage[at]
    return 1.0 if link is None else float(link[0, place])


def _name(planner: Planner, slot: int) -> str:
    unit = int(planner.tables.unit[slot]) if slot < planner.tables.slots else -1
    return planner.library.units[unit].name if unit >= 0 else "nothing"


def _blockers(planner: Planner, factors: Factors, at: int, slot: int) -> str:
    place = slot - at * planner.tables.width
    above = [int(factors.chosen[0, upper]) for upper in range(at)]
    return " and ".join(_name(planner, u) for u in above if planner.tables.blocks[at][u, place] == 0.0)


def _reason(
    planner: Planner,
    state: PlannerState,
    factors: Factors,
    character: int,
    at: int,
    place: int,
    signal: PlannerSignal,
) -> str:
    t = planner.tables
    time_s = float(signal.time_s[character] if isinstance(signal.time_s, np.ndarray) else signal.time_s)
    slot, running = at * t.width + place, int(state.running[character, at])
    chosen = int(factors.chosen[0, at])
    waits_s = float(state.wait_s[character, slot]) - time_s
    waiting = factors.time[0, at, place] == t.minimum[slot]
    if slot != chosen:
        if _link(factors, at, place) == 0.0:
            return f"blocked by linkage with {_blockers(planner, factors, at, slot)}"
        if slot in t.gesture_slots and factors.state[0, at, place] == 0.0:
            return "its word is not being said, or the emotion never showed it"
        if factors.state[0, at, place] <= 0.0:
            return "never shown in what is felt"
        if waiting:
            return f"waits {max(waits_s, 0.0):.1f} s more"
        return "scores less"
    if slot == running:
        if factors.within[0, at]:
            left_s = float(state.marks_s[character, at, 0]) - time_s
            if factors.score[0, at].max() > factors.score[0, at, place]:
                return f"kept: started less than {t.least_s[slot]:g} s ago"
            return f"kept: still within its duration, {max(left_s, 0.0):.1f} s left"
        if t.rest[slot]:
            return "rest: nothing else scores more"
        if waiting:
            return "kept past its duration: everything else waits or suits less"
        return "starts again: its waiting time is over and nothing scores more"
    habit = signal.habit
    if habit is not None and slot in habit.slots and state.phi_state[character, slot] < habit.share:
        return f"{_name(planner, slot)} is a habit: it comes whatever is felt, and its waiting time is over"
    if running >= t.slots:
        return "first choice: " + _because(planner, factors, at, place)
    before = _name(planner, running)
    if _link(factors, at, running - at * t.width) == 0.0:
        blockers = _blockers(planner, factors, at, running)
        return f"{before} is blocked by {blockers}; {_because(planner, factors, at, place)}"
    if t.rest[running]:
        return f"{_name(planner, slot)} beats rest: {_because(planner, factors, at, place)}"
    ended = "gave way" if factors.within[0, at] else "ended"
    return f"{before} {ended}; {_name(planner, slot)} best because {_because(planner, factors, at, place)}"


def _because(planner: Planner, factors: Factors, at: int, place: int) -> str:
    """The factor in which the winner is furthest ahead of the runner-up."""
    score = factors.score[0, at].copy()
    score[place] = -1.0
    second = int(score.argmax())
    if score[second] <= 0.0:
        return "nothing else may play"
    ratio = {
        "it suits the emotion": factors.state[0, at, place] / max(factors.state[0, at, second], 1e-9),
        "it follows easily": factors.continuity[0, at, place] / max(factors.continuity[0, at, second], 1e-9),
        "it need not wait": factors.time[0, at, place] / max(factors.time[0, at, second], 1e-9),
    }
    best = max(ratio, key=lambda reason: ratio[reason])
    return f"{best} more than {_name(planner, at * planner.tables.width + second)}"


def _source(planner: Planner, state: PlannerState, character: int, slot: int) -> str:
    """Take and span of the strongest variant: the one being played, or the first that would be."""
    library, t = planner.library, planner.tables
    unit = int(t.unit[slot])
    at = slot // t.width
    weights = library.mix_weights(state.emotion[character], np.array(unit), planner.config.radius)
    pick = 0.0
    if state.running[character, at] == slot:
        weights = state.decisions.emotion_weights[character, at]
        pick = float(state.decisions.variant_pick[character, at])
    if not weights.any():
        return ""
    emotion = int(weights.argmax())
    variant = library.variant(unit, emotion, pick)
    if variant is None:
        return ""
    return f"{variant.take} {variant.start_s:.2f}–{variant.end_s:.2f} s ({EMOTIONS[emotion]} {weights[emotion]:.2f})"
