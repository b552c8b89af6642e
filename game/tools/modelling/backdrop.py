"""The painted backdrops: a recipe's name -> what paints it, and the air it is seen through."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from game.tools.modelling import backdrop_market, backdrop_plaza, backdrop_temple
from game.tools.modelling.backdrop_canvas import Air, Canvas

__all__ = ["BACKDROPS", "paint_backdrop"]

BACKDROPS: Mapping[str, tuple[Callable[[Canvas, np.random.Generator], None], Air]] = {
    "market": (backdrop_market.paint_market, backdrop_market.AIR),
    "temple": (backdrop_temple.paint_temple, backdrop_temple.AIR),
    "plaza": (backdrop_plaza.paint_plaza, backdrop_plaza.AIR),
}
"""What ``backdrop.recipe`` of a stall's YAML may name."""


def paint_backdrop(path: Path, recipe: str, rng: np.random.Generator) -> None:
    """Write the 2048 x 1152 picture as PNG."""
    canvas = Canvas()
    paint, air = BACKDROPS[recipe]
    paint(canvas, rng)
    path.parent.mkdir(parents=True, exist_ok=True)
    canvas.graded(air).save(path, optimize=True)
