"""The light of the afternoon: where the sun stands, what it tints, how dark the shade is, when the lamps come on.

Palettes are hand-picked for half past two; other hours multiply them. Everything follows from the share of the
afternoon alone: 0 at 13:00, 1 at 18:00.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["DESIGN_SHARE", "STEPS", "Daylight", "daylight", "stepped"]

Floats = NDArray[np.floating[Any]]

DESIGN_SHARE = 0.3
"""The hour for which palettes and backdrops are painted: 14:30."""
STEPS = 80
"""The light changes in so many steps, 3¾ minutes each: between two steps the still picture stays as it is."""

_AT = np.array([0.0, DESIGN_SHARE, 0.7, 1.0])
# Each row: one value at each of _AT.
_SUN_AZIMUTH_DEG = np.array([-38.0, -43.919, -54.0, -66.0])  # from straight ahead of the person, to the left
_SUN_HEIGHT_DEG = np.array([54.0, 41.36, 25.0, 11.0])
_TINTS = {
    "lit": [(1.01, 1.02, 1.035), (1.0, 1.0, 1.0), (1.04, 0.91, 0.74), (0.97, 0.70, 0.53)],
    "shade": [(1.02, 1.03, 1.05), (1.0, 1.0, 1.0), (0.93, 0.82, 0.86), (0.60, 0.53, 0.76)],
    "deep": [(1.04, 1.04, 1.05), (1.0, 1.0, 1.0), (0.88, 0.76, 0.88), (0.50, 0.46, 0.76)],
    "rim": [(0.95, 1.0, 1.05), (1.0, 1.0, 1.0), (1.30, 0.98, 0.66), (1.45, 0.78, 0.50)],
    "sky": [(0.97, 1.0, 1.05), (1.0, 1.0, 1.0), (1.03, 0.86, 0.70), (0.58, 0.44, 0.62)],
    "horizon": [(1.0, 1.01, 1.02), (1.0, 1.0, 1.0), (1.05, 0.87, 0.66), (1.02, 0.62, 0.45)],
    "ground": [(1.01, 1.01, 1.02), (1.0, 1.0, 1.0), (1.02, 0.87, 0.70), (0.64, 0.50, 0.58)],
}
_LAMPS = np.array([0.0, 0.0, 0.30, 1.0])


@dataclass(frozen=True, eq=False)
class Daylight:
    """sun: unit vector toward it. lit, shade, deep, rim: factors (3,) on palette colours by tone; sky, horizon,
    ground: factors (3,) on the painted backdrop from its top over eye level to its foot; lamps: 0 out to 1 bright."""

    share: float
    sun: Floats
    lit: Floats
    shade: Floats
    deep: Floats
    rim: Floats
    sky: Floats
    horizon: Floats
    ground: Floats
    lamps: float


def stepped(share: float) -> float:
    """The share of the afternoon as the picture shows it: in STEPS, within 0 to 1."""
    return round(min(max(share, 0.0), 1.0) * STEPS) / STEPS


def daylight(share: float) -> Daylight:
    """The light at a share of the afternoon; shares outside 0 to 1 count as its ends."""
    share = min(max(share, 0.0), 1.0)
    azimuth, height = (np.radians(np.interp(share, _AT, row)) for row in (_SUN_AZIMUTH_DEG, _SUN_HEIGHT_DEG))
    flat = np.cos(height)
    sun = np.array([np.sin(azimuth) * flat, np.sin(height), np.cos(azimuth) * flat])
    tints = {
        name: np.array([np.interp(share, _AT, column) for column in np.array(rows).T]) for name, rows in _TINTS.items()
    }
    return Daylight(share=share, sun=sun, lamps=float(np.interp(share, _AT, _LAMPS)), **tints)
