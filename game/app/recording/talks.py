"""Talks played by policies: recorded move by move, and played again with words, body and pauses, or without."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from game.app.recording.digests import talk_digest
from game.app.recording.files import Event, Header, Recording
from game.app.recording.player import Divergence, not_as_recorded
from game.app.recording.recorder import said_values
from game.app.session import Session
from game.app.step import AFTER_LINE_S
from game.app.talk import Choice, TalkAssets, TalkState, choose, start_talk
from game.app.world import TICK_S, Intent, enter_talk
from game.core.errors import BadInput
from game.formats.files import write_text

__all__ = ["TalkPlayer", "play_talk", "write_talk"]

THINK_S = 1.2
"""How long the player looks before each move, where a talk without a clock is shown."""

Move = tuple[TalkState, Choice]


def write_talk(
    path: Path, stall: str, policy: str, moves: Sequence[Move], last: TalkState, content: Mapping[str, str]
) -> None:
    """Record a talk: every state with the move made in it, and how it ended. Whole or not at all; raises BadInput."""
    first = moves[0][0] if moves else last
    header = Header("talk", first.seed, stall, content=content, item=first.item, purse=first.purse, policy=policy)
    events = [Event(at, "say", said_values(state, move)) for at, (state, move) in enumerate(moves)]
    events.append(Event(len(moves), "end", {"why": str(last.beat.ended or ""), "game": talk_digest(last), "body": ""}))
    rows = [header.to_dict(), *(event.to_dict() for event in events)]
    text = "".join(json.dumps(row, ensure_ascii=False, separators=(",", ":")) + "\n" for row in rows)
    write_text(path, text, make_folder=True)


def play_talk(assets: TalkAssets, recording: Recording) -> tuple[TalkState | None, Divergence | None, int]:
    """A recorded talk again, moves alone: how it stands at the end, where it first differs, and how many moves."""
    header, moves = recording.header, 0
    try:
        talk = start_talk(assets, header.item, header.seed, purse=header.purse)
    except BadInput as error:
        return None, Divergence(0, 1, 0, "talk", header.item, str(error)), 0
    for event in recording.events:
        if event.do == "say":
            wrong = not_as_recorded(talk, event.values)
            if wrong is not None:
                return talk, Divergence(0, event.line, moves + 1, *wrong), moves
            moves += 1
            try:
                talk = choose(assets, talk, Choice(event.values["choice"], event.values["offer"]))
            except BadInput as error:
                return talk, Divergence(0, event.line, moves, "move", event.values["choice"], str(error)), moves
        elif event.do == "end" and talk_digest(talk) != event.values["game"]:
            seen = f"state {talk_digest(talk)}"
            return talk, Divergence(0, event.line, moves, "end", f"state {event.values['game']}", seen), moves
    return talk, None, moves


@dataclass
class TalkPlayer:
    """The journal of a session that plays a recorded talk with everything there is to see: it waits until a line has
    been spoken, looks for a moment, and makes the next recorded move."""

    recording: Recording
    divergence: Divergence | None = None
    decisions: int = 0
    checks: int = 0
    scene: str = "talk"
    _at: int = 0
    _waited: int = 0
    _over: bool = False

    def start(self, session: Session) -> None:
        """Step up to the table."""
        header = self.recording.header
        talk = start_talk(session.assets.talk, header.item, header.seed, purse=header.purse)
        session.world = enter_talk(session.assets, session.world, talk)
        session.journal = self

    @property
    def done(self) -> bool:
        """Whether the talk has been played, or went another way."""
        return self.divergence is not None or self._over

    def before(self, session: Session, intent: Intent) -> Intent:
        """What the player does in this tick."""
        world = session.world
        if self.done or world.talk is None:
            return Intent()
        if world.speech is not None:
            spoken_s = world.time_s - world.speech.started_s
            return Intent(proceed=spoken_s >= world.speech.timed.length_s + AFTER_LINE_S + 0.3)
        if world.queue:
            return Intent()
        self._waited += 1
        event = self.recording.events[self._at] if self._at < len(self.recording.events) else None
        if event is None or event.do != "say":
            if event is not None and event.do == "end":
                self.checks += 1
                if talk_digest(world.talk) != event.values["game"]:
                    seen = f"state {talk_digest(world.talk)}"
                    self._diverge(event, ("end", f"state {event.values['game']}", seen))
            self._over = True
            return Intent()
        if self._waited * TICK_S < THINK_S:
            return Intent()
        self._at, self._waited = self._at + 1, 0
        self.decisions += 1
        wrong = not_as_recorded(world.talk, event.values)
        if wrong is not None:
            self._diverge(event, wrong)
            return Intent()
        return Intent(choice=Choice(event.values["choice"], event.values["offer"]))

    def _diverge(self, event: Event, wrong: tuple[str, str, str]) -> None:
        self.divergence = Divergence(0, event.line, self.decisions, *wrong)

    def after(self, session: Session) -> None:
        """Nothing."""

    def begin(self, session: Session) -> None:
        """Nothing."""

    def end(self, session: Session, what: str, values: dict[str, Any]) -> None:
        """Nothing."""

    def shows(self, session: Session, scene: str) -> None:
        """Nothing."""
