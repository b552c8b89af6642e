"""Timed text: characters in order, pauses at punctuation, words and gesture words at their moments, rows that fit."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from game.core.errors import BadInput
from game.story import TimedText, wrap
from game.story.text import ROW_CHARS, fill, slots


def test_speed_and_pauses():
    plain = TimedText("aaaa", "en", 10)
    assert plain.char_s == (0.0, 0.1, 0.2, 0.3)
    assert plain.length_s == pytest.approx(0.4)
    assert TimedText("aa, aa", "en", 10).length_s == pytest.approx(0.6 + 0.4)
    # A run of marks pauses once, and a comma inside a number not at all.
    assert TimedText("a?!", "en", 10).length_s == pytest.approx(0.3 + 0.8)
    assert TimedText("1,200", "en", 10).length_s == pytest.approx(0.5)
    assert TimedText("茶。", "ja", 10).length_s == pytest.approx(0.2 + 0.45)
    assert TimedText("x" * 30, "en").length_s == pytest.approx(1.0)
    assert TimedText("茶" * 13, "ja").length_s == pytest.approx(1.0)
    assert TimedText("", "en").length_s == 0.0


def test_visible_grows_from_nothing_to_all():
    text = TimedText("Oh — hello! Sorry.", "en")
    assert text.visible(-1) == 0
    assert text.visible(0) == 1
    assert text.visible(text.length_s) == len(text.text)
    shown = [text.visible(i * 0.01) for i in range(200)]
    assert shown == sorted(shown)


def test_english_words_with_times():
    words = TimedText("Don't — this one’s big.", "en", 10).words
    assert [word.text for word in words] == ["don't", "this", "one’s", "big"]
    assert words[0].start_s == 0
    assert all(a.end_s <= b.start_s for a, b in itertools.pairwise(words))
    assert TimedText("これは茶。", "ja").words[2].text == "は"


def test_cues_find_whole_english_words_and_phrases_longest_first():
    text = TimedText("This one isn't thistle. Take a look: that, THAT!", "en")
    found = [cue.text for cue in text.cues(["this", "this one", "that", "take a look", "look", "don't"])]
    assert found == ["this one", "take a look", "that", "that"]
    assert TimedText("Don’t!", "en").cues(["don't"])[0].text == "don't"
    assert text.cues([]) == ()


def test_cues_find_japanese_anywhere():
    text = TimedText("これ、こんなに大きいの。これも。", "ja", 10)
    cues = text.cues(["これ", "大きい", "こ", "大きいの"])
    assert [cue.text for cue in cues] == ["これ", "こ", "大きいの", "これ"]
    assert cues[0].start_s == 0
    assert cues[2].start_s == text.char_s[7]


def test_bad_arguments():
    with pytest.raises(BadInput, match="language"):
        TimedText("a", "fr")
    with pytest.raises(BadInput, match="speed"):
        TimedText("a", "en", 0)


def test_wrapping():
    rows = wrap("Please don't fold the blue vase, it has never liked being folded.", "en")
    assert rows == ("Please don't fold the blue vase, it", "has never liked being folded.")
    assert wrap("one\ntwo", "en") == ("one", "two")
    rows = wrap("これはおばあちゃんが毎朝使っていた急須なんです、はい。2,400円です。", "ja")
    assert all(len(row) <= 22 for row in rows)
    assert not any(row[0] in "、。っゃゅょー」" for row in rows)
    assert "2,400円" in "".join(rows)


@settings(max_examples=150, deadline=None)
@given(st.text(max_size=120), st.sampled_from(["en", "ja"]))
def test_any_text_wraps_without_losing_a_letter(text, language):
    rows = wrap(text, language)
    assert "".join("".join(rows).split()) == "".join(text.split())
    if language == "ja":
        assert all(len(row) <= ROW_CHARS["ja"] for row in rows)


@settings(max_examples=150, deadline=None)
@given(st.text(max_size=60), st.sampled_from(["en", "ja"]), st.lists(st.text(max_size=4), max_size=5))
def test_any_text_can_be_timed(text, language, vocabulary):
    timed = TimedText(text, language)
    assert len(timed.char_s) == len(text)
    assert list(timed.char_s) == sorted(timed.char_s)
    cues = timed.cues(vocabulary)
    assert all(0 <= cue.start_s <= cue.end_s <= timed.length_s + 1e-9 for cue in cues)
    assert all(a.index < b.index for a, b in itertools.pairwise(cues))


@settings(max_examples=200, deadline=None)
@given(st.text(alphabet="{}ab_offer.!:0[]", max_size=30))
def test_filling_in_is_only_filling_in(text):
    filled = fill(text, {"offer": "{a}", "a": "X"}.get)
    assert fill("no braces", lambda _: "X") == "no braces"
    assert text == filled or any(name in {"offer", "a"} for name, _ in slots(text))


def test_names_in_braces():
    assert fill("{offer}!", {"offer": "{ask}", "ask": "no"}.get) == "{ask}!"
    assert fill("{offer.__class__} {0} {x!r} {unknown}", {"offer": "1"}.get) == "{offer.__class__} {0} {x!r} {unknown}"
    assert slots("a {b} {c") == [("b", 2), ("{", 6)]
