"""Motion units counted anew while the game runs: a watched folder's units.yaml and clips.npz are taken up, or the old
ones go on where the new are broken. Read in a thread, so that no frame waits."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field, replace
from pathlib import Path

from game.animation import KnownUnits, Performer
from game.app.reload import Watch
from game.app.session import Session
from game.app.step import forget_planners
from game.core.errors import BadInput, GameError
from game.core.paths import ASSETS
from game.embos import KnownClips, Planner, UnitLibrary, load_config

__all__ = ["Known", "UnitsWatch", "load_body", "take_up_units", "watched_units"]

POLL_S = 0.1
"""Files are looked at ten times a second: new units are to be seen within a second."""
YIELD_SHARE, MOST_YIELD_S = 0.75, 1.0
"""While new units are read a frame waits for them by this share of it: drawing keeps the interpreter to itself, and the
reading would hardly get on beside it. A machine that draws slowly waits once, one that draws fast is not seen to."""
SAID_S = 6.0
"""How long the news of new units stands; that they are broken stands until they are not."""


def watched_units(folder: Path) -> Path:
    """The units file that a folder stands for: its own, or that beside a folder of takes. Raises BadInput."""
    if not folder.is_dir():
        raise BadInput("--watch", expected="a folder with units.yaml, or of takes", seen=str(folder))
    beside = folder.resolve().parent / "units.yaml"
    inside = folder / "units.yaml"
    return beside if beside.is_file() and not inside.is_file() else inside


@dataclass
class Known:
    """What readings have in common: takes and units that did not change are not made anew."""

    clips: KnownClips = field(default_factory=KnownClips)
    units: KnownUnits = field(default_factory=KnownUnits)


def load_body(units: Path, known: Known | None = None) -> tuple[Planner, Performer]:
    """Units with their clips, ready to be played. Raises BadInput with file and place."""
    own = units.parent / "planner.yaml"
    known = known or Known()
    library = UnitLibrary.load(units, known.clips)
    planner = Planner(library, load_config(own if own.is_file() else ASSETS / "motion" / "planner.yaml"))
    return planner, Performer(library, layers=planner.tables.layers, known=known.units)


def take_up_units(session: Session, planner: Planner, performer: Performer) -> None:
    """Every stall's shopkeeper moves by these units from now on, from the pose of this moment; the talk goes on."""
    world = session.world
    state, moving, before = planner.start(1, world.seed), world.body.performer, session.assets.performer
    body = replace(
        world.body,
        planner=state,
        decisions=state.decisions,
        performer=None if moving is None or before is None else performer.adopt(moving, before),
        signal=None,
    )
    # What the present line calls up is counted in the old units' order.
    speech = None if world.speech is None else replace(world.speech, cues=None)
    session.world = replace(world, body=body, speech=speech)
    _equip(session, planner, performer)
    forget_planners()
    session.designed = True


def _equip(session: Session, planner: Planner, performer: Performer) -> None:
    for stall in session.market.stalls.values():
        if stall.assets.planner is not planner:
            stall.assets = replace(stall.assets, planner=planner, performer=performer)
    if session.assets.planner is not planner:
        session.assets = replace(session.assets, planner=planner, performer=performer)


@dataclass
class UnitsWatch:
    """Watches one units file. said: what the player is told; broken: whether that is why the new units are not used."""

    units: Path
    said: str = ""
    broken: bool = False
    _watch: Watch = field(default_factory=Watch)
    _late_s: float = POLL_S
    _said_s: float = 0.0
    _seen: bool = False
    _fresh: bool = False  # changed at the last look; read once two looks are alike, for the files are two
    _thread: threading.Thread | None = None
    _known: Known = field(default_factory=Known)
    _read: list[tuple[Planner, Performer] | str] = field(default_factory=list)
    _body: tuple[Planner, Performer] | None = None

    @property
    def files(self) -> tuple[Path, Path]:
        """What is watched."""
        return self.units, self.units.parent / "clips.npz"

    def advance(self, session: Session, elapsed_s: float) -> None:
        """Let real time pass: look, begin to read, take up what has been read."""
        if self._body is not None:
            _equip(session, *self._body)  # stalls that were still being read when the units came
        if self.said and not self.broken:
            self._said_s -= elapsed_s
            self.said = self.said if self._said_s > 0.0 else ""
        self._late_s += elapsed_s
        if self._thread is not None:
            self._thread.join(min(YIELD_SHARE * elapsed_s, MOST_YIELD_S))
        read = self._thread is not None and not self._thread.is_alive()
        if self._late_s < POLL_S and not read:
            return
        self._late_s = 0.0
        changed = self._watch.look(self.files) or not self._seen
        self._seen = True
        if self._thread is None:
            if self._fresh and not changed:
                self._begin()
            self._fresh = changed
        elif not self._thread.is_alive():
            self._thread = None
            found = self._read.pop()
            if changed:
                self._fresh = True  # the files changed while they were read: what was read may be half of each
            else:
                self._end(session, found)
        elif changed:
            self._seen = False  # look again as soon as this reading is over

    def wait(self) -> None:
        """Block until what is being read has been read (tests, pictures)."""
        if self._thread is not None:
            self._thread.join()

    def _begin(self) -> None:
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    def _work(self) -> None:
        try:
            self._read.append(load_body(self.units, self._known))
        except (GameError, OSError) as error:
            self._read.append(str(error))

    def _end(self, session: Session, found: tuple[Planner, Performer] | str) -> None:
        self.broken = isinstance(found, str)
        if isinstance(found, str):
            self.said = session.strings("units_broken", reason=found[:140])
            return
        self._body = found
        take_up_units(session, *found)
        self.said = session.strings("units_reloaded", count=sum(not u.is_rest for u in found[0].library.units))
        self._said_s = SAID_S
