"""Every shot of a talk keeps the whole head of every shopkeeper in the picture, whatever the body does."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from game.animation import Pose
from game.app.rig import rig_of
from game.app.shots import SHOTS
from game.app.stage import StageAssets
from game.core.humanoid import REFERENCE
from game.core.paths import ASSETS
from game.formats import read_bvh, read_vrm

HEAD = REFERENCE.index["head"]


def takes() -> Pose:
    """Frames from all over the shipped takes."""
    rotation, root = [], []
    for emotion in ("anger", "fear", "joy", "surprise", "neutral"):
        clip = read_bvh(ASSETS / "motion" / "takes" / f"{emotion}.bvh").clip
        order = [clip.skeleton.index[name] for name in REFERENCE.names]
        rotation.append(clip.rotation[::90][:, order].astype(np.float32))
        root.append(clip.translation[::90, order[0]].astype(np.float32))
    n = sum(map(len, root))
    return Pose(np.concatenate(rotation), np.concatenate(root), np.zeros((n, 2)), np.zeros(n), np.zeros(n))


@pytest.fixture(scope="module")
def pose() -> Pose:
    return takes()


@pytest.mark.parametrize("person", ["mira", "genzo", "daimon"])
def test_no_shot_cuts_the_crown_and_every_face_is_where_it_is_looked_for(person: str, pose: Pose) -> None:
    vrm = read_vrm(ASSETS / "characters" / f"{person}.vrm")
    rig, file = rig_of(vrm), vrm.gltf
    meshes = [node.mesh for node in file.nodes if node.mesh is not None and node.skin == 0]
    points = np.concatenate([p.attributes["POSITION"] for m in meshes for p in file.meshes[m].primitives])
    joint = int(rig.driven[rig.source == HEAD][0])
    at = rig.skeleton.rest_model[joint, :3, 3]
    lift_m = float(at[1] - REFERENCE.rest_model[HEAD, 1, 3])
    crown = points[points[:, 1].argmax()] - at
    head = rig.joint_matrices(pose)[:, joint].astype(float)
    seen = np.stack([crown, [0.0, 0.18, 0.15]]) @ head[:, :3, :3].swapaxes(1, 2) + head[:, None, :3, 3]
    for name, shot in SHOTS.items():
        camera = StageAssets.framed(SimpleNamespace(lift_m=lift_m), shot)  # type: ignore[arg-type]
        clip = np.concatenate([seen, np.ones((len(seen), 2, 1))], axis=-1) @ camera.view_projection(16 / 9).T
        x, y = np.moveaxis(clip[..., :2] / clip[..., 3:], -1, 0)
        assert np.percentile(y[:, 0], 99) < 1.0, f"{name} cuts the crown"
        assert -0.55 < np.median(x[:, 1]) < 0.1, name
        assert 0.1 < np.median(y[:, 1]) < 0.65, name
