"""One take on the desk: its motion, its annotation with undo, its file and its autosave."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from pathlib import Path

from game.core.errors import BadInput
from game.embos.clip_shelf import ClipShelf
from game.embos.clips import TakeClip
from game.tools.annotate.document import Document
from game.tools.annotate.edits import History
from game.tools.annotate.files import clear_autosave, open_document, recover, save, write_autosave

__all__ = ["AUTOSAVE_S", "Sheet"]

AUTOSAVE_S = 2.0
"""So long after a change the work is on the disk, whatever happens to the window."""


@dataclass
class Sheet:
    """A take that is being annotated.

    offer: what an interrupted session left, until somebody has said whether to take it up; refusal: why what it left
    cannot be used. on_disk: digest of the file as it was read or written here last, "" without a file.
    """

    bvh: Path
    clip: TakeClip
    history: History
    offer: Document | None = None
    refusal: str = ""
    on_disk: str = ""
    _kept: Document | None = None
    _waiting_s: float = 0.0

    @staticmethod
    def open(bvh: Path, author: str = "", shelf: ClipShelf | None = None) -> Sheet:
        """The take with its annotation, or an empty one. shelf: motions that have been read. Raises BadInput for files
        that cannot be read."""
        clip = (shelf or ClipShelf()).clip(bvh)
        document = open_document(bvh, author, clip)
        sheet = Sheet(bvh, clip, History(document, saved=document), on_disk=_digest(bvh.with_suffix(".yaml")))
        offer, sheet.refusal = recover(sheet.notes)
        if offer is not None and (offer.frames, round(offer.fps, 3)) != (document.frames, round(document.fps, 3)):
            sheet.refusal = f"what was left of {bvh.stem} belongs to a motion of {offer.frames} frames; it stays beside"
        elif offer is not None and replace(offer, fps=document.fps) != document:
            sheet.offer = replace(offer, fps=document.fps)
        return sheet

    @property
    def notes(self) -> Path:
        """The annotation's file."""
        return self.bvh.with_suffix(".yaml")

    @property
    def now(self) -> Document:
        """The annotation as it stands."""
        return self.history.now

    def take_up(self, *, wanted: bool) -> None:
        """Go on with what the interrupted session left, or let it go."""
        if self.offer is not None and wanted:
            self.history.do("take up unsaved work", self.offer)
        self.offer = None
        if not wanted:
            clear_autosave(self.notes)

    def save(self) -> str:
        """Write the annotation, one version on; returns what there is to tell. Raises BadInput, nothing written.

        Where somebody else has written the file meanwhile, theirs is kept beside as .yaml.before.
        """
        told = f"saved {self.notes.name}"
        if self.notes.exists() and _digest(self.notes) != self.on_disk:
            theirs = self.notes.with_suffix(".yaml.before")
            self.notes.replace(theirs)
            told += f"; it had been changed by another program, whose text is kept as {theirs.name}"
        saved = self.history.saved
        if saved is not None and self.on_disk and self.history.dirty:
            self.history.now = replace(self.now, version=max(saved.version, self.now.version) + 1)
        save(self.now, self.notes)
        clear_autosave(self.notes)
        self.on_disk = _digest(self.notes)
        self.history.saved = self._kept = self.now
        return told

    def tick(self, elapsed_s: float) -> None:
        """Let time pass: a change is on the disk AUTOSAVE_S after it was made. Raises BadInput where it cannot be."""
        if not self.history.dirty or self.now == self._kept or self.offer is not None:
            self._waiting_s = 0.0
            return
        self._waiting_s += elapsed_s
        if self._waiting_s >= AUTOSAVE_S:
            self.keep()

    def keep(self) -> None:
        """Write the autosave now. Raises BadInput."""
        self._waiting_s = 0.0
        self._kept = self.now
        write_autosave(self.now, self.notes)

    def drop(self) -> None:
        """The work since the last save is not wanted."""
        clear_autosave(self.notes)


def _digest(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest() if path.exists() else ""
    except OSError as error:
        raise BadInput(str(path), expected="a file that can be read", seen=str(error)) from None
