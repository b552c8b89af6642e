"""Feelings follow the rules file: the same act lands differently, masks hide, moods decay toward the baseline."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from game.core.emotion_space import EMOTION_INDEX, EMOTIONS, SIX
from game.core.errors import BadInput
from game.emotion import (
    Feeling,
    add_feelings,
    after_insult,
    after_line,
    appraise,
    felt_label,
    load_feeling_rules,
    pass_round,
    shown_emotion,
    start_feeling,
    to_valence_arousal,
)

RULES = load_feeling_rules()
STUDENT = RULES.temperaments["student"]
TRADER = RULES.temperaments["trader"]
JOY = EMOTION_INDEX["joy"]


def feel(**values: float) -> Feeling:
    felt = np.zeros(6)
    for name, value in values.items():
        felt[EMOTION_INDEX[name]] = value
    return Feeling(six=tuple(felt.tolist()), mask_shows=JOY)


def test_a_joke_warms_the_happy_and_insults_the_angry() -> None:
    assert appraise(RULES, STUDENT, feel(joy=0.6), "joke") == "right"
    assert appraise(RULES, STUDENT, feel(anger=0.6), "joke") == "wrong"
    assert appraise(RULES, STUDENT, feel(fear=0.6), "wait") == "right"
    assert appraise(RULES, STUDENT, feel(sadness=0.6), "wait") == "wrong"


def test_temperaments_differ() -> None:
    assert appraise(RULES, STUDENT, feel(fear=0.6), "story") == "wrong"
    assert appraise(RULES, TRADER, feel(fear=0.6), "story") == "neutral"
    assert appraise(RULES, TRADER, feel(), "joke") == "right"


def test_a_right_line_repeated_at_once_is_only_neutral_and_pressing_works_once() -> None:
    happy = feel(joy=0.7)
    once = after_line(RULES, STUDENT, happy, "joke", "right")
    assert appraise(RULES, STUDENT, once, "joke") == "neutral"
    other = after_line(RULES, STUDENT, once, "praise", "right")
    assert appraise(RULES, STUDENT, other, "joke") == "right"
    pressed = after_line(RULES, STUDENT, feel(fear=0.8), "press", "right")
    talked = after_line(RULES, STUDENT, pressed, "small_talk", "right")
    assert appraise(RULES, STUDENT, talked._replace(six=feel(fear=0.8).six), "press") == "neutral"


def test_right_lines_calm_and_wrong_lines_hurt_by_the_profile() -> None:
    hurt = feel(anger=0.6, fear=0.4)
    calmed = after_line(RULES, STUDENT, hurt, "apologise", "right")
    assert np.allclose(calmed.felt[:2], hurt.felt[:2] * RULES.right_negative_factor)
    assert calmed.felt[JOY] > hurt.felt[JOY]
    worse = after_line(RULES, STUDENT, feel(joy=0.5), "flaw", "wrong")
    rises = worse.felt - feel(joy=0.5).felt
    assert worse.felt[JOY] < 0.5
    assert np.argmax(rises) == EMOTION_INDEX["fear"]
    assert after_insult(RULES, STUDENT, feel(), 0.3).felt.sum() > after_insult(RULES, STUDENT, feel(), 0.0).felt.sum()


def test_feelings_halve_toward_the_baseline_in_their_half_life() -> None:
    still = replace(RULES, turn_chance=0.0)
    feeling = feel(anger=0.8)
    for _ in range(int(RULES.half_life_rounds[0])):
        feeling = pass_round(still, STUDENT, feeling, np.random.default_rng(0))
    expected = STUDENT.baseline[0] + (0.8 - STUDENT.baseline[0]) / 2
    assert feeling.felt[0] == pytest.approx(expected)


def test_moods_turn_as_often_as_the_rules_say() -> None:
    rng = np.random.default_rng(7)
    turned = sum(
        bool(np.any(pass_round(RULES, STUDENT, feel(), rng).felt >= RULES.turn_size - 1e-9)) for _ in range(2000)
    )
    neutral = STUDENT.mood_prior[6]
    assert turned / 2000 == pytest.approx(RULES.turn_chance * (1 - neutral), abs=0.025)


def test_a_strong_mask_shows_a_smile_whatever_is_felt() -> None:
    angry = feel(anger=0.8)
    honest, masked = shown_emotion(STUDENT, angry), shown_emotion(TRADER, angry)
    assert EMOTIONS[int(np.argmax(honest))] == "anger"
    assert EMOTIONS[int(np.argmax(masked))] == "joy"
    assert masked[0] < 0.1


def test_masks_are_many_to_one() -> None:
    shows = [start_feeling(RULES, TRADER, np.random.default_rng(s)).mask_shows for s in range(400)]
    assert set(shows) == {JOY, EMOTION_INDEX["neutral"]}
    assert np.mean([s == JOY for s in shows]) == pytest.approx(0.6, abs=0.08)


def test_the_label_needs_its_threshold() -> None:
    assert felt_label(RULES, feel(joy=0.24)) == "neutral"
    assert felt_label(RULES, feel(joy=0.25)) == "joy"


@settings(max_examples=100, deadline=None)
@given(
    st.lists(st.floats(0, 1), min_size=6, max_size=6),
    st.dictionaries(st.sampled_from(SIX), st.floats(-1, 1), max_size=6),
    st.sampled_from(sorted(RULES.temperaments)),
    st.sampled_from(RULES.acts),
    st.integers(0, 1000),
)
def test_feelings_stay_in_the_emotion_space(values, change, person, act, seed) -> None:
    who = RULES.temperaments[person]
    feeling = add_feelings(who, Feeling(tuple(values), JOY), change)
    feeling = after_line(RULES, who, feeling, act, appraise(RULES, who, feeling, act))
    feeling = pass_round(RULES, who, feeling, np.random.default_rng(seed))
    for vector in (np.array(feeling.felt7), shown_emotion(who, feeling)):
        assert np.all((vector >= 0) & (vector <= 1))
    assert np.all(np.abs(to_valence_arousal(feeling.felt7)) <= 1)


def test_a_typo_in_the_rules_is_named_with_its_place(tmp_path) -> None:
    source = load_feeling_rules.__defaults__[0].read_text(encoding="utf-8")
    broken = tmp_path / "rules.yaml"
    broken.write_text(source.replace("mood_prior: {anger: 9,", "mood_prior: {angre: 9,"), encoding="utf-8")
    with pytest.raises(BadInput, match=r"rules\.yaml:\d+:\d+: .*anger"):
        load_feeling_rules(broken)
