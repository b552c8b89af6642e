"""Words in two languages: wrapping to the subtitle box, and names in braces that are filled in when spoken."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

from game.core.errors import BadInput
from game.story.forms import PERSON_SLOTS, Pronoun, capitalised, form_of

__all__ = ["LANGUAGES", "ROWS_PER_BOX", "ROW_CHARS", "Pronoun", "Text", "fill", "forms_in", "slots", "wrap"]

LANGUAGES: tuple[str, ...] = ("en", "ja")
ROW_CHARS = {"en": 38, "ja": 22}
ROWS_PER_BOX = 3

_SLOT = re.compile(r"\{([^{}]*)\}")
_NAME = re.compile(r"[a-z_][a-z0-9_]*")
# Kinsoku: what may not begin a row, and what may not end one (JIS X 4051, the common subset).
_NOT_FIRST = frozenset("、。，．・：；？！ー…」』）】〉》々ぁぃぅぇぉっゃゅょァィゥェォッャュョ,.!?)]")
_NOT_LAST = frozenset("「『（【〈《([")


@dataclass(frozen=True)
class Text:
    """The same words in both languages; an empty string where a translation is missing."""

    en: str
    ja: str

    @cached_property
    def names(self) -> frozenset[str]:
        """The names that stand in braces in either language."""
        return frozenset(name for words in (self.en, self.ja) for name, _ in slots(words))

    def get(self, language: str) -> str:
        """The words in ``en`` or ``ja``; English where the other is missing. Raises BadInput for another language."""
        if language not in LANGUAGES:
            raise BadInput("language", expected=" | ".join(LANGUAGES), seen=language)
        return (self.ja if language == "ja" else self.en) or self.en


def slots(text: str) -> list[tuple[str, int]]:
    """The names that stand in braces, with their places in the text; a lone brace is given as '{' or '}'."""
    found = [(match.group(1).partition(":")[0], match.start()) for match in _SLOT.finditer(text)]
    rest = _SLOT.sub(lambda match: "\0" * len(match.group()), text)
    found += [(char, index) for index, char in enumerate(rest) if char in "{}"]
    return sorted(found, key=lambda item: item[1])


def forms_in(text: str) -> list[tuple[str, str, int]]:
    """(name, forms, place) of every ``{name:form|form}``."""
    found = [(*match.group(1).partition(":")[::2], match) for match in _SLOT.finditer(text) if ":" in match.group(1)]
    return [(name, forms, match.start()) for name, forms, match in found]


def fill(
    text: str,
    value_of: Callable[[str], str | None],
    number_of: Callable[[str], float | None] = lambda name: None,
    language: str = "en",
) -> str:
    """Replace ``{name}`` by its value and ``{name:one|other}`` by the form that goes with its number.

    What has no value stays as it stands. No format language, nothing nested.
    """

    filled = []
    for piece in _pieces(text, language):
        if isinstance(piece, str):
            filled.append(piece)
            continue
        if piece.forms is None:
            value = value_of(piece.name)
        else:
            number = number_of(piece.name)
            value = None if number is None else form_of(piece.forms, number, language)
        if value is None:
            value = piece.written
        elif piece.before is not None:
            value = capitalised(value, piece.before)
        filled.append(value)
    return "".join(filled)


class _Slot(NamedTuple):
    """A name in braces, as written; the forms after its colon; the text before it, where its value may begin a
    sentence."""

    written: str
    name: str
    forms: str | None
    before: str | None


@lru_cache(maxsize=8192)
def _pieces(text: str, language: str) -> tuple[str | _Slot, ...]:
    """The words and the names in braces of a text, in turn: lines are taken apart once and filled in many times."""
    pieces: list[str | _Slot] = []
    end = 0
    for match in _SLOT.finditer(text):
        name, colon, forms = match.group(1).partition(":")
        if _NAME.fullmatch(name):
            grows = language == "en" and (colon or name in PERSON_SLOTS)
            before = text[: match.start()] if grows else None
            pieces += [text[end : match.start()], _Slot(match.group(), name, forms if colon else None, before)]
            end = match.end()
    return (*pieces, text[end:])


def wrap(text: str, language: str) -> tuple[str, ...]:
    """Rows as the subtitle box shows them: 38 characters of English by words, 22 of Japanese by kinsoku."""
    width = ROW_CHARS[language]
    rows: list[str] = []
    for paragraph in text.strip().split("\n"):
        rows.extend(_wrap_ja(paragraph.strip(), width) if language == "ja" else _wrap_words(paragraph, width))
    return tuple(rows)


def _wrap_words(text: str, width: int) -> list[str]:
    rows = [""]
    for word in text.split():
        if rows[-1] and len(rows[-1]) + 1 + len(word) > width:
            rows.append(word)
        else:
            rows[-1] = f"{rows[-1]} {word}" if rows[-1] else word
    return rows


def _wrap_ja(text: str, width: int) -> list[str]:
    rows: list[str] = []
    while len(text) > width:
        cut = width
        while cut > width - 4 and (text[cut] in _NOT_FIRST or text[cut - 1] in _NOT_LAST or _inside_word(text, cut)):
            cut -= 1
        rows.append(text[:cut].rstrip())
        text = text[cut:].lstrip()
    return [*rows, text]


def _inside_word(text: str, cut: int) -> bool:
    """Numbers and Latin words stay whole."""
    return text[cut - 1].isascii() and text[cut - 1].isalnum() and text[cut].isascii() and text[cut].isalnum()
