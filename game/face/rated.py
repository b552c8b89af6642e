"""Expressions of a foreign avatar that people have rated: each gets its own Gaussian over (valence, arousal).

The file is written by ``face fit --avatar`` beside the ratings. Like the parts of the painted face (SPEC 9, Nagai et
al.), an expression is then chosen by how likely the wanted emotion is under what people saw in it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.core.emotion_space import EMOTION_INDEX, EMOTIONS
from game.face.model import log_density
from game.formats import Node, load_yaml

__all__ = ["RatedExpression", "load_rated", "rated_scores", "rated_shares", "rated_text"]

Floats = NDArray[np.float64]

SHARPNESS = 3.0
"""How clearly the best expression is ahead: shares are a softmax of SHARPNESS × score, so that nothing flickers."""
AFFINITY_WEIGHT = 3.0
"""Of an expression's named emotion against its density, as in weights.yaml: fear, anger and disgust lie close together
on the two axes (SPEC 9)."""
STRONG = 0.08
"""Shares below this are left out: many faces at once are none."""


@dataclass(frozen=True, eq=False)
class RatedExpression:
    """mean: (2,) valence and arousal, covariance: (2, 2), from so many ratings; affinity: (7,) to the seven."""

    name: str
    mean: Floats
    covariance: Floats
    ratings: int
    affinity: Floats


def load_rated(path: Path) -> tuple[dict[str, RatedExpression], Floats]:
    """Read the YAML of rated expressions: name -> expression, and the places (7, 2) of the seven emotions.

    Raises BadInput with file:line:col.
    """
    root = load_yaml(path).only("version", "avatar", "note", "emotions", "expressions")
    root["version"].as_int(1, 1)
    places = np.array([_pair(root["emotions"].only(*EMOTIONS)[name]) for name in EMOTIONS])
    result = {}
    for name, body in root["expressions"].as_mapping().items():
        body.only("mean", "covariance", "ratings", "affinity")
        covariance = np.array([_pair(row, 4.0) for row in body["covariance"].as_list()])
        if (
            covariance.shape != (2, 2)
            or not np.allclose(covariance, covariance.T)
            or np.linalg.eigvalsh(covariance).min() <= 1e-9
        ):
            raise body["covariance"].error("covariance", expected="a symmetric, positive definite 2×2 matrix")
        affinity = np.zeros(len(EMOTIONS))
        known = body.get("affinity")
        if known is not None:
            for emotion, value in known.only(*EMOTIONS).as_mapping().items():
                affinity[EMOTION_INDEX[emotion]] = value.as_float(0.0, 1.0)
        mean = np.array(_pair(body["mean"]))
        result[name] = RatedExpression(name, mean, covariance, body["ratings"].as_int(0, 1_000_000_000), affinity)
    if not result:
        raise root["expressions"].error("expressions", expected="at least one rated expression")
    return result, places


def _pair(node: Node, most: float = 1.0) -> tuple[float, float]:
    items = node.as_list()
    if len(items) != 2:
        raise node.error("pair", expected="two numbers")
    return items[0].as_float(-most, most), items[1].as_float(-most, most)


def rated_scores(rated: Mapping[str, RatedExpression], places: Floats, emotion: Floats) -> dict[str, float]:
    """Name -> how well the expression says a seven-value emotion: log-density of its place and weighted affinity."""
    values = np.asarray(emotion, dtype=np.float64)
    total = max(float(values.sum()), 1.0)
    point = values @ places / total
    return {
        name: float(log_density(point, row.mean, row.covariance))
        + AFFINITY_WEIGHT * float(row.affinity @ values) / total
        for name, row in rated.items()
    }


def rated_shares(rated: Mapping[str, RatedExpression], places: Floats, emotion: Floats) -> dict[str, float]:
    """Name -> share of the expressions that say an emotion best; they sum to 1."""
    score = rated_scores(rated, places, emotion)
    values = np.array(list(score.values()))
    share = np.exp(SHARPNESS * (values - values.max()))
    share /= share.sum()
    share = np.maximum(share - STRONG, 0.0)
    return dict(zip(score, (share / share.sum()).tolist(), strict=True))


def rated_text(avatar: str, rated: Mapping[str, RatedExpression], places: Floats, note: str) -> str:
    """The YAML that load_rated reads."""
    lines = ["version: 1", f"avatar: {_quoted(avatar)}", f"note: {_quoted(note)}", "emotions:"]
    lines += [f"  {name}: [{v:.4g}, {a:.4g}]" for name, (v, a) in zip(EMOTIONS, places.tolist(), strict=True)]
    lines.append("expressions:")
    for name, row in rated.items():
        (a, b), (_, d) = row.covariance.tolist()
        affinity = ", ".join(f"{e}: {x:.3g}" for e, x in zip(EMOTIONS, row.affinity.tolist(), strict=True) if x > 0.0)
        lines += [
            f"  {_quoted(name)}:",
            f"    mean: [{row.mean[0]:.5g}, {row.mean[1]:.5g}]",
            f"    covariance: [[{a:.6g}, {b:.6g}], [{b:.6g}, {d:.6g}]]",
            f"    ratings: {row.ratings}",
            f"    affinity: {{{affinity}}}",
        ]
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
