"""Every shot keeps everybody's whole head in the picture, whatever the body does and whatever the window's shape."""

from __future__ import annotations

import itertools
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from game.animation import Pose, Rig
from game.app.avatar import open_avatar
from game.app.cards import CARD_CAMERA
from game.app.figure6 import CAMERA as FIGURE_CAMERA
from game.app.passersby import load_cast
from game.app.rig import load_rig
from game.app.shots import LARGE_TEXT_DROP, SHOTS, framing
from game.app.stage import StageAssets
from game.app.strolls import LANES_M, OUT_X_M
from game.app.studio import CAMERAS
from game.app.window import TELL_CAMERA
from game.core.humanoid import REFERENCE
from game.core.paths import ASSETS
from game.formats import read_bvh, read_gltf
from game.render import Camera

HEAD = REFERENCE.index["head"]
ASPECTS = (3 / 4, 1.0, 4 / 3, 16 / 9, 21 / 9)
LARGE = {f"{name} large": framing(name, 2.0) for name in ("talk", "side")}
EVERY = {**CAMERAS, **LARGE, "home": SHOTS["home"], "tell": TELL_CAMERA, "card": CARD_CAMERA, "figure": FIGURE_CAMERA}
CORNERS = np.array(list(itertools.product((-1, 0, 1), (0, 1), (-1, 0, 1))), float)


@pytest.fixture(scope="module")
def pose() -> Pose:
    """Frames from all over the shipped takes."""
    rotation, root = [], []
    for emotion in ("anger", "fear", "joy", "surprise", "neutral"):
        clip = read_bvh(ASSETS / "motion" / "takes" / f"{emotion}.bvh").clip
        order = [clip.skeleton.index[name] for name in REFERENCE.names]
        rotation.append(clip.rotation[::90][:, order].astype(np.float32))
        root.append(clip.translation[::90, order[0]].astype(np.float32))
    n = sum(map(len, root))
    return Pose(np.concatenate(rotation), np.concatenate(root), np.zeros((n, 2)), np.zeros(n), np.zeros(n))


@cache
def someone(name: str, shared: Path) -> tuple[Rig, np.ndarray, float]:
    """Rig, every vertex at rest (v, 3), and how much higher the head is than the reference's."""
    if name == "Godette":
        avatar = open_avatar(shared / "vrm" / "Godette_vrm_v4.vrm")
        return avatar.rig, avatar.model.geometry.position, avatar.lift_m
    path = ASSETS / "characters" / f"{name}.vrm"
    rig, file = load_rig(path), read_gltf(path)
    meshes = [node.mesh for node in file.nodes if node.mesh is not None and node.skin == 0]
    points = np.concatenate([p.attributes["POSITION"] for m in meshes for p in file.meshes[m].primitives])
    joint = int(rig.driven[rig.source == HEAD][0])
    return rig, points, float(rig.skeleton.rest_model[joint, 1, 3] - REFERENCE.rest_model[HEAD, 1, 3])


def seen_at(camera: Camera, points: np.ndarray, aspect: float) -> np.ndarray:
    """(…, 2) places in the picture, −1 to 1."""
    clip = np.concatenate([points, np.ones((*points.shape[:-1], 1))], axis=-1) @ camera.view_projection(aspect).T
    return np.asarray(clip[..., :2] / clip[..., 3:])


@pytest.mark.parametrize("name", ["mira", "genzo", "daimon", "Godette"])
def test_no_shot_of_any_shape_cuts_head_hair_or_headwear(name: str, pose: Pose, shared_data: Path) -> None:
    rig, points, lift_m = someone(name, shared_data)
    joint = int(rig.driven[rig.source == HEAD][0])
    at = rig.skeleton.rest_model[joint, :3, 3]
    own = points[(points[:, 1] > at[1]) & (np.abs(points[:, 0]) < 0.4)] - at
    # What reaches farthest in each direction: nothing of the head is outside these.
    reach = own[(own @ CORNERS.T).argmax(axis=0)]
    head = rig.joint_matrices(pose)[:, joint].astype(float)
    moved = reach @ head[:, :3, :3].swapaxes(1, 2) + head[:, None, :3, 3]
    for (shot, camera), aspect in itertools.product(EVERY.items(), ASPECTS):
        framed = StageAssets.framed(SimpleNamespace(lift_m=lift_m), camera)  # type: ignore[arg-type]
        x, y = np.moveaxis(seen_at(framed, moved, aspect), -1, 0)
        top, side = y.max(axis=1), np.abs(x).max(axis=1)
        assert np.percentile(top, 99) < 1.0, f"{np.percentile(top, 99):.3f} {shot} at {aspect:.2f} cuts the crown"
        assert np.percentile(side, 99) < 1.0, f"{shot} at {aspect:.2f} cuts a side"


@pytest.mark.parametrize("name", ["mira", "genzo", "daimon"])
def test_every_face_is_where_it_is_looked_for(name: str, pose: Pose, shared_data: Path) -> None:
    rig, _, lift_m = someone(name, shared_data)
    head = rig.joint_matrices(pose)[:, int(rig.driven[rig.source == HEAD][0])].astype(float)
    face = np.array([0.0, 0.18, 0.15]) @ head[:, :3, :3].swapaxes(1, 2) + head[:, :3, 3]
    for shot, camera in SHOTS.items():
        framed = StageAssets.framed(SimpleNamespace(lift_m=lift_m), camera)  # type: ignore[arg-type]
        x, y = seen_at(framed, face, 16 / 9).T
        assert -0.55 < np.median(x) < 0.1, shot
        assert 0.1 < np.median(y) < 0.65, shot


def test_nobody_who_walks_past_loses_the_head() -> None:
    top = float(load_cast("").tall_m.max())
    places = np.array([(x, top, z) for x in (-OUT_X_M, 0.0, OUT_X_M) for z in LANES_M])
    for (shot, camera), aspect in itertools.product(EVERY.items(), ASPECTS):
        assert seen_at(camera, places, aspect)[:, 1].max() < 0.95, shot


def test_large_letters_leave_the_hands_to_be_seen_and_other_shots_as_they_are() -> None:
    hand = np.array([0.2, 0.66, 0.35, 1.0])

    def height(camera: Camera) -> float:
        clip = camera.view_projection(16.0 / 9.0) @ hand
        return float(clip[1] / clip[3]) / 2.0

    for shot in ("talk", "side"):
        risen = height(framing(shot, 2.0)) - height(SHOTS[shot])
        assert risen == pytest.approx(LARGE_TEXT_DROP, rel=0.25), shot
        assert framing(shot) is SHOTS[shot]
    assert framing("close", 2.0) is SHOTS["close"]
    assert framing("offer", 2.0) is SHOTS["offer"]
