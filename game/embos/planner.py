"""The planner: eq. 1 for every layer, for one character or for many with the same few array operations.

Nothing in eq. 1 changes between two of these events: a unit's duration or waiting time ends, the emotion moves,
a word comes or goes. So a character is only judged anew when one of them has come; in between the decision
stands. The result is the same as judging every frame.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput
from game.embos.config import PlannerConfig
from game.embos.draws import character_keys, factor, uniform
from game.embos.explain import Candidate, explain
from game.embos.library import UnitLibrary
from game.embos.mixing import mix, mix_weights
from game.embos.planner_state import TICK_S, Decisions, Factors, PlannerSignal, PlannerState
from game.embos.tables import CHUNK, PlannerTables, build_tables

__all__ = ["Planner"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


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
            words=np.zeros((n, t.gestures.stop - t.gestures.start)),
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
        # Pieces that stay in the cache; a character's result does not depend on its piece.
        pieces = [rows[i : i + CHUNK] for i in range(0, rows.size, CHUNK)]
        judged = [self.evaluate(state, piece, words[piece], now) for piece in pieces]
        return self._apply(state, rows, judged, signal.time_s, now)

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
        """Eq. 1 for some characters: (R,) rows, (R, G) their word factors -> all factors and the slots chosen."""
        t, config = self.tables, self.config
        count, layers, width = len(rows), len(t.layers), t.width
        running, wait_s, phi = state.running[rows], state.wait_s[rows], state.phi_state[rows]
        end_s, hold_s = state.end_s[rows], state.hold_s[rows]
        within = end_s >= now
        waits = wait_s >= now
        time = np.where(waits, t.minimum, config.steady)
        row, layer = within.nonzero()
        time[row, running[row, layer]] = 1.0  # keep going
        own = running[:, t.gesture_layer, None]
        # A gesture under way runs to its end though its word has passed.
        under_way = (own == t.gesture_slots) & within[:, t.gesture_layer, None]
        phi[:, t.gestures] *= np.maximum(words, under_way)
        follow = t.follow[running]
        score = (time * phi).reshape(count, layers, width)
        score *= follow
        linkage: list[Floats | None] = []
        chosen = np.empty_like(running)
        for at in range(layers):  # a layer depends on those above it: three steps, never more
            link = None
            for above in range(at):
                blocks = t.blocks[chosen[:, above], at]
                link = blocks if link is None else link * blocks
            if link is not None:
                score[:, at] *= link
            linkage.append(link)
            best = score[:, at].argmax(axis=1) + at * width
            if (best != running[:, at]).any():
                mine = running[:, at]
                best = np.where(self._kept(at, mine, best, score[:, at], time, link, hold_s[:, at] >= now), mine, best)
            chosen[:, at] = best
        # A unit that wins again after its waiting time starts again; while it waits it is merely kept.
        time_of = time[np.arange(count)[:, None], chosen]
        again = (chosen == running) & (time_of == config.steady) & t.real[chosen]
        next_s = np.where(waits, wait_s, np.inf).min(axis=1)
        next_s = np.minimum(next_s, np.where(within, end_s, np.inf).min(axis=1))
        next_s = np.minimum(next_s, np.where(hold_s >= now, hold_s, np.inf).min(axis=1))
        shape = (count, layers, width)
        return Factors(follow, time.reshape(shape), phi.reshape(shape), linkage, score, chosen, within, again, next_s)

    def _kept(
        self, at: int, mine: Ints, best: Ints, score: Floats, time: Floats, link: Floats | None, held: NDArray[Any]
    ) -> NDArray[Any]:
        """(R,) bool: the running slot stays although another has the best score."""
        t = self.tables
        each, ran = np.arange(len(mine)), mine < t.slots
        place = np.where(ran, mine - at * t.width, 0)
        score_mine, score_best = score[each, place], score[each, best - at * t.width]
        # Inside the least time; or nothing has any score at all (an emotion no take has shown); or the best is
        # itself waiting. Filling such gaps with it would give the strongest unit of an emotion more time than it
        # has in the take (random takes: shares agree at r = 0.94; with the running one kept 0.98, worst 0.95).
        gap = (time[each, best] <= t.minimum[at * t.width]) & (score_mine > 0.0)
        keep = ran & (held | gap | (score_best <= 0.0))
        return np.asarray(keep if link is None else keep & (link[each, place] > 0.0))

    def _apply(
        self, state: PlannerState, rows: Ints, judged: list[Factors], time_s: float, now: float
    ) -> tuple[PlannerState, Decisions]:
        """Start what was chosen, set durations and waiting times, note when to look again."""
        before = state.decisions
        chosen, again, soon = (
            getattr(judged[0], name) if len(judged) == 1 else np.concatenate([getattr(f, name) for f in judged])
            for name in ("chosen", "again", "next_s")
        )
        next_s = state.next_s.copy()
        next_s[rows] = soon
        changed = chosen != state.running[rows]
        started = changed | again
        row, layer = started.nonzero()
        if row.size == 0:
            state = replace(state, next_s=next_s, soonest_s=float(next_s.min()))
            return _standing(state)
        new, decided = self._begin(state, rows[row], layer, chosen[row, layer], changed[row, layer], time_s, now)
        np.minimum.at(next_s, rows[row], new.pop("soon"))
        flags = np.zeros_like(before.started)
        flags[rows] = started
        decisions = Decisions(started=flags, **decided)
        state = replace(state, decisions=decisions, next_s=next_s, soonest_s=float(next_s.min()), **new)
        return state, decisions

    def _begin(
        self, state: PlannerState, who: Ints, layer: Ints, slot: Ints, changed: NDArray[Any], time_s: float, now: float
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Start slots (S,) in layers (S,) of characters (S,) -> the state's and the decisions' new arrays."""
        t = self.tables
        running, end, hold = state.running.copy(), state.end_s.copy(), state.hold_s.copy()
        wait, starts = state.wait_s.copy(), state.starts.copy()
        # A unit cut short has had its duration: its waiting time begins now.
        left, ended_s = running[who, layer], end[who, layer]
        cut = changed & (ended_s >= now)
        wait[who[cut], left[cut]] -= ended_s[cut] - time_s
        soon = np.full(len(who), np.inf)
        soon[cut] = wait[who[cut], left[cut]]
        key, counter, spread = state.key[who], starts[who, layer], t.cv[slot] * self.config.spread
        weights = mix_weights(state.emotion[who], t.intensity[slot], t.exists[slot], self.config.radius)
        duration_s = mix(t.duration_s[slot], weights) * factor(uniform(key, layer, counter, 0), spread)
        waiting_s = mix(t.waiting_s[slot], weights) * factor(uniform(key, layer, counter, 1), spread)
        idle = t.rest[slot]
        duration_s = np.where(idle, 0.0, np.maximum(duration_s, t.least_s[layer]))
        running[who, layer] = slot
        end[who, layer] = np.where(idle, -np.inf, time_s + duration_s)
        hold[who, layer] = np.where(idle, -np.inf, time_s + t.least_s[layer])
        wait[who, slot] = np.where(idle, -np.inf, time_s + duration_s + waiting_s)
        starts[who, layer] += 1
        soon = np.where(idle, soon, np.minimum(soon, np.minimum(end[who, layer], hold[who, layer])))
        names = ("unit", "start_time_s", "duration_s", "emotion_weights", "variant_pick", "stroke_s")
        decided = {name: getattr(state.decisions, name).copy() for name in names}
        decided["unit"][who, layer] = t.unit[slot]
        decided["start_time_s"][who, layer] = time_s
        decided["duration_s"][who, layer] = duration_s
        decided["emotion_weights"][who, layer] = weights
        decided["variant_pick"][who, layer] = uniform(key, layer, counter, 2)
        strokes = layer == t.gesture_layer
        decided["stroke_s"][who, layer] = np.where(strokes, mix(self._stroke_s[slot], weights), 0.0)
        new = {"running": running, "end_s": end, "hold_s": hold, "wait_s": wait, "starts": starts, "soon": soon}
        return new, decided


def _standing(state: PlannerState) -> tuple[PlannerState, Decisions]:
    """The tick in which nothing happens."""
    if state.decisions.started.any():
        decisions = replace(state.decisions, started=np.zeros_like(state.decisions.started))
        state = replace(state, decisions=decisions)
    return state, state.decisions
