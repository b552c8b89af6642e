"""All motion units of a repertoire, with what does not change while the game runs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput
from game.embos.clips import ClipBank, KnownClips, load_clips
from game.embos.mixing import RADIUS, mix_weights
from game.embos.transitions import pose_distances
from game.embos.units import LAYERS, LAYERS_WITH_REST, MotionUnit, Variant, rest_unit
from game.embos.units_file import read_units
from game.embos.words import WordIndex

__all__ = ["UnitLibrary"]

Floats = NDArray[np.float64]


class UnitLibrary:
    """Units ordered by layer (posture, gesture, mannerism); a rest unit leads each layer that may do nothing.

    units: U motion units; index: name -> place in units. intensity, duration_s, waiting_s: (U, 7); exists: (U, 7)
    bool (σ of eq. 5); duration_cv: (U,); is_rest: (U,) bool. clips: the takes the variants point into.
    Raises BadInput for double names or a layer without any unit.
    """

    def __init__(
        self,
        units: Iterable[MotionUnit],
        clips: ClipBank | None = None,
        transitions: Mapping[str, Mapping[str, int]] | None = None,
    ) -> None:
        given = tuple(units)
        ordered: list[MotionUnit] = []
        for layer in LAYERS:
            mine = [u for u in given if u.layer == layer]
            if layer in LAYERS_WITH_REST and not any(u.is_rest for u in mine):
                mine.insert(0, rest_unit(layer))
            if not mine:
                raise BadInput("units", expected=f"at least one {layer}", seen=0)
            ordered += mine
        self.units: tuple[MotionUnit, ...] = tuple(ordered)
        self.index: dict[str, int] = {u.name: i for i, u in enumerate(ordered)}
        if len(self.index) != len(ordered):
            names = [u.name for u in ordered]
            raise BadInput("units", expected="unique names", seen=sorted({n for n in names if names.count(n) > 1}))
        self.clips = clips if clips is not None else ClipBank()
        self.intensity: Floats = _frozen([u.intensity for u in ordered])
        self.duration_s: Floats = _frozen([u.duration_s for u in ordered])
        self.waiting_s: Floats = _frozen([u.waiting_s for u in ordered])
        self.duration_cv: Floats = _frozen([u.duration_cv for u in ordered])
        self.exists: NDArray[np.bool_] = self.duration_s > 0.0
        self.is_rest: NDArray[np.bool_] = np.array([u.is_rest for u in ordered])
        self._transitions = {a: dict(b) for a, b in (transitions or {}).items()}

    def __len__(self) -> int:
        return len(self.units)

    @classmethod
    def load(cls, path: Path, known: KnownClips | None = None) -> UnitLibrary:
        """units.yaml and, where it stands beside it, clips.npz; known: takes of an earlier reading. Raises BadInput
        with place, expected and seen."""
        units, transitions = read_units(path)
        clips_path = path.parent / "clips.npz"
        clips = load_clips(clips_path, known) if clips_path.exists() else ClipBank()
        library = cls(units, clips, transitions)
        library.check_clips(path)
        return library

    def check_clips(self, path: Path) -> None:
        """Every variant must lie in a take of the clip bank (skipped where there are no clips at all)."""
        for unit in self.units if len(self.clips) else ():
            for variant in unit.variants:
                take = self.clips.get(variant.take)
                if take is None or variant.end_s > take.length_s + 0.5 * take.frame_time_s:
                    length = "no such take" if take is None else f"a take of {take.length_s:.3f} s"
                    place = f"{unit.name} at {variant.take} {variant.start_s:g}..{variant.end_s:g} s"
                    raise BadInput(
                        f"{path}: {place}", expected="a span inside its clip", seen=length, hint="run_game.py analyse"
                    )

    def of_layer(self, layer: str) -> NDArray[np.intp]:
        """Indices of a layer's units, its rest unit included."""
        return np.array([i for i, u in enumerate(self.units) if u.layer == layer], dtype=np.intp)

    @cached_property
    def gestures(self) -> NDArray[np.intp]:
        """(G,) indices of the gesture units proper: the columns of a word factor."""
        return np.array([i for i, u in enumerate(self.units) if u.layer == "gesture" and not u.is_rest], dtype=np.intp)

    @cached_property
    def known_gestures(self) -> Floats:
        """(G, 7) 1 where an emotion shows a gesture, else 0."""
        known = self.exists[self.gestures].astype(np.float64)
        known.setflags(write=False)
        return known

    @cached_property
    def _word_indices(self) -> Mapping[str, WordIndex]:
        words: dict[str, list[tuple[int, str]]] = {}
        for column, unit in enumerate(self.gestures):
            for language, own in (self.units[unit].words or {}).items():
                words.setdefault(language, []).extend((column, word) for word in own)
        return {language: WordIndex.of(language, own) for language, own in words.items()}

    def word_index(self, language: str) -> WordIndex:
        """The gesture words of a language; empty where the repertoire has none."""
        return self._word_indices.get(language) or WordIndex.of(language, ())

    @cached_property
    def stroke_offset_s(self) -> Floats:
        """(U, 7) mean seconds from start to stroke per unit and emotion (mean of all where an emotion has none)."""
        offsets = np.zeros((len(self), 7))
        for i, unit in enumerate(self.units):
            if unit.variants:
                offsets[i] = np.mean([v.stroke_offset_s for v in unit.variants])
            for k in range(7):
                own = [v.stroke_offset_s for v in unit.variants if v.emotion == k]
                if own:
                    offsets[i, k] = np.mean(own)
        offsets.setflags(write=False)
        return offsets

    def mix_weights(self, emotion: Floats, units: NDArray[np.intp], radius: float = RADIUS) -> Floats:
        """Eq. 5 for units (...,) at emotions (..., 7) -> normalised weights (..., 7) of the units' emotions."""
        return mix_weights(emotion, self.intensity[units], self.exists[units], radius)

    def stroke_lead_s(self, emotion: Floats, radius: float = RADIUS) -> Floats:
        """How long before its stroke each gesture has to start: (n, 7) -> (n, G) seconds, mixed by eq. 5."""
        weights = self.mix_weights(emotion[:, None, :], self.gestures[None, :], radius)
        return np.asarray((weights * self.stroke_offset_s[self.gestures]).sum(axis=-1))

    def variants_of(self, unit: int, emotion: int) -> tuple[Variant, ...]:
        """The takes' spans of a unit in one emotion, in the takes' order."""
        return tuple(v for v in self.units[unit].variants if v.emotion == emotion)

    def variant(self, unit: int, emotion: int, pick: float) -> Variant | None:
        """One of a unit's variants in an emotion; pick in [0, 1) chooses. None where there is none."""
        own = self.variants_of(unit, emotion)
        return own[min(int(pick * len(own)), len(own) - 1)] if own else None

    def transition_counts(self, layer: str) -> Floats:
        """(M, M) how often b followed a in the takes, for the layer's units in order; rest counts as a unit."""
        names = [self.units[i].name for i in self.of_layer(layer)]
        return np.array([[self._transitions.get(a, {}).get(b, 0) for b in names] for a in names], dtype=np.float64)

    def pose_distance(self, layer: str) -> Floats:
        """(M, M) radians from the end of a to the start of b; 0 from and to rest and where there are no clips."""
        return pose_distances([self.units[i] for i in self.of_layer(layer)], self.clips)

    def link_matrix(self) -> NDArray[np.int8]:
        """(U, U) ω_l of unit a below unit b: [b, a]. Units of one layer are never asked about."""
        from game.embos.scores import linkage

        return np.array(
            [[linkage(a.uses, a.locks, b.uses, b.locks) for a in self.units] for b in self.units], dtype=np.int8
        )


def _frozen(rows: list[Floats] | list[float]) -> Floats:
    array = np.array(rows, dtype=np.float64)
    array.setflags(write=False)
    return array
