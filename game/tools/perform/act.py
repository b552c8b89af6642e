"""What an act is: the time it takes to reach and to release, and how it is laid out; and the wave most repeats use."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.tools.perform.stage import Move

__all__ = ["Act", "pulse", "sine"]

Floats = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class Act:
    """A behaviour with a beginning and an end: seconds to reach and to release, and what happens in between."""

    reach_s: float
    release_s: float
    lay: Callable[[Move], None]


def sine(frequency_hz: float, t: Floats, lag_s: float = 0.0) -> Floats:
    """sin 2πf(t − lag)."""
    return np.asarray(np.sin(2.0 * np.pi * frequency_hz * (t - lag_s)))


def pulse(frequency_hz: float, t: Floats) -> Floats:
    """The upper halves of a sine."""
    return np.maximum(0.0, sine(frequency_hz, t))
