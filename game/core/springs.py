"""Damping and springs, exact in dt: 30, 60 and 144 fps give the same motion.

Half-life damping and critically damped springs after Daniel Holden ("Spring-It-On", theorangeduck.com);
the inertial transition follows Bollo (GDC 2018) in Holden's decaying-offset form.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["critical_spring", "damp", "damper_fraction", "decay_spring", "half_life_to_damping"]

Floats = NDArray[np.floating[Any]]
_LN2 = float(np.log(2.0))


def half_life_to_damping(half_life_s: ArrayLike) -> Floats:
    """Damping 4·ln2/half-life of a critically damped spring whose offset halves about every half_life_s."""
    return np.asarray(4.0 * _LN2 / (np.asarray(half_life_s, dtype=np.float64) + 1e-9))


def damper_fraction(half_life_s: ArrayLike, dt_s: float) -> Floats:
    """The share in [0, 1] of the remaining distance covered in dt: 1 − 2^(−dt/half-life)."""
    return np.asarray(1.0 - np.exp2(-dt_s / (np.asarray(half_life_s, dtype=np.float64) + 1e-9)))


def damp(value: Floats, target: ArrayLike, half_life_s: ArrayLike, dt_s: float) -> Floats:
    """Exponential approach of value to target; any shape, exact in dt."""
    return np.asarray(value + (np.asarray(target) - value) * damper_fraction(half_life_s, dt_s))


def critical_spring(
    value: Floats, velocity: Floats, target: ArrayLike, half_life_s: ArrayLike, dt_s: float
) -> tuple[Floats, Floats]:
    """One exact step of a critically damped spring toward target; returns value and velocity (per second)."""
    y = half_life_to_damping(half_life_s) / 2.0
    j0 = value - np.asarray(target)
    j1 = velocity + j0 * y
    decay = np.exp(-y * dt_s)
    return np.asarray(decay * (j0 + j1 * dt_s) + np.asarray(target)), np.asarray(decay * (velocity - j1 * y * dt_s))


def decay_spring(value: Floats, velocity: Floats, half_life_s: ArrayLike, dt_s: float) -> tuple[Floats, Floats]:
    """critical_spring toward zero: how an inertial transition's offset dies away."""
    return critical_spring(value, velocity, 0.0, half_life_s, dt_s)
