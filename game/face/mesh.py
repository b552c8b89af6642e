"""Triangles of the face drawing: grids, ribbons of varying width, soft ovals; everything is a batch of grids.

All shapes are laid out as ``(B, m, n)`` vertex grids (B shapes of one kind), so a whole kind is tessellated with a
handful of array operations. Positions are mm, colours premultiplied sRGB-encoded rgba in 0..1.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["FEATHER_MM", "DrawList", "Layer", "Sheet", "bezier", "discs", "rgb", "ribbons", "tint"]

Floats = NDArray[np.float64]
FEATHER_MM = 0.75  # about one pixel of a 512² texture over 340 mm


@dataclass(frozen=True)
class Layer:
    """One list of triangles: position (n, 2) float32 mm, colour (n, 4) float32 premultiplied, triangle (m, 3) uint32.

    Triangles are in painting order (later ones lie on top), of either winding. Blend with ONE, ONE_MINUS_SRC_ALPHA.
    """

    position: NDArray[np.float32]
    colour: NDArray[np.float32]
    triangle: NDArray[np.uint32]


@dataclass(frozen=True)
class DrawList:
    """``under`` is painted into the skin; ``over`` (lashes, brows, vein, sweat) once more over the hair."""

    under: Layer
    over: Layer


@lru_cache(maxsize=256)
def _grid_triangles(batch: int, rows: int, columns: int) -> NDArray[np.uint32]:
    """(batch·(rows−1)·(columns−1)·2, 3) read-only vertex numbers of a batch of grids."""
    first = np.arange(batch * rows * columns, dtype=np.uint32).reshape(batch, rows, columns)
    a, b = first[:, :-1, :-1], first[:, :-1, 1:]
    c, d = first[:, 1:, :-1], first[:, 1:, 1:]
    quads = np.stack([a, b, c, b, d, c], axis=-1).reshape(-1, 3)
    quads.setflags(write=False)
    return quads


@dataclass
class Sheet:
    """Collects grids in painting order and joins them to a Layer."""

    positions: list[Floats] = field(default_factory=list)
    colours: list[Floats] = field(default_factory=list)
    triangles: list[NDArray[np.uint32]] = field(default_factory=list)
    count: int = 0

    def grid(self, position: Floats, colour: Floats) -> None:
        """position (B, m, n, 2) or (m, n, 2); colour the same with 4 premultiplied channels."""
        if position.ndim == 3:
            position, colour = position[None], colour[None]
        batch, rows, columns, _ = position.shape
        self.positions.append(position.reshape(-1, 2))
        self.colours.append(colour.reshape(-1, 4))
        self.triangles.append(_grid_triangles(batch, rows, columns) + np.uint32(self.count))
        self.count += batch * rows * columns

    def layer(self) -> Layer:
        if not self.positions:
            return Layer(np.zeros((0, 2), np.float32), np.zeros((0, 4), np.float32), np.zeros((0, 3), np.uint32))
        return Layer(
            np.concatenate(self.positions).astype(np.float32),
            np.concatenate(self.colours).astype(np.float32),
            np.concatenate(self.triangles),
        )


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


def rgb(code: str) -> Floats:
    """``#RRGGBB`` -> (3,) in 0..1, sRGB-encoded."""
    return np.array([int(code[i : i + 2], 16) / 255.0 for i in (1, 3, 5)])


def tint(colour: ArrayLike, alpha: ArrayLike) -> Floats:
    """Premultiply: colour (..., 3) and alpha (...) -> (..., 4)."""
    a = np.clip(np.asarray(alpha, dtype=np.float64), 0.0, 1.0)[..., None]
    c = np.asarray(colour, dtype=np.float64)
    shape = np.broadcast_shapes(c.shape[:-1], a.shape[:-1])
    return np.concatenate([np.broadcast_to(c * a, (*shape, 3)), np.broadcast_to(a, (*shape, 1))], axis=-1)


def ribbons(sheet: Sheet, centre: Floats, width: ArrayLike, colour: Floats, feather: float = FEATHER_MM) -> None:
    """Strokes of varying width with soft edges.

    centre (B, n, 2) mm; width broadcastable to (B, n) mm; colour (B, 4) premultiplied. Where a stroke is thinner than
    the feather it fades instead of vanishing, so hairlines do not flicker. Strokes with alpha 0 are left out.
    """
    seen = colour[:, 3] > 1e-3
    if not seen.any():
        return
    w = np.broadcast_to(np.asarray(width, dtype=np.float64), centre.shape[:2])
    if not seen.all():
        centre, w, colour = centre[seen], w[seen], colour[seen]
    step = np.empty_like(centre)
    step[:, 1:-1] = centre[:, 2:] - centre[:, :-2]
    step[:, 0] = centre[:, 1] - centre[:, 0]
    step[:, -1] = centre[:, -1] - centre[:, -2]
    length = np.maximum(np.hypot(step[..., 0], step[..., 1]), 1e-9)
    normal = np.stack([-step[..., 1] / length, step[..., 0] / length], axis=-1)
    inner = np.maximum(w - feather, 0.0) / 2.0
    outer = inner + feather * np.minimum(w / feather + 0.25, 1.0)
    across = np.stack([-outer, -inner, inner, outer], axis=1)  # (B, 4, n)
    position = centre[:, None] + normal[:, None] * across[..., None]
    fade = np.minimum(w / feather, 1.0)
    solid = colour[:, None, :] * fade[..., None]
    clear = np.zeros_like(solid)
    sheet.grid(position, np.stack([clear, solid, solid, clear], axis=1))


@lru_cache(maxsize=32)
def _circle(sectors: int) -> Floats:
    angle = np.linspace(0.0, 2.0 * np.pi, sectors + 1)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    circle.setflags(write=False)
    return circle


def discs(centre: ArrayLike, radius: ArrayLike, rings: ArrayLike, sectors: int = 28) -> Floats:
    """Polar grids of ellipses: centre (B, 2), radius (B, 2), rings (m,) relative radii -> (B, m, sectors + 1, 2)."""
    c = np.asarray(centre, dtype=np.float64)[:, None, None, :]
    r = np.asarray(radius, dtype=np.float64)[:, None, None, :]
    return np.asarray(c + r * np.asarray(rings, dtype=np.float64)[None, :, None, None] * _circle(sectors)[None, None])
