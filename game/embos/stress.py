"""Stressed words of a spoken line: where a beat may fall (beats mark what is stressed: McNeill 1992, chapter 3).

English puts the main stress of a phrase on its last content word (nuclear stress: Chomsky and Halle 1968), Japanese
sets a phrase's pitch highest at its beginning and lets it fall (Pierrehumbert and Beckman 1988). Content words are
told from function words by a list; in Japanese by the script, which writes nouns and stems in kanji or katakana.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from game.core.errors import BadInput
from game.embos.words import WORD

__all__ = ["StressRule", "stressed_moments"]

_PHRASE = re.compile(r"[^,.;:!?…—–、。！？]+")

_STEM = re.compile(r"[一-鿿々]+|[ァ-ヴー]{2,}")


@dataclass(frozen=True)
class StressRule:
    """Which units stress words, and which words are stressed.

    units: names of the beats that go with any stressed word, in the library or not. least_s: shorter lines get
    none. apart_s: least time between two stressed words; clear_s: from a word with a gesture of its own.
    unstressed: language -> function words. Raises BadInput for times below 0.
    """

    units: tuple[str, ...] = ()
    least_s: float = 2.0
    apart_s: float = 1.4
    clear_s: float = 0.7
    unstressed: Mapping[str, frozenset[str]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in ("least_s", "apart_s", "clear_s"):
            if not 0.0 <= getattr(self, name) <= 60.0:
                raise BadInput(f"stress {name}", expected="0 to 60 s", seen=getattr(self, name))


def stressed_moments(
    text: str, char_s: Sequence[float], language: str, rule: StressRule, taken_s: Sequence[float] = ()
) -> list[float]:
    """Moments of the words that may get a beat, sorted; char_s: of each character, seconds; taken_s: moments of
    words with gestures of their own.

    The phrases' main stresses come first, other content words fill what is left between them.
    """
    if not rule.units or len(text) < 2 or char_s[-1] - char_s[0] < rule.least_s:
        return []
    main: list[float] = []
    other: list[float] = []
    for phrase in _PHRASE.finditer(text):
        words = _content_words(phrase.group(), language, rule)
        places = [char_s[phrase.start() + at] for at in words]
        if places:
            strongest = 0 if language == "ja" else len(places) - 1
            main.append(places[strongest])
            other += places[:strongest] + places[strongest + 1 :]
    chosen: list[float] = []
    for moment in main + other:
        free = all(abs(moment - t) >= rule.clear_s for t in taken_s)
        if free and all(abs(moment - t) >= rule.apart_s for t in chosen):
            chosen.append(moment)
    return sorted(chosen)


def _content_words(phrase: str, language: str, rule: StressRule) -> list[int]:
    """Where the content words of a phrase begin."""
    unstressed = rule.unstressed.get(language, frozenset())
    pattern = _STEM if language == "ja" else WORD
    return [m.start() for m in pattern.finditer(phrase) if m.group().casefold().replace("’", "'") not in unstressed]
