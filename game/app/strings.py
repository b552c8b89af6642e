"""What the program itself says, in both languages, from ``assets/ui/strings.yaml``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from game.core.errors import BadInput
from game.core.paths import ASSETS
from game.formats.yaml_source import load_yaml

__all__ = ["LANGUAGES", "Strings", "load_strings"]

LANGUAGES = ("en", "ja")


@dataclass(frozen=True)
class Strings:
    """The interface's texts in one language; a missing key is a fault of ours and raises KeyError."""

    language: str
    texts: Mapping[str, Mapping[str, str]]

    def __call__(self, key: str, **slots: object) -> str:
        """The text of a key, its {slots} filled in."""
        text = self.texts[key][self.language]
        for name, value in slots.items():
            text = text.replace("{" + name + "}", str(value))
        return text

    def switched(self, language: str) -> Strings:
        """The same texts in another language."""
        if language not in LANGUAGES:
            raise BadInput("language", expected=" | ".join(LANGUAGES), seen=language)
        return Strings(language, self.texts)


def load_strings(language: str = "en", path: Path = ASSETS / "ui" / "strings.yaml") -> Strings:
    """Read the texts. Raises BadInput where one lacks a language."""
    texts: dict[str, dict[str, str]] = {}
    for key, value in load_yaml(path).items():
        value.only(*LANGUAGES)
        texts[key.as_str()] = {name: value[name].as_str() for name in LANGUAGES}
    return Strings(language, texts).switched(language)
