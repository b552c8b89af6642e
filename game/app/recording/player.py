"""Doing a recording again: the same moves at the same ticks, and whether the world is the same after them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from game.app.recording.digests import body_digest, game_digest, talk_digest, talk_in_words
from game.app.recording.files import Event, Recording
from game.app.save_reader import SaveReader
from game.app.saves import read_game
from game.app.session import Session, take_back
from game.app.talk import Choice, TalkState
from game.app.world import TICK_S, Intent
from game.core.errors import BadInput

__all__ = ["Divergence", "Player", "not_as_recorded"]


@dataclass(frozen=True)
class Divergence:
    """The first place where a replay is not what was recorded. decision: number of the player's move, from 1."""

    tick: int
    line: int
    decision: int
    what: str
    expected: str
    seen: str

    def __str__(self) -> str:
        place = f"decision {self.decision}" if self.decision else "before the first decision"
        time = f" at {self.tick * TICK_S:.1f} s" if self.tick else ""
        return f"{place}{time} (line {self.line}): {self.what}: expected {self.expected}, saw {self.seen}"


def not_as_recorded(talk: TalkState | None, values: Mapping[str, Any]) -> tuple[str, str, str] | None:
    """What is different where a recorded choice is to be said: what, expected and seen; None where nothing is."""
    if talk is None:
        return "talk", f"at {values['node']}", "nobody to talk to"
    here = talk.beat.node
    known = {option.id: option.available for option in talk.beat.choices}
    if not known.get(values["choice"]):
        free = " | ".join(name for name, available in known.items() if available)
        closed = f"{values['choice']!r} that may not be said now" if values["choice"] in known else free
        return f"choice at {here}", repr(values["choice"]), closed or f"a talk that has ended: {talk.beat.ended}"
    if here != values["node"]:
        return "node", values["node"], here
    if talk_digest(talk) != values["talk"]:
        return f"talk at {here}", values["was"], talk_in_words(talk)
    return None


@dataclass
class Player:
    """The journal of a session that repeats a recording. ``Session.tick`` steps through it.

    on_book: what is done where a talk was booked (a window shows it). After ``divergence`` or the last event nothing
    more is done. body: whether poses are compared too. A world that differs between two moves is ``suspect`` until the
    next move, which can say better what is different.
    """

    recording: Recording
    divergence: Divergence | None = None
    checks: int = 0
    decisions: int = 0
    scene: str = "table"
    body: bool = True
    on_book: Callable[[Session], None] = field(default=lambda session: session.end_talk())
    suspect: Divergence | None = None
    _at: int = 0
    _settings: dict[str, Any] = field(default_factory=dict)

    def start(self, session: Session) -> None:
        """Stand in a fresh session's journal and do what was done before the first tick."""
        header = self.recording.header
        self._settings = {"language": header.language, "text_speed": header.text_speed, "mode": header.mode}
        session.journal = self
        self._due(session)

    @property
    def done(self) -> bool:
        """Whether there is nothing more to do."""
        return self.divergence is not None or self._at >= len(self.recording.events)

    # --- the journal -------------------------------------------------------------------------------------------------
    def before(self, session: Session, intent: Intent) -> Intent:
        """The intent that was recorded for this tick, whatever the window asks for; its settings as they were."""
        if any(getattr(session.world, name) != value for name, value in self._settings.items()):
            session.world = replace(session.world, **self._settings)
        said, proceed = None, False
        while not self.done:
            event = self.recording.events[self._at]
            if event.tick > session.ticks or event.do not in {"say", "go"}:
                break
            self._at += 1
            if event.do == "go":
                proceed = True
            elif self._can_say(session, event):
                said = event
        if said is None:
            return Intent(proceed=proceed)
        choice = Choice(said.values["choice"], said.values["offer"])
        return Intent(choice=choice, proceed=proceed, guess=said.values["guess"])

    def after(self, session: Session) -> None:
        """What was done between this tick and the next."""
        self._due(session)

    def begin(self, session: Session) -> None:
        """Nothing: the player itself changes the session."""

    def end(self, session: Session, what: str, values: dict[str, Any]) -> None:
        """Nothing."""

    def shows(self, session: Session, scene: str) -> None:
        """Nothing: what is shown follows the recording."""

    # --- doing it again ----------------------------------------------------------------------------------------------
    def _due(self, session: Session) -> None:
        while not self.done:
            event = self.recording.events[self._at]
            if event.tick > session.ticks or event.do in {"say", "go"}:
                return
            self._at += 1
            if self.suspect is not None and event.do not in {"check", "end", "scene"}:
                self.divergence = self.suspect
                return
            try:
                self._do(session, event)
            except (BadInput, KeyError) as error:
                self._diverge(event, event.do, "what was done then", str(error))

    def _do(self, session: Session, event: Event) -> None:
        values = event.values
        match event.do:
            case "set":
                self._settings.update(values)
                session.world = replace(session.world, **values)
            case "talk":
                session.begin_talk(values["item"])
            case "walk":
                if values["stall"] not in session.market.stalls:
                    raise BadInput("stall", expected=" | ".join(session.market.stalls), seen=values["stall"])
                session.walk_to(values["stall"])
            case "pause":
                session.pause()
            case "day":
                session.open_day(again=values["again"])
            case "book":
                if not session.world.over:
                    raise BadInput("talk", expected="one that has ended", seen="none")
                self.on_book(session)
            case "back":
                if not take_back(session):
                    raise BadInput("move", expected="one that can be taken back", seen="none")
            case "resume":
                root = SaveReader(self.recording.path, values["save"])
                game = read_game(root, session.market.bazaar, session.market.talks())
                session.take_up(game, values["save"])
            case "scene":
                self.scene = values["scene"]
            case "check" | "end":
                self._compare(session, event)

    def _can_say(self, session: Session, event: Event) -> bool:
        self.decisions += 1
        world, values = session.world, event.values
        if not world.waiting or world.talk is None:
            seen = "no talk" if world.talk is None else f"a line being spoken at {world.talk.beat.node}"
            self._diverge(event, f"{values['choice']!r} is said", f"the choices of {values['node']}", seen)
            return False
        wrong = not_as_recorded(world.talk, values)
        if wrong is not None:
            self._diverge(event, *wrong)
        elif self.suspect is not None:
            self.divergence = self.suspect
        return self.divergence is None

    def _compare(self, session: Session, event: Event) -> None:
        if not event.values["game"]:
            return  # a designer's hand ended the recording: what they did is not in it
        game, body = game_digest(session.world, session.afternoon), body_digest(session.world)
        self.checks += 1
        if self.suspect is None:
            here = (event.tick, event.line, self.decisions)
            if game != event.values["game"]:
                self.suspect = Divergence(*here, "world", event.values["game"], game)
            elif self.body and body and event.values["body"] and body != event.values["body"]:
                what = "pose or face (the game is the same)"
                self.suspect = Divergence(*here, what, event.values["body"], body)
        if self._at == len(self.recording.events):
            self.divergence = self.suspect

    def _diverge(self, event: Event, what: str, expected: str, seen: str) -> None:
        if self.divergence is None:
            self.divergence = Divergence(event.tick, event.line, self.decisions, what, expected, seen)
