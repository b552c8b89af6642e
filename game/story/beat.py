"""What goes into a step of a talk and what comes out: events, and the beat until the player is asked again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from game.core.errors import BadInput
from game.story.model import Speaker, TimerDef
from game.story.text import Text

__all__ = ["Beat", "Choice", "Chose", "Event", "Outcome", "Spoken", "Start", "Stimulus", "Timer", "Warp", "timer_at"]


@dataclass(frozen=True)
class Start:
    """The player steps up to the stall."""


@dataclass(slots=True)
class Chose:
    """The player takes a choice of the last beat; ``outcome`` is what the market made of it, if anything."""

    choice: str
    outcome: str | None = None


@dataclass(frozen=True)
class Outcome:
    """Something happened that no choice caused."""

    kind: str


@dataclass(frozen=True)
class Warp:
    """A designer jumps to a node, whatever the talk was doing."""

    node: str


Event = Start | Chose | Outcome | Warp


@dataclass(frozen=True)
class Spoken:
    """One line to speak, filled in, in both languages. face: a named expression; gesture: a named gesture with it."""

    id: str
    speaker: Speaker
    en: str
    ja: str
    face: str | None = None
    tone: str | None = None
    gesture: str | None = None

    def text(self, language: str) -> str:
        """The words in ``en`` or ``ja``."""
        return Text(self.en, self.ja).get(language)


@dataclass(frozen=True)
class Choice:
    """A choice on the table, exactly as it will be said; ``{offer}`` is left for the amount on the dial."""

    id: str
    act: str
    en: str
    ja: str
    available: bool
    reason: Text | None
    feel: Mapping[str, float]

    def text(self, language: str) -> str:
        """The words in ``en`` or ``ja``."""
        return Text(self.en, self.ja).get(language)


@dataclass(frozen=True)
class Stimulus:
    """``feel:`` of a node or line that was passed: signed changes per emotion (a choice's own stands in Choice)."""

    feel: Mapping[str, float]
    source: str


@dataclass(frozen=True)
class Timer:
    """A timed choice, where the player wants such: after ``seconds`` of waiting ``choice`` is taken."""

    seconds: float
    choice: str


def timer_at(timer: TimerDef | None, choices: Sequence[Choice]) -> Timer | None:
    """The timer of the place where the talk waits, if its default can be taken."""
    if timer is None or not any(choice.id == timer.default and choice.available for choice in choices):
        return None
    return Timer(timer.seconds, timer.default)


class Beat(NamedTuple):
    """What happens until the player is asked again. ``ended``: the name of an ending, None while the talk goes on."""

    node: str
    lines: tuple[Spoken, ...]
    choices: tuple[Choice, ...]
    stimuli: tuple[Stimulus, ...]
    ended: str | None
    timer: Timer | None = None

    def choice(self, choice_id: str) -> Choice:
        """The offered choice with an id. Raises BadInput where it is not offered."""
        for choice in self.choices:
            if choice.id == choice_id:
                return choice
        raise BadInput("choice", expected=" | ".join(choice.id for choice in self.choices) or "none", seen=choice_id)
