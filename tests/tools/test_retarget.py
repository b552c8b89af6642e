"""Retargeting: disguised motion comes back, bad motion is refused in one line."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from game.app.cli import main
from game.core import ASSETS, BadInput, Clip, Skeleton
from game.core import quaternion as quat
from game.core.humanoid import REFERENCE
from game.formats import read_bvh, write_bvh
from game.tools.retarget import MAPS, Options, detect_map, find_map, load_map, map_from_names, retarget

PLAIN = Options(table=False, collide=False)
LIMBS = [f"{s}{b}" for s in ("left", "right") for b in ("UpperArm", "LowerArm", "UpperLeg", "LowerLeg")]
ENDS = {"UpperArm": "LowerArm", "LowerArm": "Hand", "UpperLeg": "LowerLeg", "LowerLeg": "Foot"}


def _take(seconds: float = 6.0) -> Clip:
    clip = read_bvh(ASSETS / "motion" / "takes" / "joy.bvh").clip
    frames = slice(0, round(seconds / clip.frame_time_s))
    order = [clip.skeleton.index[name] for name in REFERENCE.names]
    return Clip(REFERENCE, clip.frame_time_s, clip.rotation[frames][:, order], clip.translation[frames][:, order])


def _disguised(clip: Clip, *, along_bones: bool) -> Clip:
    """The same movement by another program: other names, centimetres, Z up, turned, moved, 60 fps, other axes."""
    names = tuple("Bip01 " + n.replace("left", "L ").replace("right", "R ").replace("LowerArm", "Forearm")
                  for n in REFERENCE.names)  # fmt: skip
    world = quat.multiply(quat.from_axis_angle([1, 0, 0], np.pi / 2), quat.from_axis_angle([0, 1, 0], 1.2))
    axes = np.tile(quat.IDENTITY, (len(REFERENCE), 1))
    if along_bones:
        # Each chain's x axis lies along its bones.
        for j, name in enumerate(REFERENCE.names):
            way = [0.0, 1.0, 0.0]
            if name.startswith(("left", "right")):
                way = [0.0, -1.0, 0.0] if "Leg" in name or "Foot" in name or "Toes" in name else [1.0, 0.0, 0.0]
                way = [-way[0], *way[1:]] if name.startswith("right") else way
            axes[j] = quat.between([1.0, 0.0, 0.0], way)
    position, rotation = clip.to_model()
    rotation = quat.multiply(quat.multiply(world, rotation), axes)
    position = quat.rotate(world, position) * 100.0 + [30.0, -50.0, 7.0]
    parents = np.maximum(REFERENCE.parents, 0)
    offsets = quat.rotate(quat.conjugate(axes[parents]), REFERENCE.rest_translation * 100.0)
    skeleton = Skeleton(names, REFERENCE.parents, offsets, np.tile(quat.IDENTITY, (len(names), 1)))
    translation = np.broadcast_to(offsets, position.shape).copy()
    translation[:, 0] = position[:, 0]
    twice = np.arange(2 * len(clip) - 1) / 60.0
    return Clip(
        skeleton, 1.0 / 60.0, *Clip(skeleton, 1.0 / 30.0, skeleton.to_local(rotation), translation).sample(twice)
    )


def _directions(clip: Clip) -> np.ndarray:
    position, _ = clip.to_model()
    ends = [name[:-8] + ENDS[name[-8:]] for name in LIMBS]
    bones = np.stack([position[:, REFERENCE.index[b]] - position[:, REFERENCE.index[a]]
                      for a, b in zip(LIMBS, ends, strict=True)], axis=1)  # fmt: skip
    return np.asarray(bones / np.linalg.norm(bones, axis=-1, keepdims=True))


def _angle_deg(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray(np.degrees(np.arccos(np.clip((a * b).sum(-1), -1.0, 1.0))))


def test_our_own_take_comes_back_as_it_was() -> None:
    take = _take()
    made = retarget(take, options=PLAIN)
    assert made.report.zero_pose
    assert made.report.scale == pytest.approx(1.0)
    back = quat.from_axis_angle([0, 1, 0], np.radians(-made.report.turned_deg))
    wanted = quat.rotate(back, _directions(take))
    assert np.quantile(_angle_deg(_directions(made.clip), wanted), 0.95) < 6.0
    ours, theirs = made.clip.to_model()[1], quat.multiply(back, take.to_model()[1])
    for joint in ("hips", "chest", "head", "leftHand", "rightHand", "leftIndexProximal", "rightFoot"):
        j = REFERENCE.index[joint]
        turn = np.degrees(np.linalg.norm(quat.log(quat.multiply(quat.conjugate(theirs[:, j]), ours[:, j])), axis=-1))
        assert np.median(turn) < 8.0, joint


@pytest.mark.parametrize("along_bones", [False, True])
def test_a_disguised_take_is_recognised(along_bones: bool) -> None:
    take = _take()
    plain = retarget(take, options=PLAIN).clip
    made = retarget(_disguised(take, along_bones=along_bones), options=PLAIN)
    assert made.report.zero_pose is not along_bones
    assert abs(len(made.clip) - len(plain)) <= 1
    n = min(len(made.clip), len(plain))
    off = _angle_deg(_directions(made.clip)[:n], _directions(plain)[:n])
    assert np.quantile(off, 0.95) < 5.0
    ours, theirs = made.clip.to_model(slice(0, n)), plain.to_model(slice(0, n))
    for hand in ("leftHand", "rightHand"):
        j = REFERENCE.index[hand]
        assert np.quantile(np.linalg.norm(ours[0][:, j] - theirs[0][:, j], axis=-1), 0.95) < 0.03
    head = REFERENCE.index["head"]
    turn = quat.log(quat.multiply(quat.conjugate(theirs[1][:, head]), ours[1][:, head]))
    assert np.degrees(np.linalg.norm(turn, axis=-1)).mean() < (12.0 if along_bones else 2.0)


def test_the_result_stands_behind_the_table_with_its_feet_on_the_floor() -> None:
    made = retarget(_disguised(_take(), along_bones=True))
    position, _ = made.clip.to_model()
    assert made.clip.frame_time_s == pytest.approx(1 / 30)
    assert np.abs(position[:, 0, [0, 2]].mean(0)).max() < 0.02
    ankles = position[:, [REFERENCE.index["leftFoot"], REFERENCE.index["rightFoot"]], 1]
    assert np.abs(np.median(ankles) - 0.07) < 0.03
    assert position[:, [REFERENCE.index["leftToes"], REFERENCE.index["rightToes"]], 1].min() > 0.0


def test_hands_stay_out_of_the_table_where_it_is_wanted() -> None:
    position, _ = retarget(_hanging_hands_forward()).clip.to_model()
    hand = position[30:, REFERENCE.index["leftHand"]]
    assert np.all((hand[:, 1] > 0.585) | (hand[:, 2] < 0.155))
    free, _ = retarget(_hanging_hands_forward(), options=Options(table=False)).clip.to_model()
    low = free[30:, REFERENCE.index["leftHand"]]
    assert np.any((low[:, 1] < 0.585) & (low[:, 2] > 0.16))


def _hanging_hands_forward() -> Clip:
    """Two seconds of arms stretched forward and down, where the table is."""
    rotation = np.tile(quat.IDENTITY, (60, len(REFERENCE), 1))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        down = quat.from_axis_angle([0, 0, 1], -sign * np.radians(85.0))
        forward = quat.from_axis_angle([1, 0, 0], -np.radians(28.0))
        rotation[:, REFERENCE.index[f"{side}UpperArm"]] = quat.multiply(forward, down)
    translation = np.tile(REFERENCE.rest_translation, (60, 1, 1))
    return Clip(REFERENCE, 1 / 30, rotation, translation)


def test_a_source_without_fingers_neck_or_spine_is_filled_in() -> None:
    take = _take(2.0)
    left_out = ("neck", "spine", "Thumb", "Index", "Middle", "Ring", "Little")
    keep = [j for j, name in enumerate(REFERENCE.names) if not any(part in name for part in left_out)]
    position, rotation = take.to_model()
    old = REFERENCE.parents
    parents, offsets = [], []
    for j in keep:
        parent = int(old[j])
        while parent >= 0 and parent not in keep:
            parent = int(old[parent])
        parents.append(keep.index(parent) if parent >= 0 else -1)
        offsets.append(REFERENCE.rest_model[j, :3, 3] - (REFERENCE.rest_model[parent, :3, 3] if parent >= 0 else 0.0))
    skeleton = Skeleton(tuple(REFERENCE.names[j] for j in keep), np.array(parents), np.array(offsets),
                        np.tile(quat.IDENTITY, (len(keep), 1)))  # fmt: skip
    translation = np.tile(np.array(offsets), (len(take), 1, 1))
    translation[:, 0] = position[:, 0]
    clip = Clip(skeleton, take.frame_time_s, skeleton.to_local(rotation[:, keep]), translation)
    made = retarget(clip, options=PLAIN)
    assert len(made.report.notes) == 4
    assert np.quantile(_angle_deg(_directions(made.clip), _directions(retarget(take, options=PLAIN).clip)), 0.9) < 12.0


SCHEMES = {
    "biped": ("Bip01 Pelvis", "Bip01 Spine", "Bip01 Spine1", "Bip01 Neck", "Bip01 Head",
              "Bip01 {S} Clavicle", "Bip01 {S} UpperArm", "Bip01 {S} Forearm", "Bip01 {S} Hand",
              "Bip01 {S} Thigh", "Bip01 {S} Calf", "Bip01 {S} Foot", "Bip01 {S} Toe0"),
    "unreal": ("pelvis", "spine_01", "spine_02", "neck_01", "head",
               "clavicle_{s}", "upperarm_{s}", "lowerarm_{s}", "hand_{s}",
               "thigh_{s}", "calf_{s}", "foot_{s}", "ball_{s}"),
    "blender": ("DEF-hips", "DEF-spine.001", "DEF-spine.003", "DEF-neck", "DEF-head",
                "DEF-shoulder.{S}", "DEF-upper_arm.{S}", "DEF-forearm.{S}", "DEF-hand.{S}",
                "DEF-thigh.{S}", "DEF-shin.{S}", "DEF-foot.{S}", "DEF-toe.{S}"),
    "smpl": ("Pelvis", "Spine1", "Spine3", "Neck", "Head",
             "{S}_Collar", "{S}_Shoulder", "{S}_Elbow", "{S}_Wrist",
             "{S}_Hip", "{S}_Knee", "{S}_Ankle", "{S}_Foot"),
    "xsens": ("Pelvis", "L5", "T8", "Neck", "Head",
              "{Side}Shoulder", "{Side}UpperArm", "{Side}ForeArm", "{Side}Hand",
              "{Side}UpperLeg", "{Side}LowerLeg", "{Side}Foot", "{Side}Toe"),
    "daz": ("hip", "abdomen", "chest", "neck", "head",
            "{s}Collar", "{s}Shldr", "{s}ForeArm", "{s}Hand",
            "{s}Thigh", "{s}Shin", "{s}Foot", "{s}Toe"),
    "reallusion": ("CC_Base_Hip", "CC_Base_Waist", "CC_Base_Spine02", "CC_Base_NeckTwist01", "CC_Base_Head",
                   "CC_Base_{S}_Clavicle", "CC_Base_{S}_Upperarm", "CC_Base_{S}_Forearm", "CC_Base_{S}_Hand",
                   "CC_Base_{S}_Thigh", "CC_Base_{S}_Calf", "CC_Base_{S}_Foot", "CC_Base_{S}_ToeBase"),
    "small letters": ("hips", "lowerback", "thorax", "neck", "head",
                      "{s}clavicle", "{s}humerus", "{s}radius", "{s}wrist",
                      "{s}femur", "{s}tibia", "{s}foot", "{s}toes"),
}  # fmt: skip
_TRUNK = ("hips", "spine", "chest", "neck", "head")
_LIMB = ("Shoulder", "UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot", "Toes")


@pytest.mark.parametrize("scheme", SCHEMES)
def test_names_of_other_programs_are_known(scheme: str) -> None:
    names = dict(zip(_TRUNK, SCHEMES[scheme], strict=False))
    for side in ("left", "right"):
        own = (n.format(S=side[0].upper(), s=side[0], Side=side.title()) for n in SCHEMES[scheme][len(_TRUNK) :])
        names |= {side + part: name for part, name in zip(_LIMB, own, strict=True)}
    keep = [j for j, name in enumerate(REFERENCE.names) if name in names]
    parents = [keep.index(int(REFERENCE.parents[j])) if REFERENCE.parents[j] >= 0 else -1 for j in keep]
    if scheme == "biped":
        # Its collar bones hang on the neck.
        for i, j in enumerate(keep):
            if REFERENCE.names[j].endswith("Shoulder"):
                parents[i] = keep.index(REFERENCE.index["neck"])
    skeleton = Skeleton(tuple(names[REFERENCE.names[j]] for j in keep), np.array(parents),
                        REFERENCE.rest_translation[keep], np.tile(quat.IDENTITY, (len(keep), 1)))  # fmt: skip
    found = detect_map(skeleton)
    assert {target: found.joints[target] for target in names} == {target: (name,) for target, name in names.items()}


def test_joints_that_only_twist_are_passed_over() -> None:
    names = ["hip", "abdomen", "chest", "neck", "head"]
    parents = [-1, 0, 1, 2, 3]
    for s in "lr":
        for start, chain in (
            (2, ("Collar", "ShldrBend", "ShldrTwist", "ForearmBend", "ForearmTwist", "Hand")),
            (0, ("ThighBend", "ThighTwist", "Shin", "Foot")),
        ):
            above = start
            for part in chain:
                names.append(s + part)
                parents.append(above)
                above = len(names) - 1
    skeleton = Skeleton(tuple(names), np.array(parents), np.ones((len(names), 3)),
                        np.tile(quat.IDENTITY, (len(names), 1)))  # fmt: skip
    found = detect_map(skeleton)
    assert [found.one(f"left{part}") for part in ("Shoulder", "UpperArm", "LowerArm", "Hand")] == [
        "lCollar", "lShldrBend", "lForearmBend", "lHand"]  # fmt: skip
    assert [found.one(f"right{part}") for part in ("UpperLeg", "LowerLeg", "Foot")] == ["rThighBend", "rShin", "rFoot"]


# --- refused -------------------------------------------------------------------------------------------------------
def _renamed(clip: Clip, old: str, new: str) -> Clip:
    skeleton = clip.skeleton
    names = tuple(name.replace(old, new) for name in skeleton.names)
    changed = Skeleton(names, skeleton.parents, skeleton.rest_translation, skeleton.rest_rotation)
    return replace(clip, skeleton=changed)


def test_a_skeleton_without_arms_is_refused_with_what_is_missing() -> None:
    with pytest.raises(BadInput, match=r"no left hand, no right hand.*--map"):
        retarget(_renamed(_take(0.2), "Hand", "Fin"))
    with pytest.raises(BadInput, match="no head"):
        retarget(_renamed(_take(0.2), "head", "lamp"))


def test_nan_and_empty_motion_are_refused() -> None:
    take = _take(0.5)
    rotation = take.rotation.copy()
    rotation[4, 3] = np.nan
    with pytest.raises(BadInput, match="NaN in 1 frames, first 4"):
        retarget(replace(take, rotation=rotation))
    with pytest.raises(BadInput, match="at least 2 frames"):
        retarget(replace(take, rotation=take.rotation[:1].copy(), translation=take.translation[:1].copy()))
    with pytest.raises(BadInput, match="at least 2 frames"):
        retarget(replace(take, rotation=take.rotation[:0].copy(), translation=take.translation[:0].copy()))


def test_arms_without_length_are_refused() -> None:
    take = _take(0.2)
    translation = take.translation.copy()
    translation[:, REFERENCE.index["leftHand"]] = 0.0
    with pytest.raises(BadInput, match="leftLowerArm: expected a bone with a length"):
        retarget(replace(take, translation=translation))


def test_maps_are_checked(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text("joints: {hips: hips, lefthand: leftHand}\n")
    with pytest.raises(BadInput, match=r"mine\.yaml:1:\d+.*leftHand"):
        load_map(path)
    path.write_text("joints: {hips: hips}\n")
    with pytest.raises(BadInput, match="also chest, head, leftUpperArm"):
        load_map(path)
    with pytest.raises(BadInput, match=r"bandai.*mixamo"):
        find_map("blender")
    own = detect_map(REFERENCE)
    wrong = replace(own, joints={**own.joints, "head": ("heda",)})
    with pytest.raises(BadInput, match="did you mean 'head'"):
        map_from_names(wrong, REFERENCE)


def test_the_shipped_maps_can_be_read() -> None:
    paths = sorted(MAPS.glob("*.yaml"))
    assert len(paths) >= 5
    for path in paths:
        assert load_map(path).name == path.stem


def test_the_command_writes_a_take_and_refuses_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source, out = tmp_path / "theirs.bvh", tmp_path / "ours.bvh"
    write_bvh(_disguised(_take(3.0), along_bones=True), source)
    assert main(["retarget", str(source), "--out", str(out), "--cut", "0.5:2"]) == 0
    assert "written" in capsys.readouterr().out
    made = read_bvh(out).clip
    assert made.length_s == pytest.approx(1.5, abs=0.07)
    assert set(made.skeleton.names) == set(REFERENCE.names)
    for wrong in (
        ["--map", "bandai"],
        ["--cut", "9:12"],
        ["--out", str(tmp_path / "ours.txt")],
        ["--out", str(source)],
    ):
        assert main(["retarget", str(source), *wrong]) == 2
        assert capsys.readouterr().err.count("\n") == 1
