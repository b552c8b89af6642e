"""Which materials of a person's clothes are patterned, and how: the section ``weaves`` of the YAML."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from game.formats import Node
from game.render.weave import MOTIFS

__all__ = ["Weave", "read_weaves"]


@dataclass(frozen=True)
class Weave:
    """A pattern: motif, width of its tile in metres, how much lighter (or darker, below 0) it is, turned by degrees."""

    motif: str
    size: float
    strength: float
    turn_deg: float = 0.0


def read_weaves(node: Node | None, materials: Mapping[str, object]) -> dict[str, Weave]:
    """``material: {motif, size, strength, turn_deg}`` -> by material. Raises BadInput with the place."""
    found: dict[str, Weave] = {}
    for key, row in () if node is None else node.items():
        name = key.as_str()
        if name not in materials:
            raise key.error(expected="a material of the palette")
        row.only("motif", "size", "strength", "turn_deg")
        if row["motif"].as_str() not in MOTIFS:
            raise row["motif"].error(expected=" | ".join(MOTIFS))
        turn = row.get("turn_deg")
        found[name] = Weave(
            row["motif"].as_str(),
            row["size"].as_float(0.004, 0.5),
            row["strength"].as_float(-0.9, 0.9),
            0.0 if turn is None else turn.as_float(-180.0, 180.0),
        )
    return found
