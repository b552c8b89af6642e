"""The two static factors of eq. 1 (Hattori, Nakano, Hoshino: EMBOS, section 3.3), ω_c and ω_l.

The next unit of a layer is ``argmax over m of  ω_c(m_d, m) · ω_l(m, m_u) · φ_time(m, t) · φ_state(m, t)``. The two
that change with time and feeling are worked out by the compiled loops: ``plan/judging.c``, ``plan/feeling.c``.
"""

from __future__ import annotations

from collections.abc import Set

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["continuity", "linkage"]

Floats = NDArray[np.float64]

_LOWEST_LOG = -600.0
"""exp() of less is of no use to anyone and would underflow."""


def continuity(
    transitions: ArrayLike, pose_distance: ArrayLike, *, floor: float, transition_share: float, sigma: float
) -> Floats:
    """ω_c: how likely b follows a (static).

    transitions: (M, M) counts of b after a in the takes, >= 0; pose_distance: (M, M) from the end of a to the
    start of b, any unit, sigma in the same. -> (M, M) in [floor, 1], the diagonal 1:
    ``floor + (1 − floor)·(λ·P(b|a)/max_b P(b|a) + (1 − λ)·exp(−distance/σ))`` with P(b|a) add-one smoothed.
    """
    counts = np.asarray(transitions, dtype=np.float64) + 1.0  # add-one smoothing
    np.fill_diagonal(counts, 0.0)  # a unit does not compete with itself: ω_c(a, a) = 1 below
    likely = counts / np.maximum(counts.max(axis=-1, keepdims=True), 1.0)
    near = np.exp(np.maximum(-np.asarray(pose_distance, dtype=np.float64) / sigma, _LOWEST_LOG))
    omega = floor + (1.0 - floor) * (transition_share * likely + (1.0 - transition_share) * near)
    np.fill_diagonal(omega, 1.0)
    return np.asarray(omega)


def linkage(uses: Set[str], locks: Set[str], above_uses: Set[str], above_locks: Set[str]) -> int:
    """ω_l: 0 where a unit and one above it want the same body part, else 1 (static).

    ``uses(m) ∩ (uses(m_u) ∪ locks(m_u))`` or ``locks(m) ∩ uses(m_u)`` not empty -> 0.
    """
    return 0 if uses & (above_uses | above_locks) or locks & above_uses else 1
