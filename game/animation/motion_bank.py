"""All variants of all units as rows, ready to be sampled for many characters at once. Made once at load."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import channels as ch
from game.animation import rows as rw
from game.core.emotion_space import EMOTIONS
from game.core.errors import BadInput
from game.embos import MotionUnit, UnitLibrary, Variant
from game.embos.mixing import RADIUS

__all__ = ["FPS", "KnownUnits", "MotionBank", "bake"]

FPS = 30.0
"""Rows per second; takes of another frame rate are resampled."""

ADDITIVE_SHARE = 0.7
"""How much of a unit's torso and head movement shows where it does not own torso and head."""

_ABSENT = -1e4
_STEEP = 0.15
"""Below this radius exp(±1 / r²) comes near the ends of float32."""
_POSTURE_MIN_FRAMES = 8

Ints = NDArray[np.int32]
Floats = NDArray[np.floating[Any]]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class MotionBank:
    """U units, at most V variants of one emotion.

    rows: (R, CHANNELS). first: (U, 7, V) row of a variant's first frame, of any variant where that emotion has
    none (its weight is 0). frames: (U, 7, V) frames a posture's loop takes, frames − 1 of a played-once unit.
    count: (U, 7) variants, 0 where none. before_s, after_s: (U, 7, V) natural seconds before and after the
    stroke; mannerisms have everything after. stroke: (U,) frame of the stroke. loop_first, loop_frames: (U,)
    stretch that repeats (0 frames: none). owned: (U, PARTS) bool. frame: (U, 2) index into CONTACT_FRAMES.
    looks: (U,) True where the unit moves the gaze itself. mix_slope, mix_level: (U, 7), eq. 5's exponent is
    slope·i' + level; steep: True where that may leave float32's range. neutral_posture: the unit shown when the body
    must say nothing.
    """

    rows: Floats
    first: Ints
    frames: Floats
    count: Ints
    before_s: Floats
    after_s: Floats
    stroke: Floats
    loop_first: Floats
    loop_frames: Floats
    owned: Bools
    frame: NDArray[np.intp]
    looks: Bools
    mix_slope: Floats
    mix_level: Floats
    steep: bool
    neutral_posture: int
    rest: Ints

    def __post_init__(self) -> None:
        for value in vars(self).values():
            if isinstance(value, np.ndarray):
                value.setflags(write=False)


@dataclass(frozen=True, eq=False)
class BakedUnit:
    """One unit's variants as rows at FPS, ready to be laid side by side. owned: (PARTS,) bool; frame: (2,) index into
    CONTACT_FRAMES; stroke, loop_first, loop_frames as in MotionBank."""

    spans: tuple[Floats, ...]
    owned: Bools
    frame: NDArray[np.intp]
    stroke: float
    loop_first: float
    loop_frames: float


@dataclass
class KnownUnits:
    """The units of the last baking, by all that their rows follow from: those that stay the same are not made anew."""

    units: dict[Hashable, BakedUnit] = field(default_factory=dict)


def bake(
    library: UnitLibrary, layers: tuple[str, ...], radius: float = RADIUS, known: KnownUnits | None = None
) -> MotionBank:
    """Rows of every variant in the library. Raises BadInput for a unit without motion or an unknown contact."""
    takes: dict[str, rw.TakeRows] = {}
    before = {} if known is None else known.units
    baked: dict[Hashable, BakedUnit] = {}
    units = library.units
    most = max(max((len(library.variants_of(u, k)) for u in range(len(units)) for k in range(7)), default=1), 1)
    shape = (len(units), len(EMOTIONS), most)
    first = np.zeros(shape, dtype=np.int32)
    frames = np.ones(shape, dtype=np.float32)
    before_s, after_s = np.zeros(shape, dtype=np.float32), np.ones(shape, dtype=np.float32)
    count = np.zeros(shape[:2], dtype=np.int32)
    stroke, loop_first, loop_frames = (np.zeros(len(units), dtype=np.float32) for _ in range(3))
    owned = np.zeros((len(units), len(ch.PARTS)), dtype=bool)
    frame = np.full((len(units), 2), ch.CONTACT_FRAMES.index("chest"), dtype=np.intp)
    chunks: list[Floats] = [np.zeros((2, ch.CHANNELS), dtype=np.float32)]
    total = 2
    for u, unit in enumerate(units):
        if unit.is_rest:
            continue
        if not unit.variants:
            raise BadInput(f"unit {unit.name}", expected="at least one span of a take", seen="none")
        source = _source(library, unit)
        own = before.get(source) or _baked(library, takes, unit)
        baked[source] = own
        owned[u], frame[u], stroke[u] = own.owned, own.frame, own.stroke
        loop_first[u], loop_frames[u] = own.loop_first, own.loop_frames
        for variant, rows in zip(unit.variants, own.spans, strict=True):
            k, v = variant.emotion, count[u, variant.emotion]
            first[u, k, v], frames[u, k, v] = total, len(rows) - 1
            lead = variant.stroke_offset_s if unit.layer == "gesture" else 0.0
            before_s[u, k, v], after_s[u, k, v] = lead, max(variant.length_s - lead, 1.0 / FPS)
            count[u, k] += 1
            chunks.append(rows)
            total += len(rows)
        # An emotion without a variant points at one that exists: weight 0 times a finite row is 0.
        empty = np.arange(most) >= count[u][:, None]
        first[u][empty], frames[u][empty] = total - len(rows), len(rows) - 1
    if known is not None:
        known.units = baked
    return MotionBank(
        rows=np.concatenate(chunks),
        first=first,
        frames=frames,
        count=count,
        before_s=before_s,
        after_s=after_s,
        stroke=stroke,
        loop_first=loop_first,
        loop_frames=loop_frames,
        owned=owned,
        frame=frame,
        looks=np.array([bool({"gaze"} & (u.uses | u.locks)) for u in units]),
        mix_slope=(2.0 * library.intensity / radius**2).astype(np.float32),
        mix_level=np.where(count > 0, -((library.intensity / radius) ** 2), _ABSENT).astype(np.float32),
        steep=radius < _STEEP,
        neutral_posture=_neutral_posture(library),
        rest=np.array([_rest(library, layer) for layer in layers], dtype=np.int32),
    )


def _source(library: UnitLibrary, unit: MotionUnit) -> Hashable:
    """All that a unit's rows follow from; takes by identity, which readers keep where the bytes stay the same."""
    takes = tuple(library.clips.get(variant.take) for variant in unit.variants)
    return unit.layer, unit.uses, tuple(sorted((unit.contacts or {}).items())), unit.variants, takes


def _baked(library: UnitLibrary, takes: dict[str, rw.TakeRows], unit: MotionUnit) -> BakedUnit:
    """The rows of one unit. takes: what has been made of whole takes so far."""
    owned = np.ones(len(ch.PARTS), dtype=bool) if unit.layer == "posture" else _owned(unit)
    stroke, period = 0.0, None
    spans = [_span_rows(library, takes, unit, v) for v in unit.variants]
    spans[0] = rw.align_to(spans[0], rw.REST_ROW)
    side = spans[0].mean(axis=0)
    spans = [spans[0], *(rw.align_to(rows, side) for rows in spans[1:])]
    if unit.layer == "posture":
        spans = [rw.seamless_loop(rows) for rows in spans]
    else:
        together, stroke = _aligned(unit, spans)
        period = rw.period_of(together[0], owned) if unit.layer == "mannerism" else None
        spans = list(rw.additive_rows(together, owned, ADDITIVE_SHARE))
    loop_first, loop_frames = period or (0, 0)
    return BakedUnit(tuple(spans), owned, _contacts(unit), stroke, loop_first, loop_frames)


def _owned(unit: MotionUnit) -> Bools:
    return np.array([part in unit.uses for part in ch.PARTS])


def _contacts(unit: MotionUnit) -> NDArray[np.intp]:
    """(2,) the frames of the hands: the chest's where no contact is declared."""
    frame = np.full(2, ch.CONTACT_FRAMES.index("chest"), dtype=np.intp)
    for hand, name in (unit.contacts or {}).items():
        if hand not in ch.HANDS:
            raise BadInput(f"unit {unit.name}: contact", expected=" | ".join(ch.HANDS), seen=hand)
        if name not in ch.CONTACT_FRAMES:
            raise BadInput(f"unit {unit.name}: contact of {hand}", expected=" | ".join(ch.CONTACT_FRAMES), seen=name)
        frame[ch.HANDS.index(hand)] = ch.CONTACT_FRAMES.index(name)
    return frame


def _span_rows(library: UnitLibrary, takes: dict[str, rw.TakeRows], unit: MotionUnit, variant: Variant) -> Floats:
    """The variant's frames as rows at FPS: a posture's clean stretch, another unit's whole span."""
    take = library.clips.get(variant.take)
    if take is None:
        raise BadInput(f"unit {unit.name}", expected="its take among the clips", seen=variant.take)
    posture = unit.layer == "posture"
    begin = variant.clean_start_s if posture else variant.start_s
    end = variant.clean_end_s if posture else variant.end_s
    last = len(take.rotation) - 1
    low = min(max(round(begin / take.frame_time_s), 0), last)
    high = min(max(round(end / take.frame_time_s), low + 2), last + 1)
    if high - low < 2:
        low = max(high - 2, 0)
    frames = slice(low, high)
    if variant.take not in takes:
        takes[variant.take] = rw.take_rows(take.rotation, take.root)
    rows = takes[variant.take].span(frames, _contacts(unit))
    wanted = max(round((high - low) * take.frame_time_s * FPS), _POSTURE_MIN_FRAMES if posture else 4)
    return rows if wanted == len(rows) else rw.resample([rows], wanted)[0]


def _aligned(unit: MotionUnit, spans: list[Floats]) -> tuple[Floats, float]:
    """Spans resampled to one length with their strokes at one frame -> (V, frames, CHANNELS) and that frame."""
    length = max(len(rows) for rows in spans)
    if unit.layer != "gesture":
        return rw.resample(spans, length), 0.0
    shares = [min(max(v.stroke_offset_s / max(v.length_s, 1e-6), 0.05), 0.95) for v in unit.variants]
    goal = float(np.mean(shares))
    return rw.resample(spans, length, [(share, goal) for share in shares]), goal * (length - 1)


def _neutral_posture(library: UnitLibrary) -> int:
    postures = library.of_layer("posture")
    if "upright" in library.index:
        return library.index["upright"]
    return int(postures[np.argmax(library.intensity[postures, EMOTIONS.index("neutral")])])


def _rest(library: UnitLibrary, layer: str) -> int:
    if layer == "posture":
        return _neutral_posture(library)
    return next(int(u) for u in library.of_layer(layer) if library.units[u].is_rest)
