"""Dialogue edited while it is played: the talk goes on where it stood; a broken file leaves the old one running."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path

from game.app.content import load_talk_assets
from game.app.session import Session
from game.app.talk import TalkState, talk_env
from game.app.world import World
from game.core.errors import BadInput, Where
from game.core.paths import DIALOGUE
from game.story import Finding, Script, Spoken, lint_files, restore, resume
from game.story import save as save_story

__all__ = ["Reloader", "Watch", "reload_script", "watched_files"]

POLL_S = 0.5
"""Files are looked at twice a second."""
SAID_S = 4.0
"""How long the news of a good reload stands."""

Stamp = tuple[int, int, str]


def watched_files(script: Script) -> tuple[Path, ...]:
    """All files a stall's dialogue is read from: itself, its parts, the person, the rules, the expressions."""
    folder = Path(script.path).parent
    beside = folder if (folder / "people").is_dir() else DIALOGUE
    rules = folder / "rules.yaml" if (folder / "rules.yaml").is_file() else DIALOGUE / "rules.yaml"
    others = (beside / "people" / f"{script.person.id}.yaml", rules, beside / "faces.yaml")
    return tuple(dict.fromkeys((*map(Path, script.files), *others)))


@dataclass
class Watch:
    """Tells when files have other contents than before. Times of change are looked at first, contents only then."""

    stamps: dict[Path, Stamp] = field(default_factory=dict)

    def look(self, files: Iterable[Path]) -> bool:
        """Whether the contents of a file changed since the last look; a file never seen before is news to nobody."""
        changed = False
        for path in files:
            before, now = self.stamps.get(path), self._stamp(path)
            self.stamps[path] = now
            changed = changed or (before is not None and before[2] != now[2])
        return changed

    def _stamp(self, path: Path) -> Stamp:
        try:
            found = path.stat()
            before = self.stamps.get(path)
            if before is not None and before[:2] == (found.st_mtime_ns, found.st_size):
                return before
            return found.st_mtime_ns, found.st_size, hashlib.sha256(path.read_bytes()).hexdigest()
        except OSError:
            # An editor may be between taking the old file away and putting the new one there.
            return 0, 0, "gone"


@dataclass
class Reloader:
    """Hot reload of the stall one stands at. ``findings``: what is wrong with the file as it is now, if anything."""

    watch: Watch = field(default_factory=Watch)
    findings: tuple[Finding, ...] = ()
    said: str = ""
    _late_s: float = 0.0
    _said_s: float = 0.0
    _stall: str = ""

    def advance(self, session: Session, elapsed_s: float) -> None:
        """Let real time pass; look at the files twice a second and take in what changed."""
        self._said_s = max(self._said_s - elapsed_s, 0.0)
        if self._said_s == 0.0:
            self.said = ""
        self._late_s += elapsed_s
        if self._late_s < POLL_S:
            return
        self._late_s = 0.0
        script = session.assets.talk.script
        if script.stall != self._stall:
            self._stall, self.findings, self.watch = script.stall, (), Watch()
        if self.watch.look(watched_files(script)):
            self.take_in(session)

    def take_in(self, session: Session) -> None:
        """Read the script anew; keep the running one where the new one has errors."""
        path = Path(session.assets.talk.script.path)
        if not path.is_file():
            return
        try:
            reload_script(session)
        except BadInput as error:
            found = [finding for finding in lint_files([path]) if finding.severity == "error"]
            self.findings = tuple(found) or (Finding("E_BAD_VALUE", error.where or Where(path), str(error)),)
            self.said = ""
            return
        self.findings = ()
        self.said, self._said_s = session.strings("reloaded", file=path.name), SAID_S


def reload_script(session: Session) -> None:
    """Play on with the script as its file is now. Raises BadInput, with nothing changed, where that is impossible."""
    old = session.assets.talk.script
    talk_assets = load_talk_assets(Path(old.path))
    if talk_assets.script.stall != old.stall:
        raise BadInput("stall", expected=f"still {old.stall!r}", seen=talk_assets.script.stall)
    stall = session.market.stalls[session.stall]
    plain = replace(stall.assets, talk=talk_assets)
    world = session.world
    if world.talk is not None:
        story = restore(talk_assets.script, save_story(world.talk.story))
        talk = replace(world.talk, story=story, list_price=talk_assets.script.items[world.talk.item].list_price)
        story, beat = resume(talk_assets.script, story, talk_env(talk, talk_assets))
        world = _with_new_words(world, replace(talk, story=story, beat=beat), beat.lines)
    stall.assets = plain
    session.assets = plain
    if world.talk is not None:
        session.bend()
    session.world = world
    session.designed = True


def _with_new_words(world: World, talk: TalkState, lines: tuple[Spoken, ...]) -> World:
    """The world with the talk as the new script has it: lines still to come are spoken in their new words."""
    new = {line.id: line for line in lines}
    queue = tuple(new[line.id] for line in world.queue if line.id in new)
    return replace(world, talk=talk, queue=queue)
