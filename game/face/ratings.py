"""From ratings to numbers: part Gaussians, and the weights by linear regression (Nagai et al., section 4).

The paper regresses the ratings of 81 whole faces on the ratings of their parts. The model has no intercept (the
standard face lies at 0), so each axis is an ordinary least-squares fit through the origin.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from game.core import BadInput

__all__ = ["AxisFit", "fit_gaussian", "fit_weights"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class AxisFit:
    """Weights of one axis: value, standard error and two-sided p (4,), confidence interval (4, 2), and the whole fit.

    r_squared = 1 − Σ(y − ŷ)² / Σ(y − ȳ)²; p_value belongs to the F test of all weights against none.
    """

    weight: Floats
    error: Floats
    p_weight: Floats
    interval: Floats
    r_squared: float
    p_value: float
    faces: int


def fit_gaussian(ratings: ArrayLike) -> tuple[Floats, Floats]:
    """Mean (2,) and sample covariance (2, 2) of ratings (n, 2) in −1..1.

    Raises BadInput for too few ratings, ratings outside the range, or ratings on one line (singular covariance).
    """
    values = np.asarray(ratings, dtype=np.float64)
    if values.ndim != 2 or values.shape[1] != 2 or len(values) < 3:
        raise BadInput("ratings of a part", expected="at least 3 of (valence, arousal)", seen=f"shape {values.shape}")
    if not (np.isfinite(values).all() and (np.abs(values) <= 1.0).all()):
        raise BadInput("ratings of a part", expected="numbers from -1 to 1", seen=float(np.abs(values).max()))
    covariance = np.cov(values, rowvar=False)
    if np.linalg.det(covariance) < 1e-8:
        raise BadInput("ratings of a part", expected="ratings that spread over both axes", seen="ratings on one line")
    return values.mean(axis=0), np.asarray(covariance)


def fit_weights(part_mean: ArrayLike, face_mean: ArrayLike, confidence: float = 0.95) -> tuple[AxisFit, AxisFit]:
    """Regress whole faces on their parts: part_mean (F, 4, 2), face_mean (F, 2) -> fits of valence and arousal.

    Raises BadInput for fewer than 6 faces or parts whose ratings do not tell the regions apart.
    """
    x = np.asarray(part_mean, dtype=np.float64)
    y = np.asarray(face_mean, dtype=np.float64)
    if x.ndim != 3 or x.shape[2] != 2 or y.shape != (len(x), 2):
        raise BadInput("face ratings", expected="(F, regions, 2) and (F, 2)", seen=f"{x.shape} and {y.shape}")
    faces, regions, _ = x.shape
    if faces < regions + 2:
        raise BadInput("face ratings", expected=f"at least {regions + 2} rated faces for the regression", seen=faces)
    return (
        _fit_axis(x[:, :, 0], y[:, 0], confidence),
        _fit_axis(x[:, :, 1], y[:, 1], confidence),
    )


def _fit_axis(x: Floats, y: Floats, confidence: float) -> AxisFit:
    # Imported here: the game itself never fits ratings, and scipy.stats takes a third of its start.
    from scipy import stats

    faces, regions = x.shape
    gram = x.T @ x
    if np.linalg.matrix_rank(x) < regions or np.linalg.cond(gram) > 1e12:
        raise BadInput("face ratings", expected="faces that vary every region independently", seen="a singular design")
    inverse = np.linalg.inv(gram)
    weight = inverse @ (x.T @ y)
    residual = y - x @ weight
    freedom = faces - regions
    left = float(residual @ residual)
    variance = left / freedom
    error = np.sqrt(np.maximum(variance * np.diag(inverse), 1e-300))
    spread = float(((y - y.mean()) ** 2).sum())
    explained = float(y @ y) - left
    f_value = (explained / regions) / max(variance, 1e-300)
    margin = float(stats.t.ppf(0.5 + confidence / 2.0, freedom)) * error
    return AxisFit(
        weight=weight,
        error=error,
        p_weight=np.asarray(2.0 * stats.t.sf(np.abs(weight) / error, freedom)),
        interval=np.stack([weight - margin, weight + margin], axis=-1),
        r_squared=1.0 - left / spread if spread > 0.0 else 0.0,
        p_value=float(stats.f.sf(f_value, regions, freedom)),
        faces=faces,
    )
