"""The words a dialogue script may use: acts, outcomes, speakers, and the names a condition can ask about."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from game.core.errors import BadInput

__all__ = [
    "ACTS",
    "DEFAULTS",
    "ENV",
    "OPTIONAL_OUTCOMES",
    "OUTCOMES",
    "QUALITIES",
    "STANDING_ACTS",
    "WHEN",
    "EnvName",
    "Environment",
    "Type",
    "Value",
    "checked",
]

Value = float | bool | str
Type = Literal["number", "bool", "text"]

ACTS: tuple[str, ...] = ("praise", "joke", "empathise", "story", "press", "flaw", "apologise", "small_talk")
# Moves that are on the table in every round: say nothing, turn to go, put an offer.
STANDING_ACTS: tuple[str, ...] = ("wait", "leave", "offer")

# What the market can make of a move, and whether that ends the talk.
OUTCOMES: Mapping[str, bool] = MappingProxyType(
    {
        "deal": True,
        "sudden_end": True,
        "out_of_patience": True,
        "rounds_out": True,
        "walked_away": True,
        "refused_offer": False,
        "insulted": False,
        "called_back": False,
        "came_back": False,  # not an answer to a move: where a second visit starts
    }
)
OPTIONAL_OUTCOMES = frozenset({"called_back", "came_back"})

QUALITIES: tuple[str, ...] = ("none", "right", "neutral", "wrong")
# `when:` on a line: how the player's line landed, where the shopkeeper's words tell it; `veiled` where they do not.
WHEN: tuple[str, ...] = ("right", "neutral", "wrong", "veiled")


@dataclass(frozen=True)
class EnvName:
    """A name that the game sets and a condition may ask about.

    ``values``: all values of a bool or text; for numbers the range (low, high) that a check searches.
    ``money``: shown with the currency when it stands in a line. ``hidden``: tells about feelings, so that it must
    not decide which choices are on offer.
    """

    type: Type
    default: Value
    values: tuple[Value, ...]
    help: str
    money: bool = False
    hidden: bool = False


ENV: Mapping[str, EnvName] = MappingProxyType(
    {
        "trust": EnvName("number", 0.3, (0.0, 1.0), "how much she trusts the player, 0 to 1"),
        "patience": EnvName("number", 7.0, (-5.0, 12.0), "goodwill left, in rounds"),
        "tidying": EnvName("bool", False, (False, True), "impatience that can be seen"),
        "round": EnvName("number", 1.0, (0.0, 50.0), "the round that is being played, from 1"),
        "rounds": EnvName("number", 6.0, (1.0, 50.0), "how many rounds a talk has at most"),
        "visit": EnvName("number", 1.0, (1.0, 20.0), "1 on the first visit to this stall in an afternoon"),
        "list_price": EnvName("number", 0.0, (0.0, 1e6), "the price on the card", money=True),
        "ask": EnvName("number", 0.0, (0.0, 1e6), "what she asks for now", money=True),
        "price": EnvName("number", 0.0, (0.0, 1e6), "what stands between the two now", money=True),
        "offer": EnvName("number", 0.0, (0.0, 1e6), "the player's offer in this round, 0 without one", money=True),
        "deal_price": EnvName("number", 0.0, (0.0, 1e6), "what was agreed", money=True),
        "purse": EnvName("number", 0.0, (0.0, 1e6), "what the player has left", money=True),
        "item": EnvName("text", "", (), "the id of the thing talked about"),
        "quality": EnvName("text", "none", QUALITIES, "how the player's line landed", hidden=True),
        "tells": EnvName("bool", False, (False, True), "her words tell how it landed", hidden=True),
        "offer_result": EnvName(
            "text", "none", ("none", "accepted", "refused", "insult"), "what became of the offer of this round"
        ),
    }
)


class Environment(dict[str, Value]):
    """Names of ENV whose values are known to have the right types: what the game itself works out."""


def checked(env: Mapping[str, Value]) -> Mapping[str, Value]:
    """The names of ENV that are given, as plain Python values. Raises BadInput for a wrong type."""
    if isinstance(env, Environment):
        return env
    out: dict[str, Value] = {}
    for name, value in env.items():
        kind = _KINDS.get(name)
        if kind is None:
            continue
        if kind == "number":
            try:
                number = float(value)
            except (TypeError, ValueError):
                number = math.nan
            if not math.isfinite(number):
                raise BadInput(f"the name {name}", expected="a number", seen=value)
            out[name] = number
        elif kind == "bool":
            out[name] = bool(value)
        elif isinstance(value, str):
            out[name] = value
        else:
            raise BadInput(f"the name {name}", expected="a text", seen=value)
    return out


DEFAULTS: Mapping[str, Value] = {name: known.default for name, known in ENV.items()}
"""What the names of ENV stand for where the game does not say."""
_KINDS: Mapping[str, Type] = {name: known.type for name, known in ENV.items()}
