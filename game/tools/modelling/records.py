"""Dataclasses filled strictly from YAML: exactly their fields, those with a default may be left out.

Fields may be float, int, str, bool, fixed tuples of numbers, and ``tuple[X, ...]`` of numbers, tuples or records.
"""

from __future__ import annotations

from dataclasses import MISSING, fields, is_dataclass
from typing import Any, TypeVar, get_type_hints

from game.formats import Node

__all__ = ["Vector", "number_value", "record", "value"]

Vector = tuple[float, float, float]
Record = TypeVar("Record")

_FAR = 1000.0
"""No length in metres, angle in degrees or share in these files is larger."""


def number_value(node: Node) -> float:
    return node.as_float(-_FAR, _FAR)


def value(node: Node, kind: Any) -> Any:
    """The value of one field by its type hint. Raises BadInput with the place."""
    if kind is float:
        return number_value(node)
    if kind is int:
        return node.as_int(0, 1000)
    if kind is bool:
        return node.as_bool()
    if kind is str:
        return node.as_str()
    if is_dataclass(kind) and isinstance(kind, type):
        return record(node, kind)
    wanted = kind.__args__
    items = node.as_list()
    if wanted[-1] is Ellipsis:
        return tuple(value(item, wanted[0]) for item in items)
    if len(items) != len(wanted):
        raise node.error(expected=f"{len(wanted)} {'numbers' if wanted[0] is float else 'rows'}")
    return tuple(value(item, part) for item, part in zip(items, wanted, strict=True))


def record(node: Node, kind: type[Record]) -> Record:
    """A dataclass from a mapping with its fields. Raises BadInput for unknown, missing and wrong ones."""
    hints = get_type_hints(kind)
    known = {f.name: f for f in fields(kind)}  # type: ignore[arg-type]  # every Record here is a dataclass
    node.only(*known)
    return kind(
        **{
            name: value(node[name], hints[name])
            for name, field in known.items()
            if name in node or (field.default is MISSING and field.default_factory is MISSING)
        }
    )
