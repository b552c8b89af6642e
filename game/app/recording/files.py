"""A recording's file: JSON Lines, first what was played and with which content, then what was done at which tick.

Every line is one object. The first has ``recording`` with the version; the others have ``do``, and ``t``, the ticks
done when it happened. A recording that was cut off is read up to its last whole line. Nothing in it is ever run, and
nothing is believed: every value has a type, a range and a place that a refusal names.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from game.app.save_reader import SaveReader
from game.app.settings import TIMERS
from game.app.world import TEXT_SPEED
from game.core.errors import BadInput, Where
from game.formats.files import read_bytes

__all__ = ["CHECK_TICKS", "MAX_BYTES", "VERSION", "Event", "Header", "Recording", "read_recording"]

VERSION = 1
CHECK_TICKS = 300
"""A fingerprint of the world is kept this often: every ten seconds."""
MAX_BYTES = 64 * 1024 * 1024
MAX_LINE = 1_000_000
MAX_TICKS = 30 * 3600 * 48
MODES = ("full", "gestures", "body", "face")

FIELDS: dict[str, dict[str, str]] = {
    "say": {"choice": "text", "offer": "money?", "guess": "text", "node": "text", "talk": "hash", "was": "text"},
    "go": {},
    "set": {},
    "talk": {"item": "text"},
    "walk": {"stall": "text"},
    "pause": {},
    "day": {"again": "flag"},
    "book": {},
    "back": {},
    "resume": {"save": "json"},
    "scene": {"scene": "text"},
    "check": {"game": "hash", "body": "hash"},
    "end": {"why": "text", "game": "hash", "body": "hash"},
}
"""What can be done, with what belongs to it. ``set`` has some of the settings that matter; ``back`` unsays a choice."""


@dataclass(frozen=True)
class Header:
    """What was played. stall: the only one, None for the whole market; content: file -> hash.

    item, purse, policy: of a talk played by a policy, which has no ticks (``kind`` talk); a session has them all.
    """

    kind: str
    seed: int
    stall: str | None = None
    language: str = "en"
    text_speed: str = "normal"
    mode: str = "full"
    content: Mapping[str, str] = field(default_factory=dict)
    item: str = ""
    purse: int = 0
    policy: str = ""

    def to_dict(self) -> dict[str, Any]:
        """The file's first line."""
        rest = {name: getattr(self, name) for name in ("kind", "seed", "stall", "language", "text_speed", "mode")}
        talk = {"item": self.item, "purse": self.purse, "policy": self.policy} if self.kind == "talk" else {}
        return {"recording": VERSION, **rest, **talk, "content": dict(self.content)}


@dataclass(frozen=True)
class Event:
    """Something done after ``tick`` ticks. line: of the file, for messages."""

    tick: int
    do: str
    values: Mapping[str, Any]
    line: int = 0

    def to_dict(self) -> dict[str, Any]:
        """Its line of the file."""
        return {"t": self.tick, "do": self.do, **self.values}


@dataclass(frozen=True)
class Recording:
    """A whole recording. whole: whether its end is there, or it was cut off."""

    path: Path
    header: Header
    events: tuple[Event, ...]
    whole: bool

    @property
    def ticks(self) -> int:
        """How many ticks it lasts."""
        return self.events[-1].tick if self.events else 0


def read_recording(path: Path) -> Recording:
    """Read a recording. Raises BadInput with file and line where it is none or something in it is wrong."""
    lines = read_bytes(path, max_bytes=MAX_BYTES, what="recording").split(b"\n")
    cut = lines.pop()  # what follows the last line break was never finished
    if not lines:
        raise BadInput(where=Where(path, 1), expected="a recording", seen="an empty file" if not cut else "no line")
    header = _header(_line(path, 1, lines[0]))
    events: list[Event] = []
    for number, line in enumerate(lines[1:], start=2):
        event = _event(_line(path, number, line), number)
        if events and (event.tick < events[-1].tick or events[-1].do == "end"):
            wanted = f"t from {events[-1].tick} on" if events[-1].do != "end" else "nothing after the end"
            raise BadInput(where=Where(path, number), expected=wanted, seen=f"{event.do} at {event.tick}")
        events.append(event)
    return Recording(path, header, tuple(events), bool(events) and events[-1].do == "end")


class _Line(SaveReader):
    """A line of the file; its refusals name the line."""

    def fail(self, expected: str, seen: object) -> BadInput:
        path, _, number = self.pointer.partition("\n")
        return BadInput(f"{path}", where=Where(self.path, int(number or 1)), expected=expected, seen=seen)

    def at(self, key: str) -> _Line:
        if not isinstance(self.data, dict) or key not in self.data:
            raise self.fail(f"the key {key}", "none")
        number = self.pointer.partition("\n")[2]
        return _Line(self.path, self.data[key], f"{key}\n{number}")


def _line(path: Path, number: int, line: bytes) -> _Line:
    where = Where(path, number)
    if len(line) > MAX_LINE:
        raise BadInput(where=where, expected=f"a line of at most {MAX_LINE} bytes", seen=len(line))
    try:
        data = json.loads(line.decode("utf-8"))
    except (ValueError, RecursionError) as error:
        raise BadInput(where=where, expected="a JSON object", seen=str(error).split(":")[0]) from None
    if not isinstance(data, dict):
        raise BadInput(where=where, expected="a JSON object", seen=type(data).__name__)
    return _Line(path, data, f"\n{number}")


def _one_of(value: _Line, known: tuple[str, ...]) -> str:
    if value.text() not in known:
        raise value.fail(" | ".join(known), value.data)
    return str(value.data)


def _header(line: _Line) -> Header:
    if "recording" not in line.data:
        raise line.fail("a recording of the game", "something else")
    version = line.at("recording").whole()
    if version != VERSION:
        raise line.at("recording").fail(f"version {VERSION}", version)
    kind = _one_of(line.at("kind"), ("session", "talk"))
    content = line.at("content")
    stall = line.at("stall")
    talk = kind == "talk"
    return Header(
        kind=kind,
        seed=line.at("seed").whole(),
        stall=None if stall.data is None and not talk else stall.text(1000),
        language=_one_of(line.at("language"), ("en", "ja")),
        text_speed=_one_of(line.at("text_speed"), tuple(TEXT_SPEED)),
        mode=_one_of(line.at("mode"), MODES),
        content={name: content.at(name).text(16) for name in content.names(1000)},
        item=line.at("item").text() if talk else "",
        purse=line.at("purse").whole(0, 10**9) if talk else 0,
        policy=line.at("policy").text(1000) if talk else "",
    )


def _event(line: _Line, number: int) -> Event:
    do = _one_of(line.at("do"), tuple(FIELDS))
    tick = line.at("t").whole(0, MAX_TICKS)
    values: dict[str, Any] = {}
    for name, kind in FIELDS[do].items():
        value = line.at(name)
        if kind == "flag":
            values[name] = value.flag()
        elif kind == "money?":
            values[name] = None if value.data is None else value.whole(0, 10**9)
        elif kind == "json":
            values[name] = value.data
        else:
            values[name] = value.text(16 if kind == "hash" else 200)
    if do == "set":
        values = _settings(line)
    return Event(tick, do, values, number)


def _settings(line: _Line) -> dict[str, Any]:
    known = {"language": ("en", "ja"), "text_speed": tuple(TEXT_SPEED), "mode": MODES}
    values: dict[str, Any] = {name: _one_of(line.at(name), those) for name, those in known.items() if name in line.data}
    if "timers" in line.data:
        values["timers"] = line.at("timers").number(0.0, 10.0)
        if values["timers"] not in TIMERS.values():
            raise line.at("timers").fail(" | ".join(f"{value:g}" for value in TIMERS.values()), values["timers"])
    return values
