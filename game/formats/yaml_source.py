"""Strict YAML in which every value knows its place in the file.

What the format allows and authors trip over is refused with file:line:col: duplicate keys, anchors and aliases
(also the way to "alias bombs"), tags beyond the core schema, keys that are not text, several documents in one
file. Scalars follow the YAML 1.2 core schema, so ``no``, ``yes``, ``on`` and ``off`` stay text.

The tree is built from PyYAML's event stream with a stack of our own: depth and node count are checked as events
arrive, nothing recurses, and a hostile file is given up at its first offence.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import yaml

from game.core.errors import BadInput, Where
from game.formats.files import decode_utf8, read_bytes

__all__ = ["Node", "load_yaml", "nearest", "parse_yaml"]

Kind = Literal["mapping", "sequence", "scalar", "null"]
Scalar = str | int | float | bool | None

# PyYAML's C parser is some ten times faster and yields the same events; wheels carry it, source builds may not.
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

_CORE = "tag:yaml.org,2002:"
_INT = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_SPECIAL_FLOAT = re.compile(r"[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")
_NULLS = frozenset({"", "~", "null", "Null", "NULL"})
_BOOLEANS = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
_MAX_DIGITS = 40
# YAML 1.2 section 5.1 less what has no business in an authored text file (NEL, BOM in the middle, surrogates).
_UNPRINTABLE = re.compile("[^\t\n\r\x20-\x7e\xa0-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]")


class _Plain(str):
    """A description that error messages show without quotes."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Node:
    """One YAML value with its place. Immutable.

    value: the Python scalar (None for mappings and sequences); raw: the scalar's text before it was resolved.
    """

    where: Where
    kind: Kind
    value: Scalar = None
    raw: str = ""
    _items: tuple[Node, ...] = ()
    _pairs: dict[str, tuple[Node, Node]] = field(default_factory=dict)

    # --- structure -------------------------------------------------------------------------------------------
    def keys(self) -> list[Node]:
        """The key nodes of a mapping, in file order."""
        self._need("mapping", "a mapping (key: value)")
        return [key for key, _ in self._pairs.values()]

    def items(self) -> list[tuple[Node, Node]]:
        """(key node, value node) of a mapping, in file order."""
        self._need("mapping", "a mapping (key: value)")
        return list(self._pairs.values())

    def __getitem__(self, key: str) -> Node:
        """The value of a key. Raises BadInput where the key is missing."""
        self._need("mapping", f"a mapping with the key {key!r}")
        if key not in self._pairs:
            seen = ", ".join(self._pairs) or "no keys"
            close = nearest(key, self._pairs)
            raise BadInput(
                where=self.where,
                expected=f"the key {key!r}",
                seen=_Plain(seen),
                hint=f"is {close!r} a slip for it?" if close else None,
            )
        return self._pairs[key][1]

    def get(self, key: str) -> Node | None:
        """The value of a key, or None where it is missing or empty (``key:`` with nothing behind it)."""
        self._need("mapping", f"a mapping that may have the key {key!r}")
        pair = self._pairs.get(key)
        return None if pair is None or pair[1].kind == "null" else pair[1]

    def __contains__(self, key: object) -> bool:
        return self.kind == "mapping" and key in self._pairs

    def __len__(self) -> int:
        return len(self._pairs) if self.kind == "mapping" else len(self._items)

    def __bool__(self) -> bool:
        # A node is a place in a file, true even where it is empty; `if node.get(...)` must not ask for its length.
        return True

    def __iter__(self) -> Iterator[Node]:
        """The items of a sequence."""
        self._need("sequence", "a list")
        return iter(self._items)

    def only(self, *allowed: str) -> Node:
        """This mapping, if it has no keys but these. Raises BadInput at the unknown key, offering the nearest."""
        self._need("mapping", "a mapping (key: value)")
        for name, (key, _) in self._pairs.items():
            if name not in allowed:
                close = nearest(name, allowed)
                raise BadInput(
                    "unknown key",
                    where=key.where,
                    expected=" | ".join(allowed),
                    seen=name,
                    hint=f"did you mean {close!r}?" if close else None,
                )
        return self

    # --- typed values ----------------------------------------------------------------------------------------
    def as_str(self) -> str:
        """The text. Numbers, booleans and nothing are refused: quote them to make them text."""
        if self.kind == "scalar" and isinstance(self.value, str):
            return self.value
        raise self.error(expected="text", hint='put it in "quotes"' if self.kind == "scalar" else None)

    def as_float(self, lo: float | None = None, hi: float | None = None) -> float:
        """A finite number, optionally within [lo, hi]."""
        value = self.value
        if self.kind != "scalar" or isinstance(value, bool) or not isinstance(value, int | float):
            raise self.error(expected=_bounds("a number", lo, hi))
        number = float(value)
        if not math.isfinite(number) or (lo is not None and number < lo) or (hi is not None and number > hi):
            raise self.error(expected=_bounds("a finite number" if not math.isfinite(number) else "a number", lo, hi))
        return number

    def as_int(self, lo: int | None = None, hi: int | None = None) -> int:
        """A whole number, optionally within [lo, hi]."""
        value = self.value
        if self.kind != "scalar" or isinstance(value, bool) or not isinstance(value, int):
            raise self.error(expected=_bounds("a whole number", lo, hi))
        if (lo is not None and value < lo) or (hi is not None and value > hi):
            raise self.error(expected=_bounds("a whole number", lo, hi))
        return value

    def as_bool(self) -> bool:
        """true or false; yes, no, on and off are text in YAML 1.2 and refused."""
        if self.kind == "scalar" and isinstance(self.value, bool):
            return self.value
        raise self.error(expected="true or false")

    def as_list(self) -> list[Node]:
        """The items of a sequence."""
        self._need("sequence", "a list")
        return list(self._items)

    def as_mapping(self) -> dict[str, Node]:
        """Key text -> value node, in file order."""
        self._need("mapping", "a mapping (key: value)")
        return {name: value for name, (_, value) in self._pairs.items()}

    def to_python(self) -> Any:
        """Plain dict, list and scalars (recursion is bounded by the reader's max_depth)."""
        if self.kind == "mapping":
            return {name: value.to_python() for name, (_, value) in self._pairs.items()}
        if self.kind == "sequence":
            return [item.to_python() for item in self._items]
        return self.value

    # --- errors ----------------------------------------------------------------------------------------------
    def error(self, message: str = "", *, expected: str | None = None, hint: str | None = None) -> BadInput:
        """A BadInput at this place; where something is expected, what stands here is named as seen."""
        return BadInput(message, where=self.where, expected=expected, seen=self._shown(), hint=hint)

    def __repr__(self) -> str:
        return f"Node({self.where}, {self._shown()!r})"

    def _shown(self) -> str:
        if self.kind == "mapping":
            return _Plain(f"a mapping of {', '.join(self._pairs) or 'nothing'}")
        if self.kind == "sequence":
            return _Plain(f"a list of {len(self._items)}")
        if self.kind == "null":
            return _Plain("nothing")
        return self.raw if isinstance(self.value, str) else _Plain(self.raw)

    def _need(self, kind: Kind, expected: str) -> None:
        if self.kind != kind:
            raise self.error(expected=expected)


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The known name most like this one, or None where none is close."""
    # Slips are short; on long or very many names difflib would cost more than the hint is worth.
    candidates = [k for k in known if abs(len(k) - len(name)) <= 8][:1000]
    close = difflib.get_close_matches(name[:80], candidates, n=1, cutoff=0.6)
    return close[0] if close else None


def load_yaml(path: Path, *, max_bytes: int = 2_000_000, max_nodes: int = 200_000, max_depth: int = 60) -> Node:
    """Read a UTF-8 YAML file. Raises BadInput with path:line:col (path@byte for bad UTF-8)."""
    text = decode_utf8(read_bytes(path, max_bytes=max_bytes, what="YAML file"), path)
    return parse_yaml(text, path, max_nodes=max_nodes, max_depth=max_depth)


def parse_yaml(text: str, path: Path | str, *, max_nodes: int = 200_000, max_depth: int = 60) -> Node:
    """Parse one YAML document; path is only named in errors. Raises BadInput with path:line:col."""
    bad = _UNPRINTABLE.search(text)
    if bad:
        line = text.count("\n", 0, bad.start()) + 1
        col = bad.start() - (text.rfind("\n", 0, bad.start()) + 1) + 1
        raise BadInput(where=Where(path, line, col), expected="printable text", seen=f"U+{ord(bad.group()):04X}")
    builder = _Builder(path, max_nodes, max_depth)
    try:
        for event in yaml.parse(text, Loader=_LOADER):
            builder.take(event)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        if mark is None:
            raise BadInput(f"YAML: {error.problem}", where=Where(path)) from None
        tab = "cannot start any token" in str(error.problem) and _at(text, mark) == "\t"
        raise BadInput(
            f"YAML: {error.problem}",
            where=Where(path, mark.line + 1, mark.column + 1),
            hint="indent with spaces, not tabs" if tab else error.context,
        ) from None
    except yaml.YAMLError as error:
        raise BadInput(f"YAML: {error}", where=Where(path)) from None
    return builder.root if builder.root is not None else Node(Where(path, 1, 1), "null")


class _Builder:
    """Turns the event stream into nodes, refusing at the first offence."""

    def __init__(self, path: Path | str, max_nodes: int, max_depth: int) -> None:
        self.path = str(path)
        self.max_nodes = max_nodes
        self.max_depth = max_depth
        self.count = 0
        self.documents = 0
        self.root: Node | None = None
        self.stack: list[_Open] = []

    def take(self, event: yaml.Event) -> None:
        if isinstance(event, yaml.ScalarEvent):
            self._check(event)
            self._add(self._scalar(event))
        elif isinstance(event, yaml.MappingStartEvent | yaml.SequenceStartEvent):
            self._check(event)
            kind: Kind = "mapping" if isinstance(event, yaml.MappingStartEvent) else "sequence"
            if event.tag not in (None, "!", _CORE + ("map" if kind == "mapping" else "seq")):
                raise BadInput(f"tag {event.tag[:60]!r} is not allowed here", where=self._where(event))
            if len(self.stack) >= self.max_depth:
                raise BadInput(
                    where=self._where(event),
                    expected=f"at most {self.max_depth} levels of nesting",
                    seen=_Plain("more"),
                )
            if self.stack and self.stack[-1].wants_key:
                raise BadInput(where=self._where(event), expected="a text key", seen=_Plain(f"a {kind} as key"))
            self.stack.append(_Open(kind, self._where(event)))
        elif isinstance(event, yaml.MappingEndEvent | yaml.SequenceEndEvent):
            done = self.stack.pop()
            if done.kind == "mapping":
                self._add(Node(done.where, "mapping", _pairs=done.pairs))
            else:
                self._add(Node(done.where, "sequence", _items=tuple(done.items)))
        elif isinstance(event, yaml.AliasEvent):
            raise BadInput(f"alias *{event.anchor[:40]}", where=self._where(event), hint="write the value out")
        elif isinstance(event, yaml.DocumentStartEvent):
            self.documents += 1
            if self.documents > 1:
                raise BadInput(where=self._where(event), expected="one YAML document", seen=_Plain("a second one"))

    def _where(self, event: Any) -> Where:
        mark = event.start_mark
        return Where(self.path, mark.line + 1, mark.column + 1)

    def _check(self, event: Any) -> None:
        if event.anchor is not None:
            raise BadInput(
                f"anchor &{event.anchor[:40]}", where=self._where(event), hint="write the value out where needed"
            )
        self.count += 1
        if self.count > self.max_nodes:
            raise BadInput(where=self._where(event), expected=f"at most {self.max_nodes} values", seen=_Plain("more"))

    def _scalar(self, event: yaml.ScalarEvent) -> Node:
        where, text = self._where(event), event.value
        plain = event.implicit[0]
        if event.tag in (None, "!", _CORE + "str"):
            if not plain or event.tag is not None:
                return Node(where, "scalar", text, text)
            value = _resolve(text, where)
        else:
            value = _resolve(text, where)
            if event.tag != _CORE + _TAG_OF[type(value)]:
                raise BadInput(
                    f"tag {event.tag[:60]!r} does not fit or is not allowed", where=where, hint="leave it out"
                )
        return Node(where, "null" if value is None else "scalar", value, text)

    def _add(self, node: Node) -> None:
        if not self.stack:
            self.root = node
            return
        top = self.stack[-1]
        if top.kind == "sequence":
            top.items.append(node)
        elif top.key is None:
            if not isinstance(node.value, str):
                raise node.error(expected="a text key", hint='put it in "quotes"')
            first = top.pairs.get(node.value)
            if first is not None:
                place = f"{first[0].where.line}:{first[0].where.col}"
                raise BadInput(f"duplicate key {node.value[:60]!r}, first given at {place}", where=node.where)
            top.key = node
        else:
            assert isinstance(top.key.value, str)
            top.pairs[top.key.value] = (top.key, node)
            top.key = None


class _Open:
    """A mapping or sequence whose end has not come yet."""

    __slots__ = ("items", "key", "kind", "pairs", "where")

    def __init__(self, kind: Kind, where: Where) -> None:
        self.kind = kind
        self.where = where
        self.items: list[Node] = []
        self.pairs: dict[str, tuple[Node, Node]] = {}
        self.key: Node | None = None

    @property
    def wants_key(self) -> bool:
        return self.kind == "mapping" and self.key is None


_TAG_OF: dict[type, str] = {str: "str", int: "int", float: "float", bool: "bool", type(None): "null"}


def _resolve(text: str, where: Where) -> Scalar:
    """A plain scalar by the YAML 1.2 core schema (section 10.3.2)."""
    if text in _NULLS:
        return None
    if text in _BOOLEANS:
        return _BOOLEANS[text]
    if text[0] not in "+-.0123456789":
        return text
    if _INT.fullmatch(text):
        if len(text) > _MAX_DIGITS:
            raise BadInput(where=where, expected=f"a number of at most {_MAX_DIGITS} digits", seen=text)
        return int(text, {"0o": 8, "0x": 16}.get(text[:2], 10))
    if _FLOAT.fullmatch(text):
        return float(text)
    if _SPECIAL_FLOAT.fullmatch(text):
        return float(text.replace(".", ""))
    return text


def _at(text: str, mark: Any) -> str:
    """The character at a mark (the two parsers disagree on how to ask the mark itself)."""
    lines = text.splitlines()
    return lines[mark.line][mark.column : mark.column + 1] if mark.line < len(lines) else ""


def _bounds(what: str, lo: float | None, hi: float | None) -> str:
    if lo is not None and hi is not None:
        return f"{what} from {lo:g} to {hi:g}"
    if lo is not None:
        return f"{what} of at least {lo:g}"
    return what if hi is None else f"{what} of at most {hi:g}"
