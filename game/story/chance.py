"""Chance as a function of (seed, counter): nothing to carry but two integers, so a save holds all of it."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from functools import lru_cache
from typing import Generic, Protocol, TypeVar

__all__ = ["Lots", "pick_weighted", "shuffled", "uniform", "uniforms"]

_MASK = (1 << 64) - 1
_STEP = 0x9E3779B97F4A7C15
_UNIT = 1.0 / (1 << 53)


def uniform(seed: int, counter: int) -> float:
    """A number in [0, 1) by SplitMix64 (Steele, Lea, Flood 2014) at position ``counter`` of stream ``seed``."""
    z = (seed * 0xD1342543DE82EF95 + (counter + 1) * _STEP) & _MASK
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & _MASK
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & _MASK
    return ((z ^ (z >> 31)) >> 11) * _UNIT


_LANE_BITS = 128
_MOST_LANES = 16
_LANES = tuple(
    (
        sum(1 << _LANE_BITS * lane for lane in range(count)),
        sum((lane + 1) * _STEP << _LANE_BITS * lane for lane in range(count)),
        sum(_MASK << _LANE_BITS * lane for lane in range(count)),
        struct.Struct("<" + "Q8x" * count),
    )
    for count in range(_MOST_LANES + 1)
)
"""By count: ones, steps and masks in lanes of 128 bits, and how they are read."""


def uniforms(seed: int, counter: int, count: int) -> list[float]:
    """``uniform`` at ``count`` positions from ``counter`` on (0 to 16): all of them in the lanes of one whole number,
    which has room for every product, at a quarter of the price of one after the other."""
    ones, steps, masks, lanes = _LANES[count]
    z = ((seed * 0xD1342543DE82EF95 + counter * _STEP & _MASK) * ones + steps) & masks
    z = ((z ^ (z >> 30 & masks)) * 0xBF58476D1CE4E5B9) & masks
    z = ((z ^ (z >> 27 & masks)) * 0x94D049BB133111EB) & masks
    z ^= z >> 31 & masks
    return [(lane >> 11) * _UNIT for lane in lanes.unpack(z.to_bytes(lanes.size, "little"))]


def pick_weighted(weights: Sequence[float], chance: float) -> int:
    """Index drawn in proportion to the weights (all > 0) by one number in [0, 1)."""
    left = chance * sum(weights)
    for index, weight in enumerate(weights):
        left -= weight
        if left < 0:
            return index
    return len(weights) - 1


class Weighted(Protocol):
    """Something with a weight above 0."""

    @property
    def weight(self) -> float: ...


Item = TypeVar("Item", bound=Weighted)


class Lots(Generic[Item]):
    """Things to draw from; ``only``: the one thing where there is no more than one."""

    __slots__ = ("_even", "_weights", "items", "only")

    def __init__(self, items: Sequence[Item]) -> None:
        self.items = tuple(items)
        self.only = self.items[0] if len(self.items) == 1 else None
        self._weights = tuple([item.weight for item in items])
        self._even = len(self.items) if all(weight == 1.0 for weight in self._weights) else 0

    def draw(self, chance: float) -> Item:
        """As ``pick_weighted``, by one number in [0, 1)."""
        if self._even:
            # Taking ones away from a small number is exact, so that this is the same to the last bit.
            at = int(chance * self._even)
            return self.items[at if at < self._even else -1]
        return self.items[pick_weighted(self._weights, chance)]


def shuffled(count: int, chances: Sequence[float]) -> Sequence[int]:
    """0..count−1 in random order (Fisher–Yates), by count − 1 numbers in [0, 1)."""
    return _exchanged(count, *[int(chance * left) for chance, left in zip(chances, range(count, 1, -1), strict=False)])


@lru_cache(maxsize=4096)
def _exchanged(count: int, *others: int) -> tuple[int, ...]:
    """0..count−1 after the last was exchanged with one of others, then the last but one, and so on."""
    order = list(range(count))
    for last, other in zip(range(count - 1, 0, -1), others, strict=True):
        order[last], order[other] = order[other], order[last]
    return tuple(order)
