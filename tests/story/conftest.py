"""What story tests share: scripts, and a player that talks straight or through a save before each move."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Container
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from game.core.paths import DIALOGUE
from game.story import (
    ACTS,
    Beat,
    Chose,
    Event,
    Memory,
    Outcome,
    Script,
    Start,
    StoryState,
    advance,
    begin,
    load_script,
    restore,
    resume,
    save,
)
from game.story.vocabulary import Value


@dataclass
class Player:
    """Drives one talk. ``reload``: save, go through JSON, restore and resume before every event."""

    script: Script
    reload: bool
    item: str = ""
    seed: int = 1
    memory: Memory | None = None
    env: dict[str, Value] = field(default_factory=dict)
    beats: list[Beat] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.item = self.item or next(iter(self.script.items))
        price = self.script.items[self.item].list_price
        self.env = {"list_price": price, "ask": price, "price": price, **self.env}
        self.state: StoryState = begin(self.script, self.item, self.seed, memory=self.memory)
        self.send(Start())

    def send(self, event: Event, **env: Value) -> Beat:
        if self.reload:
            self.state = restore(self.script, json.loads(json.dumps(save(self.state))))
            if self.beats:
                self.state, again = resume(self.script, self.state, self.env)
                assert again.choices == self.beats[-1].choices
                assert [line.id for line in again.lines] == [line.id for line in self.beats[-1].lines]
        self.env.update(env)
        self.state, beat = advance(self.script, self.state, event, self.env)
        self.beats.append(beat)
        return beat

    def choose(self, choice: str, outcome: str | None = None, **env: Value) -> Beat:
        return self.send(Chose(choice, outcome), **{"quality": "none", "tells": False, "offer_result": "none", **env})

    def happen(self, kind: str, **env: Value) -> Beat:
        return self.send(Outcome(kind), **env)

    @property
    def beat(self) -> Beat:
        return self.beats[-1]

    def random_move(self, rng: random.Random, known: Container[str] = ()) -> Beat:
        """One move as a market without feelings would answer it; mostly something not yet ``known``."""
        round_ = int(self.env.get("round", 1))
        options = [option for option in self.beat.choices if option.available]
        new = [option for option in options if option.id not in known and option.act in ACTS]
        choice = rng.choice(new if new and known and rng.random() < 0.8 else options)
        trust = float(self.env.get("trust", 0.3)) + rng.choice([-0.12, 0.0, 0.12, 0.12])
        env: dict[str, Value] = {
            "quality": rng.choice(["right", "neutral", "wrong"]),
            "tells": rng.random() < 0.7,
            "round": round_ + 1,
            "patience": 7 - round_ - rng.random(),
            "tidying": round_ > 4 and rng.random() < 0.8,
            "trust": min(max(trust, 0.0), 1.0),
            "ask": float(self.env["ask"]) * rng.uniform(0.9, 1.0),
            "offer": 0,
            "offer_result": "none",
        }
        outcome: str | None = None
        if choice.act == "leave":
            outcome = rng.choice(["called_back", "walked_away"])
        elif choice.act == "offer" or rng.random() < 0.3:
            early = round_ < 4
            outcome = rng.choice(["refused_offer", "refused_offer", "insulted", "refused_offer" if early else "deal"])
            names = {"refused_offer": "refused", "insulted": "insult", "deal": "accepted"}
            share = rng.uniform(0.4, 1.0)
            env |= {"offer_result": names[outcome], "offer": float(self.env["list_price"]) * share}
            env["deal_price"] = env["offer"]
        if outcome != "deal" and round_ >= 6:
            outcome = rng.choice(["rounds_out", "out_of_patience", "sudden_end"])
        return self.choose(choice.id, outcome, **env)


@pytest.fixture(scope="session")
def tiny_text() -> str:
    """A small stall that has a little of everything."""
    return (Path(__file__).parent / "tiny.yaml").read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def tiny() -> Script:
    """The small stall, loaded."""
    return load_script(Path(__file__).parent / "tiny.yaml")


@pytest.fixture(scope="session")
def flea() -> Script:
    """The shipped stall."""
    return load_script(DIALOGUE / "flea.yaml")


@pytest.fixture(scope="session")
def player() -> type[Player]:
    """Starts a talk straight or reloaded, as told: ``player(script, reload, seed=…, memory=…)``."""
    return Player


@pytest.fixture(params=["straight", "reloaded"])
def talk(request: pytest.FixtureRequest) -> Callable[..., Player]:
    """Starts a talk: ``talk(script, item=…, seed=…, env=…)``. Every test with it runs twice."""

    def start(script: Script, **kwargs: Any) -> Player:
        return Player(script, request.param == "reloaded", **kwargs)

    return start
