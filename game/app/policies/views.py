"""What a policy sees before it decides: one dataclass for each kind of eye, and nothing else is handed over.

Nobody sees the lowest price. Only the oracle sees what is felt; bodies are seen as names of units, never as numbers.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["BodyView", "FaceView", "Line", "OracleView", "ReaderView", "Sign", "Table", "View", "WordsView"]

Sign = tuple[str, str]
"""(layer, unit) of a motion unit on stage."""


@dataclass(frozen=True, slots=True)
class Line:
    """A choice that can be taken: its id and what kind of line it is, as any reader of the line would say."""

    id: str
    act: str


@dataclass(frozen=True, slots=True)
class Table:
    """What lies open for anybody: money in whole units of the currency, rounds, the lines on offer.

    offer: the player's best so far, 0 if none; answer: what became of the last one (none, refused, insult);
    called_back: whether the player turned to go and was called back; tidying: the shopkeeper clears the table.
    """

    item: str
    list_price: int
    ask: int
    purse: int
    offer: int
    answer: str
    round: int
    rounds: int
    tidying: bool
    lines: tuple[Line, ...]


@dataclass(frozen=True, slots=True)
class WordsView:
    """The words alone. said: what was spoken since the last choice; told: how the player's line landed, where the
    words tell it (right, neutral, wrong), else empty."""

    table: Table
    said: tuple[str, ...]
    told: str


@dataclass(frozen=True, slots=True)
class FaceView:
    """The face alone: one part per region, and the place in valence and arousal where it is drawn."""

    table: Table
    parts: tuple[str, ...]
    valence: float
    arousal: float


@dataclass(frozen=True, slots=True)
class BodyView:
    """The body alone. signs: units that came on stage since the last choice; quiet: those to be seen after the last
    word."""

    table: Table
    signs: tuple[Sign, ...]
    quiet: tuple[Sign, ...]


@dataclass(frozen=True, slots=True)
class ReaderView:
    """Words, face and body."""

    table: Table
    said: tuple[str, ...]
    told: str
    parts: tuple[str, ...]
    valence: float
    arousal: float
    signs: tuple[Sign, ...]
    quiet: tuple[Sign, ...]


@dataclass(frozen=True, slots=True)
class OracleView:
    """What is felt, as seven numbers by name. Not the lowest price."""

    table: Table
    felt: Mapping[str, float]


View = Table | WordsView | FaceView | BodyView | ReaderView | OracleView
