"""How far two annotators agree: Cohen's kappa per layer, frame by frame, and the stretches on which they differ.

Cohen, J. (1960): A coefficient of agreement for nominal scales. κ = (p_o − p_e)/(1 − p_e), p_o = share of frames with
the same label, p_e = the share to be expected by chance from both annotators' own label frequencies.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput
from game.embos.units import LAYERS
from game.tools.annotate.document import Document

__all__ = ["Agreement", "Difference", "agreement", "cohen_kappa", "frame_labels"]

NOTHING = ""
"""Label of a frame in which a layer says nothing."""


@dataclass(frozen=True)
class Difference:
    """A stretch seen differently, seconds; an empty name: nothing was marked."""

    layer: str
    start_s: float
    end_s: float
    first: str
    second: str


@dataclass(frozen=True)
class Agreement:
    """Per layer: kappa in −1..1 (nan where there is nothing to disagree about), observed share of equal frames."""

    kappa: dict[str, float]
    observed: dict[str, float]
    differences: tuple[Difference, ...]


def frame_labels(document: Document, layer: str) -> NDArray[np.str_]:
    """(frames,) what each frame shows in a layer."""
    names = np.full(document.frames, NOTHING, dtype=object)
    for mark in document.of_layer(layer):
        # A frame belongs to the span its moment lies in.
        first = int(np.ceil(mark.start_s * document.fps - 1e-6))
        names[first : int(np.ceil(mark.end_s * document.fps - 1e-6))] = mark.behaviour
    return names.astype(np.str_)


def cohen_kappa(first: NDArray[np.str_], second: NDArray[np.str_]) -> tuple[float, float]:
    """Labels (F,) of two annotators -> kappa and the observed agreement. nan where both used one and the same label."""
    labels, both = np.unique(np.concatenate([first, second]), return_inverse=True)
    a, b = both[: len(first)], both[len(first) :]
    table = np.zeros((len(labels), len(labels)))
    np.add.at(table, (a, b), 1.0 / max(len(first), 1))
    observed = float(np.trace(table))
    chance = float(table.sum(axis=1) @ table.sum(axis=0))
    return ((observed - chance) / (1.0 - chance) if chance < 1.0 - 1e-12 else float("nan")), observed


def agreement(first: Document, second: Document, least_s: float = 0.1) -> Agreement:
    """Compare two annotations of one take. least_s: shorter differences (an edge set a little apart) are not listed.

    Raises BadInput unless both are of the same motion.
    """
    if first.frames != second.frames or abs(first.fps - second.fps) > 1e-3:
        raise BadInput(
            "annotations to compare",
            expected=f"the same motion ({first.frames} frames at {first.fps:g}/s)",
            seen=f"{second.frames} frames at {second.fps:g}/s",
        )
    kappa: dict[str, float] = {}
    observed: dict[str, float] = {}
    found: list[Difference] = []
    for layer in LAYERS:
        a, b = frame_labels(first, layer), frame_labels(second, layer)
        kappa[layer], observed[layer] = cohen_kappa(a, b)
        edges = np.flatnonzero((a[1:] != a[:-1]) | (b[1:] != b[:-1])) + 1
        for start, end in zip([0, *edges.tolist()], [*edges.tolist(), len(a)], strict=True):
            if end > start and a[start] != b[start] and (end - start) / first.fps >= least_s:
                found.append(Difference(layer, start / first.fps, end / first.fps, str(a[start]), str(b[start])))
    return Agreement(kappa, observed, tuple(sorted(found, key=lambda d: (d.start_s, d.layer))))
