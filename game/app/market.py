"""The stalls that are open: loaded one after the other beside the running game, left out where they are broken."""

from __future__ import annotations

import queue
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from game.app.bazaar import Bazaar, load_bazaar
from game.app.content import load_talk_assets, stall_path
from game.app.stage import StageAssets, load_stage
from game.app.step import StepAssets
from game.app.talk import TalkAssets
from game.app.wishes import PLAIN_WISH, WishText, load_wishes
from game.core.errors import BadInput, GameError, Where
from game.core.paths import ASSETS
from game.embos import check_habit
from game.render import CharacterModel
from game.story import Script

if TYPE_CHECKING:
    from game.app.avatar import Avatar

__all__ = ["LeftOut", "Market", "Stall", "StallLoader", "has_pictures", "read_stage", "read_stall", "stall_of"]


@dataclass
class Stall:
    """One stall: what a talk there needs, and, once it is loaded, what is seen. ``stand_in``: seen at another's."""

    id: str
    assets: StepAssets
    stage: StageAssets | None = None
    stand_in: bool = False

    @property
    def script(self) -> Script:
        """The stall's dialogue."""
        return self.assets.talk.script


@dataclass(frozen=True)
class LeftOut:
    """Why a stall does not open. kind: the key of the interface's text that says it; place: ``file:line:col`` or the
    file, without folders; detail: one line for whoever mends it."""

    kind: str
    place: str
    detail: str

    @staticmethod
    def of(name: str, error: GameError | OSError) -> LeftOut:
        """From what reading the stall raised."""
        where = getattr(error, "where", None)
        if isinstance(error, NoPictures):
            return LeftOut("stall_no_pictures", name, str(error))
        if where is None:
            return LeftOut("stall_unreadable", Path(getattr(error, "filename", None) or name).name, str(error))
        kind = "stall_faulty" if Path(where.path).suffix in {".yaml", ".yml"} else "stall_unreadable"
        return LeftOut(kind, str(Where(Path(where.path).name, where.line, where.col)), str(error))


class NoPictures(BadInput):
    """A stall that could be talked at, but not be seen."""


@dataclass
class Market:
    """All stalls, in the map's order. ``left_out``: id -> why a stall does not open. ``avatar``: a foreign one in every
    shopkeeper's place."""

    bazaar: Bazaar
    stalls: dict[str, Stall] = field(default_factory=dict)
    left_out: dict[str, LeftOut] = field(default_factory=dict)
    expected: tuple[str, ...] = ()
    wishes: Mapping[tuple[str, str], WishText] = field(default_factory=load_wishes)
    avatar: Avatar | None = None

    @staticmethod
    def single(assets: StepAssets, stage: StageAssets | None = None) -> Market:
        """A market of one stall (the studio, a designer's own script)."""
        name = assets.talk.script.stall
        return Market(load_bazaar(), {name: Stall(name, assets, stage)}, expected=(name,))

    @property
    def scripts(self) -> tuple[Script, ...]:
        """The dialogues of the open stalls, from left to right."""
        return tuple(self.stalls[name].script for name in self.order if name in self.stalls)

    @property
    def order(self) -> tuple[str, ...]:
        """The stalls expected here, from left to right."""
        known = self.bazaar.stalls
        return tuple(sorted(self.expected, key=lambda name: known.index(name) if name in known else len(known)))

    def wish(self, stall: str, item: str) -> WishText:
        """Why a thing is on the list."""
        return self.wishes.get((stall, item), PLAIN_WISH)

    def talks(self) -> dict[str, TalkAssets]:
        """What the talks of the open stalls need."""
        return {name: stall.assets.talk for name, stall in self.stalls.items()}


def has_pictures(person: str, stall: str, folder: Path = ASSETS) -> bool:
    """Whether the files a stall is drawn from are there."""
    wanted = [folder / "characters" / f"{person}.vrm", folder / "characters" / f"{person}.lod.glb"]
    wanted += [folder / "stalls" / f"{stall}{end}" for end in (".glb", ".yaml", "_backdrop.png")]
    return all(path.is_file() for path in wanted)


def read_stall(name: str, base: StepAssets, *, stand_in: bool = False) -> Stall:
    """A stall's dialogue on the given body. Raises BadInput for a script with errors or missing pictures."""
    return stall_of(load_talk_assets(stall_path(name)), base, stand_in=stand_in)


def stall_of(talk: TalkAssets, base: StepAssets, *, stand_in: bool = False) -> Stall:
    """The stall of a dialogue that has been read. Raises BadInput for unknown habits or missing pictures."""
    check_habit(base.planner.library, talk.person.habit_units, talk.person.id)
    stall, person = talk.script.stall, talk.script.person.id
    pictured = has_pictures(person, stall)
    if not pictured and not stand_in:
        raise NoPictures(
            f"stall {stall}", expected=f"pictures of {person} and {stall} in assets/", seen="not all of them"
        )
    return Stall(stall, replace(base, talk=talk), stand_in=not pictured)


def read_stage(stall: Stall, avatar: Avatar | None = None) -> StageAssets:
    """What is seen of a stall, with an avatar in the shopkeeper's place. Raises BadInput with file and place."""
    if stall.stand_in:
        return load_stage(avatar=avatar)
    return load_stage(stall.script.person.id, stall.id, avatar=avatar)


@dataclass(frozen=True)
class _News:
    """What the loader has to tell about a stall: its dialogue is read, it can be seen, or it does not open."""

    name: str
    stall: Stall | None = None
    stage: StageAssets | None = None
    why: LeftOut | None = None


class StallLoader:
    """Reads stalls in a thread of its own: first all dialogues, then what is seen. ``poll`` takes what is ready."""

    def __init__(self, market: Market, names: Sequence[str], base: StepAssets) -> None:
        self._market, self._base = market, base
        self._ready: queue.SimpleQueue[_News] = queue.SimpleQueue()
        self._scripts_read = threading.Event()
        waiting = [stall for stall in market.stalls.values() if stall.stage is None]
        self._thread = threading.Thread(target=self._work, args=(tuple(names), waiting), daemon=True)
        self._thread.start()

    def _work(self, names: tuple[str, ...], waiting: list[Stall]) -> None:
        found = list(waiting)
        for name in names:
            try:
                found.append(read_stall(name, self._base))
                self._ready.put(_News(name, stall=found[-1]))
            except (GameError, OSError) as error:
                self._ready.put(_News(name, why=LeftOut.of(name, error)))
        self._scripts_read.set()
        for stall in found:
            try:
                stage = read_stage(stall, self._market.avatar)
                if isinstance(stage.model, CharacterModel):
                    stage.model.make_all()  # here, not in the frame in which the player walks up
                self._ready.put(_News(stall.id, stage=stage))
            except (GameError, OSError) as error:
                self._ready.put(_News(stall.id, why=LeftOut.of(stall.id, error)))

    def poll(self) -> None:
        """Put into the market what has been read since; to be called by the thread that plays."""
        market = self._market
        while True:
            try:
                news = self._ready.get_nowait()
            except queue.Empty:
                return
            if news.stall is not None:
                market.stalls[news.stall.id] = news.stall
            elif news.stage is not None:
                market.stalls[news.name].stage = news.stage
            elif news.why is not None:
                market.stalls.pop(news.name, None)
                market.left_out[news.name] = news.why

    @property
    def scripts_read(self) -> bool:
        """Whether every dialogue has been read (and ``poll`` has them or will)."""
        return self._scripts_read.is_set()

    def wait_for_scripts(self) -> None:
        """Block until every dialogue has been read (a moment, and only right after the start)."""
        self._scripts_read.wait()
        self.poll()

    def finish(self) -> None:
        """Block until everything has been read."""
        self._thread.join()
        self.poll()
