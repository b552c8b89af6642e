"""A piece of work for a worker process: some episodes of one population at one stall, and what came of them."""

from __future__ import annotations

import gzip
import platform
import random
import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from threading import get_ident
from typing import Any

from game.animation import Mode
from game.app.autoplay.contents import code_hash, content_hash, there
from game.app.autoplay.episodes import Decision, play_episode, play_with_bodies
from game.app.autoplay.outings import Street, hears_news, play_outing, play_outings_with_bodies
from game.app.autoplay.rows import log_lines
from game.app.autoplay.tally import Coverage, Tally
from game.app.autoplay.tracing import ConditionTrace
from game.app.autoplay.visits import habits_of
from game.app.bazaar import load_bazaar
from game.app.body import BodyObserver
from game.app.content import load_talk_assets, stall_path
from game.app.policies import Seat, mixture_of, seat
from game.app.recording import content_hashes
from game.app.recording.talks import write_talk
from game.app.reload import watched_files
from game.app.talk import TalkAssets
from game.core.errors import BadInput
from game.emotion import shown_values
from game.story import shipped_stalls

__all__ = ["BODIES_PER_JOB", "TALKS_PER_JOB", "Job", "Result", "needs_bodies", "work"]

TALKS_PER_JOB = 100
BODIES_PER_JOB = 512
"""Bodies are cheapest side by side."""


@dataclass(frozen=True)
class Job:
    """Everything a worker has to know. stall: name or path; population: a mixture of policies as text.

    log: whether rows are wanted, ``plain`` or ``gzip``; cover: whether every condition is listened to. visits: talks of
    an episode. folder: where names of files start; made: hashes of the code and contents that it was given out with.
    """

    number: int
    stall: str
    population: str
    seed: int
    first: int
    count: int
    bodies: bool = False
    mode: Mode = "full"
    log: str = ""
    cover: bool = False
    visits: int = 1
    record: str = ""
    folder: str = ""
    made: str = ""

    @property
    def at(self) -> str:
        """The stall, from wherever this is played."""
        return there(self.folder, self.stall)

    @property
    def talks(self) -> int:
        """All of them."""
        return self.count * self.visits


@dataclass
class Result:
    """What a job gives back: by policy what was counted, what was covered, and the rows of the log.

    tallies: of first visits; returns: of later ones.
    """

    number: int
    tallies: dict[str, Tally] = field(default_factory=dict)
    returns: dict[str, Tally] = field(default_factory=dict)
    coverage: Coverage = field(default_factory=Coverage)
    rows: bytes = b""


def needs_bodies(population: str, folder: str = "") -> bool:
    """Whether some policy of a population looks at bodies. folder: where names of files start."""
    return any(
        name in {"body", "reader"} or (name.endswith(".py") and _own_looks_at_bodies(there(folder, name)))
        for name, _ in mixture_of(population).shares
    )


def _own_looks_at_bodies(name: str) -> bool:
    from pathlib import Path

    from game.app.policies import OwnPolicy

    return OwnPolicy.load(Path(name)).sees in {"body", "reader"}


@lru_cache(maxsize=64)
def _check_made(made: str, stall: str, population: str, folder: str) -> None:
    """Raises BadInput where this machine would play something else than what was given out."""
    here = f"{code_hash()} {content_hash((stall,), (population,), folder)}"
    if made != here:
        what = "code (start it anew if it was changed)" if made.split()[0] != here.split()[0] else "contents"
        raise BadInput(f"worker on {platform.node()}", expected="the same game", seen=f"other {what}")


# A worker reads what it needs once for one state of the contents (Dask's live on), each of its threads for itself;
# what a job gives depends on the job alone.
@lru_cache(maxsize=8)
def _assets(stall: str, cover: bool, made: str, thread: int) -> tuple[TalkAssets, ConditionTrace | None]:
    assets = load_talk_assets(stall_path(stall))
    return assets, ConditionTrace(assets.script) if cover else None


@lru_cache(maxsize=4)
def _observer(mode: Mode, explain: bool, made: str, thread: int) -> BodyObserver:
    return BodyObserver.load(mode, explain=explain)


@lru_cache(maxsize=32)
def _seat(assets: TalkAssets, policy: str, folder: str, bodies: bool, made: str, thread: int) -> Seat:
    # Of these very assets: a seat that outlived them would play where nobody counts.
    name = there(folder, policy)
    if name != policy:
        return replace(_seat(assets, name, "", bodies, made, thread), name=policy)
    if not bodies:
        return seat(assets, policy)
    observer = _observer("full", False, made, thread)
    habit = habits_of(assets, observer) if policy == "reader" else None
    return seat(assets, policy, library=observer.planner.library, habit=habit)


@lru_cache(maxsize=8)
def _content(stall: str, made: str) -> dict[str, str]:
    return content_hashes(watched_files(load_talk_assets(stall_path(stall)).script))


def _record(job: Job, policy: str, episode: int, decisions: list[Decision]) -> None:
    """The talk as a file that ``replay`` plays."""
    moves = [(decision.before, decision.choice) for decision in decisions]
    who = re.sub(r"[^0-9A-Za-z_-]+", "_", f"{Path(job.stall).stem}-{policy}-{job.seed}")
    path = Path(job.record) / f"{who}-{episode:06d}.jsonl"
    write_talk(path, job.stall, policy, moves, decisions[-1].after, _content(job.at, job.made))


def _players(job: Job, assets: TalkAssets) -> list[Seat]:
    mixture = mixture_of(job.population)
    names = [
        mixture.draw(random.Random(f"who {job.seed} {episode}").random())
        for episode in range(job.first, job.first + job.count)
    ]
    return [_seat(assets, name, job.folder, job.bodies, job.made, get_ident()) for name in names]


@lru_cache(maxsize=8)
def _street(stall: str, made: str, thread: int) -> Street:
    """The market; who walks it between visits talks to the others as chance has it."""
    bazaar, script = load_bazaar(), _assets(stall, False, made, thread)[0].script
    if script.stall not in bazaar.stalls or not hears_news(script):
        return Street(bazaar)
    known = {path.stem for path in shipped_stalls()} - {script.stall}
    others = [_assets(name, False, made, thread)[0] for name in bazaar.stalls if name in known]
    return Street(bazaar, tuple(_seat(assets, "random", "", False, made, thread) for assets in others))


def _episodes(job: Job, players: list[Seat]) -> Iterator[list[list[Decision]]]:
    """By episode, the talks of its visits."""
    if job.visits == 1:
        yield from ([talk] for talk in _talks(job, players))
        return
    street = _street(job.at, job.made, get_ident())
    if job.bodies:
        observer = _observer(job.mode, bool(job.log), job.made, get_ident())
        for first in range(0, job.count, BODIES_PER_JOB):
            seats = players[first : first + BODIES_PER_JOB]
            yield from play_outings_with_bodies(observer, seats, street, job.seed, job.first + first, job.visits)
    else:
        for at, player in enumerate(players):
            yield play_outing(player, street, job.seed, job.first + at, job.visits)


def _talks(job: Job, players: list[Seat]) -> Iterator[list[Decision]]:
    """Single visits."""
    if job.bodies:
        observer = _observer(job.mode, bool(job.log), job.made, get_ident())
        for first in range(0, job.count, BODIES_PER_JOB):
            seats = players[first : first + BODIES_PER_JOB]
            yield from play_with_bodies(observer, seats, job.seed, job.first + first)
    else:
        for at, player in enumerate(players):
            yield list(play_episode(player, job.seed, job.first + at))


def work(job: Job) -> Result:
    """Play the episodes of a job. Raises BadInput for content that cannot be played to an end."""
    result, rows = Result(job.number), []
    if job.made:
        _check_made(job.made, job.stall, job.population, job.folder)
    assets, trace = _assets(job.at, job.cover, job.made, get_ident())
    if trace is not None:
        trace.take()
    players = _players(job, assets)
    for episode, (player, talks) in enumerate(zip(players, _episodes(job, players), strict=True), job.first):
        for visit, decisions in enumerate(talks, 1):
            if not decisions:
                raise BadInput(f"episode {episode}", expected="at least one decision", seen="a talk that ends at once")
            tallies = result.tallies if visit == 1 else result.returns
            tallies.setdefault(player.name, Tally()).add(decisions)
            result.coverage.add(decisions)
            if job.record:
                _record(job, player.name, episode, decisions)
            if job.bodies:
                _cover_faces(player, decisions, result.coverage)
            if job.log:
                mode, number = job.mode if job.bodies else None, visit if job.visits > 1 else 0
                rows.append(log_lines(player.assets.script.stall, player.name, episode, decisions, mode, number))
    if trace is not None:
        result.coverage.conditions = trace.take()
    data = "".join(rows).encode()
    result.rows = gzip.compress(data, 6, mtime=0) if job.log == "gzip" else data
    return result


def _cover_faces(player: Seat, decisions: list[Decision], coverage: Coverage) -> None:
    """Which parts of the face were drawn for what was shown."""
    for decision in decisions:
        shown: tuple[Any, ...] = shown_values(player.assets.person, decision.after.feeling)
        parts, _, _ = player.eyes.face_eye.drawn(shown)
        coverage.parts.update(parts)
