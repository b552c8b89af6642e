"""The desk's table: the takes on it, the play head, what is selected, undo, saving, messages."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from game.core.errors import BadInput
from game.embos.repertoire import Behaviour
from game.embos.units import LAYERS
from game.tools.annotate import edits
from game.tools.annotate.desk_sheet import Sheet
from game.tools.annotate.desk_view import Clock, TimeView
from game.tools.annotate.document import Document, Mark

__all__ = ["TRACK_ORDER", "DeskTable"]

TRACK_ORDER: tuple[str, ...] = ("posture", "mannerism", "gesture")
"""The tracks from top to bottom: the paper's figure 3."""

Edit = Callable[[Document], tuple[Document, tuple[Mark, ...]]]
"""From a document to the changed one and the spans that are in hand then."""


@dataclass
class DeskTable:
    """Several takes, one of them in hand. brush: per layer the behaviour that new spans get."""

    sheets: list[Sheet]
    repertoire: dict[str, Behaviour]
    active: int = 0
    selected: tuple[Mark, ...] = ()
    layer: str = "posture"
    brush: dict[str, str] = field(default_factory=dict)
    folded: set[str] = field(default_factory=lambda: set(LAYERS))
    snap: bool = True
    begun_s: float | None = None
    message: str = ""
    failed: bool = False
    clipboard: tuple[Mark, ...] = ()
    drags: int = 0

    def __post_init__(self) -> None:
        for layer in LAYERS:
            first = next((b.name for b in self.repertoire.values() if b.layer == layer), "")
            self.brush.setdefault(layer, first)
        length = max(sheet.now.length_s for sheet in self.sheets)
        self.clock = Clock(length, self.sheets[0].now.fps)
        self.view = TimeView(self.document.length_s)

    # -- takes -------------------------------------------------------------------------------------------------------
    @property
    def sheet(self) -> Sheet:
        """The take in hand."""
        return self.sheets[self.active]

    @property
    def document(self) -> Document:
        """Its annotation."""
        return self.sheet.now

    def take(self, index: int) -> None:
        """Another take in hand."""
        self.active = index % len(self.sheets)
        self.selected, self.begun_s = (), None
        self.clock.fps = self.document.fps
        if self.view.length_s != self.document.length_s:
            self.view.length_s = self.document.length_s
            self.view.fit()

    @property
    def unsaved(self) -> list[Sheet]:
        """Takes with work that has not been saved."""
        return [sheet for sheet in self.sheets if sheet.history.dirty]

    def tick(self, elapsed_s: float) -> None:
        """Let time pass: the motion plays, changes are kept on the disk."""
        self.clock.advance(elapsed_s)
        if self.clock.playing:
            self.view.follow(self.clock.time_s)
        for sheet in self.sheets:
            try:
                sheet.tick(elapsed_s)
            except (BadInput, OSError) as error:
                self.tell(f"the work could not be kept: {error}", failed=True)

    def save(self) -> bool:
        """Save every take with work in it; True where all is saved."""
        told = []
        try:
            for sheet in self.unsaved:
                told.append(sheet.save())
        except (BadInput, OSError) as error:
            self.tell(str(error), failed=True)
            return False
        self.keep_selection()
        self.tell("; ".join(told) or "nothing to save")
        return True

    # -- telling -----------------------------------------------------------------------------------------------------
    def tell(self, text: str, *, failed: bool = False) -> None:
        """Show a message in the desk's last line."""
        self.message, self.failed = text, failed

    def do(
        self, name: str, edit: Callable[[Document], tuple[Document, tuple[Mark, ...]]], *, join: bool = False
    ) -> bool:
        """Try an edit; what it makes is selected."""
        try:
            document, made = edit(self.document)
        except BadInput as error:
            self.tell(str(error), failed=True)
            return False
        self.sheet.history.do(name, document, join=join)
        self.selected = made
        self.tell(name.partition("#")[0])
        return True

    def keep_selection(self) -> None:
        """Let go of what is no longer there."""
        present = set(self.document.marks)
        self.selected = tuple(m for m in self.selected if m in present)

    def undo(self) -> None:
        """One step back."""
        name = self.sheet.history.undo()
        self.keep_selection()
        self.tell("nothing to undo" if name is None else f"undone: {name.partition('#')[0]}")

    def redo(self) -> None:
        """One step forward again."""
        name = self.sheet.history.redo()
        self.keep_selection()
        self.tell("nothing to redo" if name is None else f"again: {name.partition('#')[0]}")

    # -- selection ---------------------------------------------------------------------------------------------------
    def select(self, mark: Mark | None, *, more: bool = False) -> None:
        """Take a span in hand, or let go; more: in addition to the others, or no longer."""
        if mark is None:
            self.selected = self.selected if more else ()
            return
        self.layer = mark.layer
        if not more:
            self.selected = (mark,)
        elif mark in self.selected:
            self.selected = tuple(m for m in self.selected if m != mark)
        else:
            self.selected = (*self.selected, mark)

    @property
    def one(self) -> Mark | None:
        """The selected span, where it is exactly one."""
        return self.selected[0] if len(self.selected) == 1 else None

    def neighbour(self, step: int) -> None:
        """Select the next (1) or the one before (−1) in the present layer; the play head goes along."""
        marks = self.document.of_layer(self.layer)
        if not marks:
            return
        own = [m for m in self.selected if m.layer == self.layer]
        if own:
            at = marks.index(own[0]) + step
        elif step > 0:
            at = next((i for i, m in enumerate(marks) if m.end_s > self.clock.time_s), len(marks) - 1)
        else:
            at = next((i for i in reversed(range(len(marks))) if marks[i].start_s < self.clock.time_s), 0)
        self.select(marks[min(max(at, 0), len(marks) - 1)])
        self.clock.go_to(self.selected[0].start_s)
        self.view.follow(self.clock.time_s)

    def change_layer(self, step: int) -> None:
        """The layer above or below; what stands under the play head there is selected."""
        at = TRACK_ORDER.index(self.layer) + step
        self.layer = TRACK_ORDER[min(max(at, 0), len(TRACK_ORDER) - 1)]
        here = self.document.at(self.layer, self.clock.time_s)
        self.selected = () if here is None else (here,)

    def next_gap(self) -> None:
        """To the next stretch without a posture, from the play head on and then from the start."""
        gaps = self.document.gaps("posture")
        if not gaps:
            self.tell("a posture is marked everywhere")
            return
        start, end = next((g for g in gaps if g[0] > self.clock.time_s + 1e-6), gaps[0])
        self.clock.go_to(start)
        self.view.follow(start)
        self.tell(f"no posture from {start:.2f} to {end:.2f} s")

    def loop_selection(self) -> None:
        """Play the selected span over and over; without a selection, or again, no longer."""
        span = (min(m.start_s for m in self.selected), max(m.end_s for m in self.selected)) if self.selected else None
        self.clock.loop = None if span == self.clock.loop else span
        if self.clock.loop is not None:
            self.clock.go_to(self.clock.loop[0])

    def snapped(self, time_s: float, reach_px: float = 8.0, ignore: Mark | None = None) -> float:
        """A time drawn to edges, words, frames and the play head, where snapping is on."""
        if not self.snap:
            return time_s
        reach_s = reach_px / max(self.view.px_s, 1e-6)
        if abs(time_s - self.clock.time_s) <= 0.5 * reach_s:
            return self.clock.time_s
        return edits.snapped(self.document, time_s, reach_s, ignore)
