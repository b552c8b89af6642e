"""Triangles of the face drawing: fills as vertex grids, strokes of varying width with soft edges.

A Sheet collects fills and strokes and tessellates all strokes together in one pass over a flat array, whatever their
lengths; index arrays depend only on the shapes' sizes and are kept. Positions are mm, colours premultiplied
sRGB-encoded rgba in 0..1.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["FEATHER_MM", "DrawList", "Layer", "Sheet", "bezier", "ink", "polar", "ribbons"]

Floats = NDArray[np.float64]
Ints = NDArray[np.uint32]
Points = NDArray[np.floating[Any]]
Shapes = tuple[tuple[int, int, int], ...]
Runs = tuple[tuple[int, int], ...]
FEATHER_MM = 0.75  # about one pixel of a 512² texture over 340 mm


@dataclass(frozen=True)
class Layer:
    """One list of triangles: position (n, 2) float32 mm, colour (n, 4) float32 premultiplied, triangle (m, 3) uint32.

    Triangles are in painting order (later ones lie on top), of either winding. Blend with ONE, ONE_MINUS_SRC_ALPHA.
    The triangle array is read-only and the same object for expressions of the same make-up.
    """

    position: NDArray[np.float32]
    colour: NDArray[np.float32]
    triangle: Ints


@dataclass(frozen=True)
class DrawList:
    """``under`` is painted into the skin; ``over`` (lashes, brows, vein, sweat) once more over the hair."""

    under: Layer
    over: Layer


@dataclass
class _Pass:
    """Fills, then strokes over them; those that also belong over the hair are kept apart and come last."""

    fills: list[tuple[Floats, Floats]] = field(default_factory=list)
    over_fills: list[tuple[Floats, Floats]] = field(default_factory=list)
    strokes: list[tuple[Floats, Floats, Floats]] = field(default_factory=list)
    over_strokes: list[tuple[Floats, Floats, Floats]] = field(default_factory=list)


@dataclass
class Sheet:
    """Collects shapes in two passes (``late`` ones are painted after all others)."""

    early: _Pass = field(default_factory=_Pass)
    late: _Pass = field(default_factory=_Pass)

    def grid(self, position: Floats, colour: Floats, *, late: bool = False, over: bool = False) -> None:
        """Fill: position (B, m, n, 2) mm, colour (B, m, n, 4) premultiplied."""
        target = self.late if late else self.early
        (target.over_fills if over else target.fills).append((position, colour))

    def layer(self) -> Layer:
        """Everything as one layer."""
        return self.draw_list().under

    def draw_list(self) -> DrawList:
        """All shapes under, the ``over`` shapes once more for the hair."""
        position: list[Points] = []
        colour: list[Points] = []
        over_position: list[Points] = []
        over_colour: list[Points] = []
        make_up: list[tuple[Shapes, Runs]] = []
        over_make_up: list[tuple[Shapes, Runs]] = []
        for part in (self.early, self.late):
            fills = part.fills + part.over_fills
            for grid, shades in fills:
                position.append(grid.reshape(-1, 2))
                colour.append(shades.reshape(-1, 4))
            for grid, shades in part.over_fills:
                over_position.append(grid.reshape(-1, 2))
                over_colour.append(shades.reshape(-1, 4))
            strokes = part.strokes + part.over_strokes
            runs: Runs = tuple((len(s[0]), s[0].shape[1]) for s in strokes)
            over_runs: Runs = runs[len(part.strokes) :]
            if strokes:
                place, shade = _stroke(strokes, runs)
                position.append(place)
                colour.append(shade)
                if over_runs:
                    first = 4 * sum(b * n for b, n in runs[: len(part.strokes)])
                    over_position.append(place[first:])
                    over_colour.append(shade[first:])
            make_up.append((tuple(f[0].shape[:3] for f in fills), runs))
            over_make_up.append((tuple(f[0].shape[:3] for f in part.over_fills), over_runs))
        return DrawList(_join(position, colour, tuple(make_up)), _join(over_position, over_colour, tuple(over_make_up)))


def _join(
    position: list[NDArray[np.float32]], colour: list[NDArray[np.float32]], make_up: tuple[tuple[Shapes, Runs], ...]
) -> Layer:
    if not position:
        return Layer(np.zeros((0, 2), np.float32), np.zeros((0, 4), np.float32), np.zeros((0, 3), np.uint32))
    return Layer(
        np.concatenate(position, dtype=np.float32, casting="same_kind"),
        np.concatenate(colour, dtype=np.float32, casting="same_kind"),
        _triangles(make_up),
    )


@lru_cache(maxsize=48)  # 32 KB each: enough for a face that changes, not for every face there is
def _triangles(make_up: tuple[tuple[Shapes, Runs], ...]) -> Ints:
    """Read-only vertex numbers (m, 3) of passes of grids and strokes laid out one after the other."""
    pieces: list[Ints] = []
    start = 0
    for shapes, runs in make_up:
        # A stroke of n points is a grid of n × 4 vertices.
        for batch, rows, columns in (*shapes, *((b, n, 4) for b, n in runs)):
            first = start + np.arange(batch * rows * columns, dtype=np.uint32).reshape(batch, rows, columns)
            a, b, c, d = first[:, :-1, :-1], first[:, :-1, 1:], first[:, 1:, :-1], first[:, 1:, 1:]
            pieces.append(np.stack([a, b, c, b, d, c], axis=-1).reshape(-1, 3).astype(np.uint32))
            start += batch * rows * columns
    result = np.concatenate(pieces) if pieces else np.zeros((0, 3), np.uint32)
    result.setflags(write=False)
    return result


@lru_cache(maxsize=128)
def _neighbours(runs: Runs) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """For the points of strokes laid end to end: the point before, the point after, the stroke's number."""
    size = np.concatenate([np.full(b, n) for b, n in runs])
    number = np.repeat(np.arange(len(size)), size)
    first = np.concatenate([[0], np.cumsum(size)[:-1]])[number]
    last = first + size[number] - 1
    here = np.arange(int(size.sum()))
    result = (np.maximum(here - 1, first), np.minimum(here + 1, last), number)
    for array in result:
        array.setflags(write=False)
    return result


def _stroke(
    strokes: list[tuple[Floats, Floats, Floats]], runs: Runs
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Tessellate strokes: vertices (4·points, 2) and colours (4·points, 4); across: clear, solid, solid, clear.

    Where a stroke is thinner than the feather it fades instead of vanishing, so hairlines do not flicker.
    """
    before, after, number = _neighbours(runs)
    point = np.concatenate([s[0].reshape(-1, 2) for s in strokes])
    width = np.concatenate([s[1].reshape(-1) for s in strokes])
    colour = np.concatenate([s[2] for s in strokes])[number]
    step = point[after] - point[before]
    length = np.sqrt(step[:, 0] * step[:, 0] + step[:, 1] * step[:, 1])
    length += 1e-9
    normal = np.empty_like(step)
    normal[:, 0] = -step[:, 1]
    normal[:, 1] = step[:, 0]
    normal /= length[:, None]
    inner = np.maximum(width - FEATHER_MM, 0.0)
    inner *= 0.5
    fade = np.minimum(width * (1.0 / FEATHER_MM), 1.0)
    near = normal * inner[:, None]
    far = normal * (inner + FEATHER_MM * np.minimum(fade + 0.25, 1.0))[:, None]
    position = np.empty((len(point), 4, 2), np.float32)
    position[:, 0] = point - far
    position[:, 1] = point - near
    position[:, 2] = point + near
    position[:, 3] = point + far
    shade = np.zeros((len(point), 4, 4), np.float32)
    colour *= fade[:, None]
    shade[:, 1] = colour
    shade[:, 2] = colour
    return position.reshape(-1, 2), shade.reshape(-1, 4)


def ribbons(
    sheet: Sheet, centre: Floats, width: ArrayLike, colour: Floats, *, late: bool = False, over: bool = False
) -> None:
    """Strokes: centre (B, n, 2) mm; width broadcastable to (B, n) mm; colour (B, 4) premultiplied.

    Strokes with alpha 0 are left out.
    """
    alpha = colour[:, 3].tolist()
    if max(alpha) <= 1e-3:
        return
    size = np.empty(centre.shape[:2])
    size[...] = width
    if min(alpha) <= 1e-3:
        seen = colour[:, 3] > 1e-3
        centre, size, colour = centre[seen], size[seen], colour[seen]
    target = sheet.late if late else sheet.early
    (target.over_strokes if over else target.strokes).append((centre, size, colour))


@lru_cache(maxsize=64)
def _bernstein(samples: int) -> Floats:
    t = np.linspace(0.0, 1.0, samples)
    s = 1.0 - t
    basis = np.stack([s**3, 3 * t * s**2, 3 * t**2 * s, t**3], axis=-1)
    basis.setflags(write=False)
    return basis


def bezier(control: ArrayLike, samples: int = 24) -> Floats:
    """Cubic curves: control (..., 4, 2) -> points (..., samples, 2)."""
    return np.asarray(_bernstein(samples) @ np.asarray(control, dtype=np.float64))


@lru_cache(maxsize=128)
def ink(code: str) -> Floats:
    """``#RRGGBB`` -> opaque (4,) sRGB-encoded; times an alpha it is premultiplied. Read-only."""
    colour = np.array([int(code[i : i + 2], 16) / 255.0 for i in (1, 3, 5)] + [1.0])
    colour.setflags(write=False)
    return colour


@lru_cache(maxsize=32)
def polar(rings: tuple[float, ...], sectors: int) -> Floats:
    """Unit polar grid (len(rings), sectors + 1, 2), read-only; the last column repeats the first."""
    angle = np.linspace(0.0, 2.0 * np.pi, sectors + 1)
    grid = np.array(rings)[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    grid.setflags(write=False)
    return np.asarray(grid)
