"""From annotated takes to intensity, duration and waiting time (EMBOS, section 4; eq. 2 and 3)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["ALPHA", "competition_rank", "duration", "importance", "intensity", "spread", "universality", "waiting"]

Floats = NDArray[np.float64]

ALPHA = 0.3
"""Weight of importance against universality in eq. 2, as published."""


def universality(amount: ArrayLike) -> Floats:
    """``s_e(m) = amount_e(m) / Σ_k amount_k(m)``: how special the behaviour is to the emotion.

    amount: (M, 7) frames of postures or occurrences of mannerisms and gestures, >= 0 -> (M, 7), 0 where unseen.
    """
    a = np.asarray(amount, dtype=np.float64)
    total = a.sum(axis=1, keepdims=True)
    return a / np.where(total > 0, total, 1.0)


def importance(amount: ArrayLike) -> Floats:
    """The behaviour's share of all amounts of its layer in the emotion. (M, 7) -> (M, 7)."""
    a = np.asarray(amount, dtype=np.float64)
    total = a.sum(axis=0, keepdims=True)
    return a / np.where(total > 0, total, 1.0)


def competition_rank(values: Floats, among: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Rank of each value per column, 1 = largest, among the marked ones; equal values share the best rank.

    values, among: (M, E) -> (M, E); rows not marked get a meaningless rank. Values closer than 1e-12 are equal.
    """
    level = np.round(np.where(among, values, -np.inf), 12)
    return np.asarray(1 + (level[None, :, :] > level[:, None, :]).sum(axis=1), dtype=np.intp)


def intensity(amount: ArrayLike, alpha: float = ALPHA) -> Floats:
    """Eq. 2: ``i_e(m) = α·E(r) + (1 − α)·E(n)``, ``E(x) = (D − x + 1)/D``; 0 where the emotion never showed m.

    D behaviours of the layer are present in e; r ranks their importance, n their universality.
    amount: (M, 7) of one layer -> (M, 7) in [0, 1].
    """
    a = np.asarray(amount, dtype=np.float64)
    present = a > 0
    count = np.maximum(present.sum(axis=0), 1)  # D
    r = competition_rank(importance(a), present)
    n = competition_rank(universality(a), present)
    value = alpha * (count - r + 1) / count + (1.0 - alpha) * (count - n + 1) / count
    return np.where(present, value, 0.0)


def duration(lengths_s: ArrayLike) -> float:
    """L_d: the mean span length in one emotion, seconds; 0 where there is none."""
    lengths = np.asarray(lengths_s, dtype=np.float64)
    return float(lengths.mean()) if lengths.size else 0.0


def waiting(lengths_s: ArrayLike, annotated_s: float) -> float:
    """Eq. 3: ``L_w = (L_e − ΣL_d)/ΣL_d · mean(L_d)``, seconds, never below 0.

    annotated_s: L_e, the take's length less what is not annotated with any posture. A unit that restarts
    whenever it may is then on stage for the same share of time as in the take.
    """
    lengths = np.asarray(lengths_s, dtype=np.float64)
    total = float(lengths.sum())
    if total <= 0.0:
        return 0.0
    return max(0.0, (annotated_s - total) / total * duration(lengths))


def spread(lengths_by_emotion_s: Sequence[ArrayLike]) -> float:
    """Coefficient of variation of span lengths around their own emotion's mean, pooled; 0..1."""
    squares, freedom = 0.0, 0
    for lengths_s in lengths_by_emotion_s:
        lengths = np.asarray(lengths_s, dtype=np.float64)
        if lengths.size > 1:
            squares += float(((lengths / lengths.mean() - 1.0) ** 2).sum())
            freedom += lengths.size - 1
    return min(1.0, (squares / freedom) ** 0.5) if freedom else 0.0
