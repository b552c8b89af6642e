"""Autoplay's eye on the body: which units were on stage between decisions, and why each began.

The bodies of many talks live side by side: feelings and planner run for all of them in the same few array
operations, at the step's own rate and with its own functions; only where a line begins or ends does a talk need a
world of its own. The result is what ``step`` gives, talk by talk.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import Mode
from game.app.loading import load_planner
from game.app.performance import factors_of, played_span
from game.app.step import StepAssets, feelings_after, leaked_emotion, new_world, speech_stage
from game.app.talk import TalkAssets, TalkState
from game.app.world import TICK_S, Intent, World, enter_talk
from game.core.emotion_space import with_neutral
from game.embos import Decisions, Planner, PlannerSignal, PlannerState, greet, habit_of

__all__ = ["BATCH", "BodyObserver", "Watched"]

Floats = NDArray[np.float64]

NextBeat = Callable[[int, list["Watched"]], TalkState | None]

BATCH = 512
"""Talks whose bodies run side by side."""
THINKING_TICKS = 61
"""How long the simulated player looks before deciding: 2 s and the tick in which the last word ended."""
PATIENCE_S = 0.4
"""After a line's end the next one is asked for."""
NEVER = 2**62
MAX_TICKS = 3000
"""A beat that is longer than this is broken off."""
CROWDED = 0.8
"""Where fewer than this share of the bodies still have a talk, the others are left out."""
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
    """One talk's body: what of its world changes between lines. number: of the talk, whatever its row is by now."""

    number: int
    world: World
    watched: list[Watched]
    began: int = 0
    over: bool = False


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
    """N talks in step. All arrays have N rows; a row's world is asked only when a line begins or ends."""

    def __init__(
        self,
        observer: BodyObserver,
        assets: StepAssets,
        count: int,
        beat: NextBeat,
        seed: int,
        first: int,
    ) -> None:
        self.observer, self.assets, self.planner = observer, assets, observer.planner
        self.beat = beat
        n, library = count, observer.planner.library
        seeds = [(seed * 1_000_003 + first + i) & 0x7FFFFFFF for i in range(n)]
        self.actors = [_Actor(i, new_world(assets, s, text_speed="fast"), []) for i, s in enumerate(seeds)]
        self.talks = list(self.actors)
        keys = [actor.world.body.planner.key for actor in self.actors]
        self.state: PlannerState = self.planner.start(n, seed).renewed(key=np.concatenate(keys))
        person = assets.talk.person
        self.habit = habit_of(self.planner, person.habit_units, person.habit_rate)
        self.state = greet(self.state, self.habit, 0.0)
        self.felt, self.shown = np.zeros((n, 6)), np.zeros((n, 6))
        self.felt_target, self.shown_target = np.zeros((n, 6)), np.zeros((n, 6))
        for row, actor in enumerate(self.actors):
            self.felt[row], self.shown[row] = actor.world.felt, actor.world.shown[:6]
        self.burst_s = np.full(n, -1e9)
        self.due_s = np.full(n, np.inf)  # when the present line has been heard out; −inf: one waits to begin
        self.over_tick = np.full(n, NEVER)  # when the player has looked long enough
        self.fresh: list[int] = []  # rows whose beat begins in this tick
        self.cue_row, self.cue_column = np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.intp)
        self.cue_s = np.zeros(0)
        self.lead_most_s = float(library.stroke_offset_s[library.gestures].max(initial=0.0))
        self.layers = self.planner.tables.layers
        self.seen = np.array([layer in SEEN[observer.mode] for layer in self.layers])

    def run(self) -> list[list[Watched]]:
        """Tick until every talk has had its last beat."""
        tick, left = 0, sum(self._next_beat(row, 0) for row in range(len(self.actors)))
        while left:
            time_s = tick * TICK_S
            for row in np.flatnonzero(self.due_s < time_s).tolist():
                self._speak(row, tick)
            self.felt, self.shown = feelings_after(self.felt, self.felt_target, self.shown, self.shown_target)
            since_s = time_s - self.burst_s
            emotion = leaked_emotion(self.assets.talk.person, self.felt, self.shown, since_s)
            signal = PlannerSignal(emotion, self._words(emotion, time_s), time_s, self.habit)
            before = self.state
            self.state, decisions = self.planner.advance(before, signal, TICK_S)
            self._note(before, signal, decisions, tick)
            tick += 1
            self.fresh.clear()
            for row in np.flatnonzero(self.over_tick <= tick).tolist():
                if not self._next_beat(row, tick):
                    left -= 1
            if left < CROWDED * len(self.actors):
                self._close_ranks()
        return [actor.watched for actor in self.talks]

    def _close_ranks(self) -> None:
        """Bodies whose talk is over leave; the others go on as before."""
        live = np.array([row for row, actor in enumerate(self.actors) if not actor.over], dtype=np.intp)
        place = np.full(len(self.actors), -1, dtype=np.intp)
        place[live] = np.arange(len(live))
        self.actors = [self.actors[row] for row in live]
        self.fresh = [int(place[row]) for row in self.fresh]
        for name in ("felt", "shown", "felt_target", "shown_target", "burst_s", "due_s", "over_tick"):
            setattr(self, name, getattr(self, name)[live])
        cued = place[self.cue_row] >= 0
        self.cue_row, self.cue_column = place[self.cue_row[cued]], self.cue_column[cued]
        self.cue_s = self.cue_s[cued]
        self.state = self.state.of(live)

    def _next_beat(self, row: int, tick: int) -> bool:
        """The decision falls: what it led to is said from this tick on. False after the last one."""
        actor = self.actors[row]
        talk = self.beat(actor.number, actor.watched)
        if talk is None:
            actor.over = True
            self.over_tick[row], self.due_s[row] = NEVER, np.inf
            return False
        if not actor.watched:
            actor.world = enter_talk(self.assets, actor.world, talk)
        else:
            actor.world = replace(actor.world, talk=talk, queue=talk.beat.lines)
        actor.watched.append(Watched())
        actor.began = tick
        self.over_tick[row] = tick + MAX_TICKS
        self.fresh.append(row)
        self._read_back(row, tick)
        return True

    def _speak(self, row: int, tick: int) -> None:
        """A line begins or has been heard out: the step's own stage, on this talk's own world."""
        actor = self.actors[row]
        world = replace(
            actor.world, tick=tick, felt=self.felt[row], shown=with_neutral(self.shown[row]),
            burst_s=float(self.burst_s[row]),
        )  # fmt: skip
        actor.world = speech_stage(self.assets, world, Intent(proceed=world.speech is not None))
        self._read_back(row, tick)

    def _read_back(self, row: int, tick: int) -> None:
        """From a talk's world into the arrays."""
        actor, world = self.actors[row], self.actors[row].world
        self.felt_target[row], self.shown_target[row] = world.felt_target, world.shown_target[:6]
        self.burst_s[row] = world.burst_s
        others = self.cue_row != row
        rows, columns, times_s = self.cue_row[others], self.cue_column[others], self.cue_s[others]
        if world.speech is not None:
            self.due_s[row] = world.speech.started_s + world.speech.timed.length_s + PATIENCE_S
            if world.speech.cues is not None:
                cues = world.speech.cues
                rows = np.concatenate([rows, np.full(len(cues.gesture), row)])
                columns, times_s = np.concatenate([columns, cues.gesture]), np.concatenate([times_s, cues.time_s])
        elif world.queue:
            self.due_s[row] = -np.inf
        else:
            self.due_s[row] = np.inf
            self._all_said(row)
            self.over_tick[row] = min(tick + THINKING_TICKS, actor.began + MAX_TICKS)
        self.cue_row, self.cue_column, self.cue_s = rows, columns, times_s

    def _all_said(self, row: int) -> None:
        """The last word is spoken: what is on stage now stays to be seen."""
        library, seen = self.planner.library, self.actors[row].watched[-1]
        for at, unit in enumerate(self.state.decisions.unit[row].tolist()):
            if unit >= 0 and self.seen[at] and not library.is_rest[unit]:
                seen.units[library.units[unit].name] = None
                seen.quiet[library.units[unit].name] = None

    def _words(self, emotion: Floats, time_s: float) -> Floats:
        """(N, G) word factors, as GestureCues.factors gives them row by row."""
        library, config = self.planner.library, self.planner.config
        words = np.zeros((len(self.actors), len(library.gestures)))
        half_s = 0.5 * config.word_window_s
        near = (self.cue_s >= time_s - half_s) & (self.cue_s <= time_s + self.lead_most_s + half_s)
        if np.count_nonzero(near):
            rows, columns = self.cue_row[near], self.cue_column[near]
            units = library.gestures[columns]
            weights = library.mix_weights(emotion[rows], units)
            lead_s = (weights * library.stroke_offset_s[units]).sum(axis=-1)
            open_now = np.abs(time_s - (self.cue_s[near] - lead_s)) <= half_s
            words[rows[open_now], columns[open_now]] = 1.0
        return words

    def _note(self, before: PlannerState, signal: PlannerSignal, decisions: Decisions, tick: int) -> None:
        """Who came on stage, and why."""
        library = self.planner.library
        new = decisions.started & self.seen & ~library.is_rest[decisions.unit]
        rows = np.flatnonzero(new.any(axis=1))
        reasons = dict[int, list[Any]]()
        if self.observer.explain and rows.size:
            reasons = dict(zip(rows.tolist(), self.planner.explain_chosen(before, signal, rows), strict=True))
        for row in {*rows.tolist(), *self.fresh}:
            actor = self.actors[row]
            if actor.over:
                continue  # the talk is over, its body merely goes on
            watched = actor.watched[-1]
            for at in range(len(self.layers)):
                unit = int(decisions.unit[row, at])
                if unit < 0 or library.is_rest[unit] or not self.seen[at] or not (actor.began == tick or new[row, at]):
                    continue
                watched.units[library.units[unit].name] = None
                if self.due_s[row] == np.inf:
                    watched.quiet[library.units[unit].name] = None
                if new[row, at] and row in reasons:
                    chosen = reasons[row][at]
                    watched.starts.append(
                        {
                            "time_s": round(signal.time_s, 3),
                            "layer": chosen.layer,
                            "unit": chosen.name,
                            "factors": factors_of(chosen),
                            "reason": chosen.reason,
                            "source": played_span(library, decisions, row, at),
                        }
                    )
