"""Lip-sync from timed text: English and Japanese vowels to mouth shapes.

Every character of a line has a moment (``char_s``). Japanese kana carry their vowel; a kanji, whose reading is not
known here, is given two morae chosen by its code, which keeps the rhythm and always looks the same. English letters
are read in vowel groups. Lips close on m, b, p, ん, っ and in pauses.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.core import BadInput
from game.formats import load_yaml

__all__ = ["VISEMES", "VisemeShapes", "VisemeTrack", "load_visemes", "viseme_track"]

Floats = NDArray[np.float64]
VISEMES: tuple[str, ...] = ("a", "i", "u", "e", "o", "closed")
_CLOSED = VISEMES.index("closed")
_SHORTEST_S = 0.075  # faster changes look like a flicker, not like speech
_LONGEST_S = 0.24  # a vowel held longer than this lets the mouth fall shut

_KANA_ROWS = {
    "a": "あかさたなはまやらわがざだばぱぁゃゎ",
    "i": "いきしちにひみりぎじぢびぴぃゐ",
    "u": "うくすつぬふむゆるぐずづぶぷぅゅゔ",
    "e": "えけせてねへめれげぜでべぺぇゑ",
    "o": "おこそとのほもよろをごぞどぼぽぉょ",
    "closed": "んっ",
}
_KANA = {kana: VISEMES.index(vowel) for vowel, row in _KANA_ROWS.items() for kana in row}
_LIPS_MEET = "まみむめもばびぶべぼぱぴぷぺぽ"
_ENGLISH_GROUPS = (
    ("oo", "u"), ("ee", "i"), ("ea", "i"), ("ie", "i"), ("ou", "o"), ("ow", "o"), ("oa", "o"), ("oi", "o"),
    ("au", "o"), ("aw", "o"), ("ai", "e"), ("ay", "e"), ("ei", "e"), ("ey", "i"), ("ue", "u"), ("ui", "u"),
    ("a", "a"), ("e", "e"), ("i", "i"), ("o", "o"), ("u", "a"), ("w", "u"),
    ("m", "closed"), ("b", "closed"), ("p", "closed"), ("f", "i"), ("v", "i"),
)  # fmt: skip


@dataclass(frozen=True)
class VisemeTrack:
    """Mouth shapes over one line: shape ``shape[k]`` (index into VISEMES) holds from ``start_s[k]`` on."""

    start_s: tuple[float, ...]
    shape: tuple[int, ...]
    length_s: float

    def at(self, time_s: float) -> Floats:
        """Weights (6,) of the shapes at a time, one-hot; all zero before and after the line (the mouth is at rest)."""
        weights = np.zeros(len(VISEMES))
        if self.start_s and 0.0 <= time_s < self.length_s:
            k = int(np.searchsorted(self.start_s, time_s, side="right")) - 1
            if k >= 0:
                weights[self.shape[k]] = 1.0
        return weights


@dataclass(frozen=True)
class VisemeShapes:
    """The drawn shapes (6,) each: opening mm, width factor, upper-lip arch mm, teeth and tongue amounts."""

    opening: Floats
    width: Floats
    top: Floats
    teeth: Floats
    tongue: Floats


def load_visemes(path: Path) -> VisemeShapes:
    """Read ``visemes.yaml``. Raises BadInput with file:line:col."""
    root = load_yaml(path).only("version", "visemes")
    root["version"].as_int(1, 1)
    table = root["visemes"].only(*VISEMES)
    rows = []
    for name in VISEMES:
        row = table[name].only("open", "width", "top", "teeth", "tongue")
        rows.append(
            [
                row["open"].as_float(0.0, 50.0),
                row["width"].as_float(0.2, 2.0),
                row["top"].as_float(0.0, 20.0),
                row["teeth"].as_float(0.0, 1.0),
                row["tongue"].as_float(0.0, 1.0),
            ]
        )
    array = np.array(rows)
    array.setflags(write=False)
    return VisemeShapes(*array.T)


def _japanese(text: str) -> list[tuple[float, int]]:
    """(place in characters, shape) of every mora."""
    result: list[tuple[float, int]] = []
    last = _CLOSED
    for place, raw in enumerate(text):
        char = chr(ord(raw) - 0x60) if "ァ" <= raw <= "ヶ" else raw
        if char in _KANA:
            if char in _LIPS_MEET:
                result.append((float(place), _CLOSED))
                result.append((place + 0.35, _KANA[char]))
            else:
                result.append((float(place), _KANA[char]))
            last = _KANA[char]
        elif raw in "ー〜":
            result.append((float(place), last))
        elif unicodedata.category(raw) == "Lo":  # a kanji: two morae
            code = ord(raw)
            result.append((float(place), code % 5))
            result.append((place + 0.5, (code // 5) % 5))
        elif raw.isalnum():
            result.append((float(place), ord(raw) % 5))
        else:
            result.append((float(place), _CLOSED))
    return result


def _english(text: str) -> list[tuple[float, int]]:
    lower = text.lower()
    result: list[tuple[float, int]] = []
    place = 0
    while place < len(lower):
        for group, shape in _ENGLISH_GROUPS:
            if lower.startswith(group, place):
                silent = group == "e" and place > 1 and not lower[place + 1 : place + 2].isalpha()
                if not silent:
                    result.append((float(place), VISEMES.index(shape)))
                place += len(group)
                break
        else:
            char = lower[place]
            if char.isdigit():
                result.append((float(place), int(char) % 5))
            elif char in ".,;:!?…—–-":
                result.append((float(place), _CLOSED))
            place += 1
    return result


def viseme_track(text: str, language: str, char_s: Sequence[float], length_s: float) -> VisemeTrack:
    """Mouth shapes of a spoken line.

    text: one line of at most 2,000 characters; language: ``en`` or ``ja``; char_s: the moment of every character in
    seconds from the line's start; length_s: when the line ends. Raises BadInput for lengths that do not match.
    """
    if language not in ("en", "ja"):
        raise BadInput("language", expected="en | ja", seen=language)
    if len(char_s) != len(text) or len(text) > 2000:
        raise BadInput("timed text", expected=f"{len(text)} moments, at most 2000", seen=len(char_s))
    sounds = _japanese(text) if language == "ja" else _english(text)
    moments = np.append(np.asarray(char_s, dtype=np.float64), length_s)
    places = np.arange(len(moments), dtype=np.float64)
    starts: list[float] = []
    shapes: list[int] = []
    for place, shape in sounds:
        start = float(np.interp(place, places, moments))
        if starts and start - starts[-1] < _SHORTEST_S:
            # Too close to the last: an open vowel is worth more than a consonant's closing.
            if shape != _CLOSED and shapes[-1] == _CLOSED:
                shapes[-1] = shape
            continue
        if starts and start - starts[-1] > _LONGEST_S and shapes[-1] != _CLOSED:
            starts.append(starts[-1] + _LONGEST_S)
            shapes.append(_CLOSED)
        starts.append(start)
        shapes.append(shape)
    if starts and length_s - starts[-1] > _LONGEST_S and shapes[-1] != _CLOSED:
        starts.append(starts[-1] + _LONGEST_S)
        shapes.append(_CLOSED)
    return VisemeTrack(tuple(starts), tuple(shapes), float(length_s))
