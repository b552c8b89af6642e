"""Printed and woven patterns of clothes: each a tile that repeats, kept as distances so that any size has sharp edges.

A vertex of patterned cloth says where on the cloth it lies, in tiles; the shader finds the motif's edge there and
makes the palette's colours a little lighter or darker inside it. What is too small to be seen becomes an even tone.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["ASPECT", "MOTIFS", "REACH", "tinted", "weave_distance", "weave_tiles"]

Floats = NDArray[np.floating[Any]]

TILE_PX = 64
REACH = 0.125
"""Distances within a tile are kept up to this far, in tile widths."""
_ROOT_3 = float(np.sqrt(3.0))


def _segment(u: Floats, v: Floats, a: tuple[float, float], b: tuple[float, float]) -> Floats:
    """Distance to a piece of a line."""
    way = np.subtract(b, a)
    share = np.clip(((u - a[0]) * way[0] + (v - a[1]) * way[1]) / (way @ way), 0.0, 1.0)
    return np.asarray(np.hypot(u - a[0] - share * way[0], v - a[1] - share * way[1]))


def _around(u: Floats, v: Floats, shape: Callable[[Floats, Floats], Floats], tall: float = 1.0) -> Floats:
    """The nearest of a shape's copies in this tile and in those beside it; shape: distance, negative outside."""
    copies = [shape(u - i, v - j * tall) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    return np.asarray(np.max(copies, axis=0))


def _dots(u: Floats, v: Floats) -> Floats:
    places = ((0.25, 0.25), (0.75, 0.75))
    return _around(u, v, lambda x, y: 0.115 - np.min([np.hypot(x - a, y - b) for a, b in places], axis=0))


def _leaves(u: Floats, v: Floats) -> Floats:
    """Three leaves around a point, in every second place: a crest made small."""

    def one(x: Floats, y: Floats, turn: float) -> Floats:
        spokes = [turn + k * 2.0 * np.pi / 3.0 for k in range(3)]
        ways = [(np.cos(a), np.sin(a)) for a in spokes]
        return np.asarray(np.min([_segment(x, y, (0.07 * c, 0.07 * s), (0.13 * c, 0.13 * s)) for c, s in ways], axis=0))

    def pair(x: Floats, y: Floats) -> Floats:
        return 0.052 - np.minimum(one(x - 0.25, y - 0.25, np.pi / 2), one(x - 0.75, y - 0.75, np.pi / 2))

    return _around(u, v, pair)


def _hemp(u: Floats, v: Floats) -> Floats:
    """Hemp leaf (asanoha): equilateral triangles, each with three lines from its middle to its corners."""
    y = v * _ROOT_3
    nearest = np.full(np.shape(u), 1.0)
    for row in range(-1, 3):
        for column in range(-2, 3):
            a = (column + 0.5 * (row % 2), row * _ROOT_3 / 2)
            b, top, low = (a[0] + 1.0, a[1]), (a[0] + 0.5, a[1] + _ROOT_3 / 2), (a[0] + 0.5, a[1] - _ROOT_3 / 2)
            for tip in (top, low):
                middle = ((a[0] + b[0] + tip[0]) / 3.0, (a[1] + b[1] + tip[1]) / 3.0)
                for start, end in ((a, b), (a, tip), (b, tip), (middle, a), (middle, b), (middle, tip)):
                    nearest = np.minimum(nearest, _segment(u, y, start, end))
    return np.asarray(0.020 - nearest)


def _knit(u: Floats, v: Floats) -> Floats:
    """Stitches: two columns of slanted loops."""

    def loops(x: Floats, y: Floats) -> Floats:
        found = []
        for left in (0.25, 0.75):
            for low in (0.0, 0.5):
                found += [_segment(x, y, (left, low), (left + way, low + 0.30)) for way in (-0.20, 0.20)]
        return np.asarray(0.045 - np.min(found, axis=0))

    return _around(u, v, loops)


def _twill(u: Floats, v: Floats) -> Floats:
    """Fine slanting ribs."""
    across = (u + v) * 2.0
    return np.asarray(0.10 - np.abs(across - np.rint(across)) / (2.0 * np.sqrt(2.0)))


def _herringbone(u: Floats, v: Floats) -> Floats:
    """Ribs that slant one way and the other in turn."""
    zigzag = np.abs(2.0 * (u - np.floor(u)) - 1.0) * 0.5
    across = (zigzag + v) * 4.0
    return np.asarray(0.052 - np.abs(across - np.rint(across)) / (4.0 * np.sqrt(2.0)))


MOTIFS: Mapping[str, Callable[[Floats, Floats], Floats]] = MappingProxyType(
    {
        "dots": _dots,
        "hemp": _hemp,
        "herringbone": _herringbone,
        "knit": _knit,
        "leaves": _leaves,
        "twill": _twill,
    }
)
"""Name -> distance to the motif's edge at u, v (0..1 across one tile), positive inside; in tile widths."""
ASPECT: Mapping[str, float] = MappingProxyType({name: _ROOT_3 if name == "hemp" else 1.0 for name in MOTIFS})
"""A tile's height for a width of 1."""


def weave_distance(motif: str, size: int = TILE_PX) -> Floats:
    """(size, size) distances within one tile, in tile widths, positive inside the motif; rows along v."""
    at = (np.arange(size) + 0.5) / size
    u, v = np.meshgrid(at, at)
    return MOTIFS[motif](u, v)


def weave_tiles(worn: Collection[int] = range(len(MOTIFS))) -> NDArray[np.uint8]:
    """(motifs, TILE_PX, TILE_PX): all motifs in order of name, distances of ±REACH as 0 to 255; blank those not
    ``worn``, which nobody looks at."""
    return np.stack(
        [_tile(name) if i in worn else np.zeros((TILE_PX, TILE_PX), np.uint8) for i, name in enumerate(MOTIFS)]
    )


@lru_cache(maxsize=16)
def _tile(name: str) -> NDArray[np.uint8]:
    share = np.clip(weave_distance(name) / (2.0 * REACH) + 0.5, 0.0, 1.0)
    return np.asarray(np.rint(share * 255.0), dtype=np.uint8)


def tinted(colour: Floats, strength: float) -> Floats:
    """A palette colour (..., 3) inside a motif, as woven.glsl makes it: lighter where strength is positive."""
    return np.asarray(np.clip(colour * (1.0 + strength) + 0.12 * max(strength, 0.0), 0.0, 1.0))
