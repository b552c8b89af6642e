"""What takes longer than a frame: learning and proposing, counting the units anew. In a thread, so that the window
stays alive; the result is taken up by the thread that draws."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from game.app.analyse import counted, write_units
from game.core.errors import BadInput, GameError
from game.embos.clip_shelf import ClipShelf
from game.embos.clips import TakeClip
from game.embos.findings import Findings
from game.embos.repertoire import Behaviour
from game.tools.annotate.automatic import Annotator, Example, propose
from game.tools.annotate.desk_sheet import Sheet
from game.tools.annotate.document import Document
from game.tools.annotate.files import read_document
from game.tools.annotate.motion_features import RATE_HZ

__all__ = ["Job", "example_of_known", "learnable", "proposed_marks", "tried"]


@dataclass
class Job:
    """One piece of work beside the window. what: told while it runs; done: takes its result, in the window's thread."""

    what: str
    work: Callable[[], Any]
    done: Callable[[Any], None]
    _result: list[Any] = field(default_factory=list)
    _error: list[Exception] = field(default_factory=list)
    _thread: threading.Thread | None = None

    def start(self) -> Job:
        """Begin."""
        self._thread = threading.Thread(target=self._run, daemon=True, name=self.what)
        self._thread.start()
        return self

    def _run(self) -> None:
        try:
            self._result.append(self.work())
        except (GameError, OSError) as error:
            self._error.append(error)

    def wait(self, seconds: float) -> None:
        """Leave it the interpreter for so long, or until it is over: drawing would keep it to itself."""
        if self._thread is not None:
            self._thread.join(seconds)

    def poll(self) -> tuple[bool, Exception | None]:
        """Whether it is over, and what went wrong; takes the result in when it is."""
        assert self._thread is not None, "start comes first"
        if self._thread.is_alive():
            return False, None
        if self._result:
            self.done(self._result.pop())
        return True, self._error[0] if self._error else None


def learnable(folders: Sequence[Path], without: Path) -> list[Path]:
    """The annotated takes of some folders (NAME.yaml beside NAME.bvh), each name once, the first folder's; without one
    of them: a copy of a take elsewhere would only repeat it."""
    found: dict[str, Path] = {}
    for folder in folders:
        for notes in sorted(folder.glob("[!.]*.yaml")) if folder.is_dir() else []:
            if notes.with_suffix(".bvh").exists() and notes.name != without.name:
                found.setdefault(notes.name, notes)
    return list(found.values())


def example_of_known(document: Document, clip: TakeClip) -> Example | None:
    """What a person has said about a take so far: the stretch from its first to its last posture that has been set,
    without what lies between; None below five seconds of it."""
    whole = Example.of(document, clip)
    known = np.zeros(len(whole.features), dtype=np.bool_)
    for mark in document.of_layer("posture"):
        if mark.confidence is None:
            known[int(mark.start_s * RATE_HZ) : int(mark.end_s * RATE_HZ)] = True
    if known.sum() < 5.0 * RATE_HZ:
        return None
    return Example(whole.features[known], {layer: labels[known] for layer, labels in whole.labels.items()})


def proposed_marks(
    sheet_document: Document,
    clip: TakeClip,
    others: Mapping[Path, tuple[Document, TakeClip]],
    files: Sequence[Path],
    repertoire: Mapping[str, Behaviour],
    read_clip: Callable[[Path], TakeClip],
) -> Document:
    """The document with proposals, learnt from files, from the other takes on the desk as they stand now, and from
    what has been set in this one. Raises BadInput, MissingPart."""
    examples: list[Example] = []
    own = example_of_known(sheet_document, clip)
    if own is not None:
        examples.append(own)
    for notes in files:
        known = others.get(notes.resolve())
        document, motion = known if known else (read_document(notes), read_clip(notes.with_suffix(".bvh")))
        document = document.with_marks([m for m in document.marks if m.behaviour in repertoire])
        if any(m.layer == "posture" and m.confidence is None for m in document.marks):
            examples.append(Example.of(document, motion))
    return propose(Annotator(examples), sheet_document, clip)


def tried(folder: Path, behaviours: Path, shelf: ClipShelf) -> str:
    """The units of a folder of takes, counted anew into units.yaml and clips.npz beside it. Raises a BadInput with
    all that is wrong."""
    findings = Findings()
    takes, units = counted(folder, behaviours, findings, read_clip=shelf.clip)
    if len(findings):
        error = BadInput(f"no units were written: {findings.items[0]}")
        error.findings = tuple(findings.items)
        raise error
    out = folder.resolve().parent / "units.yaml"
    changed = write_units(takes, units, out, shelf.packed)
    verb = "written" if changed else "unchanged"
    return f"{len(units)} units from {len(takes)} takes {verb}: {out}"


def sheets_by_file(sheets: Sequence[Sheet]) -> dict[Path, tuple[Document, TakeClip]]:
    """The takes on the desk by their annotation's file, as they stand now."""
    return {sheet.notes.resolve(): (sheet.now, sheet.clip) for sheet in sheets}
