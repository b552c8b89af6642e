"""One talk, or many at once, played by a policy: the same code as the game, no window, one seed one result."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from game.app.body import BodyObserver, Watched
from game.app.policies import Player, Seat, Sign
from game.app.talk import Choice, TalkState, choose, start_talk
from game.core.errors import BadInput

__all__ = ["MAX_MOVES", "Decision", "Talk", "play_bodies", "play_episode", "play_with_bodies", "sit_down"]

MAX_MOVES = 64
"""A talk is over long before this many moves; one that is not is a fault worth stopping for."""
PURSE = 1.5
"""What the player carries, in list prices."""


@dataclass(frozen=True)
class Decision:
    """One move: the state in which it was chosen, the move, and what became of it.

    seen: what the body did before it; shown: what it did after it; None where no body was played.
    """

    before: TalkState
    after: TalkState
    choice: Choice
    seen: Watched | None = None
    shown: Watched | None = None


@dataclass
class Talk:
    """A talk in the making: who plays, where it stands, what was decided."""

    episode: int
    seat: Seat
    player: Player
    state: TalkState
    decisions: list[Decision] = field(default_factory=list)

    def decide(self, signs: tuple[Sign, ...] = (), quiet: tuple[Sign, ...] = (), seen: Watched | None = None) -> None:
        """Let the player move. Raises BadInput where a talk does not end."""
        if len(self.decisions) >= MAX_MOVES:
            raise BadInput(
                f"episode {self.episode}", expected=f"an end within {MAX_MOVES} moves", seen=self.state.beat.node
            )
        view = self.seat.eyes.view(self.seat.sees, self.state, signs, quiet)
        try:
            move = self.player.move(view)
            after = choose(self.seat.assets, self.state, move)
        except BadInput as error:
            when = f"episode {self.episode}, move {len(self.decisions) + 1} of {self.seat.name}"
            raise BadInput(f"{error} ({when})") from None
        self.decisions.append(Decision(self.state, after, move, seen))
        self.state = after


def sit_down(seat: Seat, seed: int, episode: int) -> Talk:
    """An episode before its first move: the thing, the talk's own seed and the player's chance follow from the two
    numbers alone, so that policies with the same seed meet the same moods and lowest prices."""
    deal = random.Random(f"talk {seed} {episode}")
    items = sorted(seat.assets.script.items)
    item, talk_seed = items[int(deal.random() * len(items))], deal.getrandbits(31)
    purse = int(seat.assets.script.items[item].list_price * PURSE)
    state = start_talk(seat.assets, item, talk_seed, purse=purse)
    return Talk(episode, seat, seat.sit(random.Random(f"play {seed} {episode}")), state)


def play_episode(seat: Seat, seed: int, episode: int) -> Iterator[Decision]:
    """Play one talk; yields every decision."""
    talk = sit_down(seat, seed, episode)
    while not talk.state.ended:
        talk.decide()
        yield talk.decisions[-1]


def play_with_bodies(observer: BodyObserver, seats: Sequence[Seat], seed: int, first: int) -> list[list[Decision]]:
    """Episodes from ``first`` on, one for each seat, their bodies side by side: every player sees the body of its own
    talk from the greeting to the moment of its choice."""
    return play_bodies(observer, [sit_down(seat, seed, first + at) for at, seat in enumerate(seats)], seed, first)


def play_bodies(observer: BodyObserver, talks: Sequence[Talk], seed: int, first: int) -> list[list[Decision]]:
    """Talks before their first move, all at the same stall, to their ends; seed, first: of their bodies."""

    def beat(row: int, seen: list[Watched]) -> TalkState | None:
        talk = talks[row]
        if seen and talk.state.ended:
            return None
        if seen:
            eyes = talk.seat.eyes
            talk.decide(eyes.signs(seen[-1].units), eyes.signs(seen[-1].quiet), seen[-1])
        return talk.state

    watched = observer.play(talks[0].seat.assets, len(talks), beat, seed, first)
    return [
        [
            Decision(decision.before, decision.after, decision.choice, decision.seen, shown)
            for decision, shown in zip(talk.decisions, beats[1:], strict=True)
        ]
        for talk, beats in zip(talks, watched, strict=True)
    ]
