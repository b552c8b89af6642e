"""Talks per second with the planner at 30 Hz simulated: talks of exactly ten choices, and whole negotiations.

The ten choices are those on which story engines are compared (bench_talk), played with all that a talk at a stall has:
the shopkeeper's feelings and bargain, lines in time with their gesture words, eq. 1 for every tick of the body.
"""

from __future__ import annotations

import multiprocessing
import random
import time
from dataclasses import dataclass
from typing import Any

from game.app.autoplay import play_with_bodies
from game.app.autoplay.jobs import BODIES_PER_JOB
from game.app.bench_rows import Row, row
from game.app.bench_talk import patient_talk
from game.app.body import BodyObserver
from game.app.content import load_talk_assets, stall_path
from game.app.policies import Seat, Table, seat
from game.app.talk import Choice
from game.embos import UnitLibrary

__all__ = ["rows", "ten_choices"]

REPEATS = 3
WORKERS, WORK_S = 2, 5.0


@dataclass
class _AnyLine:
    """Says any line but a farewell, and offers nothing."""

    rng: random.Random

    def move(self, view: Table) -> Choice:
        """The next move."""
        lines = [line for line in view.lines if line.act != "leave"]
        return Choice(lines[int(self.rng.random() * len(lines))].id)


def ten_choices(library: UnitLibrary) -> Seat:
    """Who plays a talk that goes on for ten choices: rounds and patience last, nothing ends it sooner."""
    layers = {unit.name: unit.layer for unit in library.units}
    return Seat("any line", "table", patient_talk(), _AnyLine, layers)


def _played(observer: BodyObserver, player: Seat, seed: int) -> int:
    """Play as many talks as a job has."""
    return len(play_with_bodies(observer, [player] * BODIES_PER_JOB, seed, 0))


def _rates(observer: BodyObserver, player: Seat) -> list[float]:
    """Talks per second of processor time, once warm."""
    _played(observer, player, 0)
    rates = []
    for seed in range(1, REPEATS + 1):
        begun = time.process_time()
        made = _played(observer, player, seed)
        rates.append(made / (time.process_time() - begun))
    return rates


def _worker(ready: Any, results: Any) -> None:
    observer = BodyObserver.load(explain=False)
    player = ten_choices(observer.planner.library)
    _played(observer, player, 0)
    ready.wait()
    begun, made = time.perf_counter(), 0
    while time.perf_counter() - begun < WORK_S:
        made += _played(observer, player, made + 1)
    results.put(made / (time.perf_counter() - begun))


def _together() -> float:
    """Talks of ten choices per second of the clock, of workers side by side."""
    context = multiprocessing.get_context("spawn")
    ready, results = context.Barrier(WORKERS), context.Queue()
    workers = [context.Process(target=_worker, args=(ready, results)) for _ in range(WORKERS)]
    for worker in workers:
        worker.start()
    rate = sum(results.get(timeout=300) for _ in workers)
    for worker in workers:
        worker.join()
    return float(rate)


def rows() -> list[Row]:
    """The table's rows; "a core": per second of processor time."""
    observer = BodyObserver.load(explain=False)
    ten = ten_choices(observer.planner.library)
    name = "autoplay: bodies at 30 Hz, "
    found = [
        row(f"{name}ten choices, a core, episodes/s", _rates(observer, ten), unit="/s",
            more_is_better=True),
        row(f"{name}ten choices, {WORKERS} workers, by the clock", [_together() for _ in range(REPEATS)], unit="/s",
            wanted=">= 200", more_is_better=True),
    ]  # fmt: skip
    assets = load_talk_assets(stall_path("flea"))
    for policy in ("random", "reader"):
        player = seat(assets, policy, library=observer.planner.library)
        rates = _rates(observer, player)
        found.append(row(f"{name}flea, {policy}, a core, talks/s", rates, unit="/s", more_is_better=True))
    return found
