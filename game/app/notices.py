"""What the game says in passing: it stands until it can be read, then goes; everything can be read again."""

from __future__ import annotations

import unicodedata
from dataclasses import dataclass, field

from game.app.world import TICK_S

__all__ = ["Notice", "Notices", "reading_s"]

MOST = 40
"""So many are kept to be read again."""
AT_ONCE_S, LETTER_S, WIDE_S = 3.0, 0.065, 0.16
"""Noticing it, then reading: slow readers need about so long for a letter, and for a Japanese one."""
LEAST_S, LONGEST_S = 4.0, 14.0
FADE_S = 0.5


def reading_s(text: str) -> float:
    """Seconds a message stands: long enough to be noticed and read slowly."""
    wide = sum(unicodedata.east_asian_width(letter) in "WF" for letter in text)
    return min(max(AT_ONCE_S + LETTER_S * (len(text) - wide) + WIDE_S * wide, LEAST_S), LONGEST_S)


@dataclass(frozen=True)
class Notice:
    """One message. tick: of the session, when it was said."""

    text: str
    tick: int


@dataclass
class Notices:
    """The message that stands, by the simulation's clock, and the ones before it, oldest first."""

    told: list[Notice] = field(default_factory=list)
    taken_back: bool = False

    def say(self, text: str, tick: int) -> None:
        """A new message in place of the one that stands (said again, it stands anew); none only takes that away."""
        self.taken_back = not text
        if text:
            before = self.told[:-1] if self.told and self.told[-1].text == text else self.told
            self.told = [*before[-MOST + 1 :], Notice(text, tick)]

    def now(self, tick: int) -> str:
        """The message that stands, empty where none does."""
        return self.told[-1].text if self.strength(tick, still=True) > 0.0 else ""

    def strength(self, tick: int, *, still: bool) -> float:
        """How far it can be seen, in [0, 1]; still: it does not fade, it goes."""
        if not self.told or self.taken_back:
            return 0.0
        left_s = reading_s(self.told[-1].text) - (tick - self.told[-1].tick) * TICK_S
        if still:
            return float(left_s > 0.0)
        return min(max(1.0 + left_s / FADE_S, 0.0), 1.0)
