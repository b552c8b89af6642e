"""Policies by name, tuned for each temperament, and what a command line may ask for: one, a mixture, a file."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from game.app.policies.beliefs import Acquaintance, BodyReading, FaceReading
from game.app.policies.custom import OwnPolicy
from game.app.policies.eyes import Eyes
from game.app.policies.players import (
    BodyPlayer,
    ExplorerPlayer,
    FacePlayer,
    FixedPlayer,
    OraclePlayer,
    Player,
    RandomPlayer,
    ReaderPlayer,
    Reading,
    WordsPlayer,
)
from game.app.policies.scripted import ScriptedPlayer, load_moves
from game.app.policies.strategy import FixedPlan, Strategy
from game.app.talk import TalkAssets
from game.core.errors import BadInput
from game.core.paths import ASSETS
from game.embos import UnitLibrary
from game.formats.yaml_source import Node, load_yaml, nearest

__all__ = ["COMPARED", "NAMES", "TUNED", "Mixture", "Seat", "Tuned", "load_tuned", "mixture_of", "seat", "seat_exists"]

NAMES: Mapping[str, str] = {
    "random": "table",
    "fixed": "table",
    "words": "words",
    "face": "face",
    "body": "body",
    "reader": "reader",
    "oracle": "oracle",
    "explorer": "table",
}
"""What each policy sees (``game.app.policies.views``)."""
COMPARED = tuple(name for name in NAMES if name != "explorer")
"""Those whose figures are set against each other; the explorer plays to come everywhere, not to win."""
TUNED = ASSETS / "autoplay" / "strategies.yaml"
_BELIEVERS: Mapping[str, type[WordsPlayer | FacePlayer | BodyPlayer | ReaderPlayer | OraclePlayer]] = {
    "words": WordsPlayer,
    "face": FacePlayer,
    "body": BodyPlayer,
    "reader": ReaderPlayer,
    "oracle": OraclePlayer,
}


@dataclass(frozen=True)
class Tuned:
    """What searches found: plans of ``fixed`` and strategies of the others, by temperament; ``any`` for the rest."""

    fixed: Mapping[str, FixedPlan]
    strategies: Mapping[str, Mapping[str, Strategy]]

    def plan(self, temperament: str) -> FixedPlan:
        """The best fixed plan known."""
        return self.fixed.get(temperament, self.fixed["any"])

    def strategy(self, policy: str, temperament: str) -> Strategy:
        """The best strategy known for a policy."""
        of = self.strategies.get(policy, {})
        return of.get(temperament) or of.get("any") or Strategy()


def load_tuned(path: Path = TUNED) -> Tuned:
    """Read the searches' findings. Raises BadInput with file:line:col."""
    root = load_yaml(path).only("version", "found", "fixed", *_BELIEVERS)
    root["version"].as_int(1, 1)
    fixed = {key.as_str(): FixedPlan.from_node(node) for key, node in root["fixed"].items()}
    if "any" not in fixed:
        raise root["fixed"].error(expected="a plan named any")

    def strategies(node: Node | None) -> dict[str, Strategy]:
        return {key.as_str(): Strategy.from_node(own) for key, own in node.items()} if node is not None else {}

    return Tuned(fixed, {name: strategies(root.get(name)) for name in _BELIEVERS})


@dataclass
class Seat:
    """A policy at one stall: what it sees there, and a new player for each talk.

    sees: kind of view; bodies: whether the body has to be played so that it can be seen.
    """

    name: str
    sees: str
    assets: TalkAssets
    sit: Callable[[random.Random], Player]
    layers: Mapping[str, str] = field(default_factory=dict)

    @property
    def bodies(self) -> bool:
        """Whether it looks at bodies."""
        return self.sees in {"body", "reader"}

    @cached_property
    def eyes(self) -> Eyes:
        """Makes its views."""
        return Eyes(self.assets, self.layers)


def seat_exists(name: str) -> None:
    """Raises BadInput for a name that no policy has, or a file that is none."""
    if name.startswith("script:"):
        load_moves(Path(name.removeprefix("script:")))
    elif name.endswith(".py"):
        OwnPolicy.load(Path(name))
    elif name not in NAMES:
        wanted = " | ".join([*NAMES, "script:FILE", "FILE.py"])
        raise BadInput("--policy", expected=wanted, seen=name, hint=nearest(name, NAMES))


def seat(
    assets: TalkAssets,
    name: str,
    *,
    library: UnitLibrary | None = None,
    habit: Mapping[str, float] | None = None,
    tuned: Tuned | None = None,
    strategy: Strategy | FixedPlan | None = None,
) -> Seat:
    """A policy by name, ``script:FILE`` or ``FILE.py`` at a stall.

    library: the motion units, needed by those who look at bodies; habit: see ``BodyReading``; strategy: in place of
    the tuned one. Raises BadInput for an unknown name.
    """
    layers = {} if library is None else {unit.name: unit.layer for unit in library.units}
    if name.startswith("script:"):
        moves = load_moves(Path(name.removeprefix("script:")))
        return Seat(name, "table", assets, lambda rng: ScriptedPlayer(moves), layers)
    if name.endswith(".py"):
        own = OwnPolicy.load(Path(name))
        return Seat(name, own.sees, assets, own.sit, layers)
    seat_exists(name)
    if name in {"random", "explorer"}:
        return Seat(name, "table", assets, RandomPlayer if name == "random" else ExplorerPlayer, layers)
    tuned = tuned or load_tuned()
    if name == "fixed":
        plan = strategy if isinstance(strategy, FixedPlan) else tuned.plan(assets.person.id)
        return Seat(name, "table", assets, lambda rng: FixedPlayer(plan), layers)
    known = Acquaintance(assets)
    chosen = strategy if isinstance(strategy, Strategy) else tuned.strategy(name, assets.person.id)
    reading = Reading(known, assets.market, chosen)
    made = Seat(name, NAMES[name], assets, lambda rng: _BELIEVERS[name](reading, rng), layers)
    if name in {"face", "reader"}:
        # A face taken at its word, or one that is known to be a mask.
        reading.face = FaceReading.of(known, made.eyes.face_eye, masked=name == "reader")
    if made.bodies:
        if library is None:
            raise BadInput(f"policy {name}", expected="bodies to look at", seen="none")
        reading.body = BodyReading(library, habit if name == "reader" else None)
    return made


@dataclass(frozen=True)
class Mixture:
    """Policies by name with their shares (sum 1); one policy is a mixture of one."""

    shares: tuple[tuple[str, float], ...]

    def __str__(self) -> str:
        if len(self.shares) == 1:
            return self.shares[0][0]
        return ",".join(f"{name}:{share:g}" for name, share in self.shares)

    def draw(self, chance: float) -> str:
        """Who plays, by a number in [0, 1)."""
        for name, share in self.shares:
            chance -= share
            if chance < 0:
                return name
        return self.shares[-1][0]


def mixture_of(text: str) -> Mixture:
    """``reader``, ``random:0.5,reader:0.5``, ``my_policy.py:1,fixed:2``. Raises BadInput for a share that is none."""
    shares: list[tuple[str, float]] = []
    for part in text.split(","):
        name, colon, share = part.strip().rpartition(":")
        if not colon or name == "script" or not _is_number(share):
            name, share = part.strip(), "1"
        weight = float(share)
        if not name or not 0.0 < weight < 1e6:
            raise BadInput("--policy", expected="NAME or NAME:SHARE,NAME:SHARE…", seen=text)
        shares.append((name, weight))
    total = sum(weight for _, weight in shares)
    return Mixture(tuple((name, weight / total) for name, weight in shares))


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
