"""The table of what reading is worth: its figures, their intervals, and what they are held to."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from game.app.autoplay.comparisons import compared
from game.app.autoplay.tally import Tally
from game.app.cli import main

TALKS = 400


def tally(mean: float, spread: float = 0.3) -> Tally:
    """So many talks with a surplus of this mean and standard deviation."""
    total, squares = TALKS * mean, (TALKS - 1) * spread**2 + TALKS * mean**2
    return Tally(talks=TALKS, surplus=total, surplus_squares=squares)


PLAYED = {"random": 0.2, "fixed": 0.45, "words": 0.5, "face": 0.43, "body": 0.65, "reader": 0.7, "oracle": 0.75}


def test_the_figures_are_differences_of_means_with_the_intervals_of_differences() -> None:
    found = {c.name: c for c in compared({name: tally(mean) for name, mean in PLAYED.items()}, mask=0.9)}
    one = 1.96 * 0.3 / math.sqrt(TALKS)
    assert found["oracle − fixed"].value.mean == pytest.approx(0.3)
    assert found["oracle − fixed"].value.half == pytest.approx(math.sqrt(2) * one, rel=1e-3)
    assert found["body − face"].value.mean == pytest.approx(0.22)
    assert found["face − words"].value.mean == pytest.approx(-0.07)
    assert all(c.good for c in found.values())


def test_the_share_of_the_gap_has_the_interval_that_repeating_gives() -> None:
    closed = next(c for c in compared({k: tally(v) for k, v in PLAYED.items()}, 0.9) if c.percent)
    rng = np.random.default_rng(3)
    error = 0.3 / math.sqrt(TALKS)
    low, mid, high = (rng.normal(PLAYED[name], error, 40_000) for name in ("fixed", "reader", "oracle"))
    shares = (mid - low) / (high - low)
    assert closed.value.mean == pytest.approx(0.25 / 0.30)
    assert closed.value.half == pytest.approx(1.96 * shares.std(), rel=0.08)


def test_what_is_not_as_wanted_is_said_and_what_was_not_played_is_left_out() -> None:
    worse = {
        c.name: c for c in compared({k: tally(v) for k, v in {**PLAYED, "reader": 0.55, "face": 0.6}.items()}, 0.9)
    }
    assert not worse["reader closes of that gap"].good
    assert "NOT" in worse["face − words"].text
    assert not worse["reader − body"].good
    plain = {c.name: c for c in compared({k: tally(v) for k, v in {**PLAYED, "face": 0.7}.items()}, 0.15)}
    assert plain["body − face"].good, "where nothing is hidden a face may tell more"
    assert "face − words" not in plain
    assert compared({"fixed": tally(0.4)}, 0.5) == []
    level = {name: tally(0.5) for name in ("fixed", "reader", "oracle")}
    assert not any(c.good for c in compared(level, 0.5) if c.percent), "no gap, nothing closed"


def test_the_command_prints_them_below_its_table_and_into_json(capsys) -> None:
    asked = ["autoplay", "--stall", "toys", "--policy", "random", "--policy", "fixed", "--policy", "oracle"]
    assert main([*asked, "--episodes", "40"]) == 0
    told = capsys.readouterr().out
    assert "oracle − fixed" in told
    assert "reader closes" not in told
    assert main([*asked, "--episodes", "40", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    (figure,) = next(row["compared"] for row in rows if row["policy"] == "oracle")
    assert figure["name"] == "oracle − fixed"
    assert f"{figure['mean']:+.3f} ± {figure['ci95']:.3f}" in told
