"""What a stall is made of, as records read strictly from its YAML: every piece names its kind, sizes and materials.

A piece gives parts that stand still, by group (``scene``, ``table``, ``awning``), and things that move by themselves
(``Moving``): swaying lanterns, cloth and flags, turning pinwheels.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Literal, NewType, Protocol, get_origin, get_type_hints

from game.formats import Node
from game.tools.modelling.parts import Part

__all__ = ["Colour", "Hanging", "Moving", "Piece", "Vector", "read_piece"]

Colour = NewType("Colour", str)
"""The name of an entry of the stall's palette."""
Vector = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Hanging:
    """Parts that turn together about one point, world metres."""

    pivot: Vector
    parts: Sequence[Part]


@dataclass(frozen=True, eq=False)
class Moving:
    """A group of things that move alike, each about its own pivot.

    sway: to and fro about ``axis`` by up to ``amplitude_deg``; spin: round and round, one turn per ``period_s``.
    """

    group: str
    motion: Literal["sway", "spin"]
    axis: Vector
    amplitude_deg: float
    period_s: float
    hanging: Sequence[Hanging]


class Piece(Protocol):
    """One entry of ``pieces`` in a stall's YAML."""

    def still(self) -> Mapping[str, list[Part]]: ...

    def moving(self) -> Sequence[Moving]: ...


def read_piece(row: Node, kinds: Mapping[str, type[Any]], palette: Mapping[str, object]) -> Piece:
    """A record of the class that ``piece`` names, with exactly its fields. Raises BadInput with file:line:col."""
    kind = row["piece"]
    if kind.as_str() not in kinds:
        raise kind.error(expected=" | ".join(kinds))
    record = kinds[kind.as_str()]
    hints = get_type_hints(record)
    names = [field.name for field in fields(record)]
    row.only("piece", *names)
    piece: Piece = record(**{name: _value(row[name], hints[name], palette) for name in names})
    return piece


def _value(node: Node, kind: Any, palette: Mapping[str, object]) -> Any:
    if kind is float:
        return node.as_float(-10.0, 360.0)
    if kind is int:
        return node.as_int(0, 200)
    if kind is Colour:
        if node.as_str() not in palette:
            raise node.error(expected="an entry of the palette")
        return node.as_str()
    if kind is bool:
        return node.as_bool()
    inner = kind.__args__
    if get_origin(kind) is Literal:
        if node.as_str() not in inner:
            raise node.error(expected=" | ".join(inner))
        return node.as_str()
    items = node.as_list()
    if inner[-1] is Ellipsis:
        if not items:
            raise node.error(expected="at least one value")
        return tuple(_value(item, inner[0], palette) for item in items)
    if len(items) != len(inner):
        raise node.error(expected=f"{len(inner)} values")
    return tuple(_value(item, each, palette) for item, each in zip(items, inner, strict=True))
