"""The planner: eq. 1 for every layer, for one character or for many with the same few array operations.

Nothing in eq. 1 changes between two of these events: a unit's duration or waiting time ends, the emotion moves,
a word comes or goes. So a character is only judged anew when one of them has come; in between the decision
stands. The result is the same as judging every frame.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput
from game.embos.config import PlannerConfig
from game.embos.draws import character_keys, factor, uniform
from game.embos.explain import Candidate, explain
from game.embos.library import UnitLibrary
from game.embos.mixing import mix, mix_weights
from game.embos.tables import PlannerTables, build_tables

__all__ = ["TICK_S", "Decisions", "Factors", "Planner", "PlannerSignal", "PlannerState"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

TICK_S = 1.0 / 30.0
"""The simulation's step."""


@dataclass(frozen=True, eq=False)
class PlannerSignal:
    """What a tick brings. emotion: (n, 7) felt; words: (n, G) word factor per gesture unit, 1 at its word's moment,
    else 0 (columns as library.gestures); time_s: the moment of this tick."""

    emotion: Floats
    words: Floats
    time_s: float


@dataclass(frozen=True, eq=False)
class Decisions:
    """One unit per layer, columns in the order of the planner's layers.

    unit: (n, L) index into library.units. started: (n, L) bool, True in the tick a unit starts (again).
    start_time_s, duration_s: (n, L); a rest unit has duration 0. emotion_weights: (n, L, 7) normalised weights of
    eq. 5 at the start, all 0 for rest. variant_pick: (n, L) in [0, 1). stroke_s: (n, L) seconds from the start to
    the stroke of the mixed variants (gestures), 0 elsewhere.
    """

    unit: Ints
    started: Bools
    start_time_s: Floats
    duration_s: Floats
    emotion_weights: Floats
    variant_pick: Floats
    stroke_s: Floats


@dataclass(frozen=True, eq=False)
class PlannerState:
    """Where n characters stand; never changed in place, so an old state can be kept, saved or compared.

    key: (n,) uint64 of each character's draws. running: (n, L) slots. end_s: (n, L) end of the running unit's
    duration, −inf for rest. hold_s: (n, L) until when it may not be given up. wait_s: (n, P) end of each slot's
    waiting time, −inf if it never ran. starts: (n, L) how often the layer has started a unit. emotion: (n, 7) and
    phi_state: (n, P) as last computed. words: (n, G) of the last tick. next_s: (n,) when the decision may change
    by time alone. decisions: the last tick's.
    """

    key: NDArray[np.uint64]
    running: Ints
    end_s: Floats
    hold_s: Floats
    wait_s: Floats
    starts: NDArray[np.int64]
    emotion: Floats
    phi_state: Floats
    words: Floats
    next_s: Floats
    soonest_s: float
    decisions: Decisions

    def __len__(self) -> int:
        return len(self.key)


@dataclass(frozen=True, eq=False)
class Factors:
    """The factors of eq. 1 for R characters: continuity, time, state, linkage, score: (R, L, M); chosen: (R, L)
    slots. within: (R, L) the running unit is inside its duration."""

    continuity: Floats
    time: Floats
    state: Floats
    linkage: Floats
    score: Floats
    chosen: Ints
    within: Bools


class Planner:
    """Chooses units from a library by eq. 1. Immutable; all that changes is in the state."""

    def __init__(self, library: UnitLibrary, config: PlannerConfig | None = None) -> None:
        self.library = library
        self.config = config or PlannerConfig()
        self.tables: PlannerTables = build_tables(library, self.config)
        offsets = np.where(self.tables.unit[:, None] >= 0, library.stroke_offset_s[self.tables.unit], 0.0)
        self._stroke_s = offsets
        self._unit_of = np.append(self.tables.unit, -1)

    def start(self, n: int, rng_seed: int, first: int = 0) -> PlannerState:
        """n characters before their first tick: character first + i draws the same in any company."""
        t = self.tables
        layers = len(t.layers)
        running = np.tile(t.initial, (n, 1))
        never = np.full((n, layers), -np.inf)
        zero = np.zeros((n, layers))
        decisions = Decisions(
            unit=self._unit_of[running],
            started=np.zeros((n, layers), dtype=bool),
            start_time_s=zero,
            duration_s=zero,
            emotion_weights=np.zeros((n, layers, 7)),
            variant_pick=zero,
            stroke_s=zero,
        )
        return PlannerState(
            key=character_keys(rng_seed, first, n),
            running=running,
            end_s=never,
            hold_s=never,
            wait_s=np.full((n, t.slots), -np.inf),
            starts=np.zeros((n, layers), dtype=np.int64),
            emotion=np.full((n, 7), -9.0),
            phi_state=np.zeros((n, t.slots)),
            words=np.zeros((n, len(t.gesture_slots))),
            next_s=np.full(n, -np.inf),
            soonest_s=-np.inf,
            decisions=decisions,
        )

    def advance(
        self, state: PlannerState, signal: PlannerSignal, dt_s: float = TICK_S
    ) -> tuple[PlannerState, Decisions]:
        """One tick: eq. 1 where something has happened, the standing decision elsewhere.

        A threshold counts as passed when it lies before the middle of the coming tick, so that lengths are right
        on average. Raises BadInput for a signal of the wrong shape.
        """
        n = len(state)
        emotion, words = signal.emotion, signal.words
        if emotion.shape != (n, 7) or words.shape != state.words.shape:
            raise BadInput(
                "planner signal",
                expected=f"emotion {(n, 7)} and words {state.words.shape}",
                seen=f"{emotion.shape} and {words.shape}",
            )
        now = signal.time_s + 0.5 * dt_s
        same_words = not (words != state.words).any()
        moved_by = np.abs(emotion - state.emotion)
        if same_words and now <= state.soonest_s and moved_by.max(initial=0.0) <= self.config.tolerance:
            return _standing(state)
        moved = moved_by.max(axis=1) > self.config.tolerance
        due = moved | (state.next_s < now)
        if not same_words:
            due |= (words != state.words).any(axis=1)
        rows = np.flatnonzero(due)
        if rows.size == 0:
            return _standing(state)
        if moved.any():
            state = self._feel(state, emotion, np.flatnonzero(moved))
        if not same_words:
            state = replace(state, words=words.copy())
        factors = self.evaluate(state, rows, words[rows], now)
        return self._apply(state, rows, factors, signal.time_s, now)

    def explain(
        self, state: PlannerState, signal: PlannerSignal, character: int, dt_s: float = TICK_S
    ) -> list[list[Candidate]]:
        """Why: per layer all candidates with their factors and a reason, the chosen one first (see explain.py)."""
        return explain(self, state, signal, character, dt_s)

    def with_emotion(self, state: PlannerState, emotion: Floats) -> PlannerState:
        """The state after taking note of an emotion (n, 7), as advance would before deciding."""
        moved = np.abs(emotion - state.emotion).max(axis=1) > self.config.tolerance
        return self._feel(state, emotion, np.flatnonzero(moved)) if moved.any() else state

    def _feel(self, state: PlannerState, emotion: Floats, rows: Ints) -> PlannerState:
        """φ_state anew for the characters whose emotion has moved."""
        felt, phi = state.emotion.copy(), state.phi_state.copy()
        felt[rows] = emotion[rows]
        phi[rows] = self.tables.phi_state(felt[rows])
        return replace(state, emotion=felt, phi_state=phi)

    def evaluate(self, state: PlannerState, rows: Ints, words: Floats, now: float) -> Factors:
        """Eq. 1 for some characters: (R,) rows, (R, G) their word factors -> all factors and the slot chosen."""
        t, config = self.tables, self.config
        count, layers = len(rows), len(t.layers)
        shape = (count, layers, t.width)
        running, wait_s = state.running[rows], state.wait_s[rows]
        within = state.end_s[rows] >= now
        row, layer = np.nonzero(within)
        time = np.where(wait_s >= now, t.minimum, config.steady)
        time[row, running[row, layer]] = 1.0  # keep going
        phi = state.phi_state[rows]
        said = words
        if within[:, t.gesture_layer].any():
            # A gesture under way runs to its end though its word has passed.
            said = np.where(running[:, t.gesture_layer, None] == t.gesture_slots, within[:, t.gesture_layer, None], 0.0)
            said = np.maximum(words, said)
        phi[:, t.gesture_slots] *= said
        time, phi = time.reshape(shape), phi.reshape(shape)
        follow = t.follow[running]
        score = follow * time * phi
        link = np.ones(shape)
        chosen = np.empty_like(running)
        held = state.hold_s[rows] >= now
        each = np.arange(count)
        for at in range(layers):  # layers depend on those above: three steps, never more
            for above in range(at):
                link[:, at] *= t.blocks[chosen[:, above], at]
            score[:, at] *= link[:, at]
            best = score[:, at].argmax(axis=1)
            mine = running[:, at] - at * t.width
            ran = running[:, at] < t.slots
            mine = np.where(ran, mine, 0)
            # Kept: inside the least time, or nothing has any score at all (an emotion no take has shown).
            keep = ran & (held[:, at] | (score[each, at, best] <= 0.0)) & (link[each, at, mine] > 0.0)
            chosen[:, at] = np.where(keep, running[:, at], best + at * t.width)
        return Factors(follow, time, phi, link, score, chosen, within)

    def _apply(
        self, state: PlannerState, rows: Ints, factors: Factors, time_s: float, now: float
    ) -> tuple[PlannerState, Decisions]:
        """Start what was chosen, set durations and waiting times, note when to look again."""
        t, before = self.tables, state.decisions
        running, chosen = state.running[rows], factors.chosen
        end_s, hold_s, wait_s = state.end_s[rows], state.hold_s[rows], state.wait_s[rows]
        changed = chosen != running
        # A unit that wins again after its waiting time starts again; while it waits it is merely kept.
        over = ~changed & ~factors.within & ~t.rest[chosen]
        over &= np.take_along_axis(wait_s, chosen, axis=1) < now
        started = changed | over
        row, layer = np.nonzero(started)
        new: dict[str, Any] = {}
        if row.size:
            left, slot = running[row, layer], chosen[row, layer]
            # A unit cut short has had its duration: its waiting time begins now.
            cut = changed[row, layer] & (end_s[row, layer] >= now)
            wait_s[row[cut], left[cut]] -= end_s[row, layer][cut] - time_s
            emotion, counter = state.emotion[rows[row]], state.starts[rows[row], layer]
            weights = mix_weights(emotion, t.intensity[slot], t.exists[slot], self.config.radius)
            key, spread = state.key[rows[row]], t.cv[slot] * self.config.spread
            duration_s = mix(t.duration_s[slot], weights) * factor(uniform(key, layer, counter, 0), spread)
            waiting_s = mix(t.waiting_s[slot], weights) * factor(uniform(key, layer, counter, 1), spread)
            idle = t.rest[slot]
            duration_s = np.where(idle, 0.0, np.maximum(duration_s, t.least_s[layer]))
            end_s[row, layer] = np.where(idle, -np.inf, time_s + duration_s)
            hold_s[row, layer] = np.where(idle, -np.inf, time_s + t.least_s[layer])
            wait_s[row, slot] = np.where(idle, -np.inf, time_s + duration_s + waiting_s)
            event = rows[row]
            starts, hold, end, run = state.starts.copy(), state.hold_s.copy(), state.end_s.copy(), state.running.copy()
            starts[event, layer] += 1
            hold[event, layer], end[event, layer], run[event, layer] = hold_s[row, layer], end_s[row, layer], slot
            wait = state.wait_s.copy()
            wait[rows] = wait_s
            new = {"starts": starts, "hold_s": hold, "end_s": end, "running": run, "wait_s": wait}
            decided = {name: getattr(before, name).copy() for name in _DECIDED}
            decided["unit"][event, layer] = t.unit[slot]
            decided["start_time_s"][event, layer] = time_s
            decided["duration_s"][event, layer] = duration_s
            decided["emotion_weights"][event, layer] = weights
            decided["variant_pick"][event, layer] = uniform(key, layer, counter, 2)
            decided["stroke_s"][event, layer] = np.where(
                layer == t.gesture_layer, mix(self._stroke_s[slot], weights), 0.0
            )
        else:
            decided = {name: getattr(before, name) for name in _DECIDED}
        flags = np.zeros_like(before.started)
        flags[rows] = started
        decisions = Decisions(started=flags, **decided)
        next_s = state.next_s.copy()
        next_s[rows] = np.minimum(_next(wait_s, now), np.minimum(_next(end_s, now), _next(hold_s, now)))
        state = replace(state, decisions=decisions, next_s=next_s, soonest_s=float(next_s.min()), **new)
        return state, decisions


_DECIDED = ("unit", "start_time_s", "duration_s", "emotion_weights", "variant_pick", "stroke_s")


def _next(times_s: Floats, now: float) -> Floats:
    """(R, K) -> (R,): the first of the times that is still to come, inf if none."""
    return np.asarray(np.where(times_s >= now, times_s, np.inf).min(axis=1))


def _standing(state: PlannerState) -> tuple[PlannerState, Decisions]:
    """The tick in which nothing happens."""
    if state.decisions.started.any():
        decisions = replace(state.decisions, started=np.zeros_like(state.decisions.started))
        state = replace(state, decisions=decisions)
    return state, state.decisions
