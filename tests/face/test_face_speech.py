"""Lip-sync: vowels of two languages at their moments."""

from __future__ import annotations

import numpy as np
import pytest

from game.core import BadInput
from game.face import VISEMES, viseme_track


def _track(text, language, per_char=0.12):
    moments = [i * per_char for i in range(len(text))]
    return viseme_track(text, language, moments, len(text) * per_char)


def _names(track):
    return [VISEMES[i] for i in track.shape]


def test_japanese_kana_carry_their_vowels():
    assert _names(_track("あいうえお", "ja")) == ["a", "i", "u", "e", "o"]
    assert _names(_track("カキクケコ", "ja")) == ["a", "i", "u", "e", "o"]
    assert _names(_track("さん", "ja")) == ["a", "closed"]


def test_lips_meet_before_m_b_p():
    assert _names(_track("ママ", "ja", 0.3)) == ["closed", "a", "closed", "a"]
    assert "closed" in _names(_track("amber", "en"))


def test_a_long_vowel_goes_on():
    assert _names(_track("おー", "ja")) == ["o", "o"]


def test_english_vowels_in_groups():
    assert _names(_track("good", "en", 0.05)) == ["u"]
    assert _names(_track("see", "en", 0.05)) == ["i"]
    assert _names(_track("no", "en", 0.05)) == ["o"]
    assert _names(_track("take it.", "en", 0.05))[:2] == ["a", "i"]  # the silent e makes no shape


def test_kanji_move_the_mouth_the_same_way_every_time():
    one, two = _track("値段交渉", "ja", 0.3), _track("値段交渉", "ja", 0.3)
    assert one == two
    assert len(one.shape) == 8


def test_shapes_stand_at_their_moments_and_rest_outside():
    track = _track("あい", "ja", 0.2)
    assert VISEMES[int(track.at(0.1).argmax())] == "a"
    assert VISEMES[int(track.at(0.3).argmax())] == "i"
    for outside in (-0.1, 0.41, 9.0):
        assert track.at(outside).sum() == 0.0


def test_fast_text_does_not_flutter_and_pauses_close_the_mouth():
    track = _track("a thousand furious little words about nothing at all", "en", 0.02)
    assert np.diff(track.start_s).min() >= 0.07
    held = viseme_track("あ", "ja", [0.0], 2.0)
    assert VISEMES[int(held.at(1.0).argmax())] == "closed"


def test_empty_and_wrong_input():
    assert _track("", "en").at(0.0).sum() == 0.0
    with pytest.raises(BadInput, match=r"en \| ja"):
        viseme_track("salut", "fr", [0.0] * 5, 1.0)
    with pytest.raises(BadInput, match="5 moments"):
        viseme_track("hello", "en", [0.0], 1.0)
