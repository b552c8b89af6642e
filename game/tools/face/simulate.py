"""Simulated raters: they know a model's truth and answer with its spread. They test the fit; they are no experiment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from game.core import BadInput
from game.face import Face, FaceModel, Parts, fit_weights, whole_face
from game.face.parts import Region
from game.tools.face.ratings_file import Rating
from game.tools.face.sitting import single_part_faces

__all__ = ["ErrorRow", "errors_by_raters", "first_parts", "simulate_ratings"]

Floats = NDArray[np.float64]
HABIT = 0.08
"""Deviation of each person's own shift from the crowd, on both axes."""
MAX_RATERS = 1000


def face_gaussian(model: FaceModel, face: Face) -> tuple[Floats, Floats]:
    """What people say of a face. A face with one part defines that part's Gaussian; the weights make the others."""
    worn = [i for i, name in enumerate(face.parts) if name != "standard"]
    if len(worn) > 1:
        return model.mean_cov(face)
    region = model.parts.regions[worn[0] if worn else 0]
    number = region.index(face.parts[worn[0]]) if worn else 0
    return region.mean[number], region.covariance[number]


def simulate_ratings(model: FaceModel, faces: Sequence[Face], raters: int, rng: np.random.Generator) -> list[Rating]:
    """Every rater rates every face: the face's Gaussian, shifted by the rater's habit, cut to the square."""
    if not 1 <= raters <= MAX_RATERS:
        raise BadInput("raters", expected=f"1 to {MAX_RATERS}", seen=raters)
    habit = rng.normal(0.0, HABIT, (raters, 2))
    found = []
    for number in range(raters):
        for face in faces:
            mean, covariance = face_gaussian(model, face)
            spread = np.linalg.cholesky(covariance) @ rng.standard_normal(2)
            v, a = np.clip(mean + spread + habit[number], -1.0, 1.0)
            found.append(Rating(f"simulated-{number + 1:03d}", face, round(float(v), 4), round(float(a), 4)))
    return found


def first_parts(parts: Parts, count: int) -> Parts:
    """The same parts cut down to the first ``count`` of each region."""

    def cut(region: Region) -> Region:
        arrays = {
            name: getattr(region, name)[:count] for name in ("shape", "mean", "covariance", "affinity", "strength")
        }
        return replace(region, names=region.names[:count], labels=region.labels[:count], **arrays)

    return replace(parts, regions=tuple(cut(region) for region in parts.regions))


@dataclass(frozen=True)
class ErrorRow:
    """Error of the predicted mean over all faces (root mean square per axis pair), for so many raters."""

    raters: int
    rated_faces: int
    predicted_faces: int
    error_known_weights: float
    error_fitted_weights: float
    weight_error: float


def errors_by_raters(
    model: FaceModel, counts: Sequence[int], *, parts: int = 8, faces: int = 81, repeats: int = 12, seed: int = 1
) -> list[ErrorRow]:
    """Predict all parts⁴ faces from 1 + 4·(parts − 1) rated ones, for several numbers of raters.

    error_known_weights: with the true weights, so that only the part ratings are to blame; error_fitted_weights: with
    weights regressed on ``faces`` whole faces that the same people rated. Means over ``repeats`` simulated groups.
    """
    small = replace(model, parts=first_parts(model.parts, parts))
    truth, _ = small.all_faces()
    single = single_part_faces(small.parts)
    rng = np.random.default_rng([seed, 5])
    rows = []
    for raters in counts:
        errors = [_one_group(small, truth, raters, faces, rng) for _ in range(repeats)]
        known, fitted, weights = np.mean(errors, axis=0)
        rows.append(ErrorRow(raters, len(single), truth[..., 0].size, float(known), float(fitted), float(weights)))
    return rows


def _one_group(model: FaceModel, truth: Floats, raters: int, faces: int, rng: np.random.Generator) -> list[float]:
    regions = model.parts.regions
    weights = model.weights.value
    habit = rng.normal(0.0, HABIT, (raters, 1, 2))

    def rate(mean: Floats, covariance: Floats) -> Floats:
        noise = np.einsum("fij,rfj->rfi", np.linalg.cholesky(covariance), rng.standard_normal((raters, len(mean), 2)))
        return np.asarray(np.clip(mean + noise + habit, -1.0, 1.0).mean(axis=0))

    measured = [rate(region.mean, region.covariance) for region in regions]
    for mean in measured:
        mean[0] = 0.0  # the standard face is N(0, ·)
    numbers = np.stack([rng.integers(0, n, faces) for n in model.parts.counts], axis=-1)
    true_mean = np.stack([region.mean[numbers[:, i]] for i, region in enumerate(regions)], axis=1)
    true_covariance = np.stack([region.covariance[numbers[:, i]] for i, region in enumerate(regions)], axis=1)
    rated = rate(*whole_face(true_mean, true_covariance, weights))
    seen = np.stack([mean[numbers[:, i]] for i, mean in enumerate(measured)], axis=1)
    fitted = np.stack([axis.weight for axis in fit_weights(seen, rated)], axis=-1)

    def error(by: Floats) -> float:
        total = np.zeros(truth.shape)
        for i, mean in enumerate(measured):
            total = total + (mean * by[i]).reshape(*(-1 if i == j else 1 for j in range(len(regions))), 2)
        return float(np.sqrt(((total - truth) ** 2).mean()))

    return [error(weights), error(fitted), float(np.sqrt(((fitted - weights) ** 2).mean()))]
