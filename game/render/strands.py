"""Strands of hair: each in a tone of its own, its highlight a little higher or lower than its neighbour's.

Curls that grow together over a whole head are no strand: they keep the palette's tone.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.render.coarse import loose_pieces

__all__ = ["strand_terms"]

_TONE = (-0.10, 0.06)
_SHIFT = 0.020
_WELD_M = 1e-5
_WHOLE_HEAD_M = 0.30
"""Sum of the standard deviations along the axes; a long lock's is 0.24, a head of curls' 0.34."""


def strand_terms(
    position: NDArray[np.float32], triangle: NDArray[np.uint32], hair: NDArray[np.floating[Any]]
) -> NDArray[np.float32]:
    """position (v, 3); triangle (t, 3); hair (v, 2): azimuth on the head in radians, height term of the highlight.

    Returns (v, 2): how much lighter the strand is than its palette, and the height term with the highlight's waves and
    the strand's own shift. A strand is what hangs together; its draws follow from where it is, so that all levels of
    detail agree.
    """
    grid = np.rint(position / _WELD_M).astype(np.int64)
    place = np.unique(grid @ np.array([1, 1 << 20, 1 << 40]), return_inverse=True)[1].ravel()
    strand = loose_pieces(place[triangle])[place]
    count = np.bincount(strand)
    middle, square = (
        np.stack([np.bincount(strand, values[:, i]) for i in range(3)], axis=1) / count[:, None]
        for values in (position, position.astype(np.float64) ** 2)
    )
    spread = np.sqrt(np.maximum(square - middle**2, 0.0)).sum(axis=1)
    apart = spread < _WHOLE_HEAD_M
    # Waves short enough that neighbours differ, long enough that a coarser mesh of the strand draws the same.
    one, other = (0.5 + 0.5 * np.sin(middle @ np.array(way)) for way in ((61.0, 43.0, 57.0), (-47.0, 67.0, 39.0)))
    tone = np.where(apart, _TONE[0] + (_TONE[1] - _TONE[0]) * one, 0.0)
    shift = np.where(apart, _SHIFT * (2.0 * other - 1.0), 0.0)
    azimuth, height = hair.T
    wave = 0.030 * np.sin(azimuth * 13.0) + 0.012 * np.sin(azimuth * 37.0 + 1.0)
    return np.stack([tone[strand], height + wave + shift[strand]], axis=1).astype(np.float32)
