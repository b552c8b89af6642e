"""Random numbers that depend on nothing but (seed, character, layer, how often that layer started, purpose).

A counter-based generator (splitmix64's finalizer as a hash, Steele, Lea, Flood 2014) has no state to share, so a
character's draws are the same alone and in a crowd, in any order, and after loading a save. What a unit draws when it
starts is drawn by the compiled loops, in the same way: ``plan/draws.c``.
"""

from __future__ import annotations

from math import erf, sqrt

import numpy as np
from numpy.typing import NDArray

__all__ = ["NORMAL", "SHARE", "character_keys", "uniform"]

Words = NDArray[np.uint64]
Floats = NDArray[np.float64]

_GOLDEN = 0x9E3779B97F4A7C15
_FARTHEST = 3.0
"""Standard deviations at which a normal draw is cut: no posture lasts ten times its length."""
NORMAL = np.linspace(-_FARTHEST, _FARTHEST, 1201)
"""The normal distribution's quantiles between the cuts as a table, exact to 1e-5 …"""
SHARE = np.array([0.5 + 0.5 * erf(x / sqrt(2.0)) for x in NORMAL])
"""… and what lies below each."""
NORMAL.setflags(write=False)
SHARE.setflags(write=False)


def _mix(x: Words) -> Words:
    x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return np.asarray(x ^ (x >> np.uint64(31)))


def character_keys(seed: int, first: int, count: int) -> Words:
    """(count,) keys of characters first, first + 1, … under a seed."""
    number = np.arange(first + 1, first + 1 + count, dtype=np.uint64) * np.uint64(_GOLDEN)
    start = np.full(count, (seed * _GOLDEN + 1) & 0xFFFFFFFFFFFFFFFF, dtype=np.uint64)
    return _mix(_mix(start) ^ number)


def uniform(keys: Words, layer: NDArray[np.intp], started: NDArray[np.int64], count: int) -> Floats:
    """(S, count) draws in (0, 1) for S events; count at most 8."""
    event = started.astype(np.uint64) * np.uint64(64) + layer.astype(np.uint64) * np.uint64(8)
    counter = event[:, None] + np.arange(1, count + 1, dtype=np.uint64)
    bits = _mix(_mix(keys[:, None] ^ (counter * np.uint64(_GOLDEN))))
    return ((bits >> np.uint64(11)).astype(np.float64) + 0.5) * 2.0**-53
