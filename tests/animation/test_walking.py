"""Walking legs under the engine's upper bodies: feet that do not slide, joints that do not break."""

from __future__ import annotations

import numpy as np

from game.animation import Pose
from game.animation.walking import Walk
from game.core.humanoid import REFERENCE

LENGTH_M = 0.7


def standing(n: int) -> Pose:
    rotation = np.zeros((n, len(REFERENCE.names), 4), np.float32)
    rotation[..., 3] = 1.0
    head = REFERENCE.index["head"]
    rotation[:, head] = (0.0, np.sin(0.2), 0.0, np.cos(0.2))
    root = np.tile(REFERENCE.rest_translation[0].astype(np.float32), (n, 1))
    return Pose(rotation, root, np.zeros((n, 2)), np.zeros(n), np.zeros(n))


def stride(n: int = 240, length_m: float = LENGTH_M) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Phases of one cycle and where every joint is in model space, (n, 3) each."""
    phase = np.arange(n) / n
    pose = Walk()(standing(n), phase, np.full(n, length_m), np.ones(n))
    local = np.tile(REFERENCE.rest_translation, (n, 1, 1))
    local[:, 0] = pose.root
    shift, _ = REFERENCE.to_model(pose.rotation, local)
    return phase, {name: shift[:, i] for i, name in enumerate(REFERENCE.names)}


def test_a_foot_on_the_ground_stays_where_it_is_while_the_body_goes_on() -> None:
    phase, joints = stride()
    ground = joints["leftFoot"][:, 2] + phase * LENGTH_M
    flat = (phase > 0.05) & (phase < 0.42)
    assert np.ptp(ground[flat]) < 0.02, "metres of slide"
    assert np.ptp(joints["leftFoot"][flat, 1]) < 0.015


def test_feet_clear_the_ground_when_they_swing_and_never_sink_into_it() -> None:
    phase, joints = stride()
    rest_y = REFERENCE.rest_model[REFERENCE.index["leftFoot"], 1, 3]
    height = joints["leftFoot"][:, 1] - rest_y
    assert height.min() > -0.012
    assert height[(phase > 0.7) & (phase < 0.9)].min() > 0.03


def test_left_and_right_take_turns_and_arms_swing_against_the_legs() -> None:
    _, joints = stride()
    np.testing.assert_allclose(joints["leftFoot"][:, 2], np.roll(joints["rightFoot"][:, 2], 120), atol=0.02)
    assert np.corrcoef(joints["leftHand"][:, 2], joints["leftFoot"][:, 2])[0, 1] < -0.5
    assert (joints["leftHand"][:, 1] < joints["chest"][:, 1]).all(), "arms hang"


def test_bones_keep_their_lengths_and_nothing_jumps() -> None:
    _, joints = stride()
    for a, b in (("leftUpperLeg", "leftLowerLeg"), ("leftLowerLeg", "leftFoot")):
        assert np.ptp(np.linalg.norm(joints[a] - joints[b], axis=1)) < 1e-5
    for name in ("leftFoot", "rightLowerLeg", "hips", "leftHand"):
        step = np.linalg.norm(np.diff(joints[name], axis=0, append=joints[name][:1]), axis=1)
        assert step.max() < 0.022, name


def test_the_upper_body_keeps_what_the_units_do_and_standing_keeps_everything() -> None:
    pose, walk = standing(3), Walk()
    still = walk(pose, np.zeros(3), np.zeros(3), np.zeros(3))
    np.testing.assert_allclose(still.rotation, pose.rotation, atol=1e-6)
    np.testing.assert_allclose(still.root, pose.root, atol=1e-6)
    moving = walk(pose, np.array([0.1, 0.4, 0.8]), np.full(3, LENGTH_M), np.ones(3))
    for name in ("head", "neck", "leftIndexProximal"):
        joint = REFERENCE.index[name]
        np.testing.assert_allclose(moving.rotation[:, joint], pose.rotation[:, joint], atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(moving.rotation, axis=-1), 1.0, atol=1e-5)


def test_a_shorter_step_lifts_less() -> None:
    rest_y = REFERENCE.rest_model[REFERENCE.index["leftFoot"], 1, 3]
    high, low = (stride(length_m=length_m)[1]["leftFoot"][:, 1].max() - rest_y for length_m in (LENGTH_M, 0.1))
    assert low < 0.4 * high
