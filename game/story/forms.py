"""Forms of words that follow a number or a person: English plurals and pronouns, Japanese counters.

``{told:one story|# stories}`` in a line picks by the value of ``told``; ``#`` is the number as a sentence writes it.
English takes one|other or none|one|other; Japanese, which has no plural, takes other or none|other, with native
numerals before つ and 人. ``{they}`` and its kin are the shopkeeper's pronouns; in Japanese they are the name with
さん, so that no line tells anybody's gender.
"""

from __future__ import annotations

from typing import Literal

__all__ = ["FORMS", "PERSON_SLOTS", "Pronoun", "capitalised", "form_of", "form_texts", "number_text", "person_word"]

Pronoun = Literal["she", "he", "they"]

FORMS = {"en": (2, 3), "ja": (1, 2)}
"""How many forms a language takes; the larger number has one for none."""
PERSON_SLOTS: tuple[str, ...] = ("name", "they", "them", "their")

_PRONOUNS: dict[str, dict[str, str]] = {
    "she": {"they": "she", "them": "her", "their": "her"},
    "he": {"they": "he", "them": "him", "their": "his"},
    "they": {"they": "they", "them": "them", "their": "their"},
}
_WORDS = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
_KANJI = "〇一二三四五六七八九十"
_SENTENCE_ENDS = frozenset(".!?…:\n")
_OPENING = "\"'“‘( \n"


def number_text(number: float) -> str:
    """A number in digits: thousands separated, at most two decimals."""
    return f"{round(number):,}" if abs(number - round(number)) < 0.005 else f"{number:,.2f}".rstrip("0")


def form_of(forms: str, number: float, language: str) -> str:
    """The form that goes with a number, ``#`` written out. Too few forms give the last, nothing fails."""
    parts = forms.split("|")
    most = FORMS[language][1]
    if language == "ja":
        part = parts[0] if len(parts) == most and number == 0 else parts[-1]
        return _counted(part, number)
    if len(parts) >= most:
        index = 0 if number == 0 else 1 if number == 1 else 2
    else:
        index = 0 if number == 1 else 1
    part = parts[min(index, len(parts) - 1)]
    small = number == int(number) and 0 <= number < len(_WORDS)
    return part.replace("#", _WORDS[int(number)] if small else number_text(number))


def form_texts(forms: str, language: str) -> list[str]:
    """Every form as long as it gets: for checks of length."""
    return [part.replace("#", "seven" if language == "en" else "88") for part in forms.split("|")]


def _counted(part: str, number: float) -> str:
    """A Japanese counter with its number: 三つ, 十, 12個; 三人; 3冊."""
    small = number == int(number) and 1 <= number <= 10
    kanji = _KANJI[int(number)] if small else ""
    if kanji:
        part = part.replace("#つ", kanji if number == 10 else f"{kanji}つ").replace("#人", f"{kanji}人")
    digits = number_text(number)
    return part.replace("#つ", f"{digits}個").replace("#", digits)


def person_word(slot: str, name: str, pronoun: Pronoun, language: str) -> str:
    """What ``{name}``, ``{they}``, ``{them}`` or ``{their}`` stands for."""
    if slot == "name":
        return name
    if language == "en":
        return _PRONOUNS[pronoun][slot]
    return f"{name}さんの" if slot == "their" else f"{name}さん"


def capitalised(word: str, before: str) -> str:
    """The word with a capital where the text before it ends a sentence, or there is none."""
    left = before.rstrip(_OPENING)
    begins = not left or left[-1] in _SENTENCE_ENDS
    return word[:1].upper() + word[1:] if begins else word
