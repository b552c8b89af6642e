"""What may be done to a document. Each edit is a function from document to document that refuses what cannot be.

Marks of one layer never overlap, lie within the motion, and last at least a frame (postures: a second). An edit that
would break this is bounded where that is what a hand at the mouse means (trim, move), and refused otherwise.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from game.core.errors import BadInput
from game.tools.annotate.document import Document, Mark, on_grid

__all__ = [
    "LEAST_POSTURE_S", "History", "accept", "changed", "copied", "created", "deleted", "least_s", "merged", "moved",
    "snapped", "split", "trimmed",
]  # fmt: skip

LEAST_POSTURE_S = 1.0
"""A posture is held at least this long (SPEC 2)."""


def least_s(document: Document, layer: str) -> float:
    """The shortest a mark of a layer may be, seconds."""
    return LEAST_POSTURE_S if layer == "posture" else 1.0 / document.fps


def created(
    document: Document, layer: str, behaviour: str, start_s: float, end_s: float, **more: object
) -> tuple[Document, Mark]:
    """A new mark from start to end, cut to the room there is. Raises BadInput where there is too little."""
    start_s, end_s = sorted((on_grid(start_s), on_grid(end_s)))
    room = document.room(layer, start_s)
    if room is None:
        taken = document.at(layer, start_s)
        raise BadInput(
            f"new {layer} span", expected="a place that is free",
            seen="" if taken is None else taken.behaviour, hint="trim or delete what is there first",
        )  # fmt: skip
    start_s, end_s = max(start_s, room[0]), min(end_s, room[1])
    _check_length(document, layer, end_s - start_s)
    mark = replace(Mark(start_s, end_s, layer, behaviour), **more)  # type: ignore[arg-type]
    return document.with_marks([*document.marks, mark]), mark


def deleted(document: Document, marks: Iterable[Mark]) -> Document:
    """Without these marks."""
    gone = set(marks)
    return document.with_marks([m for m in document.marks if m not in gone])


def moved(document: Document, mark: Mark, start_s: float) -> tuple[Document, Mark]:
    """The mark begun elsewhere, as long as before; it stops at its neighbours. stroke_s goes with it."""
    length = mark.length_s
    middle = start_s + 0.5 * length
    room = document.room(mark.layer, middle, mark) or document.room(mark.layer, mark.start_s, mark)
    if room is None or room[1] - room[0] < length - 1e-9:
        room = document.room(mark.layer, mark.start_s, mark)
    assert room is not None, "a mark stands where there is room for it"
    start = on_grid(min(max(start_s, room[0]), room[1] - length))
    shift = start - mark.start_s
    stroke = None if mark.stroke_s is None else on_grid(mark.stroke_s + shift)
    return _put(document, mark, replace(mark, start_s=start, end_s=on_grid(start + length), stroke_s=stroke))


def trimmed(
    document: Document, mark: Mark, *, start_s: float | None = None, end_s: float | None = None
) -> tuple[Document, Mark]:
    """Other edges, as far as the neighbours and the least length let them. The stroke stays inside."""
    room = document.room(mark.layer, mark.start_s, mark)
    assert room is not None, "a mark stands where there is room for it"
    least = least_s(document, mark.layer)
    start, end = mark.start_s, mark.end_s
    if start_s is not None:
        start = on_grid(min(max(start_s, room[0]), end - least))
    if end_s is not None:
        end = on_grid(max(min(end_s, room[1]), start + least))
    stroke = None if mark.stroke_s is None else min(max(mark.stroke_s, start), end)
    return _put(document, mark, replace(mark, start_s=start, end_s=end, stroke_s=stroke))


def split(document: Document, mark: Mark, time_s: float) -> tuple[Document, tuple[Mark, Mark]]:
    """Two marks of the same behaviour. The words and the stroke stay with the part the stroke lies in."""
    time_s = on_grid(time_s)
    least = least_s(document, mark.layer)
    if not mark.start_s + least - 1e-9 <= time_s <= mark.end_s - least + 1e-9:
        raise BadInput(
            "split", expected=f"a moment at least {least:.3g} s from both ends of {mark.behaviour}", seen=time_s
        )
    first, second = replace(mark, end_s=time_s), replace(mark, start_s=time_s)
    if mark.stroke_s is not None and mark.stroke_s >= time_s:
        first = replace(first, stroke_s=None, words="")
    else:
        second = replace(second, stroke_s=None, words="")
    rest = [m for m in document.marks if m != mark]
    return document.with_marks([*rest, first, second]), (first, second)


def merged(document: Document, marks: Iterable[Mark]) -> tuple[Document, Mark]:
    """One mark from the first one's start to the last one's end; notes and words are joined.

    Raises BadInput unless all are of one layer and behaviour with nothing else of that layer between.
    """
    own = sorted(set(marks))
    if len(own) < 2 or len({(m.layer, m.behaviour) for m in own}) != 1:
        seen = ", ".join(sorted({m.behaviour for m in own})) or "nothing"
        raise BadInput("merge", expected="at least two spans of one behaviour", seen=seen)
    first, last = own[0], own[-1]
    between = [m for m in document.of_layer(first.layer) if m not in own and first.start_s < m.start_s < last.end_s]
    if between:
        raise BadInput("merge", expected="nothing else between them", seen=between[0].behaviour)
    strokes = [m.stroke_s for m in own if m.stroke_s is not None]
    whole = replace(
        first,
        end_s=last.end_s,
        stroke_s=strokes[0] if strokes else None,
        words=" ".join(dict.fromkeys(m.words for m in own if m.words)),
        note="; ".join(dict.fromkeys(m.note for m in own if m.note)),
        confidence=None if any(m.confidence is None for m in own) else min(m.confidence or 0.0 for m in own),
    )
    rest = [m for m in document.marks if m not in own]
    return document.with_marks([*rest, whole]), whole


def copied(document: Document, mark: Mark, start_s: float) -> tuple[Document, Mark]:
    """The same mark once more, beginning elsewhere. Raises BadInput where there is no room."""
    shift = on_grid(start_s) - mark.start_s
    stroke = None if mark.stroke_s is None else on_grid(mark.stroke_s + shift)
    return created(
        document, mark.layer, mark.behaviour, mark.start_s + shift, mark.end_s + shift,
        stroke_s=stroke, words=mark.words, note=mark.note,
    )  # fmt: skip


def changed(document: Document, mark: Mark, **what: object) -> tuple[Document, Mark]:
    """Another behaviour (of the same layer), stroke, words or note; a person stands behind it from now on."""
    new = replace(mark, **{"confidence": None, **what})  # type: ignore[arg-type]
    if new.stroke_s is not None and not new.start_s <= new.stroke_s <= new.end_s:
        expected = f"a moment from {new.start_s:g} to {new.end_s:g} s"
        raise BadInput("stroke", expected=expected, seen=new.stroke_s)
    return _put(document, mark, new)


def accept(document: Document, marks: Iterable[Mark]) -> Document:
    """Proposals a person has looked at and agrees with."""
    agreed = set(marks)
    return document.with_marks([replace(m, confidence=None) if m in agreed else m for m in document.marks])


def snapped(document: Document, time_s: float, reach_s: float, ignore: Mark | None = None) -> float:
    """A time drawn to the nearest edge of any mark or word within reach, else to the nearest frame."""
    edges = [t for m in document.marks if m != ignore for t in (m.start_s, m.end_s)]
    edges += [t for w in document.spoken for t in (w.start_s, w.end_s)]
    near = min(edges, key=lambda t: abs(t - time_s), default=None)
    if near is not None and abs(near - time_s) <= reach_s:
        return near
    return on_grid(min(document.frame_of(time_s) / document.fps, document.length_s))


def _put(document: Document, old: Mark, new: Mark) -> tuple[Document, Mark]:
    return document.with_marks([new if m == old else m for m in document.marks]), new


def _check_length(document: Document, layer: str, length_s: float) -> None:
    least = least_s(document, layer)
    if length_s < least - 1e-9:
        raise BadInput(f"{layer} span", expected=f"room for at least {least:.3g} s", seen=f"{max(length_s, 0.0):.3g} s")


@dataclass
class History:
    """Undo and redo without end: documents share what did not change, so keeping them all costs little."""

    now: Document
    saved: Document | None = None
    _past: list[tuple[str, Document]] = field(default_factory=list)
    _future: list[tuple[str, Document]] = field(default_factory=list)

    def do(self, name: str, document: Document, *, join: bool = False) -> None:
        """Take an edit. join: it continues the last one of this name (a drag is one step)."""
        if document == self.now:
            return
        if not (join and self._past and self._past[-1][0] == name):
            self._past.append((name, self.now))
        self.now = document
        self._future.clear()

    def undo(self) -> str | None:
        """Back by one step; its name, None where there is nothing to undo."""
        return self._step(self._past, self._future)

    def redo(self) -> str | None:
        """Forward again."""
        return self._step(self._future, self._past)

    def _step(self, source: list[tuple[str, Document]], target: list[tuple[str, Document]]) -> str | None:
        if not source:
            return None
        name, document = source.pop()
        target.append((name, self.now))
        self.now = document
        return name

    @property
    def dirty(self) -> bool:
        """Whether there is something that has not been saved."""
        return self.now != self.saved
