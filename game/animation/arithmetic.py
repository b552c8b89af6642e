"""Formulas for one character or for many: a number is a float alone, an array over the characters in company.

NumPy takes as long for one number as for a hundred; Python's own arithmetic takes a twentieth of that for one. What a
formula is made of comes from here, so that it is written once.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Arithmetic", "Curve", "Number", "arithmetic", "columns", "numbers"]

Floats = NDArray[np.floating[Any]]

Number = Any
"""float, or (n,) array."""


class Curve:
    """Straight lines between points: x (k,) rising, y (k,). Beyond the ends it stays level."""

    def __init__(self, x: Floats, y: Floats) -> None:
        self.x, self.y = np.array(x), np.array(y)
        self.x.setflags(write=False)
        self.y.setflags(write=False)
        slope = np.diff(self.y) / np.diff(self.x)
        # One piece more on either side, level: where x falls into tells the piece.
        self._pieces = [
            (float(a), float(b), float(s)) for a, b, s in zip([x[0], *x], [y[0], *y], [0.0, *slope, 0.0], strict=True)
        ]
        self._x = [float(a) for a in x]

    def at(self, x: float) -> float:
        """y at one x."""
        start, height, slope = self._pieces[bisect_right(self._x, x)]
        return height + (x - start) * slope


def _interpolated(curve: Curve, x: Number) -> Number:
    return np.interp(x, curve.x, curve.y)


def _chosen(condition: Number, yes: Number, no: Number) -> Number:
    return yes if condition else no


@dataclass(frozen=True)
class Arithmetic:
    """least, most: of two; any: whether a condition holds for somebody; where: the second or the third by the first."""

    sin: Callable[[Number], Number]
    cos: Callable[[Number], Number]
    exp: Callable[[Number], Number]
    arctan2: Callable[[Number, Number], Number]
    hypot: Callable[[Number, Number], Number]
    least: Callable[[Number, Number], Number]
    most: Callable[[Number, Number], Number]
    any: Callable[[Number], bool]
    where: Callable[[Number, Number, Number], Number]
    curve: Callable[[Curve, Number], Number]


_ALONE = Arithmetic(math.sin, math.cos, math.exp, math.atan2, math.hypot, min, max, bool, _chosen, Curve.at)
_MANY = Arithmetic(
    np.sin,
    np.cos,
    np.exp,
    np.arctan2,
    np.hypot,
    np.minimum,
    np.maximum,
    lambda c: bool(np.any(c)),
    np.where,
    _interpolated,
)


def arithmetic(n: int) -> Arithmetic:
    """Of the numbers of n characters."""
    return _ALONE if n == 1 else _MANY


def numbers(array: Floats) -> Sequence[Number]:
    """(n, k) -> k numbers."""
    if len(array) == 1:
        return array[0].tolist()  # type: ignore[no-any-return]
    return list(array.T)


def columns(values: Sequence[Number], n: int, dtype: Any = np.float64) -> Floats:
    """k numbers of n characters, some of which may be the same for all -> (n, k)."""
    if n == 1:
        return np.array([values], dtype=dtype)
    made = np.empty((len(values), n), dtype=dtype)
    for row, value in zip(made, values, strict=True):
        row[:] = value
    return made.T
