"""Speed of the planner for 1, 100, 1000 and 10 000 characters, 3 layers × 40 units, beside a NumPy floor.

The floor computes the scores of eq. 1 from ready factors and takes the argmax, layer by layer, in the fewest
array calls; it keeps no state, starts nothing and explains nothing.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from game.core.emotion_space import with_neutral
from game.core.humanoid import BODY_PARTS
from game.embos import LAYERS, MotionUnit, Planner, PlannerConfig, PlannerSignal, UnitLibrary

__all__ = ["PlannerRow", "made_up_library", "run"]

_PER_LAYER = 40
_CROWD_LOOK_S = 0.1
_HALF_LIFE_S = 8.0
_TICK_S = 1.0 / 30.0
_NEW_FEELING_S = 10.0
"""Every so often each character is given a new emotion to drift to."""


@dataclass(frozen=True)
class PlannerRow:
    """ns per character and tick.

    look_s: as PlannerConfig, 0: every tick. tick: with emotions that drift all the time and words that come now
    and then (mean, median, least over ticks); judged: eq. 1 computed for every character; felt: φ_state computed
    for every character; floor: see above.
    """

    characters: int
    look_s: float
    tick_mean_ns: float
    tick_median_ns: float
    tick_least_ns: float
    judged_ns: float
    felt_ns: float
    floor_ns: float
    tick_to_floor: float


def made_up_library(seed: int, per_layer: int = _PER_LAYER) -> UnitLibrary:
    """Random units with the statistics of a repertoire: each is shown in some emotions, uses a part or two."""
    rng = np.random.default_rng(seed)
    units = []
    for layer in LAYERS:
        for i in range(per_layer - (layer != "posture")):
            shown = rng.random(7) < 0.4
            shown[rng.integers(7)] = True
            units.append(
                MotionUnit(
                    name=f"{layer}_{i}",
                    layer=layer,
                    intensity=np.where(shown, rng.random(7), 0.0),
                    duration_s=np.where(shown, rng.uniform(1.5, 8.0, 7), 0.0),
                    waiting_s=np.where(shown, rng.uniform(10.0, 60.0, 7), 0.0),
                    duration_cv=0.3,
                    uses=frozenset(rng.choice(BODY_PARTS, 2 if layer == "gesture" else 1).tolist()),
                )
            )
    return UnitLibrary(units)


def run(as_json: bool, seed: int = 1, counts: tuple[int, ...] = (1, 100, 1000, 10_000)) -> list[PlannerRow]:
    """Measure, print (a table or JSON), return the rows."""
    library = made_up_library(seed)
    hero, crowd = Planner(library), Planner(library, PlannerConfig(look_s=_CROWD_LOOK_S))
    rows = [_measure(planner, n, seed) for planner in (hero, crowd) for n in counts if planner is hero or n >= 100]
    if as_json:
        print(json.dumps({"planner": [asdict(row) for row in rows]}))
        return rows
    print("planner, 3 layers × 40 units, ns per character and tick (tick: emotions drifting)")
    print(
        f"{'characters':>10} {'mean':>9} {'median':>9} {'least':>9} {'judged':>9} {'felt':>9} {'floor':>9} {'ratio':>6}"
    )
    for r in rows:
        times = (r.tick_mean_ns, r.tick_median_ns, r.tick_least_ns, r.judged_ns, r.felt_ns, r.floor_ns)
        print(f"{r.characters:>10} " + " ".join(f"{t:>9.0f}" for t in times) + f" {r.tick_to_floor:>6.2f}")
    return rows


def _measure(planner: Planner, n: int, seed: int) -> PlannerRow:
    rng = np.random.default_rng(seed)
    ticks = int(np.clip(600_000 // n, 90, 1800))
    state = planner.start(n, seed)
    words = np.zeros((n, len(planner.library.gestures)))
    emotion, target = _feelings(rng, n), _feelings(rng, n)
    keep = 0.5 ** (_TICK_S / _HALF_LIFE_S)
    times = []
    for tick in range(ticks):
        changed = rng.random(n) < _TICK_S / _NEW_FEELING_S
        target[changed] = _feelings(rng, int(changed.sum()))
        emotion = emotion * keep + target * (1.0 - keep)
        said = words
        if tick % 10 == 0:
            said = (rng.random(words.shape) < 0.01).astype(np.float64)
        signal = PlannerSignal(emotion, said, tick * _TICK_S)
        begin = time.perf_counter_ns()
        state, _ = planner.advance(state, signal)
        times.append(time.perf_counter_ns() - begin)
    settled = np.array(times[len(times) // 10 :]) / n
    everyone, now = np.arange(n), ticks * _TICK_S
    pieces = [everyone[i : i + 64] for i in range(0, n, 64)]
    repeats = int(np.clip(20_000 // n, 3, 500))
    judged = _least(lambda: [planner.evaluate(state, p, words[p], now) for p in pieces], repeats) / n
    felt = _least(lambda: planner.tables.phi_state(emotion), repeats) / n
    floor = _least(_floor(rng, n), repeats) / n
    mean = float(settled.mean())
    return PlannerRow(
        n,
        planner.config.look_s,
        mean,
        float(np.median(settled)),
        float(settled.min()),
        judged,
        felt,
        floor,
        mean / max(floor, 1e-9),
    )  # fmt: skip


def _feelings(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    """Two emotions felt at a time, as most moments are."""
    six = np.zeros((n, 6))
    six[np.arange(n), rng.integers(0, 6, n)] = rng.uniform(0.2, 0.8, n)
    six[np.arange(n), rng.integers(0, 6, n)] = rng.uniform(0.0, 0.2, n)
    return with_neutral(six)


def _floor(rng: np.random.Generator, n: int) -> Callable[[], object]:
    m, layers = _PER_LAYER, len(LAYERS)
    follow, blocks = rng.random((layers * m, m)), (rng.random((layers * m, layers, m)) < 0.7).astype(np.float64)
    running = rng.integers(0, m, (n, layers)) + np.arange(layers) * m
    wait_s, phi_state = rng.random((n, layers, m)), rng.random((n, layers, m))

    def scores_and_argmax() -> object:
        score = np.where(wait_s > 0.5, 0.02, 0.5)
        score *= phi_state
        score *= follow[running]
        first = score[:, 0].argmax(axis=1)
        second = (score[:, 1] * blocks[first, 1]).argmax(axis=1)
        return (score[:, 2] * blocks[first, 2] * blocks[second + m, 2]).argmax(axis=1)

    return scores_and_argmax


def _least(work: Callable[[], object], repeats: int) -> float:
    """Least wall time of a call over some repeats, ns: what the work costs when nothing disturbs it."""
    best = float("inf")
    for _ in range(repeats):
        begin = time.perf_counter_ns()
        work()
        best = min(best, float(time.perf_counter_ns() - begin))
    return best
