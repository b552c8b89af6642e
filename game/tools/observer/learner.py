"""The observer: learns from windows of takes which feeling a movement belongs to, and is asked about others.

Multinomial logistic regression on standardised features with a strong quadratic penalty (scikit-learn).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.clip import Clip
from game.core.emotion_space import EMOTIONS
from game.core.errors import MissingPart
from game.tools.observer.features import FPS, describe
from game.tools.observer.keypoints import keypoints_of_clip, mirrored

__all__ = ["WINDOW_S", "Observer", "Training", "training_windows", "windows"]

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.intp]

WINDOW_S = 8.0
PENALTY = 0.02
"""scikit-learn's C: inverse of the penalty's weight. Chosen by leaving out stretches of the takes."""
_CLIP_SD = 4.0
"""Features further than this from the takes' mean, in standard deviations, count as that far: a viewer who sees
something quite unknown does not become quite certain."""


def windows(points: Floats, window_s: float = WINDOW_S, step_s: float | None = None) -> Floats:
    """(F, K, 3) -> (N, T, K, 3) windows, side by side or every step_s. A shorter stretch is one window."""
    length = min(round(window_s * FPS), len(points))
    step = length if step_s is None else max(round(step_s * FPS), 1)
    starts = range(0, len(points) - length + 1, step)
    return np.stack([points[start : start + length] for start in starts])


@dataclass(frozen=True, eq=False)
class Training:
    """Features (N, D), emotion (N,) index, and the stretch (N,) of the take a window lies in (for leaving out)."""

    features: Floats
    emotion: Ints
    stretch: Ints


def training_windows(
    takes: Mapping[int, Clip],
    seed: int = 0,
    *,
    copies: int = 3,
    step_s: float = 2.0,
    window_s: float = WINDOW_S,
    stretches: int = 5,
) -> Training:
    """Windows of the takes (emotion index -> clip), each as it is and in some copies that a viewer would judge alike:
    seen in a mirror, a little faster or slower, larger or smaller, from a little aside."""
    rng = np.random.default_rng(seed)
    parts: list[tuple[Floats, int, int]] = []
    for emotion, clip in sorted(takes.items()):
        points = keypoints_of_clip(clip)
        cuts = np.linspace(0, len(points), stretches + 1).astype(int)
        for stretch in range(stretches):
            own = points[cuts[stretch] : cuts[stretch + 1]]
            for copy in range(copies + 1):
                seen = own if copy == 0 else _varied(own, rng)
                parts.append((describe(windows(seen, window_s, step_s)), emotion, stretch))
    return Training(
        np.concatenate([features for features, _, _ in parts]),
        np.concatenate([np.full(len(features), emotion) for features, emotion, _ in parts]),
        np.concatenate([np.full(len(features), stretch) for features, _, stretch in parts]),
    )


def _varied(points: Floats, rng: np.random.Generator) -> Floats:
    pace = float(np.exp(rng.uniform(-0.15, 0.15)))
    at = np.arange(0.0, len(points) - 1.0, pace)
    low = at.astype(np.intp)
    share = (at - low)[:, None, None].astype(points.dtype)
    varied: Floats = points[low] * (1 - share) + points[low + 1] * share
    if rng.random() < 0.5:
        varied = mirrored(varied)
    size = np.exp(rng.normal(0.0, 0.02))
    aside = rng.normal(0.0, 0.012, 3) * (1.0, 0.5, 1.0)
    jitter = rng.normal(0.0, 0.006, (1, points.shape[1], 3))
    return np.asarray(varied * size + aside + jitter, dtype=np.float32)


class Observer:
    """Fitted once; asked for the probability of each of the seven emotions."""

    def __init__(self, training: Training, penalty: float = PENALTY) -> None:
        """Raises MissingPart where scikit-learn is not installed."""
        try:
            from sklearn.linear_model import LogisticRegression
        except ImportError:
            raise MissingPart(
                "the observer needs scikit-learn: pip install 'mental-communication-game[tools]'"
            ) from None
        self._mean = training.features.mean(axis=0)
        self._spread = np.maximum(training.features.std(axis=0), 1e-3)
        # Every emotion counts the same, however long its take.
        self._model = LogisticRegression(C=penalty, max_iter=300, tol=1e-3, class_weight="balanced")
        self._model.fit(self._standard(training.features), training.emotion)

    def _standard(self, features: Floats) -> Floats:
        return np.asarray(np.clip((features - self._mean) / self._spread, -_CLIP_SD, _CLIP_SD))

    def probabilities(self, seen: Floats) -> Floats:
        """Windows of points (N, T, K, 3) -> (N, 7)."""
        return self.judge(describe(seen))

    def judge(self, features: Floats) -> Floats:
        """Features (N, D) -> (N, 7) probabilities."""
        result = np.zeros((len(features), len(EMOTIONS)))
        result[:, self._model.classes_] = self._model.predict_proba(self._standard(features))
        return result

    @staticmethod
    def left_out(training: Training, penalty: float = PENALTY) -> float:
        """Share of windows named right when their stretch of the takes was not learnt from."""
        right = 0
        for stretch in np.unique(training.stretch):
            out = training.stretch == stretch
            kept = Training(training.features[~out], training.emotion[~out], training.stretch[~out])
            guess = Observer(kept, penalty).judge(training.features[out]).argmax(axis=1)
            right += int((guess == training.emotion[out]).sum())
        return right / len(training.emotion)
