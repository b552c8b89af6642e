"""Retargeting of other people's motion: several programs' names, axes and scales; and on through the analysis."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from game.animation import Performer
from game.app.cli import main
from game.core import ASSETS, Clip
from game.core.humanoid import REFERENCE
from game.embos import Planner, UnitLibrary
from game.formats import read_bvh
from game.tools.observer import play_scenes
from game.tools.retarget import Options, Retargeted, detect_map, find_map, load_map, retarget

FILES = {
    "bandai": "bandai1/dataset-1_bow_happy_001.bvh",
    "motionbuilder": "zeroeggs_talk/013_Happy_2_part20__n_289_o_13_20.bvh",
    "mixamo": "bvh_dialects/test_freebvh.bvh",
    "cmu": "bvh_dialects/01_01.bvh",
    "daz": "bvh_dialects/jumping_jacks.bvh",
    "numbered_fingers": "bvh_dialects/Center.bvh",
}


def _clip(shared_data: Path, name: str) -> Clip:
    path = shared_data / FILES[name]
    if not path.exists():
        pytest.skip(f"{FILES[name]} is not among the shared files")
    clip = read_bvh(path).clip
    last = min(len(clip), round(4.0 / clip.frame_time_s))
    return replace(clip, rotation=clip.rotation[:last].copy(), translation=clip.translation[:last].copy())


@pytest.mark.parametrize("name", FILES)
def test_joints_are_found_as_the_shipped_map_says(shared_data: Path, name: str) -> None:
    known = load_map(find_map(name))
    assert dict(detect_map(_clip(shared_data, name).skeleton).joints) == dict(known.joints)


@pytest.mark.parametrize("name", FILES)
def test_directions_are_kept_and_feet_stand(shared_data: Path, name: str) -> None:
    made = retarget(_clip(shared_data, name), options=Options(table=False, collide=False, hand_targets=False))
    assert max(made.report.limb_error_deg.values()) < 12.0, made.report.limb_error_deg
    position, _ = made.clip.to_model()
    scale = made.report.scale
    for side in ("left", "right"):
        theirs = made.source.at(f"{side}Foot")[:, 1] * scale
        ours = position[:, REFERENCE.index[f"{side}Foot"], 1]
        flat = theirs < np.quantile(theirs, 0.05) + 0.01
        assert np.abs(ours[flat] - 0.07).max() < 0.03
        assert position[:, REFERENCE.index[f"{side}Toes"], 1].min() > 0.0
    # The head stays above the hips, as it is in every one of these.
    assert (position[:, REFERENCE.index["head"], 1] - position[:, 0, 1]).min() > 0.1


@pytest.mark.parametrize("name", ["bandai", "motionbuilder", "numbered_fingers"])
def test_hands_are_where_they_were_as_seen_from_the_chest(shared_data: Path, name: str) -> None:
    made = retarget(_clip(shared_data, name), options=Options(table=False, collide=False))
    far = _off_target_m(made)
    assert np.median(far) < 0.01
    assert np.quantile(far, 0.9) < 0.05


def _off_target_m(made: Retargeted) -> np.ndarray:
    """(F, 2) how far our wrists are from the source's, scaled by the arms, both seen from between the shoulders."""
    position, _ = made.clip.to_model()
    off = []

    def ours(target: str) -> np.ndarray:
        return np.asarray(position[:, REFERENCE.index[target]])

    source = made.source
    arm = np.linalg.norm(source.along("leftUpperArm", "leftLowerArm"), axis=-1).mean()
    arm += np.linalg.norm(source.along("leftLowerArm", "leftHand"), axis=-1).mean()
    our_arm = sum(np.linalg.norm(REFERENCE.rest_translation[REFERENCE.index[n]]) for n in ("leftLowerArm", "leftHand"))
    for side in ("left", "right"):
        theirs = source.at(f"{side}Hand") - 0.5 * (source.at("leftUpperArm") + source.at("rightUpperArm"))
        mine = ours(f"{side}Hand") - 0.5 * (ours("leftUpperArm") + ours("rightUpperArm"))
        off.append(np.linalg.norm(mine - theirs * (our_arm / arm), axis=-1))
    return np.stack(off, axis=-1)


def test_every_vrm_animation_becomes_a_take(
    shared_data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = sorted((shared_data / "vrma").glob("*.vrma"))
    assert files
    for path in files:
        out = tmp_path / f"{path.stem}.bvh"
        assert main(["retarget", str(path), "--out", str(out), "--json", "--directions-only", "--no-collide"]) == 0
        report = json.loads(capsys.readouterr().out)
        assert report["map_name"] == "VRM"
        clip = read_bvh(out).clip
        assert set(clip.skeleton.names) == set(REFERENCE.names)
        # Arms keep their directions; a VRM animation's bones are known without guessing.
        worst = max(report["limb_error_deg"][name] for name in report["limb_error_deg"] if "Arm" in name)
        assert worst < 15.0, (path.name, report["limb_error_deg"])


def test_nothing_jumps(shared_data: Path) -> None:
    clip = retarget(_clip(shared_data, "motionbuilder")).clip
    position, _ = clip.to_model()
    speed = np.linalg.norm(np.diff(position, axis=0), axis=-1) * 30.0
    assert speed.max() < 8.0
    assert (np.diff(clip.rotation, axis=0) ** 2).sum(-1).max() < 1.0


@pytest.mark.parametrize("name", ["zeroeggs_talk/009_Sad_3_part20__n_204_o_9_20.bvh", "vrma/Relax.vrma"])
def test_an_annotated_foreign_take_joins_the_analysis(
    shared_data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    source = shared_data / name
    if not source.exists():
        pytest.skip(f"{name} is not among the shared files")
    motion = tmp_path / "motion"
    shutil.copytree(ASSETS / "motion" / "takes", motion / "takes")
    shutil.copy(ASSETS / "motion" / "behaviours.yaml", motion)
    take = motion / "takes" / "visitor.bvh"
    assert main(["retarget", str(source), "--out", str(take), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    length_s = report["frames"] / 30.0
    assert length_s > 3.0
    take.with_suffix(".yaml").write_text(
        "take: visitor\nemotion: sadness\nbvh: visitor.bvh\nfps: 30\nspans:\n"
        f"  - {{layer: posture, behaviour: shoulders_dropped, start_s: 0.0, end_s: {length_s - 0.1:.3f}}}\n"
        "  - {layer: mannerism, behaviour: look_down, start_s: 0.4, end_s: 1.9}\n"
    )
    assert main(["analyse", str(motion / "takes"), "--json"]) == 0
    capsys.readouterr()
    library = UnitLibrary.load(motion / "units.yaml")
    by_name = {unit.name: unit for unit in library.units}
    for behaviour in ("shoulders_dropped", "look_down"):
        assert any(variant.take == "visitor" for variant in by_name[behaviour].variants)
    assert len(library.clips["visitor"].rotation) == report["frames"]
    # And bodies made from this library still move like bodies.
    planner = Planner(library)
    scenes = play_scenes(planner, Performer(library, planner.tables.layers), "body", 3, 1, 4.0)
    assert all(np.isfinite(scene.points).all() and np.abs(scene.points).max() < 2.0 for scene in scenes)
