"""Every EMBOS formula against independent vectors; MCG_CONFORMANCE names another file of the same form."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from game.core import EMOTIONS, with_neutral
from game.embos import MotionUnit, Planner, PlannerConfig, PlannerSignal, UnitLibrary, mixing, scores, statistics
from tests.embos import plain_scores

VECTORS: dict[str, Any] = json.loads(
    Path(os.environ.get("MCG_CONFORMANCE") or Path(__file__).parents[1] / "data" / "formulae.json").read_text("utf-8")
)


def seven(values: dict[str, float]) -> np.ndarray:
    return np.array([values.get(name, 0.0) for name in EMOTIONS], dtype=np.float64)


def cases(name: str) -> list[Any]:
    return [pytest.param(case, id=f"{name}{i}") for i, case in enumerate(VECTORS[name])]


def test_order_of_emotions() -> None:
    assert tuple(VECTORS["emotions"]) == EMOTIONS


@pytest.mark.parametrize("case", cases("neutral"))
def test_neutral_eq4(case: dict[str, Any]) -> None:
    np.testing.assert_allclose(with_neutral(case["six"])[6], case["neutral"], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("case", cases("intensity"))
def test_intensity_eq2(case: dict[str, Any]) -> None:
    amount = np.array([seven(row) for row in case["amount"].values()])
    wanted = np.array([seven(case["intensity"][name]) for name in case["amount"]])
    np.testing.assert_allclose(statistics.intensity(amount, case["alpha"]), wanted, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("case", cases("timing"))
def test_timing_eq3(case: dict[str, Any]) -> None:
    lengths = [end - start for start, end in case["spans"]]
    np.testing.assert_allclose(statistics.duration(lengths), case["mean_duration"], rtol=1e-9)
    np.testing.assert_allclose(
        statistics.waiting(lengths, case["annotated_length"]), case["waiting"], rtol=1e-9, atol=1e-12
    )


@pytest.mark.parametrize("case", cases("rbf"))
def test_mixing_eq5(case: dict[str, Any]) -> None:
    exists = np.array([name in case["values"] for name in EMOTIONS])
    weights = mixing.mix_weights(seven(case["character"]), seven(case["unit_intensity"]), exists, case["r"])
    np.testing.assert_allclose(mixing.mix(seven(case["values"]), weights), case["mixed"], rtol=1e-9)


@pytest.mark.parametrize("case", cases("phi_time"))
def test_phi_time(case: dict[str, Any]) -> None:
    started = -np.inf if case["started"] is None else case["started"]
    minimum = case.get("minimum", 0.02)
    phi = plain_scores.phi_time(case["t"], started, case["L_d"], case["L_w"], minimum=minimum)
    np.testing.assert_allclose(phi, case["phi"], rtol=1e-9)


def planned_phi_state(character: np.ndarray, intensity: np.ndarray) -> np.ndarray:
    """φ_state as the planner works it out, wherever a unit was seen."""
    shown = np.ones(7)
    units = [MotionUnit(f"p{i}", "posture", row, shown, shown) for i, row in enumerate(intensity)]
    planner = Planner(UnitLibrary(units), PlannerConfig(presence=0.0))
    state, _ = planner.advance(planner.start(1, 1), PlannerSignal(np.array([character]), np.zeros((1, 0)), 0.0))
    return state.phi_state[0, : len(units)]


@pytest.mark.parametrize("case", cases("phi_state"))
def test_phi_state(case: dict[str, Any]) -> None:
    units = np.array(case["units"], dtype=np.float64)
    np.testing.assert_allclose(planned_phi_state(case["character"], units), case["phi"], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(plain_scores.phi_state(case["character"], units), case["phi"], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("case", cases("linkage"))
def test_linkage(case: dict[str, Any]) -> None:
    a, b = case["a"], case["b"]
    assert scores.linkage(set(a["uses"]), set(a["locks"]), set(b["uses"]), set(b["locks"])) == case["linkage"]


SIX = hnp.arrays(np.float64, 6, elements=st.floats(0, 1, allow_subnormal=False))
UNITS = hnp.arrays(np.float64, (5, 7), elements=st.floats(0, 1, allow_subnormal=False))


@given(SIX, UNITS)
@settings(max_examples=60, deadline=None)
def test_phi_state_stays_in_its_range_and_prefers_the_nearest(six: np.ndarray, units: np.ndarray) -> None:
    character = with_neutral(six)
    phi = planned_phi_state(character, units)
    d = [plain_scores.difference(character, unit) for unit in units]
    assert phi.min() >= 0.0
    assert phi.max() <= 1.0
    assert phi.max() == pytest.approx(phi[np.argmin(d)])


@given(SIX, SIX, st.lists(st.booleans(), min_size=7, max_size=7))
@settings(max_examples=60, deadline=None)
def test_mixing_weights_are_shares_of_what_exists(six: np.ndarray, unit: np.ndarray, exists: list[bool]) -> None:
    weights = mixing.mix_weights(with_neutral(six), with_neutral(unit), np.array(exists))
    assert weights[~np.array(exists)].sum() == 0.0
    assert weights.sum() == pytest.approx(1.0 if any(exists) else 0.0)


@given(hnp.arrays(np.float64, (4, 4), elements=st.integers(0, 9)), st.floats(0.01, 9.0))
@settings(max_examples=40, deadline=None)
def test_continuity_stays_between_its_floor_and_one(counts: np.ndarray, distance: float) -> None:
    omega = scores.continuity(counts, np.full((4, 4), distance), floor=0.1, transition_share=0.5, sigma=0.4)
    assert np.all(omega >= 0.1)
    assert np.all(omega <= 1.0)
    assert np.all(np.diag(omega) == 1.0)


def test_far_away_emotions_do_not_divide_by_zero() -> None:
    anger = with_neutral([1.0, 0, 0, 0, 0, 0])
    exists = np.zeros(7, dtype=bool)
    exists[2] = True
    weights = mixing.mix_weights(anger, np.eye(7)[2], exists, radius=0.01)
    assert weights.tolist() == [0, 0, 1, 0, 0, 0, 0]


def test_intensity_ignores_behaviours_an_emotion_never_showed() -> None:
    amount = np.zeros((3, 7))
    amount[0, 0], amount[1, 0], amount[1, 2] = 30, 10, 90
    value = statistics.intensity(amount)
    assert value[2].tolist() == [0.0] * 7
    assert value[0, 0] == 1.0
    assert value[1, 2] == 1.0
    assert 0.0 < value[1, 0] < 1.0


def test_spread_is_relative_to_each_emotions_own_mean() -> None:
    assert statistics.spread([[2.0, 2.0], [6.0, 6.0]]) == 0.0
    assert statistics.spread([[1.0], [5.0]]) == 0.0
    assert statistics.spread([[1.0, 3.0]]) == pytest.approx(0.5**0.5)
