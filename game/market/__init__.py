"""The bargain: asking price, hidden lowest price, offers and concessions, patience and trust, the purse."""

from game.market.bargain import (
    Answer,
    Bargain,
    Move,
    OfferResult,
    Outcome,
    ask_floor,
    play_round,
    start_bargain,
    surplus_share,
    turn_to_go,
)
from game.market.rules import MarketRules, load_market_rules, market_rules_from

__all__ = [
    "Answer",
    "Bargain",
    "MarketRules",
    "Move",
    "OfferResult",
    "Outcome",
    "ask_floor",
    "load_market_rules",
    "market_rules_from",
    "play_round",
    "start_bargain",
    "surplus_share",
    "turn_to_go",
]
