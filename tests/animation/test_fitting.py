"""Poses on other bodies: hands and feet keep their contacts, whatever the proportions, axes, rest pose and bones."""

from __future__ import annotations

import numpy as np
import pytest

from game.animation import REGIONS, BodyShape, BodySize, Pose, Rig, figure, fit_to, measure_body, measure_shape
from game.animation.body_shape import COLUMNS, ROWS, turn_share
from game.app.rig import load_rig
from game.core import quaternion as quat
from game.core.errors import BadInput
from game.core.humanoid import REFERENCE, TABLE_TOP_M
from game.core.paths import ASSETS
from game.formats import read_bvh

REST = {name: REFERENCE.rest_model[i, :3, 3].copy() for i, name in enumerate(REFERENCE.names)}
PALM = np.array([0.085, 0.0, 0.0])


def take(emotion: str, step: int = 7) -> Pose:
    """Every few frames of a shipped take."""
    clip = read_bvh(ASSETS / "motion" / "takes" / f"{emotion}.bvh").clip
    order = [clip.skeleton.index[name] for name in REFERENCE.names]
    rotation = clip.rotation[::step][:, order].astype(np.float32)
    n = len(rotation)
    root = clip.translation[::step, order[0]].astype(np.float32)
    return Pose(rotation, root, np.zeros((n, 2)), np.zeros(n), np.zeros(n))


def tall() -> dict[str, np.ndarray]:
    """A grown-up: longer legs, arms and trunk, broader, smaller hands."""
    places = {name: place * np.array([1.35, 1.2, 1.1]) for name, place in REST.items()}
    for name, place in places.items():
        if any(word in name for word in ("Thumb", "Index", "Middle", "Ring", "Little")):
            hand = f"{'left' if name.startswith('left') else 'right'}Hand"
            places[name] = places[hand] + 0.9 * (REST[name] - REST[hand])
        if "Leg" in name or "Foot" in name or "Toes" in name:
            place[1] *= 1.05
    for name in ("hips", "spine", "chest", "neck", "head"):
        places[name][1] += 0.03
    return places


def rig_at(
    places: dict[str, np.ndarray],
    turn: dict[str, np.ndarray] | None = None,
    size: BodySize | None = None,
    shape: BodyShape | None = None,
) -> Rig:
    """A rig whose joints stand at places (model space); turn: model-space rest rotations, the identity where none."""
    names = [name for name in REFERENCE.names if name in places]
    above = {}
    for name in names:
        at = int(REFERENCE.parents[REFERENCE.index[name]])
        while at >= 0 and REFERENCE.names[at] not in places:
            at = int(REFERENCE.parents[at])
        above[name] = names.index(REFERENCE.names[at]) if at >= 0 else -1
    world = [quat.IDENTITY if turn is None else turn[name] for name in names]
    rest, local = [], []
    for i, name in enumerate(names):
        parent = above[name]
        back = quat.conjugate(world[parent]) if parent >= 0 else quat.IDENTITY
        rest.append(quat.rotate(back, places[name] - (places[names[parent]] if parent >= 0 else 0.0)))
        local.append(quat.multiply(back, world[i]))
    return Rig.from_arrays(
        names, np.array(list(above.values())), np.array(rest), rest_rotation=np.array(local), size=size, shape=shape
    )


def joints(rig: Rig, pose: Pose) -> dict[str, np.ndarray]:
    """Joint -> (n, 4, 4)."""
    model = rig.joint_matrices(pose).astype(np.float64)
    return {name: model[:, i] for i, name in enumerate(rig.skeleton.names)}


def palms(found: dict[str, np.ndarray], side: str, share: float = 1.0) -> np.ndarray:
    hand = found[f"{side}Hand"]
    return hand[:, :3, 3] + share * (1 if side == "left" else -1) * (hand[:, :3, :3] @ PALM)


def test_the_references_own_body_is_left_alone():
    rig, pose = rig_at(REST), take("joy", 200)
    assert rig.fitting is None
    found, model = joints(rig, pose), REFERENCE.to_model(pose.rotation.astype(float))[1]
    for i, name in enumerate(REFERENCE.names):
        np.testing.assert_allclose(found[name][:, :3, :3], quat.to_matrix(model[:, i]), atol=1e-5)
    assert fit_to(REST, BodySize({})) is not None


@pytest.mark.parametrize("emotion", ["anger", "fear", "neutral"])
def test_feet_stay_planted_and_hands_stay_on_the_table(emotion: str):
    """The bounds are what an eye at the customer's place sees: a few millimetres."""
    pose = take(emotion)
    here, there = joints(rig_at(REST), pose), joints(rig_at(tall()), pose)
    for side in ("left", "right"):
        foot = f"{side}Foot"
        planted = np.abs(here[foot][:, :3, 3] - REST[foot]).max(axis=1) < 1e-4
        assert planted.any()
        np.testing.assert_allclose(
            there[foot][planted, :3, 3], np.broadcast_to(tall()[foot], (planted.sum(), 3)), atol=2e-3
        )
        palm = palms(here, side)
        low = (palm[:, 1] < TABLE_TOP_M + 0.055) & (palm[:, 2] > 0.17) & (palm[:, 2] < 0.7)
        apart = np.linalg.norm(palm - palms(here, "right" if side == "left" else "left"), axis=-1) > 0.34
        chosen = low & apart
        assert chosen.sum() >= 15
        mine = palms(there, side, 0.9)[chosen]
        assert np.abs(mine - palm[chosen])[:, [0, 2]].max() < 0.03
        assert np.abs(mine - palm[chosen])[:, 1].max() < 0.012


def test_a_hand_on_the_head_is_at_the_same_place_of_a_bigger_head():
    size = BodySize({"head": (1.3, 1.4, 1.2)})
    fitting = fit_to(REST, size)
    assert fitting is not None
    pose = take("disgust", 3)
    here = joints(rig_at(REST), pose)
    there = joints(rig_at(REST, size=size), pose)
    centre, radius = fitting.centre[:, 3].astype(float), fitting.radius[:, 3].astype(float)
    seen = 0
    for side in ("left", "right"):
        local = [
            (np.einsum("nji,nj->ni", body["head"][:, :3, :3], palms(body, side) - body["head"][:, :3, 3]) - c) / r
            for body, c, r in ((here, centre[0], radius[0]), (there, centre[1], radius[1]))
        ]
        other = "right" if side == "left" else "left"
        apart = np.linalg.norm(palms(here, side) - palms(here, other), axis=-1) > 0.34
        near = (np.linalg.norm(local[0], axis=-1) < 1.42) & apart
        seen += int(near.sum())
        # On the skin, not in it and not beside it (the chest may have a little say).
        difference = np.linalg.norm(local[1][near], axis=-1) - np.linalg.norm(local[0][near], axis=-1)
        assert near.sum() == 0 or np.abs(difference).max() < 0.12
    assert seen > 5


def test_clasped_hands_stay_clasped_on_broad_shoulders():
    broad = {name: place * np.array([1.5, 1.0, 1.0]) for name, place in REST.items()}
    pose = take("fear")
    here, there = joints(rig_at(REST), pose), joints(rig_at(broad), pose)
    rig = rig_at(broad)
    assert rig.fitting is not None
    way = palms(here, "left") - palms(here, "right")
    close = np.linalg.norm(way, axis=-1) < 0.14
    assert close.sum() > 20
    share = rig.fitting.hand
    mine = palms(there, "left", share) - palms(there, "right", share)
    np.testing.assert_allclose(mine[close], share * way[close], atol=0.01)


def test_axes_of_the_joints_do_not_matter():
    rng = np.random.default_rng(5)
    turn = {name: quat.exp(rng.normal(size=3)) for name in REFERENCE.names}
    pose = take("joy", 50)
    plain, turned = joints(rig_at(tall()), pose), joints(rig_at(tall(), turn), pose)
    for name in REFERENCE.names:
        np.testing.assert_allclose(turned[name][:, :3, 3], plain[name][:, :3, 3], atol=2e-5)
        back = turned[name][:, :3, :3] @ quat.to_matrix(quat.conjugate(turn[name]))
        np.testing.assert_allclose(back, plain[name][:, :3, :3], atol=2e-5)


def test_an_a_pose_at_rest_moves_like_a_t_pose():
    places, turn = dict(tall()), dict.fromkeys(REFERENCE.names, quat.IDENTITY)
    for side, sign in (("left", -1.0), ("right", 1.0)):
        down = quat.from_axis_angle([0.0, 0.0, 1.0], sign * np.deg2rad(45.0))
        shoulder = places[f"{side}UpperArm"].copy()
        for name in REFERENCE.names:
            if name.startswith(side) and not any(w in name for w in ("Shoulder", "Leg", "Foot", "Toes")):
                places[name] = shoulder + quat.rotate(down, places[name] - shoulder)
                turn[name] = down
    pose = take("joy", 50)
    plain, sloped = joints(rig_at(tall()), pose), joints(rig_at(places, turn), pose)
    for name in REFERENCE.names:
        # The arms of the reference are not quite in line with ±X, so neither is what they are set to.
        np.testing.assert_allclose(sloped[name][:, :3, 3], plain[name][:, :3, 3], atol=2e-3)


def test_missing_bones_are_made_up_by_their_neighbours():
    few = {k: v for k, v in tall().items() if k not in ("chest", "neck", "leftShoulder", "rightShoulder")}
    few = {k: v for k, v in few.items() if not any(w in k for w in ("Toes", "Thumb", "Ring", "Little"))}
    pose = take("anger", 50)
    whole, found = joints(rig_at(tall()), pose), joints(rig_at(few), pose)
    np.testing.assert_allclose(found["head"][:, :3, :3], whole["head"][:, :3, :3], atol=2e-5)
    np.testing.assert_allclose(found["spine"][:, :3, :3], whole["chest"][:, :3, :3], atol=2e-5)
    for side in ("left", "right"):
        np.testing.assert_allclose(found[f"{side}Hand"][:, :3, :3], whole[f"{side}Hand"][:, :3, :3], atol=2e-5)
        np.testing.assert_allclose(found[f"{side}Foot"][:, :3, 3], whole[f"{side}Foot"][:, :3, 3], atol=2e-3)


def big_handed(hand: float) -> dict[str, np.ndarray]:
    """The reference but for its hands."""
    places = {name: place.copy() for name, place in REST.items()}
    for name in places:
        if any(word in name for word in ("Thumb", "Index", "Middle", "Ring", "Little")):
            wrist = REST[f"{'left' if name.startswith('left') else 'right'}Hand"]
            places[name] = wrist + hand * (REST[name] - wrist)
    return places


def barrel(radius: float) -> BodyShape:
    """A body as round as a barrel from the hips to the neck."""
    chest, hips = REST["chest"], REST["hips"]
    return BodyShape(
        {"chest": np.array([0.0, hips[1] - chest[1], 0.0])},
        {"chest": float(REST["neck"][1] - hips[1])},
        {"chest": np.full((ROWS, COLUMNS), radius)},
    )


def depth_of_fingers(rig: Rig, pose: Pose, joint: str, shape: BodyShape) -> np.ndarray:
    """(n,) how deep the deepest finger joint is below a region's surface, metres; along the horizontal."""
    found = joints(rig, pose)
    fingers = [name for name in found if any(f in name for f in ("Index", "Middle", "Little", "Thumb"))]
    place = np.stack([found[name][:, :3, 3] for name in fingers], axis=1) - found[joint][:, None, :3, 3]
    local = np.einsum("nij,nki->nkj", found[joint][:, :3, :3], place) - shape.centre[joint]
    row = local[..., 1] / shape.height[joint] * (ROWS - 1)
    column = np.rint(turn_share(local[..., 0], local[..., 2]) * COLUMNS).astype(int) % COLUMNS
    inside = (row > 2.5) & (row < ROWS - 3.5)
    surface = shape.radius[joint][np.clip(np.rint(row).astype(int), 0, ROWS - 1), column]
    return np.where(inside, surface - np.hypot(local[..., 0], local[..., 2]), -1.0).max(axis=1)


def test_big_hands_lie_on_a_big_body_and_not_in_it():
    pose, shape = take("sadness", 12), barrel(0.17)
    into = depth_of_fingers(rig_at(big_handed(1.3)), pose, "chest", shape)
    onto = depth_of_fingers(rig_at(big_handed(1.3), shape=shape), pose, "chest", shape)
    assert (into > 0.02).mean() > 0.05
    assert np.percentile(onto, 99) < 0.004
    assert (onto <= np.maximum(into + 0.004, 0.0)).all()


def test_the_body_s_shape_moves_only_hands_bigger_than_the_reference_s():
    pose = take("sadness", 60)
    for hand, moved in ((1.05, False), (1.3, True)):
        free, held = (joints(rig_at(big_handed(hand), shape=s), pose) for s in (None, barrel(0.20)))
        shift = np.abs(free["leftHand"] - held["leftHand"]).max()
        assert (shift > 0.01) == moved
        np.testing.assert_array_equal(free["head"], held["head"])
        np.testing.assert_array_equal(free["leftFoot"], held["leftFoot"])


def test_hands_are_held_off_without_jumps():
    """What the body pushes grows with the way of the hand into it."""
    pose = take("sadness", 1)
    free, held = (joints(rig_at(big_handed(1.3), shape=s), pose) for s in (None, barrel(0.17)))
    push = held["leftHand"][:, :3, 3] - free["leftHand"][:, :3, 3]
    assert np.abs(push).max() > 0.01
    assert np.linalg.norm(np.diff(push, axis=0), axis=1).max() < 0.03


def test_a_shape_is_measured_by_height_and_direction():
    angle, height = (x.ravel() for x in np.meshgrid(np.linspace(0, 2 * np.pi, 97), np.linspace(0.4, 1.0, 61)))
    radius = 0.15 + 0.05 * (np.cos(angle) > 0.0) * (height < 0.8)
    outer = np.stack([radius * np.sin(angle), height, radius * np.cos(angle)], axis=1)
    points = np.vstack([outer, outer * (0.5, 1.0, 0.5)])
    first = (np.arange(60)[:, None] * 97 + np.arange(96)).ravel()
    sheet = np.vstack([np.stack([first, first + 1, first + 97], 1), np.stack([first + 1, first + 98, first + 97], 1)])
    triangle = np.vstack([sheet, sheet + len(outer)])
    found = measure_shape(points, triangle, np.zeros(len(points), np.intp), REST)
    assert set(found.radius) == set(REGIONS) - {"head"}
    spine = found.radius["spine"]
    middle = slice(3, ROWS - 6)
    np.testing.assert_allclose(spine[middle, [0, 1, -1]], 0.20, atol=0.002)
    np.testing.assert_allclose(spine[middle, COLUMNS // 2], 0.15, atol=0.002)
    assert float(found.centre["spine"][1]) < 0.0


def test_daimons_hands_stay_out_of_his_own_clothes():
    rig, pose = load_rig(ASSETS / "characters" / "daimon.vrm", springs=False), take("sadness", 40)
    shapes = {REFERENCE.names[figure.FIGURE[row["joint"]]]: row for row in rig.fitting.shapes}
    assert set(shapes) == set(REGIONS)
    for name, row in shapes.items():
        shape = BodyShape({name: row["centre"]}, {name: float(row["height"])}, {name: row["radius"]})
        assert depth_of_fingers(rig, pose, name, shape).max() < (0.02 if name == "head" else 0.003)
    assert len(load_rig(ASSETS / "characters" / "genzo.vrm", springs=False).fitting.shapes) == 0


def test_outer_finger_joints_curl_with_the_fist():
    places = tall()
    names = list(REFERENCE.names)
    rig = rig_at(places)
    parents = [int(p) for p in rig.skeleton.parents]
    rest = list(rig.skeleton.rest_translation)
    names.append("leftIndexDistal")
    parents.append(names.index("leftIndexIntermediate"))
    rest.append(np.array([0.02, 0.0, 0.0]))
    rig = Rig.from_arrays(names, np.array(parents), np.array(rest))
    pose = take("joy", 500)
    bend = quat.from_axis_angle([0.0, 0.0, 1.0], -np.deg2rad(80.0)).astype(np.float32)
    pose.rotation[:, REFERENCE.index["leftIndexIntermediate"]] = bend
    found = joints(rig, pose)
    local = found["leftIndexIntermediate"][0, :3, :3].T @ found["leftIndexDistal"][0, :3, :3]
    angle = np.rad2deg(np.arctan2(local[0, 1], local[0, 0]))
    assert 35.0 < angle < 70.0


def test_many_characters_are_fitted_like_each_alone():
    rig, pose = rig_at(tall()), take("disgust", 300)
    together = rig.joint_matrices(pose)
    for i in range(len(pose)):
        part = Pose(*(getattr(pose, f)[i : i + 1] for f in ("rotation", "root", "gaze", "blink", "breath")))
        assert np.array_equal(rig.joint_matrices(part)[0], together[i])


def test_nothing_jumps_between_frames():
    """A smooth movement stays smooth: no frame's wrist goes further than in proportion to the reference's."""
    pose = take("surprise", 1)
    here, there = joints(rig_at(REST), pose), joints(rig_at(tall()), pose)
    for side in ("left", "right"):
        step = [np.linalg.norm(np.diff(palms(b, side), axis=0), axis=-1) for b in (here, there)]
        assert step[1].max() < 1.9 * step[0].max()
        second = [np.linalg.norm(np.diff(palms(b, side), n=2, axis=0), axis=-1) for b in (here, there)]
        assert second[1].max() < 2.2 * second[0].max()


def test_needed_bones_are_named():
    few = {k: v for k, v in REST.items() if k not in ("leftFoot", "head")}
    with pytest.raises(BadInput, match="no head, leftFoot"):
        fit_to(few)


def _drum(front: float, back: float, half: float = 0.126) -> np.ndarray:
    """(v, 3) a trunk of this width, its front and back so far from the middle, as tall as the reference's."""
    angle, height = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 60), np.linspace(0.5, 0.9, 60))
    depth = np.where(np.cos(angle) > 0.0, front, back)
    return np.stack([half * np.sin(angle), height, depth * np.cos(angle)], axis=-1).reshape(-1, 3)


def _measured(points: np.ndarray) -> BodySize:
    everywhere = np.ones(len(points), dtype=bool)
    return measure_body(points, ~everywhere, everywhere, REST["hips"], REST["head"])


def test_a_belly_that_is_all_in_front_keeps_hands_off_it():
    """Twice the depth in front and none behind: what lies on it moves as far forward as the belly's front does."""
    flat, belly = _measured(_drum(0.104, 0.104)), _measured(_drum(0.208, 0.104))
    assert flat.ahead["spine"] == pytest.approx(0.0, abs=4e-3)
    assert belly.share["spine"][2] == pytest.approx(1.5, abs=0.02)
    assert belly.ahead["spine"] == pytest.approx(0.052, abs=4e-3)
    places = []
    for size in (flat, belly):
        fitting = fit_to(REST, size)
        assert fitting is not None
        places.append((fitting.centre[1, 1, 2], fitting.radius[1, 1, 2]))
    (thin, thin_radius), (wide, wide_radius) = places
    assert wide + wide_radius - thin - thin_radius == pytest.approx(0.104, abs=0.012)
    assert wide - wide_radius - thin + thin_radius == pytest.approx(0.0, abs=0.012)


def test_a_hand_on_the_belly_goes_with_a_belly_that_leans_over_the_table():
    """Over the top the table lets it: what touches the reference's belly is as near to this one's."""
    broad = (1.4, 1.0, 1.5)
    size = BodySize(dict.fromkeys(("chest", "spine", "hips"), broad), {"spine": 0.03, "hips": 0.01})
    fitting = fit_to(REST, size)
    assert fitting is not None
    seen = []
    for emotion in ("anger", "fear", "disgust"):
        pose = take(emotion, 5)
        here, there = joints(rig_at(REST), pose), joints(rig_at(REST, size=size), pose)
        for side in ("left", "right"):
            local = [
                (np.einsum("nji,nj->ni", body["spine"][:, :3, :3], palms(body, side) - body["spine"][:, :3, 3]) - c) / r
                for body, c, r in zip((here, there), fitting.centre[:, 1], fitting.radius[:, 1], strict=True)
            ]
            palm = palms(here, side)
            apart = np.linalg.norm(palm - palms(here, "right" if side == "left" else "left"), axis=-1) > 0.34
            on = (np.linalg.norm(local[0], axis=-1) < 1.45) & (palm[:, 1] > TABLE_TOP_M + 0.06) & apart
            seen.append(np.linalg.norm(local[1][on], axis=-1) - np.linalg.norm(local[0][on], axis=-1))
    off = np.concatenate(seen)
    assert len(off) > 15
    assert off.min() > -0.12


def test_no_palm_is_deeper_in_a_round_body_than_in_the_references():
    """Also between two places and on the way to one: hands that sweep past the belly at every height and distance."""
    round_body = BodySize(
        {"chest": (1.2, 1.0, 1.4), "spine": (1.4, 1.0, 1.6), "hips": (1.2, 1.0, 1.2)}, {"spine": 0.02}
    )
    rng, n = np.random.default_rng(3), 1500
    rotation = np.tile(quat.IDENTITY, (n, len(REFERENCE), 1)).astype(np.float32)
    lowered = quat.from_axis_angle(np.array([0.0, 0.0, 1.0]), rng.uniform(-1.5, -0.6, n))
    inward = quat.from_axis_angle(np.array([0.0, 1.0, 0.0]), rng.uniform(-1.7, 0.2, n))
    rotation[:, REFERENCE.index["leftUpperArm"]] = quat.multiply(inward, lowered)
    folded = quat.from_axis_angle(np.array([0.0, 1.0, 0.0]), rng.uniform(-2.9, -1.2, n))
    across = quat.from_axis_angle(np.array([1.0, 0.0, 0.0]), rng.uniform(-2.6, 0.6, n))
    rotation[:, REFERENCE.index["leftLowerArm"]] = quat.multiply(across, folded)
    root = np.tile(REST["hips"], (n, 1)).astype(np.float32)
    pose = Pose(rotation, root, np.zeros((n, 2)), np.zeros(n), np.zeros(n))
    norms = []
    for size, radii, ahead in ((None, (0.135, 0.140, 0.112), 0.0), (round_body, (0.189, 0.140, 0.1792), 0.02)):
        found = joints(rig_at(dict(REST), size=size), pose)
        local = palms(found, "left") - found["spine"][:, :3, 3] - ((0.0, 0.680, ahead) - REST["spine"])
        norms.append(np.linalg.norm(local / radii, axis=1))
    near = (norms[0] > 0.6) & (norms[0] < 1.3)
    assert near.sum() > 20
    assert (norms[0] - norms[1])[near].max() < 0.02, "in radii of the belly: three millimetres"
