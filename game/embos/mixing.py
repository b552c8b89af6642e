"""Mixing the variants of one behaviour for an in-between emotion (EMBOS, section 5.1, eq. 5)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["RADIUS", "mix", "mix_weights"]

Floats = NDArray[np.float64]

RADIUS = 0.5
"""r of the radial basis function."""

_FAR = -1e12
_LOWEST_LOG = -600.0
"""Relative weights below exp(this) are kept there: they are nothing, and must not underflow."""


def mix_weights(character: Floats, intensity: Floats, exists: NDArray[Any], radius: float = RADIUS) -> Floats:
    """Normalised ``σ_k·Γ_k`` of eq. 5, radial over the whole emotion space.

    Variant k sits at the unit's intensity i_k on axis k and at 0 on the other six, so the squared distance is
    ``|i'|² − i'_k² + (i'_k − i_k)²``. Logarithms keep far-away emotions from dividing by zero.
    character, intensity, exists (σ): (..., 7), broadcasting -> (..., 7), sums to 1, or all 0 without a variant.
    """
    has = np.asarray(exists, dtype=bool)
    # |i'|² is the same for every k and falls out of the quotient; i_k² − 2·i'_k·i_k is left of the distance.
    log = (2.0 * character - intensity) * intensity
    log *= 1.0 / (radius * radius)
    log = np.where(has, log, _FAR)
    log -= log.max(axis=-1, keepdims=True)
    weight = np.exp(np.maximum(log, _LOWEST_LOG, out=log))
    weight *= has
    weight /= np.maximum(weight.sum(axis=-1, keepdims=True), 1e-300)
    return weight


def mix(values: Floats, weights: Floats) -> Floats:
    """``Σ_k v_k·w_k`` for scalars per emotion such as L_d and L_w: (..., 7), (..., 7) -> (...)."""
    return np.asarray((values * weights).sum(axis=-1))
