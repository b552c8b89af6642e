"""Writing a session down while it is played: what was done at which tick, and a fingerprint now and then."""

from __future__ import annotations

import contextlib
import json
import os
import tempfile
from dataclasses import fields
from pathlib import Path
from typing import Any, TextIO

from game.app.afternoon import Afternoon
from game.app.recording.content import content_hashes
from game.app.recording.digests import body_digest, game_digest, talk_digest, talk_in_words
from game.app.recording.files import CHECK_TICKS, MAX_BYTES, Event, Header
from game.app.reload import watched_files
from game.app.saves import game_to_dict
from game.app.session import Session, saved_game
from game.app.talk import Choice, TalkState
from game.app.world import Intent, World
from game.core.errors import BadInput, Where

__all__ = ["LAST_SESSION", "Recorder", "record_session", "said_values"]

LAST_SESSION = "last-session.jsonl"
"""Where the user's folder keeps what was played last."""

SETTINGS = ("language", "text_speed", "mode", "timers")
"""The settings of a world that decide what happens in it."""
KEPT = frozenset(f.name for f in fields(World)) - set(SETTINGS) - {"tick", "seed"}


def record_session(session: Session, path: Path, *, stall: str | None = None) -> Recorder:
    """Record a session from here on. stall: as it was opened. Raises BadInput where that is impossible."""
    if session.designed:
        raise BadInput("recording", expected="a play that no designer has had a hand in", seen="a designed one")
    world = session.world
    own = watched_files(session.assets.talk.script) if stall is not None else ()
    header = Header(
        kind="session",
        seed=world.seed,
        stall=stall,
        language=world.language,
        text_speed=world.text_speed,
        mode=world.mode,
        content=content_hashes(own),
    )
    recorder = Recorder(path, header)
    if session.afternoon != Afternoon(seed=world.seed) or world.talk is not None:
        recorder.write(Event(0, "resume", {"save": game_to_dict(saved_game(session))}))
    recorder.follow(session)
    return recorder


class Recorder:
    """Writes beside ``path`` and puts the file there when it is closed; what cannot be written ends it, not the game.

    A recording that was not closed is left beside under its temporary name (``.NAME….part``), and can be replayed.
    """

    def __init__(self, path: Path, header: Header) -> None:
        self.path = path
        self._world: World | None = None
        self._afternoon: Afternoon | None = None
        self._bytes = 0
        self._scene = ""
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            _keep_crashed(path)
            handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
        except OSError as error:
            raise BadInput(
                "recording", where=Where(path), expected="a folder that can be written", seen=error.strerror
            ) from None
        self.part = Path(name)
        self._file: TextIO | None = os.fdopen(handle, "w", encoding="utf-8", newline="\n")
        self.trouble = ""
        self._put(header.to_dict())

    def follow(self, session: Session) -> None:
        """Stand in the session's journal from now on; the session as it is now is taken as known."""
        session.journal = self
        self._know(session)

    # --- what the session tells --------------------------------------------------------------------------------------
    def before(self, session: Session, intent: Intent) -> Intent:
        """A tick is to be made."""
        self.begin(session)
        if self._file is None:
            return intent
        at, world = session.ticks, session.world
        if intent.choice is not None and world.waiting:
            assert world.talk is not None
            self.write(Event(at, "say", said_values(world.talk, intent.choice, intent.guess)))
        elif intent.proceed and world.speech is not None:
            self.write(Event(at, "go", {}))
        return intent

    def after(self, session: Session) -> None:
        """A tick has been made."""
        self._know(session)
        if session.ticks % CHECK_TICKS == 0:
            self.write(Event(session.ticks, "check", _prints(session)))
            self._flush()

    def begin(self, session: Session) -> None:
        """Something is about to change: first write down what changed since without telling."""
        if self._file is None or self._world is None:
            return
        if session.designed:
            session.say(session.strings("recording_ends"))
            self.close(session, "designed")
            return
        world, before = session.world, self._world
        if world is not before:
            settings = {n: getattr(world, n) for n in SETTINGS if getattr(world, n) != getattr(before, n)}
            if all(getattr(world, name) is getattr(before, name) for name in KEPT):
                if settings:
                    self.write(Event(session.ticks, "set", settings))
            else:
                self._write_state(session)
        elif session.afternoon is not self._afternoon:
            self._write_state(session)
        self._know(session)

    def end(self, session: Session, what: str, values: dict[str, Any]) -> None:
        """Something has been done."""
        self.write(Event(session.ticks, what, values))
        self._know(session)

    def shows(self, session: Session, scene: str) -> None:
        """Another framing is shown."""
        if scene != self._scene:
            self._scene = scene
            self.write(Event(session.ticks, "scene", {"scene": scene}))

    # --- writing -----------------------------------------------------------------------------------------------------
    def _write_state(self, session: Session) -> None:
        self.write(Event(session.ticks, "resume", {"save": game_to_dict(saved_game(session))}))

    def _know(self, session: Session) -> None:
        self._world, self._afternoon = session.world, session.afternoon

    def write(self, event: Event) -> None:
        """One line more."""
        self._put(event.to_dict())

    def _put(self, data: dict[str, Any]) -> None:
        if self._file is None:
            return
        line = json.dumps(data, ensure_ascii=False, separators=(",", ":")) + "\n"
        self._bytes += len(line.encode())
        try:
            if self._bytes > MAX_BYTES:
                raise OSError(0, f"more than {MAX_BYTES} bytes")
            self._file.write(line)
        except OSError as error:
            self._give_up(error)

    def _flush(self) -> None:
        if self._file is not None:
            try:
                self._file.flush()
            except OSError as error:
                self._give_up(error)

    def _give_up(self, error: OSError) -> None:
        """The disk is full, or gone: the game goes on without a recording; what there is of it is kept."""
        file, self._file = self._file, None
        if file is not None:
            with contextlib.suppress(OSError):
                file.close()
        kept = ""
        with contextlib.suppress(OSError):
            if self.part.stat().st_size:
                left = _crashed(self.path)
                os.replace(self.part, left)
                kept = f"; up to there it lies in {left.name}"
            else:
                self.part.unlink()
        self.trouble = f"{self.path}: recording ends ({error.strerror}){kept}"

    def close(self, session: Session | None = None, why: str = "closed") -> None:
        """Finish the file and put it in its place."""
        if self._file is None:
            return
        if session is not None:
            if why == "closed":
                self.begin(session)
            # What a designer has done is not in the recording: there is nothing to compare at its end.
            prints = _prints(session) if why == "closed" else {"game": "", "body": ""}
            self.write(Event(session.ticks, "end", {"why": why, **prints}))
        if self._file is None:
            return
        try:
            self._file.close()
            os.replace(self.part, self.path)
            self._file = None
        except OSError as error:
            self._give_up(error)


def said_values(talk: TalkState, choice: Choice, guess: str = "") -> dict[str, Any]:
    """What a recording keeps of a move: the choice, and the talk as it stood."""
    said = {"choice": choice.id, "offer": choice.offer, "guess": guess}
    return {**said, "node": talk.beat.node, "talk": talk_digest(talk), "was": talk_in_words(talk)}


def _prints(session: Session) -> dict[str, str]:
    return {"game": game_digest(session.world, session.afternoon), "body": body_digest(session.world)}


def _keep_crashed(path: Path) -> None:
    """What a play left that did not end well lies under a name one finds, instead of piling up unseen."""
    left = sorted(path.parent.glob(f".{path.name}.*.part"), key=lambda part: part.stat().st_mtime)
    for part in left:
        os.replace(part, _crashed(path))


def _crashed(path: Path) -> Path:
    return path.with_name(f"{path.stem}-crashed{path.suffix}")
