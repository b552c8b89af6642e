"""The emotion space of the paper (section 3.1): six independent emotions and a derived neutral.

The order is fixed: anger, fear, joy, sadness, disgust, surprise, neutral. Characters and motion units live in
the same space. ``neutral`` is never stored; it follows from the other six by eq. 4.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from game.core.errors import BadInput

__all__ = ["EMOTIONS", "EMOTION_INDEX", "SIX", "emotion_vector", "parse_emotion", "with_neutral"]

EMOTIONS: tuple[str, ...] = ("anger", "fear", "joy", "sadness", "disgust", "surprise", "neutral")
SIX: tuple[str, ...] = EMOTIONS[:6]
EMOTION_INDEX: Mapping[str, int] = {name: i for i, name in enumerate(EMOTIONS)}

Floats = NDArray[np.float64]


def with_neutral(six: ArrayLike) -> Floats:
    """Append the derived neutral (Hattori et al., eq. 4): ``1 − Σ six`` where that sum is below 1, else 0.

    ``six``: (..., 6) floats in [0, 1] -> (..., 7).
    """
    values = np.asarray(six, dtype=np.float64)
    total = values.sum(axis=-1, keepdims=True)
    return np.concatenate([values, np.where(total < 1.0, 1.0 - total, 0.0)], axis=-1)


def emotion_vector(values: Mapping[str, float]) -> Floats:
    """``{"joy": 0.8}`` -> (7,) with the derived neutral. ``neutral: 1`` may be given and changes nothing.

    Raises BadInput for an unknown emotion or a value outside [0, 1].
    """
    six = np.zeros(6)
    for name, value in values.items():
        if name not in EMOTION_INDEX:
            raise BadInput("unknown emotion", expected=" | ".join(EMOTIONS), seen=name)
        if not 0.0 <= value <= 1.0:
            raise BadInput(f"emotion {name}", expected="a number from 0 to 1", seen=value)
        if name != "neutral":
            six[EMOTION_INDEX[name]] = value
    return with_neutral(six)


def parse_emotion(text: str) -> Floats:
    """The command line's ``joy=0.8,fear=0.1`` -> (7,). Raises BadInput with what was expected."""
    values: dict[str, float] = {}
    for item in text.split(","):
        name, equals, number = item.strip().partition("=")
        try:
            values[name.strip()] = float(number) if equals else 1.0
        except ValueError:
            raise BadInput("emotion", expected="NAME=NUMBER[,NAME=NUMBER…]", seen=text) from None
    return emotion_vector(values)
