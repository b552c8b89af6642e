"""The planner: eq. 1 for every layer, for one character or for many with the same few array operations.

Nothing in eq. 1 changes between two of these events: a unit's duration or waiting time ends, the emotion moves,
a word comes or goes. So a character is only judged anew when one of them has come; in between the decision
stands. The result is the same as judging every frame.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput
from game.embos.config import PlannerConfig
from game.embos.draws import character_keys, factor, uniform
from game.embos.explain import Candidate, explain, explain_chosen
from game.embos.library import UnitLibrary
from game.embos.mixing import mix, mix_weights
from game.embos.planner_state import TICK_S, Decisions, Factors, Habit, PlannerSignal, PlannerState
from game.embos.tables import CHUNK, PlannerTables, build_tables

__all__ = ["Planner"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]


LEAP = 0.35
"""A change of any of the seven emotions beyond this is one that strikes."""


class Planner:
    """Chooses units from a library by eq. 1. Immutable; all that changes is in the state."""

    def __init__(self, library: UnitLibrary, config: PlannerConfig | None = None) -> None:
        self.library = library
        self.config = config or PlannerConfig()
        self.tables: PlannerTables = build_tables(library, self.config)

    def start(self, n: int, rng_seed: int, first: int = 0) -> PlannerState:
        """n characters before their first tick: character first + i draws the same in any company."""
        t = self.tables
        layers = len(t.layers)
        running = np.tile(t.initial, (n, 1))
        decisions = Decisions(
            unit=np.where(running < t.slots, t.unit[np.minimum(running, t.slots - 1)], -1),
            started=np.zeros((n, layers), dtype=bool),
            numbers=np.zeros((n, layers, 11)),
        )
        return PlannerState(
            key=character_keys(rng_seed, first, n),
            running=running,
            marks_s=np.full((n, layers, 2), -np.inf),
            wait_s=np.full((n, t.slots), -np.inf),
            untried=np.ones((n, t.slots), dtype=bool),
            starts=np.zeros((n, layers), dtype=np.int64),
            emotion=np.full((n, 7), -9.0),
            settled=np.full((n, 7), -9.0),
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

        Raises BadInput for a signal of the wrong shape.
        """
        n = len(state)
        emotion, words = signal.emotion, signal.words
        if emotion.shape != (n, 7) or words.shape != state.words.shape:
            raise BadInput(
                "planner signal",
                expected=f"emotion {(n, 7)} and words {state.words.shape}",
                seen=f"{emotion.shape} and {words.shape}",
            )
        now = self.moment(signal.time_s, dt_s)
        said_anew, moved_by = words != state.words, np.abs(emotion - state.emotion)
        new_words = np.count_nonzero(said_anew)
        looking = self._looks(signal.time_s, dt_s)
        moving = looking and np.count_nonzero(moved_by > self.config.tolerance)
        all_begun = state.soonest_s > -np.inf
        if not new_words and not moving and all_begun and (not looking or now <= state.soonest_s):
            return _standing(state)
        fresh = (state.starts == 0).all(axis=1)  # a posture starts in everyone's first tick
        due = state.next_s < now if looking else fresh
        moved = moved_by.max(axis=1) > self.config.tolerance if looking else fresh
        due = due | moved
        state = self._settle(self._feel(state, emotion, moved), fresh, signal.time_s)
        if new_words:
            due = due | said_anew.any(axis=1)
            state = state.renewed(words=words.copy())
        rows = due.nonzero()[0]
        # Pieces that stay in the cache; a character's result does not depend on its piece.
        pieces = [rows[i : i + CHUNK] for i in range(0, rows.size, CHUNK)]
        judged = [self.evaluate(state, piece, words[piece], now, signal.habit) for piece in pieces]
        return self._apply(state, rows, judged, signal.time_s, now)

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

    def prepared(self, state: PlannerState, signal: PlannerSignal) -> PlannerState:
        """The state as eq. 1 finds it in this tick: the emotion noted, whoever begins settled."""
        moved = np.abs(signal.emotion - state.emotion).max(axis=1) > self.config.tolerance
        fresh = (state.starts == 0).all(axis=1)
        return self._settle(self._feel(state, signal.emotion, moved), fresh, signal.time_s)

    def _feel(self, state: PlannerState, emotion: Floats, moved: Bools) -> PlannerState:
        """φ_state anew for the characters whose emotion has moved, (n,) bool."""
        rows = moved.nonzero()[0]
        if rows.size == 0:
            return state
        felt, phi = state.emotion.copy(), state.phi_state.copy()
        felt[rows] = emotion[rows]
        phi[rows] = self.tables.phi_state(felt[rows])
        return state.renewed(emotion=felt, phi_state=phi)

    def _settle(self, state: PlannerState, fresh: Bools, time_s: float) -> PlannerState:
        """Some way through its waiting time, for each unit of the settled layers of characters about to begin.

        Where the emotion has leapt since, units that have not run yet come sooner: a feeling that strikes shows.
        """
        t, slots = self.tables, self.tables.settled
        leapt = np.abs(state.emotion - state.settled).max(axis=1) > LEAP
        rows = (fresh | leapt).nonzero()[0]
        if slots.size == 0 or rows.size == 0:
            return state
        weights = mix_weights(state.emotion[rows, None], t.intensity[slots], t.exists[slots], self.config.radius)
        period_s = mix(t.timing_s[slots, 0] + t.timing_s[slots, 1], weights)
        who, which = np.indices((len(rows), len(slots))).reshape(2, -1)
        first = fresh[rows]
        # Events of their own, before the first start.
        event = np.where(first, -1, -2).astype(np.int64)[who]
        chance = uniform(state.key[rows[who]], slots[which], event, 1).reshape(period_s.shape)
        at = np.ix_(rows, slots)
        drawn_s = time_s + chance * period_s * np.where(first, 1.0, self.config.eager)[:, None]
        old_s = state.wait_s[at]
        sooner = state.untried[at] & (first[:, None] | (drawn_s < old_s))
        wait_s, settled = state.wait_s.copy(), state.settled.copy()
        wait_s[at] = np.where(sooner, drawn_s, old_s)
        settled[rows] = state.emotion[rows]
        return state.renewed(wait_s=wait_s, settled=settled)

    def evaluate(
        self, state: PlannerState, rows: Ints, words: Floats, now: float, habit: Habit | None = None
    ) -> Factors:
        """Eq. 1 for some characters: (R,) rows, (R, G) their word factors -> all factors and the slots chosen."""
        t, config = self.tables, self.config
        count, layers, width = len(rows), len(t.layers), t.width
        # Everybody in order (a character alone, above all) is looked at in place instead of gathered.
        some: Ints | slice = slice(None) if count == len(state) else rows
        running, wait_s, marks_s = state.running[some], state.wait_s[some], state.marks_s[some]
        ahead = marks_s >= now
        within, held = ahead[..., 0], ahead[..., 1]
        waits = wait_s >= now
        time = np.where(waits, t.minimum, config.steady)
        row, layer = within.nonzero()
        time[row, running[row, layer]] = 1.0  # keep going
        if np.count_nonzero(within[:, t.gesture_layer]):
            # A gesture under way runs to its end though its word has passed.
            under_way = running[:, t.gesture_layer, None] == t.gesture_slots
            words = np.maximum(words, under_way & within[:, t.gesture_layer, None])
        phi = state.phi_state[rows]
        phi[:, t.gestures] *= words
        if habit is not None:
            phi[:, habit.slots] = np.maximum(phi[:, habit.slots], habit.share)
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
            mine = running[:, at]
            if np.count_nonzero(best != mine):
                best = np.where(self._kept(at, mine, best, score[:, at], time, link, held[:, at]), mine, best)
            chosen[:, at] = best
        # A unit that wins again after its waiting time starts again; while it waits it is merely kept.
        again = (chosen == running) & ~within & t.real[chosen]
        if np.count_nonzero(again):
            again &= time[np.arange(count)[:, None], chosen] == config.steady
        next_s = np.where(waits, wait_s, np.inf).min(axis=1)
        next_s = np.minimum(next_s, np.where(ahead, marks_s, np.inf).min(axis=(1, 2)))
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
            return _standing(state.renewed(next_s=next_s, soonest_s=float(next_s.min())))
        flags = np.zeros(state.running.shape, dtype=bool)
        flags[rows] = started
        at = (row, layer)
        state, soon = self._begin(state, rows[row], layer, chosen[at], changed[at], flags, time_s, now)
        np.minimum.at(next_s, rows[row], soon)
        state = state.renewed(next_s=next_s, soonest_s=float(next_s.min()))
        return state, state.decisions

    def _begin(
        self,
        state: PlannerState,
        who: Ints,
        layer: Ints,
        slot: Ints,
        changed: NDArray[Any],
        flags: Bools,
        time_s: float,
        now: float,
    ) -> tuple[PlannerState, Floats]:
        """Start slots (S,) in layers (S,) of characters (S,) -> the new state, and (S,) when to look again."""
        t, old = self.tables, state.decisions
        running, marks_s, wait_s = state.running.copy(), state.marks_s.copy(), state.wait_s.copy()
        starts, numbers, unit = state.starts.copy(), old.numbers.copy(), old.unit.copy()
        untried = state.untried.copy()
        untried[who, slot] = False
        soon = np.full(len(who), np.inf)
        # A unit cut short has had its duration: its waiting time begins now.
        ended_s = marks_s[who, layer, 0]
        cut = (changed & (ended_s >= now)).nonzero()[0]
        if cut.size:
            left = (who[cut], running[who[cut], layer[cut]])
            wait_s[left] -= ended_s[cut] - time_s
            soon[cut] = np.maximum(wait_s[left], now)
        counter = starts[who, layer]
        chance = uniform(state.key[who], layer, counter, 3)
        weights = mix_weights(state.emotion[who], t.intensity[slot], t.exists[slot], self.config.radius)
        mixed = mix(t.timing_s[slot], weights[:, None, :])  # (S, 3): L_d, L_w, start to stroke; 0 for rest
        mixed[:, :2] *= factor(chance[:, :2], t.sigma[slot])
        duration_s = np.maximum(mixed[:, 0], t.least_s[slot])
        end_s = time_s + duration_s
        new_marks = np.stack([end_s, time_s + t.least_s[slot]], axis=1)
        running[who, layer], starts[who, layer], unit[who, layer] = slot, counter + 1, t.unit[slot]
        marks_s[who, layer], wait_s[who, slot] = new_marks, end_s + mixed[:, 1]
        start_s = np.full_like(end_s, time_s)
        head = np.stack([start_s, duration_s, chance[:, 2], mixed[:, 2]], axis=1)
        numbers[who, layer] = np.concatenate([head, weights], axis=1)
        soon = np.minimum(soon, np.where(new_marks >= now, new_marks, np.inf).min(axis=1))
        decisions = Decisions(unit, flags, numbers)
        state = state.renewed(
            running=running, marks_s=marks_s, wait_s=wait_s, untried=untried, starts=starts, decisions=decisions
        )
        return state, soon


def _standing(state: PlannerState) -> tuple[PlannerState, Decisions]:
    """The tick in which nothing starts."""
    old = state.decisions
    if np.count_nonzero(old.started):
        state = state.renewed(decisions=Decisions(old.unit, np.zeros_like(old.started), old.numbers))
    return state, state.decisions
