"""The market as data: its stalls in order, the clock, what things cost in time, the purse, the first lessons."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from game.app.talk import TalkAssets
from game.core.emotion_space import EMOTION_INDEX, EMOTIONS
from game.core.errors import BadInput
from game.core.paths import ASSETS
from game.formats.yaml_source import Node, load_yaml, nearest

__all__ = ["Bazaar", "Costs", "Lesson", "load_bazaar"]

_HEX = re.compile(r"#[0-9A-Fa-f]{6}")


@dataclass(frozen=True)
class Costs:
    """Minutes of the afternoon: stepping up, one exchange, one spent waiting, one stall further, a pause."""

    arrive: float
    round: float
    wait: float
    walk: float
    pause: float


@dataclass(frozen=True)
class Lesson:
    """How one of the first talks bends a person; None leaves what is their own. mask, leak, habit in [0, 1]."""

    mask: float | None = None
    leak: float | None = None
    habit: float | None = None
    mood: str | None = None
    shows: str | None = None
    greeting_habit: bool = False

    def bend(self, assets: TalkAssets) -> TalkAssets:
        """The talk with this lesson's mask, leak, habit, mood and smile."""
        person, feelings = assets.person, assets.feelings
        person = replace(
            person,
            mask=person.mask if self.mask is None else self.mask,
            leak=person.leak if self.leak is None else self.leak,
            habit_rate=person.habit_rate if self.habit is None else self.habit,
            mood_prior=person.mood_prior if self.mood is None else np.eye(7)[EMOTION_INDEX[self.mood]],
        )
        if self.shows is not None:
            feelings = replace(feelings, mask_shows=np.eye(7)[EMOTION_INDEX[self.shows]])
        return replace(assets, person=person, feelings=feelings)


@dataclass(frozen=True)
class Bazaar:
    """See ``assets/market/market.yaml``. opens_min: minutes after midnight; colours: stall -> awning, cloth, sign."""

    opens_min: int
    length_min: float
    last_talk_min: float
    costs: Costs
    cooling_min: float
    wish_count: int
    wishes_per_stall: int
    purse_share: float
    purse_step: int
    colours: Mapping[str, tuple[str, str, str]]
    lessons: tuple[Lesson, ...]

    @cached_property
    def stalls(self) -> tuple[str, ...]:
        """The stalls' ids from left to right."""
        return tuple(self.colours)

    def clock(self, minutes: float) -> str:
        """The time of day, as on a watch."""
        whole = self.opens_min + int(minutes)
        return f"{whole // 60 % 24}:{whole % 60:02d}"

    def day_share(self, minutes: float) -> float:
        """0 when the market opens, 1 when it closes."""
        return min(max(minutes / self.length_min, 0.0), 1.0)

    def hops(self, a: str, b: str) -> int:
        """How many stalls further b is than a; 0 where either is no place on the map."""
        if a not in self.colours or b not in self.colours:
            return 0
        return abs(self.stalls.index(a) - self.stalls.index(b))


def _emotion(node: Node | None) -> str | None:
    if node is None:
        return None
    name = node.as_str()
    if name not in EMOTION_INDEX:
        raise BadInput(where=node.where, expected=" | ".join(EMOTIONS), seen=name, hint=nearest(name, EMOTIONS))
    return name


def _share(node: Node | None) -> float | None:
    return None if node is None else node.as_float(0.0, 1.0)


def _flag(node: Node | None) -> bool:
    return node is not None and node.as_bool()


def _lesson(node: Node) -> Lesson:
    node.only("mask", "leak", "habit", "mood", "shows", "greeting_habit")
    return Lesson(
        mask=_share(node.get("mask")),
        leak=_share(node.get("leak")),
        habit=_share(node.get("habit")),
        mood=_emotion(node.get("mood")),
        shows=_emotion(node.get("shows")),
        greeting_habit=_flag(node.get("greeting_habit")),
    )


def _minutes(node: Node) -> int:
    found = re.fullmatch(r"(\d{1,2}):(\d{2})", node.as_str())
    if found is None or int(found[1]) > 23 or int(found[2]) > 59:
        raise BadInput(where=node.where, expected='a time such as "13:00"', seen=node.raw)
    return int(found[1]) * 60 + int(found[2])


def _colours(node: Node) -> tuple[str, str, str]:
    codes = [item.as_str() for item in node.only("colours")["colours"].as_list()]
    if len(codes) != 3 or not all(_HEX.fullmatch(code) for code in codes):
        raise BadInput(where=node.where, expected='three colours such as "#D9483A"', seen=", ".join(codes))
    return codes[0], codes[1], codes[2]


def load_bazaar(path: Path = ASSETS / "market" / "market.yaml") -> Bazaar:
    """Read the market. Raises BadInput with file:line:col."""
    root = load_yaml(path).only(
        "opens", "closes_after_min", "last_talk_min", "cost_min", "cooling_min", "wishes", "purse", "stalls", "lessons"
    )
    costs = root["cost_min"].only("arrive", "round", "wait", "walk", "pause")
    wishes, purse = root["wishes"].only("count", "per_stall"), root["purse"].only("share", "step")
    return Bazaar(
        opens_min=_minutes(root["opens"]),
        length_min=root["closes_after_min"].as_float(1, 1440),
        last_talk_min=root["last_talk_min"].as_float(0, 600),
        costs=Costs(**{key.as_str(): value.as_float(0, 600) for key, value in costs.items()}),
        cooling_min=root["cooling_min"].as_float(1, 10_000),
        wish_count=wishes["count"].as_int(1, 12),
        wishes_per_stall=wishes["per_stall"].as_int(1, 12),
        purse_share=purse["share"].as_float(0.1, 10),
        purse_step=purse["step"].as_int(1, 100_000),
        colours={key.as_str(): _colours(value) for key, value in root["stalls"].items()},
        lessons=tuple(_lesson(node) for node in root["lessons"].as_list()),
    )
