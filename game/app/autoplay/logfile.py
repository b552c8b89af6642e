"""A log that streams to disk, grows in the order of the episodes, and can be gone on with after a stop."""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

from game.core.errors import BadInput

__all__ = ["LogFile"]

STATE_VERSION = 1


class LogFile:
    """Writes to ``OUT.part``, with ``OUT.part.json`` beside it telling how far it is good; whole, it becomes OUT.

    key: what the run is of (seed, policies, contents); a part of another run is not gone on with.
    """

    def __init__(self, path: Path, key: dict[str, Any]) -> None:
        self.path, self.key = path, key
        self.part = path.with_name(path.name + ".part")
        self.state = path.with_name(path.name + ".part.json")
        self._file: BinaryIO | None = None

    def begin(self, resume: bool) -> dict[str, Any] | None:
        """Open the log. -> what ``keep`` kept last, where a stopped run is gone on with."""
        folder = self.path.resolve().parent
        if not folder.is_dir():
            raise BadInput("--out", expected="a folder that exists", seen=str(self.path.parent))
        kept = self._kept() if resume else None
        try:
            self._file = self.part.open("r+b" if kept else "wb")
            if kept:
                self._file.truncate(kept["bytes"])
                self._file.seek(kept["bytes"])
        except OSError as error:
            raise BadInput(
                "--out", expected="a file that can be written", seen=f"{self.path}: {error.strerror}"
            ) from None
        return kept["run"] if kept else None

    def _kept(self) -> dict[str, Any]:
        try:
            kept = json.loads(self.state.read_text(encoding="utf-8"))
            good = kept["version"] == STATE_VERSION and 0 <= kept["bytes"] <= self.part.stat().st_size
        except (OSError, ValueError, KeyError, TypeError):
            raise BadInput("--resume", expected=f"a stopped run beside {self.path}", seen="none") from None
        if not good or kept["key"] != self.key:
            differ = sorted(name for name in self.key if kept.get("key", {}).get(name) != self.key[name])
            raise BadInput("--resume", expected="the same run", seen=f"another {', '.join(differ) or 'length'}")
        return dict(kept)

    def write(self, rows: bytes) -> None:
        """The rows of the next job."""
        assert self._file is not None
        with self._told():
            self._file.write(rows)

    def keep(self, run: dict[str, Any]) -> None:
        """Remember how far the run is."""
        assert self._file is not None
        fresh = self.state.with_name(self.state.name + ".new")
        with self._told():
            self._file.flush()
            text = json.dumps({"version": STATE_VERSION, "key": self.key, "bytes": self._file.tell(), "run": run})
            try:
                fresh.write_text(text, encoding="utf-8")
                os.replace(fresh, self.state)
            except OSError:
                fresh.unlink(missing_ok=True)
                raise

    def end(self) -> None:
        """All is written: the part becomes the log."""
        assert self._file is not None
        with self._told():
            self._file.flush()
            self.stop()
            os.replace(self.part, self.path)
            self.state.unlink(missing_ok=True)

    def stop(self) -> None:
        """Close; what was kept stays for ``--resume``, which cuts off what was written after it."""
        if self._file is not None:
            with contextlib.suppress(OSError):
                self._file.close()
            self._file = None

    @contextlib.contextmanager
    def _told(self) -> Iterator[None]:
        """A full or lost disk is told in one line."""
        try:
            yield
        except OSError as error:
            raise BadInput("--out", expected="room to write", seen=f"{self.path}: {error.strerror}") from None

    def drop(self) -> None:
        """Nothing worth keeping was written."""
        self.stop()
        self.part.unlink(missing_ok=True)
        self.state.unlink(missing_ok=True)
