"""Timed text: when each character appears, and when each word is spoken, so that gestures meet their words."""

from __future__ import annotations

import bisect
import re
from collections.abc import Iterable
from dataclasses import dataclass, field

from game.core.errors import BadInput
from game.story.text import LANGUAGES, wrap

__all__ = ["CHARS_PER_S", "TimedText", "TimedWord"]

# Reading aloud: about 170 words a minute of English, some 7 to 8 morae a second of Japanese, both a little hurried
# so that the text never lags behind a reader.
CHARS_PER_S = {"en": 30.0, "ja": 13.0}
# A breath after punctuation, in characters' worth of time.
_PAUSE = {",": 4.0, ";": 5.0, ":": 4.0, ".": 8.0, "!": 8.0, "?": 8.0, "…": 9.0, "—": 6.0, "–": 4.0}
_PAUSE_JA = {"、": 2.5, "。": 4.5, "！": 4.5, "？": 4.5, "…": 3.0, "—": 3.0, "〜": 1.0}
_WORD = re.compile(r"[^\W_]+(?:['’][^\W_]+)*")


@dataclass(frozen=True)
class TimedWord:
    """A word of the line: when it is spoken (seconds from the line's start) and where it stands in the text."""

    text: str
    start_s: float
    end_s: float
    index: int


@dataclass(frozen=True)
class TimedText:
    """One spoken line in time. ``chars_per_s`` None takes the language's own speed. Raises BadInput otherwise."""

    text: str
    language: str
    chars_per_s: float | None = None
    char_s: tuple[float, ...] = field(init=False)
    length_s: float = field(init=False)

    def __post_init__(self) -> None:
        if self.language not in LANGUAGES:
            raise BadInput("language", expected=" | ".join(LANGUAGES), seen=self.language)
        speed = CHARS_PER_S[self.language] if self.chars_per_s is None else self.chars_per_s
        if not 0.1 <= speed <= 1e6:
            raise BadInput("text speed", expected="0.1 to 1e6 characters a second", seen=speed)
        pauses = _PAUSE_JA if self.language == "ja" else _PAUSE
        times: list[float] = []
        now = 0.0
        for index, char in enumerate(self.text):
            times.append(now / speed)
            now += 1.0
            last_of_run = index + 1 == len(self.text) or self.text[index + 1] not in pauses
            inside_number = char in ".,:" and self.text[index + 1 : index + 2].isdigit()
            if last_of_run and not inside_number:
                now += pauses.get(char, 0.0)
        object.__setattr__(self, "char_s", tuple(times))
        object.__setattr__(self, "length_s", now / speed)

    @property
    def rows(self) -> tuple[str, ...]:
        """The text wrapped as the subtitle box shows it."""
        return wrap(self.text, self.language)

    def visible(self, time_s: float) -> int:
        """How many characters stand in the box at a time."""
        return bisect.bisect_right(self.char_s, time_s)

    @property
    def words(self) -> tuple[TimedWord, ...]:
        """English words in lower case; Japanese, which puts no spaces, character by character."""
        if self.language == "ja":
            return tuple(self._word(i, i + 1) for i, char in enumerate(self.text) if char.isalnum())
        return tuple(self._word(match.start(), match.end()) for match in _WORD.finditer(self.text))

    def cues(self, vocabulary: Iterable[str]) -> tuple[TimedWord, ...]:
        """Where words of a vocabulary are spoken, in order; the longest match wins and matches do not overlap.

        English: whole words or phrases in any case. Japanese: anywhere in the text. ``text`` of a cue is the
        vocabulary's own spelling.
        """
        known = {_plain(word): word for word in vocabulary if word}
        if not known:
            return ()
        pattern = "|".join(re.escape(word) for word in sorted(known, key=lambda word: (-len(word), word)))
        if self.language == "en":
            pattern = rf"(?<![^\W_])(?:{pattern})(?![^\W_])"
        text = _plain(self.text)
        if len(text) != len(self.text):
            text = self.text  # a letter that changes its length in lower case: match as written
        found = re.finditer(pattern, text)
        return tuple(self._word(m.start(), m.end(), known[m.group()]) for m in found)

    def _word(self, start: int, end: int, name: str | None = None) -> TimedWord:
        end_s = self.char_s[end] if end < len(self.char_s) else self.length_s
        return TimedWord(self.text[start:end].lower() if name is None else name, self.char_s[start], end_s, start)


def _plain(word: str) -> str:
    return word.lower().replace("’", "'")
