"""Why a unit plays: every candidate with its four factors, its score and a sentence."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
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
    case = _Case(planner, *planner.weigh(state, signal, np.array([character]), dt_s))
    result: list[list[Candidate]] = []
    for at in range(len(t.layers)):
        candidates = [case.candidate(at, place) for place in range(t.width) if t.unit[at * t.width + place] >= 0]
        result.append(sorted(candidates, key=lambda c: (not c.chosen, -c.score)))
    return result


def explain_chosen(
    planner: Planner, state: PlannerState, signal: PlannerSignal, characters: NDArray[np.intp], dt_s: float
) -> list[list[Candidate]]:
    """For each of the characters (R,), what its layers chose in the tick and why; explain() without the losers."""
    few, own, factors = planner.weigh(state, signal, characters, dt_s)
    cases = [_Case(planner, few, own, factors, row) for row in range(len(characters))]
    width = planner.tables.width
    return [[case.candidate(at, slot - at * width) for at, slot in enumerate(case.chosen)] for case in cases]


@dataclass(frozen=True, eq=False)
class _Case:
    """One character's decision: its row in the state, in what the tick brings and in the factors."""

    planner: Planner
    state: PlannerState
    signal: PlannerSignal
    factors: Factors
    row: int = 0

    @cached_property
    def chosen(self) -> list[int]:
        """Slots, layer by layer."""
        slots: list[int] = self.factors.chosen[self.row].tolist()
        return slots

    def candidate(self, at: int, place: int) -> Candidate:
        """The unit at a place of a layer."""
        t, here, factors = self.planner.tables, (self.row, at, place), self.factors
        slot = at * t.width + place
        unit = int(t.unit[slot])
        return Candidate(
            layer=t.layers[at],
            unit=unit,
            name=self.planner.library.units[unit].name,
            continuity=float(factors.continuity[here]),
            linkage=float(factors.linkage[here]),
            time=float(factors.time[here]),
            state=float(factors.state[here]),
            score=float(factors.score[here]),
            chosen=slot == self.chosen[at],
            reason=self._reason(at, place),
            source=self._source(slot),
        )

    def _name(self, slot: int) -> str:
        t = self.planner.tables
        unit = int(t.unit[slot]) if slot < t.slots else -1
        return self.planner.library.units[unit].name if unit >= 0 else "nothing"

    def _blockers(self, at: int, place: int) -> str:
        blocks = self.planner.tables.blocks[at]
        return " and ".join(self._name(above) for above in self.chosen[:at] if blocks[above, place] == 0.0)

    def _reason(self, at: int, place: int) -> str:
        t, row, state, factors = self.planner.tables, self.row, self.state, self.factors
        time_s = float(np.asarray(self.signal.time_s).reshape(-1)[row if np.ndim(self.signal.time_s) else 0])
        slot, running, chosen = at * t.width + place, int(state.running[row, at]), self.chosen[at]
        link, time, phi, score = (f[row, at] for f in (factors.linkage, factors.time, factors.state, factors.score))
        waiting = time[place] == t.minimum[slot]
        if slot != chosen:
            if link[place] == 0.0:
                return f"blocked by linkage with {self._blockers(at, place)}"
            if t.gestures.start <= slot < t.gestures.stop and phi[place] == 0.0:
                return "its word is not being said, or the emotion never showed it"
            if phi[place] <= 0.0:
                return "never shown in what is felt"
            if waiting:
                return f"waits {max(float(state.wait_s[row, slot]) - time_s, 0.0):.1f} s more"
            return "scores less"
        if slot == running:
            if factors.within[row, at]:
                if score.max() > score[place]:
                    return f"kept: started less than {t.least_s[slot]:g} s ago"
                left_s = float(state.marks_s[row, at, 0]) - time_s
                return f"kept: still within its duration, {max(left_s, 0.0):.1f} s left"
            if t.rest[slot]:
                return "rest: nothing else scores more"
            if waiting:
                return "kept past its duration: everything else waits or suits less"
            return "starts again: its waiting time is over and nothing scores more"
        habit = self.signal.habit
        if habit is not None and slot in habit.slots and state.phi_state[row, slot] < habit.share:
            return f"{self._name(slot)} is a habit: it comes whatever is felt, and its waiting time is over"
        if running >= t.slots:
            return "first choice: " + self._because(at, place)
        before = self._name(running)
        if link[running - at * t.width] == 0.0:
            return f"{before} is blocked by {self._blockers(at, running - at * t.width)}; {self._because(at, place)}"
        if t.rest[running]:
            return f"{self._name(slot)} beats rest: {self._because(at, place)}"
        ended = "gave way" if factors.within[row, at] else "ended"
        return f"{before} {ended}; {self._name(slot)} best because {self._because(at, place)}"

    def _because(self, at: int, place: int) -> str:
        """The factor in which the winner is furthest ahead of the runner-up."""
        here, factors = (self.row, at), self.factors
        score = factors.score[here].copy()
        score[place] = -1.0
        second = int(score.argmax())
        if score[second] <= 0.0:
            return "nothing else may play"
        ratio = {
            reason: factor[here][place] / max(factor[here][second], 1e-9)
            for reason, factor in (
                ("it suits the emotion", factors.state),
                ("it follows easily", factors.continuity),
                ("it need not wait", factors.time),
            )
        }
        best = max(ratio, key=lambda reason: ratio[reason])
        return f"{best} more than {self._name(at * self.planner.tables.width + second)}"

    def _source(self, slot: int) -> str:
        """Take and span of the strongest variant: the one being played, or the first that would be."""
        library, t, row = self.planner.library, self.planner.tables, self.row
        unit, at = int(t.unit[slot]), slot // t.width
        weights = library.mix_weights(self.state.emotion[row], np.array(unit), self.planner.config.radius)
        pick = 0.0
        if self.state.running[row, at] == slot:
            weights = self.state.decisions.emotion_weights[row, at]
            pick = float(self.state.decisions.variant_pick[row, at])
        if not weights.any():
            return ""
        emotion = int(weights.argmax())
        variant = library.variant(unit, emotion, pick)
        if variant is None:
            return ""
        span = f"{variant.take} {variant.start_s:.2f}–{variant.end_s:.2f} s"
        return f"{span} ({EMOTIONS[emotion]} {weights[emotion]:.2f})"
