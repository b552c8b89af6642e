"""The outer shape of a body, clothes and beard included: what hands that are bigger than the reference's stay out of.

Each region (REGIONS) has the radius of its outermost surface about an upright axis through its joint, by height and
by direction; skin/clear.c looks it up.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation.body_size import REGIONS

__all__ = ["COLUMNS", "ROWS", "BodyShape", "measure_shape"]

Floats = NDArray[np.floating[Any]]

ROWS, COLUMNS = 16, 32
_OVERLAP_M = 0.05
"""Regions of the trunk overlap by this much where it bends."""
_UNDER_M = {"hips": 0.10, "head": 0.03}
"""How far below its joint a region begins; what is lower has no shape."""
_QUANTILE = {"head": 0.75}
"""Curls give way: a head's surface is this quantile of what lies in a direction, a trunk's nearly the outermost."""
_OUTER = 0.9
_LAYER = 0.8
"""What lies nearer to the axis than this share of the outermost is another layer."""
_SAMPLES = ((0.34, 0.33), (0.8, 0.1), (0.1, 0.8), (0.1, 0.1))
"""Points of a triangle: the shares of its first two corners."""


@dataclass(frozen=True, eq=False)
class BodyShape:
    """By region of REGIONS: centre (3,) of the lowest row from the region's joint, height (m) of all rows together,
    radius (ROWS, COLUMNS) metres."""

    centre: Mapping[str, Floats]
    height: Mapping[str, float]
    radius: Mapping[str, Floats]


def turn_share(x: Floats, z: Floats) -> Floats:
    """The direction from the axis as a share of a whole turn, in [0, 1): 0 is ahead, 1/4 to the left. Even along a
    square about the axis, which needs no arc tangent."""
    t = x / np.maximum(np.abs(x) + np.abs(z), 1e-9)
    return np.asarray(np.where(z >= 0.0, t, 2.0 - t) / 4.0 % 1.0)


def measure_shape(
    position: Floats, triangle: NDArray[np.integer[Any]], region: NDArray[np.intp], places: Mapping[str, Floats]
) -> BodyShape:
    """position: (v, 3) of a mesh in its T-pose, metres; triangle: (t, 3); region: (v,) of REGIONS each vertex belongs
    to, -1 for none; places: joint -> (3,). Regions with nothing on them are left out."""
    shares = np.array([(a, b, 1.0 - a - b) for a, b in _SAMPLES])
    owner, head_region = region[triangle], REGIONS.index("head")
    on_head, on_trunk = (owner == head_region).all(axis=1), ((owner >= 0) & (owner != head_region)).all(axis=1)
    head, trunk = (np.tensordot(position[triangle[own]], shares, (1, 1)).swapaxes(1, 2) for own in (on_head, on_trunk))
    order = ("hips", "spine", "chest", "head")
    levels = {r: float(places[r][1]) for r in order} | {
        "top": float(position[region == head_region, 1].max(initial=0.0))
    }
    centre, height, radius = {}, {}, {}
    for name, above in zip(order, (*order[1:], "top"), strict=True):
        low = levels[name] - _UNDER_M.get(name, _OVERLAP_M)
        high = levels[above] + (0.0 if name in ("chest", "head") else _OVERLAP_M)
        own = (head if name == "head" else trunk).reshape(-1, 3)
        own = own[(own[:, 1] >= low) & (own[:, 1] < high)]
        if len(own) < ROWS * COLUMNS:
            continue
        start = np.array([places[name][0], low, places[name][2]])
        centre[name] = start - places[name]
        height[name] = high - low
        radius[name] = _radii(own - start, high - low, _QUANTILE.get(name, _OUTER))
    return BodyShape(centre, height, radius)


def _radii(points: Floats, height: float, quantile: float) -> Floats:
    """(ROWS, COLUMNS): a quantile of the radii in each cell, gaps filled, a little smoothed."""
    row = np.clip(np.rint(points[:, 1] / height * (ROWS - 1)).astype(int), 0, ROWS - 1)
    column = np.rint(turn_share(points[:, 0], points[:, 2]) * COLUMNS).astype(int) % COLUMNS
    away = np.hypot(points[:, 0], points[:, 2])
    cell = row * COLUMNS + column
    sorted_ = np.lexsort((away, cell))
    cell, away = cell[sorted_], away[sorted_]
    first = np.searchsorted(cell, np.arange(ROWS * COLUMNS + 1))
    filled = np.full(ROWS * COLUMNS, np.nan)
    some = np.flatnonzero(np.diff(first))
    last = first[some + 1] - 1
    # Without the inner layers: of what is nearly as far out as the outermost.
    outer = away > _LAYER * np.repeat(away[last], np.diff(first)[some])
    count = np.add.reduceat(outer, first[some])
    filled[some] = away[last - np.floor((1.0 - quantile) * (count - 1)).astype(int)]
    grid = filled.reshape(ROWS, COLUMNS)
    while np.isnan(grid).any():
        around = np.stack([np.roll(grid, 1, 1), np.roll(grid, -1, 1), *_up_and_down(grid)])
        known = ~np.isnan(around)
        mean = np.where(known, around, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
        grid = np.where(np.isnan(grid) & known.any(axis=0), mean, grid)
    smooth = 0.5 * grid + 0.25 * (np.roll(grid, 1, 1) + np.roll(grid, -1, 1))
    up, down = _up_and_down(smooth)
    return np.asarray(0.5 * smooth + 0.25 * (up + down))


def _up_and_down(grid: Floats) -> tuple[Floats, Floats]:
    """The rows above and below each; the ends stay."""
    return np.vstack([grid[1:], grid[-1:]]), np.vstack([grid[:1], grid[:-1]])
