"""Several talks at one stall in one afternoon, as the game has them: who comes back is remembered.

The first visit is the very talk that is played without any other, so that figures of first visits stay what they are.
From then on all goes by the game's own afternoon: purse, clock, memory, failed visits, what is bought, the news.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from game.app.afternoon import (
    Afternoon,
    finish_talk,
    is_closed,
    next_day,
    open_day,
    pass_time,
    talk_minutes,
    visit_stall,
    walk_to,
)
from game.app.autoplay.episodes import Decision, Talk, play_bodies, sit_down
from game.app.bazaar import Bazaar
from game.app.body import BodyObserver
from game.app.policies import Player, Seat
from game.app.talk import Choice
from game.story import Script

__all__ = ["Leaver", "Outing", "Street", "hears_news", "play_outing", "play_outings_with_bodies"]

SAME_AGAIN = 0.5
"""How often somebody who comes back asks for the same thing, if it is still there."""
LEAVES = 0.5
"""How often somebody who comes back goes before they are done, after 1 to ``LEAVES_WITHIN`` moves."""
LEAVES_WITHIN = 6
WALKS = 0.5
"""How often there is a talk at another stall in between; else now and then a pause."""
PAUSES = 0.3
HOPELESS = 0.4
"""Who carries less than this share of the cheapest list price goes home, and comes back on the next day."""


@dataclass(frozen=True)
class Street:
    """The market around a stall. others: guests at the stalls whose news this one hears."""

    bazaar: Bazaar
    others: tuple[Seat, ...] = ()


def hears_news(script: Script) -> bool:
    """Whether a script asks what happened at other stalls."""
    return any(variable.scope == "afternoon" for variable in script.variables.values())


@dataclass
class Leaver:
    """A player who turns to go after so many moves, and does not come back when called."""

    player: Player
    moves: int

    def move(self, view: Any) -> Choice:
        """The player's own move, or the way out."""
        self.moves -= 1
        if self.moves < 0:
            for line in getattr(view, "table", view).lines:
                if line.act == "leave":
                    return Choice(line.id)
        return self.player.move(view)


@dataclass
class Outing:
    """An episode of several visits. Its chance follows from seed and episode alone, as everything in it."""

    seat: Seat
    street: Street
    seed: int
    episode: int
    visit: int = 1
    talk: Talk = field(init=False)
    afternoon: Afternoon = field(init=False)
    rng: random.Random = field(init=False)

    def __post_init__(self) -> None:
        script = self.seat.assets.script
        self.rng = random.Random(f"outing {self.seed} {self.episode}")
        self.talk = sit_down(self.seat, self.seed, self.episode)
        opened = open_day(self.street.bazaar, self._scripts(), self.talk.state.seed)
        self.afternoon = replace(opened, purse=self.talk.state.purse, place=script.stall)

    def come_back(self) -> None:
        """Book the talk that has ended and begin the next one, on the next day where this one has no more to give."""
        assets, rng = self.seat.assets, self.rng
        self._book(self.talk)
        if self._is_over():
            self.afternoon = next_day(self.street.bazaar, self._scripts(), self.afternoon)
        elif self.street.others and rng.random() < WALKS:
            self._talk_elsewhere()
        elif rng.random() < PAUSES:
            self.afternoon = pass_time(self.street.bazaar, self.afternoon, self.street.bazaar.costs.pause)
        if self._is_over():
            self.afternoon = next_day(self.street.bazaar, self._scripts(), self.afternoon)
        self.afternoon = walk_to(self.street.bazaar, self.afternoon, assets.script.stall)
        left, last = self._left(self.seat), self.talk.state.item
        item = left[int(rng.random() * len(left))]
        if last in left and rng.random() < SAME_AGAIN:
            item = last
        self.visit += 1
        player = self.seat.sit(random.Random(f"play {self.seed} {self.episode} {self.visit}"))
        if rng.random() < LEAVES:
            player = Leaver(player, 1 + int(rng.random() * LEAVES_WITHIN))
        self.talk = Talk(self.episode, self.seat, player, visit_stall(assets, self.afternoon, item))

    def _scripts(self) -> tuple[Script, ...]:
        return (self.seat.assets.script, *(guest.assets.script for guest in self.street.others))

    def _left(self, seat: Seat) -> list[str]:
        script = seat.assets.script
        return sorted(set(script.items) - self.afternoon.owned(script.stall))

    def _is_over(self) -> bool:
        """Too late, nothing left to ask for, or nothing to pay with."""
        items, left = self.seat.assets.script.items, self._left(self.seat)
        cheapest = min((items[name].list_price for name in left), default=0)
        return not left or is_closed(self.street.bazaar, self.afternoon) or self.afternoon.purse < HOPELESS * cheapest

    def _talk_elsewhere(self) -> None:
        """A talk at another stall: it takes time and money, and the news of it comes along."""
        rng = self.rng
        guest = self.street.others[int(rng.random() * len(self.street.others))]
        left = self._left(guest)
        walked = walk_to(self.street.bazaar, self.afternoon, guest.assets.script.stall)
        if not left or is_closed(self.street.bazaar, walked):
            return
        self.afternoon = walked
        state = visit_stall(guest.assets, self.afternoon, left[int(rng.random() * len(left))])
        player: Player = guest.sit(random.Random(f"away {self.seed} {self.episode} {self.visit}"))
        if rng.random() < LEAVES:
            player = Leaver(player, 1 + int(rng.random() * LEAVES_WITHIN))
        talk = Talk(self.episode, guest, player, state)
        while not talk.state.ended:
            talk.decide()
        self._book(talk)

    def _book(self, talk: Talk) -> None:
        bazaar = self.street.bazaar
        minutes = talk_minutes(bazaar, [dict(decision.after.record)["act"] for decision in talk.decisions])
        self.afternoon = finish_talk(bazaar, talk.seat.assets, self.afternoon, talk.state, minutes)


def play_outing(seat: Seat, street: Street, seed: int, episode: int, visits: int) -> list[list[Decision]]:
    """Play the talks of one episode, one list of decisions for each visit."""
    outing = Outing(seat, street, seed, episode)
    talks = []
    for visit in range(visits):
        if visit:
            outing.come_back()
        while not outing.talk.state.ended:
            outing.talk.decide()
        talks.append(outing.talk.decisions)
    return talks


def play_outings_with_bodies(
    observer: BodyObserver, seats: Sequence[Seat], street: Street, seed: int, first: int, visits: int
) -> Iterator[list[list[Decision]]]:
    """Episodes from ``first`` on, one for each seat: all first visits side by side, then all second ones, and so on."""
    outings = [Outing(seat, street, seed, first + at) for at, seat in enumerate(seats)]
    played: list[list[list[Decision]]] = [[] for _ in seats]
    for visit in range(visits):
        body_seed = seed
        if visit:
            body_seed = random.Random(f"bodies {seed} {visit}").getrandbits(31)
            for outing in outings:
                outing.come_back()
        talks = play_bodies(observer, [outing.talk for outing in outings], body_seed, first)
        for own, decisions in zip(played, talks, strict=True):
            own.append(decisions)
    yield from played
