"""Display-referred values to linear light."""

from __future__ import annotations

from collections.abc import Iterable

__all__ = ["linear_light"]


def linear_light(values: Iterable[float]) -> tuple[float, float, float]:
    """Three sRGB values to linear light, IEC 61966-2-1; what is below 0 counts as 0, above 1 the curve goes on."""
    r, g, b = (
        v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in (max(float(x), 0.0) for x in values)
    )
    return (r, g, b)
