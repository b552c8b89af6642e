"""A texture of drawn text lines: shelves filled from the top, cleared as a whole when full."""

from __future__ import annotations

from dataclasses import dataclass

import moderngl
import numpy as np

from game.render.device import Device, Owner
from game.render.text import FontSet

__all__ = ["LineAtlas", "Placed"]

_SIZE = 2048
_GAP = 1


@dataclass(frozen=True)
class Placed:
    """A line in the atlas: pixels from the left and top, its size, and rows above the baseline."""

    x: int
    y: int
    width: int
    height: int
    ascent: int


class LineAtlas(Owner):
    """Lines of text by (text, role, size); drawing a line again costs a dictionary look-up."""

    def __init__(self, device: Device, fonts: FontSet, size: int = _SIZE) -> None:
        super().__init__()
        self.size = size
        self._fonts = fonts
        self.texture = self.own(device.context.texture((size, size), 1, np.zeros((size, size), np.uint8), alignment=1))
        self.texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._places: dict[tuple[str, str, int], Placed] = {}
        self._shelf = (0, 0, 0)  # next x, top, height

    def find(self, text: str, role: str, size_px: int) -> Placed | None:
        """Where the line is; drawn when it is new. None when the atlas is full: then ``clear`` it and ask again."""
        key = (text, role, size_px)
        if key in self._places:
            return self._places[key]
        line = self._fonts.draw(text, role, size_px)
        coverage = line.coverage[:, : self.size]
        height, width = coverage.shape
        x, top, shelf = self._shelf
        if x + width > self.size:
            x, top, shelf = 0, top + shelf + _GAP, 0
        if top + height > self.size:
            return None
        self.texture.write(np.ascontiguousarray(coverage), viewport=(x, top, width, height), alignment=1)
        self._shelf = (x + width + _GAP, top, max(shelf, height))
        placed = Placed(x, top, width, height, line.ascent)
        self._places[key] = placed
        return placed

    def clear(self) -> None:
        """Forget all lines."""
        self._places.clear()
        self._shelf = (0, 0, 0)
