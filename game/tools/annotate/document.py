"""One take's annotation as an immutable document: every edit makes a new one, so undo is keeping the old ones."""

from __future__ import annotations

import bisect
import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from game.core.errors import BadInput, Where
from game.embos.findings import Findings
from game.embos.units import LAYERS

__all__ = ["LONGEST_S", "MOMENT_S", "TRACKS", "Document", "Mark", "Word", "check_overlaps", "on_grid"]

MOMENT_S = 0.001
"""Times are kept in whole milliseconds: ELAN's unit, and what the files hold."""

LONGEST_S = 1_000_000.0
"""No take lasts longer: eleven days."""

TRACKS = LAYERS
"""The layers of EMBOS, each a track of the timeline."""


def on_grid(time_s: float) -> float:
    """The nearest whole millisecond, seconds."""
    return round(round(time_s / MOMENT_S) * MOMENT_S, 3)


@dataclass(frozen=True, order=True)
class Mark:
    """A span somebody saw: seconds from the take's start. stroke_s: when a gesture strikes; words: what it goes with.

    confidence: 0..1 of a proposal that nobody has looked at yet, None once a person stands behind it.
    """

    start_s: float
    end_s: float
    layer: str
    behaviour: str
    stroke_s: float | None = None
    words: str = ""
    note: str = ""
    confidence: float | None = None

    @property
    def length_s(self) -> float:
        """Seconds."""
        return self.end_s - self.start_s


@dataclass(frozen=True, order=True)
class Word:
    """A spoken word, seconds."""

    start_s: float
    end_s: float
    text: str


@dataclass(frozen=True)
class Document:
    """A take's annotation. marks and spoken are sorted by time; frames: how many the motion has, fps its rate.

    emotion is empty until somebody says which of the seven the take shows.
    """

    take: str
    bvh: str
    fps: float
    frames: int
    emotion: str = ""
    author: str = ""
    version: int = 1
    note: str = ""
    licence: str = ""
    marks: tuple[Mark, ...] = ()
    spoken: tuple[Word, ...] = ()

    @property
    def length_s(self) -> float:
        """Seconds: as many frame times as there are frames, in whole milliseconds and never beyond the motion."""
        return int(self.frames / self.fps / MOMENT_S + 1e-6) * MOMENT_S

    def of_layer(self, layer: str) -> list[Mark]:
        """The marks of one layer, in order; they do not overlap."""
        return [mark for mark in self.marks if mark.layer == layer]

    def at(self, layer: str, time_s: float) -> Mark | None:
        """What a layer shows at a time."""
        return next((m for m in self.of_layer(layer) if m.start_s <= time_s < m.end_s), None)

    def with_marks(self, marks: Iterator[Mark] | list[Mark] | tuple[Mark, ...]) -> Document:
        """The same take with other marks, sorted."""
        return replace(self, marks=tuple(sorted(marks, key=_order)))

    def gaps(self, layer: str) -> list[tuple[float, float]]:
        """Stretches in which a layer says nothing, seconds; those below a frame are none."""
        edges, found = 0.0, []
        for mark in self.of_layer(layer):
            if mark.start_s - edges > 1.0 / self.fps:
                found.append((edges, mark.start_s))
            edges = max(edges, mark.end_s)
        if self.length_s - edges > 1.0 / self.fps:
            found.append((edges, self.length_s))
        return found

    def room(self, layer: str, time_s: float, without: Mark | None = None) -> tuple[float, float] | None:
        """The free stretch of a layer around a time, as if ``without`` were not there; None inside another mark."""
        others = [m for m in self.of_layer(layer) if m is not without and m != without]
        at = bisect.bisect_right([m.start_s for m in others], time_s)
        if at and others[at - 1].end_s > time_s:
            return None
        low = others[at - 1].end_s if at else 0.0
        return low, others[at].start_s if at < len(others) else self.length_s

    def frame_of(self, time_s: float) -> int:
        """The nearest frame."""
        return min(max(round(time_s * self.fps), 0), self.frames)


def check_overlaps(document: Document, places: Mapping[Mark, Where], findings: Findings) -> None:
    """Within one layer only one thing can be done at a time: a finding for each mark that begins too early.

    places: where each mark stands in its file.
    """
    for layer in LAYERS:
        for before, after in itertools.pairwise(document.of_layer(layer)):
            if after.start_s < before.end_s - 1e-6:
                findings.add(
                    BadInput(
                        f"overlapping {layer} spans",
                        where=places.get(after),
                        expected=f"a start at or after {before.end_s:g} s, where {before.behaviour} ends",
                        seen=f"{after.behaviour} at {after.start_s:g}",
                    )
                )


def _order(mark: Mark) -> tuple[float, float, str, str]:
    return mark.start_s, mark.end_s, mark.layer, mark.behaviour
