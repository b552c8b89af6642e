"""Gesture words in a line: which are found, when, and when the gesture has to start."""

from __future__ import annotations

import numpy as np
import pytest

from game.embos import GestureCues, MotionUnit, Planner, PlannerSignal, UnitLibrary, Variant, timed_tokens

JOY = np.eye(7)[2]


def library() -> UnitLibrary:
    def gesture(name: str, english: tuple[str, ...], japanese: tuple[str, ...], stroke_s: float) -> MotionUnit:
        span = Variant(2, "joy", 10.0, 12.0, 10.0, 12.0, 10.0 + stroke_s)
        words = {"en": english, "ja": japanese}
        return MotionUnit(name, "gesture", JOY, 2.0 * JOY, 1.0 * JOY, words=words, variants=(span,))

    return UnitLibrary(
        [
            MotionUnit("upright", "posture", JOY, 5.0 * JOY, 0.0 * JOY),
            gesture("point", ("this", "over there"), ("これ",), 0.5),
            gesture("size", ("box", "baby"), ("箱", "大きさ"), 0.2),
            MotionUnit("sway", "mannerism", JOY, 2.0 * JOY, 3.0 * JOY),
        ]
    )


def found(text: str, language: str = "en") -> list[tuple[int, float]]:
    cues = GestureCues.from_text(library(), text, 0.0, float(len(text)), language)
    return list(zip(cues.gesture.tolist(), cues.time_s.tolist(), strict=True))


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("Look at THIS!", [(0, 8.0)]),
        ("thistle, thesis", []),
        ("the boxes", [(1, 4.0)]),
        ("a box's lid", [(1, 2.0)]),
        ("two babies", [(1, 4.0)]),
        ("it is over there.", [(0, 6.0)]),
        ("over here", []),
        ("this box", [(0, 0.0), (1, 5.0)]),
        ("", []),
    ],
)
def test_english_words_are_whole_words_with_simple_inflection(text: str, wanted: list[tuple[int, float]]) -> None:
    assert found(text) == wanted


def test_japanese_words_are_found_inside_the_line() -> None:
    assert found("その箱はこれです", "ja") == [(1, 2.0), (0, 4.0)]
    assert found("どの大きさ？", "ja") == [(1, 2.0)]
    assert found("this box", "ja") == []


def test_tokens_carry_the_moment_of_their_first_letter() -> None:
    assert timed_tokens("so, this one", 2.0, 6.0) == [("so", 2.0), ("this", 4.0), ("one", 6.5)]


def test_the_window_opens_early_enough_for_the_stroke_to_fall_on_the_word() -> None:
    units = library()
    cues = GestureCues.from_tokens(units, [("this", 3.0)])
    lead_s = units.stroke_lead_s(JOY[None])[0]
    assert lead_s.tolist() == pytest.approx([0.5, 0.2])
    assert cues.factors(2.5, lead_s).tolist() == [1.0, 0.0]
    assert cues.factors(2.5).tolist() == [0.0, 0.0]
    assert cues.factors(3.0).tolist() == [1.0, 0.0]
    assert cues.factors(2.6, lead_s).tolist() == [0.0, 0.0]


def test_the_planned_stroke_lands_within_a_tenth_of_a_second_of_its_word() -> None:
    units = library()
    planner = Planner(units)
    cues = GestureCues.from_text(units, "And what would this box be worth to you?", 1.0, 3.0)
    state = planner.start(1, 3)
    strokes: list[tuple[int, float]] = []
    for tick in range(150):
        now = tick / 30.0
        words = cues.factors(now, units.stroke_lead_s(JOY[None])[0])[None]
        state, d = planner.advance(state, PlannerSignal(JOY[None], words, now))
        if d.started[0, 1] and d.duration_s[0, 1] > 0.0:
            strokes.append((int(d.unit[0, 1]), float(d.start_time_s[0, 1] + d.stroke_s[0, 1])))
    assert strokes
    for unit, stroke_s in strokes:
        column = units.gestures.tolist().index(unit)
        assert np.abs(cues.time_s[cues.gesture == column] - stroke_s).min() <= 0.1


def test_silence_calls_nothing() -> None:
    assert GestureCues.silent(library()).factors(0.0).tolist() == [0.0, 0.0]
