"""The observer: what it may see, how it describes movement, and that it can tell the takes apart."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from game.animation import Performer
from game.app.loading import load_planner
from game.core import ASSETS, EMOTIONS, Clip
from game.core import quaternion as quat
from game.core.humanoid import REFERENCE, mirrored_name
from game.formats import read_bvh
from game.tools.observer import (
    POINT,
    POINTS,
    SETS,
    Observer,
    Training,
    describe,
    keypoints,
    keypoints_of_clip,
    play_scenes,
    read_set,
    score_of,
    score_scenes,
    training_windows,
    windows,
)
from game.tools.observer.keypoints import mirrored
from game.tools.observer.scoring import wilson


@pytest.fixture(scope="module")
def training() -> Training:
    takes = {k: read_bvh(ASSETS / "motion" / "takes" / f"{e}.bvh").clip for k, e in enumerate(EMOTIONS)}
    last = 1800
    short = {
        k: Clip(c.skeleton, c.frame_time_s, c.rotation[:last].copy(), c.translation[:last].copy())
        for k, c in takes.items()
    }
    return training_windows(short, copies=1, step_s=3.0, stretches=3)


def test_points_are_joints_in_the_world() -> None:
    rest = keypoints(np.tile(quat.IDENTITY, (2, len(REFERENCE), 1)), np.tile(REFERENCE.rest_translation[0], (2, 1)))
    assert rest.shape == (2, len(POINTS), 3)
    wrist = REFERENCE.rest_model[REFERENCE.index["leftHand"], :3, 3]
    np.testing.assert_allclose(rest[0, POINT["left_wrist"]], wrist, atol=1e-6)
    assert rest[0, POINT["crown"], 1] > rest[0, POINT["nose"], 1] > rest[0, POINT["neck"], 1]
    assert rest[0, POINT["nose"], 2] > rest[0, POINT["head"], 2] + 0.1


def test_the_order_of_a_clips_joints_does_not_matter() -> None:
    clip = read_bvh(ASSETS / "motion" / "takes" / "neutral.bvh").clip
    points = keypoints_of_clip(clip)
    position, _ = clip.to_model(slice(0, 1))
    for point, joint in (("hips", "hips"), ("right_elbow", "rightLowerArm"), ("chest", "chest")):
        np.testing.assert_allclose(points[0, POINT[point]], position[0, clip.skeleton.index[joint]], atol=1e-5)


def test_a_mirror_image_is_described_alike() -> None:
    rng = np.random.default_rng(3)
    assert mirrored_name("leftHand") == "rightHand"
    points = rng.normal(0.0, 0.02, (1, 60, len(POINTS), 3)).cumsum(axis=1).astype(np.float32) * 0.1
    np.testing.assert_allclose(mirrored(mirrored(points)), points)
    one, other = describe(points)[0], describe(mirrored(points))[0]
    assert np.abs(one - other).max() < 1e-4 * np.abs(one).max()


def test_description_knows_speed_and_rhythm() -> None:
    still = np.tile(np.arange(len(POINTS), dtype=np.float32)[None, :, None] * 0.05, (240, 1, 3))
    t = np.arange(240) / 30.0
    slow, fast = still.copy(), still.copy()
    for points, hz in ((slow, 0.5), (fast, 3.0)):
        points[:, POINT["right_wrist"], 1] += (0.05 * np.sin(2 * np.pi * hz * t)).astype(np.float32)
    seen = describe(np.stack([still, slow, fast]))
    assert np.isfinite(seen).all()
    differs = np.abs(seen[1] - seen[2]) > 0.5
    assert 5 < differs.sum() < 0.3 * seen.shape[1]


def test_windows_lie_side_by_side_and_short_takes_make_one() -> None:
    points = np.zeros((500, len(POINTS), 3), dtype=np.float32)
    assert windows(points).shape == (2, 240, len(POINTS), 3)
    assert windows(points, step_s=2.0).shape[0] == 5
    assert windows(points[:100]).shape == (1, 100, len(POINTS), 3)


def test_feelings_are_told_from_stretches_that_were_not_learnt(training: Training) -> None:
    assert Observer.left_out(training) > 0.8


def test_bodies_tell_and_bodies_held_still_do_not(training: Training) -> None:
    observer = Observer(training)
    planner = load_planner()
    performer = Performer(planner.library, layers=planner.tables.layers, radius=planner.config.radius)
    share = {
        mode: score_scenes(observer, play_scenes(planner, performer, mode, 400, 1, 16.0)).share
        for mode in ("body", "face")
    }
    assert share["body"] > 0.7
    assert share["face"] < 0.4


def test_scores() -> None:
    felt, named = np.array([0, 0, 1, 1, 6]), np.array([0, 1, 1, 1, 6])
    score = score_of(felt, named, cases=3)
    assert score.confusion[0].tolist() == [1, 1, 0, 0, 0, 0, 0]
    assert score.share == pytest.approx((0.5 + 1.0 + 1.0) / 3)
    assert score.among == (0, 1, 6)
    assert score.row()["chance"] == pytest.approx(1 / 7, abs=1e-3)
    low, high = wilson(0.5, 100)
    assert (low, high) == (pytest.approx(0.4038, abs=1e-3), pytest.approx(0.5962, abs=1e-3))
    assert wilson(1.0, 10)[0] < 0.75


def test_foreign_styles_are_read_by_their_names(shared_data: Path, tmp_path: Path) -> None:
    source = shared_data / "bandai1"
    if not source.is_dir():
        pytest.skip("bandai1 is not among the shared files")
    folder = tmp_path / "bandai1"
    folder.mkdir()
    for name in ("dataset-1_bow_angry_001.bvh", "dataset-1_bow_old_001.bvh"):
        (folder / name).symlink_to(source / name)
    foreign = read_set(tmp_path, SETS["bandai1"])
    assert foreign is not None
    assert foreign.emotion.tolist() == [EMOTIONS.index("anger"), -1]
    assert np.isfinite(foreign.features).all()
    assert read_set(tmp_path, SETS["zeroeggs"]) is None
