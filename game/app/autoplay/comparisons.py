"""What reading is worth: policies set against each other at one stall, with 95 % intervals and what is wanted."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from game.app.autoplay.tally import Interval, Tally

__all__ = ["Comparison", "compared"]

MASKED, BLIND = 0.4, 0.75
"""From this mask on the body tells more than the face; from that one on the face tells nothing."""


@dataclass(frozen=True)
class Comparison:
    """One figure of the table. name: such as "oracle − fixed"; wanted: in words; least, most: bounds it is held to."""

    name: str
    value: Interval
    wanted: str
    least: float = -math.inf
    most: float = math.inf
    percent: bool = False

    @property
    def good(self) -> bool:
        """Whether what was measured is as wanted."""
        return self.least <= self.value.mean <= self.most

    @property
    def figure(self) -> str:
        """The value with its interval."""
        mean, half = self.value.mean, self.value.half
        return f"{mean:.1%} ± {half:.1%}" if self.percent else f"{mean:+.3f} ± {half:.3f}"

    @property
    def text(self) -> str:
        """One line for people."""
        return f"{self.name:<26}{self.figure:<17}{'ok ' if self.good else 'NOT'}  wanted: {self.wanted}"

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return {
            "name": self.name, "mean": round(self.value.mean, 4), "ci95": round(self.value.half, 4),
            "wanted": self.wanted, "good": self.good,
        }  # fmt: skip


def compared(tallies: Mapping[str, Tally], mask: float) -> list[Comparison]:
    """Every figure that the policies played allow. mask: of the person, in [0, 1]."""
    return list(_compared({name: tally.surplus_ci for name, tally in tallies.items() if tally.talks > 1}, mask))


def _compared(surplus: Mapping[str, Interval], mask: float) -> Iterator[Comparison]:
    if {"oracle", "fixed"} <= surplus.keys():
        yield Comparison("oracle − fixed", _minus(surplus["oracle"], surplus["fixed"]), "0.20 or more", 0.20)
    if {"oracle", "fixed", "reader"} <= surplus.keys():
        closed = _closed(surplus["fixed"], surplus["reader"], surplus["oracle"])
        yield Comparison("reader closes of that gap", closed, "60 % or more", 0.6, percent=True)
    if {"words", "random"} <= surplus.keys():
        yield Comparison("words − random", _minus(surplus["words"], surplus["random"]), "more than 0", 1e-9)
    if {"body", "face"} <= surplus.keys():
        value = _minus(surplus["body"], surplus["face"])
        masked = mask >= MASKED
        wanted = "more than 0 behind a mask" if masked else "anything, without a mask"
        yield Comparison("body − face", value, wanted, 1e-9 if masked else -math.inf)
    if {"face", "words"} <= surplus.keys() and mask >= BLIND:
        value = _minus(surplus["face"], surplus["words"])
        yield Comparison("face − words", value, "0 or less: the face is worth nothing", most=0.0)
    if {"reader", "body"} <= surplus.keys():
        yield Comparison("reader − body", _minus(surplus["reader"], surplus["body"]), "0 or more", 0.0)


def _minus(a: Interval, b: Interval) -> Interval:
    return Interval(a.mean - b.mean, math.hypot(a.half, b.half))


def _closed(low: Interval, mid: Interval, high: Interval) -> Interval:
    """(mid − low) / (high − low), its interval by the delta method: the three means are taken as independent."""
    gap = high.mean - low.mean
    if gap <= 0.0:
        return Interval(0.0, math.inf)
    share = (mid.mean - low.mean) / gap
    half = math.sqrt(mid.half**2 + ((1.0 - share) * low.half) ** 2 + (share * high.half) ** 2) / gap
    return Interval(share, half)
