"""Stressed words of a line: which they are, how far apart, and that words with gestures of their own come first."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from game.core import ASSETS
from game.core.errors import BadInput
from game.embos import GestureCues, MotionUnit, StressRule, UnitLibrary, load_config, stressed_moments

JOY = np.eye(7)[2]
RULE = StressRule(
    ("beat",), least_s=1.0, apart_s=1.0, clear_s=0.5, unstressed={"en": frozenset({"i", "would", "it", "that"})}
)


def words_at(text: str, moments: list[float], per_char_s: float = 0.1) -> list[str]:
    return [text[round(m / per_char_s) :].split()[0].strip(",.!?") for m in moments]


def found(text: str, rule: StressRule = RULE, language: str = "en", taken_s: tuple[float, ...] = ()) -> list[float]:
    return stressed_moments(text, [0.1 * i for i in range(len(text))], language, rule, taken_s)


def test_a_phrase_is_stressed_on_its_last_content_word() -> None:
    text = "Honestly, I would sell it"
    assert words_at(text, found(text)) == ["Honestly", "sell"]
    assert words_at("Copper kettles shine, I would", found("Copper kettles shine, I would")) == ["Copper", "shine"]


def test_stresses_keep_their_distance_and_short_lines_get_none() -> None:
    long = "kettle " * 30
    moments = found(long)
    assert len(moments) > 5
    assert np.diff(moments).min() >= RULE.apart_s - 1e-9
    assert found("kettle") == []
    assert found("I would, I would, I would") == []
    assert found(long, StressRule()) == []


def test_words_with_gestures_of_their_own_are_left_to_them() -> None:
    text = "Copper kettles shine beautifully"
    assert 1.5 in found(text)[1:] or 2.1 in found(text)
    assert all(abs(m - 2.1) >= RULE.clear_s for m in found(text, taken_s=(2.1,)))


def test_japanese_stresses_the_first_stem_of_a_phrase() -> None:
    text = "この古い時計は、ずっと祖父の大切な宝物でした。"
    moments = found(text, replace(RULE, apart_s=0.8), language="ja")
    assert text[round(moments[0] / 0.1)] == "古"
    assert text[round(moments[1] / 0.1)] == "祖"


def test_a_line_gets_its_own_gestures_and_beats_between_them() -> None:
    def gesture(name: str, word: str) -> MotionUnit:
        return MotionUnit(name, "gesture", JOY, 1.0 * JOY, 1.0 * JOY, words={"en": (word,)})

    library = UnitLibrary(
        [
            MotionUnit("upright", "posture", JOY, 5.0 * JOY, 0.0 * JOY),
            gesture("point", "kettle"),
            gesture("beat", "really"),
            MotionUnit("sway", "mannerism", JOY, 2.0 * JOY, 3.0 * JOY),
        ]
    )
    text = "That kettle has crossed the wide ocean, really"
    char_s = [0.1 * i for i in range(len(text))]
    words = GestureCues.from_words(library, text, char_s, "en")
    for knows_point in (True, False):
        shown = np.array([knows_point, True])
        cues = words.with_beats(library, text, char_s, "en", shown=shown, stress=RULE)
        own = dict(zip(cues.gesture.tolist(), cues.time_s.tolist(), strict=True))
        assert own[0] == pytest.approx(0.5)  # its word is heard even where the feeling does not know the gesture
        beats = cues.time_s[cues.gesture == 1]
        assert beats.max() == pytest.approx(4.0)
        near = np.abs(beats - 0.5).min()
        assert (near > RULE.clear_s - 1e-9) == knows_point
    none = words.with_beats(library, text, char_s, "en", shown=np.array([True, False]), stress=RULE)
    assert none.gesture.tolist() == [0, 1]
    assert cues.later(2.0).time_s.tolist() == (cues.time_s + 2.0).tolist()


def test_a_line_waits_for_the_preparation_of_its_first_word() -> None:
    cues = GestureCues(np.array([0, 1]), np.array([0.2, 1.0]), 2)
    assert cues.preparation_s(np.array([0.5, 0.5]), np.array([True, True])) == pytest.approx(0.3)
    assert cues.preparation_s(np.array([0.5, 0.5]), np.array([False, True])) == 0.0
    assert GestureCues(np.zeros(0, dtype=np.intp), np.zeros(0), 2).preparation_s(np.ones(2), np.ones(2, bool)) == 0.0


def test_the_shipped_rule_leaves_function_words_alone() -> None:
    rule = load_config(ASSETS / "motion" / "planner.yaml").stress
    text = "I would not sell it to you, but there is an old lantern"
    assert words_at(text, found(text, rule)) == ["sell", "lantern"]
    with pytest.raises(BadInput, match="stress apart_s"):
        StressRule(apart_s=-1.0)
