"""One bargain over one item, round by round. All prices are shares of the list price (list price = 1).

The market does not import the feelings: it is told how the line was taken and what is felt, and it tells what
became of the offer, for the feelings to react to.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from game.core.errors import BadInput
from game.core.streams import Draws
from game.market.rules import MarketRules

__all__ = [
    "Answer",
    "Bargain",
    "Move",
    "OfferResult",
    "Outcome",
    "ask_floor",
    "play_round",
    "start_bargain",
    "surplus_share",
    "turn_to_go",
]


class Outcome:
    """How a talk ended; the names dialogue scripts use in ``on:``."""

    DEAL = "deal"
    OUT_OF_PATIENCE = "out_of_patience"
    SUDDEN_END = "sudden_end"
    ROUNDS_OUT = "rounds_out"
    WALKED_AWAY = "walked_away"
    ALL = (DEAL, OUT_OF_PATIENCE, SUDDEN_END, ROUNDS_OUT, WALKED_AWAY)


class OfferResult:
    """What became of an offer in this round."""

    NONE = "none"
    ACCEPTED = "accepted"
    REFUSED = "refused"
    INSULT = "insult"


class Bargain(NamedTuple):
    """lowest: the hidden lowest price L. ask: the public price. offer: the player's best so far, 0 if none.

    patience: rounds' worth of goodwill left. trust in [0, 1]. outcome: empty while the talk goes on.
    """

    lowest: float
    ask: float
    offer: float
    patience: float
    trust: float
    round: int = 0
    outcome: str = ""
    price: float = 0.0


class Move(NamedTuple):
    """What the player does in a round: an act (or ``wait``), how it was taken, and perhaps an offer in (0, 1]."""

    act: str
    quality: str
    offer: float | None = None


class Answer(NamedTuple):
    """What the seller makes of it. ``excess``: by how much an insult went beyond the margin; ``above_lowest``:
    offer − L of a refused offer; ``conceded``: by how much the ask fell; ``tidying``: impatience to be seen."""

    result: str
    excess: float = 0.0
    above_lowest: float = 0.0
    conceded: float = 0.0
    tidying: bool = False
    tells: bool = False


def start_bargain(rules: MarketRules, patience: float, rng: Draws, *, failed_visits: float = 0.0) -> Bargain:
    """A fresh bargain: the lowest price and the patience are drawn anew on every visit."""
    low, high = rules.lowest_price
    lowest = low + (high - low) * rng.random()
    start = patience + rules.patience_sigma * rng.standard_normal() - rules.annoyance_on_return * failed_visits
    return Bargain(lowest=lowest, ask=1.0, offer=0.0, patience=max(start, 1.0), trust=rules.trust_start)


def surplus_share(bargain: Bargain) -> float:
    """(list − price)/(list − lowest) of a deal, 0 where there is none."""
    return (1.0 - bargain.price) / (1.0 - bargain.lowest) if bargain.outcome == Outcome.DEAL else 0.0


def ask_floor(rules: MarketRules, bargain: Bargain) -> float:
    """The public price never falls below this: L + margin (1 − L)."""
    return bargain.lowest + rules.floor_margin * (1.0 - bargain.lowest)


def turn_to_go(rules: MarketRules, bargain: Bargain, quality: str) -> Bargain:
    """The player turns to go. Taken well, the seller calls them back with a better price; else the talk is over."""
    if quality != "right":
        return bargain._replace(outcome=Outcome.WALKED_AWAY)
    floor = ask_floor(rules, bargain)
    ask = min(bargain.ask, bargain.ask - rules.called_back_fall * (bargain.ask - floor))
    return bargain._replace(ask=ask, patience=bargain.patience - rules.patience_round, round=bargain.round + 1)


_ONES = (1.0,) * 7


def weighted(values: Sequence[float], weights: Sequence[float]) -> float:
    """Sum of seven products, from left to right (``sum`` rounds differently from one Python to the next)."""
    a, b, c, d, e, f, g = values
    p, q, r, s, t, u, v = weights
    return a * p + b * q + c * r + d * s + e * t + f * u + g * v


def _concession(
    rules: MarketRules, bargain: Bargain, move: Move, offer: float, felt7: Sequence[float], label: str, noise: float
) -> tuple[float, float]:
    """How far the ask falls, and the patience it costs to be held against."""
    raised = offer - bargain.offer
    if bargain.offer > 0 and raised < rules.small_raise:
        rate = rules.holding_by_label[label]
        return rules.holding_rate * max(bargain.ask - offer, 0.0) * rate, (
            0.0 if rate > 0 else rules.unmoved_patience
        ) + rules.patience_small_raise
    step = rules.per_raise * raised if bargain.offer > 0 else rules.first_offer
    hard = weighted(felt7, rules.hard) / weighted(felt7, _ONES)
    trust = rules.trust_base + rules.trust_slope * bargain.trust
    return step * rules.quality[move.quality] * hard * trust * math.exp(rules.concession_sigma * noise), 0.0


def play_round(
    rules: MarketRules, bargain: Bargain, move: Move, felt7: Sequence[float], label: str, rng: Draws
) -> tuple[Bargain, Answer]:
    """One round: the line is spoken, the ask falls, the offer is answered, patience and trust change.

    felt7: (7,) what is felt after the line; label: its name. Draws the same number of random values whatever
    happens, so that one seed stays comparable across choices. Raises BadInput for an offer outside (0, 1] or a
    bargain that has ended.
    """
    if bargain.outcome:
        raise BadInput("bargain", expected="a talk that goes on", seen=bargain.outcome)
    if move.offer is not None and not 0.0 < move.offer <= 1.0:
        raise BadInput("offer", expected="a share of the list price above 0, at most 1", seen=move.offer)
    noise, accept_noise = rng.standard_normal(), rng.standard_normal()
    sudden, tidy, tells = rng.random(), rng.random(), rng.random()

    patience = bargain.patience - (rules.patience_wait if move.act == "wait" else rules.patience_round)
    trust = bargain.trust
    if move.quality == "right":
        patience -= rules.patience_right
        trust += rules.trust_right
    elif move.quality == "wrong":
        patience -= rules.patience_wrong
        trust += rules.trust_wrong
    if move.act == "press":
        trust += rules.trust_press
    trust = min(max(trust, 0.0), 1.0)

    ask, result, excess, above, price, outcome = bargain.ask, OfferResult.NONE, 0.0, 0.0, 0.0, ""
    best = bargain.offer
    if move.offer is not None:
        offer = move.offer
        patience -= rules.patience_offer
        fall, cost = _concession(rules, bargain, move, offer, felt7, label, noise)
        patience -= cost
        ask = min(bargain.ask, max(bargain.ask - fall, ask_floor(rules, bargain)))
        warmth = min(weighted(felt7, rules.soft) + rules.acceptance_trust * trust, rules.acceptance_limit)
        accept_at = bargain.lowest + (ask - bargain.lowest) * (1.0 - warmth) + rules.acceptance_sigma * accept_noise
        best = max(best, offer)
        # A disgusted seller sells only at the asking price.
        if offer >= ask or (label != "disgust" and offer >= max(accept_at, bargain.lowest)):
            result, outcome, price = OfferResult.ACCEPTED, Outcome.DEAL, min(offer, bargain.ask)
        elif offer < bargain.lowest - rules.insult_margin:
            result = OfferResult.INSULT
            excess = bargain.lowest - rules.insult_margin - offer
            patience -= rules.insult_patience_base + rules.insult_patience_slope * excess
        else:
            result = OfferResult.REFUSED
            above = offer - bargain.lowest
    played = bargain.round + 1
    if not outcome:
        if patience <= 0:
            outcome = Outcome.OUT_OF_PATIENCE
        elif sudden < rules.sudden_end_chance:
            outcome = Outcome.SUDDEN_END
        elif played >= rules.rounds:
            outcome = Outcome.ROUNDS_OUT
    after = Bargain(bargain.lowest, ask, best, patience, trust, played, outcome, price)
    return after, Answer(
        result=result,
        excess=excess,
        above_lowest=above,
        conceded=bargain.ask - ask,
        tidying=patience <= rules.tidy_below and tidy < rules.tidy_seen,
        tells=tells < rules.spoken_tells,
    )
