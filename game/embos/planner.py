"""The planner: eq. 1 for every layer, for one character or for many with the same few array operations.

Nothing in eq. 1 changes between two of these events: a unit's duration or waiting time ends, the emotion moves,
a word comes or goes. So a character is only judged anew when one of them has come that can change the decision; in
between it stands. The result is the same as judging every frame.
"""

from __future__ import annotations

from typing import Any, TypeVar

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


Time = TypeVar("Time", float, Floats)

NOBODY: Ints = np.zeros(0, dtype=np.intp)
NOBODY.setflags(write=False)
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
            calm=np.zeros(n, dtype=bool),
            soonest_s=-np.inf,
            decisions=decisions,
        )

    def advance(
        self, state: PlannerState, signal: PlannerSignal, dt_s: float = TICK_S, *, spend: bool = False
    ) -> tuple[PlannerState, Decisions]:
        """One tick: eq. 1 where something has happened, the standing decision elsewhere.

        spend: the old state is needed no more, so that its arrays may be written to (a crowd's are large).
        Raises BadInput for a signal of the wrong shape.
        """
        n = len(state)
        if signal.emotion.shape != (n, 7) or signal.words.shape != state.words.shape:
            raise BadInput(
                "planner signal",
                expected=f"emotion {(n, 7)} and words {state.words.shape}",
                seen=f"{signal.emotion.shape} and {signal.words.shape}",
            )
        said = signal.words != state.words
        spoken = np.count_nonzero(said)
        rows = self._due(state, signal, dt_s, said if spoken else None)
        if rows.size:
            state = self.judge(state, rows, signal if rows.size == n else signal.of(rows), dt_s, spend=spend)
        elif np.count_nonzero(state.decisions.started):
            state = state.standing()
        if spoken:
            state = state.renewed(words=signal.words.copy())
        return state, state.decisions

    def _due(self, state: PlannerState, signal: PlannerSignal, dt_s: float, said: Bools | None) -> Ints:
        """(R,) whose decisions may change in this tick. said: (n, G) words that have come or gone, None for none."""
        time_s = float(signal.time_s)  # one for all here
        now, looking = self.moment(time_s, dt_s), self._looks(time_s, dt_s)
        far = np.abs(signal.emotion - state.emotion) > self.config.tolerance
        moving = looking and np.count_nonzero(far)
        if said is None and not moving and state.soonest_s > -np.inf and (not looking or now <= state.soonest_s):
            return NOBODY
        due = state.next_s < now if looking else state.fresh()  # a posture starts in everyone's first tick
        if moving:
            due = due | far.any(axis=1)
        if said is not None:
            # A word that goes is heard by those whom it may move, or who look at the clock only now and then.
            ending = ~state.calm | (state.next_s < now)
            due = due | (signal.words > state.words).any(axis=1) | (said.any(axis=1) & ending)
        return due.nonzero()[0]

    def judge(
        self, state: PlannerState, rows: Ints, signal: PlannerSignal, dt_s: float = TICK_S, *, spend: bool = False
    ) -> PlannerState:
        """Eq. 1 for the characters ``rows`` (R,); the signal has R rows and may bring each a time of its own.

        Only these stand in ``decisions.started``. Who has nothing to decide may be judged too and stays as they are.
        """
        if not spend:
            state = state.copied()
        time_s = np.full(rows.size, signal.time_s)
        self._feel(state, rows, signal.emotion, self._looks(signal.time_s, dt_s))
        self._settle(state, rows, time_s)
        state.words[rows] = signal.words
        now = self.moment(time_s, dt_s)
        # Pieces that stay in the cache; a character's result does not depend on its piece.
        judged = []
        for first in range(0, rows.size, CHUNK):
            piece = slice(first, first + CHUNK)
            judged.append(self.evaluate(state, rows[piece], signal.words[piece], now[piece], signal.habit))
        self._apply(state, rows, judged, time_s, now)
        return state.renewed(soonest_s=float(state.next_s.min()))

    def moment(self, time_s: Time, dt_s: float) -> Time:
        """Thresholds before this moment count as passed: half a look ahead, so that lengths are right on average."""
        return time_s + 0.5 * max(self.config.look_s, dt_s)

    def _looks(self, time_s: float | Floats, dt_s: float) -> Any:
        """Whether times and emotions are looked at in this tick (config.look_s): True, or bool for each time."""
        look_s = self.config.look_s
        if look_s <= dt_s:
            return True
        return np.floor((time_s + 1e-6) / look_s) > np.floor((time_s - dt_s + 1e-6) / look_s)

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

    def prepared(self, state: PlannerState, signal: PlannerSignal, rows: Ints) -> PlannerState:
        """Some characters as eq. 1 finds them in this tick: the emotion noted, whoever begins settled."""
        few, everyone = state.of(rows), np.arange(len(rows))
        self._feel(few, everyone, signal.emotion[rows], True)
        self._settle(few, everyone, np.full(len(rows), signal.of(rows).time_s))
        return few

    def _feel(self, state: PlannerState, rows: Ints, emotion: Floats, looking: Any) -> None:
        """φ_state anew for those of the rows whose emotion, (R, 7), has moved or is looked at for the first time."""
        moved = np.abs(emotion - state.emotion.take(rows, axis=0)).max(axis=1) > self.config.tolerance
        if looking is not True:
            moved &= looking | state.fresh()[rows]
        some = moved.nonzero()[0]
        if some.size:
            who, felt = rows[some], emotion[some]
            state.emotion[who] = felt
            state.phi_state[who] = self.tables.phi_state(felt)

    def _settle(self, state: PlannerState, among: Ints, time_s: Floats) -> None:
        """Some way through its waiting time, for each unit of the settled layers of characters about to begin.

        Where the emotion has leapt since, units that have not run yet come sooner: a feeling that strikes shows.
        """
        t, slots = self.tables, self.tables.settled
        if slots.size == 0:
            return
        # … or has never been settled.
        leapt = np.abs(state.emotion.take(among, axis=0) - state.settled.take(among, axis=0)).max(axis=1) > LEAP
        if not np.count_nonzero(leapt):
            return
        rows, time_s = among[leapt], time_s[leapt, None]
        weights = mix_weights(state.emotion[rows, None], t.intensity[slots], t.exists[slots], self.config.radius)
        period_s = mix(t.timing_s[slots, 0] + t.timing_s[slots, 1], weights)
        who, which = np.indices((len(rows), len(slots))).reshape(2, -1)
        first = state.fresh()[rows]
        # Events of their own, before the first start.
        event = np.where(first, -1, -2).astype(np.int64)[who]
        chance = uniform(state.key[rows[who]], slots[which], event, 1).reshape(period_s.shape)
        at = np.ix_(rows, slots)
        drawn_s = time_s + chance * period_s * np.where(first, 1.0, self.config.eager)[:, None]
        old_s = state.wait_s[at]
        sooner = state.untried[at] & (first[:, None] | (drawn_s < old_s))
        state.wait_s[at] = np.where(sooner, drawn_s, old_s)
        state.settled[rows] = state.emotion[rows]

    def evaluate(
        self, state: PlannerState, rows: Ints, words: Floats, now: float | Floats, habit: Habit | None = None
    ) -> Factors:
        """Eq. 1 for some characters: (R,) rows, (R, G) their word factors, now: the moment, or (R,) moments.

        -> all factors and the slots chosen.
        """
        t, config = self.tables, self.config
        count, layers, width = len(rows), len(t.layers), t.width
        late = np.asarray(now)[..., None]
        # take is the quicker of two ways to gather rows.
        running, wait_s = state.running.take(rows, axis=0), state.wait_s.take(rows, axis=0)
        marks_s = state.marks_s.take(rows, axis=0)
        ahead = marks_s >= late[..., None]
        within, held = ahead[..., 0], ahead[..., 1]
        waits = wait_s >= late
        first = np.arange(0, count * t.slots, t.slots)[:, None]  # of each character's slots, all in one row
        time = np.where(waits, t.minimum, config.steady)
        time.ravel()[(first + running)[within]] = 1.0  # keep going
        if np.count_nonzero(within[:, t.gesture_layer]):
            # A gesture under way runs to its end though its word has passed.
            under_way = running[:, t.gesture_layer, None] == t.gesture_slots
            words = np.maximum(words, under_way & within[:, t.gesture_layer, None])
        phi = state.phi_state.take(rows, axis=0)
        phi[:, t.gestures] *= words
        if habit is not None:
            phi[:, habit.slots] = np.maximum(phi[:, habit.slots], habit.share)
        follow = t.follow.take(running, axis=0)
        score = (time * phi).reshape(count, layers, width)
        score *= follow
        linkage: list[Floats | None] = []
        chosen, beaten = np.empty_like(running), np.zeros(running.shape, dtype=bool)
        for at in range(layers):  # a layer depends on those above it: three steps, never more
            link = None
            for above in range(at):
                blocks = t.blocks[at].take(chosen[:, above], axis=0)
                link = blocks if link is None else link * blocks
            if link is not None:
                score[:, at] *= link
            linkage.append(link)
            best, mine = score[:, at].argmax(axis=1) + at * width, running[:, at]
            other = (best != mine).nonzero()[0]
            if other.size:
                places = first[other, 0]
                keep = self._kept(at, mine[other], best[other], places, score, time, held[other, at])
                if link is not None:
                    keep &= link[other, np.minimum(mine[other] - at * width, width - 1)] > 0.0
                stay = other[keep]
                best[stay] = mine[stay]
                beaten[stay, at] = True
            chosen[:, at] = best
        place = first + chosen
        # A unit that wins again after its waiting time starts again; while it waits it is merely kept.
        again = (chosen == running) & ~within & t.real[chosen]
        if np.count_nonzero(again):
            again &= time.ravel()[place] == config.steady
        started = (chosen != running) | again
        anew = started.any(axis=1)
        # What can change the decision by time alone: the end of a duration, the least time of a unit that is beaten,
        # the end of a wait after which a unit would score as much as the one chosen. Who starts something is judged
        # from another unit next time, so there every end counts.
        bar = score.reshape(-1)[place] * t.reach
        bar[anew] = -1.0
        waits &= (score >= bar[..., None]).reshape(waits.shape)
        ahead[..., 1] &= beaten | anew[:, None]
        next_s = np.where(ahead, marks_s, np.inf).min(axis=(1, 2))
        who, slot = waits.nonzero()
        np.minimum.at(next_s, who, wait_s[who, slot])
        gesture = chosen[:, t.gesture_layer]
        calm = ~(anew | beaten[:, t.gesture_layer]) & (within[:, t.gesture_layer] | ~t.real[gesture])
        shape = (count, layers, width)
        return Factors(
            follow, time.reshape(shape), phi.reshape(shape), linkage, score, chosen, within, started, next_s, calm
        )

    def _kept(self, at: int, mine: Ints, best: Ints, first: Ints, score: Floats, time: Floats, held: Bools) -> Bools:
        """(K,) bool: the running slot stays although another has the best score. first: of each one's slots."""
        t = self.tables
        ran, score = mine < t.slots, score.reshape(-1)
        score_mine, score_best = score[first + np.where(ran, mine, 0)], score[first + best]
        # Inside the least time; or nothing has any score at all (an emotion no take has shown); or the best is
        # itself waiting. Filling such gaps with it would give the strongest unit of an emotion more time than it
        # has in the take (random takes: shares agree at r = 0.94; with the running one kept 0.98, worst 0.95).
        gap = (time.reshape(-1)[first + best] <= t.minimum[at * t.width]) & (score_mine > 0.0)
        return np.asarray(ran & (held | gap | (score_best <= 0.0)))

    def _apply(self, state: PlannerState, rows: Ints, judged: list[Factors], time_s: Floats, now: Floats) -> None:
        """Start what was chosen, set durations and waiting times, note when to look again."""
        chosen, started, next_s, calm = (
            getattr(judged[0], name) if len(judged) == 1 else np.concatenate([getattr(f, name) for f in judged])
            for name in ("chosen", "started", "next_s", "calm")
        )
        state.next_s[rows], state.calm[rows] = next_s, calm
        state.decisions.started[:] = False
        event, layer = started.nonzero()
        if event.size:
            state.decisions.started[rows] = started
            self._begin(state, rows[event], layer, chosen[event, layer], time_s[event], now[event])

    def _begin(self, state: PlannerState, who: Ints, layer: Ints, slot: Ints, time_s: Floats, now: Floats) -> None:
        """Start slots (S,) in layers (S,) of characters (S,) at their times."""
        t, at = self.tables, (who, layer)
        state.untried[who, slot] = False
        # A unit cut short has had its duration: its waiting time begins now.
        ended_s, left = state.marks_s[who, layer, 0], state.running[at]
        cut = ((left != slot) & (ended_s >= now)).nonzero()[0]
        if cut.size:
            place = (who[cut], left[cut])
            state.wait_s[place] -= ended_s[cut] - time_s[cut]
            np.minimum.at(state.next_s, who[cut], np.maximum(state.wait_s[place], now[cut]))
        counter = state.starts[at]
        chance = uniform(state.key[who], layer, counter, 3)
        numbers = np.empty((len(who), 11))
        weights = mix_weights(state.emotion[who], t.intensity[slot], t.exists[slot], self.config.radius)
        mixed = mix(t.timing_s[slot], weights[:, None, :])  # (S, 3): L_d, L_w, start to stroke; 0 for rest
        mixed[:, :2] *= factor(chance[:, :2], t.sigma[slot])
        least_s = t.least_s[slot]
        numbers[:, 0], numbers[:, 1], numbers[:, 2] = time_s, np.maximum(mixed[:, 0], least_s), chance[:, 2]
        numbers[:, 3], numbers[:, 4:] = mixed[:, 2], weights
        marks_s = np.empty((len(who), 2))
        marks_s[:, 0], marks_s[:, 1] = time_s + numbers[:, 1], time_s + least_s
        state.running[at], state.starts[at], state.marks_s[at] = slot, counter + 1, marks_s
        state.wait_s[who, slot] = marks_s[:, 0] + mixed[:, 1]
        state.decisions.unit[at], state.decisions.numbers[at] = t.unit[slot], numbers
        np.minimum.at(state.next_s, who, np.where(marks_s >= now[:, None], marks_s, np.inf).min(axis=1))
