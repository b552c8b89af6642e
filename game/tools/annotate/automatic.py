"""Automatic annotation after Arikan, Forsyth and O'Brien (2003): classifiers learnt from annotated takes label the
frames of another one, and the labels become spans a person may accept or correct.

One classifier per layer sees windowed features of a frame (motion_features). Postures: linear discriminant analysis;
mannerisms and gestures: a support vector machine with a radial kernel, as in the paper. Which of the two a layer uses
was chosen by leaving one take out (F1 of frames: postures .66 against .60, gestures .31 against .38).

Tried and left out, by F1 of three takes left out (gestures .31, mannerisms .19 as it is): features less each take's own
median (.27, .13), rare labels weighing more (.28, .16), discriminant analysis with even priors (.28, .17), changes of
label at a third of the cost (.31, .18), random trees (they answer "nothing"). Examples are lacking, not a learner.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput, MissingPart
from game.embos.clips import TakeClip
from game.embos.units import LAYERS
from game.tools.annotate.agreement import NOTHING
from game.tools.annotate.document import Document, Mark, on_grid
from game.tools.annotate.edits import least_s
from game.tools.annotate.motion_features import RATE_HZ, frame_features

__all__ = ["Annotator", "Example", "labels_at_rate", "most_likely", "propose", "spans_of"]

Floats = NDArray[np.floating[Any]]

COMPONENTS = 200
"""Principal components of the features that are kept."""
_FAR_SD = 4.0
"""Features further than this from the examples' mean count as that far."""
_SVM_COST, _SVM_WIDTH, _SVM_SHARPNESS = 5.0, 0.3, 1.5
_LDA_SHRINKAGE = 0.05
_SVM_STRIDE = 3
"""Every so many frames are learnt by the support vector machine: neighbours say the same."""
SWITCH_COST = {"posture": 6.0, "mannerism": 3.0, "gesture": 3.0}
"""Nats that a change of label must gain (a Viterbi path): spans do not flicker."""
_FLOOR = 0.02


@dataclass(frozen=True, eq=False)
class Example:
    """An annotated take to learn from: features (T, D) and, per layer, labels (T,)."""

    features: Floats
    labels: Mapping[str, NDArray[np.str_]]

    @staticmethod
    def of(document: Document, clip: TakeClip) -> Example:
        """What a person said about a motion. Proposals nobody accepted are not learnt from."""
        features = frame_features(clip)
        known = document.with_marks([m for m in document.marks if m.confidence is None])
        return Example(features, {layer: labels_at_rate(known, layer, len(features)) for layer in LAYERS})


def labels_at_rate(document: Document, layer: str, count: int) -> NDArray[np.str_]:
    """(count,) what a layer shows at the moments that are looked at."""
    names = np.full(count, NOTHING, dtype=object)
    for mark in document.of_layer(layer):
        first, last = (int(np.ceil(t * RATE_HZ - 1e-6)) for t in (mark.start_s, mark.end_s))
        names[first:last] = mark.behaviour
    return names.astype(np.str_)


class Annotator:
    """Learnt once from examples; asked about other motions."""

    def __init__(self, examples: Sequence[Example]) -> None:
        """Raises BadInput without examples, MissingPart without scikit-learn."""
        try:
            from sklearn.decomposition import PCA
        except ImportError:
            raise MissingPart(
                "automatic annotation needs scikit-learn: pip install 'mental-communication-game[tools]'"
            ) from None
        if not examples:
            raise BadInput("automatic annotation", expected="at least one annotated take to learn from", seen="none")
        features = np.concatenate([example.features for example in examples]).astype(np.float64)
        self._mean, self._spread = features.mean(axis=0), features.std(axis=0) + 1e-3
        standard = self._standard(features)
        kept = min(COMPONENTS, standard.shape[1], len(standard[::3]))
        self._components = PCA(kept, svd_solver="covariance_eigh").fit(standard[::3])
        seen = self._components.transform(standard)
        # Half-whitened: the first components must not drown the small movements of hands.
        self._scale = 1.0 / np.sqrt(np.maximum(seen.std(axis=0), 1e-6))
        self._models = {
            layer: _fitted(layer, seen, seen * self._scale, np.concatenate([e.labels[layer] for e in examples]))
            for layer in LAYERS
        }

    def _standard(self, features: Floats) -> Floats:
        return np.asarray(np.clip((features - self._mean) / self._spread, -_FAR_SD, _FAR_SD))

    def probabilities(self, features: Floats) -> dict[str, tuple[list[str], Floats]]:
        """Features (T, D) -> per layer the labels it knows and (T, labels) how likely each is."""
        seen = self._components.transform(self._standard(features.astype(np.float64)))
        result: dict[str, tuple[list[str], Floats]] = {}
        for layer, model in self._models.items():
            if isinstance(model, str):
                result[layer] = ([model], np.ones((len(seen), 1)))
            elif layer == "posture":
                result[layer] = (list(model.classes_), np.asarray(model.predict_proba(seen)))
            else:
                score = np.asarray(model.decision_function(seen * self._scale))
                if score.ndim == 1:
                    score = np.stack([-score, score], axis=1)
                odds = np.exp(_SVM_SHARPNESS * (score - score.max(axis=1, keepdims=True)))
                result[layer] = (list(model.classes_), odds / odds.sum(axis=1, keepdims=True))
        return result


def _fitted(layer: str, seen: Floats, scaled: Floats, labels: NDArray[np.str_]) -> Any:
    """A classifier, or the one label there is."""
    from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
    from sklearn.svm import SVC

    known = np.unique(labels)
    if len(known) == 1:
        return str(known[0])
    if layer == "posture":
        return LinearDiscriminantAnalysis(solver="lsqr", shrinkage=_LDA_SHRINKAGE).fit(seen, labels)
    # Thinned within each label, so that a rare one is not lost.
    keep = np.sort(np.concatenate([np.flatnonzero(labels == name)[::_SVM_STRIDE] for name in known]))
    width = _SVM_WIDTH / (scaled.var() * scaled.shape[1])
    return SVC(C=_SVM_COST, gamma=width).fit(scaled[keep], labels[keep])


def most_likely(probability: Floats, switch_cost: float) -> NDArray[np.intp]:
    """(T, K) -> (T,) the most likely sequence when each change costs so many nats (Viterbi 1967)."""
    level = np.log(probability + _FLOOR)
    count, kinds = level.shape
    came = np.zeros((count, kinds), dtype=np.intp)
    best = level[0].copy()
    here = np.arange(kinds)
    for t in range(1, count):
        top = int(best.argmax())
        jump = best[top] - switch_cost
        came[t] = np.where(best >= jump, here, top)
        best = np.maximum(best, jump) + level[t]
    path = np.empty(count, dtype=np.intp)
    path[-1] = int(best.argmax())
    for t in range(count - 1, 0, -1):
        path[t - 1] = came[t, path[t]]
    return path


def propose(annotator: Annotator, document: Document, clip: TakeClip) -> Document:
    """The document with proposals wherever a layer says nothing yet. What people marked stays as it is."""
    features = frame_features(clip)
    marks = [m for m in document.marks if m.confidence is None]
    base = document.with_marks(marks)
    for layer, (names, probability) in annotator.probabilities(features).items():
        path = most_likely(probability, SWITCH_COST[layer])
        for mark in spans_of(base, layer, [names[i] for i in path], probability.max(axis=1)):
            room = base.room(layer, mark.start_s + 0.5 * mark.length_s)
            if room is not None:
                start, end = max(mark.start_s, room[0]), min(mark.end_s, room[1])
                if end - start >= least_s(base, layer):
                    base = base.with_marks([*base.marks, replace(mark, start_s=start, end_s=end)])
    return base


def spans_of(document: Document, layer: str, labels: Sequence[str], sure: Floats) -> list[Mark]:
    """Runs of equal labels at RATE_HZ as marks; those too short for the layer are left out. sure: (T,) 0..1."""
    names = np.array(list(labels), dtype=np.str_)
    edges = [0, *(np.flatnonzero(names[1:] != names[:-1]) + 1).tolist(), len(names)]
    found = []
    for first, last in itertools.pairwise(edges):
        start, end = on_grid(first / RATE_HZ), on_grid(min(last / RATE_HZ, document.length_s))
        if names[first] != NOTHING and end - start >= least_s(document, layer) - 1e-9:
            confidence = round(float(sure[first:last].mean()), 3)
            found.append(Mark(start, end, layer, str(names[first]), confidence=confidence))
    return found
