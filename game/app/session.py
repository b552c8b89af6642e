"""The running game as its screens see it, and what a screen is."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from game.app.afternoon import (
    Afternoon,
    Reading,
    finish_talk,
    lesson_of,
    next_day,
    open_day,
    pass_time,
    talk_minutes,
    visit_stall,
    walk_to,
)
from game.app.input import COMMANDS, Action, command_of
from game.app.journal import Journal
from game.app.market import Market, StallLoader
from game.app.notices import Notices
from game.app.reading import ReadLines
from game.app.saves import SavedGame
from game.app.settings import Settings, save_settings
from game.app.step import StepAssets, new_world, step
from game.app.strings import Strings
from game.app.talk import TalkState
from game.app.tells import TellWatch
from game.app.ui import Canvas
from game.app.world import Intent, Mark, World, enter_talk, leave_talk
from game.face import FaceParams

__all__ = ["MenuScreen", "Screen", "Session", "change_setting", "keep_keys", "saved_game", "take_back"]


@dataclass
class Session:
    """The running game as the screens see it. ``world`` is replaced by every tick; screens never change it.

    assets: those of the stall one stands at; during a talk, bent by its lesson. loader: reads the other stalls;
    taken_up: whether the game saved last has been looked for. designed: a designer has had a hand in it (a script
    reloaded, a feeling turned, a jump): nothing is saved, booked or scored any more. pointed: the item on the table
    under the pointer. watch: sees what the body tells in the talk under way. notices: what the game has told in
    passing. read: lines that have been read before. journal: who follows what is done; ticks: done since the session
    began, at whatever stall.
    """

    assets: StepAssets
    world: World
    strings: Strings
    settings: Settings
    afternoon: Afternoon
    market: Market
    overlays: set[str] = field(default_factory=set)
    running: bool = True
    loader: StallLoader | None = None
    taken_up: bool = False
    pointed: str | None = None
    designed: bool = False
    read: ReadLines = field(default_factory=ReadLines)
    watch: TellWatch = field(default_factory=TellWatch)
    notices: Notices = field(default_factory=Notices)
    journal: Journal | None = None
    ticks: int = 0
    _told: int = 0

    @property
    def stall(self) -> str:
        """The stall one stands at."""
        return self.assets.talk.script.stall

    @property
    def message(self) -> str:
        """What the game tells in passing, as long as it stands."""
        return self.notices.now(self.ticks)

    def say(self, text: str) -> None:
        """Tell something in passing; nothing: take away what stands."""
        self.notices.say(text, self.ticks)

    @property
    def minutes(self) -> float:
        """Minutes of the afternoon gone by, those of the talk under way among them."""
        talk = self.world.talk
        if talk is None:
            return self.afternoon.minutes
        return self.afternoon.minutes + talk_minutes(self.market.bazaar, [m.act for m in self.world.marks[1:]])

    @property
    def day_share(self) -> float:
        """0 when the market opens, 1 when it closes."""
        return self.market.bazaar.day_share(self.minutes)

    def money(self, amount: float) -> str:
        """An amount as the stall's currency writes it in the present language."""
        return self.assets.talk.script.currency.text(amount).get(self.strings.language)

    def tick(self, intent: Intent) -> None:
        """One fixed step of the world."""
        if self.journal is not None:
            intent = self.journal.before(self, intent)
        self.world = step(self.assets, self.world, intent)
        self.ticks += 1
        if self.journal is not None:
            self.journal.after(self)

    @contextmanager
    def told(self, what: str, **values: Any) -> Iterator[None]:
        """Tell the journal of a change that is not a tick; every such change is made inside."""
        if self.journal is not None and self._told == 0:
            self.journal.begin(self)
        self._told += 1
        try:
            yield
        finally:
            self._told -= 1
        if self.journal is not None and self._told == 0:
            self.journal.end(self, what, values)

    def walk_to(self, stall: str) -> None:
        """Walk along the street to a stall, and stand at its table."""
        with self.told("walk", stall=stall):
            self.afternoon = walk_to(self.market.bazaar, self.afternoon, stall)
            self.go_to(stall)

    def pause(self) -> None:
        """Sit down for a while."""
        with self.told("pause"):
            bazaar = self.market.bazaar
            self.afternoon = pass_time(bazaar, self.afternoon, bazaar.costs.pause)

    def take_up(self, game: SavedGame, data: Any) -> None:
        """Go on with a saved game. data: its JSON, what it was read from."""
        with self.told("resume", save=data):
            self.afternoon = game.afternoon
            if game.stall in self.market.stalls:
                self.go_to(game.stall)
            if game.talk is not None:
                self.resume_talk(game.talk, game.marks)

    def go_to(self, stall: str) -> None:
        """Stand at a stall's table: its person, calm, and its goods."""
        if stall != self.stall:
            world, number = self.world, 1 + self.market.order.index(stall)
            fresh = new_world(
                self.market.stalls[stall].assets,
                world.seed + 7919 * number,
                language=world.language,
                text_speed=world.text_speed,
            )
            self.world = replace(fresh, mode=world.mode)
        self.world = leave_talk(self.world)
        self.assets = self.market.stalls[stall].assets

    def begin_talk(self, item: str) -> None:
        """Ask about a thing on this table."""
        with self.told("talk", item=item):
            self.bend()
            talk = visit_stall(self.assets.talk, self.afternoon, item)
            self.world, self.watch = enter_talk(self.assets, self.world, talk), TellWatch()
            if lesson_of(self.market.bazaar, self.afternoon).greeting_habit:
                self.world = replace(self.world, habit=self.assets.talk.person.habit_label)

    def resume_talk(self, talk: TalkState, marks: tuple[Mark, ...]) -> None:
        """Go on with a talk as it stood, its curve with it."""
        self.bend()
        self.world, self.watch = replace(enter_talk(self.assets, self.world, talk), marks=marks), TellWatch()

    def open_day(self, *, again: bool = False) -> None:
        """A new afternoon: the next day of this one, or a first one."""
        if self.loader is not None:
            self.loader.wait_for_scripts()
        with self.told("day", again=again):
            self._open_day(again)

    def _open_day(self, again: bool) -> None:
        bazaar, scripts, before = self.market.bazaar, self.market.scripts, self.afternoon
        first = self.market.order[0]
        if again:
            self.afternoon = next_day(bazaar, scripts, before)
        else:
            self.afternoon = open_day(bazaar, scripts, before.seed)
        self.afternoon = replace(self.afternoon, place=first)
        self.go_to(first)

    def bend(self) -> None:
        """The person as the next talk's lesson wants them."""
        plain = self.market.stalls[self.stall].assets
        self.assets = replace(plain, talk=lesson_of(self.market.bazaar, self.afternoon).bend(plain.talk))

    def end_talk(self) -> None:
        """Book the talk that has ended and step back from the table."""
        with self.told("book"):
            self._end_talk()

    def booked(self) -> Afternoon:
        """The afternoon with the talk that has ended; as it stands where none has, or a designer had a hand in it."""
        talk, marks = self.world.talk, self.world.marks
        if talk is None or not talk.ended or self.designed:
            return self.afternoon
        readings = [Reading(self.stall, m.guess, m.label, m.face) for m in marks if m.guess]
        minutes = talk_minutes(self.market.bazaar, [m.act for m in marks[1:]])
        return finish_talk(self.market.bazaar, self.assets.talk, self.afternoon, talk, minutes, readings)

    def _end_talk(self) -> None:
        self.afternoon = self.booked()
        self.assets = self.market.stalls[self.stall].assets
        self.world = leave_talk(self.world)


def change_setting(session: Session, name: str) -> None:
    """Move a setting to its next value, apply what is ours to apply, and keep it."""
    settings: Settings = session.settings.next(name)
    session.settings = settings
    if name == "language":
        session.strings = session.strings.switched(settings.language)
        session.world = replace(session.world, language=settings.language)
    _keep_settings(session)


def _keep_settings(session: Session) -> None:
    failed = save_settings(session.settings)
    session.say(session.strings("settings_failed", reason=failed) if failed else "")


def keep_keys(session: Session, command: str, key: str) -> None:
    """Give a command another key, and whoever had that key the command's old one; no command: all as usual."""
    keys = dict(session.settings.keys)
    if not command:
        keys = {}
    else:
        old, other = keys.get(command, command), command_of(key, keys)
        keys[command] = key
        if other in COMMANDS and other != command:
            keys[other] = old
    session.settings = replace(session.settings, keys={c: k for c, k in keys.items() if c != k})
    _keep_settings(session)


def take_back(session: Session) -> bool:
    """Unsay the last choice: back to where it was made, as often as there are choices. The score remembers.

    False where nothing can be taken back.
    """
    world = session.world
    before = world.marks[-1].before if world.marks else None
    if before is None or world.talk is None:
        return False
    gone = {line.id for line in world.talk.beat.lines}
    backlog = world.backlog
    while backlog and backlog[-1].id in gone:
        backlog = backlog[:-1]
    kept = world.marks[:-1]
    with session.told("back"):
        entered = enter_talk(session.assets, world, before)
        session.world = replace(entered, queue=(), backlog=backlog, marks=kept, waited=0)
        session.watch.tells = [tell for tell in session.watch.tells if tell.round < len(kept)]
        session.afternoon = replace(session.afternoon, taken_back=session.afternoon.taken_back + 1)
    return True


def saved_game(session: Session) -> SavedGame:
    """What a save holds of the running game; a talk that has ended is booked, not saved: whoever leaves while the last
    words stand has had it all the same."""
    world = session.world
    if world.talk is None or world.talk.ended:
        return SavedGame(session.booked(), session.stall)
    return SavedGame(session.afternoon, session.stall, world.talk, world.marks)


class Screen(Protocol):
    """One screen of the game. ``handle`` may return another screen to go to; ``intent`` is what the next tick does.

    scene: which framing it wants, one of the director's scenes; played: a body and a face to draw instead of the
    present ones.
    """

    scene: str

    def handle(self, session: Session, action: Action) -> Screen | None: ...

    def intent(self) -> Intent: ...

    def after_tick(self, session: Session) -> Screen | None: ...

    def draw(self, session: Session, canvas: Canvas) -> None: ...

    def played(self) -> tuple[NDArray[np.float32], FaceParams] | None: ...


class MenuScreen:
    """What screens without a talk have in common: they ask nothing of the tick and wait for the player."""

    scene = "title"

    def intent(self) -> Intent:
        return Intent()

    def after_tick(self, session: Session) -> Screen | None:
        return None

    def played(self) -> tuple[NDArray[np.float32], FaceParams] | None:
        return None
