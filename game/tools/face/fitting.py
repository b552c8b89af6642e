"""From people's ratings to the model (Nagai et al., section 4): part Gaussians, weights, and how well it all fits.

Part Gaussians come from the faces that wear one part. The weights come from the whole faces, by regression of their
mean rating on the means of their parts; a part nobody has rated enters with its present value.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from game.core import BadInput, Where
from game.face import REGIONS, AxisFit, Face, FaceModel, fit_gaussian, fit_weights, log_density, whole_face
from game.tools.face.ratings_file import Rating

__all__ = ["FACES_NEEDED", "RATINGS_NEEDED", "FaceFit", "HeldOut", "PartFit", "WholeFaces", "fit_ratings"]

Floats = NDArray[np.float64]
RATINGS_NEEDED = 3
"""Fewer ratings of a part have no covariance."""
FACES_NEEDED = len(REGIONS) + 2
"""Fewer whole faces leave the regression of four weights without an error of its own."""
_NARROWEST, _WIDEST, _STRAIGHTEST = 0.02, 1.0, 0.95  # what parts.yaml can say


@dataclass(frozen=True)
class PartFit:
    """One part's Gaussian from so many ratings; mean (2,) is 0 by definition for the standard face."""

    region: str
    part: str
    ratings: int
    mean: Floats
    covariance: Floats


@dataclass(frozen=True)
class WholeFaces:
    """Whole faces as the regression sees them, F of them."""

    faces: tuple[Face, ...]
    part_mean: Floats  # (F, 4, 2)
    part_covariance: Floats  # (F, 4, 2, 2)
    mean: Floats  # (F, 2) of the ratings
    deviation: Floats  # (F, 2) of the ratings, NaN where there are too few
    ratings: tuple[int, ...]

    def __len__(self) -> int:
        return len(self.faces)

    def take(self, numbers: NDArray[np.int64]) -> WholeFaces:
        """Some of them."""
        return WholeFaces(
            tuple(self.faces[i] for i in numbers),
            self.part_mean[numbers],
            self.part_covariance[numbers],
            self.mean[numbers],
            self.deviation[numbers],
            tuple(self.ratings[i] for i in numbers),
        )

    def predict(self, weights: Floats) -> tuple[Floats, Floats]:
        """Means (F, 2) and covariances (F, 2, 2) by weights (4, 2)."""
        return whole_face(self.part_mean, self.part_covariance, weights)


@dataclass(frozen=True)
class HeldOut:
    """How the model does on whole faces that the weights have not seen: R² and error per axis, error of the
    predicted deviations (None where no face has enough ratings), mean log-density."""

    faces: WholeFaces
    predicted: Floats
    r_squared: Floats  # (2,)
    rmse: Floats  # (2,)
    deviation_rmse: Floats | None  # (2,)
    log_density: float


@dataclass(frozen=True)
class FaceFit:
    """Everything a fit says. axes and weights are None where too few whole faces were rated (``lacking`` says so)."""

    raters: int
    simulated: bool
    ratings: int
    parts: tuple[PartFit, ...]
    unrated: tuple[str, ...]
    standard_offset: Floats | None
    whole: WholeFaces | None
    axes: tuple[AxisFit, AxisFit] | None
    weights: Floats | None
    held_out: HeldOut | None
    lacking: tuple[str, ...]

    @property
    def label(self) -> str:
        """Who rated, as it stands in the written files."""
        who = "simulated raters" if self.simulated else "raters"
        total = len(self.parts) + len(self.unrated)
        rest = f"; the other {len(self.unrated)} are designers' estimates" if self.unrated else ""
        return f"{self.raters} {who}, {len(self.parts)} of {total} parts{rest}"


def fit_ratings(
    ratings: Sequence[Rating], model: FaceModel, path: Path, *, held_out: float = 0.2, seed: int = 1
) -> FaceFit:
    """Fit what the ratings allow. Raises BadInput (with file:line where a row is at fault) where they allow nothing,
    or a part's ratings lie on one line."""
    if not 0.0 <= held_out <= 0.5:
        raise BadInput("held-out share", expected="0 to 0.5", seen=held_out)
    by_face: dict[Face, list[Rating]] = defaultdict(list)
    for rating in ratings:
        if isinstance(rating.face, Face):
            by_face[rating.face].append(rating)
    parts, lacking = _fit_parts(by_face, model, path)
    whole = _whole_faces(by_face, model, parts)
    enough = whole is not None and len(whole) >= FACES_NEEDED
    if not parts and not enough:
        expected = f"{RATINGS_NEEDED} ratings of a face with one part, or {FACES_NEEDED} rated faces of several"
        raise BadInput("too few ratings", where=Where(path), expected=expected, seen=f"{len(ratings)} ratings")
    if not enough:
        have = len(whole) if whole else 0
        lacking.append(f"weights: {have} of the {FACES_NEEDED} whole faces needed, {FACES_NEEDED - have} more to rate")
    standard = by_face.get(Face(), [])
    raters = {r.rater for r in ratings}
    done = {(p.region, p.part) for p in parts.values()}
    return FaceFit(
        raters=len(raters),
        simulated=any(name.startswith("simulated") for name in raters),
        ratings=len(ratings),
        parts=tuple(parts.values()),
        unrated=tuple(
            f"{region.name}/{name}"
            for region in model.parts.regions
            for name in region.names
            if (region.name, name) not in done
        ),
        standard_offset=np.mean([(r.valence, r.arousal) for r in standard], axis=0) if standard else None,
        whole=whole,
        axes=_regress(whole, path) if whole is not None and enough else None,
        weights=_weights(whole) if whole is not None and enough else None,
        held_out=_hold_out(whole, held_out, seed, path) if whole is not None and enough else None,
        lacking=tuple(lacking),
    )


def _points(rows: Sequence[Rating]) -> Floats:
    return np.array([(r.valence, r.arousal) for r in rows])


def _fit_parts(
    by_face: Mapping[Face, list[Rating]], model: FaceModel, path: Path
) -> tuple[dict[tuple[str, str], PartFit], list[str]]:
    parts: dict[tuple[str, str], PartFit] = {}
    lacking: list[str] = []
    for face, rows in by_face.items():
        worn = [(r, p) for r, p in zip(REGIONS, face.parts, strict=True) if p != "standard"]
        if len(worn) > 1:
            continue
        if len(rows) < RATINGS_NEEDED:
            what = "/".join(worn[0]) if worn else "standard face"
            lacking.append(f"{what}: {len(rows)} of the {RATINGS_NEEDED} ratings needed")
            continue
        try:
            mean, covariance = fit_gaussian(_points(rows))
        except BadInput as error:
            place = Where(path, rows[-1].line)
            raise BadInput(
                f"{'/'.join(worn[0]) if worn else 'standard face'}: singular covariance",
                where=place, expected=error.expected, seen=error.seen,
            ) from None  # fmt: skip
        covariance = _within(covariance)
        if worn:
            parts[worn[0]] = PartFit(*worn[0], len(rows), np.round(mean, 4), covariance)
        else:
            # The standard face is N(0, ·) by definition (section 4); what people say of it is reported beside.
            for region in REGIONS:
                parts[region, "standard"] = PartFit(region, "standard", len(rows), np.zeros(2), covariance)
    return parts, lacking


def _within(covariance: Floats) -> Floats:
    """The covariance as parts.yaml can say it: deviations and correlation inside their ranges, four digits."""
    deviation = np.clip(np.sqrt(np.diag(covariance)), _NARROWEST, _WIDEST).round(4)
    together = covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
    cross = round(float(np.clip(together, -_STRAIGHTEST, _STRAIGHTEST)), 4) * deviation[0] * deviation[1]
    return np.array([[deviation[0] ** 2, cross], [cross, deviation[1] ** 2]])


def _whole_faces(
    by_face: Mapping[Face, list[Rating]], model: FaceModel, parts: Mapping[tuple[str, str], PartFit]
) -> WholeFaces | None:
    faces = sorted((f for f in by_face if sum(p != "standard" for p in f.parts) > 1), key=lambda f: f.parts)
    if not faces:
        return None
    means, covariances = [], []
    for face in faces:
        mean, covariance = np.zeros((4, 2)), np.zeros((4, 2, 2))
        for i, (region, name) in enumerate(zip(model.parts.regions, face.parts, strict=True)):
            rated = parts.get((region.name, name))
            number = region.index(name)
            mean[i] = region.mean[number] if rated is None else rated.mean
            covariance[i] = region.covariance[number] if rated is None else rated.covariance
        means.append(mean)
        covariances.append(covariance)
    return WholeFaces(
        tuple(faces),
        np.array(means),
        np.array(covariances),
        np.array([_points(by_face[f]).mean(axis=0) for f in faces]),
        np.array([_deviation(by_face[f]) for f in faces]),
        tuple(len(by_face[f]) for f in faces),
    )


def _deviation(rows: Sequence[Rating]) -> Floats:
    if len(rows) < RATINGS_NEEDED:
        return np.full(2, np.nan)
    return np.asarray(_points(rows).std(axis=0, ddof=1))


def _regress(whole: WholeFaces, path: Path) -> tuple[AxisFit, AxisFit]:
    try:
        return fit_weights(whole.part_mean, whole.mean)
    except BadInput as error:
        raise BadInput("weights", where=Where(path), expected=error.expected, seen=error.seen) from None


def _weights(whole: WholeFaces) -> Floats:
    """Weights (4, 2) for the game: least squares with none below 0, for a negative one has no meaning in the model."""
    columns = [nnls(whole.part_mean[:, :, axis], whole.mean[:, axis])[0] for axis in (0, 1)]
    return np.asarray(np.clip(np.stack(columns, axis=-1), 0.0, 2.0).round(4), dtype=np.float64)


def _hold_out(whole: WholeFaces, share: float, seed: int, path: Path) -> HeldOut | None:
    """Fit on a seeded part of the faces, measure on the others; None where too few would be left for either."""
    count = round(share * len(whole))
    if count < 3 or len(whole) - count < FACES_NEEDED:
        return None
    order = np.random.default_rng([seed, 3]).permutation(len(whole))
    kept, seen = whole.take(order[:count]), whole.take(order[count:])
    _regress(seen, path)  # refuses a singular design, which least squares without negatives would not notice
    predicted, covariance = kept.predict(_weights(seen))
    residual = kept.mean - predicted
    off = kept.deviation - np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    known = np.isfinite(off).all(axis=1)
    spread = ((kept.mean - kept.mean.mean(axis=0)) ** 2).sum(axis=0)
    return HeldOut(
        kept,
        predicted,
        1.0 - (residual**2).sum(axis=0) / np.maximum(spread, 1e-12),
        np.sqrt((residual**2).mean(axis=0)),
        np.sqrt((off[known] ** 2).mean(axis=0)) if known.any() else None,
        float(log_density(kept.mean, predicted, covariance).mean()),
    )
