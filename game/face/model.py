"""The emotion of a face as a Gaussian over (valence, arousal), and where its weights come from.

After Nagai, Takayama, Xu and Sakazawa, "Dimensional Emotion Representation for Anime-like Facial Expressions",
section 3.2: ``μ = Σ w·μ_part`` and ``Σ = Σ w·Σ_part`` over the four regions, so that n parts per region need O(n)
ratings and give n⁴ faces. The paper reports one weight per region **and axis**; with them the covariance becomes
``Σ_ij = Σ_parts √(w_i·w_j)·Σ_part,ij``, which is S·Σ_part·S with a diagonal S and so stays positive semi-definite.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from game.core import BadInput
from game.face.params import REGIONS
from game.face.parts import Face, Parts
from game.formats import load_yaml

__all__ = ["FaceModel", "Weights", "load_weights", "log_density", "whole_face"]

Floats = NDArray[np.float64]
_AXES = ("valence", "arousal")


def whole_face(mean: ArrayLike, covariance: ArrayLike, weights: ArrayLike) -> tuple[Floats, Floats]:
    """A face's Gaussian from its parts' (Nagai et al., the two equations of section 3.2).

    mean (..., 4, 2), covariance (..., 4, 2, 2), weights (4, 2) ≥ 0 per region and axis -> (..., 2), (..., 2, 2).
    Raises BadInput for a negative weight.
    """
    w = np.asarray(weights, dtype=np.float64)
    if not (w >= 0.0).all():
        raise BadInput("face weights", expected="numbers of 0 or more", seen=w.tolist())
    root = np.sqrt(w)
    mu = (np.asarray(mean, dtype=np.float64) * w).sum(axis=-2)
    sigma = (np.asarray(covariance, dtype=np.float64) * (root[:, :, None] * root[:, None, :])).sum(axis=-3)
    return np.asarray(mu), np.asarray(sigma)


def log_density(point: ArrayLike, mean: ArrayLike, covariance: ArrayLike) -> Floats:
    """log N(point; mean, covariance) in two dimensions; all arguments broadcast, (..., 2) and (..., 2, 2) -> (...).

    Raises BadInput for a covariance that is not positive definite.
    """
    sigma = np.asarray(covariance, dtype=np.float64)
    a, b, d = sigma[..., 0, 0], sigma[..., 0, 1], sigma[..., 1, 1]
    determinant = a * d - b * b
    if not ((determinant > 0.0) & (a > 0.0)).all():
        raise BadInput("covariance of a face", expected="a positive definite matrix", seen=sigma.tolist())
    offset = np.asarray(point, dtype=np.float64) - np.asarray(mean, dtype=np.float64)
    x, y = offset[..., 0], offset[..., 1]
    distance = (d * x * x - 2.0 * b * x * y + a * y * y) / determinant
    return np.asarray(-0.5 * distance - 0.5 * np.log(determinant) - np.log(2.0 * np.pi))


@dataclass(frozen=True)
class Weights:
    """Weight per region and axis (4, 2), whether each is ``reported``, ``assumed`` or ``fitted``, and the two-axis
    versus affinity balance used for seven-value emotions."""

    value: Floats
    source: tuple[tuple[str, str], ...]
    affinity_weight: float


def load_weights(path: Path) -> Weights:
    """Read ``weights.yaml``. Raises BadInput with file:line:col."""
    root = load_yaml(path).only("version", "weights", "affinity_weight")
    root["version"].as_int(1, 1)
    table = root["weights"].only(*REGIONS)
    values, sources = [], []
    for region in REGIONS:
        axes = table[region].only(*_AXES)
        row, origin = [], []
        for axis in _AXES:
            entry = axes[axis].only("value", "source")
            row.append(entry["value"].as_float(0.0, 2.0))
            source = entry["source"].as_str()
            if source not in ("reported", "assumed", "fitted"):
                raise entry["source"].error(expected="reported | assumed | fitted")
            origin.append(source)
        values.append(row)
        sources.append((origin[0], origin[1]))
    array = np.array(values)
    if (array.sum(axis=0) <= 0.0).any():
        raise table.error(expected="some weight above 0 on each axis")
    array.setflags(write=False)
    return Weights(array, tuple(sources), root["affinity_weight"].as_float(0.0, 100.0))


@dataclass(frozen=True)
class FaceModel:
    """Parts and weights together: from a face to its emotion."""

    parts: Parts
    weights: Weights

    def mean_cov(self, face: Face | Iterable[int]) -> tuple[Floats, Floats]:
        """Mean (2,) and covariance (2, 2) of a face, given by names or part numbers."""
        numbers = self.parts.numbers(face) if isinstance(face, Face) else tuple(face)
        chosen = list(zip(self.parts.regions, numbers, strict=True))
        mean = np.stack([region.mean[i] for region, i in chosen])
        covariance = np.stack([region.covariance[i] for region, i in chosen])
        return whole_face(mean, covariance, self.weights.value)

    def log_density(self, point: ArrayLike, face: Face | Iterable[int]) -> float:
        """How well a face says an emotion: log-density of (valence, arousal) under the face's Gaussian."""
        return float(log_density(point, *self.mean_cov(face)))

    def all_faces(self) -> tuple[Floats, Floats]:
        """Gaussians of every face: mean (n1, n2, n3, n4, 2), covariance (n1, n2, n3, n4, 2, 2)."""
        grid: Mapping[int, tuple[int, ...]] = {
            axis: tuple(-1 if i == axis else 1 for i in range(len(REGIONS))) for axis in range(len(REGIONS))
        }
        w = self.weights.value
        root = np.sqrt(w)
        counts = self.parts.counts
        mean = np.zeros((*counts, 2))
        covariance = np.zeros((*counts, 2, 2))
        for axis, region in enumerate(self.parts.regions):
            mean = mean + (region.mean * w[axis]).reshape(*grid[axis], 2)
            scaled = region.covariance * (root[axis][:, None] * root[axis][None, :])
            covariance = covariance + scaled.reshape(*grid[axis], 2, 2)
        return mean, covariance
