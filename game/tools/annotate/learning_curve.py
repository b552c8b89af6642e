"""How many minutes of takes are enough: the paper's open question, answered for any set of annotated takes.

Stretches of growing length are cut out of every take, the statistics (eq. 2 and 3) are made from them alone, and the
planner lives in each pure emotion with the resulting units. Compared with the same from the whole takes: how far the
intensities and times are off, and how differently the planner behaves, beside how much it differs from itself when
only the dice fall differently.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.emotion_space import EMOTIONS
from game.core.errors import BadInput
from game.embos import LAYERS, Planner, PlannerSignal, UnitLibrary
from game.embos.analysis import transitions, units_of
from game.embos.annotations import Span, Take
from game.embos.repertoire import Behaviour
from game.embos.statistics import ALPHA

__all__ = ["MEASURES", "Curve", "Point", "learning_curve", "part_of"]

Floats = NDArray[np.float64]

LENGTHS_S = (10.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, 150.0, 180.0, 240.0, 360.0, 600.0)
MEASURES = ("intensity", "times", "behaviour")
"""Mean absolute difference of the intensities (0..1); median relative difference of L_d + L_w; half the summed absolute
difference of the shares of time on stage (0 the same, 1 nothing in common), worst layer, mean of the emotions."""
BAND = (10.0, 90.0)
WATCH_S, WATCH_DT_S = 120.0, 0.1
ENOUGH = {"intensity": 0.05, "behaviour": 0.10}
"""A length is enough when the upper end of the band is below this (behaviour: on top of what the dice do)."""
_SHORTEST_POSTURE_S = 1.0


@dataclass(frozen=True)
class Point:
    """One length of takes: mean and band of each measure over the stretches that were drawn."""

    length_s: float
    mean: Mapping[str, float]
    low: Mapping[str, float]
    high: Mapping[str, float]


@dataclass(frozen=True)
class Curve:
    """points by length; dice: the behaviour's own variation with the whole takes; enough_s: None where no length of
    these takes is enough."""

    points: tuple[Point, ...]
    dice: float
    enough_s: float | None
    draws: int
    seed: int

    def row(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "draws": self.draws,
            "seed": self.seed,
            "dice": self.dice,
            "enough_s": self.enough_s,
            "points": [
                {"length_s": p.length_s, "mean": dict(p.mean), "low": dict(p.low), "high": dict(p.high)}
                for p in self.points
            ],
        }


def part_of(take: Take, start_s: float, end_s: float) -> Take:
    """The take as if only a stretch of it had been recorded: spans are cut at its ends, gestures with their stroke."""
    spans: list[Span] = []
    for span in take.spans:
        first, last = max(span.start_s, start_s), min(span.end_s, end_s)
        # Of what is done rather than held, half is not a case of it, and a gesture is nothing without its stroke.
        least_s = _SHORTEST_POSTURE_S if span.layer == "posture" else 0.5 * span.length_s
        struck = span.stroke_s is None or first <= span.stroke_s <= last
        if last - first >= least_s and struck:
            spans.append(replace(span, start_s=first, end_s=last))
    return replace(take, spans=tuple(spans))


def learning_curve(
    takes: Sequence[Take], repertoire: Mapping[str, Behaviour], *, draws: int = 8, seed: int = 1
) -> Curve:
    """Resample the takes from seconds to their full length. draws: stretches per length, seeded.

    Raises BadInput where the takes are shorter than the shortest stretch.
    """
    longest = min(take.clip.length_s for take in takes)
    lengths = [length for length in LENGTHS_S if length < longest - 5.0]
    if not lengths:
        expected = f"takes longer than {LENGTHS_S[0] + 5.0:g} s"
        raise BadInput("learning curve", expected=expected, seen=f"{longest:.1f} s")
    names = list(repertoire)
    full = _measured(takes, repertoire, names, seed)
    assert full is not None, "the analysis has refused takes without a layer"
    again = [_measured(takes, repertoire, names, seed + 1 + k) for k in range(3)]
    dice = float(np.mean([_apart(full.share, other.share) for other in again if other is not None]))
    rng = np.random.default_rng(seed)
    points: list[Point] = []
    for length in lengths:
        rows = []
        for draw in range(draws):
            starts = [rng.uniform(0.0, take.clip.length_s - length) for take in takes]
            parts = [part_of(take, start, start + length) for take, start in zip(takes, starts, strict=True)]
            rows.append(_difference(full, _measured(parts, repertoire, names, seed + 100 + draw)))
        table = np.array(rows)
        low, high = np.percentile(table, BAND, axis=0)
        points.append(Point(length, *(_named(values) for values in (table.mean(axis=0), low, high))))
    enough = (
        p.length_s
        for p in points
        if p.high["intensity"] <= ENOUGH["intensity"] and p.high["behaviour"] <= dice + ENOUGH["behaviour"]
    )
    return Curve(tuple(points), dice, next(enough, None), draws, seed)


def _named(values: Floats) -> dict[str, float]:
    return {name: round(float(v), 5) for name, v in zip(MEASURES, values, strict=True)}


@dataclass(frozen=True, eq=False)
class _Measured:
    """(B, 7) intensity and period L_d + L_w of every behaviour of the repertoire; share: per layer (B, 7) of the time
    the planner has it on stage in each pure emotion."""

    intensity: Floats
    period_s: Floats
    share: Mapping[str, Floats]


def _measured(
    takes: Sequence[Take], repertoire: Mapping[str, Behaviour], names: Sequence[str], seed: int
) -> _Measured | None:
    """None where some layer shows nothing at all: no character can be made of that."""
    units = units_of(takes, repertoire, ALPHA)
    if {unit.layer for unit in units} != set(LAYERS):
        return None
    row = {name: i for i, name in enumerate(names)}
    intensity, period = np.zeros((len(names), 7)), np.zeros((len(names), 7))
    for unit in units:
        intensity[row[unit.name]] = unit.intensity
        period[row[unit.name]] = np.where(unit.duration_s > 0.0, unit.duration_s + unit.waiting_s, 0.0)
    library = UnitLibrary(units, transitions=transitions(takes))
    return _Measured(intensity, period, _lived(library, row, seed))


def _lived(library: UnitLibrary, row: Mapping[str, int], seed: int) -> dict[str, Floats]:
    """Shares of time on stage when seven characters live in the seven pure emotions; gestures at every word."""
    planner = Planner(library)
    state = planner.start(len(EMOTIONS), seed)
    emotion, words = np.eye(len(EMOTIONS)), np.ones((len(EMOTIONS), len(library.gestures)))
    on_stage = np.zeros((len(EMOTIONS), len(library)))
    ticks = round(WATCH_S / WATCH_DT_S)
    characters = np.arange(len(EMOTIONS))[:, None]
    for tick in range(ticks):
        state, decisions = planner.advance(state, PlannerSignal(emotion, words, tick * WATCH_DT_S), WATCH_DT_S)
        on_stage[characters, decisions.unit] += 1.0 / ticks
    shares = {layer: np.zeros((len(row) + 1, len(EMOTIONS))) for layer in LAYERS}
    for i, unit in enumerate(library.units):
        # A layer's rest is a behaviour too: doing nothing must be as frequent.
        shares[unit.layer][row.get(unit.name, len(row))] = on_stage[:, i]
    return shares


def _difference(full: _Measured, part: _Measured | None) -> tuple[float, float, float]:
    if part is None:
        return 1.0, 1.0, 1.0
    known = (full.intensity > 0.0) | (part.intensity > 0.0)
    intensity = float(np.abs(full.intensity - part.intensity)[known].mean())
    seen = full.period_s > 0.0
    times = float(np.median(np.minimum(np.abs(part.period_s[seen] / full.period_s[seen] - 1.0), 1.0)))
    return intensity, times, _apart(full.share, part.share)


def _apart(a: Mapping[str, Floats], b: Mapping[str, Floats]) -> float:
    return float(np.max([0.5 * np.abs(a[layer] - b[layer]).sum(axis=0).mean() for layer in LAYERS]))
