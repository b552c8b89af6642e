"""The pointwise part of the picture's grading, applied to palettes beforehand instead of to every frame."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["grade", "palette_bytes"]

_WARMTH = np.array([0.97, 1.0, 1.015])  # exponents of red, green, blue; shaders/grade.glsl holds the same curve


def grade(colour: ArrayLike) -> NDArray[np.float64]:
    """Gentle S-curve (16 %) and warmth: display-referred colours (..., 3) in 0..1 -> the same shape."""
    c = np.clip(np.asarray(colour, dtype=np.float64), 0.0, 1.0)
    c = c + (c * c * (3.0 - 2.0 * c) - c) * 0.16
    return np.asarray(np.clip(c, 1e-6, None) ** _WARMTH)


def palette_bytes(lit: ArrayLike, shade: ArrayLike, deep: ArrayLike, *, graded: bool) -> NDArray[np.uint8]:
    """One palette entry as (12,) bytes: lit, shade, deep, three bytes of padding for 4-byte alignment."""
    entry = np.stack([np.asarray(c, dtype=np.float64) for c in (lit, shade, deep)])
    if graded:
        entry = grade(entry)
    return np.concatenate([np.rint(np.clip(entry, 0.0, 1.0) * 255.0).ravel(), np.zeros(3)]).astype(np.uint8)
