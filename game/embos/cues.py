"""Gesture words in a spoken line: which units they call up, and when (EMBOS, section 3.2; stroke synchrony: McNeill).

A gesture's stroke falls on its word, so its window opens earlier by the time the unit needs to reach its stroke.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.embos.library import UnitLibrary
from game.embos.stress import StressRule, stressed_moments
from game.embos.words import BY_SUBSTRING, WORD

__all__ = ["GestureCues", "beat_columns", "timed_tokens"]

Floats = NDArray[np.float64]


def timed_tokens(text: str, start_s: float, length_s: float, language: str = "en") -> list[tuple[str, float]]:
    """(token, time) of a line, time shared out by the characters before each token.

    Languages without spaces give one token per character position: the rest of the line from there, so that a
    word of any length can be found at its own place.
    """
    letters = max(len(text), 1)
    if language in BY_SUBSTRING:
        return [(text[i:], start_s + length_s * i / letters) for i in range(len(text))]
    return [(m.group(), start_s + length_s * m.start() / letters) for m in WORD.finditer(text)]


def beat_columns(library: UnitLibrary, stress: StressRule) -> list[int]:
    """Columns of library.gestures that may stress any word."""
    return [column for column, unit in enumerate(library.gestures) if library.units[unit].name in stress.units]


@dataclass(frozen=True, eq=False)
class GestureCues:
    """When the words of one line fall. gesture: (C,) column of library.gestures; time_s: (C,) its word's moment;
    count: G. Sorted by time."""

    gesture: NDArray[np.intp]
    time_s: Floats
    count: int

    @classmethod
    def silent(cls, library: UnitLibrary) -> GestureCues:
        """No line, no cue."""
        return cls(np.zeros(0, dtype=np.intp), np.zeros(0), len(library.gestures))

    @classmethod
    def from_tokens(
        cls, library: UnitLibrary, tokens: Iterable[tuple[str, float]], language: str = "en"
    ) -> GestureCues:
        """Cues of (token, moment in seconds) pairs.

        Where words are spaced, whole words match without regard to case, with plural and possessive; a unit's
        "word" may be several words. Elsewhere a token matches a word it starts with.
        """
        found = library.word_index(language).find(list(tokens))
        return cls(
            np.array([column for _, column in found], dtype=np.intp),
            np.array([time_s for time_s, _ in found], dtype=np.float64),
            len(library.gestures),
        )

    @classmethod
    def from_words(cls, library: UnitLibrary, text: str, char_s: Sequence[float], language: str) -> GestureCues:
        """Cues of a line: words that call up gestures. char_s: seconds of each character, on any clock."""
        return cls.from_tokens(library, _tokens(text, char_s, language), language)

    def with_beats(
        self,
        library: UnitLibrary,
        text: str,
        char_s: Sequence[float],
        language: str,
        *,
        shown: NDArray[np.bool_],
        stress: StressRule,
    ) -> GestureCues:
        """With beats on stressed words between these.

        char_s: seconds of each character, on the same clock; shown: (G,) gestures the present feeling knows, the others
        compete with no beat.
        """
        taken_s = self.time_s[shown[self.gesture]].tolist() if self.gesture.size else []
        beats = [column for column in beat_columns(library, stress) if shown[column]]
        moments = stressed_moments(text, char_s, language, stress, taken_s) if beats else []
        pairs = {*zip(self.time_s.tolist(), self.gesture.tolist(), strict=True)}
        found = sorted(pairs | {(moment, column) for moment in moments for column in beats})
        return GestureCues(
            np.array([column for _, column in found], dtype=np.intp),
            np.array([time_s for time_s, _ in found], dtype=np.float64),
            self.count,
        )

    @classmethod
    def from_text(
        cls, library: UnitLibrary, text: str, start_s: float, length_s: float, language: str = "en"
    ) -> GestureCues:
        """Cues of a line spoken from start_s for length_s."""
        return cls.from_tokens(library, timed_tokens(text, start_s, length_s, language), language)

    def later(self, seconds: float) -> GestureCues:
        """The same cues on a clock that is ahead by so many seconds."""
        return GestureCues(self.gesture, self.time_s + seconds, self.count)

    def adding(self, library: UnitLibrary, name: str, time_s: float) -> GestureCues:
        """These cues and one more gesture by its unit's name; unchanged where the library has no such gesture."""
        names = [library.units[unit].name for unit in library.gestures]
        if name not in names:
            return self
        at = int(np.searchsorted(self.time_s, time_s))
        gesture = np.insert(self.gesture, at, names.index(name))
        return GestureCues(gesture, np.insert(self.time_s, at, time_s), self.count)

    def preparation_s(self, lead_s: Floats, shown: NDArray[np.bool_]) -> float:
        """How long before the line its first gestures have to start, seconds, at least 0.

        lead_s: (G,) from start to stroke; shown: (G,) which gestures count. For cues counted from the line's start.
        """
        early = (lead_s[self.gesture] - self.time_s)[shown[self.gesture]]
        return max(float(early.max()), 0.0) if early.size else 0.0

    def factors(self, time_s: float, lead_s: Floats | None = None, window_s: float = 0.1) -> Floats:
        """(G,) word factor: 1 where a cue's window is open, else 0.

        lead_s: (G,) seconds from start to stroke of each gesture (UnitLibrary.stroke_lead_s). The window is
        centred on the moment at which a start puts the stroke on the word.
        """
        result = np.zeros(self.count)
        if self.gesture.size:
            at = self.time_s if lead_s is None else self.time_s - lead_s[self.gesture]
            result[self.gesture[np.abs(time_s - at) <= 0.5 * window_s]] = 1.0
        return result


def _tokens(text: str, char_s: Sequence[float], language: str) -> list[tuple[str, float]]:
    """(token, moment): words where they are spaced, else the rest of the line at every character."""
    if language in BY_SUBSTRING:
        return [(text[i:], at) for i, at in enumerate(char_s)]
    return [(m.group(), char_s[m.start()]) for m in WORD.finditer(text)]
