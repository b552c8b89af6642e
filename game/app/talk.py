"""One talk: the player's choice runs through story, appraisal and market, and comes back as lines and feelings.

This is the upper half of the one data flow (choice → story → stimuli → emotion → market). It draws nothing and
keeps no clock: a round is a round however long the player thinks. ``game.app.step`` moves the body below it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

from game.core.errors import BadInput
from game.core.streams import Streams
from game.emotion import (
    Feeling,
    FeelingRules,
    Temperament,
    add_feelings,
    after_insult,
    after_line,
    after_refusal,
    appraise,
    felt_label,
    pass_round,
    shown_values,
    start_feeling,
)
from game.market import (
    Answer,
    Bargain,
    MarketRules,
    Move,
    OfferResult,
    Outcome,
    play_round,
    start_bargain,
    surplus_share,
    turn_to_go,
)
from game.story import Beat, Chose, Environment, Memory, Script, Start, StoryState, Warp, advance, begin

__all__ = [
    "MONEY_STEP",
    "Choice",
    "TalkAssets",
    "TalkState",
    "ask_money",
    "choose",
    "start_talk",
    "talk_env",
    "warp_talk",
]

MONEY_STEP = 10
"""Prices are spoken in whole tens of yen."""


@dataclass(frozen=True, eq=False)
class TalkAssets:
    """What a talk needs and never changes: the script, the rules and the person, and where its chance comes from."""

    script: Script
    feelings: FeelingRules
    market: MarketRules
    person: Temperament
    streams: Streams = field(default_factory=Streams, repr=False)


@dataclass(frozen=True)
class Choice:
    """The player's move: a choice of the present beat and, if it carries one, an offer in yen."""

    id: str
    offer: int | None = None


_NO_ANSWER = Answer(OfferResult.NONE)
_OFFER_OUTCOMES = {OfferResult.REFUSED: "refused_offer", OfferResult.INSULT: "insulted"}


@dataclass(frozen=True, eq=False)
class TalkState:
    """Everything a talk owns. ``record`` has what observers and logs need of the last move, never read by rules."""

    seed: int
    item: str
    list_price: int
    purse: int
    story: StoryState
    feeling: Feeling
    bargain: Bargain
    beat: Beat
    visit: int = 1
    deal_price: int = 0
    answer: Answer = _NO_ANSWER
    record: tuple[tuple[str, Any], ...] = ()

    @property
    def ended(self) -> bool:
        """True once the story has nothing more to say."""
        return self.beat.ended is not None

    @property
    def surplus(self) -> float:
        """Share of the possible gain, 0 where there is no deal."""
        return surplus_share(self.bargain)


@lru_cache(maxsize=4096)
def ask_money(list_price: int, ask: float) -> int:
    """The public asking price in yen, rounded up to whole tens, never above the list price."""
    return min(math.ceil(round(ask * list_price / MONEY_STEP, 6)) * MONEY_STEP, list_price)


def talk_env(state: TalkState, assets: TalkAssets) -> Environment:
    """The names a dialogue condition may use; what is felt is not among them, on purpose."""
    return _env(state, assets, state.bargain, state.answer, state.deal_price)


def _env(state: TalkState, assets: TalkAssets, bargain: Bargain, answer: Answer, deal_price: int) -> Environment:
    list_price = state.list_price
    ask = float(ask_money(list_price, bargain.ask))
    return Environment(
        rounds=float(assets.market.rounds),
        trust=bargain.trust,
        patience=bargain.patience,
        round=bargain.round + 1.0,
        ask=ask,
        price=ask,
        list_price=float(list_price),
        purse=float(state.purse),
        visit=float(state.visit),
        offer=float(round(bargain.offer * list_price)),
        deal_price=float(deal_price),
        tidying=answer.tidying,
    )


def start_talk(
    assets: TalkAssets,
    item: str,
    seed: int,
    *,
    purse: int,
    memory: Memory | None = None,
    failed_visits: float = 0.0,
    shared: Mapping[str, float | str | bool] | None = None,
) -> TalkState:
    """Walk up to the stall for one item. Mood, lowest price and patience are drawn anew on every visit.

    shared: the script variables of scope ``afternoon``, as earlier talks at any stall left them.
    """
    if item not in assets.script.items:
        raise BadInput("item", expected=" | ".join(assets.script.items), seen=item)
    list_price = assets.script.items[item].list_price
    story = begin(assets.script, item, seed, memory=memory, afternoon=shared)
    feeling = start_feeling(assets.feelings, assets.person, assets.streams.at(seed, "mood", 0))
    bargain = start_bargain(
        assets.market, assets.person.patience, assets.streams.at(seed, "mark", 0), failed_visits=failed_visits
    )
    visit = 1 if memory is None else memory.visits + 1
    nothing = Beat(node="", lines=(), choices=(), stimuli=(), ended=None)
    first = TalkState(seed, item, list_price, purse, story, feeling, bargain, nothing, visit=visit)
    story, beat = advance(assets.script, story, Start(), talk_env(first, assets))
    felt = _with_stimuli(assets, feeling, beat)
    return TalkState(seed, item, list_price, purse, story, felt, bargain, beat, visit)


def warp_talk(assets: TalkAssets, state: TalkState, node: str) -> TalkState:
    """The talk at another node of its script, feelings and bargain as they are. Raises BadInput for an unknown node."""
    story, beat = advance(assets.script, state.story, Warp(node), talk_env(state, assets))
    return replace(state, story=story, beat=beat, feeling=_with_stimuli(assets, state.feeling, beat))


def _with_stimuli(assets: TalkAssets, feeling: Feeling, beat: Beat) -> Feeling:
    for stimulus in beat.stimuli:
        feeling = add_feelings(assets.person, feeling, stimulus.feel)
    return feeling


def _offer_share(state: TalkState, offer: int | None) -> float | None:
    """An offer in yen as a share of the list price; meeting the spoken ask counts as meeting the ask."""
    if offer is None:
        return None
    if not 0 < offer <= state.list_price:
        raise BadInput("offer", expected=f"a price from 1 to {state.list_price}", seen=offer)
    if offer > state.purse:
        raise BadInput("offer", expected=f"at most the purse, {state.purse}", seen=offer)
    if offer >= ask_money(state.list_price, state.bargain.ask):
        return max(state.bargain.ask, offer / state.list_price)
    return offer / state.list_price


def choose(assets: TalkAssets, state: TalkState, choice: Choice) -> TalkState:
    """One move of the player and all that follows from it: a new beat of lines, new feelings, a new price.

    Raises BadInput for a choice that is not on the table, an offer beyond the purse, or a talk that has ended.
    """
    if state.ended:
        raise BadInput("choice", expected="a talk that goes on", seen=state.beat.ended)
    for said in state.beat.choices:
        if said.id == choice.id and said.available:
            break
    else:
        known = [option.id for option in state.beat.choices if option.available]
        raise BadInput("choice", expected=" | ".join(known), seen=choice.id)
    act = said.act
    offer = _offer_share(state, choice.offer)
    if act == "offer" and offer is None:
        raise BadInput("choice offer", expected="an offer in yen with it", seen="none")
    judged = "turn_to_go" if act == "leave" else act
    before = felt_label(assets.feelings, state.feeling)
    quality = appraise(assets.feelings, assets.person, state.feeling, judged)
    feeling = after_line(assets.feelings, assets.person, state.feeling, judged, quality)
    feeling = add_feelings(assets.person, feeling, said.feel)
    counter = state.bargain.round + 1
    rng = assets.streams.at(state.seed, "mark", counter)
    outcome: str | None
    if act == "leave":
        bargain = turn_to_go(assets.market, state.bargain, quality)
        answer = Answer(OfferResult.NONE, conceded=state.bargain.ask - bargain.ask)
        outcome = Outcome.WALKED_AWAY if bargain.outcome else "called_back"
    else:
        label = felt_label(assets.feelings, feeling)
        bargain, answer = play_round(assets.market, state.bargain, Move(act, quality, offer), feeling.felt7, label, rng)
        outcome = bargain.outcome or _OFFER_OUTCOMES.get(answer.result)
    if answer.result == OfferResult.INSULT:
        feeling = after_insult(assets.feelings, assets.person, feeling, answer.excess)
    elif answer.result == OfferResult.REFUSED and answer.above_lowest >= 0:
        feeling = after_refusal(assets.feelings, feeling, answer.above_lowest)
    deal = choice.offer if bargain.outcome == Outcome.DEAL and choice.offer is not None else 0
    if deal:
        deal = min(deal, ask_money(state.list_price, state.bargain.ask))
    env = _env(state, assets, bargain, answer, deal)
    env.update(round=float(counter), quality=quality, tells=answer.tells, offer_result=answer.result)
    if choice.offer:
        env["offer"] = float(choice.offer)
    story, beat = advance(assets.script, state.story, Chose(choice.id, outcome=outcome), env)
    # The option's own `feel:` was added above, before the offer was weighed; the beat brings those of what was said.
    reacted = _with_stimuli(assets, feeling, beat)
    after = pass_round(assets.feelings, assets.person, reacted, assets.streams.at(state.seed, "mood", counter))
    record = (
        ("act", act),
        ("quality", quality),
        ("felt_label", before),
        ("result", answer.result),
        ("outcome", outcome or ""),
        ("felt", feeling.felt7),
        ("shown", shown_values(assets.person, feeling)),
    )
    return TalkState(
        state.seed, state.item, state.list_price, state.purse - deal, story, after, bargain, beat,
        state.visit, deal, answer, record,
    )  # fmt: skip
