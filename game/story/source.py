"""One YAML file with its text: typed access that notes every fault and goes on, and places inside scalars."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import yaml

from game.core.errors import BadInput, Where
from game.formats.yaml_source import Node, parse_yaml
from game.story.findings import Findings
from game.story.grammar import Shape

__all__ = ["ID", "Source"]

ID = re.compile(r"[a-z][a-z0-9_]{0,63}")
# Plain scalars that YAML 1.1 tools (many editors and libraries) read as true or false.
_TRAPS = frozenset({"yes", "no", "on", "off", "y", "n"})
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class Source:
    """The file's nodes and lines; every ``get``-like method notes a fault in ``findings`` and returns None for it."""

    def __init__(self, path: Path | str, text: str, findings: Findings, *, traps: bool = True) -> None:
        self.path = str(path)
        self.findings = findings
        self.traps = traps
        # The rows of this file and of those it includes, by the path their nodes name.
        self.rows: dict[str, list[str]] = {self.path: text.split("\n")}
        self.root: Node | None = None
        try:
            self.root = parse_yaml(text, path)
        except BadInput as error:
            if not self._duplicates(text):
                findings.take("E_YAML", error)
        else:
            if traps:
                self._traps(text)

    def adopt(self, other: Source) -> None:
        """Know the text of another file too: nodes of both may be asked for places inside them."""
        self.rows.update(other.rows)

    # --- the file as a whole ---------------------------------------------------------------------------------
    def _duplicates(self, text: str) -> bool:
        """Note all duplicate keys, not only the first; False where there are none or the file breaks otherwise."""
        found: list[tuple[Where, str]] = []
        # One entry per open mapping or sequence: its keys so far, and whether a key comes next.
        stack: list[tuple[set[str], list[bool]] | None] = []
        try:
            for event in yaml.parse(text, Loader=_LOADER):
                top = stack[-1] if stack else None
                if isinstance(event, yaml.MappingEndEvent | yaml.SequenceEndEvent):
                    stack.pop()
                    continue
                if isinstance(event, yaml.ScalarEvent) and top is not None and top[1][0]:
                    if event.value in top[0]:
                        found.append((self._where(event), event.value))
                    top[0].add(event.value)
                if isinstance(event, yaml.NodeEvent) and top is not None:
                    top[1][0] = not top[1][0]
                if isinstance(event, yaml.MappingStartEvent):
                    stack.append((set(), [True]))
                elif isinstance(event, yaml.SequenceStartEvent):
                    stack.append(None)
        except yaml.YAMLError:
            return False
        for where, key in found:
            self.findings.add("E_DUPLICATE_KEY", where, f"the key {key!r} is given twice", "keep one")
        return bool(found)

    def _traps(self, text: str) -> None:
        for event in yaml.parse(text, Loader=_LOADER):
            if isinstance(event, yaml.ScalarEvent) and event.implicit[0] and event.value.lower() in _TRAPS:
                self.findings.add(
                    "W_YAML_BOOLEAN",
                    self._where(event),
                    f"unquoted {event.value}: YAML 1.1 tools read it as true or false",
                    f'write "{event.value}"',
                )

    def _where(self, event: yaml.Event) -> Where:
        mark: Any = event.start_mark
        return Where(self.path, mark.line + 1, mark.column + 1)

    def inside(self, node: Node) -> Callable[[int], Where]:
        """Places inside a scalar: character of its text -> Where in the file."""
        line, col = node.where.line or 1, node.where.col or 1
        all_rows = self.rows[node.where.path]
        first = all_rows[line - 1][col - 1 : col] if line <= len(all_rows) else ""
        if first in {"|", ">"}:
            return self._inside_block(node, line)
        shift = 1 if first in {'"', "'"} else 0
        rows = all_rows[line - 1 : line]
        one_row = bool(rows) and len(rows[0]) - (col - 1) >= len(node.raw)

        def place(offset: int) -> Where:
            # A scalar folded over several rows keeps only its start.
            return Where(node.where.path, line, col + shift + offset) if one_row else node.where

        return place

    def _inside_block(self, node: Node, line: int) -> Callable[[int], Where]:
        def place(offset: int) -> Where:
            before = node.raw[:offset]
            row = line + 1 + before.count("\n")
            if row > len(self.rows[node.where.path]):
                return node.where
            content = self.rows[node.where.path][row - 1]
            indent = len(content) - len(content.lstrip(" "))
            return Where(node.where.path, row, indent + 1 + offset - (before.rfind("\n") + 1))

        return place

    # --- typed access ----------------------------------------------------------------------------------------
    def mapping(self, node: Node, shape: Shape) -> dict[str, Node]:
        """Key -> value of what is there and known; unknown and missing keys are noted."""
        if node.kind != "mapping":
            self._take(node.error(expected="a mapping (key: value)"))
            return {}
        out: dict[str, Node] = {}
        for key, value in node.items():
            name = str(key.value)
            if name in shape:
                if value.kind != "null":
                    out[name] = value
            else:
                hint = self.findings.hint(name, shape)
                self.findings.add("E_UNKNOWN_KEY", key.where, f"unknown key {name!r}", hint)
        for name in shape.required:
            if name not in out:
                code = "E_MISSING_ID" if name == "id" else "E_MISSING_KEY"
                self.findings.add(code, node.where, f"{shape.title} needs {name!r}")
        return out

    def entries(self, node: Node | None) -> list[tuple[Node, Node]]:
        """(key, value) of a mapping with free keys."""
        if node is None:
            return []
        if node.kind != "mapping":
            self._take(node.error(expected="a mapping (key: value)"))
            return []
        return node.items()

    def items(self, node: Node | None) -> list[Node]:
        """The items of a list; a missing one is empty."""
        if node is None:
            return []
        if node.kind != "sequence":
            self._take(node.error(expected="a list"))
            return []
        return node.as_list()

    def text(self, node: Node | None) -> str | None:
        """Text."""
        return None if node is None else self._try(node.as_str)

    def number(self, node: Node | None, low: float, high: float) -> float | None:
        """A number in [low, high]."""
        return None if node is None else self._try(lambda: node.as_float(low, high))

    def number_of(self, fields: Mapping[str, Node], shape: Shape, name: str) -> float | None:
        """The number under a key, in the range the shape gives it."""
        return self.number(fields.get(name), shape[name].low, shape[name].high)

    def whole_of(self, fields: Mapping[str, Node], shape: Shape, name: str) -> int | None:
        """The whole number under a key, in the range the shape gives it."""
        node, key = fields.get(name), shape[name]
        return None if node is None else self._try(lambda: node.as_int(int(key.low), int(key.high)))

    def flag(self, node: Node | None, default: bool) -> bool:
        """true or false."""
        if node is None:
            return default
        value = self._try(node.as_bool)
        return default if value is None else value

    def identifier(self, node: Node | None) -> str | None:
        """An id: small letters, digits and _, starting with a letter."""
        name = self.text(node)
        if name is None or node is None:
            return None
        if not ID.fullmatch(name):
            self.findings.add("E_BAD_ID", node.where, f"{name!r} is not an id", "small letters, digits and _")
            return None
        return name

    def one_of(self, node: Node | None, known: Iterable[str], code: str, what: str) -> str | None:
        """One of the known names."""
        name = self.text(node)
        if name is None or node is None:
            return None
        names = list(known)
        if name in names:
            return name
        self.findings.add(code, node.where, f"unknown {what} {name!r}", self.findings.hint(name, names))
        return None

    def _try(self, read: Callable[[], Any]) -> Any:
        try:
            return read()
        except BadInput as error:
            self._take(error)
            return None

    def _take(self, error: BadInput) -> None:
        self.findings.take("E_BAD_VALUE", error)
