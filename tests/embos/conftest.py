"""Random takes, and the library their statistics give: what the planner has to reproduce."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from game.core.humanoid import BODY_PARTS
from game.embos import LAYERS, LAYERS_WITH_REST, MotionUnit, Planner, PlannerConfig, PlannerSignal, UnitLibrary
from game.embos import statistics as stats
from game.embos.transitions import count_transitions

COUNTS = {"posture": 14, "gesture": 10, "mannerism": 18}
LENGTH_S = 180.0


@dataclass(frozen=True)
class MadeUp:
    """A library and the share of time each unit has in the takes it comes from, (7, U)."""

    library: UnitLibrary
    take_share: np.ndarray


def _spans(rng: np.random.Generator, layer: str) -> list[tuple[str, float, float]]:
    own = rng.choice(COUNTS[layer], rng.integers(4, 8), replace=False)
    weight = rng.dirichlet(np.ones(len(own)))
    spans: list[tuple[str, float, float]] = []
    at, last = (0.0, -1) if layer == "posture" else (rng.exponential(3.0), -1)
    while at < LENGTH_S - 1.0:
        pick = rng.choice(len(own), p=weight)
        if layer == "posture":
            if pick == last:
                continue
            length, pause = max(1.0, rng.gamma(4.0, 1.5)), 0.0
        else:
            length, pause = 0.4 + rng.gamma(6.0, 0.3), rng.exponential(4.0)
        spans.append((f"{layer}{own[pick]}", at, min(at + length, LENGTH_S)))
        at, last = at + length + pause, pick
    return spans


def make_up(seed: int, *, with_parts: bool = False) -> MadeUp:
    rng = np.random.default_rng(seed)
    units: list[MotionUnit] = []
    transitions: dict[str, dict[str, int]] = {}
    shares: dict[str, np.ndarray] = {}
    for layer in LAYERS:
        takes = [_spans(rng, layer) for _ in range(7)]
        names = [f"{layer}{i}" for i in range(COUNTS[layer])]
        lengths = {n: [[b - a for name, a, b in take if name == n] for take in takes] for n in names}
        amount = np.array([[sum(x) * 30 if layer == "posture" else len(x) for x in lengths[n]] for n in names])
        intensity = stats.intensity(amount)
        rest = f"rest_{layer}" if layer in LAYERS_WITH_REST else None
        for take in takes:
            for a, row in count_transitions(take, rest, pause_s=0.2).items():
                for b, count in row.items():
                    transitions.setdefault(a, {})[b] = transitions.get(a, {}).get(b, 0) + count
        for i, name in enumerate(names):
            parts = frozenset(rng.choice(BODY_PARTS, 2).tolist()) if with_parts else frozenset()
            units.append(
                MotionUnit(
                    name,
                    layer,
                    intensity[i],
                    np.array([stats.duration(x) for x in lengths[name]]),
                    np.array([stats.waiting(x, LENGTH_S) for x in lengths[name]]),
                    stats.spread(lengths[name]),
                    words={"en": (f"word{i}",)} if layer == "gesture" else None,
                    uses=parts,
                )
            )
            shares[name] = np.array([sum(x) / LENGTH_S for x in lengths[name]])
    library = UnitLibrary(units, None, transitions)
    share = np.array([shares.get(u.name, np.zeros(7)) for u in library.units]).T
    return MadeUp(library, share)


@pytest.fixture(scope="session")
def made_up() -> Callable[..., MadeUp]:
    return make_up


def stage_time(library: UnitLibrary, config: PlannerConfig, minutes: float, seed: int, dt_s: float = 0.1) -> np.ndarray:
    """(7, U) share of time each unit is on stage in the seven pure emotions, every word always at hand."""
    planner = Planner(library, config)
    state = planner.start(7, seed)
    emotion, words = np.eye(7), np.ones((7, len(library.gestures)))
    on = np.zeros((7, len(library)))
    ticks = int(minutes * 60 / dt_s)
    for tick in range(ticks):
        state, decisions = planner.advance(state, PlannerSignal(emotion, words, tick * dt_s), dt_s, spend=True)
        on[np.arange(7)[:, None], decisions.unit] += 1
    return on / ticks


@pytest.fixture(scope="session")
def on_stage() -> Callable[..., np.ndarray]:
    return stage_time
