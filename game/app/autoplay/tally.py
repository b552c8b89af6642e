"""What is counted while talks are played: sums and counts that add up, as small after a million talks as after ten."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from game.app.autoplay.episodes import Decision

__all__ = ["MOST_ROUNDS", "PRICE_BINS", "Coverage", "Interval", "Tally", "interval_of"]

MOST_ROUNDS = 12
"""Rounds beyond this are counted with the last one."""
PRICE_BINS = 20
"""Agreed prices are counted in this many equal shares of the list price."""


@dataclass(frozen=True)
class Interval:
    """A mean and the half width of its 95 % interval (normal approximation)."""

    mean: float
    half: float

    @property
    def low(self) -> float:
        return self.mean - self.half

    @property
    def high(self) -> float:
        return self.mean + self.half


def interval_of(count: int, total: float, squares: float) -> Interval:
    """From a count, a sum and a sum of squares."""
    if count == 0:
        return Interval(0.0, 0.0)
    mean = total / count
    variance = max(squares - count * mean * mean, 0.0) / (count - 1) if count > 1 else 0.0
    return Interval(mean, 1.96 * math.sqrt(variance / count))


def _zeros(rows: int, columns: int) -> list[list[float]]:
    return [[0.0] * columns for _ in range(rows)]


@dataclass
class Tally:
    """One policy at one stall. felt, shown: sums by round and emotion; surplus and talk length as sums and squares."""

    talks: int = 0
    deals: int = 0
    surplus: float = 0.0
    surplus_squares: float = 0.0
    moves: int = 0
    moves_squares: int = 0
    endings: Counter[str] = field(default_factory=Counter)
    qualities: Counter[str] = field(default_factory=Counter)
    lengths: list[int] = field(default_factory=lambda: [0] * (MOST_ROUNDS + 1))
    prices: list[int] = field(default_factory=lambda: [0] * PRICE_BINS)
    at_round: list[int] = field(default_factory=lambda: [0] * MOST_ROUNDS)
    felt: list[list[float]] = field(default_factory=lambda: _zeros(MOST_ROUNDS, 7))
    felt_squares: list[list[float]] = field(default_factory=lambda: _zeros(MOST_ROUNDS, 7))
    shown: list[list[float]] = field(default_factory=lambda: _zeros(MOST_ROUNDS, 7))

    def add(self, decisions: Sequence[Decision]) -> None:
        """Count one talk."""
        last = decisions[-1].after
        count, surplus = len(decisions), last.surplus
        self.talks += 1
        self.surplus += surplus
        self.surplus_squares += surplus * surplus
        self.moves += count
        self.moves_squares += count * count
        self.endings[str(last.beat.ended)] += 1
        self.lengths[min(count, MOST_ROUNDS)] += 1
        if last.bargain.outcome == "deal":
            self.deals += 1
            self.prices[min(int(last.bargain.price * PRICE_BINS), PRICE_BINS - 1)] += 1
        for at, decision in enumerate(decisions[:MOST_ROUNDS]):
            record = dict(decision.after.record)
            self.qualities[record["quality"]] += 1
            self.at_round[at] += 1
            sums, squares, shown = self.felt[at], self.felt_squares[at], self.shown[at]
            for index, (felt, face) in enumerate(zip(record["felt"], record["shown"], strict=True)):
                sums[index] += felt
                squares[index] += felt * felt
                shown[index] += face

    def merge(self, other: Tally) -> None:
        """Add another tally."""
        for name in ("talks", "deals", "surplus", "surplus_squares", "moves", "moves_squares"):
            setattr(self, name, getattr(self, name) + getattr(other, name))
        self.endings.update(other.endings)
        self.qualities.update(other.qualities)
        for mine, theirs in (
            (self.lengths, other.lengths),
            (self.prices, other.prices),
            (self.at_round, other.at_round),
        ):
            mine[:] = [a + b for a, b in zip(mine, theirs, strict=True)]
        for table, added in (
            (self.felt, other.felt),
            (self.felt_squares, other.felt_squares),
            (self.shown, other.shown),
        ):
            for row, more in zip(table, added, strict=True):
                row[:] = [a + b for a, b in zip(row, more, strict=True)]

    @property
    def surplus_ci(self) -> Interval:
        """Mean share of the possible gain."""
        return interval_of(self.talks, self.surplus, self.surplus_squares)

    @property
    def deal_ci(self) -> Interval:
        """Deal rate."""
        return interval_of(self.talks, float(self.deals), float(self.deals))

    @property
    def moves_ci(self) -> Interval:
        """Mean length of a talk in moves."""
        return interval_of(self.talks, float(self.moves), float(self.moves_squares))

    def summary(self) -> dict[str, Any]:
        """The figures for people and machines."""
        surplus, deals, moves = self.surplus_ci, self.deal_ci, self.moves_ci
        made = max(sum(self.qualities.values()), 1)
        return {
            "episodes": self.talks,
            "deal_rate": round(deals.mean, 4),
            "deal_rate_ci95": round(deals.half, 4),
            "mean_surplus": round(surplus.mean, 4),
            "mean_surplus_ci95": round(surplus.half, 4),
            "mean_rounds": round(moves.mean, 3),
            "mean_rounds_ci95": round(moves.half, 3),
            "lines": {name: round(self.qualities[name] / made, 4) for name in ("right", "neutral", "wrong")},
            "endings": dict(sorted(self.endings.items())),
        }

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready, exactly."""
        return {**vars(self), "endings": dict(self.endings), "qualities": dict(self.qualities)}

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> Tally:
        """What ``to_dict`` wrote."""
        tally = Tally(**data)
        tally.endings, tally.qualities = Counter(data["endings"]), Counter(data["qualities"])
        return tally

    def trajectory(self, emotion: int) -> list[Interval]:
        """Mean of a felt emotion by round, as far as any talk went."""
        return [
            interval_of(count, self.felt[at][emotion], self.felt_squares[at][emotion])
            for at, count in enumerate(self.at_round)
            if count
        ]


@dataclass
class Coverage:
    """How often each part of one stall was reached; conditions: [times false, times true] by number in the script."""

    nodes: Counter[str] = field(default_factory=Counter)
    offered: Counter[str] = field(default_factory=Counter)
    chosen: Counter[str] = field(default_factory=Counter)
    lines: Counter[str] = field(default_factory=Counter)
    units: Counter[str] = field(default_factory=Counter)
    parts: Counter[str] = field(default_factory=Counter)
    labels: Counter[str] = field(default_factory=Counter)
    conditions: list[list[int]] = field(default_factory=list)

    def add(self, decisions: Sequence[Decision]) -> None:
        """Count what one talk passed through."""
        first, last = decisions[0].before, decisions[-1].after
        self.nodes.update(last.story.visits)
        self.offered.update([option.id for decision in decisions for option in decision.before.beat.choices])
        self.chosen.update([decision.choice.id for decision in decisions])
        beats = [first.beat, *[decision.after.beat for decision in decisions]]
        self.lines.update([line.id for beat in beats for line in beat.lines])
        self.labels.update([dict(decision.after.record)["felt_label"] for decision in decisions])
        for decision in decisions:
            if decision.shown is not None:
                self.units.update(decision.shown.units.keys())

    def merge(self, other: Coverage) -> None:
        """Add another coverage."""
        for name in ("nodes", "offered", "chosen", "lines", "units", "parts", "labels"):
            getattr(self, name).update(getattr(other, name))
        if not self.conditions:
            self.conditions = [[0, 0] for _ in other.conditions]
        for mine, theirs in zip(self.conditions, other.conditions, strict=False):
            mine[0] += theirs[0]
            mine[1] += theirs[1]

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready, exactly."""
        return {name: dict(value) if isinstance(value, Counter) else value for name, value in vars(self).items()}

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> Coverage:
        """What ``to_dict`` wrote."""
        counted = {name: Counter(value) for name, value in data.items() if name != "conditions"}
        return Coverage(**counted, conditions=data["conditions"])
