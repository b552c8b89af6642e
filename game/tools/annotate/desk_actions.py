"""The desk's commands beyond edits: what windows, menus and keys have in common, and work that takes a while."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field
from pathlib import Path

from game.core.errors import BadInput
from game.embos.clip_shelf import ClipShelf
from game.tools.annotate.agreement import Agreement, agreement
from game.tools.annotate.desk_jobs import Job, learnable, proposed_marks, sheets_by_file, tried
from game.tools.annotate.desk_motion import Orbit
from game.tools.annotate.desk_state import Desk
from game.tools.annotate.document import Document
from game.tools.annotate.files import read_document
from game.tools.annotate.statistics import Statistics, statistics_of

__all__ = ["STYLES", "Actions"]

STYLES = ("character", "stall", "stick")


@dataclass
class Actions:
    """behaviours: the repertoire's file; learn: folder of annotated takes to learn from besides those of the desk.

    shelf: motions that have been read.
    searching, typing: what the window is asked to open (a search for a behaviour; the field of words or note);
    findings: all that kept the last try from being written, until it has been read.
    """

    desk: Desk
    behaviours: Path
    learn: Path
    shelf: ClipShelf = field(default_factory=ClipShelf)
    orbit: Orbit = field(default_factory=Orbit)
    style: str = "character"
    searching: bool = False
    typing: str = ""
    help: bool = False
    leaving: bool = False
    done: bool = False
    findings: tuple[str, ...] = ()
    job: Job | None = None
    second: Document | None = None
    second_name: str = ""
    _counted: tuple[tuple[Document, ...], Statistics] | None = None
    _agreed: tuple[Document, Document, Agreement] | None = None
    _others: dict[Path, Document] | None = None

    # -- looking -----------------------------------------------------------------------------------------------------
    @property
    def half_second(self) -> int:
        """In frames."""
        return max(round(0.5 * self.desk.document.fps), 1)

    def step(self, frames: int) -> None:
        """Frames on or back, the time line follows."""
        self.desk.clock.step(frames)
        self.desk.view.follow(self.desk.clock.time_s)

    def zoom(self, notches: int) -> None:
        """The time line nearer or further about the play head."""
        view = self.desk.view
        view.zoom(1.4**notches, view.x(self.desk.clock.time_s))

    def fold(self) -> None:
        """The layer in hand as one track, or as rows."""
        self.desk.folded ^= {self.desk.layer}

    def next_style(self) -> None:
        """Another way to show the motion."""
        self.style = STYLES[(STYLES.index(self.style) + 1) % len(STYLES)]

    def take(self, step: int) -> None:
        """The next take, or the one before."""
        self.desk.take(self.desk.active + step)

    def toggle_snap(self) -> None:
        """Whether edges are drawn to other edges, words, frames."""
        self.desk.snap = not self.desk.snap
        self.desk.tell("snapping is on" if self.desk.snap else "snapping is off")

    def toggle_help(self) -> None:
        """The sheet of keys."""
        self.help = not self.help

    def let_go(self) -> None:
        """Close what is open, else let the selection go."""
        if self.help or self.findings:
            self.help, self.findings = False, ()
        elif self.desk.begun_s is not None:
            self.desk.begun_s = None
        else:
            self.desk.select(None)

    # -- editing -----------------------------------------------------------------------------------------------------
    def cut(self) -> None:
        """Copy and delete."""
        self.desk.copy()
        self.desk.delete()

    def ask_behaviour(self) -> None:
        """Open the search."""
        self.searching = True

    def ask_text(self, what: str) -> None:
        """Put the keys into the field of words or note."""
        if self.desk.one is None:
            self.desk.tell("select one span first", failed=True)
        else:
            self.typing = what

    # -- work that takes a while -------------------------------------------------------------------------------------
    def read_ahead(self) -> None:
        """Read the folder's other motions beside the window, so that nobody waits for them at the first proposal or
        the first try."""
        paths = [notes.with_suffix(".bvh") for notes in learnable([self.desk.sheet.bvh.parent], Path())]
        threading.Thread(target=self.shelf.fill, args=(paths,), daemon=True, name="reading ahead").start()

    def _begin(self, job: Job) -> None:
        if self.job is not None:
            self.desk.tell(f"still busy: {self.job.what}", failed=True)
            return
        self.job = job.start()
        self.desk.tell(f"{job.what} …")

    def propose(self) -> None:
        """Proposals for the take in hand, learnt from the other takes as they stand now."""
        sheet = self.desk.sheet
        files = learnable([sheet.bvh.parent, self.learn], sheet.notes)
        others, repertoire = sheets_by_file(self.desk.sheets), self.desk.repertoire
        document, clip, shelf = sheet.now, sheet.clip, self.shelf
        self._begin(
            Job(
                f"learning from {len(files)} takes",
                lambda: proposed_marks(document, clip, others, files, repertoire, shelf.clip),
                lambda proposed: self.desk.take_proposals(sheet, proposed.marks),
            )
        )

    def try_it(self) -> None:
        """Save, count the units of the folder anew; a game that watches takes them up."""
        unsaid = [sheet.now.take for sheet in self.desk.sheets if not sheet.now.emotion]
        if unsaid:
            told = f"which emotion does {unsaid[0]} show? say it on the page Span, with nothing selected"
            self.desk.tell(told, failed=True)
            return
        if not self.desk.save():
            return
        folder, behaviours, shelf = self.desk.sheet.bvh.parent, self.behaviours, self.shelf
        self._begin(Job("counting the units", lambda: tried(folder, behaviours, shelf), self.desk.tell))

    def tick(self, elapsed_s: float) -> None:
        """Let time pass; take in what has been finished."""
        self.desk.tick(elapsed_s)
        if self.job is not None:
            self.job.wait(min(0.5 * elapsed_s, 0.5))
            over, wrong = self.job.poll()
            if over:
                self.job = None
            if wrong is not None:
                self.desk.tell(str(wrong), failed=True)
                self.findings = tuple(str(f) for f in wrong.findings) if isinstance(wrong, BadInput) else ()

    def quit(self) -> None:
        """Close the desk; where work is unsaved, ask first."""
        if self.desk.unsaved:
            self.leaving = True
        else:
            self.done = True

    # -- figures -----------------------------------------------------------------------------------------------------
    def others(self) -> dict[Path, Document]:
        """The other annotated takes of the folder: with those on the desk they make the statistics."""
        if self._others is None:
            self._others = {}
            on_desk = set(sheets_by_file(self.desk.sheets))
            for notes in learnable([self.desk.sheets[0].bvh.parent], Path()):
                if notes.resolve() not in on_desk:
                    try:
                        self._others[notes] = read_document(notes)
                    except BadInput as error:
                        self.desk.tell(f"left out of the statistics: {error}", failed=True)
        return self._others

    def statistics(self) -> Statistics:
        """Of all takes of the folder, those on the desk as they stand now."""
        now = tuple(sheet.now for sheet in self.desk.sheets)
        if self._counted is None or self._counted[0] != now:
            self._counted = now, statistics_of([*now, *self.others().values()], self.desk.repertoire)
        return self._counted[1]

    def compare_with(self, path: Path) -> None:
        """Take a second annotation of the take in hand to compare with."""
        try:
            second = read_document(path)
            agreement(self.desk.document, second)
        except BadInput as error:
            self.desk.tell(str(error), failed=True)
            return
        self.second, self.second_name = second, path.name

    def agreement(self) -> Agreement | None:
        """How far the take in hand and the second annotation agree; None without one of the same motion."""
        now, second = self.desk.document, self.second
        if second is None or second.frames != now.frames:
            return None
        if self._agreed is None or self._agreed[0] is not now or self._agreed[1] is not second:
            self._agreed = now, second, agreement(now, second)
        return self._agreed[2]
