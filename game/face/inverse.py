"""From a wanted emotion to faces, best first: the paper's open task (Nagai et al., section 5).

A face is scored by the log-density of the wanted point under the face's Gaussian; for a wanted Gaussian by the
negative Kullback–Leibler divergence from it; for a seven-value emotion by the log-density of its place plus the
parts' mean affinity, because fear, anger and disgust share nearly the same valence and arousal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from game.core import BadInput
from game.face.model import FaceModel
from game.face.parts import Face

__all__ = ["FaceSearch", "Proposal"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


BLEND_COST = 12.0
"""Of two feelings at once mouth and colour show the stronger, brows and eyes tell of the other: fear behind joy is a
laugh under anxious brows. On two axes alone happy eyes over chattering teeth come to the same point. So much score may
a mouth or a colour lose that says only the weaker."""
_OUTRIGHT = 0.8
"""A part that says the stronger feeling this share as well as the best one does costs nothing."""
_LOUD = 3.0
"""As much again for a part this share of the scale (1/3) louder than the stronger feeling is: half a joy smiles."""


def _blend_cost(affinity: Floats, mean: Floats, emotion: Floats) -> Floats:
    """Cost (n,) of parts with affinities (n, 7) and means (n, 2) for an emotion (7,); 0 where one feeling is alone."""
    six = emotion[:6]
    together = float(six.sum())
    if together <= 0.0:
        return np.zeros(len(affinity))
    strongest = float(six.max())
    mixed = (1.0 - strongest / together) * min(together, 1.0)
    told = affinity @ (emotion / emotion.max()) ** 5  # little is left of the weaker one
    loud = np.maximum(np.sqrt((mean * mean).sum(axis=1)) - 0.8 * strongest, 0.0)
    weak = np.maximum(1.0 - told / (_OUTRIGHT * told.max()), 0.0)
    return np.asarray(BLEND_COST * mixed * (weak + _LOUD * loud))


@dataclass(frozen=True)
class Proposal:
    """A proposed face: its parts, its score (higher is better) and its own Gaussian."""

    face: Face
    score: float
    mean: Floats
    covariance: Floats


class FaceSearch:
    """All faces of a model with their Gaussians, computed once; every query is a few array operations over them.

    Faces are numbered row-major over (eyes, eyebrows, mouth, skin); of equal scores (to 1e-9) the lower number wins.
    """

    def __init__(self, model: FaceModel) -> None:
        self.model = model
        self.counts = model.parts.counts
        mean, covariance = model.all_faces()
        self.mean = mean.reshape(-1, 2)
        self.covariance = covariance.reshape(-1, 2, 2)
        a, b, d = self.covariance[:, 0, 0], self.covariance[:, 0, 1], self.covariance[:, 1, 1]
        determinant = a * d - b * b
        if not (determinant > 0.0).all():
            raise BadInput("face model", expected="positive definite covariances", seen=float(determinant.min()))
        # log p of (v, a) is quadratic in it: (6, F) factors of 1, v, a, v², v·a, a², so that a query is one product.
        x, y, p, q, r = *self.mean.T, d / determinant, -b / determinant, a / determinant
        constant = -0.5 * (p * x * x + 2.0 * q * x * y + r * y * y + np.log(determinant)) - np.log(2.0 * np.pi)
        self._quadratic = np.stack([constant, p * x + q * y, q * x + r * y, -0.5 * p, -q, -0.5 * r])
        for array in (self.mean, self.covariance, self._quadratic):
            array.setflags(write=False)

    def __len__(self) -> int:
        return len(self.mean)

    def numbers(self, index: int) -> tuple[int, ...]:
        """Part numbers (4,) of face ``index``."""
        return tuple(int(i) for i in np.unravel_index(index, self.counts))

    def index(self, numbers: tuple[int, ...]) -> int:
        """The face's number from its part numbers."""
        return int(np.ravel_multi_index(numbers, self.counts))

    def score_point(self, point: ArrayLike) -> Floats:
        """log-density (F,) of (valence, arousal) under every face."""
        v, a = np.asarray(point, dtype=np.float64)
        return np.asarray(np.array([1.0, v, a, v * v, v * a, a * a]) @ self._quadratic)

    def score_gaussian(self, mean: ArrayLike, covariance: ArrayLike) -> Floats:
        """−KL(wanted ‖ face) (F,) of a wanted Gaussian. Raises BadInput where it is not positive definite."""
        wanted = np.asarray(covariance, dtype=np.float64)
        determinant = float(np.linalg.det(wanted)) if wanted.shape == (2, 2) else -1.0
        if determinant <= 0.0 or wanted[0, 0] <= 0.0:
            raise BadInput("wanted covariance", expected="a positive definite 2×2 matrix", seen=wanted.tolist())
        v, a = np.asarray(mean, dtype=np.float64)
        (s, c), (_, u) = wanted
        # The trace term of the divergence has the same factors as the squares of the point.
        score = np.array([1.0, v, a, v * v + s, v * a + c, a * a + u]) @ self._quadratic
        return np.asarray(score + (np.log(2.0 * np.pi) + 1.0 + 0.5 * np.log(determinant)))

    def score_emotion(self, emotion: ArrayLike) -> Floats:
        """Score (F,) of a seven-value emotion: log-density of its place plus weighted mean affinity of the parts."""
        values = np.asarray(emotion, dtype=np.float64)
        if values.shape != (7,) or not np.isfinite(values).all() or values.min() < 0.0:
            raise BadInput("wanted emotion", expected="seven numbers of 0 or more", seen=values.tolist())
        total = max(float(values.sum()), 1.0)
        parts = self.model.parts
        score = self.score_point(values @ parts.places / total).reshape(self.counts)
        factor = self.model.weights.affinity_weight / (len(self.counts) * total)
        for axis, region in enumerate(parts.regions):
            shape = [1] * len(self.counts)
            shape[axis] = -1
            gain = factor * (region.affinity @ values)
            if region.name in ("mouth", "skin"):
                gain -= _blend_cost(region.affinity, region.mean, values)
            score = score + gain.reshape(shape)
        return score.reshape(-1)

    def order(self, score: Floats, top: int, locked: Face | None = None, free: tuple[str, ...] = ()) -> Ints:
        """Numbers of the best faces, best first, ties to the lower number. With ``locked``, only the regions named in
        ``free`` may differ from it."""
        if locked is not None:
            keep = np.ones(self.counts, dtype=bool)
            wanted = self.model.parts.numbers(locked)
            for axis, region in enumerate(self.model.parts.regions):
                if region.name not in free:
                    shape = [1] * len(self.counts)
                    shape[axis] = -1
                    keep &= (np.arange(self.counts[axis]) == wanted[axis]).reshape(shape)
            score = np.where(keep.reshape(-1), score, -np.inf)
            top = min(top, int(keep.sum()))
        top = max(1, min(top, len(score)))
        rounded = np.round(score, 9)
        threshold = np.partition(rounded, len(rounded) - top)[len(rounded) - top]
        candidates = np.flatnonzero(rounded >= threshold)
        return np.asarray(candidates[np.argsort(-rounded[candidates], kind="stable")][:top])

    def best(self, score: Floats) -> int:
        """Number of the best face, ties to the lower number."""
        return int(np.argmax(np.round(score, 9)))

    def propose(
        self,
        score: Floats,
        top: int = 12,
        diversity: float = 0.0,
        locked: Face | None = None,
        free: tuple[str, ...] = (),
    ) -> list[Proposal]:
        """The best faces, best first. ``diversity`` > 0 takes off that much score for every part that a face shares
        with the faces already proposed, on average (standard parts count too)."""
        if diversity <= 0.0:
            chosen = [int(i) for i in self.order(score, top, locked, free)]
        else:
            pool = self.order(score, max(400, 40 * top), locked, free)
            parts = np.stack(np.unravel_index(pool, self.counts), axis=-1)
            shared = np.zeros(len(pool))
            left = np.round(score[pool], 9).copy()
            chosen = []
            for count in range(min(top, len(pool))):
                pick = int(np.argmax(left - diversity * shared / max(count, 1)))
                chosen.append(int(pool[pick]))
                shared += (parts == parts[pick]).sum(axis=1)
                left[pick] = -np.inf
        return [
            Proposal(
                self.model.parts.face(self.numbers(i)), float(score[i]), self.mean[i].copy(), self.covariance[i].copy()
            )
            for i in chosen
        ]
