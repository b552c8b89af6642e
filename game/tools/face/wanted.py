"""What is wanted of a face, as typed or dragged: a point, a Gaussian, or seven values; and the faces that say it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.core import EMOTIONS, BadInput
from game.face import Face, FaceSearch, Proposal, log_density

__all__ = ["COHERENCE", "DIVERSITY", "Found", "Proposer", "Wanted", "parse_spread", "points_around"]

Floats = NDArray[np.float64]

COHERENCE = 6.0
"""How much score a face gains whose parts all say one and the same emotion. On two axes alone a vein and a smile
cancel out to a fitting point; nobody would draw that. 0 leaves the paper's model by itself."""
DIVERSITY = 2.5
"""Score lost by a face that shares all its parts with those already proposed."""
_CLEAR, _FULL = 0.3, 0.6
"""A part of the lower affinity to an emotion does not contradict it, of the higher says it outright."""
_FAR = 1.0
"""Sense and variety may cost a face this much log-density against the best; beyond it, they cost twice."""


@dataclass(frozen=True)
class Wanted:
    """point: (valence, arousal) in −1..1; spread: covariance (2, 2) or None; emotion: (7,) or None, which decides."""

    point: tuple[float, float]
    spread: Floats | None = None
    emotion: Floats | None = None

    def __post_init__(self) -> None:
        if not all(np.isfinite(v) and abs(v) <= 1.0 for v in self.point):
            raise BadInput("wanted point", expected="valence and arousal from -1 to 1", seen=self.point)

    def __str__(self) -> str:
        if self.emotion is not None:
            named = [f"{name} {value:.2g}" for name, value in zip(EMOTIONS, self.emotion, strict=True) if value > 0.005]
            return ", ".join(named)
        text = f"valence {self.point[0]:+.2f}, arousal {self.point[1]:+.2f}"
        if self.spread is not None:
            valence, arousal = np.sqrt(np.diag(self.spread))
            text += f" ± {valence:.2f}, {arousal:.2f}"
        return text


@dataclass(frozen=True)
class Found:
    """A proposal with the log-density of the wanted point under it (the paper's measure, whatever the order by)."""

    proposal: Proposal
    log_density: float

    @property
    def face(self) -> Face:
        return self.proposal.face


class Proposer:
    """Proposes faces of a model; how well their parts go together is computed once."""

    def __init__(self, search: FaceSearch) -> None:
        self.search = search
        regions = search.model.parts.regions
        told = np.zeros((*search.counts, len(EMOTIONS)))
        weakest = np.ones_like(told)
        lively, calm = np.zeros(search.counts), np.zeros(search.counts)
        for axis, region in enumerate(regions):
            along = tuple(-1 if i == axis else 1 for i in range(len(regions)))
            affinity = region.affinity
            told = told + np.minimum(affinity / _FULL, 1.0).reshape(*along, len(EMOTIONS)) / len(regions)
            fits = np.minimum(affinity / _CLEAR, 1.0)
            fits[0] = 1.0  # the standard part goes with everything
            weakest = np.minimum(weakest, fits.reshape(*along, len(EMOTIONS)))
            lively = np.maximum(lively, region.mean[:, 1].reshape(along))
            calm = np.maximum(calm, -region.mean[:, 1].reshape(along))
        # (F,) at most 1: how far the parts say one and the same emotion, whether any of them contradicts it, and
        # whether one is wide awake and another half asleep: a roar of laughter under drowsy lids is no calm joy.
        self.sense = (0.5 * told + 0.5 * weakest).max(axis=-1).reshape(-1)
        self.sense -= 0.5 * np.minimum(lively, calm).reshape(-1)

    def score(self, wanted: Wanted, coherence: float = COHERENCE) -> Floats:
        """Score of every face (F,), higher is better; ``coherence`` 0 is the model by itself."""
        if wanted.emotion is not None:
            return self.search.score_emotion(wanted.emotion)
        if wanted.spread is not None:
            score = self.search.score_gaussian(wanted.point, wanted.spread)
        else:
            score = self.search.score_point(wanted.point)
        if coherence == 0.0:
            return score
        short = np.maximum(score.max() - _FAR - score, 0.0)
        return np.asarray(score - short + 2.0 * coherence * self.sense)

    def find(
        self,
        wanted: Wanted,
        top: int,
        *,
        diverse: bool = False,
        coherence: float = COHERENCE,
        locked: Face | None = None,
        free: Sequence[str] = (),
    ) -> list[Found]:
        """The best faces, best first; with ``locked`` only the regions named in ``free`` may differ from it."""
        score = self.score(wanted, coherence)
        proposals = self.search.propose(score, top, DIVERSITY if diverse else 0.0, locked=locked, free=tuple(free))
        return [Found(p, float(log_density(wanted.point, p.mean, p.covariance))) for p in proposals]


def parse_spread(text: str) -> Floats:
    """``0.2`` | ``0.2,0.3`` | ``0.2,0.3,-0.4``: deviations of valence and arousal, correlation -> covariance (2, 2)."""
    try:
        numbers = [float(item) for item in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) == 1:
        numbers *= 2
    valence, arousal, together = (*numbers, 0.0)[:3] if len(numbers) in (2, 3) else (0.0, 0.0, 0.0)
    if not (0.01 <= valence <= 2.0 and 0.01 <= arousal <= 2.0 and abs(together) <= 0.99):
        raise BadInput("spread", expected="SD or SD_VALENCE,SD_AROUSAL[,CORRELATION], SD from 0.01 to 2", seen=text)
    cross = together * valence * arousal
    return np.array([[valence**2, cross], [cross, arousal**2]])


def points_around(radius: float, count: int = 8) -> list[Wanted]:
    """Points around the circle, the first at pure pleasure, counter-clockwise."""
    if not 0.0 < radius <= 1.0:
        raise BadInput("radius", expected="above 0, at most 1", seen=radius)
    angles = np.arange(count) * 2.0 * np.pi / count
    return [
        Wanted((round(float(radius * np.cos(a)), 6) + 0.0, round(float(radius * np.sin(a)), 6) + 0.0)) for a in angles
    ]
