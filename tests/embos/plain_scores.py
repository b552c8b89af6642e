"""The factors of eq. 1 that the compiled loops work out, written down as plainly as the paper has them."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["difference", "phi_state", "phi_time", "presence"]


def phi_time(
    time_s: float, started_s: float, duration_s: float, waiting_s: float, minimum: float = 0.02, steady: float = 0.5
) -> float:
    """1 while t₀ ≤ t ≤ t₀ + L_d, minimum while t₀ + L_d < t ≤ t₀ + L_d + L_w, steady otherwise; t₀ −inf: never ran."""
    if started_s <= time_s <= started_s + duration_s:
        return 1.0
    return minimum if started_s <= time_s <= started_s + duration_s + waiting_s else steady


def difference(character: Sequence[float], intensity: Sequence[float]) -> float:
    """Σ_k i'_k·|i'_k − i_k| / Σ_k i'_k"""
    return sum(f * abs(f - i) for f, i in zip(character, intensity, strict=True)) / sum(character)


def presence(character: Sequence[float], exists: Sequence[float]) -> float:
    """Σ_k i'_k·σ_k / Σ_k i'_k"""
    return sum(f * e for f, e in zip(character, exists, strict=True)) / sum(character)


def phi_state(character: Sequence[float], units: Sequence[Sequence[float]]) -> list[float]:
    """(1 − d) · (n − rank + 1)/n of one layer's units, rank 1 = smallest d, equal d share the best rank."""
    d = [difference(character, intensity) for intensity in units]
    rank = [1 + sum(other < mine - 1e-12 for other in d) for mine in d]
    return [(1.0 - mine) * (len(d) - place + 1) / len(d) for mine, place in zip(d, rank, strict=True)]
