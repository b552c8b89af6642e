"""What can be done at the desk, without its window: spans are made, dragged, cut, joined, copied, named, accepted.

Every method is safe to call at any time: what cannot be done is told in ``message`` and changes nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

from game.tools.annotate import edits
from game.tools.annotate.desk_sheet import Sheet
from game.tools.annotate.desk_table import DeskTable
from game.tools.annotate.document import Document, Mark, on_grid

__all__ = ["Desk", "Drag", "moved_together"]


@dataclass(frozen=True)
class Drag:
    """A drag with the mouse: every position is tried on the document as it was when the drag began.

    what: move, start, end, stroke; grab_s: where the mouse took hold, seconds; number: makes it one step of undo.
    """

    what: str
    marks: tuple[Mark, ...]
    base: Document
    grab_s: float
    number: int


class Desk(DeskTable):
    """The desk's edits; the table below it holds what they work on."""

    # -- edits -------------------------------------------------------------------------------------------------------
    def create(self, layer: str, start_s: float, end_s: float, behaviour: str | None = None) -> bool:
        """A new span with the layer's brush, or another behaviour."""
        name = behaviour or self.brush[layer]
        self.layer, self.brush[layer] = layer, name

        def edit(document: Document) -> tuple[Document, tuple[Mark, ...]]:
            changed, mark = edits.created(document, layer, name, start_s, end_s)
            return changed, (mark,)

        return self.do(f"new {name}", edit)

    def begin_or_end(self) -> None:
        """With the keyboard: the first call sets where a span begins, the second where it ends."""
        if self.begun_s is None:
            self.begun_s = self.clock.time_s
            self.tell(f"a {self.layer} begins at {self.begun_s:.2f} s; go where it ends and press the key again")
        else:
            # The frame under the play head belongs to the span.
            first, last = sorted((self.begun_s, self.clock.time_s))
            self.begun_s = None
            self.create(self.layer, first, min(last + 1.0 / self.document.fps, self.document.length_s))

    def delete(self) -> None:
        """Without the selected spans."""
        gone = self.selected
        if gone:
            self.do(f"delete {named(gone)}", lambda d: (edits.deleted(d, gone), ()))

    def begin_drag(self, what: str, mark: Mark, time_s: float) -> Drag:
        """Take hold of a span (what: move), one of its edges (start, end) or its stroke."""
        if mark not in self.selected:
            self.select(mark)
        marks = self.selected if what == "move" else (mark,)
        self.drags += 1
        return Drag(what, marks, self.document, time_s, self.drags)

    def drag(self, drag: Drag, time_s: float) -> None:
        """Where the mouse is now: the whole drag is one step of undo."""
        self.do(f"{drag.what} {named(drag.marks)}#{drag.number}", lambda _: self._dragged(drag, time_s), join=True)

    def _dragged(self, drag: Drag, time_s: float) -> tuple[Document, tuple[Mark, ...]]:
        mark = drag.marks[0]
        if drag.what == "move":
            start = mark.start_s + time_s - drag.grab_s
            end = self.snapped(start + mark.length_s, ignore=mark)
            begin = self.snapped(start, ignore=mark)
            nearer_end = abs(end - start - mark.length_s) < abs(begin - start)
            shift = (end - mark.length_s if nearer_end else begin) - mark.start_s
            return moved_together(drag.base, drag.marks, shift)
        time_s = self.snapped(time_s, ignore=mark)
        if drag.what == "stroke":
            document, new = edits.changed(drag.base, mark, stroke_s=min(max(time_s, mark.start_s), mark.end_s))
        elif drag.what == "start":
            document, new = edits.trimmed(drag.base, mark, start_s=time_s)
        else:
            document, new = edits.trimmed(drag.base, mark, end_s=time_s)
        return document, (new,)

    def nudge(self, frames: int) -> None:
        """The selected spans some frames later."""
        marks, shift = self.selected, frames / self.document.fps
        if marks:
            self.do(f"move {named(marks)}", lambda d: moved_together(d, marks, shift), join=True)

    def trim_here(self, edge: str) -> None:
        """The selected span's start or end (edge) to the play head."""
        time_s = self.clock.time_s

        def edit(document: Document, mark: Mark) -> tuple[Document, Mark]:
            if edge == "start":
                return edits.trimmed(document, mark, start_s=time_s)
            return edits.trimmed(document, mark, end_s=time_s)

        self._each(f"trim {edge}", edit)

    def split_here(self) -> None:
        """Two spans where the play head cuts the selected ones, or what lies there in the present layer."""
        here = self.document.at(self.layer, self.clock.time_s)
        marks = self.selected or (() if here is None else (here,))

        def edit(document: Document) -> tuple[Document, tuple[Mark, ...]]:
            made: tuple[Mark, ...] = ()
            for mark in marks:
                document, parts = edits.split(document, mark, self.clock.time_s)
                made += parts[1:]
            return document, made

        if marks:
            self.do(f"split {named(marks)}", edit)
        else:
            self.tell(f"no {self.layer} under the play head", failed=True)

    def merge(self) -> None:
        """One span from the selected ones; a single one is merged with the next."""
        marks = self.selected
        if len(marks) == 1:
            after = [m for m in self.document.of_layer(marks[0].layer) if m.start_s >= marks[0].end_s][:1]
            marks = (*marks, *after)

        def edit(document: Document) -> tuple[Document, tuple[Mark, ...]]:
            changed, mark = edits.merged(document, marks)
            return changed, (mark,)

        self.do("merge", edit)

    def copy(self) -> None:
        """Remember the selected spans."""
        if self.selected:
            self.clipboard = tuple(sorted(self.selected))
            self.tell(f"copied {named(self.clipboard)}")

    def paste(self, time_s: float | None = None) -> None:
        """The remembered spans once more, the first at the play head (or another time)."""
        marks = self.clipboard
        if not marks:
            self.tell("nothing has been copied", failed=True)
            return
        shift = (self.clock.time_s if time_s is None else time_s) - marks[0].start_s

        def edit(document: Document) -> tuple[Document, tuple[Mark, ...]]:
            made: list[Mark] = []
            for mark in marks:
                document, new = edits.copied(document, mark, mark.start_s + shift)
                made.append(new)
            return document, tuple(made)

        self.do(f"paste {named(marks)}", edit)

    def _each(self, name: str, edit: Callable[[Document, Mark], tuple[Document, Mark]], *, join: bool = False) -> bool:
        marks = self.selected
        if not marks:
            self.tell("no span is selected", failed=True)
            return False

        def together(document: Document) -> tuple[Document, tuple[Mark, ...]]:
            made = []
            for mark in marks:
                document, new = edit(document, mark)
                made.append(new)
            return document, tuple(made)

        return self.do(name, together, join=join)

    def set_behaviour(self, name: str) -> None:
        """Another behaviour for the selected spans, and for the next ones of its layer."""
        layer = self.repertoire[name].layer
        self.brush[layer] = name
        if not self.selected:
            self.layer = layer
            self.tell(f"new {layer} spans will be {name}")
        elif any(m.layer != layer for m in self.selected):
            self.tell(f"{name} is a {layer}", failed=True)
        else:
            self._each(f"call it {name}", lambda d, m: edits.changed(d, m, behaviour=name))

    def change(self, **what: str | float | None) -> None:
        """Words, note or stroke_s of the selected spans."""
        self._each(f"set {', '.join(what).replace('_s', '')}", lambda d, m: edits.changed(d, m, **what))

    def stroke_here(self) -> None:
        """The play head is where the gesture strikes; there already: it has no stroke."""
        mark = self.one
        here = None if mark is not None and mark.stroke_s == self.clock.time_s else self.clock.time_s
        self.change(stroke_s=here)

    def describe(self, **what: str) -> None:
        """Emotion, author, note or licence of the take in hand."""
        document = replace(self.document, **what)  # type: ignore[arg-type]
        self.sheet.history.do(f"set {', '.join(what)}", document, join=True)

    # -- proposals ---------------------------------------------------------------------------------------------------
    def proposals(self, marks: Iterable[Mark] | None = None) -> tuple[Mark, ...]:
        """The spans a program proposed that nobody has looked at."""
        return tuple(m for m in (self.document.marks if marks is None else marks) if m.confidence is not None)

    def accept(self, *, everything: bool = False) -> None:
        """The selected proposals, or all, are right."""
        agreed = self.proposals(None if everything else self.selected)
        kept = tuple(replace(m, confidence=None) for m in agreed)
        if agreed:
            self.do(f"accept {len(agreed)}", lambda d: (edits.accept(d, agreed), () if everything else kept))

    def reject(self, *, everything: bool = False) -> None:
        """The selected proposals, or all, are wrong."""
        wrong = self.proposals(None if everything else self.selected)
        if wrong:
            self.do(f"reject {len(wrong)}", lambda d: (edits.deleted(d, wrong), ()))

    def take_proposals(self, sheet: Sheet, proposed: Iterable[Mark]) -> None:
        """New proposals instead of the old, wherever nothing has been marked meanwhile."""
        kept = [m for m in sheet.now.marks if m.confidence is None]
        document, count = sheet.now.with_marks(kept), 0
        for mark in proposed:
            room = document.room(mark.layer, mark.start_s + 0.5 * mark.length_s)
            if mark.confidence is None or room is None:
                continue
            start, end = max(mark.start_s, room[0]), min(mark.end_s, room[1])
            if end - start >= edits.least_s(document, mark.layer):
                document = document.with_marks([*document.marks, replace(mark, start_s=start, end_s=end)])
                count += 1
        sheet.history.do("propose", document)
        self.keep_selection()
        self.tell(f"{count} proposed for {sheet.now.take}: A accepts, R rejects, Tab goes on to the next")


def moved_together(document: Document, marks: Iterable[Mark], shift_s: float) -> tuple[Document, tuple[Mark, ...]]:
    """All marks moved alike: as far as the one that is stopped first. One alone may jump over what is in its way."""
    own = sorted(marks)
    if len(own) == 1:
        document, new = edits.moved(document, own[0], own[0].start_s + shift_s)
        return document, (new,)
    rest = edits.deleted(document, own)
    for mark in own:
        room = rest.room(mark.layer, mark.start_s)
        assert room is not None, "a mark stands where there is room for it"
        shift_s = min(max(shift_s, room[0] - mark.start_s), room[1] - mark.end_s)
    made = tuple(
        replace(
            mark,
            start_s=on_grid(mark.start_s + shift_s),
            end_s=on_grid(mark.end_s + shift_s),
            stroke_s=None if mark.stroke_s is None else on_grid(mark.stroke_s + shift_s),
        )
        for mark in own
    )
    return rest.with_marks([*rest.marks, *made]), made


def named(marks: Iterable[Mark]) -> str:
    own = list(marks)
    return own[0].behaviour if len(own) == 1 else f"{len(own)} spans"
