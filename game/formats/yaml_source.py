"""Strict YAML in which every value knows its place in the file.

What the format allows and authors trip over is refused with file:line:col: duplicate keys, anchors and aliases
(also the way to "alias bombs"), tags beyond the core schema, keys that are not text, several documents in one
file. Scalars follow the YAML 1.2 core schema, so ``no``, ``yes``, ``on`` and ``off`` stay text.

The tree is built from PyYAML's event stream with a stack of our own: depth and node count are checked as events
arrive, nothing recurses, and a hostile file is given up at its first offence.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import yaml

from game.core.errors import BadInput, Where
from game.formats.files import decode_utf8, read_bytes
from game.formats.yaml_node import Kind, Node, Plain, Scalar, nearest

__all__ = ["Node", "load_yaml", "nearest", "parse_yaml"]

# PyYAML's C parser is some ten times faster and yields the same events; wheels carry it, source builds may not.
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

_CORE = "tag:yaml.org,2002:"
_TEXT_TAGS = ("!", _CORE + "str")
_NO_PAIRS: Mapping[str, tuple[Node, Node]] = MappingProxyType({})
_INT = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_SPECIAL_FLOAT = re.compile(r"[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")
_NULLS = frozenset({"", "~", "null", "Null", "NULL"})
_BOOLEANS = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
_MAX_DIGITS = 40
# YAML 1.2 section 5.1 less what has no business in an authored text file (NEL, BOM in the middle, surrogates).
_UNPRINTABLE = re.compile("[^\t\n\r\x20-\x7e\xa0-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]")


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
        elif isinstance(event, yaml.CollectionStartEvent):
            self._check(event)
            kind: Kind = "mapping" if isinstance(event, yaml.MappingStartEvent) else "sequence"
            if event.tag not in (None, "!", _CORE + ("map" if kind == "mapping" else "seq")):
                raise BadInput(f"tag {str(event.tag)[:60]!r} is not allowed here", where=self._where(event))
            if len(self.stack) >= self.max_depth:
                raise BadInput(
                    where=self._where(event),
                    expected=f"at most {self.max_depth} levels of nesting",
                    seen=Plain("more"),
                )
            if self.stack and self.stack[-1].wants_key:
                raise BadInput(where=self._where(event), expected="a text key", seen=Plain(f"a {kind} as key"))
            self.stack.append(_Open(kind, self._where(event)))
        elif isinstance(event, yaml.CollectionEndEvent):
            done = self.stack.pop()
            if done.kind == "mapping":
                self._add(Node(done.where, "mapping", _pairs=done.pairs))
            else:
                self._add(Node(done.where, "sequence", _items=tuple(done.items)))
        elif isinstance(event, yaml.AliasEvent):
            raise BadInput(f"alias *{str(event.anchor)[:40]}", where=self._where(event), hint="write the value out")
        elif isinstance(event, yaml.DocumentStartEvent):
            self.documents += 1
            if self.documents > 1:
                raise BadInput(where=self._where(event), expected="one YAML document", seen=Plain("a second one"))

    def _where(self, event: Any) -> Where:
        mark = event.start_mark
        return Where(self.path, mark.line + 1, mark.column + 1)

    def _check(self, event: Any) -> None:
        if event.anchor is not None:
            raise BadInput(
                f"anchor &{str(event.anchor)[:40]}", where=self._where(event), hint="write the value out where needed"
            )
        self.count += 1
        if self.count > self.max_nodes:
            raise BadInput(where=self._where(event), expected=f"at most {self.max_nodes} values", seen=Plain("more"))

    def _scalar(self, event: yaml.ScalarEvent) -> Node:
        where, text, tag = self._where(event), event.value, event.tag
        if tag is None or tag in _TEXT_TAGS:
            if tag is not None or not event.implicit[0]:
                return Node(where, "scalar", text, text, (), _NO_PAIRS)
            value = _resolve(text, where)
        else:
            value = _resolve(text, where)
            if tag != _CORE + _TAG_OF[type(value)]:
                raise BadInput(
                    f"tag {str(tag)[:60]!r} does not fit or is not allowed", where=where, hint="leave it out"
                )
        return Node(where, "null" if value is None else "scalar", value, text, (), _NO_PAIRS)

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
    if text[0] not in "+-.0123456789":
        return _BOOLEANS.get(text, text)
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
