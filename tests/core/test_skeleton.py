"""Skeletons, the reference humanoid and clips."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from game.core import BadInput, Clip, Skeleton
from game.core import quaternion as quat
from game.core.humanoid import BODY_PARTS, PART_JOINTS, REFERENCE, mirrored_name

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])


def chain() -> Skeleton:
    offsets = np.array([[0, 1, 0], [1, 0, 0], [1, 0, 0], [0, 0, 2]], float)
    return Skeleton(("root", "a", "b", "side"), np.array([-1, 0, 1, 0]), offsets, np.tile(IDENTITY, (4, 1)))


def test_forward_kinematics_against_a_plain_loop():
    skeleton = REFERENCE
    rng = np.random.default_rng(2)
    local = Rotation.random(len(skeleton) * 3, random_state=4).as_quat().reshape(3, -1, 4)
    shift = skeleton.rest_translation + rng.normal(0, 0.01, (3, len(skeleton), 3))
    positions, rotations = skeleton.to_model(local, shift)
    for frame in range(3):
        turned: list[Rotation] = []
        placed: list[np.ndarray] = []
        for joint, parent in enumerate(skeleton.parents):
            own = Rotation.from_quat(local[frame, joint])
            turned.append(own if parent < 0 else turned[parent] * own)
            placed.append(
                shift[frame, joint] if parent < 0 else placed[parent] + turned[parent].apply(shift[frame, joint])
            )
        np.testing.assert_allclose(positions[frame], placed, atol=1e-12)
        np.testing.assert_allclose(quat.to_matrix(rotations[frame]), [r.as_matrix() for r in turned], atol=1e-12)


def test_local_and_model_rotations_are_inverse():
    local = Rotation.random(2 * len(REFERENCE), random_state=1).as_quat().reshape(2, -1, 4)
    _, model = REFERENCE.to_model(local)
    again = REFERENCE.to_local(model)
    np.testing.assert_allclose(quat.align(again, local), local, atol=1e-9)


def test_rest_pose_matrices():
    matrices = chain().rest_model
    np.testing.assert_allclose(matrices[:, :3, 3], [[0, 1, 0], [1, 1, 0], [2, 1, 0], [0, 1, 2]])
    assert not matrices.flags.writeable
    assert [level.tolist() for level in chain().levels] == [[0], [1, 3], [2]]
    assert chain().index == {"root": 0, "a": 1, "b": 2, "side": 3}


@pytest.mark.parametrize(
    ("names", "parents", "message"),
    [
        ((), [], "at least one joint"),
        (("a", "a"), [-1, 0], "unique joint names"),
        (("a", "b"), [1, -1], "every parent before"),
        (("a", "b"), [-1, 1], "every parent before"),
        (("a", "b"), [-1, -2], "every parent before"),
        (("a", "b"), [-1], "arrays for 2 joints"),
    ],
)
def test_broken_hierarchies(names: tuple[str, ...], parents: list[int], message: str):
    count = len(names)
    with pytest.raises(BadInput, match=message):
        Skeleton(names, np.array(parents, dtype=int), np.zeros((count, 3)), np.tile(IDENTITY, (count, 1)))


def test_a_rest_pose_must_be_finite():
    with pytest.raises(BadInput, match="finite rest pose"):
        Skeleton(("a",), np.array([-1]), np.array([[np.nan, 0, 0]]), IDENTITY[None])


def test_the_reference_is_a_t_pose_that_faces_plus_z():
    position = dict(zip(REFERENCE.names, REFERENCE.rest_model[:, :3, 3], strict=True))
    assert len(REFERENCE) == 41
    np.testing.assert_allclose(REFERENCE.rest_rotation, np.tile(IDENTITY, (41, 1)))
    for joint in ("leftUpperArm", "leftLowerArm", "leftHand"):
        assert position[joint][1] == position["leftUpperArm"][1]
    assert position["leftHand"][0] > position["leftLowerArm"][0] > 0
    assert position["leftThumbProximal"][2] > position["leftHand"][2]
    assert position["leftToes"][2] > position["leftFoot"][2]
    assert 1.0 < position["head"][1] < 1.4


def test_the_reference_is_symmetric():
    for name in REFERENCE.names:
        here = REFERENCE.rest_model[REFERENCE.index[name], :3, 3]
        there = REFERENCE.rest_model[REFERENCE.index[mirrored_name(name)], :3, 3]
        np.testing.assert_allclose(there, here * [-1, 1, 1], atol=1e-12)
        assert mirrored_name(mirrored_name(name)) == name


def test_body_parts_share_out_all_joints():
    assert tuple(PART_JOINTS) == BODY_PARTS
    joints = [joint for part in BODY_PARTS for joint in PART_JOINTS[part]]
    assert sorted(joints) == sorted(REFERENCE.names)
    assert len(PART_JOINTS["left_hand"]) == len(PART_JOINTS["right_hand"]) == 10


def two_frames() -> Clip:
    turn = quat.from_axis_angle([0, 0, 1], np.array([0.0, np.pi / 2]))
    rotation = np.tile(IDENTITY, (2, 4, 1))
    rotation[:, 0] = turn
    translation = np.tile(chain().rest_translation, (2, 1, 1))
    translation[1, 0] = (0, 3, 0)
    return Clip(chain(), 0.5, rotation, translation)


def test_sampling_between_frames_and_beyond_the_ends():
    clip = two_frames()
    assert clip.length_s == 1.0
    rotation, translation = clip.sample(np.array([-1.0, 0.0, 0.25, 0.5, 9.0]))
    np.testing.assert_allclose(translation[:, 0, 1], [1, 1, 2, 3, 3])
    angle = 2 * np.arctan2(rotation[:, 0, 2], rotation[:, 0, 3])
    np.testing.assert_allclose(angle, [0, 0, np.pi / 4, np.pi / 2, np.pi / 2], atol=1e-9)
    single, _ = clip.sample(np.array(0.25))
    assert single.shape == (4, 4)


def test_a_clip_of_one_frame_can_be_sampled():
    clip = Clip(chain(), 0.1, np.tile(IDENTITY, (1, 4, 1)), chain().rest_translation[None].copy())
    rotation, _ = clip.sample(np.array([0.0, 5.0]))
    np.testing.assert_allclose(rotation, np.tile(IDENTITY, (2, 4, 1)))


def test_clips_are_read_only_and_checked():
    clip = two_frames()
    with pytest.raises(ValueError, match="read-only"):
        clip.rotation[0, 0, 0] = 1
    with pytest.raises(BadInput, match="rotations"):
        Clip(chain(), 0.1, np.zeros((2, 3, 4)), np.zeros((2, 4, 3)))
    for frame_time_s in (0.0, -1.0, float("nan"), float("inf")):
        with pytest.raises(BadInput, match="frame time above 0"):
            Clip(chain(), frame_time_s, np.zeros((2, 4, 4)), np.zeros((2, 4, 3)))
