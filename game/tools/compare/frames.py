"""Expected and got, picture by picture, with a verdict: do they look the same?"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput
from game.tools.compare.flip import PIXELS_PER_DEGREE, flip

__all__ = ["TILE_PX", "Compared", "Limits", "compare_frames", "cut_strip"]

Pixels = NDArray[np.uint8]
TILE_PX = 24


@dataclass(frozen=True)
class Limits:
    """Up to here two pictures count as the same. mean: of the whole picture, tile: of its worst 24 × 24 pixels.

    A hand, an eye or a word that is gone is lost in the mean of a picture; no tile lets it pass.
    """

    mean: float = 0.02
    tile: float = 0.25


@dataclass(frozen=True, eq=False)
class Compared:
    """Two pictures (h, w, 3) and what lies between them. difference: (h, w) in [0, 1], by ꟻLIP."""

    name: str
    expected: Pixels
    got: Pixels
    difference: NDArray[np.float64]
    mean: float
    tile: float
    same: bool

    def told(self) -> str:
        """One line for a test's message."""
        return f"{self.name}: mean {self.mean:.4f}, worst tile {self.tile:.3f}"


def compare_frames(
    frames: Iterable[tuple[str, Pixels, Pixels]], limits: Limits = Limits(), per_degree: float = PIXELS_PER_DEGREE
) -> list[Compared]:
    """Compare (name, expected, got) one by one. Raises BadInput for pictures of different size."""
    return [_compare(name, expected, got, limits, per_degree) for name, expected, got in frames]


def _compare(name: str, expected: Pixels, got: Pixels, limits: Limits, per_degree: float) -> Compared:
    if expected.shape != got.shape:
        sizes = [f"{pixels.shape[1]}x{pixels.shape[0]}" for pixels in (expected, got)]
        raise BadInput(f"the picture {name}", expected=f"a size of {sizes[0]}", seen=sizes[1])
    if np.array_equal(expected, got):
        return Compared(name, expected, got, np.zeros(expected.shape[:2]), 0.0, 0.0, True)
    difference = flip(expected, got, per_degree)
    mean, tile = float(difference.mean()), _worst_tile(difference)
    return Compared(name, expected, got, difference, mean, tile, mean <= limits.mean and tile <= limits.tile)


def _worst_tile(difference: NDArray[np.float64]) -> float:
    """The largest mean of a tile, tiles overlapping by half so that none cuts a fault in two."""
    side = [min(TILE_PX, length) for length in difference.shape]
    sums = np.zeros((difference.shape[0] + 1, difference.shape[1] + 1))
    sums[1:, 1:] = difference.cumsum(0).cumsum(1)
    half = [max(length // 2, 1) for length in side]
    y, x = (np.arange(0, difference.shape[i] - side[i] + 1, half[i]) for i in (0, 1))
    y, x = (np.union1d(at, [difference.shape[i] - side[i]]) for i, at in ((0, y), (1, x)))
    low, high = sums[y], sums[y + side[0]]
    inside = high[:, x + side[1]] - high[:, x] - low[:, x + side[1]] + low[:, x]
    return float(inside.max() / (side[0] * side[1]))


def cut_strip(pixels: Pixels, cell: tuple[int, int]) -> Sequence[Pixels]:
    """The frames of a film strip, row by row. cell: (width, height) of one. Raises BadInput where it does not fit."""
    width, height = cell
    if not (width > 0 and height > 0) or pixels.shape[0] % height or pixels.shape[1] % width:
        size = f"{pixels.shape[1]}x{pixels.shape[0]}"
        raise BadInput("--cell", expected=f"a size that divides the strip's {size}", seen=f"{width}x{height}")
    return [
        pixels[y : y + height, x : x + width]
        for y in range(0, pixels.shape[0], height)
        for x in range(0, pixels.shape[1], width)
    ]
