"""Real fonts for the interface: which files, which glyphs, lines of text as pictures of coverage."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import groupby
from pathlib import Path

import numpy as np
import pygame
import pygame.font
import pygame.surfarray
from numpy.typing import NDArray

from game.core.errors import MissingPart

__all__ = ["FontSet", "Line", "MissingFont", "font_folders", "japanese_font"]

# Usual Japanese fonts of Linux, macOS and Windows, best first. File name stems, lower case, without blanks and dashes.
_JAPANESE = (
    "notosanscjkjpmedium",
    "notosanscjkjpregular",
    "notosanscjkregular",
    "notosansjp",
    "hiraginosansgb",
    "ヒラギノ角ゴシックw3",
    "ヒラギノ角ゴシックw4",
    "hiraginokakugothicpronw3",
    "yugothm",
    "yugothr",
    "yugothb",
    "meiryo",
    "msgothic",
    "ipaexg",
    "ipagp",
    "ipag",
    "takaopgothic",
    "takaogothic",
    "vlpgothicregular",
    "vlgothicregular",
    "sourcehansansjpregular",
    "mplus1pregular",
)
_WRAPPED = 256  # paragraphs whose line breaks are remembered
_UNASSIGNED = "\u0378"  # a code point without a character: fonts draw their box for unknown ones


class MissingFont(MissingPart):
    """No font has the glyphs of a language; says what to install."""


@dataclass(frozen=True)
class Line:
    """A drawn line: coverage (h, w) uint8; ascent: rows above the baseline."""

    coverage: NDArray[np.uint8]
    ascent: int


def font_folders() -> list[Path]:
    """Where systems keep their fonts."""
    home = Path.home()
    return [
        Path("/usr/share/fonts"),
        Path("/usr/local/share/fonts"),
        home / ".local/share/fonts",
        home / ".fonts",
        Path("/System/Library/Fonts"),
        Path("/Library/Fonts"),
        home / "Library/Fonts",
        Path("C:/Windows/Fonts"),
    ]


def _package_file(package: str, pattern: str) -> Path | None:
    """A file of an installed package, found without importing it (some font packages import much else)."""
    spec = find_spec(package)
    for folder in (spec.submodule_search_locations or ()) if spec else ():
        found = sorted(Path(folder).rglob(pattern))
        if found:
            return found[0]
    return None


def japanese_font(folders: Iterable[Path] | None = None) -> Path | None:
    """The best Japanese font file of the system, else the one of the package ``matplotlib-fontja``, else None."""
    found: dict[str, Path] = {}
    for folder in font_folders() if folders is None else folders:
        if folder.is_dir():
            for path in folder.rglob("*"):
                if path.suffix.lower() in (".ttf", ".otf", ".ttc"):
                    found.setdefault(path.stem.lower().replace("-", "").replace(" ", "").replace("_", ""), path)
    for stem in _JAPANESE:
        if stem in found:
            return found[stem]
    return _package_file("matplotlib_fontja", "ipaexg.ttf")


class FontSet:
    """Fonts by role and size, with fallbacks for single characters.

    Roles: ``body``, ``bold``, ``title``. Sizes are device pixels: text is drawn at the size it is shown, never scaled.
    """

    def __init__(self, files: dict[str, Sequence[Path]]) -> None:
        """files: role -> font files, the first preferred, the others for characters it lacks."""
        if not pygame.font.get_init():
            pygame.font.init()
        self._files = {role: tuple(paths) for role, paths in files.items()}
        self._fonts: dict[tuple[Path, int], pygame.font.Font] = {}
        self._unknown: dict[Path, bytes] = {}
        self._wrapped: dict[tuple[str, str, int, float], list[str]] = {}
        self._choice: dict[tuple[str, str], Path | None] = {}

    @classmethod
    def for_language(cls, language: str) -> FontSet:
        """Fonts for ``en`` or ``ja`` (any other language is treated as English).

        Raises MissingFont where a package, or for ``ja`` every known Japanese font, is missing.
        """
        body = _package_file("font_source_sans_pro", "*Pro-Regular.ttf") or _package_file(
            "font_source_sans_pro", "*.ttf"
        )
        bold = _package_file("font_source_sans_pro", "*Pro-Semibold.ttf") or body
        title = _package_file("font_fredoka_one", "*.ttf")
        if body is None or bold is None or title is None:
            raise MissingFont("no interface font; install them: pip install font-source-sans-pro font-fredoka-one")
        japanese = japanese_font()
        if language.lower().startswith("ja"):
            if japanese is None:
                raise MissingFont(
                    "no Japanese font; install one: apt-get install fonts-noto-cjk, or pip install matplotlib-fontja"
                )
            # Latin letters of the Japanese fonts are plain: Source Sans beside kana looks better, and fits in height.
            return cls({"body": (body, japanese), "bold": (bold, japanese), "title": (title, japanese)})
        spare = (japanese,) if japanese else ()
        return cls({"body": (body, *spare), "bold": (bold, *spare), "title": (title, body, *spare)})

    def _font(self, path: Path, size_px: int) -> pygame.font.Font:
        key = (path, size_px)
        if key not in self._fonts:
            self._fonts[key] = pygame.font.Font(str(path), size_px)
        return self._fonts[key]

    def _file_for(self, role: str, character: str) -> Path | None:
        """The first font of the role that has the character, None if none has it."""
        key = (role, character)
        if key not in self._choice:
            self._choice[key] = next((path for path in self._files[role] if self._has(path, character)), None)
        return self._choice[key]

    def _has(self, path: Path, character: str) -> bool:
        """Whether the font draws the character as something else than its box for unknown ones."""
        font = self._font(path, 24)
        if path not in self._unknown:
            self._unknown[path] = _bits(font.render(_UNASSIGNED, True, (255, 255, 255)))
        return character.isspace() or _bits(font.render(character, True, (255, 255, 255))) != self._unknown[path]

    def missing(self, text: str, role: str = "body") -> str:
        """The characters of the text that no font of the role has."""
        return "".join(sorted({c for c in text if not c.isspace() and self._file_for(role, c) is None}))

    def _runs(self, text: str, role: str) -> list[tuple[Path, str]]:
        first = self._files[role][0]
        pieces = groupby(text, key=lambda c: self._file_for(role, c) or first)
        return [(path, "".join(characters)) for path, characters in pieces]

    def width(self, text: str, role: str, size_px: int) -> int:
        """Advance of one line in pixels."""
        return sum(self._font(path, size_px).size(piece)[0] for path, piece in self._runs(text, role))

    def height(self, role: str, size_px: int) -> int:
        """Distance of two lines in pixels."""
        return max(self._font(path, size_px).get_linesize() for path in self._files[role])

    def ascent(self, role: str, size_px: int) -> int:
        """Rows above the baseline of any line of the role."""
        return max(self._font(path, size_px).get_ascent() for path in self._files[role])

    def draw(self, text: str, role: str, size_px: int) -> Line:
        """Draw one line, white on nothing."""
        ascent = self.ascent(role, size_px)
        pieces = []
        for path, piece in self._runs(text, role):
            font = self._font(path, size_px)
            alpha = pygame.surfarray.array_alpha(font.render(piece, True, (255, 255, 255))).T
            pieces.append((alpha, ascent - font.get_ascent()))
        height = max((top + len(alpha) for alpha, top in pieces), default=1)
        coverage = np.zeros((height, max(1, sum(alpha.shape[1] for alpha, _ in pieces))), np.uint8)
        x = 0
        for alpha, top in pieces:
            coverage[top : top + len(alpha), x : x + alpha.shape[1]] = alpha
            x += alpha.shape[1]
        return Line(coverage, ascent)

    def wrap(self, text: str, role: str, size_px: int, width_px: float) -> list[str]:
        """Break a paragraph into lines of at most ``width_px``; Japanese breaks between any two characters but not
        before closing punctuation."""
        key = (text, role, size_px, width_px)
        if key not in self._wrapped:
            if len(self._wrapped) >= _WRAPPED:
                self._wrapped.clear()
            self._wrapped[key] = self._wrap(text, role, size_px, width_px)
        return list(self._wrapped[key])

    def _wrap(self, text: str, role: str, size_px: int, width_px: float) -> list[str]:
        lines: list[str] = []
        for paragraph in text.split("\n"):
            tokens = _tokens(paragraph)
            full = self._broken(tokens, role, size_px, width_px, phrases=False)
            kind = self._broken(tokens, role, size_px, width_px, phrases=True) if len(full) > 1 else full
            # Phrases are kept whole where that costs no further line.
            lines += kind if len(kind) == len(full) else full
        return lines

    def _broken(self, tokens: list[str], role: str, size_px: int, width_px: float, *, phrases: bool) -> list[str]:
        lines: list[str] = []
        line: list[str] = []
        for token in tokens:
            if line and self.width("".join([*line, token]).rstrip(), role, size_px) > width_px:
                at = _phrase_end([*line, token]) if phrases else len(line)
                lines.append("".join(line[:at]).rstrip())
                line = line[at:]
                token = token if line else token.lstrip()
            line.append(token)
        return [*lines, "".join(line).rstrip()]


def _bits(surface: pygame.Surface) -> bytes:
    return f"{surface.get_size()}".encode() + pygame.surfarray.array_alpha(surface).tobytes()


_NO_LINE_START = (
    "、。，．・：；？！゛゜ヽヾゝゞ々ー）］｝」』】〉》〕ぁぃぅぇぉっゃゅょゎァィゥェォッャュョヮ…‥!?,.:;)]}%"
)


_LOOK_BACK = 0.45
"""So much of a line may be left empty for the sake of a phrase."""


def _phrase_end(tokens: list[str]) -> int:
    """Before which token a line of Japanese is broken best; the last one does not fit any more. A sentence or clause
    ends, or a new word begins: kanji and katakana begin words, hiragana end them."""
    best, found = len(tokens) - 1, 0.0
    for at in range(len(tokens) - 1, round((1.0 - _LOOK_BACK) * len(tokens)), -1):
        before, after = tokens[at - 1][-1], tokens[at][0]
        if ord(before) <= 0x2E7F and ord(after) <= 0x2E7F:
            worth = 1.0 if at == len(tokens) - 1 else 0.0
        elif before in "。！？!?…　":
            worth = 3.0
        elif before in "、」』":
            worth = 2.5
        else:
            worth = 1.5 if _is_hiragana(before) and not _is_hiragana(after) and after.isalnum() else 0.0
        worth -= (len(tokens) - 1 - at) / len(tokens)
        if worth > found:
            best, found = at, worth
    return best


def _is_hiragana(letter: str) -> bool:
    return "\u3041" <= letter <= "\u309f"


def _tokens(text: str) -> list[str]:
    """Pieces between which a line may break: words with their blank, or single ideographs with closing marks."""
    tokens: list[str] = []
    for c in text:
        wide = ord(c) > 0x2E7F
        before = tokens[-1] if tokens else ""
        glue = before and (
            c in _NO_LINE_START or (not wide and ord(before[-1]) <= 0x2E7F and not before[-1].isspace()) or c == " "
        )
        if glue:
            tokens[-1] += c
        else:
            tokens.append(c)
    return tokens
