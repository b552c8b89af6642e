"""From takes to motion units: eq. 2 and 3 over every layer and emotion, and what followed what."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from game.core.emotion_space import EMOTIONS
from game.embos import statistics
from game.embos.annotations import Span, Take
from game.embos.repertoire import Behaviour
from game.embos.transitions import count_transitions
from game.embos.units import LAYERS, LAYERS_WITH_REST, MotionUnit, Variant, rest_unit

__all__ = ["PAUSE_S", "annotated_s", "clean_part", "shares", "transitions", "units_of"]

PAUSE_S = 0.2
"""A longer pause between two mannerisms or gestures counts as a stay at rest, seconds."""


def annotated_s(takes: Iterable[Take]) -> float:
    """L_e of eq. 3: seconds annotated with a posture; postures of one take do not overlap."""
    return sum(span.length_s for take in takes for span in take.of_layer("posture"))


def clean_part(span: Span, others: Iterable[Span]) -> tuple[float, float]:
    """The longest part of a span that no other span overlaps, seconds; the whole span where nothing is left."""
    edges, best = span.start_s, (span.start_s, span.start_s)
    for other in sorted(others, key=lambda s: s.start_s):
        if other.end_s <= edges or other.start_s >= span.end_s:
            continue
        best = max(best, (edges, other.start_s), key=lambda part: part[1] - part[0])
        edges = max(edges, other.end_s)
    best = max(best, (edges, span.end_s), key=lambda part: part[1] - part[0])
    return best if best[1] > best[0] else (span.start_s, span.end_s)


def units_of(takes: Sequence[Take], repertoire: Mapping[str, Behaviour], alpha: float) -> list[MotionUnit]:
    """One unit per behaviour the takes show, layer by layer in the repertoire's order. alpha: of eq. 2."""
    units: list[MotionUnit] = []
    whole_s = [annotated_s(take for take in takes if take.emotion == k) for k in range(len(EMOTIONS))]
    for layer in LAYERS:
        spans = {name: [(t, s) for t in takes for s in t.of_layer(layer) if s.behaviour == name] for name in repertoire}
        shown = [name for name in repertoire if spans[name]]
        amount = np.zeros((len(shown), len(EMOTIONS)))
        for i, name in enumerate(shown):
            for take, span in spans[name]:
                # Frames for what is held, occurrences for what is done (EMBOS, section 4.2).
                frames = round(span.length_s / take.clip.frame_time_s)
                amount[i, take.emotion] += frames if layer == "posture" else 1
        intensity = statistics.intensity(amount, alpha)
        for i, name in enumerate(shown):
            lengths = [[s.length_s for t, s in spans[name] if t.emotion == k] for k in range(len(EMOTIONS))]
            known = repertoire[name]
            units.append(
                MotionUnit(
                    name=name,
                    layer=layer,
                    intensity=intensity[i],
                    duration_s=np.array([statistics.duration(own) for own in lengths]),
                    waiting_s=np.array([statistics.waiting(own, whole_s[k]) for k, own in enumerate(lengths)]),
                    duration_cv=statistics.spread(lengths),
                    kind=known.kind,
                    label=known.label,
                    words=known.words,
                    uses=known.uses,
                    locks=known.locks,
                    contacts=known.contacts,
                    variants=tuple(_variant(take, span) for take, span in spans[name]),
                )
            )
    return units


def _variant(take: Take, span: Span) -> Variant:
    clean = (span.start_s, span.end_s)
    if span.layer == "posture":
        clean = clean_part(span, [s for s in take.spans if s.layer != "posture"])
    return Variant(take.emotion, take.name, span.start_s, span.end_s, clean[0], clean[1], span.stroke_s)


def transitions(takes: Iterable[Take]) -> dict[str, dict[str, int]]:
    """How often b followed a, over all takes and layers; rest counts as a unit where a layer has one."""
    total: dict[str, dict[str, int]] = {}
    for take in takes:
        for layer in LAYERS:
            rest = rest_unit(layer).name if layer in LAYERS_WITH_REST else None
            spans = [(s.behaviour, s.start_s, s.end_s) for s in take.of_layer(layer)]
            for a, row in count_transitions(spans, rest, pause_s=PAUSE_S).items():
                for b, count in row.items():
                    total.setdefault(a, {})[b] = total.get(a, {}).get(b, 0) + count
    return total


def shares(units: Sequence[MotionUnit]) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """(U, 7) share of the annotated time each unit is on stage in the takes: L_d/(L_d + L_w), 0 where unseen."""
    duration = np.array([u.duration_s for u in units])
    period = duration + np.array([u.waiting_s for u in units])
    return np.asarray(duration / np.where(period > 0.0, period, 1.0))
