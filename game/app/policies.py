"""Autoplay's players. Each sees only what its name allows.

``random`` knows nothing. ``oracle`` sees the felt emotion and the rules by which lines are taken, not the hidden
lowest price. Ties among equal lines are broken at random, by the policy's own seeded generator.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from game.app.talk import MONEY_STEP, Choice, TalkAssets, TalkState, ask_money
from game.emotion import appraise, felt_label

__all__ = ["POLICIES", "Policy"]

Policy = Callable[[TalkAssets, TalkState, np.random.Generator], Choice]


def _money(amount: float, limit: int) -> int:
    """A spoken price: whole tens, at least one step, at most the limit."""
    return max(min(round(amount / MONEY_STEP) * MONEY_STEP, limit), min(MONEY_STEP, limit))


def random_policy(assets: TalkAssets, state: TalkState, rng: np.random.Generator) -> Choice:
    """Any available choice; an offer, where one comes with it, anywhere between the last one and the ask."""
    options = [option for option in state.beat.choices if option.available and option.act != "leave"]
    option = options[int(rng.integers(len(options)))]
    ask = ask_money(state.list_price, state.bargain.ask)
    low = max(state.bargain.offer, 0.4) * state.list_price
    amount = _money(float(rng.uniform(min(low, ask), ask)), min(ask, state.purse))
    with_offer = option.act == "offer" or (option.act != "wait" and rng.random() < 0.6)
    return Choice(option.id, amount if with_offer else None)


def oracle_policy(assets: TalkAssets, state: TalkState, rng: np.random.Generator) -> Choice:
    """Answers what is felt with a line that will be taken well, and raises its offers in small steps."""
    worth = {"right": 2.0, "neutral": 1.0, "wrong": 0.0}
    best, best_score = None, -1.0
    for option in state.beat.choices:
        if not option.available or option.act in {"offer", "leave"}:
            continue
        score = worth[appraise(assets.feelings, assets.person, state.feeling, option.act)]
        # Waiting and pressing cost a little more than they look.
        score -= 0.3 if option.act in {"wait", "press"} else 0.0
        score += 0.01 * float(rng.random())
        if score > best_score:
            best, best_score = option, score
    if best is None:
        best = next(option for option in state.beat.choices if option.act == "leave")
    ask = ask_money(state.list_price, state.bargain.ask)
    limit = min(ask, state.purse)
    last = state.bargain.round >= assets.market.rounds - 1 or state.bargain.patience < 2.0
    if last and state.purse >= ask:
        return Choice(best.id, ask)
    if felt_label(assets.feelings, state.feeling) == "disgust":
        return Choice(best.id)
    opening = 0.5 if state.bargain.offer == 0 else state.bargain.offer + 0.06
    return Choice(best.id, _money(opening * state.list_price, limit))


POLICIES: Mapping[str, Policy] = {"random": random_policy, "oracle": oracle_policy}
