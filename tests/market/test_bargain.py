"""The bargain keeps the rules that players feel: floors, patience, insults, acceptance, one seed one result."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from game.core.emotion_space import EMOTIONS, emotion_vector
from game.core.errors import BadInput
from game.market import (
    Bargain,
    Move,
    OfferResult,
    Outcome,
    ask_floor,
    load_market_rules,
    play_round,
    start_bargain,
    surplus_share,
    turn_to_go,
)

RULES = load_market_rules()
CALM = replace(RULES, sudden_end_chance=0.0)
NEUTRAL = emotion_vector({})


def fresh(lowest: float = 0.6, **changes: float) -> Bargain:
    return Bargain(lowest=lowest, ask=1.0, offer=0.0, patience=50.0, trust=0.3)._replace(**changes)


def rng(seed: int = 1) -> np.random.Generator:
    return np.random.default_rng(seed)


moves = st.builds(
    Move,
    st.sampled_from(["praise", "joke", "press", "wait"]),
    st.sampled_from(["right", "neutral", "wrong"]),
    st.one_of(st.none(), st.floats(0.01, 1.0)),
)
feelings = st.dictionaries(st.sampled_from(EMOTIONS[:6]), st.floats(0, 1), max_size=3).map(emotion_vector)


@settings(max_examples=150, deadline=None)
@given(st.integers(0, 2**31), st.lists(st.tuples(moves, feelings, st.sampled_from(EMOTIONS)), min_size=1, max_size=8))
def test_the_ask_only_falls_and_never_below_its_floor(seed, played) -> None:
    bargain = start_bargain(RULES, 7.0, rng(seed))
    for number, (move, felt, label) in enumerate(played):
        if bargain.outcome:
            break
        before = bargain
        bargain, answer = play_round(RULES, bargain, move, felt, label, rng(seed + number))
        assert bargain.ask <= before.ask
        assert bargain.ask >= min(before.ask, ask_floor(RULES, before)) - 1e-12
        assert 0.0 <= bargain.trust <= 1.0
        assert answer.conceded >= 0
        if answer.result == OfferResult.ACCEPTED:
            assert bargain.outcome == Outcome.DEAL
            assert bargain.lowest <= bargain.price <= before.ask
            assert 0.0 <= surplus_share(bargain) <= 1.0
        else:
            assert bargain.price == 0.0


def test_a_talk_ends_after_the_rounds_or_when_patience_is_out() -> None:
    bargain = fresh()
    for _ in range(RULES.rounds):
        assert bargain.outcome == ""
        bargain, _ = play_round(CALM, bargain, Move("small_talk", "neutral"), NEUTRAL, "neutral", rng())
    assert bargain.outcome == Outcome.ROUNDS_OUT
    tired, _ = play_round(CALM, fresh(patience=0.9), Move("joke", "wrong"), NEUTRAL, "neutral", rng())
    assert tired.outcome == Outcome.OUT_OF_PATIENCE
    with pytest.raises(BadInput, match="a talk that goes on"):
        play_round(CALM, tired, Move("joke", "right"), NEUTRAL, "neutral", rng())


def test_meeting_the_ask_is_a_deal_even_in_disgust_but_less_is_not() -> None:
    disgust = emotion_vector({"disgust": 0.9})
    met, answer = play_round(CALM, fresh(), Move("praise", "neutral", 1.0), disgust, "disgust", rng())
    assert (answer.result, met.price) == (OfferResult.ACCEPTED, 1.0)
    short, answer = play_round(CALM, fresh(), Move("praise", "neutral", 0.95), disgust, "disgust", rng())
    assert answer.result == OfferResult.REFUSED
    assert short.outcome == ""


def test_an_insult_costs_patience_by_how_far_it_goes() -> None:
    near, small = play_round(CALM, fresh(), Move("flaw", "neutral", 0.44), NEUTRAL, "neutral", rng())
    far, large = play_round(CALM, fresh(), Move("flaw", "neutral", 0.20), NEUTRAL, "neutral", rng())
    assert small.result == large.result == OfferResult.INSULT
    assert far.patience < near.patience
    assert large.excess == pytest.approx(0.25)


def test_a_right_line_moves_the_ask_more_than_a_wrong_one() -> None:
    falls = {}
    for quality in ("right", "neutral", "wrong"):
        _, answer = play_round(CALM, fresh(offer=0.5), Move("story", quality, 0.6), NEUTRAL, "neutral", rng())
        falls[quality] = answer.conceded
    assert falls["right"] > falls["neutral"] > falls["wrong"] > 0


def test_holding_pays_with_a_frightened_seller_and_annoys_an_angry_one() -> None:
    held = Move("wait", "neutral", 0.6)
    scared, answer = play_round(CALM, fresh(offer=0.6), held, emotion_vector({"fear": 0.7}), "fear", rng())
    angry, nothing = play_round(CALM, fresh(offer=0.6), held, emotion_vector({"anger": 0.7}), "anger", rng())
    assert answer.conceded > 0.1
    assert nothing.conceded == 0.0
    assert scared.patience - angry.patience == pytest.approx(RULES.unmoved_patience)


def test_turning_to_go_ends_the_talk_unless_it_is_right() -> None:
    assert turn_to_go(RULES, fresh(), "neutral").outcome == Outcome.WALKED_AWAY
    back = turn_to_go(RULES, fresh(), "right")
    assert back.outcome == ""
    assert ask_floor(RULES, back) < back.ask < 1.0


def test_one_seed_one_bargain_and_visits_leave_annoyance() -> None:
    assert start_bargain(RULES, 7.0, rng(5)) == start_bargain(RULES, 7.0, rng(5))
    assert start_bargain(RULES, 7.0, rng(5)) != start_bargain(RULES, 7.0, rng(6))
    again = start_bargain(RULES, 7.0, rng(5), failed_visits=2)
    assert again.patience == pytest.approx(start_bargain(RULES, 7.0, rng(5)).patience - 2 * RULES.annoyance_on_return)


@pytest.mark.parametrize("offer", [0.0, -0.5, 1.5])
def test_an_offer_outside_the_list_price_is_refused_as_input(offer: float) -> None:
    with pytest.raises(BadInput, match="a share of the list price"):
        play_round(RULES, fresh(), Move("praise", "right", offer), NEUTRAL, "neutral", rng())


def test_a_broken_rules_file_names_the_place(tmp_path) -> None:
    text = (load_market_rules.__defaults__[0]).read_text(encoding="utf-8")
    broken = tmp_path / "rules.yaml"
    broken.write_text(text.replace("lowest_price: [0.50, 0.85]", "lowest_price: [0.85, 0.50]"), encoding="utf-8")
    with pytest.raises(BadInput, match=r"rules\.yaml:\d+:\d+: .*smaller first"):
        load_market_rules(broken)
