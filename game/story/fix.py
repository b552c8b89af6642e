"""Missing ids, written back into the file: only the ids are put in, every other byte stays as it is."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from game.formats.files import decode_utf8, read_bytes, write_bytes
from game.formats.yaml_source import Node, parse_yaml

__all__ = ["fix_file", "with_ids"]

_MAX_BYTES = 2_000_000
_BOM = b"\xef\xbb\xbf"
_NOT_ID = re.compile(r"[^a-z0-9_]+")


@dataclass(frozen=True)
class _Gap:
    """A line or choice without an id; stem: what its id begins with."""

    node: Node
    stem: str


def fix_file(path: Path) -> list[str]:
    """Write the missing ids of one file; the ids that were put in. Raises BadInput where that is impossible."""
    data = read_bytes(path, max_bytes=_MAX_BYTES, what="YAML file")
    text, ids = with_ids(decode_utf8(data, path), path)
    if ids:
        write_bytes(path, (_BOM if data.startswith(_BOM) else b"") + text.encode("utf-8"), keep_rights=True)
    return ids


def with_ids(text: str, path: Path | str = "text") -> tuple[str, list[str]]:
    """The text with an id in every line and choice that had none, and the new ids in the order of the file.

    An id is made of where the line stands: ``hub_3``, ``praise_2``. Raises BadInput for what is no YAML.
    """
    root = parse_yaml(text, path)
    if root.kind != "mapping":
        return text, []
    taken = set(_ids(root))
    places = sorted(_gaps(root), key=lambda gap: (gap.node.where.line or 0, gap.node.where.col or 0))
    rows = text.split("\n")
    starts = [0]
    for row in rows:
        starts.append(starts[-1] + len(row) + 1)
    out, at, ids = [], 0, []
    for gap in places:
        line, col = gap.node.where.line or 1, gap.node.where.col or 1
        offset = starts[line - 1] + col - 1
        name = _free(gap.stem, taken)
        if text[offset : offset + 1] == "{":
            offset += 1
            rest = text[offset:].lstrip(" ")
            new = f"id: {name}" if rest.startswith("}") else f"id: {name}, "
        else:
            end = "\r\n" if rows[line - 1].endswith("\r") else "\n"
            new = f"id: {name}{end}{' ' * (col - 1)}"
        out += [text[at:offset], new]
        at = offset
        ids.append(name)
    return "".join([*out, text[at:]]), ids


def _gaps(root: Node) -> Iterator[_Gap]:
    """Every line and choice without an id."""
    for key, pool in _entries(root.get("pools")):
        yield from _choices(pool, str(key.value))
    yield from _choices(root.get("standing"), "standing")
    for key, node in _entries(root.get("nodes")):
        if node.kind == "mapping":
            for item in _items(node.get("lines")):
                group = item.get("any") if item.kind == "mapping" and "any" in item else None
                for line in _items(group) if group is not None else [item]:
                    yield from _gap(line, str(key.value))
            yield from _choices(node.get("choices"), str(key.value))


def _choices(node: Node | None, stem: str) -> Iterator[_Gap]:
    for choice in _items(node):
        if choice.kind != "mapping":
            continue
        act = choice.get("act")
        yield from _gap(choice, act.raw if act is not None else stem)
        name = choice.get("id")
        for wording in _items(choice.get("say")):
            yield from _gap(wording, next((given.raw for given in (name, act) if given is not None), stem))


def _gap(node: Node, stem: str) -> Iterator[_Gap]:
    # An empty mapping or one that is no line at all is told by the linter; nothing is made of it.
    if node.kind == "mapping" and len(node) and "id" not in node:
        yield _Gap(node, _NOT_ID.sub("_", stem.lower()).strip("_") or "line")


def _free(stem: str, taken: set[str]) -> str:
    stem = stem if stem[0].isalpha() else f"line_{stem}"
    number = 1
    while f"{stem[:56]}_{number}" in taken:
        number += 1
    name = f"{stem[:56]}_{number}"
    taken.add(name)
    return name


def _ids(root: Node) -> Iterator[str]:
    """Every id and node name of a file."""
    stack = [root]
    while stack:
        node = stack.pop()
        for key, value in _entries(node):
            if key.value == "id":
                yield value.raw
            stack.append(value)
        stack.extend(_items(node))
    yield from (str(key.value) for key, _ in _entries(root.get("nodes")))


def _entries(node: Node | None) -> list[tuple[Node, Node]]:
    return node.items() if node is not None and node.kind == "mapping" else []


def _items(node: Node | None) -> list[Node]:
    return node.as_list() if node is not None and node.kind == "sequence" else []
