"""VRM 0.x and 1.0 characters and VRM animations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from game.core import BadInput
from game.formats import read_vrm, read_vrma


def test_a_character_in_full(vrm_model, store):
    vrm = read_vrm(store(vrm_model, "small.vrm"))
    assert (vrm.version, vrm.faces, vrm.name, vrm.authors) == ("1.0", "+Z", "Small", ("nobody",))
    assert vrm.licence == {"licenseUrl": "https://example.org/", "modification": "prohibited"}
    assert vrm.gltf.nodes[vrm.bones["leftHand"]].name == "leftHand"
    assert vrm.expressions["happy"].morphs == ((0, 0, 1.0),)
    assert vrm.expressions["happy"].override_blink == "block"
    assert vrm.expressions["grin"].is_binary
    assert not vrm.expressions["grin"].preset
    (chain,) = vrm.springs
    assert [joint.node for joint in chain.joints] == [0, 1, 2]
    assert (chain.joints[0].stiffness, chain.joints[1].stiffness, chain.joints[1].gravity_dir) == (2.0, 1.0, (0, -1, 0))
    assert vrm.colliders[chain.colliders[0]].radius_m == 0.2
    assert vrm.look_at is not None
    assert vrm.look_at.ranges["VerticalUp"] == (90.0, 8.0)
    assert vrm.first_person == {3: "both"}
    assert vrm.findings == []


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda e: e["VRMC_vrm"]["humanoid"]["humanBones"].pop("hips"), "required bones are missing: hips"),
        (lambda e: e["VRMC_vrm"]["humanoid"]["humanBones"]["hips"].update(node=999), "/hips/node: expected an index"),
        (lambda e: e["VRMC_vrm"].pop("humanoid"), "'humanoid' is missing"),
        (lambda e: e["VRMC_vrm"].update(specVersion="3.0"), "specVersion: expected 1.0"),
        (
            lambda e: e["VRMC_vrm"]["expressions"]["preset"]["happy"]["morphTargetBinds"][0].update(index=5),
            "1 morph targets",
        ),
        (lambda e: e["VRMC_springBone"]["springs"][0]["joints"].reverse(), "a descendant of the joint before it"),
        (lambda e: e["VRMC_springBone"]["springs"][0]["colliderGroups"].append(4), "springColliderGroups"),
        (lambda e: e["VRMC_springBone"]["colliderGroups"][0]["colliders"].append(4), "springColliders"),
        (lambda e: e["VRMC_springBone"]["springs"][0]["joints"][0].update(stiffness=1e30), "stiffness"),
        (lambda e: e.pop("VRMC_vrm"), "without a character"),
    ],
)
def test_broken_characters(vrm_model, store, change, message: str):
    change(vrm_model.document["extensions"])
    with pytest.raises(BadInput, match=message) as caught:
        read_vrm(store(vrm_model, "small.vrm"))
    assert "\n" not in str(caught.value)


def test_the_older_version_in_the_terms_of_the_newer(vrm_model, store):
    extensions = vrm_model.document["extensions"]
    bones = extensions.pop("VRMC_vrm")["humanoid"]["humanBones"]
    extensions.pop("VRMC_springBone")
    human = [{"bone": bone, "node": item["node"]} for bone, item in bones.items()]
    human += [{"bone": "leftThumbProximal", "node": 1}, {"bone": "leftThumbIntermediate", "node": 2}]
    extensions["VRM"] = {
        "meta": {"title": "Old", "author": "", "licenseName": "CC0"},
        "humanoid": {"humanBones": [*human, {"bone": "tail", "node": 2}]},
        "firstPerson": {
            "firstPersonBone": -1,
            "firstPersonBoneOffset": {"x": 0, "y": 0.1, "z": 0.2},
            "lookAtTypeName": "BlendShape",
            "meshAnnotations": [{"mesh": 0, "firstPersonFlag": "Both"}],
        },
        "blendShapeMaster": {
            "blendShapeGroups": [
                {"name": "Joy", "presetName": "joy", "binds": [{"mesh": 0, "index": 0, "weight": 50}]},
                {"name": "Wink", "presetName": "unknown", "binds": []},
            ]
        },
        "secondaryAnimation": {
            "boneGroups": [{"bones": [0], "stiffiness": 3, "colliderGroups": [0], "center": -1}],
            "colliderGroups": [{"node": 1, "colliders": [{"offset": {"x": 0, "y": 0, "z": 1}, "radius": 0.1}]}],
        },
    }
    vrm_model.document["extensionsUsed"] = ["VRM"]
    vrm = read_vrm(store(vrm_model, "old.vrm"))
    assert (vrm.version, vrm.faces, vrm.name, vrm.authors) == ("0.x", "-Z", "Old", ())
    assert (vrm.bones["leftThumbMetacarpal"], vrm.bones["leftThumbProximal"]) == (1, 2)
    assert vrm.expressions["happy"].morphs == ((0, 0, 0.5),)
    assert list(vrm.expressions) == ["happy", "Wink"]
    assert [joint.node for joint in vrm.springs[0].joints] == [0, 1, 2]
    assert vrm.springs[0].joints[0].stiffness == 3.0
    assert vrm.colliders[0].offset == (0.0, 0.0, -1.0)
    assert vrm.look_at is not None
    assert vrm.look_at.offset == (0.0, 0.1, -0.2)
    assert vrm.first_person == {3: "both"}
    assert "unknown bone 'tail'" in vrm.findings[0]


def test_an_animation(model, store):
    model.document["extensionsUsed"] = ["VRMC_vrm_animation"]
    model.document["extensions"] = {
        "VRMC_vrm_animation": {
            "specVersion": "1.0",
            "humanoid": {"humanBones": {"hips": {"node": 0}, "spine": {"node": 1}}},
            "expressions": {"preset": {"happy": {"node": 3}}},
        }
    }
    animation = read_vrma(store(model, "a.vrma"), fps=10.0)
    assert len(animation.clip) == 11
    assert animation.clip.skeleton.names[animation.bones["spine"]] == "spine"
    assert animation.expressions == {"happy": 3}
    turn = animation.clip.rotation[:, animation.bones["spine"]]
    np.testing.assert_allclose(2 * np.arctan2(turn[:, 2], turn[:, 3]), np.linspace(0, np.pi, 11), atol=1e-6)


BROKEN = {
    "broken_draco.vrm": "needs KHR_draco_mesh_compression",
    "broken_human_bone.vrm": "/humanBones/0/node: expected an index into the 20 nodes but saw 12345",
}


def test_real_characters_load_or_say_why_not(shared_data: Path):
    paths = sorted((shared_data / "vrm").glob("*.vrm"))
    assert paths
    for path in paths:
        if path.name in BROKEN:
            with pytest.raises(BadInput, match=BROKEN[path.name]):
                read_vrm(path)
            continue
        vrm = read_vrm(path)
        assert vrm.findings == []
        assert len(vrm.bones) >= 15
        head, hips = (vrm.gltf.node_model[vrm.bones[bone], 1, 3] for bone in ("head", "hips"))
        assert 0.1 < head - hips < 2.0
        sideways = vrm.gltf.node_model[vrm.bones["leftHand"], 0, 3] - vrm.gltf.node_model[vrm.bones["hips"], 0, 3]
        assert (sideways > 0) == (vrm.faces == "+Z")


def test_real_animations_load(shared_data: Path):
    paths = sorted((shared_data / "vrma").glob("*.vrma"))
    assert paths
    for path in paths:
        animation = read_vrma(path)
        assert len(animation.bones) >= 20
        assert len(animation.clip) > 10
        positions, _ = animation.clip.to_model()
        assert np.isfinite(positions).all()
