"""Quaternion mathematics against SciPy's rotations."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.spatial.transform import Rotation

from game.core import quaternion as quat

ORDERS = ["".join(order) for order in itertools.permutations("XYZ")]
VECTORS = hnp.arrays(np.float64, (3,), elements=st.floats(-3, 3, allow_subnormal=False))


def some(count: int, seed: int = 1) -> np.ndarray:
    return Rotation.random(count, random_state=seed).as_quat()


def same_rotation(a: np.ndarray, b: np.ndarray, atol: float = 1e-9) -> None:
    np.testing.assert_allclose(quat.align(a, b), b, atol=atol)


def test_products_and_rotations_agree_with_scipy():
    a, b = some(50, 1), some(50, 2)
    same_rotation(quat.multiply(a, b), (Rotation.from_quat(a) * Rotation.from_quat(b)).as_quat())
    v = np.random.default_rng(3).normal(size=(50, 3))
    np.testing.assert_allclose(quat.rotate(a, v), Rotation.from_quat(a).apply(v), atol=1e-12)
    np.testing.assert_allclose(quat.rotate(quat.conjugate(a), quat.rotate(a, v)), v, atol=1e-12)


def test_broadcasting_over_leading_axes():
    a = some(12).reshape(3, 4, 4)
    b = some(4, 2)
    whole = quat.multiply(a, b)
    assert whole.shape == (3, 4, 4)
    np.testing.assert_allclose(whole[2, 1], quat.multiply(a[2, 1], b[1]))
    assert quat.rotate(a, np.ones(3)).shape == (3, 4, 3)


def test_matrices_both_ways():
    q = some(200)
    np.testing.assert_allclose(quat.to_matrix(q), Rotation.from_quat(q).as_matrix(), atol=1e-12)
    same_rotation(quat.from_matrix(quat.to_matrix(q)), q)
    assert (quat.from_matrix(quat.to_matrix(q))[:, 3] >= 0).all()


@pytest.mark.parametrize("axis", np.vstack([np.eye(3), -np.eye(3)]))
def test_half_turns_survive_the_matrix(axis: np.ndarray):
    q = quat.from_axis_angle(axis, np.pi)
    np.testing.assert_allclose(quat.to_matrix(quat.from_matrix(quat.to_matrix(q))), quat.to_matrix(q), atol=1e-9)


@pytest.mark.parametrize("order", ORDERS)
def test_euler_angles_are_intrinsic_left_to_right(order: str):
    angles = np.random.default_rng(5).uniform(-np.pi, np.pi, (100, 3))
    q = quat.from_euler(order, angles)
    # SciPy writes intrinsic rotations in capitals.
    same_rotation(q, Rotation.from_euler(order, angles).as_quat())
    same_rotation(quat.from_euler(order, quat.to_euler(order, q)), q)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("middle", [np.pi / 2, -np.pi / 2])
def test_gimbal_lock_keeps_the_rotation(order: str, middle: float):
    q = quat.from_euler(order, [0.7, middle, -0.4])
    same_rotation(quat.from_euler(order, quat.to_euler(order, q)), q, atol=1e-6)


def test_euler_with_other_than_three_angles():
    same_rotation(quat.from_euler("Z", [[0.3]])[0], quat.from_axis_angle([0, 0, 1], 0.3))
    same_rotation(quat.from_euler("ZXZ", [0.3, 0.5, 0.7]), Rotation.from_euler("ZXZ", [0.3, 0.5, 0.7]).as_quat())


@settings(max_examples=100, deadline=None)
@given(VECTORS)
def test_exp_and_log_are_inverse(vector: np.ndarray):
    q = quat.exp(vector)
    np.testing.assert_allclose(np.linalg.norm(q), 1.0, atol=1e-12)
    same_rotation(q, Rotation.from_rotvec(vector).as_quat())
    same_rotation(quat.exp(quat.log(q)), q)
    assert np.linalg.norm(quat.log(q)) <= np.pi + 1e-9


def test_small_angles_lose_nothing():
    tiny = np.array([[1e-12, 0, 0], [0, -1e-9, 0], [0, 0, 0]])
    np.testing.assert_allclose(quat.log(quat.exp(tiny)), tiny, rtol=1e-6)


def test_slerp_has_constant_speed_and_takes_the_short_way():
    a, b = some(20, 1), some(20, 2)
    for t in (0.0, 0.25, 1.0):
        between = quat.slerp(a, b, np.full(20, t))
        angle = np.linalg.norm(quat.log(quat.multiply(quat.conjugate(a), b)), axis=-1)
        part = np.linalg.norm(quat.log(quat.multiply(quat.conjugate(a), between)), axis=-1)
        np.testing.assert_allclose(part, t * angle, atol=1e-7)
    same_rotation(quat.slerp(a, -b, 0.3), quat.slerp(a, b, 0.3))
    same_rotation(quat.nlerp(a, -b, 0.5), quat.slerp(a, b, 0.5))
    np.testing.assert_allclose(np.linalg.norm(quat.nlerp(a, b, 0.3), axis=-1), 1.0)


def test_normalize_gives_the_identity_for_nothing():
    np.testing.assert_allclose(quat.normalize([[0, 0, 0, 0], [0, 0, 0, 5]]), [[0, 0, 0, 1], [0, 0, 0, 1]])


def test_between_turns_one_direction_to_the_other_even_when_opposite():
    rng = np.random.default_rng(8)
    a, b = rng.normal(size=(2, 30, 3))
    b[:3] = -a[:3]
    b[3] = a[3]
    turned = quat.rotate(quat.between(a, b), a / np.linalg.norm(a, axis=-1, keepdims=True))
    np.testing.assert_allclose(turned, b / np.linalg.norm(b, axis=-1, keepdims=True), atol=1e-6)


def test_single_precision_stays_single():
    q = some(3).astype(np.float32)
    for result in (quat.multiply(q, q), quat.rotate(q, q[:, :3]), quat.normalize(q), quat.to_matrix(q)):
        assert result.dtype == np.float32
