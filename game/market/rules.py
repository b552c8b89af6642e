"""The bargaining part of ``dialogue/rules.yaml``. All prices are shares of the list price."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from game.core.emotion_space import EMOTIONS
from game.core.errors import BadInput
from game.core.paths import DIALOGUE
from game.formats.yaml_source import Node, load_yaml

__all__ = ["MarketRules", "load_market_rules", "market_rules_from"]


@dataclass(frozen=True, eq=False)
class MarketRules:
    """Constants of concessions, acceptance, patience and trust; the rules file explains each, with its unit."""

    rounds: int
    lines_on_offer: int
    per_raise: float
    first_offer: float
    quality: Mapping[str, float]
    trust_base: float
    trust_slope: float
    concession_sigma: float
    floor_margin: float
    small_raise: float
    holding_rate: float
    holding_by_label: Mapping[str, float]
    unmoved_patience: float
    acceptance_trust: float
    acceptance_limit: float
    acceptance_sigma: float
    soft: tuple[float, ...]
    hard: tuple[float, ...]
    lowest_price: tuple[float, float]
    patience_sigma: float
    patience_round: float
    patience_wait: float
    patience_offer: float
    patience_small_raise: float
    patience_wrong: float
    patience_right: float
    tidy_below: float
    tidy_seen: float
    insult_margin: float
    insult_patience_base: float
    insult_patience_slope: float
    trust_start: float
    trust_right: float
    trust_wrong: float
    trust_press: float
    called_back_fall: float
    sudden_end_chance: float
    spoken_tells: float
    annoyance_on_return: float


def _by_emotion(node: Node) -> tuple[float, ...]:
    node.only(*EMOTIONS)
    return tuple(node[name].as_float(0) for name in EMOTIONS)


def market_rules_from(root: Node) -> MarketRules:
    """Read the bargaining rules from the parsed rules file. Raises BadInput with file:line:col."""
    c = root["constants"]
    concession, holding, acceptance = c["concession"], c["holding"], c["acceptance"]
    patience, insult, trust = c["patience"], c["insult"], c["trust"]
    low, high = (item.as_float(0, 1) for item in c["lowest_price"].as_list())
    if not low < high:
        raise BadInput(where=c["lowest_price"].where, expected="two shares, the smaller first", seen=f"{low}, {high}")
    return MarketRules(
        rounds=c["rounds"].as_int(1, 50),
        lines_on_offer=c["lines_on_offer"].as_int(1, 9),
        per_raise=concession["per_raise"].as_float(0),
        first_offer=concession["first_offer"].as_float(0, 1),
        quality={key.as_str(): value.as_float(0) for key, value in concession["quality"].items()},
        trust_base=concession["trust_base"].as_float(0),
        trust_slope=concession["trust_slope"].as_float(0),
        concession_sigma=concession["noise_sigma"].as_float(0, 2),
        floor_margin=concession["floor_margin"].as_float(0, 1),
        small_raise=holding["small_raise"].as_float(0, 1),
        holding_rate=holding["rate"].as_float(0, 1),
        holding_by_label={key.as_str(): value.as_float(0) for key, value in holding["by_label"].items()},
        unmoved_patience=holding["unmoved_patience"].as_float(0),
        acceptance_trust=acceptance["trust_weight"].as_float(0),
        acceptance_limit=acceptance["limit"].as_float(0, 1),
        acceptance_sigma=acceptance["noise_sigma"].as_float(0, 1),
        soft=_by_emotion(c["soft"]),
        hard=_by_emotion(c["hard"]),
        lowest_price=(low, high),
        patience_sigma=patience["start_sigma"].as_float(0),
        patience_round=patience["round"].as_float(),
        patience_wait=patience["wait"].as_float(),
        patience_offer=patience["offer"].as_float(),
        patience_small_raise=patience["small_raise"].as_float(),
        patience_wrong=patience["wrong"].as_float(),
        patience_right=patience["right"].as_float(),
        tidy_below=patience["tidy_below"].as_float(),
        tidy_seen=patience["tidy_seen"].as_float(0, 1),
        insult_margin=insult["margin"].as_float(0, 1),
        insult_patience_base=insult["patience_base"].as_float(0),
        insult_patience_slope=insult["patience_slope"].as_float(0),
        trust_start=trust["start"].as_float(0, 1),
        trust_right=trust["right"].as_float(),
        trust_wrong=trust["wrong"].as_float(),
        trust_press=trust["press"].as_float(),
        called_back_fall=c["called_back"]["fall"].as_float(0, 1),
        sudden_end_chance=c["sudden_end_chance"].as_float(0, 1),
        spoken_tells=c["spoken_tells"].as_float(0, 1),
        annoyance_on_return=c["annoyance_on_return"].as_float(0),
    )


def load_market_rules(path: Path = DIALOGUE / "rules.yaml") -> MarketRules:
    """The shipped rules, or those of another file of the same form."""
    return market_rules_from(load_yaml(path))
