"""The performer's parts: timing, arms, legs, paths that never jump, and scores that are refused with a reason."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from game.core import quaternion as quat
from game.core.errors import BadInput
from game.core.humanoid import REFERENCE
from game.tools.perform import perform_score, perform_take, timing
from game.tools.perform.arms import finger_rotations, hand_frame, mirror_points, mirror_rotations, solve_arm
from game.tools.perform.body import CHANNELS, legs, torso
from game.tools.perform.data import load_effort, load_hands, load_score
from game.tools.perform.measure import measure


def test_ease_goes_from_zero_to_one_and_anticipates_only_when_asked() -> None:
    u = np.linspace(-0.5, 1.5, 401)
    plain = timing.ease(u, timing.Ease())
    assert plain[0] == 0.0
    assert plain[-1] == 1.0
    assert (np.diff(plain) >= -1e-12).all()
    wound_up = timing.ease(u, timing.Ease(skew=1.25, sharp=0.7, anticipation=0.16))
    assert -0.161 < wound_up.min() < -0.1
    assert wound_up[-1] == 1.0
    # A sudden start is ahead of a strike all the way.
    assert timing.ease(0.3, timing.Ease(skew=0.6)) > 0.4 > timing.ease(0.3, timing.Ease(skew=2.0))


def test_spring_settles_overshoots_by_its_damping_and_does_not_care_how_parameters_are_given() -> None:
    step = np.concatenate([np.zeros((10, 2)), np.ones((120, 2))])
    y = timing.spring(step, 3.0, np.array([0.4, 1.0]))
    assert y[-1] == pytest.approx([1.0, 1.0], abs=1e-4)
    assert y[:, 0].max() > 1.15
    assert y[:, 1].max() < 1.0 + 1e-9
    over_time = timing.spring(step, np.full((130, 2), 3.0), np.tile([0.4, 1.0], (130, 1)))
    assert over_time == pytest.approx(y)


def test_spring_stays_bounded_when_a_contact_stiffens_it_suddenly() -> None:
    rng = np.random.default_rng(4)
    x = rng.normal(size=(300, 3)).cumsum(0) * 0.01
    frequency = np.where(np.arange(300)[:, None] % 60 < 30, 2.0, 11.0)
    y = timing.spring(x, np.broadcast_to(frequency, x.shape), 1.0)
    assert np.abs(y - x).max() < 0.2


def test_rotation_spring_follows_and_keeps_an_even_speed_through_a_half_turn() -> None:
    angle = np.radians(175.0) * timing.minimum_jerk(np.linspace(-0.5, 3.0, 120))
    q = quat.from_axis_angle(np.array([0.3, 1.0, 0.2]), angle)
    out = timing.spring_rotation(q, np.full(120, 5.0), np.full(120, 0.9))
    speed = np.linalg.norm(quat.log(quat.multiply(out[1:], quat.conjugate(out[:-1]))), axis=-1)
    wanted = np.linalg.norm(quat.log(quat.multiply(q[1:], quat.conjugate(q[:-1]))), axis=-1)
    assert speed.max() < 1.25 * wanted.max()
    assert np.abs((out[-1] * q[-1]).sum()) == pytest.approx(1.0, abs=1e-4)


def test_a_move_that_is_interrupted_starts_from_where_the_blend_is() -> None:
    time = np.arange(90) * timing.DT_S
    track = np.zeros(90)
    timing.blend_scalar(track, time, 0.2, 1.0, 10.0, timing.Ease())
    timing.blend_scalar(track, time, 0.7, 0.6, -5.0, timing.Ease())
    assert np.abs(np.diff(track)).max() < 1.5
    assert track[-1] == pytest.approx(-5.0)


def test_arms_reach_on_both_sides_and_never_stretch_past_their_soft_end() -> None:
    rng = np.random.default_rng(7)
    wrist = np.array([0.2, 0.85, 0.2]) + rng.uniform(-0.08, 0.08, (40, 3))
    wrist[0] = [0.9, 0.9, 0.9]
    hand = np.broadcast_to(hand_frame(np.array([0.0, 0.3, 1.0]), np.array([0.2, 1.0, 0.0])), (40, 4))
    for side in ("left", "right"):
        local = np.tile(quat.IDENTITY, (40, len(REFERENCE), 1))
        at = mirror_points(REFERENCE.rest_model[REFERENCE.index[f"{side}UpperArm"], :3, 3], side)
        shoulder = np.broadcast_to(at, (40, 3))
        pole = np.broadcast_to([1.0, -0.5, -0.3], (40, 3))
        solved, _, reached = solve_arm(shoulder, wrist, pole, hand, local[:, 0])
        for part, q in solved.items():
            local[:, REFERENCE.index[f"{side}{part}"]] = mirror_rotations(q, side)
        position, rotation = REFERENCE.to_model(local)
        joint = REFERENCE.index[f"{side}Hand"]
        assert mirror_points(position[:, joint], side) == pytest.approx(reached, abs=1e-9)
        assert mirror_points(position[1:, joint], side) == pytest.approx(wrist[1:], abs=1e-6)
        assert np.linalg.norm(reached[0] - shoulder[0]) < 0.986 * 0.422
        turned = mirror_rotations(rotation[:, joint], side)
        assert np.abs((turned * hand).sum(-1)) == pytest.approx(np.ones(40))


def test_a_fist_curls_toward_the_palm_and_spread_fans_the_fingers() -> None:
    _, presets = load_hands()
    for preset, name in (("fist", "Middle"), ("spread", "Index"), ("spread", "Little")):
        local = np.tile(quat.IDENTITY, (1, len(REFERENCE), 1))
        for finger, q in finger_rotations(presets[preset][None]).items():
            local[:, REFERENCE.index[f"left{finger}"]] = q
        position, rotation = REFERENCE.to_model(local)
        joint = REFERENCE.index[f"left{name}Intermediate"]
        tip = position[0, joint] + quat.rotate(rotation[0, joint], REFERENCE.rest_translation[joint])
        knuckle = position[0, REFERENCE.index[f"left{name}Proximal"]]
        if preset == "fist":
            assert tip[1] < knuckle[1] - 0.02
        else:
            assert (tip[2] > knuckle[2] + 0.008) if name == "Index" else (tip[2] < knuckle[2] - 0.008)


def test_feet_stay_on_the_floor_in_a_squat_on_tiptoe_and_far_back() -> None:
    shift = np.array([[0, 0, 0], [0, -0.3, 0], [0.03, 0.05, -0.06], [0, 0, 0.1], [0, -0.02, -0.1]], dtype=np.float64)
    hips = quat.from_euler("YX", np.radians([[0, 0], [10, 8], [18, -4], [0, 10], [20, 5]]))
    moved, rotations = legs(shift, hips)
    local = np.tile(quat.IDENTITY, (5, len(REFERENCE), 1))
    local[:, REFERENCE.index["hips"]] = hips
    for name, q in rotations.items():
        local[:, REFERENCE.index[name]] = q
    translation = np.broadcast_to(REFERENCE.rest_translation, (5, len(REFERENCE), 3)).copy()
    translation[:, 0] += moved
    position, _ = REFERENCE.to_model(local, translation)
    for side in ("left", "right"):
        toes = REFERENCE.index[f"{side}Toes"]
        assert position[:, toes] == pytest.approx(np.tile(REFERENCE.rest_model[toes, :3, 3], (5, 1)), abs=2e-4)
    knees = position[:, REFERENCE.index["leftLowerLeg"], 2]
    assert knees[1] > knees[0] + 0.08


def test_the_head_keeps_its_bearing_in_the_world_whatever_the_trunk_does() -> None:
    x = {name: np.zeros(3) for name in CHANNELS}
    x["lean"], x["curl"], x["twist"] = np.array([0.0, 20.0, -12.0]), np.array([0.0, 15.0, 0.0]), np.array([0, 8.0, -9])
    x["head_pitch"], x["head_yaw"] = np.full(3, 10.0), np.full(3, -20.0)
    local = np.tile(quat.IDENTITY, (3, len(REFERENCE), 1))
    for name, q in torso(x)[1].items():
        local[:, REFERENCE.index[name]] = q
    _, rotation = REFERENCE.to_model(local)
    wanted = quat.from_euler("YX", np.radians([-20.0, 10.0]))
    assert np.abs((rotation[:, REFERENCE.index["head"]] * wanted).sum(-1)) == pytest.approx(np.ones(3))


def test_a_score_that_asks_for_a_hand_its_posture_holds_is_refused_with_the_reason() -> None:
    score = load_score("anger")
    crossed = next(cue for cue in score.cues if cue.do == "arms_crossed")
    clash = replace(score, cues=(crossed, replace(crossed, at_s=1.0, do="wave")))
    with pytest.raises(BadInput, match=r"wave at 1\.\d s: .*right_arm.* used by arms_crossed"):
        perform_score(clash, 1, 2.0)
    unknown = replace(score, cues=(crossed, replace(crossed, at_s=1.0, do="juggle")))
    with pytest.raises(BadInput, match="behaviour of the repertoire but saw 'juggle'"):
        perform_score(unknown, 1, 2.0)


def test_effort_orders_the_emotions_as_published() -> None:
    tempo = {emotion: load_effort(emotion).tempo for emotion in ("anger", "joy", "sadness", "neutral", "disgust")}
    assert tempo["anger"] < tempo["neutral"] < tempo["disgust"] < tempo["sadness"]
    assert load_effort("sadness").carriage["shoulders"] < 0 < load_effort("fear").carriage["shoulders"]
    assert load_effort("fear").carriage["forward"] < 0 < load_effort("anger").carriage["forward"]


def test_the_same_seed_gives_the_same_take_and_another_seed_another_timing() -> None:
    clip, notes = perform_take("joy", 3, 4.0)
    again, notes_again = perform_take("joy", 3, 4.0)
    assert np.array_equal(clip.rotation, again.rotation)
    assert notes == notes_again
    _, other = perform_take("joy", 4, 4.0)
    assert [s.behaviour for s in other.spans][:2] == [s.behaviour for s in notes.spans][:2]
    assert other.spans[1].start_s != notes.spans[1].start_s


def test_measure_sees_a_hand_that_is_pushed_into_the_head() -> None:
    clip, _ = perform_take("neutral", 1, 1.0)
    assert measure(clip).hand_depth_m < 0.008
    local = clip.rotation.copy()
    local[:, REFERENCE.index["leftUpperArm"]] = quat.from_euler("ZY", np.radians([35.0, 0.0]))
    local[:, REFERENCE.index["leftLowerArm"]] = quat.from_euler("Z", np.radians([150.0]))
    broken = replace(clip, rotation=local)
    assert measure(broken).hand_depth_m > 0.02
