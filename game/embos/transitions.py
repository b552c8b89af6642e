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
    owner, emotion, first, last = [], [], [], []
    for i, unit in enumerate(units):
        for variant in unit.variants:
            take = clips.get(variant.take)
            if take is not None:
                owner.append(i)
                emotion.append(variant.emotion)
                first.append(take.rotation[take.frame(variant.start_s), _MAJOR])
                last.append(take.rotation[max(take.frame(variant.end_s) - 1, 0), _MAJOR])
    count = len(units)
    if not owner:
        return np.zeros((count, count))
    member = np.zeros((count, len(owner)))
    member[owner, np.arange(len(owner))] = 1.0
    total = np.zeros((len(owner), len(owner)))
    ends, starts = np.array(last, dtype=np.float64), np.array(first, dtype=np.float64)
    for joint in range(len(_MAJOR)):  # a joint at a time keeps the memory at variants²
        dot = np.abs(ends[:, joint] @ starts[:, joint].T)
        total += 2.0 * np.arccos(np.minimum(dot, 1.0))
    total /= len(_MAJOR)
    same = (np.array(emotion)[:, None] == np.array(emotion)[None, :]).astype(np.float64)
    pairs_same, pairs_all = member @ same @ member.T, member @ np.ones_like(same) @ member.T
    mean_same = (member @ (total * same) @ member.T) / np.maximum(pairs_same, 1.0)
    mean_all = (member @ total @ member.T) / np.maximum(pairs_all, 1.0)
    return np.asarray(np.where(pairs_same > 0, mean_same, mean_all))
