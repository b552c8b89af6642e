"""A unit's way through its clip in stretches, and formulas that are the same alone and in company."""

from __future__ import annotations

import numpy as np
import pytest

from game.animation import pace
from game.animation.arithmetic import Curve, arithmetic, columns, numbers

DT = np.float32(1.0 / 30.0)


def timing_of(**rows: float) -> np.ndarray:
    """(10, 1, 1) of a unit with its stroke at 0.5 s and frame 12, played at 33 frames a second, of 60 frames."""
    numbers_ = {"BEFORE_S": 0.5, "LEAD_RATE": 24.0, "AFTER_RATE": 33.0, "LAST": 60.0, "HOLD_LENGTH": 1.0} | rows
    timing = np.zeros((10, 1, 1), dtype=np.float32)
    for name, value in numbers_.items():
        timing[getattr(pace, name)] = value
    return timing


def frame_at(timing: np.ndarray, elapsed_s: float) -> float:
    """The frame by hand: lead, then the rest with its repeats or its slowed middle."""
    row = {n: float(timing[getattr(pace, n)].item()) for n in ("BEFORE_S", "LEAD_RATE", "AFTER_RATE", "HELD")}
    at = min(elapsed_s, row["BEFORE_S"]) * row["LEAD_RATE"]
    at += max(elapsed_s - row["BEFORE_S"], 0.0) * row["AFTER_RATE"]
    frames, times = timing[pace.LOOP_FRAMES].item(), timing[pace.LOOP_TIMES].item()
    if times:
        at -= frames * min(max((at - timing[pace.LOOP_FIRST].item()) // frames, 0.0), times)
    if row["HELD"]:
        share = (at - timing[pace.HOLD_FIRST].item()) / timing[pace.HOLD_LENGTH].item()
        turn = 2.0 * np.pi * min(max(share, 0.0), 1.0)
        at -= row["HELD"] * (turn - np.sin(turn)) / (2.0 * np.pi)
    return at


@pytest.mark.parametrize(
    "timing",
    [
        timing_of(),
        timing_of(LOOP_FIRST=20.0, LOOP_FRAMES=10.0, LOOP_TIMES=3.0),
        timing_of(HOLD_FIRST=22.0, HOLD_LENGTH=40.0, HELD=16.0),
    ],
)
def test_stretches_of_even_pace_are_the_whole_way(timing: np.ndarray) -> None:
    loops = np.full((1, 1, 7), np.inf, dtype=np.float32)
    stretch, elapsed, lap, asked = pace.unknown((1, 1)), np.zeros((1, 1), dtype=np.float32), np.zeros((1, 1)), 0
    for _ in range(300):
        due = elapsed >= stretch.until_s
        if due.any():
            asked += 1
            stretch, lap, ended = pace.next_stretch(stretch, due, due, timing, loops, elapsed, lap)
            if ended.any():
                break
        at = float((elapsed * stretch.rate + stretch.base).item())
        assert at == pytest.approx(frame_at(timing, float(elapsed.item())), abs=2e-3)
        elapsed = elapsed + DT
    assert frame_at(timing, float(elapsed.item())) >= 60.0 - 1e-3, "it ends where the clip ends"
    assert asked < (8 if not timing[pace.HELD].any() else 60), "most ticks need no more than a product and a sum"


def test_a_posture_goes_round_its_loops() -> None:
    timing = timing_of(BEFORE_S=np.inf, LEAD_RATE=30.0, LAST=np.inf)
    loops = np.array([20.0, 14.0, 8.0, 25.0, 17.0, 18.0, 85.0], dtype=np.float32).reshape(1, 1, 7)
    stretch, elapsed, lap = pace.unknown((1, 1)), np.full((1, 1), 2.18, dtype=np.float32), np.zeros((1, 1))
    for _ in range(200):
        due = elapsed >= stretch.until_s
        if due.any():
            stretch, lap, ended = pace.next_stretch(stretch, due, due, timing, loops, elapsed, lap)
            assert not ended.any()
        frame = (elapsed * stretch.rate + stretch.base)[..., None] - stretch.wrapped
        # The end of a loop is its beginning.
        away = np.abs(frame - np.fmod(30.0 * elapsed, loops))
        assert np.minimum(away, loops - away).max() < 1e-3
        assert (frame <= loops + 1e-3).all()
        elapsed = elapsed + DT


def test_numbers_are_the_same_alone_and_in_company() -> None:
    crowd = np.random.default_rng(4).normal(size=(5, 3))
    curve = Curve(np.array([-1.0, 0.0, 0.5]), np.array([2.0, 0.0, 1.0]))

    def formula(some: np.ndarray) -> np.ndarray:
        do = arithmetic(len(some))
        a, b, c = numbers(some)
        found = [do.sin(a) + do.exp(b), do.least(a, do.most(b, c)), do.where(a < b, c, do.hypot(a, b)), 7.0]
        return columns([*found, do.curve(curve, c), do.arctan2(a, b) * do.cos(c)], len(some))

    together = formula(crowd)
    assert together.shape == (5, 6)
    for who in range(5):
        np.testing.assert_allclose(formula(crowd[who : who + 1])[0], together[who], rtol=1e-12, atol=1e-12)
    assert arithmetic(1).any(crowd[0, 0] < 9.0)
    assert not arithmetic(5).any(crowd[:, 0] > 9.0)
