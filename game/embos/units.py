"""The motion unit (Hattori et al., section 3.2) and the spans of the takes it was seen in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from game.core.emotion_space import EMOTIONS
from game.core.errors import BadInput
from game.core.humanoid import BODY_PARTS

__all__ = ["LAYERS", "LAYERS_WITH_REST", "MotionUnit", "Variant", "rest_unit"]

Floats = NDArray[np.float64]

LAYERS: tuple[str, ...] = ("posture", "gesture", "mannerism")
"""The three attributes in their default order, upper layers first."""

LAYERS_WITH_REST: tuple[str, ...] = ("gesture", "mannerism")
"""Layers in which "nothing" is a choice; a posture is always held."""


@dataclass(frozen=True)
class Variant:
    """One annotated span of one take: emotion index 0..6, take name, times in seconds of that take.

    clean_start_s..clean_end_s: the longest part of the span that no unit of another layer overlaps (a posture's
    own pose); the whole span for other layers. stroke_s: the moment of a gesture's stroke, in the take's time.
    """

    emotion: int
    take: str
    start_s: float
    end_s: float
    clean_start_s: float
    clean_end_s: float
    stroke_s: float | None = None

    @property
    def length_s(self) -> float:
        """Seconds from start to end."""
        return self.end_s - self.start_s

    @property
    def stroke_offset_s(self) -> float:
        """Seconds from the start to the stroke; the middle where no stroke is marked."""
        return (self.stroke_s - self.start_s) if self.stroke_s is not None else 0.5 * self.length_s


@dataclass(frozen=True, eq=False)
class MotionUnit:
    """A behaviour with everything eq. 1 needs.

    intensity: (7,) in [0, 1] (eq. 2). duration_s, waiting_s: (7,) seconds per emotion (eq. 3), 0 where the
    emotion never showed the unit. duration_cv: spread of the span lengths around their emotion's mean, as a
    share of it (coefficient of variation, 0..1). uses/locks: body parts (constraint state). contacts: hand ->
    frame in which its place must be kept. words: language -> words that call a gesture up.
    Raises BadInput for an unknown layer or part and for values outside their ranges.
    """

    name: str
    layer: str
    intensity: Floats
    duration_s: Floats
    waiting_s: Floats
    duration_cv: float = 0.0
    kind: str = ""
    label: Mapping[str, str] | None = None
    words: Mapping[str, tuple[str, ...]] | None = None
    uses: frozenset[str] = frozenset()
    locks: frozenset[str] = frozenset()
    contacts: Mapping[str, str] | None = None
    is_rest: bool = False
    variants: tuple[Variant, ...] = ()

    def __post_init__(self) -> None:
        if self.layer not in LAYERS:
            raise BadInput(f"unit {self.name}: layer", expected=" | ".join(LAYERS), seen=self.layer)
        for part in sorted((self.uses | self.locks) - set(BODY_PARTS)):
            raise BadInput(f"unit {self.name}: body part", expected=" | ".join(BODY_PARTS), seen=part)
        for field, high in (("intensity", 1.0), ("duration_s", np.inf), ("waiting_s", np.inf)):
            object.__setattr__(self, field, _seven(f"unit {self.name}: {field}", getattr(self, field), high))
        if not 0.0 <= self.duration_cv <= 1.0:
            raise BadInput(f"unit {self.name}: duration_cv", expected="0 to 1", seen=self.duration_cv)
        object.__setattr__(self, "label", dict(self.label or {"en": self.name.replace("_", " ")}))
        object.__setattr__(self, "words", {k: tuple(v) for k, v in (self.words or {}).items()})
        object.__setattr__(self, "contacts", dict(self.contacts or {}))

    @property
    def exists(self) -> NDArray[np.bool_]:
        """(7,) σ of eq. 5: the emotions whose take showed this unit."""
        return self.duration_s > 0.0

    def title(self, language: str = "en") -> str:
        """The name shown to a person."""
        label = self.label or {}
        return label.get(language) or label.get("en") or self.name


def _seven(what: str, values: ArrayLike, high: float) -> Floats:
    array = np.array(values, dtype=np.float64)
    if array.shape != (len(EMOTIONS),):
        raise BadInput(what, expected="seven values", seen=array.shape)
    if not np.isfinite(array).all() or array.min() < 0.0 or array.max() > high:
        raise BadInput(what, expected=f"values from 0 to {high:g}", seen=array.tolist())
    array.setflags(write=False)
    return array


def rest_unit(layer: str) -> MotionUnit:
    """The unit that means "nothing" in a layer; its φ_state is a constant threshold (SPEC 3)."""
    zero = np.zeros(len(EMOTIONS))
    label = {"en": "rest", "ja": "なし"}
    return MotionUnit(f"rest_{layer}", layer, zero, zero, zero, kind="rest", label=label, is_rest=True)
