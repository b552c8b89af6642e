"""Does a performance keep what the takes say? Each finding is one line; no finding, all is well."""

from __future__ import annotations

import itertools
from collections.abc import Mapping

import numpy as np

from game.app.performance import Performance, correlations, take_rates
from game.core.emotion_space import EMOTIONS
from game.embos import LAYERS, Planner

__all__ = ["LEAST_MEAN_R", "LEAST_POSTURE_S", "LEAST_R", "check_means", "check_performance"]

LEAST_R, LEAST_MEAN_R = 0.9, 0.95
LEAST_POSTURE_S = 1.0
_TICK_SLACK_S = 1e-6


def check_performance(planner: Planner, performance: Performance, emotion: int) -> list[str]:
    """What is wrong with a performance of one pure emotion (index 0..6)."""
    name = EMOTIONS[emotion]
    found = [
        f"{name}: {layer} agrees with the take at r = {r:.3f}, expected at least {LEAST_R}"
        for layer, r in correlations(planner.library, performance, emotion).items()
        if r < LEAST_R
    ]
    foreign = np.flatnonzero((take_rates(planner.library)[0][:, emotion] == 0.0) & ~planner.library.is_rest)
    found += [
        f"{name}: {performance.share[i]:.1%} of the time in {planner.library.units[i].name}, which it never showed"
        for i in foreign
        if performance.share[i] > 0.0
    ]
    found += [f"{name}: {finding}" for finding in _hurried(performance) + _too_soon(planner, performance)]
    return found


def _too_soon(planner: Planner, performance: Performance) -> list[str]:
    """Starts of a unit inside its waiting time although another unit of its layer might have played."""
    minimum = planner.config.minimum
    return [
        f"{event.chosen.name} at {event.time_s:.2f} s inside its waiting time while {free[0]} was free"
        for event in performance.events
        if event.chosen.time == minimum[event.chosen.layer]
        and (
            free := [
                c.name
                for c in event.table[1:]
                if c.time > minimum[c.layer] and c.linkage > 0.0 and c.state > 0.0 and c.source
            ]
        )
    ]


def _hurried(performance: Performance) -> list[str]:
    """Postures given up in less than a second."""
    starts = [event for event in performance.events if event.chosen.layer == "posture"]
    changes = [b for a, b in itertools.pairwise(starts) if a.chosen.unit != b.chosen.unit]
    held = zip([starts[0], *changes] if starts else [], changes, strict=False)
    return [
        f"{a.chosen.name} held for {b.time_s - a.time_s:.2f} s from {a.time_s:.2f} s, expected {LEAST_POSTURE_S:g} s"
        for a, b in held
        if b.time_s - a.time_s < LEAST_POSTURE_S - _TICK_SLACK_S
    ]


def check_means(r: Mapping[str, Mapping[str, float]]) -> list[str]:
    """r: emotion -> layer -> r. The mean over the emotions must be better than each one needs to be."""
    found = []
    for layer in LAYERS:
        values = [by_layer[layer] for by_layer in r.values() if layer in by_layer]
        if values and float(np.mean(values)) < LEAST_MEAN_R:
            found.append(f"{layer}: mean r = {np.mean(values):.3f}, expected at least {LEAST_MEAN_R}")
    return found
