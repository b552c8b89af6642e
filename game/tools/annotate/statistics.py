"""What a set of annotations says at this moment: eq. 2 and 3, profiles, transitions, and what is missing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from game.core.emotion_space import EMOTION_INDEX
from game.core.errors import Where
from game.core.humanoid import REFERENCE
from game.embos.analysis import annotated_s, shares, transitions, units_of
from game.embos.annotations import Span, Take
from game.embos.clips import TakeClip
from game.embos.repertoire import Behaviour
from game.embos.statistics import ALPHA
from game.embos.units import MotionUnit
from game.tools.annotate.document import Document

__all__ = ["Missing", "Statistics", "as_take", "statistics_of"]


@dataclass(frozen=True)
class Missing:
    """What is still to be done in one take: seconds without a posture, proposals nobody has looked at, gestures
    without a stroke."""

    take: str
    unannotated: tuple[tuple[float, float], ...]
    proposals: int
    strokeless: int

    @property
    def unannotated_s(self) -> float:
        """Seconds without any posture."""
        return sum(end - start for start, end in self.unannotated)


@dataclass(frozen=True, eq=False)
class Statistics:
    """units: one per behaviour shown, with intensity (eq. 2), duration and waiting time (eq. 3) per emotion.

    share: (U, 7) of the annotated time each is on stage; transitions: how often b followed a; annotated_s per take.
    """

    units: tuple[MotionUnit, ...]
    share: np.ndarray[tuple[int, int], np.dtype[np.float64]]
    transitions: Mapping[str, Mapping[str, int]]
    annotated_s: Mapping[str, float]
    missing: tuple[Missing, ...]

    def profile(self, behaviour: str) -> np.ndarray[tuple[int], np.dtype[np.float64]] | None:
        """(7,) the emotion profile of a behaviour, as in the paper's figure 4; None where nobody marked it."""
        return next((unit.intensity for unit in self.units if unit.name == behaviour), None)


def statistics_of(
    documents: Sequence[Document], repertoire: Mapping[str, Behaviour], alpha: float = ALPHA
) -> Statistics:
    """The statistics of all documents that say which emotion they show. Behaviours outside the repertoire are left
    out, and so are proposals: both are nobody's observations yet."""
    takes = [as_take(d, repertoire) for d in documents if d.emotion]
    units = units_of(takes, repertoire, alpha)
    missing = [
        Missing(
            d.take,
            tuple(d.gaps("posture")),
            sum(m.confidence is not None for m in d.marks),
            sum(m.layer == "gesture" and m.stroke_s is None for m in d.marks),
        )
        for d in documents
    ]
    return Statistics(
        units=tuple(units),
        share=shares(units) if units else np.zeros((0, 7)),
        transitions=transitions(takes),
        annotated_s={take.name: annotated_s([take]) for take in takes},
        missing=tuple(missing),
    )


def as_take(document: Document, repertoire: Mapping[str, Behaviour]) -> Take:
    """The document as the analysis wants it; its motion is not needed there, only its frame time."""
    still = np.zeros((2, len(REFERENCE), 4), dtype=np.float32)
    still[..., 3] = 1.0
    clip = TakeClip(still, np.zeros((2, 3), dtype=np.float32), 1.0 / document.fps)
    place = Where(document.take)
    spans = [
        Span(m.layer, m.behaviour, m.start_s, m.end_s, m.stroke_s, place)
        for m in document.marks
        if m.confidence is None and m.behaviour in repertoire and repertoire[m.behaviour].layer == m.layer
    ]
    return Take(document.take, EMOTION_INDEX[document.emotion], clip, tuple(spans))
