"""What is a stall's own in the picture besides its model: the colour of its light, and what stands nearest the eye."""

from __future__ import annotations

from dataclasses import dataclass, fields

from game.formats import Node

__all__ = ["MARKET_MOOD", "NEAR", "Mood", "read_mood"]

Factors = tuple[float, float, float]

NEAR = ("flowers", "garden", "fair", "none")
"""What the near layer can be: flowers; pine and plum; balloons and pinwheels."""


@dataclass(frozen=True)
class Mood:
    """near: one of NEAR. lit, shade, deep, rim: factors on what the hour makes of each tone; far: on the backdrop."""

    near: str = "flowers"
    lit: Factors = (1.0, 1.0, 1.0)
    shade: Factors = (1.0, 1.0, 1.0)
    deep: Factors = (1.0, 1.0, 1.0)
    rim: Factors = (1.0, 1.0, 1.0)
    far: Factors = (1.0, 1.0, 1.0)


MARKET_MOOD = Mood()


def read_mood(node: Node) -> Mood:
    """The section ``mood`` of a stall's YAML; what it does not name is as everywhere. Raises BadInput."""
    node.only(*(f.name for f in fields(Mood)))
    near = node.get("near")
    if near is not None and near.as_str() not in NEAR:
        raise near.error(expected=" | ".join(NEAR))
    tints: dict[str, Factors] = {}
    for name in ("lit", "shade", "deep", "rim", "far"):
        row = node.get(name)
        if row is None:
            continue
        values = [value.as_float(0.2, 2.0) for value in row.as_list()]
        if len(values) != 3:
            raise row.error(expected="three factors: red, green, blue")
        tints[name] = (values[0], values[1], values[2])
    return Mood("flowers" if near is None else near.as_str(), **tints)
