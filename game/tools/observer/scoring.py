"""How well an observer does: confusion, share right with its interval, chance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.emotion_space import EMOTIONS
from game.tools.observer.features import describe
from game.tools.observer.learner import Observer, windows
from game.tools.observer.scenes import Scene

__all__ = ["Score", "accustomed", "scene_features", "score_of", "score_scenes", "wilson"]

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.intp]
_Z95 = 1.959964


@dataclass(frozen=True, eq=False)
class Score:
    """What was asked and answered.

    confusion: (7, 7) windows, row felt, column named; among: emotions asked about; share: mean over these of the
    share named right; interval: its 95 % interval (Wilson; a performance counts once, as its windows are alike);
    cases: performances; chance: of guessing blindly among those that may be named.
    """

    confusion: Ints
    among: tuple[int, ...]
    share: float
    interval: tuple[float, float]
    cases: int
    chance: float

    def row(self) -> dict[str, Any]:
        """JSON-ready."""
        return {
            "share": round(self.share, 4),
            "interval": [round(v, 4) for v in self.interval],
            "chance": round(self.chance, 4),
            "performances": self.cases,
            "windows": int(self.confusion.sum()),
            "emotions": [EMOTIONS[k] for k in self.among],
            "named": list(EMOTIONS),
            "confusion": [self.confusion[k].tolist() for k in self.among],
        }


def wilson(share: float, n: int) -> tuple[float, float]:
    """95 % interval of a share seen in n independent cases (Wilson 1927)."""
    z2 = _Z95 * _Z95
    middle = (share + z2 / (2 * n)) / (1 + z2 / n)
    half = _Z95 / (1 + z2 / n) * float(np.sqrt(share * (1 - share) / n + z2 / (4 * n * n)))
    return max(middle - half, 0.0), min(middle + half, 1.0)


def score_of(felt: Ints, named: Ints, cases: int, choices: int = len(EMOTIONS)) -> Score:
    """felt, named: (N,) emotion indices; cases: how many independent performances they come from."""
    confusion = np.zeros((len(EMOTIONS), len(EMOTIONS)), dtype=np.intp)
    np.add.at(confusion, (felt, named), 1)
    among = tuple(int(k) for k in np.flatnonzero(confusion.sum(axis=1)))
    # Every emotion counts the same, however many windows it has.
    share = float(np.mean([confusion[k, k] / confusion[k].sum() for k in among]))
    return Score(confusion, among, share, wilson(share, cases), cases, 1.0 / choices)


def score_scenes(observer: Observer, scenes: Sequence[Scene]) -> Score:
    """Every window of 8 s of every performance, side by side."""
    features, felt = scene_features(scenes)
    return score_of(felt, observer.judge(features).argmax(axis=1), len(scenes))


def accustomed(features: Floats, training: Floats) -> Floats:
    """Features (N, D) as a viewer sees them who has got used to whom they come from: shifted and stretched, all
    together and without their labels, to the mean and spread of what was learnt."""
    spread = np.maximum(features.std(axis=0), 1e-3)
    return np.asarray((features - features.mean(axis=0)) / spread * training.std(axis=0) + training.mean(axis=0))


def scene_features(scenes: Sequence[Scene]) -> tuple[Floats, Ints]:
    """Features (N, D) of all windows and what was felt (N,)."""
    parts = [describe(windows(scene.points)) for scene in scenes]
    felt = [np.full(len(part), scene.emotion) for part, scene in zip(parts, scenes, strict=True)]
    return np.concatenate(parts), np.concatenate(felt)
