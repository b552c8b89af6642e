"""Seven values to Russell's circumplex: where an emotion stands in valence and arousal.

The places of the six are designers' estimates after Russell (1980) and the norms of Russell & Mehrabian (1977,
"Evidence for a three-factor theory of emotions"), rounded; neutral is the origin.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["PLACES", "to_valence_arousal"]

PLACES: NDArray[np.float64] = np.array(
    [
        [-0.51, 0.59],  # anger
        [-0.64, 0.60],  # fear
        [0.76, 0.48],  # joy
        [-0.63, -0.27],  # sadness
        [-0.60, 0.35],  # disgust
        [0.20, 0.75],  # surprise
        [0.0, 0.0],  # neutral
    ]
)
PLACES.setflags(write=False)


def to_valence_arousal(emotion: ArrayLike) -> NDArray[np.float64]:
    """(..., 7) -> (..., 2) valence and arousal in [-1, 1]: the places weighted by the values."""
    values = np.asarray(emotion, dtype=np.float64)
    total = np.maximum(values.sum(-1, keepdims=True), 1.0)
    return np.asarray(values @ PLACES / total)
