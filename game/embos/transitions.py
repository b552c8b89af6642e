"""What followed what in the takes, and how far apart their poses are: the two sources of ω_c."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from game.core.humanoid import FINGERS, REFERENCE
from game.embos.clips import TakeClip
from game.embos.units import MotionUnit

__all__ = ["count_transitions", "pose_distances"]

Floats = NDArray[np.float64]

# Fingers change all the time and would drown the limbs; toes and eyes carry no posture.
_MAJOR = np.array([i for i, n in enumerate(REFERENCE.names) if not any(k in n for k in (*FINGERS, "Thumb", "Toes"))])


def count_transitions(
    spans: Iterable[tuple[str, float, float]], rest: str | None, *, pause_s: float
) -> dict[str, dict[str, int]]:
    """Count b after a over one take's spans (behaviour, start, end) of one layer, in seconds.

    Where the layer has a rest unit, a pause longer than pause_s between two spans is one stay at rest.
    """
    counts: dict[str, dict[str, int]] = defaultdict(lambda: defaultdict(int))
    before, ended = rest, 0.0
    for name, start_s, end_s in sorted(spans, key=lambda span: span[1]):
        if rest is not None and before not in (rest, None) and start_s - ended > pause_s:
            counts[str(before)][rest] += 1
            before = rest
        if before is not None and before != name:
            counts[before][name] += 1
        before, ended = name, end_s
    if rest is not None and before not in (rest, None):
        counts[str(before)][rest] += 1
    return {a: dict(b) for a, b in counts.items()}


def pose_distances(units: Sequence[MotionUnit], clips: Mapping[str, TakeClip]) -> Floats:
    """(M, M) mean joint angle in radians between the last pose of a and the first of b.

    Averaged over the variants of both that come from one emotion, over all pairs where they share none.
    0 where either has no clip (rest).
    """
    spans = [
        (i, variant, clips[variant.take])
        for i, unit in enumerate(units)
        for variant in unit.variants
        if variant.take in clips
    ]
    count = len(units)
    if not spans:
        return np.zeros((count, count))
    member = np.zeros((count, len(spans)))
    member[[i for i, _, _ in spans], np.arange(len(spans))] = 1.0
    first = np.array([take.rotation[take.frame(v.start_s), _MAJOR] for _, v, take in spans], dtype=np.float64)
    last = np.array([take.rotation[max(take.frame(v.end_s) - 1, 0), _MAJOR] for _, v, take in spans], dtype=np.float64)
    emotion = np.array([variant.emotion for _, variant, _ in spans])
    same = (emotion[:, None] == emotion).astype(np.float64)
    pairs_same, pairs_all = member @ same @ member.T, member @ np.ones_like(same) @ member.T
    # Arc cosines are dear: only those of pairs that count.
    strangers = (pairs_same == 0.0).astype(np.float64)
    counting = np.flatnonzero((same + member.T @ strangers @ member) > 0.0)
    angle = np.zeros(len(counting))
    for joint in range(len(_MAJOR)):  # a joint at a time keeps the memory at variants²
        dot = np.abs((last[:, joint] @ first[:, joint].T).take(counting))
        angle += 2.0 * np.arccos(np.minimum(dot, 1.0))
    total = np.zeros_like(same)
    total.put(counting, angle / len(_MAJOR))
    mean_same = (member @ (total * same) @ member.T) / np.maximum(pairs_same, 1.0)
    mean_all = (member @ total @ member.T) / np.maximum(pairs_all, 1.0)
    return np.asarray(np.where(pairs_same > 0, mean_same, mean_all))
