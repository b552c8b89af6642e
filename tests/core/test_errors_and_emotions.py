"""The error tree's one line, and the emotion space (eq. 4)."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from game.core import (
    EMOTION_INDEX,
    EMOTIONS,
    SIX,
    BadInput,
    GameError,
    MissingPart,
    Where,
    emotion_vector,
    parse_emotion,
    with_neutral,
)

VECTORS: dict[str, Any] = json.loads(
    Path(os.environ.get("MCG_CONFORMANCE") or Path(__file__).parents[1] / "data" / "formulae.json").read_text("utf-8")
)


@pytest.mark.parametrize(
    ("where", "text"),
    [
        (Where("a.yaml", 3, 7), "a.yaml:3:7"),
        (Where("a.yaml", 3), "a.yaml:3"),
        (Where("a.glb", byte=0), "a.glb@0"),
        (Where("a.gltf", pointer="/nodes/0"), "a.gltf:/nodes/0"),
        (Where("a.gltf", pointer=""), "a.gltf:/"),
        (Where(Path("x") / "y"), "x/y"),
    ],
)
def test_places(where: Where, text: str):
    assert str(where) == text
    assert where == Where(text)
    assert hash(where) == hash(Where(text))
    assert where != text


def test_bad_input_is_one_line_with_everything_in_it():
    error = BadInput("line\none", where=Where("f", 1, 2), expected="a number", seen="x\ny", hint="like 3")
    assert str(error) == "f:1:2: line one: expected a number but saw 'x\\ny' (like 3)"
    assert (error.expected, error.seen, error.hint) == ("a number", "x\ny", "like 3")
    assert str(BadInput(expected="a number", seen=None)) == "expected a number but saw None"
    assert len(str(BadInput(expected="less", seen="y" * 10_000))) < 120
    assert isinstance(error, GameError)
    assert issubclass(MissingPart, GameError)


@pytest.mark.parametrize("case", VECTORS["neutral"], ids=range(len(VECTORS["neutral"])))
def test_neutral_follows_eq_4(case: dict[str, Any]):
    seven = with_neutral(case["six"])
    np.testing.assert_array_equal(seven[:6], case["six"])
    np.testing.assert_allclose(seven[6], case["neutral"], rtol=1e-9, atol=1e-15)


@given(hnp.arrays(np.float64, (4, 6), elements=st.floats(0, 1)))
def test_the_seven_never_sum_below_one(six: np.ndarray):
    seven = with_neutral(six)
    assert seven.shape == (4, 7)
    assert (seven.sum(axis=-1) >= 1 - 1e-12).all()
    assert ((seven >= 0) & (seven <= 1)).all()


def test_the_order_is_the_papers():
    assert tuple(VECTORS["emotions"]) == EMOTIONS
    assert (*SIX, "neutral") == EMOTIONS
    assert [EMOTION_INDEX[name] for name in EMOTIONS] == list(range(7))


def test_emotions_by_name_and_from_the_command_line():
    np.testing.assert_allclose(emotion_vector({"joy": 0.25, "neutral": 1.0}), [0, 0, 0.25, 0, 0, 0, 0.75])
    np.testing.assert_allclose(parse_emotion("joy=0.8, fear = .1"), [0, 0.1, 0.8, 0, 0, 0, 0.1], atol=1e-12)
    np.testing.assert_allclose(parse_emotion("anger"), [1, 0, 0, 0, 0, 0, 0])
    np.testing.assert_allclose(parse_emotion("neutral"), [0, 0, 0, 0, 0, 0, 1])


@pytest.mark.parametrize(
    "text", ["", "joy=", "joy=x", "joy=1.1", "joy=-0.1", "joy=nan", "joy=inf", "delight=1", "joy=1=2", ",", "joy=0.5,"]
)
def test_broken_emotions_are_refused(text: str):
    with pytest.raises(BadInput) as caught:
        parse_emotion(text)
    assert "\n" not in str(caught.value)
