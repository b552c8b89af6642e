"""Foreign avatars: every real file loads or is refused for a stated reason, and stands in the stall as it should."""

from __future__ import annotations

import json
import shutil
import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from game.animation import Pose
from game.app.avatar import Avatar, open_avatar
from game.app.avatar_smile import smile_instead
from game.core.emotion_space import EMOTION_INDEX
from game.core.errors import BadInput
from game.core.humanoid import REFERENCE
from game.face import FaceSignal
from game.face.params import face_params
from game.formats import parse_yaml

REFUSED = {
    "broken_draco.vrm": "KHR_draco_mesh_compression",
    "broken_human_bone.vrm": "index into the 20 nodes",
    "basic_armature_vrm1.vrm": "nothing to draw",
    "blender_multi_root_armature_vrm0.vrm": "nothing to draw",
    "blender_thumbnail_vrm1.vrm": "nothing to draw",
    "AnimatedMorphCube.gltf": "no skin",
    "SimpleMorph.gltf": "no skin",
    "facecap.glb": "no skin",
    "Fox.glb": "no head",
    "SimpleSkin.gltf": "no head",
    "cesium_man.gltf": "no head",
    "rigged_simple.gltf": "no head",
    **{f"Animation_SkinType_0{i}.gltf": "no head" for i in range(4)},
}
"""What cannot stand behind a table, and the reason that is given. cesium_man has no names: see the map below."""

CESIUM = """
name: cesium man
joints:
  hips: node_2
  spine: [node_11]
  chest: node_12
  neck: [node_19]
  head: node_20
  leftUpperLeg: node_7
  leftLowerLeg: node_8
  leftFoot: node_9
  leftToes: node_10
  rightUpperLeg: node_3
  rightLowerLeg: node_4
  rightFoot: node_5
  rightToes: node_6
  leftUpperArm: node_16
  leftLowerArm: node_17
  leftHand: node_18
  rightUpperArm: node_13
  rightLowerArm: node_14
  rightHand: node_15
"""


def still(n: int = 1) -> Pose:
    rotation = np.tile(np.array([0, 0, 0, 1], dtype=np.float32), (n, len(REFERENCE), 1))
    root = np.tile(REFERENCE.rest_translation[0], (n, 1)).astype(np.float32)
    return Pose(rotation, root, np.zeros((n, 2)), np.zeros(n), np.zeros(n))


def vertices(avatar: Avatar, pose: Pose) -> np.ndarray:
    """(V, 3) where the mesh is in a pose."""
    geometry = avatar.model.geometry
    matrix = avatar.rig.advance(avatar.rig.start(1), pose, 0.0)[1][0].astype(np.float64)
    place = np.zeros((len(geometry.position), 3))
    for corner in range(4):
        rows = matrix[geometry.joint[:, corner]]
        moved = np.einsum("vij,vj->vi", rows[:, :3, :3], geometry.position) + rows[:, :3, 3]
        place += geometry.weight[:, corner, None] / 255.0 * moved
    return place


def test_every_real_file_loads_or_is_refused_for_a_stated_reason(shared_data: Path):
    files = sorted([*shared_data.glob("vrm/*.vrm"), *shared_data.glob("gltf_skin_morph/**/*.gl*")])
    assert len(files) > 20
    for path in files:
        if path.name in REFUSED:
            with pytest.raises(BadInput, match=REFUSED[path.name]):
                open_avatar(path)
            continue
        avatar = open_avatar(path)
        _, skin = avatar.rig.advance(avatar.rig.start(1), still(), 0.0)
        assert skin.shape == (1, avatar.model.joint_count, 4, 4), path.name
        assert np.isfinite(skin).all(), path.name
        assert avatar.licence, path.name


def test_malformed_files_are_refused_in_one_line(shared_data: Path):
    files = sorted(p for p in (shared_data / "gltf_malformed").glob("**/*") if p.suffix in {".gltf", ".glb"})
    assert len(files) > 150
    for path in files:
        with pytest.raises(BadInput) as caught:
            open_avatar(path)
        assert "\n" not in str(caught.value), path


@pytest.mark.parametrize("name", ["Godette_vrm_v4.vrm", "cryptovoxels.vrm", "Example.vrm"])
def test_a_person_stands_on_the_ground_and_faces_the_customer(shared_data: Path, name: str):
    avatar = open_avatar(shared_data / "vrm" / name)
    place = vertices(avatar, still())
    feet = np.percentile(place[:, 1], 0.5)
    assert abs(feet) < 0.03
    assert 1.1 < place[:, 1].max() < 1.9
    names = avatar.rig.skeleton.names
    model = avatar.rig.joint_matrices(still())[0]
    assert len(names) == len(model)
    fitting = avatar.rig.fitting
    assert fitting is not None
    # The left side is at +X and the toes point at the customer.
    where = dict(zip(REFERENCE.names, _fitted_places(avatar), strict=True))
    assert where["leftUpperArm"][0] > 0.03 > -0.03 > where["rightUpperArm"][0]
    assert where["leftToes"][2] > where["leftFoot"][2]


def _fitted_places(avatar: Avatar) -> list[np.ndarray]:
    assert avatar.rig.fitting is not None
    rest = avatar.rig.fitting.rest
    place: list[np.ndarray] = []
    for offset, parent in zip(rest, REFERENCE.parents.tolist(), strict=True):
        place.append(offset + (place[parent] if parent >= 0 else 0.0))
    return place


def test_a_map_names_the_joints_of_a_skeleton_without_names(shared_data: Path, tmp_path: Path):
    from game.formats import load_map

    path = tmp_path / "cesium.yaml"
    path.write_text(CESIUM, encoding="utf-8")
    assert parse_yaml(CESIUM, "cesium.yaml")["name"].as_str() == "cesium man"
    avatar = open_avatar(shared_data / "gltf_skin_morph" / "cesium_man.gltf", load_map(path))
    place = vertices(avatar, still())
    assert abs(np.percentile(place[:, 1], 0.5)) < 0.03
    # His arms hang down in the file; in the T-pose they do not.
    reach = np.ptp(place[:, 0])
    assert reach > 0.6 * np.ptp(place[:, 1])
    assert avatar.model.pictures[0].shape[2] == 4


def test_springs_of_0x_hair_swing_and_come_to_rest(shared_data: Path):
    avatar = open_avatar(shared_data / "vrm" / "Godette_vrm_v4.vrm")
    assert avatar.rig.springs.pieces > 4
    state = avatar.rig.start(1)
    pose = still()
    for _ in range(60):
        state, rest = avatar.rig.advance(state, pose, 1 / 30)
    shaken = Pose(pose.rotation, pose.root + np.float32([0.15, 0.0, 0.0]), pose.gaze, pose.blink, pose.breath)
    state, first = avatar.rig.advance(state, shaken, 1 / 30)
    for _ in range(150):
        state, last = avatar.rig.advance(state, shaken, 1 / 30)
    shift = np.abs((first - rest)[0, :, :3, 3] - (last - rest)[0, :, :3, 3]).max()
    assert shift > 0.005, "nothing lagged behind"
    state, after = avatar.rig.advance(state, shaken, 1 / 30)
    assert np.abs(after - last).max() < 1e-3


def test_eye_bones_follow_the_gaze_by_the_files_range(shared_data: Path):
    avatar = open_avatar(shared_data / "vrm" / "blender_look_at_preview_enabled.vrm")
    pose = still()
    ahead = avatar.rig.joint_matrices(pose)[0]
    left = Pose(pose.rotation, pose.root, np.array([[1.0, 0.0]]), pose.blink, pose.breath)
    turned = avatar.rig.joint_matrices(left)[0]
    assert avatar.rig.eyes is not None
    for joint in (avatar.rig.eyes.left, avatar.rig.eyes.right):
        delta = turned[joint, :3, :3] @ ahead[joint, :3, :3].T
        angle = np.rad2deg(np.arctan2(delta[0, 2], delta[2, 2]))
        assert 1.0 < angle < 20.0, "to the character's left is toward +X"


def _rewritten(path: Path, target: Path, change: Callable[[dict], None]) -> None:
    data = path.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    document = json.loads(data[20 : 20 + length])
    change(document)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    header = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A)
    target.write_bytes(header + text + rest)


def test_pictures_come_from_inside_only(shared_data: Path, tmp_path: Path):
    """A picture's path may not lead out of the avatar's folder; one beside it is taken."""
    source = shared_data / "vrm" / "Godette_vrm_v4.vrm"
    inside = tmp_path / "inside"
    inside.mkdir()
    secret = tmp_path / "secret.png"
    shutil.copy(Path(__file__).parents[2] / "assets" / "stalls" / "flea_backdrop.png", secret)

    def out(document: dict) -> None:
        document["images"][0] = {"uri": "../secret.png"}

    _rewritten(source, inside / "out.vrm", out)
    with pytest.raises(BadInput, match="inside the file's folder"):
        open_avatar(inside / "out.vrm")
    shutil.copy(secret, inside / "near.png")

    def near(document: dict) -> None:
        document["images"][0] = {"uri": "near.png"}

    _rewritten(source, inside / "near.vrm", near)
    assert open_avatar(inside / "near.vrm").model.pictures[0].shape[1] > 256


def test_a_bomb_of_a_picture_is_not_opened(shared_data: Path, tmp_path: Path):
    source = shared_data / "vrm" / "Godette_vrm_v4.vrm"
    header = b"\x89PNG\r\n\x1a\n" + struct.pack(">I4sIIBBBBB", 13, b"IHDR", 60_000, 60_000, 8, 6, 0, 0, 0)
    (tmp_path / "bomb.png").write_bytes(header + b"\0" * 64)

    def bomb(document: dict) -> None:
        document["images"][0] = {"uri": "bomb.png"}

    _rewritten(source, tmp_path / "bomb.vrm", bomb)
    avatar = open_avatar(tmp_path / "bomb.vrm")
    assert 0 not in avatar.model.pictures
    assert any("60000×60000" in note for note in avatar.notes)


def test_missing_bones_are_named(shared_data: Path, tmp_path: Path):
    def lame(document: dict) -> None:
        bones = document["extensions"]["VRM"]["humanoid"]["humanBones"]
        document["extensions"]["VRM"]["humanoid"]["humanBones"] = [b for b in bones if b["bone"] != "leftFoot"]

    _rewritten(shared_data / "vrm" / "Godette_vrm_v4.vrm", tmp_path / "lame.vrm", lame)
    with pytest.raises(BadInput, match="leftFoot"):
        open_avatar(tmp_path / "lame.vrm")


def test_an_avatar_whose_happy_is_an_oh_smiles_with_the_mouth_that_does(shared_data: Path):
    """Godette's "Joy" is half an O and a look upward; her U pulls the corners of the mouth up."""
    avatar = open_avatar(shared_data / "vrm" / "Godette_vrm_v4.vrm")
    glad = np.zeros(7)
    glad[EMOTION_INDEX["joy"]] = 0.9
    names = avatar.face.names
    weight = avatar.face.weights(FaceSignal(glad), face_params(), np.zeros(6)).weight
    assert weight[names.index("ou")] > 0.8
    assert weight[names.index("oh")] == weight[names.index("happy")] == 0.0
    assert any("joy is shown as ou" in note for note in avatar.notes)
    # A happy face of its own, or one that smiles, stays.
    happy = avatar.expressions["happy"]
    brows = next(bind for bind in avatar.expressions["angry"].morphs if bind[1] == 14)
    for binds in (avatar.expressions["ou"].morphs, ((0, 5, 0.1), *happy.morphs, *avatar.expressions["ou"].morphs)):
        assert smile_instead(avatar.model, {**avatar.expressions, "happy": replace(happy, morphs=binds)}) is None
    assert smile_instead(avatar.model, {**avatar.expressions, "happy": replace(happy, morphs=(brows,))}) == "ou"
    assert smile_instead(avatar.model, {"happy": happy}) is None, "no mouth that speaks"
    mouthless = {name: e for name, e in avatar.expressions.items() if name not in ("ou", "ih")}
    assert smile_instead(avatar.model, mouthless) is None, "nothing of it smiles"
