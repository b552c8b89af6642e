"""Whole ticks: what the decisions ask for is what the body does, without pops, in any company, at any frame rate."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from game.animation import (
    GAZE_AWAY,
    GAZE_CUSTOMER,
    GAZE_GOODS,
    MODES,
    Performer,
    PerformSignal,
    Pose,
    interpolate_pose,
    largest_joint_acceleration,
)
from game.animation.channels import PART_OF_JOINT, PARTS, WRIST
from game.core import quaternion as quat
from game.core.emotion_space import EMOTIONS, emotion_vector
from game.core.humanoid import REFERENCE, TABLE_TOP_M
from game.embos import Decisions, UnitLibrary

DT = 1.0 / 30.0
J = REFERENCE.index
REST = ("rest_gesture", "rest_mannerism")


def decided(unit: np.ndarray, started: np.ndarray, seconds: np.ndarray, weights: np.ndarray) -> Decisions:
    numbers = np.concatenate([np.zeros((*unit.shape, 4)), weights], axis=-1)
    numbers[..., 1], numbers[..., 2] = seconds, 0.3
    return Decisions(unit, started, numbers)


class Script:
    """Decisions by hand: (time, posture, gesture, mannerism[, seconds])."""

    def __init__(self, library: UnitLibrary, *lines: tuple[object, ...], emotion: str = "joy") -> None:
        self.library, self.lines = library, lines
        self.emotion = emotion_vector({emotion: 1.0} if emotion != "neutral" else {})

    def at(self, tick: int, dt: float = DT, n: int = 1) -> Decisions:
        now = tick * dt
        passed = [line for line in self.lines if float(line[0]) <= now + 1e-9]  # type: ignore[arg-type]
        line = passed[-1]
        unit = np.tile([self.library.index[str(name)] for name in line[1:4]], (n, 1))
        before = [x for x in self.lines if float(x[0]) <= now - dt + 1e-9]  # type: ignore[arg-type]
        started = np.array([tick == 0 or line[1 + i] != before[-1][1 + i] for i in range(3)])
        weights = np.stack([self.library.mix_weights(self.emotion, u) for u in unit[0]])
        seconds = float(line[4]) if len(line) > 4 else 2.0  # type: ignore[arg-type]
        return decided(unit, np.tile(started, (n, 1)), np.full((n, 3), seconds), np.tile(weights, (n, 1, 1)))

    def signal(self, n: int = 1, gaze: np.ndarray = GAZE_CUSTOMER, mode: str = "full") -> PerformSignal:
        return PerformSignal(np.tile(self.emotion, (n, 1)), np.tile(gaze, (n, 1)), np.zeros(n), mode)  # type: ignore[arg-type]


def play(
    performer: Performer, script: Script, seconds: float, dt: float = DT, n: int = 1, **signal: object
) -> list[Pose]:
    state = performer.start(n, seed=5)
    poses = []
    for tick in range(round(seconds / dt)):
        state, pose = performer.advance(state, script.at(tick, dt, n), script.signal(n, **signal), dt)  # type: ignore[arg-type]
        poses.append(pose)
    return poses


def rotations(poses: list[Pose]) -> np.ndarray:
    return np.stack([p.rotation[0] for p in poses]).astype(float)


def positions(poses: list[Pose]) -> np.ndarray:
    """(F, 41, 3) in model space."""
    shift = np.tile(REFERENCE.rest_translation, (len(poses), 1, 1))
    shift[:, 0] = [p.root[0] for p in poses]
    return np.asarray(REFERENCE.to_model(rotations(poses), shift)[0])


@pytest.fixture(scope="module")
def performer(library: UnitLibrary) -> Performer:
    """Without collisions: the made-up takes pay no heed to body and table."""
    return Performer(library, collide=False)


BUSY = (
    (0.0, "upright", *REST),
    (1.0, "hand_on_table", *REST),
    (2.2, "hand_on_table", "point", "rest_mannerism"),
    (3.1, "upright", "rest_gesture", "touch_face"),
    (3.4, "hand_on_table", "point", "rest_mannerism"),
    (5.0, "upright", "rest_gesture", "tap", 6.0),
    (8.0, "hand_on_table", *REST),
)


def test_transitions_do_not_pop(library: UnitLibrary, performer: Performer) -> None:
    poses = play(performer, Script(library, *BUSY), 9.0)
    own = max(largest_joint_acceleration(take.rotation) for take in library.clips.values())
    # A move taken over 0.3 s after it began is the hardest case here.
    assert largest_joint_acceleration(rotations(poses)) < 4.5 * own
    wrists = positions(poses)[:, [J["leftHand"], J["rightHand"]]]
    assert np.linalg.norm(np.diff(wrists, axis=0), axis=-1).max() / DT < 3.0


def test_taking_up_another_repertoire_goes_on_from_where_the_body_is_and_as_fast(
    library: UnitLibrary, performer: Performer
) -> None:
    script = Script(library, *BUSY)
    for moment in (73, 76, 97):  # in the middle of a move
        state, poses = performer.start(1, seed=5), []
        for tick in range(moment + 30):
            if tick == moment:
                state = Performer(library, collide=False).adopt(state, performer)
            state, pose = performer.advance(state, script.at(tick), script.signal(), DT)
            poses.append(pose)
        own = max(largest_joint_acceleration(take.rotation) for take in library.clips.values())
        assert largest_joint_acceleration(rotations(poses)[moment - 4 : moment + 6]) < 1.7 * own


def test_a_cut_without_transition_would_be_seen_by_the_measure(library: UnitLibrary) -> None:
    take = library.clips["joy"].rotation
    cut = np.concatenate([take[:30], take[340:370]])
    assert largest_joint_acceleration(cut) > 3 * largest_joint_acceleration(take)


def test_a_hand_on_the_table_stays_there_while_the_torso_moves(library: UnitLibrary, performer: Performer) -> None:
    script = Script(library, (0.0, "hand_on_table", *REST), (1.5, "hand_on_table", "point", "rest_mannerism"))
    poses = play(performer, script, 3.4)
    at = positions(poses)
    heights = at[10:, J["leftHand"], 1]
    chest = at[10:, J["chest"]]
    assert np.ptp(chest, axis=0).max() > 0.004, "the torso moves"
    clip = performer.bank.rows[:, WRIST.start + 1]  # the left wrist's height in table space, as recorded
    first = performer.bank.first[library.index["hand_on_table"], 2, 0]
    recorded = clip[first : first + int(performer.bank.frames[library.index["hand_on_table"], 2, 0])]
    assert recorded.min() - 0.005 < heights.min()
    assert heights.max() < recorded.max() + 0.005


def test_a_hand_at_the_face_keeps_its_distance_from_it(library: UnitLibrary, performer: Performer) -> None:
    def gap(posture: str) -> np.ndarray:
        script = Script(library, (0.0, posture, *REST), (1.0, posture, "rest_gesture", "touch_face"))
        at = positions(play(performer, script, 2.6))
        return np.linalg.norm(at[:, J["rightHand"]] - at[:, J["head"]], axis=-1)[60:75]

    assert np.abs(gap("upright") - gap("hand_on_table")).max() < 0.012


def test_feet_stay_planted(library: UnitLibrary, performer: Performer) -> None:
    at = positions(play(performer, Script(library, *BUSY), 9.0))
    for side in ("left", "right"):
        foot = at[:, J[f"{side}Foot"]]
        assert np.abs(foot - REFERENCE.rest_model[J[f"{side}Foot"], :3, 3]).max() < 0.012


def test_one_alone_is_one_of_many(library: UnitLibrary, performer: Performer) -> None:
    script = Script(library, *BUSY)
    alone, crowd = performer.start(1, 5, first=2), performer.start(12, 5)
    for tick in range(120):
        alone, one = performer.advance(alone, script.at(tick), script.signal(), DT)
        crowd, many = performer.advance(crowd, script.at(tick, n=12), script.signal(12), DT)
        dots = np.abs((one.rotation[0] * many.rotation[2]).sum(-1))
        assert dots.min() > 1 - 1e-4
        np.testing.assert_allclose(one.root[0], many.root[2], atol=1e-4)
        np.testing.assert_allclose(one.gaze[0], many.gaze[2], atol=1e-4)
        assert one.blink[0] == pytest.approx(many.blink[2], abs=1e-6)
    assert np.abs(many.rotation[2] - many.rotation[3]).max() > 1e-3, "each sways in a way of its own"


def test_frame_rate_does_not_matter(library: UnitLibrary, performer: Performer) -> None:
    script = Script(library, (0.0, "upright", *REST), (1.0, "hand_on_table", *REST), (2.0, "upright", "point", REST[1]))
    slow = play(performer, script, 3.5)
    fast = play(performer, script, 3.5, dt=DT / 2)
    a = rotations(slow)[1:]
    b = rotations(fast)[2::2][: len(a)]
    angle = 2 * np.arccos(np.clip(np.abs((a * b).sum(-1)), 0, 1))
    assert np.degrees(angle.max()) < 6.0
    assert np.degrees(np.median(angle)) < 0.3


def test_a_gesture_moves_only_its_own_parts_and_leaves_a_trace_in_the_torso(
    library: UnitLibrary, performer: Performer
) -> None:
    without = rotations(play(performer, Script(library, (0.0, "upright", *REST)), 2.5))
    with_point = rotations(
        play(performer, Script(library, (0.0, "upright", *REST), (0.5, "upright", "point", REST[1])), 2.5)
    )
    turn = np.degrees(2 * np.arccos(np.clip(np.abs((without * with_point).sum(-1)), 0, 1))).max(axis=0)
    part = {p: turn[i == PART_OF_JOINT].max() for i, p in enumerate(PARTS)}
    assert part["right_arm"] > 25
    assert part["left_hand"] < 0.2
    assert part["head"] < 10
    assert 1 < turn[J["chest"]] < 10


def test_between_joy_and_anger_the_pose_lies_between(library: UnitLibrary, performer: Performer) -> None:
    def mean(emotion: np.ndarray) -> np.ndarray:
        script = Script(library, (0.0, "upright", *REST))
        script.emotion = emotion
        return rotations(play(performer, script, 4.8))[60:, J["chest"]].mean(axis=0)

    anger, joy = mean(emotion_vector({"anger": 1.0})), mean(emotion_vector({"joy": 1.0}))
    middle = mean(emotion_vector({"anger": 0.5, "joy": 0.5}))
    assert min(anger[0], joy[0]) < middle[0] < max(anger[0], joy[0])
    assert abs(anger[0] - joy[0]) > 0.01


def test_a_posture_follows_the_emotion_slowly(library: UnitLibrary, performer: Performer) -> None:
    script = Script(library, (0.0, "upright", *REST), emotion="anger")
    state = performer.start(1)
    chest = []
    for tick in range(240):
        if tick == 60:
            script.emotion = emotion_vector({"joy": 1.0})
        state, pose = performer.advance(state, script.at(tick), script.signal(), DT)
        chest.append(float(pose.rotation[0, J["chest"], 0]))
    assert np.abs(np.diff(chest)).max() < 0.01
    assert state.weight[0, 0, EMOTIONS.index("joy")] > 0.95


def test_modes_hold_what_they_do_not_show(library: UnitLibrary, performer: Performer) -> None:
    script = Script(library, *BUSY)
    neutral = Script(library, (0.0, "upright", *REST), emotion="neutral")
    assert np.array_equal(rotations(play(performer, script, 4.0, mode="body")), rotations(play(performer, script, 4.0)))
    still = rotations(play(performer, script, 4.0, mode="face"))
    np.testing.assert_allclose(still, rotations(play(performer, neutral, 4.0, mode="face")), atol=1e-5)
    gestures = rotations(play(performer, script, 4.0, mode="gestures"))
    arm = [J["rightUpperArm"], J["rightLowerArm"]]
    legs = J["leftLowerArm"]
    assert np.abs(gestures - still)[:, arm].max() > 0.2, "the gestures are there"
    assert np.abs(gestures - still)[:, legs].max() < 0.05, "the posture is not"


def test_gaze_eyes_lead_and_the_head_follows(library: UnitLibrary, performer: Performer) -> None:
    script = Script(library, (0.0, "upright", *REST), emotion="neutral")
    state = performer.start(1)
    eyes, head = [], []
    for tick in range(60):
        state, pose = performer.advance(
            state, script.at(tick), script.signal(gaze=GAZE_CUSTOMER if tick < 20 else GAZE_AWAY), DT
        )
        eyes.append(float(pose.gaze[0, 0]))
        head.append(float(state.head[0, 0]))
    assert eyes[22] < -0.7, "the eyes are there at once"
    assert abs(head[22]) < 0.4 * abs(head[59]), "the head takes its time"
    assert eyes[59] > eyes[23], "as the head arrives the eyes return"
    down = play(performer, script, 2.0, gaze=GAZE_GOODS)[-1]
    assert down.gaze[0, 1] < -0.2


def test_nothing_is_ever_frozen_and_eyes_blink(library: UnitLibrary, performer: Performer) -> None:
    poses = play(performer, Script(library, (0.0, "upright", *REST), emotion="neutral"), 12.0)
    q = rotations(poses)[:, J["head"]]
    assert (np.abs(np.diff(q, axis=0)).max(axis=1) > 1e-6).all()
    blink = np.array([p.blink[0] for p in poses])
    assert blink.max() == 1.0
    assert 1 <= (np.diff((blink > 0.5).astype(int)) == 1).sum() <= 8
    breath = np.array([p.breath[0] for p in poses])
    assert breath.min() < 0.05
    assert breath.max() > 0.95


def test_hands_are_kept_out_of_the_table(library: UnitLibrary) -> None:
    at = positions(play(Performer(library), Script(library, *BUSY), 9.0))
    for side in ("left", "right"):
        hand = at[:, J[f"{side}Hand"]]
        over = (hand[:, 2] > 0.2) & (hand[:, 2] < 0.74)
        assert (hand[over, 1] > TABLE_TOP_M + 0.01).all()


def test_poses_between_ticks(library: UnitLibrary, performer: Performer) -> None:
    a, b = play(performer, Script(library, *BUSY), 0.1)[-2:]
    half = interpolate_pose(a, b, 0.5)
    np.testing.assert_allclose(half.root, (a.root + b.root) / 2)
    np.testing.assert_allclose(np.linalg.norm(half.rotation, axis=-1), 1.0, atol=1e-5)
    np.testing.assert_allclose(interpolate_pose(a, b, 0.0).rotation, a.rotation, atol=1e-6)


@lru_cache(maxsize=1)
def _colliding(library: UnitLibrary) -> Performer:
    return Performer(library)


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_any_decisions_give_unit_quaternions(library: UnitLibrary, seed: int) -> None:
    rng = np.random.default_rng(seed)
    performer = _colliding(library)
    n = int(rng.integers(1, 12))
    layers = [library.of_layer(layer) for layer in performer.layers]
    state = performer.start(n, seed)
    unit = np.stack([rng.choice(ids, n) for ids in layers], axis=1)
    for tick in range(40):
        started = rng.random((n, 3)) < (1.0 if tick == 0 else 0.15)
        unit = np.where(started, np.stack([rng.choice(ids, n) for ids in layers], axis=1), unit)
        emotion = rng.dirichlet(np.ones(7), n)
        weights = library.mix_weights(emotion[:, None], unit)
        decisions = decided(unit, started, rng.uniform(0.0, 5.0, (n, 3)), weights)
        signal = PerformSignal(
            emotion,
            rng.normal(size=(n, 3)) * 2,
            rng.random(n),
            MODES[int(rng.integers(4))] if tick % 9 == 0 else "full",
        )
        state, pose = performer.advance(state, decisions, signal, float(rng.uniform(0.005, 0.05)))
        assert np.isfinite(pose.rotation).all()
        np.testing.assert_allclose(np.linalg.norm(pose.rotation, axis=-1), 1.0, atol=1e-4)
        assert np.abs(pose.gaze).max() <= 1.0
        assert np.linalg.norm(pose.root - REFERENCE.rest_translation[0], axis=-1).max() < 0.5


def test_long_units_repeat_their_rhythm_instead_of_stretching(library: UnitLibrary, performer: Performer) -> None:
    unit = library.index["tap"]
    assert performer.bank.loop_frames[unit] > 0
    period = performer.bank.loop_frames[unit] % 15
    assert min(period, 15 - period) <= 1, "whole periods of 2 Hz at 30 fps"
    script = Script(library, (0.0, "upright", *REST), (0.5, "upright", "rest_gesture", "tap", 14.0))
    wrist = rotations(play(performer, script, 12.0))[60:330, J["leftHand"]]
    signal = wrist[:, 2] - wrist[:, 2].mean()
    spectrum = np.abs(np.fft.rfft(signal * np.hanning(len(signal))))
    peak = np.fft.rfftfreq(len(signal), DT)[spectrum.argmax()]
    assert 1.4 < peak < 2.8


def test_quaternions_of_layers_are_the_clip_where_nothing_is_added(library: UnitLibrary, performer: Performer) -> None:
    poses = play(performer, Script(library, (0.0, "upright", *REST), emotion="joy"), 1.0)
    finger = J["leftIndexProximal"]
    wanted = library.clips["joy"].rotation[10, finger].astype(float)
    assert abs(float((rotations(poses)[10, finger] * wanted).sum())) > 1 - 1e-5
    elbow = J["rightLowerArm"]
    turn = quat.log(rotations(poses)[:, elbow])
    assert 70 < np.degrees(np.linalg.norm(turn, axis=-1)).mean() < 120
