"""What is drawn of a stall: every node as somebody meets it who plays, its person in what is felt there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from game.app.autoplay.episodes import sit_down
from game.app.policies import seat
from game.app.step import StepAssets, targets_of
from game.app.talk import Choice, TalkAssets, TalkState, choose
from game.story import Spoken
from game.tools.crawl.visit import beats_of

__all__ = ["Moment", "moments_of"]

TALKS = 240
"""Talks played to find out what is felt at a node; fewer leave rare nodes unmet, more find nothing new."""
LEAVES_EVERY, LEAVES_AFTER = 4, 5
"""Every so-manieth player turns to go, after one to so many moves."""


@dataclass(frozen=True, eq=False)
class Moment:
    """A node as it is met. lines: its own that are said; met: whether a played talk came here, so that the feeling is
    the one felt here."""

    node: str
    talk: TalkState
    lines: tuple[Spoken, ...]
    met: bool

    @property
    def asks(self) -> bool:
        """Whether the player may choose afterwards."""
        return bool(self.talk.beat.choices) and not self.talk.ended

    @property
    def spoken(self) -> Spoken:
        """The line that is shown: the longest, the shopkeeper's before others."""
        return max(self.lines, key=lambda line: (line.speaker == "shopkeeper", len(line.en)))

    def feelings(self, assets: StepAssets) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(6,) felt and (7,) shown while the node's lines are spoken."""
        record = dict(self.talk.record)
        if not record:
            return targets_of(assets, self.talk)
        return np.asarray(record["felt"], np.float64)[:6], np.asarray(record["shown"], np.float64)


def moments_of(assets: StepAssets, seed: int = 1) -> Iterator[Moment]:
    """Each node that says something or asks, in the script's order."""
    greetings, met = _met(assets.talk, seed)
    for node, place in assets.talk.script.nodes.items():
        own = {line.id for say in place.says for line in say.lines}
        came = met.get(node) or [replace(_usual(greetings), beat=talk.beat) for talk in beats_of(assets, node)[:1]]
        said = [talk for talk in came if any(line.id in own for line in talk.beat.lines)]
        if came:
            talk = _usual(said or came)
            moment = Moment(node, talk, tuple(line for line in talk.beat.lines if line.id in own), node in met)
            if moment.lines or moment.asks:
                yield moment


def _met(assets: TalkAssets, seed: int) -> tuple[list[TalkState], dict[str, list[TalkState]]]:
    """How played talks began, and the states in which they came to each node."""
    greetings: list[TalkState] = []
    found: dict[str, list[TalkState]] = {}
    for state, before in _played(assets, seed):
        if not before:
            greetings.append(state)
        for node, count in state.story.visits.items():
            if count != before.get(node, 0):
                found.setdefault(node, []).append(state)
    return greetings, found


def _usual(states: list[TalkState]) -> TalkState:
    """The one whose feeling is nearest to the mean of all."""
    felt = np.array([dict(state.record).get("felt", state.feeling.felt7)[:6] for state in states], np.float64)
    return states[int(((felt - felt.mean(axis=0)) ** 2).sum(axis=1).argmin())]


def _played(assets: TalkAssets, seed: int) -> Iterator[tuple[TalkState, Mapping[str, int]]]:
    """States after every move of many talks, each with the visits to nodes before it."""
    player = seat(assets, "explorer")
    for episode in range(TALKS):
        talk = sit_down(player, seed, episode)
        leaves = 1 + episode // LEAVES_EVERY % LEAVES_AFTER if episode % LEAVES_EVERY == 0 else 0
        yield talk.state, {}
        while not talk.state.ended:
            before = talk.state.story.visits
            going = [choice.id for choice in talk.state.beat.choices if choice.act == "leave" and choice.available]
            if leaves and len(talk.decisions) >= leaves and going:
                talk = replace(talk, state=choose(assets, talk.state, Choice(going[0])))
            else:
                talk.decide()
            yield talk.state, before
