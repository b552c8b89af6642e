"""Autoplay's eye on the body: which units were on stage between decisions, and why each began.

The bodies of many talks live side by side, with the step's own functions and at its rate, but not in step with each
other: between two lines of its talk each goes through its ticks at one go (game.app.body_ahead, Planner.follow). The
result is what ``step`` gives, talk by talk.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import Mode
from game.app.body_ahead import TICKS, Ahead, first_tick_after
from game.app.loading import load_planner
from game.app.performance import factors_of, played_span
from game.app.step import PEAK_S, StepAssets, line_cues, reaction_to, targets_of, timed_line
from game.app.talk import TalkAssets, TalkState
from game.app.world import TICK_S
from game.embos import GestureCues, Planner, PlannerState, Told, greet, habit_of
from game.embos.draws import character_keys
from game.story import Spoken, TimedText

__all__ = ["BodyObserver", "Watched"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

NextBeat = Callable[[int, list["Watched"]], TalkState | None]

THINKING_TICKS = 61
"""How long the simulated player looks before deciding: 2 s and the tick in which the last word ended."""
PATIENCE_S = 0.4
"""After a line's end the next one is asked for."""
NEVER = 2**62
MAX_TICKS = 3000
"""A beat that is longer than this is broken off."""
CROWDED = 0.8
"""Where fewer than this share of the bodies still have a talk, the others are left out."""
TEXT_SPEED, LANGUAGE = "fast", "en"
SEEN: dict[Mode, tuple[str, ...]] = {
    "full": ("posture", "gesture", "mannerism"), "body": ("posture", "gesture", "mannerism"),
    "gestures": ("gesture",), "face": (),
}  # fmt: skip
"""Layers that can be seen in each mode: the others stand still."""


@dataclass(frozen=True)
class Watched:
    """One beat as the body played it. units: names in the order in which they came on stage; starts: JSON rows.

    quiet: those of them that could be seen after the last word, while the player made up their mind.
    """

    units: dict[str, None] = field(default_factory=dict)
    quiet: dict[str, None] = field(default_factory=dict)
    starts: list[dict[str, Any]] = field(default_factory=list)


@dataclass
class _Actor:
    """One talk: what changes between lines. number: of the talk, whatever its row is by now; reacted: the present
    beat's reaction has been shown, which its first answer brings."""

    number: int
    watched: list[Watched] = field(default_factory=list)
    talk: TalkState | None = None
    queue: tuple[Spoken, ...] = ()
    speaking: bool = False
    reacted: bool = False
    began: int = 0


@dataclass(frozen=True)
class BodyObserver:
    """Lets the lines of each beat be spoken with the planner on; observers change nothing in the talk.

    explain: also tell of each start its factors, reason, take and span.
    """

    planner: Planner
    mode: Mode = "full"
    explain: bool = True

    @staticmethod
    def load(mode: Mode = "full", *, explain: bool = True) -> BodyObserver:
        """With the shipped motion units."""
        return BodyObserver(load_planner(), mode, explain)

    def watch(
        self, assets: TalkAssets, talks: Sequence[Sequence[TalkState]], seed: int, first: int = 0
    ) -> list[list[Watched]]:
        """talks: per episode the states that its decisions led to; first: number of the first episode.

        -> per episode and decision what was seen until the next one.
        """

        def recorded(row: int, seen: list[Watched]) -> TalkState | None:
            return talks[row][len(seen)] if len(seen) < len(talks[row]) else None

        return self.play(assets, len(talks), recorded, seed, first)

    def play(self, assets: TalkAssets, count: int, beat: NextBeat, seed: int, first: int = 0) -> list[list[Watched]]:
        """``count`` talks whose beats are told one by one, each when what came before it has been seen.

        beat: (row, all that was seen of that talk so far) -> the state whose lines are spoken next, None at the end.
        """
        return _Bodies(self, StepAssets(assets, self.planner), count, beat, seed, first).run()


class _Bodies:
    """N talks, each at a tick of its own. All arrays have N rows; Python looks at a row where a line begins or ends.

    tick: the next one; due_s: when the present line has been heard out, −inf: one waits to begin;
    speaks, over_tick: ticks at which that is so, and at which the player has looked long enough; over: their talk is.
    """

    def __init__(
        self, observer: BodyObserver, assets: StepAssets, count: int, beat: NextBeat, seed: int, first: int
    ) -> None:
        self.observer, self.assets, self.planner = observer, assets, observer.planner
        self.beat = beat
        n, library, person = count, observer.planner.library, assets.talk.person
        self.actors = [_Actor(i) for i in range(n)]
        self.talks = list(self.actors)
        keys = [character_keys((seed * 1_000_003 + first + i) & 0x7FFFFFFF, 0, 1) for i in range(n)]
        self.state: PlannerState = self.planner.start_keyed(np.concatenate(keys))
        self.habit = habit_of(self.planner, person.habit_units, person.habit_rate)
        self.state = greet(self.state, self.habit, 0.0)
        self.ahead = Ahead.start(n, person)
        self.tick = np.zeros(n, dtype=np.int64)
        self.due_s = np.full(n, np.inf)
        self.speaks, self.over_tick = np.full(n, NEVER), np.zeros(n, dtype=np.int64)
        self.over, self.fresh = np.zeros(n, dtype=bool), np.zeros(n, dtype=bool)
        seen = np.array([layer in SEEN[observer.mode] for layer in self.planner.tables.layers])
        self.layers = np.flatnonzero(seen).tolist()
        # What is seen of each unit: its name, or nothing of a rest unit and of none (the last one).
        self.names = [None if u.is_rest else u.name for u in library.units] + [None]
        self.seen = np.array([name is not None for name in self.names])[:, None] & seen

    def run(self) -> list[list[Watched]]:
        """Until every talk has had its last beat."""
        while self.actors:
            due = self.over_tick <= self.tick
            for row in (due & ~self.over).nonzero()[0].tolist():
                self._next_beat(row)
            self._speak(((self.speaks <= self.tick) & ~self.over).nonzero()[0])
            live = (~self.over).nonzero()[0]
            if live.size:
                self._play(live)
            if live.size < CROWDED * len(self.actors):
                self._close_ranks(live)
        return [actor.watched for actor in self.talks]

    def _play(self, rows: Ints) -> None:
        """The rows go through the ticks up to what Python has to look after next, or some way towards it."""
        left = np.minimum(self.speaks[rows], self.over_tick[rows]) - self.tick[rows]
        length = np.minimum(left, TICKS)
        course = self.ahead.look(rows, self.tick[rows], length, self.fresh[rows], self.habit)
        for told in self.planner.follow(self.state, rows, course, TICK_S, before=self.observer.explain):
            self._note(rows, told)
        self.tick[rows] += length

    def _close_ranks(self, live: Ints) -> None:
        """Bodies whose talk is over leave; the others go on as before."""
        self.actors = [self.actors[row] for row in live]
        for name in ("tick", "due_s", "speaks", "over_tick", "over", "fresh"):
            setattr(self, name, getattr(self, name)[live])
        self.ahead.keep(live)
        self.state = self.state.of(live)

    def _next_beat(self, row: int) -> None:
        """The decision falls: what it led to is said from this tick on, or the talk is over."""
        actor, tick = self.actors[row], int(self.tick[row])
        talk = self.beat(actor.number, actor.watched)
        if talk is None:
            self.over[row] = True
            return
        if not actor.watched:
            self._feel(row, *targets_of(self.assets, talk))
        actor.talk, actor.queue, actor.began, actor.reacted = talk, talk.beat.lines, tick, False
        actor.watched.append(Watched())
        self.fresh[row], self.over_tick[row] = True, tick + MAX_TICKS
        if not actor.speaking:
            self.due_s[row], self.speaks[row] = -np.inf, tick
            if not actor.queue:
                self._all_said(row)

    def _speak(self, rows: Ints) -> None:
        """Lines begin or have been heard out."""
        spoken: list[tuple[int, Spoken]] = []
        for row in rows.tolist():
            actor = self.actors[row]
            if actor.queue:
                line, actor.queue = actor.queue[0], actor.queue[1:]
                actor.speaking = True
                if line.speaker == "shopkeeper":
                    spoken.append((row, line))
                else:
                    self._say(row, timed_line(line, LANGUAGE, TEXT_SPEED), None, float(self.tick[row] * TICK_S))
                continue
            # Everything is said: what is felt now is what the next line will be judged by.
            assert actor.talk is not None
            self._feel(row, *targets_of(self.assets, actor.talk))
            actor.speaking = False
            self._all_said(row)
        if not spoken:
            return
        who = np.array([row for row, _ in spoken], dtype=np.intp)
        time_s: Floats = np.asarray(self.tick[who] * TICK_S, dtype=np.float64)
        emotion = self.ahead.leaked(who, time_s)
        lead_s = self.planner.library.stroke_lead_s(emotion)
        for at, (row, line) in enumerate(spoken):
            actor, now_s = self.actors[row], float(time_s[at])
            timed = timed_line(line, LANGUAGE, TEXT_SPEED)
            cues, start_s = line_cues(self.planner, timed, line.gesture, emotion[at], lead_s[at], now_s)
            self._say(row, timed, cues, start_s)
            if not actor.reacted:
                actor.reacted = True
                reaction = reaction_to(actor.talk, line, self.ahead.target[row, :6])
                if reaction is not None:
                    self._feel(row, *reaction)
                    self.ahead.burst_s[row] = now_s + PEAK_S

    def _say(self, row: int, timed: TimedText, cues: GestureCues | None, start_s: float) -> None:
        """A line begins."""
        self.ahead.say(row, cues)
        due_s = start_s + timed.length_s + PATIENCE_S
        self.due_s[row], self.speaks[row] = due_s, first_tick_after(due_s)

    def _feel(self, row: int, felt: Floats, shown: Floats) -> None:
        """What the body's feeling and the face go towards from now on."""
        self.ahead.target[row, :6], self.ahead.target[row, 6:] = felt, shown[:6]

    def _all_said(self, row: int) -> None:
        """The last word is spoken: what is on stage now stays to be seen."""
        actor = self.actors[row]
        self.ahead.say(row, None)
        self.due_s[row], self.speaks[row] = np.inf, NEVER
        self.over_tick[row] = min(int(self.tick[row]) + THINKING_TICKS, actor.began + MAX_TICKS)
        self._see(row, self.state.decisions.unit[row].tolist(), self.layers)

    def _see(self, row: int, units: Sequence[int], layers: Sequence[int]) -> None:
        """What is on stage in these layers is seen in the present beat. units: (L,) on stage."""
        watched, quiet = self.actors[row].watched[-1], self.due_s[row] == np.inf
        for at in layers:
            name = self.names[units[at]]
            if name is not None:
                watched.units[name] = None
                if quiet:
                    watched.quiet[name] = None

    def _note(self, rows: Ints, told: Told) -> None:
        """Who came on stage, and why. In a beat's first tick all are seen who are on stage."""
        decisions = told.decisions
        new = decisions.started & self.seen[decisions.unit, np.arange(decisions.unit.shape[1])]
        some = new.any(axis=1)
        which, units, fresh = rows[told.row], decisions.unit.tolist(), self.fresh
        for at in (some | fresh[which]).nonzero()[0].tolist():
            row = int(which[at])
            self._see(row, units[at], self.layers if fresh[row] else new[at].nonzero()[0].tolist())
            fresh[row] = False
        if not self.observer.explain or not np.count_nonzero(some):
            return
        who = some.nonzero()[0]
        reasons = self.planner.explain_chosen(PlannerState(told.before, -np.inf, True), told.signal, who)
        library, time_s = self.planner.library, np.asarray(told.signal.time_s)
        for place, of in zip(who.tolist(), reasons, strict=True):
            for at in new[place].nonzero()[0].tolist():
                self.actors[int(which[place])].watched[-1].starts.append(
                    {
                        "time_s": round(float(time_s[place]), 3),
                        "layer": of[at].layer,
                        "unit": of[at].name,
                        "factors": factors_of(of[at]),
                        "reason": of[at].reason,
                        "source": played_span(library, decisions, place, at),
                    }
                )
