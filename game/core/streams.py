"""Chance as a function of (seed, purpose, counter): what one purpose draws never shifts what another does."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

__all__ = ["Draws", "Streams"]


class Draws(Protocol):
    """What rules ask of a source of chance; ``numpy.random.Generator`` is one."""

    def random(self) -> float: ...

    def standard_normal(self) -> float: ...


class Streams:
    """Philox 4x64-10 (Salmon et al. 2011) keyed by seed, purpose and counter.

    One generator is set anew for each stream, which costs a tenth of making one: ``at`` ends the stream given before.
    """

    def __init__(self) -> None:
        self._bits = np.random.Philox(key=0)
        self._generator = np.random.Generator(self._bits)
        self._start: Any = self._bits.state
        self._key: Any = self._start["state"]["key"]
        self._names: dict[str, int] = {}

    def at(self, seed: int, purpose: str, counter: int) -> np.random.Generator:
        """The stream of one purpose (its first four letters tell it from others), good until the next call."""
        name = self._names.get(purpose)
        if name is None:
            name = self._names[purpose] = int.from_bytes(purpose.encode("ascii")[:4], "big") << 32
        self._key[0] = name | counter
        self._key[1] = seed & 0xFFFFFFFF
        self._bits.state = self._start
        return self._generator

    def __reduce__(self) -> tuple[type[Streams], tuple[()]]:
        return Streams, ()
