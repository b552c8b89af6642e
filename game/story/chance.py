"""Chance as a function of (seed, counter): nothing to carry but two integers, so a save holds all of it."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["pick_weighted", "shuffled", "uniform"]

_MASK = (1 << 64) - 1


def uniform(seed: int, counter: int) -> float:
    """A number in [0, 1) by SplitMix64 (Steele, Lea, Flood 2014) at position ``counter`` of stream ``seed``."""
    z = (seed * 0xD1342543DE82EF95 + (counter + 1) * 0x9E3779B97F4A7C15) & _MASK
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & _MASK
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & _MASK
    return ((z ^ (z >> 31)) >> 11) / (1 << 53)


def pick_weighted(weights: Sequence[float], chance: float) -> int:
    """Index drawn in proportion to the weights (all > 0) by one number in [0, 1)."""
    left = chance * sum(weights)
    for index, weight in enumerate(weights):
        left -= weight
        if left < 0:
            return index
    return len(weights) - 1


def shuffled(count: int, seed: int, counter: int) -> list[int]:
    """0..count−1 in random order (Fisher–Yates); uses the positions counter … counter + count − 2."""
    order = list(range(count))
    for step, last in enumerate(range(count - 1, 0, -1)):
        other = int(uniform(seed, counter + step) * (last + 1))
        order[last], order[other] = order[other], order[last]
    return order
