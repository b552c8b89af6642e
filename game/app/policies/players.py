"""The players behind the policies' names. Each decides from its view alone."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from game.app.policies.beliefs import Acquaintance, Belief, BodyReading, FaceReading
from game.app.policies.strategy import Bargainer, FixedPlan, Strategy, money
from game.app.policies.views import BodyView, FaceView, Line, OracleView, ReaderView, Table, WordsView
from game.app.talk import Choice
from game.core.emotion_space import EMOTIONS
from game.market import MarketRules
from game.story import ACTS

__all__ = [
    "BodyPlayer",
    "ExplorerPlayer",
    "FacePlayer",
    "FixedPlayer",
    "OraclePlayer",
    "Player",
    "RandomPlayer",
    "ReaderPlayer",
    "Reading",
    "WordsPlayer",
]


class Player(Protocol):
    """Plays one talk from its views."""

    def move(self, view: Any) -> Choice: ...


@dataclass
class RandomPlayer:
    """Any available line; an offer, where one comes with it, anywhere between the last one and the ask."""

    rng: random.Random

    def move(self, view: Table) -> Choice:
        """The next move."""
        rng = self.rng
        lines = [line for line in view.lines if line.act != "leave"]
        line = lines[int(rng.random() * len(lines))]
        low = max(view.offer, 0.4 * view.list_price)
        amount = money(rng.uniform(min(low, view.ask), view.ask), min(view.ask, view.purse))
        with_offer = line.act == "offer" or (line.act != "wait" and rng.random() < 0.6)
        return Choice(line.id, amount if with_offer else None)


@dataclass
class ExplorerPlayer:
    """A tester with another temper in every talk: one kind of line it likes, one way with money.

    What good players seldom do (a joke that lands wrong, a bargain after an insult) comes about in the same talks.
    """

    rng: random.Random
    liked: str = field(init=False)
    opens: float = field(init=False)
    step: float = field(init=False)
    often: float = field(init=False)
    closes: bool = field(init=False)

    LIKING = 0.6
    """How often it says a line of the kind it likes where there is one."""

    def __post_init__(self) -> None:
        rng = self.rng
        self.liked = ACTS[int(rng.random() * len(ACTS))]
        # From one who haggles from the bottom, and says prices seldom or always, to one who pays what the card says.
        self.opens, self.step = rng.uniform(0.25, 1.0), rng.uniform(0.0, 0.12)
        self.often = (0.15, 0.5, 1.0)[int(rng.random() * 3)]
        self.closes = rng.random() < 0.5

    def move(self, view: Table) -> Choice:
        """The next move."""
        rng = self.rng
        lines = [line for line in view.lines if line.act != "leave"]
        liked = [line for line in lines if line.act == self.liked]
        if liked and rng.random() < self.LIKING:
            lines = liked
        line = lines[int(rng.random() * len(lines))]
        wanted = view.offer + self.step * view.list_price if view.offer else self.opens * view.list_price
        if self.closes and view.rounds - view.round <= 2 and line.act != "wait":
            return Choice(line.id, min(view.ask, view.purse))
        with_offer = line.act == "offer" or (line.act != "wait" and rng.random() < self.often)
        return Choice(line.id, money(wanted, min(view.ask, view.purse)) if with_offer else None)


@dataclass
class FixedPlayer:
    """The best strategy that looks at nobody."""

    plan: FixedPlan

    def move(self, view: Table) -> Choice:
        """The next move."""
        return self.plan.move(view)


@dataclass
class Reading:
    """What a reading player brings to every talk with a person."""

    known: Acquaintance
    market: MarketRules
    plan: Strategy
    face: FaceReading | None = None
    body: BodyReading | None = None
    body_trust: float = 0.8
    quiet_trust: float = 0.6


@dataclass
class _Believer:
    """A player with a belief; subclasses say what they look at."""

    reading: Reading
    rng: random.Random
    belief: Belief = field(init=False)
    hand: Bargainer = field(init=False)
    _last: tuple[Line, float, float, bool] | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        self.belief = Belief(self.reading.known)
        self.hand = Bargainer(self.reading.known, self.reading.market, self.reading.plan, self.rng)

    def told(self, view: Any) -> str:
        """How the last line landed, as far as this player hears it."""
        return ""

    def look(self, view: Any) -> None:
        """Meet what is seen."""

    def move(self, view: Any) -> Choice:
        """The next move."""
        table: Table = view.table
        if self._last is not None:
            line, right, wrong, offered = self._last
            told = self.told(view)
            self.hand.landed(line.act, told, wrong, right, offered)
            act = "turn_to_go" if line.act == "leave" else line.act
            self.belief.pass_line(act, told, table.answer if offered else "none")
        self.look(view)
        choice, line = self.hand.move(table, self.belief)
        self._last = (line, *self.hand.chances(self.belief, line.act), choice.offer is not None)
        return choice


class WordsPlayer(_Believer):
    """Hears how lines land, where the words tell it."""

    def told(self, view: WordsView) -> str:
        return view.told


class FacePlayer(_Believer):
    """Takes the shown face at its word."""

    def look(self, view: FaceView) -> None:
        assert self.reading.face is not None
        self.belief.see(self.reading.face.log_likelihood((view.parts, view.valence, view.arousal)).max(axis=0))


class BodyPlayer(_Believer):
    """Reads the units on stage."""

    def look(self, view: BodyView) -> None:
        reading = self.reading
        assert reading.body is not None
        self.belief.see(
            reading.body_trust * reading.body.log_likelihood(view.signs)
            + reading.quiet_trust * reading.body.log_likelihood(view.quiet)
        )


@dataclass
class ReaderPlayer(_Believer):
    """Hears, sees face and body, knows the person's habits and mask: which smile is worn is found out as well."""

    shows: Any = field(init=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        weights = np.asarray(self.reading.known.rules.mask_shows, dtype=np.float64)[[2, 6]]
        self.shows = np.log(weights / weights.sum())

    def told(self, view: ReaderView) -> str:
        return view.told

    def look(self, view: ReaderView) -> None:
        reading = self.reading
        assert reading.body is not None
        assert reading.face is not None
        self.belief.see(
            reading.body_trust * reading.body.log_likelihood(view.signs)
            + reading.quiet_trust * reading.body.log_likelihood(view.quiet)
        )
        # Which of its two faces the mask shows does not change within a talk: the face tells both at once.
        joint = reading.face.log_likelihood((view.parts, view.valence, view.arousal)) + self.shows[:, None]
        top = joint.max()
        both = np.exp(joint - top)
        self.shows = np.log((both @ self.belief.now) + 1e-12)
        self.shows -= self.shows.max()
        self.belief.see(np.log(both.sum(axis=0) + 1e-12))


@dataclass
class OraclePlayer(_Believer):
    """Sees what is felt."""

    def look(self, view: OracleView) -> None:
        threshold = self.reading.known.rules.label_threshold
        most = max(EMOTIONS[:6], key=lambda name: view.felt[name])
        label = EMOTIONS.index(most) if view.felt[most] >= threshold else 6
        self.belief.now = np.full(7, 1e-9)
        self.belief.now[label] = 1.0

    def told(self, view: OracleView) -> str:
        # What was felt is known, and so how the line landed.
        if self._last is None:
            return ""
        line = self._last[0]
        label = int(np.argmax(self.belief.now))
        return self.reading.known.taken("turn_to_go" if line.act == "leave" else line.act, label)


Sit = Callable[[random.Random], Player]
"""A new player for a new talk."""
