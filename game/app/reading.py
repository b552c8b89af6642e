"""Reading on by itself: auto-forward after each line, skipping of what has been read, and what has been read at all."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from game.app.world import World
from game.core.errors import BadInput
from game.formats.files import read_bytes, write_text

__all__ = ["AUTO_S", "ReadLines", "Reader", "load_read", "save_read"]

AUTO_S: dict[str, float] = {"off": 0.0, "slow": 3.2, "normal": 1.7, "fast": 0.8}
"""Seconds a line stands after it has been spoken before the next begins by itself; 0: never."""
MAX_LINES = 50_000
_MAX_BYTES = 8_000_000


@dataclass
class ReadLines:
    """Ids of lines that have been read to their end, per stall, over all afternoons."""

    stalls: dict[str, set[str]] = field(default_factory=dict)
    changed: bool = False

    def has(self, stall: str, line: str) -> bool:
        """Whether a line was read before."""
        return line in self.stalls.get(stall, ())

    def add(self, stall: str, line: str) -> None:
        """A line has been read to its end."""
        known = self.stalls.setdefault(stall, set())
        if line not in known and len(known) < MAX_LINES:
            known.add(line)
            self.changed = True


@dataclass
class Reader:
    """Whether to go on without being asked. skipping: until the player must choose, or a line is new."""

    skipping: bool = False
    line: str = ""

    def goes_on(self, world: World, stall: str, read: ReadLines, *, auto: str, everything: bool) -> bool:
        """One tick: True to proceed. Notes every line that has been spoken."""
        speech = world.speech
        if speech is None:
            if world.waiting or world.over:
                self.skipping = False
            return False
        known = read.has(stall, speech.line.id) and self.line != speech.line.id
        if self.line != speech.line.id and not known:
            self.line = speech.line.id
            if not everything:
                self.skipping = False
        spoken_s = world.time_s - speech.started_s - speech.timed.length_s
        if spoken_s >= 0.0 or speech.hurried:
            read.add(stall, speech.line.id)
        if self.skipping:
            return True
        wait_s = AUTO_S[auto]
        return wait_s > 0.0 and spoken_s >= wait_s


def load_read(folder: Path) -> ReadLines:
    """What has been read; nothing where the file is missing or broken (no loss: a line is only new once more)."""
    try:
        data = json.loads(read_bytes(folder / "read.json", max_bytes=_MAX_BYTES, what="list of lines"))
    except (BadInput, ValueError, RecursionError):
        return ReadLines()
    if not isinstance(data, Mapping):
        return ReadLines()
    good = {
        str(stall): {line for line in lines[:MAX_LINES] if isinstance(line, str)}
        for stall, lines in list(data.items())[:100]
        if isinstance(lines, list)
    }
    return ReadLines(good)


def save_read(read: ReadLines, folder: Path) -> None:
    """Write what has been read, whole or not at all; silently nothing where the folder cannot be written."""
    if not read.changed:
        return
    read.changed = False
    try:
        text = json.dumps({stall: sorted(lines) for stall, lines in sorted(read.stalls.items())})
        write_text(folder / "read.json", text, make_folder=True)
    except BadInput:
        return
