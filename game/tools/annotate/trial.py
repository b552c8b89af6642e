"""How good automatic annotation is: leave one take out, annotate it from the others, compare with a person."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.embos.clips import TakeClip
from game.embos.repertoire import Behaviour
from game.embos.units import LAYERS
from game.tools.annotate.agreement import NOTHING, cohen_kappa, frame_labels
from game.tools.annotate.automatic import Annotator, Example, propose
from game.tools.annotate.document import Document
from game.tools.annotate.edits import accept
from game.tools.annotate.statistics import statistics_of

__all__ = ["Score", "Trial", "leave_one_out", "score_frames"]


@dataclass(frozen=True)
class Score:
    """Frames of one behaviour over all takes: precision and recall in 0..1 (nan where there is nothing to divide by).

    known: the share of its frames that lie in takes whose others show it too; elsewhere it could not be learnt.
    """

    precision: float
    recall: float
    frames: int
    known: float


@dataclass(frozen=True)
class Trial:
    """scores: per behaviour; layers: per layer over all its behaviours; kappa: per layer, mean over the takes.

    intensity_error: mean absolute difference of eq. 2's intensities when all takes are annotated by program;
    share_r: correlation of the shares of time on stage with those of the hand-made annotations.
    """

    scores: Mapping[str, Score]
    layers: Mapping[str, Score]
    kappa: Mapping[str, float]
    intensity_error: float
    share_r: float


def leave_one_out(
    documents: Sequence[Document], clips: Mapping[str, TakeClip], repertoire: Mapping[str, Behaviour]
) -> tuple[Trial, list[Document]]:
    """Annotate each take from all others -> the trial and the proposed documents."""
    examples = [Example.of(document, clips[document.take]) for document in documents]
    proposed: list[Document] = []
    for index, document in enumerate(documents):
        annotator = Annotator([e for i, e in enumerate(examples) if i != index])
        proposed.append(propose(annotator, document.with_marks([]), clips[document.take]))
    return _trial(documents, proposed, repertoire), proposed


def _trial(truth: Sequence[Document], proposed: Sequence[Document], repertoire: Mapping[str, Behaviour]) -> Trial:
    scores: dict[str, Score] = {}
    layers: dict[str, Score] = {}
    kappa: dict[str, float] = {}
    for layer in LAYERS:
        said = [frame_labels(d, layer) for d in truth]
        told = [frame_labels(d, layer) for d in proposed]
        own, whole = score_frames(said, told)
        scores |= own
        layers[layer] = whole
        kappa[layer] = float(np.mean([cohen_kappa(a, b)[0] for a, b in zip(said, told, strict=True)]))
    by_hand = statistics_of(truth, repertoire)
    by_program = statistics_of([accept(d, d.marks) for d in proposed], repertoire)
    hand = {u.name: (u.intensity, by_hand.share[i]) for i, u in enumerate(by_hand.units)}
    program = {u.name: (u.intensity, by_program.share[i]) for i, u in enumerate(by_program.units)}
    nothing = np.zeros(7), np.zeros(7)
    pairs = [(hand.get(n, nothing), program.get(n, nothing)) for n in sorted({*hand, *program})]
    error = float(np.mean([np.abs(a[0] - b[0]) for a, b in pairs]))
    shares = np.array([np.concatenate([a[1], b[1]]) for a, b in pairs])
    r = float(np.corrcoef(shares[:, :7].ravel(), shares[:, 7:].ravel())[0, 1])
    return Trial(scores, layers, kappa, error, r)


def score_frames(said: Sequence[NDArray[np.str_]], told: Sequence[NDArray[np.str_]]) -> tuple[dict[str, Score], Score]:
    """Per take (F,) what a person said and what the program told -> per behaviour, and over all of them."""
    names = sorted({str(n) for labels in said for n in np.unique(labels)} - {NOTHING})
    scores: dict[str, Score] = {}
    total = np.zeros(4)
    for name in names:
        right = sum(int(((a == name) & (b == name)).sum()) for a, b in zip(said, told, strict=True))
        marked = [int((a == name).sum()) for a in said]
        claimed = sum(int((b == name).sum()) for b in told)
        known = sum(m for i, m in enumerate(marked) if any(n for j, n in enumerate(marked) if j != i))
        scores[name] = _score(right, claimed, sum(marked), known)
        total += (right, 0, sum(marked), known)
    claimed_all = sum(int((b != NOTHING).sum()) for b in told)
    return scores, _score(int(total[0]), claimed_all, int(total[2]), int(total[3]))


def _score(right: int, claimed: int, marked: int, known: int) -> Score:
    return Score(
        right / claimed if claimed else float("nan"), right / marked if marked else float("nan"), marked,
        known / marked if marked else float("nan"),
    )  # fmt: skip
