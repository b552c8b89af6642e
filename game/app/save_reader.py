"""Typed access to a saved game's untrusted JSON: every refusal names the file and the JSON pointer."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from game.core.errors import BadInput, Where
from game.formats.files import read_bytes

__all__ = ["MAX_BYTES", "SaveReader", "read_json"]

MAX_BYTES = 1_000_000


def read_json(path: Path) -> SaveReader:
    """Read a save's JSON. Raises BadInput where the file cannot be read, is too large, or is no JSON."""
    raw = read_bytes(path, max_bytes=MAX_BYTES, what="save")
    try:
        data = json.loads(raw.decode("utf-8"))
    except (ValueError, RecursionError) as error:
        at = getattr(error, "pos", getattr(error, "start", 0))
        raise BadInput(where=Where(path, byte=at), expected="JSON", seen=str(error).split(":")[0]) from None
    return SaveReader(path, data)


@dataclass(frozen=True)
class SaveReader:
    """Typed access to untrusted JSON with the pointer of every value."""

    path: Path
    data: Any
    pointer: str = ""

    def fail(self, expected: str, seen: object) -> BadInput:
        return BadInput(
            where=Where(self.path, pointer=self.pointer),
            expected=expected,
            seen=seen,
            hint="the save was left as it is; start a new afternoon or restore the file",
        )

    def at(self, key: str) -> SaveReader:
        if not isinstance(self.data, dict) or key not in self.data:
            raise self.fail(f"the key {key}", "none")
        return SaveReader(self.path, self.data[key], f"{self.pointer}/{key}")

    def names(self, limit: int = 1000) -> list[str]:
        if not isinstance(self.data, dict) or len(self.data) > limit or not all(isinstance(k, str) for k in self.data):
            raise self.fail(f"a mapping of at most {limit}", type(self.data).__name__)
        return list(self.data)

    def number(self, low: float = -1e9, high: float = 1e9) -> float:
        value = self.data
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.fail("a number", value)
        if not low <= value <= high:  # neither nan nor infinity, nor a whole number too large to be a float
            raise self.fail(f"a number from {low:g} to {high:g}", value)
        return float(value)

    def whole(self, low: int = 0, high: int = 2**63) -> int:
        value = self.data
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise self.fail(f"a whole number from {low} to {high}", value)
        return value

    def text(self, limit: int = 200) -> str:
        if not isinstance(self.data, str) or len(self.data) > limit:
            raise self.fail(f"a text of at most {limit} characters", self.data)
        return self.data

    def items(self, limit: int = 1000) -> list[SaveReader]:
        if not isinstance(self.data, list) or len(self.data) > limit:
            raise self.fail(f"a list of at most {limit}", type(self.data).__name__)
        return [SaveReader(self.path, item, f"{self.pointer}/{i}") for i, item in enumerate(self.data)]

    def flag(self) -> bool:
        if not isinstance(self.data, bool):
            raise self.fail("true or false", self.data)
        return self.data
