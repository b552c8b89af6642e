"""The four factors of eq. 1 (Hattori, Nakano, Hoshino: EMBOS, section 3.3), one function each.

The next unit of a layer is ``argmax over m of  ω_c(m_d, m) · ω_l(m, m_u) · φ_time(m, t) · φ_state(m, t)``.
Everything broadcasts over leading axes, so one character and a thousand take the same path.
"""

from __future__ import annotations

from collections.abc import Set
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["continuity", "difference", "linkage", "phi_state", "phi_time", "presence", "rank_share", "ranks"]

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


def phi_time(
    time_s: ArrayLike,
    started_s: ArrayLike,
    duration_s: ArrayLike,
    waiting_s: ArrayLike,
    *,
    minimum: float = 0.02,
    steady: float = 0.5,
) -> Floats:
    """φ_time: 1 while t₀ ≤ t ≤ t₀ + L_d, minimum while t₀ + L_d < t ≤ t₀ + L_d + L_w, steady otherwise.

    started_s: t₀ in seconds, −inf where the unit never ran. Arguments broadcast.
    """
    t, t0 = np.asarray(time_s, dtype=np.float64), np.asarray(started_s, dtype=np.float64)
    end = t0 + np.asarray(duration_s, dtype=np.float64)
    wait_end = end + np.asarray(waiting_s, dtype=np.float64)
    ran = t0 <= t
    return np.where(ran & (t <= end), 1.0, np.where(ran & (t <= wait_end), minimum, steady))


def difference(character: Floats, intensity: Floats) -> Floats:
    """d of φ_state: ``Σ_k i'_k·|i'_k − i_k| / Σ_k i'_k``; what is not felt does not count.

    character: (..., 7); intensity: (M, 7) -> (..., M) in [0, 1]. Σ is never below 1, by eq. 4.
    """
    felt = character[..., None, :]
    total = np.maximum(character.sum(axis=-1), 1e-12)[..., None]
    return np.asarray((felt * np.abs(felt - intensity)).sum(axis=-1) / total)


def ranks(d: Floats) -> NDArray[np.intp]:
    """Rank of each d within the last axis, 1 = smallest, equal values share the best rank. (..., M) -> (..., M).

    Differences below 1e-12 are rounding, not rank.
    """
    level = np.round(d, 12)
    order = np.argsort(level, axis=-1, kind="stable")
    in_order = np.take_along_axis(level, order, axis=-1)
    place = np.zeros(d.shape, dtype=np.intp)
    place[..., 1:] = np.where(in_order[..., 1:] > in_order[..., :-1], np.arange(1, d.shape[-1]), 0)
    np.maximum.accumulate(place, axis=-1, out=place)
    result = np.empty_like(place)
    np.put_along_axis(result, order, place + 1, axis=-1)
    return result


def rank_share(d: Floats, count: ArrayLike) -> Floats:
    """``(1 − d) · (n − rank + 1)/n`` over the last axis; entries with d = inf are no units and get 0."""
    n = np.asarray(count, dtype=np.float64)
    near = 1.0 - np.minimum(d, 1.0)
    return np.asarray(near * np.maximum(n - ranks(d) + 1.0, 0.0) / n)


def phi_state(character: Floats, intensity: Floats) -> Floats:
    """φ_state of the M units of one layer: ``(1 − d)·(n − rank + 1)/n`` (SPEC 3).

    character: (..., 7); intensity: (M, 7) -> (..., M) in [0, 1].
    """
    return rank_share(difference(character, intensity), len(intensity))


def presence(character: Floats, exists: NDArray[Any]) -> Floats:
    """The share of what is felt in which a unit was ever seen: ``Σ_k i'_k·σ_k / Σ_k i'_k``.

    1 for an own unit of a pure emotion, 0 for a foreign one (whose φ_state is 0 there anyway). It decides in
    mixed emotions: at joy ½, anger ½ the difference d alone cannot tell a unit of pure joy (d = ½) from one
    that neither ever showed (d = ½). character: (..., 7); exists: (M, 7) 0 or 1 -> (..., M) in [0, 1].
    """
    total = np.maximum(character.sum(axis=-1), 1e-12)[..., None]
    return np.asarray((character[..., None, :] * exists).sum(axis=-1) / total)
