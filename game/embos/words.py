"""The words that call up gestures, laid out so that a line is read once however many words there are."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

__all__ = ["BY_SUBSTRING", "WORD", "WordIndex", "normal_word"]

WORD = re.compile(r"[^\W_]+(?:['’][^\W_]+)*")
BY_SUBSTRING = frozenset({"ja", "zh", "ko"})
"""Languages written without spaces between words."""


def normal_word(word: str) -> str:
    """Without regard to case, width and kind of apostrophe."""
    return unicodedata.normalize("NFKC", word).casefold().replace("’", "'")


def _forms(word: str) -> frozenset[str]:
    """A word with its simple inflections: plural and possessive."""
    forms = {word, word + "s", word + "'s", word + "s'"}
    if word.endswith(("s", "x", "z", "ch", "sh")):
        forms.add(word + "es")
    if word.endswith("y") and word[-2:-1] not in set("aeiou"):
        forms.add(word[:-1] + "ies")
    return frozenset(forms)


@dataclass(frozen=True)
class WordIndex:
    """One language's words. starts: first word (or, without spaces, first letter) -> (column, what must follow)."""

    language: str
    starts: Mapping[str, tuple[tuple[int, tuple[frozenset[str], ...] | str], ...]]

    @classmethod
    def of(cls, language: str, words: Iterable[tuple[int, str]]) -> WordIndex:
        """words: (column, word or phrase)."""
        starts: dict[str, list[tuple[int, tuple[frozenset[str], ...] | str]]] = {}
        for column, word in words:
            plain = normal_word(word)
            if language in BY_SUBSTRING:
                if plain:
                    starts.setdefault(plain[0], []).append((column, plain))
                continue
            parts = tuple(_forms(part) for part in WORD.findall(plain))
            for form in parts[0] if parts else ():
                starts.setdefault(form, []).append((column, parts))
        return cls(language, {start: tuple(entries) for start, entries in starts.items()})

    def find(self, tokens: Sequence[tuple[str, float]]) -> list[tuple[float, int]]:
        """(moment, column) of every word found in (token, moment) pairs, sorted, none twice.

        Where words are spaced, whole words match; elsewhere a token matches a word it starts with.
        """
        timed = [(normal_word(token), moment) for token, moment in tokens]
        found: set[tuple[float, int]] = set()
        for i, (token, moment) in enumerate(timed):
            for column, wanted in self.starts.get(token[:1] if self.language in BY_SUBSTRING else token, ()):
                if isinstance(wanted, str):
                    match = token.startswith(wanted)
                else:
                    match = len(timed) - i >= len(wanted) and all(
                        timed[i + j][0] in forms for j, forms in enumerate(wanted)
                    )
                if match:
                    found.add((moment, column))
        return sorted(found)
