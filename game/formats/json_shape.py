"""Strict JSON from outside, checked against a described shape before anything is done with it.

A shape says what a value must be; `check` walks value and shape together, so its depth is the shape's, never the
file's. What later code relies on is refused with the JSON pointer of the fault; what it can live with (an unknown
choice, an empty list) becomes a finding.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

from game.core.errors import BadInput, Where
from game.formats.files import decode_utf8

__all__ = ["Anything", "Fields", "Flag", "Index", "Items", "Number", "Report", "Table", "Text", "check", "parse_json"]

_MAX_STRUCTURE = 1_000_000
_MAX_DEPTH = 128
_LARGEST = 1e30


@dataclass(frozen=True)
class Number:
    """A finite number within [lo, hi]; above: the bound lo itself is excluded."""

    lo: float = -_LARGEST
    hi: float = _LARGEST
    above: bool = False
    integer: bool = False


@dataclass(frozen=True)
class Text:
    """A string; choices: the known values (others are refused if `strict`, else a finding)."""

    choices: tuple[str, ...] = ()
    strict: bool = False


@dataclass(frozen=True)
class Flag:
    """true or false."""


@dataclass(frozen=True)
class Index:
    """An index into one of the document's lists, by name. `none`: -1 stands for nothing."""

    of: str
    none: bool = False


@dataclass(frozen=True)
class Items:
    """A list. count: allowed lengths; empty_ok: being empty is no finding."""

    of: Shape
    count: tuple[int, ...] = ()
    unique: bool = False
    empty_ok: bool = False


@dataclass(frozen=True)
class Table:
    """An object with free keys."""

    of: Shape


@dataclass(frozen=True)
class Fields:
    """An object with known keys; others are left alone."""

    known: Mapping[str, Shape]
    required: tuple[str, ...] = ()


@dataclass(frozen=True)
class Anything:
    """Any value."""


Shape = Number | Text | Flag | Index | Items | Table | Fields | Anything


@dataclass
class Report:
    """Where faults of one document go: `refuse` raises, `note` is kept (the first 200)."""

    path: Path
    lengths: Mapping[str, int] = field(default_factory=dict)
    findings: list[str] = field(default_factory=list)

    def where(self, *pointer: str | int) -> Where:
        """The place of a JSON pointer given as its parts."""
        escaped = (str(part)[:60].replace("~", "~0").replace("/", "~1") for part in pointer)
        return Where(self.path, pointer="".join(f"/{part}" for part in escaped))

    def refuse(self, pointer: tuple[str | int, ...], message: str = "", **parts: Any) -> NoReturn:
        """Raise BadInput at a pointer; parts: expected, seen, hint."""
        raise BadInput(message, where=self.where(*pointer), **parts)

    def note(self, pointer: tuple[str | int, ...], message: str) -> None:
        """Keep a finding: wrong, but harmless to what we do with the file."""
        if len(self.findings) < 200:
            self.findings.append(f"{self.where(*pointer)}: {message}")


def parse_json(data: bytes, path: Path) -> dict[str, Any]:
    """A JSON object. Raises BadInput: not JSON (line and column), duplicate keys, NaN, too large or too deep."""
    text = decode_utf8(data, path)
    # Each element costs tens of bytes once parsed, so their number is bounded before parsing.
    if text.count(",") + text.count("[") + text.count("{") > _MAX_STRUCTURE:
        raise BadInput(
            "JSON with too many elements", where=Where(path), expected=f"at most {_MAX_STRUCTURE}", seen="more"
        )
    try:
        value = json.loads(text, object_pairs_hook=_unique_object, parse_constant=_refuse_constant, parse_float=_number)
    except json.JSONDecodeError as error:
        raise BadInput(f"JSON: {error.msg}", where=Where(path, error.lineno, error.colno)) from None
    except _BadJson as error:
        raise BadInput(f"JSON: {error}", where=Where(path)) from None
    except RecursionError:
        raise BadInput(f"JSON nested more than {_MAX_DEPTH} deep", where=Where(path)) from None
    except ValueError as error:  # an integer of thousands of digits
        raise BadInput(f"JSON: {error}", where=Where(path)) from None
    if not isinstance(value, dict):
        raise BadInput(where=Where(path, pointer=""), expected="a JSON object", seen=_shown(value))
    if _depth_exceeds(value, _MAX_DEPTH):
        raise BadInput(f"JSON nested more than {_MAX_DEPTH} deep", where=Where(path))
    return value


def check(value: Any, shape: Shape, report: Report, pointer: tuple[str | int, ...] = ()) -> None:
    """Hold a value against a shape. Raises BadInput with the JSON pointer of the first fault."""
    if isinstance(shape, Fields):
        if not isinstance(value, dict):
            report.refuse(pointer, expected="an object", seen=_shown(value))
        for name in shape.required:
            if name not in value:
                report.refuse(pointer, f"{name!r} is missing")
        for name, inner in shape.known.items():
            if name in value:
                check(value[name], inner, report, (*pointer, name))
    elif isinstance(shape, Items):
        _check_items(value, shape, report, pointer)
    elif isinstance(shape, Table):
        if not isinstance(value, dict):
            report.refuse(pointer, expected="an object", seen=_shown(value))
        for name, item in value.items():
            check(item, shape.of, report, (*pointer, name))
    elif isinstance(shape, Number):
        _check_number(value, shape, report, pointer)
    elif isinstance(shape, Index):
        length = report.lengths.get(shape.of, 0)
        if isinstance(value, bool) or not isinstance(value, int):
            report.refuse(pointer, expected=f"an index into {shape.of}", seen=_shown(value))
        if not (0 <= value < length or (shape.none and value == -1)):
            report.refuse(pointer, expected=f"an index into the {length} {shape.of}", seen=value)
    elif isinstance(shape, Text):
        if not isinstance(value, str):
            report.refuse(pointer, expected="a string", seen=_shown(value))
        if shape.choices and value not in shape.choices:
            if shape.strict:
                report.refuse(pointer, expected=" | ".join(shape.choices), seen=value)
            report.note(pointer, f"unknown value {value[:40]!r}")
    elif isinstance(shape, Flag) and not isinstance(value, bool):
        report.refuse(pointer, expected="true or false", seen=_shown(value))


def _check_items(value: Any, shape: Items, report: Report, pointer: tuple[str | int, ...]) -> None:
    if not isinstance(value, list):
        report.refuse(pointer, expected="a list", seen=_shown(value))
    if shape.count and len(value) not in shape.count:
        report.refuse(pointer, expected=f"{' or '.join(map(str, shape.count))} items", seen=len(value))
    if not value and not shape.empty_ok:
        report.note(pointer, "an empty list")
    for index, item in enumerate(value):
        check(item, shape.of, report, (*pointer, index))
    if shape.unique and len(set(value)) != len(value):
        report.refuse(pointer, expected="no item twice", seen=_shown(value))


def _check_number(value: Any, shape: Number, report: Report, pointer: tuple[str | int, ...]) -> None:
    wanted = "a whole number" if shape.integer else "a number"
    allowed = int if shape.integer else (int, float)
    if isinstance(value, bool) or not isinstance(value, allowed):
        report.refuse(pointer, expected=wanted, seen=_shown(value))
    inside = shape.lo <= value <= shape.hi and not (shape.above and value == shape.lo)
    if not inside or not math.isfinite(value):
        bounds = f"{'above' if shape.above else 'from'} {shape.lo:g} to {shape.hi:g}"
        report.refuse(pointer, expected=f"{wanted} {bounds}", seen=_shown(value))


class _BadJson(Exception):
    """Refused while parsing."""


def _unique_object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    result = dict(pairs)
    if len(result) != len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise _BadJson(f"the key {twice[:40]!r} stands twice in one object")
    return result


def _number(text: str) -> float | int:
    """1.0 is a whole number in JSON."""
    value = float(text)
    return int(value) if abs(value) < 2**53 and value.is_integer() else value


def _refuse_constant(name: str) -> NoReturn:
    raise _BadJson(f"{name} is not a JSON number")


def _depth_exceeds(value: Any, limit: int) -> bool:
    level: list[Any] = [value]
    for _ in range(limit):
        level = [
            inner
            for item in level
            for inner in (item.values() if isinstance(item, dict) else item)
            if isinstance(inner, dict | list)
        ]
        if not level:
            return False
    return True


def _shown(value: Any) -> Any:
    if isinstance(value, dict):
        return "an object"
    if isinstance(value, list):
        return f"a list of {len(value)}"
    return str(value)[:60] if isinstance(value, int) and abs(value) > 10**60 else value
