"""One row of a benchmark's table."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from typing import Any

__all__ = ["Row", "row"]

Row = dict[str, Any]


def row(
    name: str,
    values: Sequence[float],
    *,
    unit: str,
    floor: float | None = None,
    wanted: str = "",
    more_is_better: bool = False,
) -> Row:
    """Median, best and spread (interquartile range over the median) of repeated measurements, and the ratio of the
    median to a floor measured in the same run."""
    median = statistics.median(values)
    quarters = statistics.quantiles(values, n=4) if len(values) > 2 else [min(values), median, max(values)]
    return {
        "name": name,
        "unit": unit,
        "median": median,
        "min": max(values) if more_is_better else min(values),
        "spread": (quarters[2] - quarters[0]) / median if median else None,
        "floor": floor,
        "ratio": median / floor if floor else None,
        "wanted": wanted,
    }
