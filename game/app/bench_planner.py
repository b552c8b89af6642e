"""Speed of the planner for 1, 100, 1000 and 10 000 characters, 3 layers × 40 units, beside a NumPy floor.

The floor computes the scores of eq. 1 from ready factors and takes the argmax, layer by layer, in the fewest
array calls; it keeps no state, starts nothing and explains nothing.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from game.app.bench_rows import Row, row
from game.core.emotion_space import with_neutral
from game.core.humanoid import BODY_PARTS
from game.embos import LAYERS, MotionUnit, Planner, PlannerConfig, PlannerSignal, UnitLibrary

__all__ = ["made_up_library", "rows"]

_PER_LAYER = 40
_CROWD_LOOK_S = 0.1
_HALF_LIFE_S = 8.0
_TICK_S = 1.0 / 30.0
_NEW_FEELING_S = 10.0
"""Every so often each character is given a new emotion to drift to."""


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


def rows(seed: int = 1, counts: tuple[int, ...] = (1, 100, 1000, 10_000)) -> list[Row]:
    """Microseconds per character and tick, and the floor measured beside each."""
    library = made_up_library(seed)
    hero, crowd = Planner(library), Planner(library, PlannerConfig(look_s=_CROWD_LOOK_S))
    result: list[Row] = []
    for n in counts:
        result += _measure(hero, n, seed, "every tick")
        if n >= 100:
            result += _measure(crowd, n, seed, f"looking every {_CROWD_LOOK_S:g} s")[:1]
    return result


def _measure(planner: Planner, n: int, seed: int, how: str) -> list[Row]:
    """A tick with emotions that drift all the time and words now and then; eq. 1 computed for every character."""
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
        state, _ = planner.advance(state, signal, spend=n > 1)  # a hero's past is kept, a crowd's is not
        times.append(time.perf_counter_ns() - begin)
    settled = np.array(times[len(times) // 10 :]) / n / 1000.0
    everyone, signal = np.arange(n), PlannerSignal(emotion, words, ticks * _TICK_S)
    repeats = int(np.clip(20_000 // n, 5, 500))
    judged = _times(lambda: planner.weigh(state, signal, everyone), repeats) / n
    floor = float(np.median(_times(_floor(rng, n), repeats))) / n
    who = "1 character" if n == 1 else f"{n} characters"
    wanted = "<= 18 µs" if n == 1 else "<= 0.8 µs"
    drifting = row(f"{who}, {how}", settled.tolist(), unit="µs", floor=floor, wanted=wanted)
    drifting["mean"] = float(settled.mean())
    return [drifting, row(f"{who}, eq. 1 for all of them", judged.tolist(), unit="µs", floor=floor)]


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


def _times(work: Callable[[], object], repeats: int) -> NDArray[np.float64]:
    """Wall times of some calls, µs."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter_ns()
        work()
        times.append((time.perf_counter_ns() - begin) / 1000.0)
    return np.array(times)
