"""Damping and springs are exact in dt: many small steps are one large step."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from game.core import springs

VALUES = st.floats(-10, 10, allow_subnormal=False)
HALF_LIVES = st.floats(0.01, 2)


@settings(max_examples=60, deadline=None)
@given(VALUES, VALUES, VALUES, HALF_LIVES, st.floats(0.001, 0.5), st.integers(2, 8))
def test_many_steps_are_one_step(value: float, velocity: float, target: float, half_life: float, dt: float, parts: int):
    start = (np.array(value), np.array(velocity))
    whole = springs.critical_spring(*start, target, half_life, dt)
    split = start
    damped = np.array(value)
    for _ in range(parts):
        split = springs.critical_spring(*split, target, half_life, dt / parts)
        damped = springs.damp(damped, target, half_life, dt / parts)
    np.testing.assert_allclose(split, whole, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(damped, springs.damp(np.array(value), target, half_life, dt), rtol=1e-9, atol=1e-9)


def test_half_life_means_half():
    value = springs.damp(np.array([0.0, 1.0]), np.array([1.0, 3.0]), 0.2, 0.2)
    np.testing.assert_allclose(value, [0.5, 2.0], rtol=1e-6)
    np.testing.assert_allclose(springs.damper_fraction([0.1, 0.2], 0.2), [0.75, 0.5], rtol=1e-6)
    assert springs.damper_fraction(0.0, 0.1) == pytest.approx(1.0)


def test_the_spring_solves_its_equation():
    half_life, target = 0.3, 2.0
    damping = float(springs.half_life_to_damping(half_life))
    solved = solve_ivp(
        lambda _, s: [s[1], -damping * s[1] - (damping**2 / 4) * (s[0] - target)],
        (0, 0.5),
        [0.0, 4.0],
        rtol=1e-10,
        atol=1e-12,
    )
    value, velocity = springs.critical_spring(np.array(0.0), np.array(4.0), target, half_life, 0.5)
    np.testing.assert_allclose([value, velocity], solved.y[:, -1], rtol=1e-6)


def test_a_decaying_offset_starts_where_it_was_and_dies_away():
    offset, velocity = np.array([1.0, -2.0]), np.array([0.0, 1.0])
    same, speed = springs.decay_spring(offset, velocity, 0.1, 0.0)
    np.testing.assert_allclose(same, offset)
    np.testing.assert_allclose(speed, velocity)
    gone, still = springs.decay_spring(offset, velocity, 0.1, 5.0)
    np.testing.assert_allclose([gone, still], 0, atol=1e-9)


def test_a_resting_spring_never_overshoots():
    value, velocity = np.array(1.0), np.array(0.0)
    for _ in range(100):
        value, velocity = springs.critical_spring(value, velocity, 0.0, 0.1, 1 / 30)
        assert value >= -1e-12
