"""A whole run: populations at stalls, cut into jobs, put together again in order whatever came first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from game.animation import Mode
from game.app.autoplay.contents import code_hash, content_hash
from game.app.autoplay.executors import Crew
from game.app.autoplay.jobs import BODIES_PER_JOB, TALKS_PER_JOB, Job, Result, needs_bodies
from game.app.autoplay.logfile import LogFile
from game.app.autoplay.progress import Progress
from game.app.autoplay.tally import Coverage, Tally

__all__ = ["Plan", "Run", "play"]


@dataclass(frozen=True)
class Plan:
    """What is to be played: every population plays ``episodes`` at every stall, each of ``visits`` talks.

    record: a folder for a recording of every talk, "" for none; folder: where names of files start on every machine, ""
    for where a process stands."""

    stalls: tuple[str, ...]
    populations: tuple[str, ...]
    episodes: int
    seed: int
    bodies: bool = False
    mode: Mode = "full"
    log: str = ""
    cover: bool = False
    per_job: int = 0  # 0: as many as suit the work
    visits: int = 1
    record: str = ""
    folder: str = ""

    @property
    def talks(self) -> int:
        """All of them."""
        return self.episodes * self.visits * len(self.stalls) * len(self.populations)

    def jobs(self) -> Iterator[Job]:
        """In the order of the log."""
        number = 0
        for stall in self.stalls:
            for population in self.populations:
                bodies = self.bodies or needs_bodies(population, self.folder)
                made = f"{code_hash()} {content_hash((stall,), (population,), self.folder)}"
                size = self.per_job or (BODIES_PER_JOB if bodies else TALKS_PER_JOB)
                for first in range(0, self.episodes, size):
                    count = min(size, self.episodes - first)
                    yield Job(
                        number, stall, population, self.seed, first, count, bodies, self.mode, self.log, self.cover,
                        self.visits, self.record, self.folder, made,
                    )  # fmt: skip
                    number += 1

    def key(self) -> dict[str, Any]:
        """What decides every byte of the log."""
        return {
            "stalls": list(self.stalls),
            "populations": list(self.populations),
            "episodes": self.episodes,
            "seed": self.seed,
            "bodies": self.bodies,
            "mode": self.mode,
            "log": self.log,
            "cover": self.cover,
            "per_job": [self.per_job, TALKS_PER_JOB, BODIES_PER_JOB],
            "visits": self.visits,
            "contents": content_hash(self.stalls, self.populations),
            "code": code_hash(),
        }


Place = tuple[str, str, str]
"""(stall, population, policy that played)."""


@dataclass
class Run:
    """What came of a run so far. talks: played; whole: whether that is all of them.

    tallies: of first visits, whatever came after them; returns: of later visits.
    """

    plan: Plan
    tallies: dict[Place, Tally] = field(default_factory=dict)
    returns: dict[Place, Tally] = field(default_factory=dict)
    coverage: dict[str, Coverage] = field(default_factory=dict)
    jobs: int = 0
    talks: int = 0
    whole: bool = False

    def add(self, job: Job, result: Result) -> None:
        """The next job's result."""
        for mine, found in ((self.tallies, result.tallies), (self.returns, result.returns)):
            for policy, tally in found.items():
                mine.setdefault((job.stall, job.population, policy), Tally()).merge(tally)
        self.coverage.setdefault(job.stall, Coverage()).merge(result.coverage)
        self.jobs += 1
        self.talks += job.talks

    def total(self, stall: str, population: str, *, later: bool = False) -> Tally:
        """All who played of a population: their first visits, or their later ones."""
        total = Tally()
        for (at, of, _), tally in sorted((self.returns if later else self.tallies).items()):
            if (at, of) == (stall, population):
                total.merge(tally)
        return total

    def policies(self, stall: str, population: str) -> Mapping[str, Tally]:
        """By policy, where a population is a mixture."""
        return {who: t for (at, of, who), t in sorted(self.tallies.items()) if (at, of) == (stall, population)}

    def to_dict(self) -> dict[str, Any]:
        """For ``--resume``."""
        return {
            "jobs": self.jobs,
            "talks": self.talks,
            "tallies": [[*place, tally.to_dict()] for place, tally in self.tallies.items()],
            "returns": [[*place, tally.to_dict()] for place, tally in self.returns.items()],
            "coverage": {stall: coverage.to_dict() for stall, coverage in self.coverage.items()},
        }

    @staticmethod
    def from_dict(plan: Plan, data: Mapping[str, Any]) -> Run:
        """What ``to_dict`` wrote."""
        run = Run(plan, jobs=data["jobs"], talks=data["talks"])
        for mine, kept in ((run.tallies, data["tallies"]), (run.returns, data["returns"])):
            for stall, population, policy, tally in kept:
                mine[stall, population, policy] = Tally.from_dict(tally)
        run.coverage = {stall: Coverage.from_dict(own) for stall, own in data["coverage"].items()}
        return run


def play(
    plan: Plan,
    crew: Crew,
    *,
    out: Path | None = None,
    resume: bool = False,
    progress: Callable[[int, int], Progress] = Progress,
) -> Run:
    """Play everything. Ctrl-C ends it with what is done: ``Run.whole`` is False, and the log can be gone on with.

    Results are added in the order of the jobs, so that sums are the same to the last bit however many work on them.
    """
    log = None if out is None else LogFile(out, plan.key())
    kept = None if log is None else log.begin(resume)
    run = Run(plan) if kept is None else Run.from_dict(plan, kept)
    bar = progress(plan.talks, run.talks)
    jobs: dict[int, Job] = {}  # those that are given out
    early: dict[int, Result] = {}

    def given_out() -> Iterator[Job]:
        for job in plan.jobs():
            if job.number >= run.jobs:
                jobs[job.number] = job
                yield job

    results = crew.results(given_out())
    try:
        for result in results:
            bar.add(jobs[result.number].talks)
            early[result.number] = result
            while run.jobs in early:
                ready = early.pop(run.jobs)
                job = jobs.pop(ready.number)
                if log is not None:
                    log.write(ready.rows)
                run.add(job, ready)
                if log is not None:
                    log.keep(run.to_dict())
        run.whole = True
    except KeyboardInterrupt:
        results.close()
    except BaseException:
        if log is not None:
            log.stop() if run.jobs else log.drop()
        raise
    finally:
        bar.end()
    if log is not None:
        if run.whole:
            log.end()
        elif run.jobs:
            log.stop()
        else:
            log.drop()
    return run
