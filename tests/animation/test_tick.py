"""The compiled tick: its structs are Python's, and its stages alone do what they say."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from game.animation import LifeConfig, Performer, PerformSignal, collision, figure
from game.animation import channels as ch
from game.animation.reach import ARM, LIMB, STRAIGHT, limb_table
from game.animation.tick_data import LAYER, LAYERS, RIGID, ROW, STRUCTS
from game.animation.tick_setup import setup_of
from game.animation.ticking import MODULE
from game.core import quaternion as quat
from game.core.compiled import Machine
from game.core.emotion_space import EMOTIONS
from game.core.humanoid import REFERENCE, TABLE_TOP_M
from game.embos import Decisions, UnitLibrary
from game.embos.draws import character_keys, uniform

DT = 1.0 / 30.0
POINTERS = {"limb_alone": "III", "hands_alone": "IIIII", "unit_alone": "IiIf", "layout": "II"}


class Stages:
    """Stages by name, with arrays as arguments."""

    def __init__(self) -> None:
        self.machine = Machine(MODULE)
        self._functions = {name: self.machine.function(name, form) for name, form in POINTERS.items()}

    def __call__(self, name: str, *values: Any) -> list[np.ndarray]:
        """-> the arrays after it."""
        blocks = [self._put(v) if isinstance(v, np.ndarray) else None for v in values]
        self._functions[name](*[v if b is None else b.address for b, v in zip(blocks, values, strict=True)])
        return [b.data for b in blocks if b is not None]

    def _put(self, array: np.ndarray) -> Any:
        block = self.machine.block(array.shape, array.dtype)
        block.data[...] = array
        return block


@pytest.fixture(scope="module")
def stages() -> Stages:
    return Stages()


def test_both_sides_mean_the_same_structs(stages: Stages) -> None:
    count, told = stages("layout", np.zeros(1, np.uint32), np.zeros(400, np.uint32))
    wanted = [ch.CHANNELS, ROW, LAYERS, len(ch.PARTS)]
    for struct in STRUCTS:
        assert struct.fields is not None
        wanted += [struct.itemsize, *(offset for _, offset in (field[:2] for field in struct.fields.values()))]
    assert told[: int(count[0])].tolist() == wanted


# ---- limbs ----

UPPER_M, LOWER_M = 0.216, 0.206


def limb(share: tuple[float, float]) -> np.ndarray:
    lengths = np.full(4, UPPER_M), np.full(4, LOWER_M)
    return np.array(limb_table(*lengths, np.array([share] * 4))[:1], dtype=LIMB)


def solved(stages: Stages, elbow_deg: float, target: object, share: tuple[float, float] = STRAIGHT) -> Any:
    """A limb along x, bent by elbow_deg, sent to a target -> where its end comes to lie, its turns, the goal's."""
    bend = Rotation.from_euler("y", -elbow_deg, degrees=True)
    joint = np.array([UPPER_M, 0, 0])
    end = joint + bend.apply([LOWER_M, 0, 0])
    goal = Rotation.from_rotvec([0.3, -0.4, 0.9])
    places = [np.zeros(3), np.zeros(3), joint, end, end if target is None else np.asarray(target)]
    bones = np.zeros(5, dtype=RIGID)
    bones["place"] = places
    bones["turn"] = [r.as_quat() for r in (Rotation.identity(), Rotation.identity(), bend, bend, goal)]
    local = stages("limb_alone", limb(share), bones, np.zeros((3, 4), np.float32))[-1]
    upper, lower, last = (Rotation.from_quat(q) for q in local)
    reached = upper.apply(joint) + (upper * lower).apply([LOWER_M, 0, 0])
    return reached, (upper, bend.inv() * lower), (goal.inv() * upper * lower * last).magnitude()


@pytest.mark.parametrize("elbow", [0.0, 20.0, 90.0, 140.0])
@pytest.mark.parametrize("target", [(0.2, 0.1, 0.2), (-0.1, 0.25, 0.15), (0.05, -0.3, 0.1), (0.12, 0.0, 0.02)])
def test_limbs_reach_their_targets(stages: Stages, elbow: float, target: tuple[float, float, float]) -> None:
    reached, _, off = solved(stages, elbow, target)
    np.testing.assert_allclose(reached, target, atol=2e-3)
    assert off < 1e-3, "the end is turned as it shall be"


def test_a_limb_that_is_there_stays_as_it_is(stages: Stages) -> None:
    _, turns, _ = solved(stages, 70.0, None, ARM)
    assert max(turn.magnitude() for turn in turns) < 2e-3


@pytest.mark.parametrize("share", [ARM, STRAIGHT, (0.985, 0.999)])
def test_a_reach_ends_softly_and_never_runs_ahead_of_what_is_asked(stages: Stages, share: tuple[float, float]) -> None:
    full = UPPER_M + LOWER_M
    asked = np.linspace(0.85, 1.3, 150)
    got = np.array([np.linalg.norm(solved(stages, 40.0, (a * full, 0, 0), share)[0]) for a in asked]) / full
    near = asked < share[0] - 0.01
    np.testing.assert_allclose(got[near], asked[near], atol=3e-3)
    assert got.max() < share[1] + 1e-3
    assert (np.diff(got) < np.diff(asked) + 4e-4).all()
    assert (np.diff(got) > -1e-3).all()


# ---- body and table ----


def pushed(stages: Stages, left: tuple[float, float, float], right: tuple[float, float, float]) -> np.ndarray:
    """Wrists in the open hand of a figure at rest -> (2, 3) how far they are pushed."""
    body = np.zeros(len(figure.FIGURE), dtype=RIGID)
    body["turn"], body["place"] = quat.IDENTITY, REFERENCE.rest_model[figure.FIGURE, :3, 3]
    goals = np.zeros(2, dtype=RIGID)
    goals["turn"], goals["place"] = quat.IDENTITY, (left, right)
    # Elbows outside and above, so that the forearm is far from all.
    for side, (hand, sign) in enumerate(((left, 1.0), (right, -1.0))):
        bones = figure.BONES.reshape(4, 4).T[side]
        body["place"][bones[3]] = hand
        body["place"][bones[2]] = np.add(hand, (0.3 * sign, 0.5, 0.2))
    points = np.zeros((2, ch.POINTS_PER_HAND, 3), np.float32)
    points[:, :, 0] = np.array([[0.08], [-0.08]])
    made = stages("hands_alone", setup_of(LifeConfig()), body, goals, points, np.zeros((2, 3), np.float32))
    return np.array(made[-1])


FAR = ((1.0, 1.5, 0.0), (-1.0, 1.5, 0.0))


def distance(point: np.ndarray) -> float:
    """How far a point lies outside the body at rest, by the ellipsoids' level sets; a plain reference."""
    return min(float((np.linalg.norm((point - c) / r) - 1.0) * min(r)) for _, c, r in collision.BODY)


def test_hands_in_the_open_are_left_alone(stages: Stages) -> None:
    assert not pushed(stages, *FAR).any()


def test_hands_inside_the_body_are_pushed_to_its_surface(stages: Stages) -> None:
    radius = float(collision.POINT_RADII[0] - collision.TOLERANCE_M[0])
    for wrist in ((0.05, 0.82, 0.09), (0.09, 0.70, 0.07), (0.10, 1.2, 0.13)):
        push = pushed(stages, wrist, FAR[1])
        assert not push[1].any()
        assert distance(np.array(wrist)) < radius
        assert distance(wrist + push[0]) > 0.4 * radius
        assert push[0, 2] > 0.0, "forward, where it came from"
        again = pushed(stages, tuple(wrist + push[0]), FAR[1])
        assert np.linalg.norm(again[0]) < 0.35 * np.linalg.norm(push[0])


def test_a_push_grows_smoothly_from_before_the_touch(stages: Stages) -> None:
    ways = [pushed(stages, (0.0, 0.80, z), FAR[1])[0] for z in np.arange(0.20, 0.12, -0.001)]
    size = np.linalg.norm(ways, axis=1)
    assert size[0] == 0.0
    assert size[-1] > 0.005
    assert (np.diff(size) > -1e-4).all()
    assert np.diff(size).max() < 2e-3


def test_hands_on_the_table_are_lifted_and_below_its_edge_drawn_back(stages: Stages) -> None:
    push = pushed(stages, (0.25, 0.58, 0.4), (-0.35, 0.50, 0.14))
    np.testing.assert_allclose(0.58 + push[0, 1], TABLE_TOP_M + 0.027 + 0.004, atol=1e-3)
    assert push[1, 2] < -0.005
    assert abs(push[1, 1]) < 0.01


# ---- a unit's way through its clip ----


def layer_of(**values: float) -> np.ndarray:
    """A unit with its stroke at 0.5 s and frame 12, played at 33 frames a second, of 60 frames."""
    layer = np.zeros(1, dtype=LAYER)
    layer["active"], layer["frames"] = 1, 60.0
    for name, value in ({"before_s": 0.5, "lead_rate": 24.0, "after_rate": 33.0, "last": 60.0} | values).items():
        layer[name] = value
    return layer


def frame_at(layer: np.ndarray, elapsed_s: float) -> float:
    """The frame by hand: lead, then the rest with its repeats or its slowed middle."""
    at = {name: float(layer[name][0]) for name in LAYER.names or () if layer[name].ndim == 1}
    frame = min(elapsed_s, at["before_s"]) * at["lead_rate"] + max(elapsed_s - at["before_s"], 0.0) * at["after_rate"]
    if at["loop_times"]:
        rounds = (frame - at["loop_first"]) // at["loop_frames"]
        frame -= at["loop_frames"] * min(max(rounds, 0.0), at["loop_times"])
    if at["held"]:
        turn = 2.0 * np.pi * min(max((frame - at["hold_first"]) / at["hold_length"], 0.0), 1.0)
        frame -= at["held"] * (turn - np.sin(turn)) / (2.0 * np.pi)
    return frame


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"loop_first": 20.0, "loop_frames": 10.0, "loop_times": 3.0},
        {"hold_first": 22.0, "hold_length": 40.0, "held": 16.0},
    ],
)
def test_a_unit_goes_through_its_clip_to_its_end(stages: Stages, values: dict[str, float]) -> None:
    layer, elapsed, before, jumps = layer_of(**values), 0.0, 0.0, 0
    for _ in range(300):
        layer, event = stages("unit_alone", layer, 0, np.zeros(1, np.int32), DT)
        elapsed += DT
        jumps += int(event[0])
        if not layer["active"][0]:
            break
        frame = float(layer["row"][0, 3] + layer["part"][0, 3])
        assert frame == pytest.approx(frame_at(layer, elapsed), abs=2e-3)
        if not event[0] and elapsed > 0.6:
            assert float(layer["rate"][0]) == pytest.approx((frame - before) / DT, abs=3.0), "its speed is told"
        before = frame
    assert frame_at(layer, elapsed) >= 60.0 - 1e-3, "it ends where the clip ends"
    assert jumps == 1 + values.get("loop_times", 0.0)


def test_a_posture_goes_round_its_loops(stages: Stages) -> None:
    layer = layer_of(before_s=np.inf, lead_rate=30.0, last=np.inf, elapsed_s=2.18)
    layer["frames"] = [20.0, 14.0, 8.0, 25.0, 17.0, 18.0, 85.0]
    for _ in range(200):
        layer, event = stages("unit_alone", layer, 1, np.zeros(1, np.int32), DT)
        assert not event[0]
        frame, loops = (layer["row"] + layer["part"])[0], layer["frames"][0]
        # The end of a loop is its beginning.
        away = np.abs(frame - np.fmod(30.0 * float(layer["elapsed_s"][0]), loops))
        assert np.minimum(away, loops - away).max() < 1e-3
        assert (frame <= loops + 1e-3).all()


# ---- states ----


def still(library: UnitLibrary, performer: Performer, n: int) -> tuple[Decisions, PerformSignal]:
    unit = np.tile([library.index["upright"], *performer.bank.rest[1:]], (n, 1))
    numbers = np.zeros((n, 3, 11))
    numbers[..., 1], numbers[:, 0, 4 + EMOTIONS.index("joy")] = 3.0, 1.0
    felt = np.tile(np.eye(7)[EMOTIONS.index("joy")], (n, 1))
    return Decisions(unit, np.zeros((n, 3), bool), numbers), PerformSignal(
        felt, np.tile([0, 1, 3.0], (n, 1)), felt[:, 0]
    )


def test_a_state_is_a_value(library: UnitLibrary) -> None:
    performer = Performer(library)
    decisions, signal = still(library, performer, 2)
    state, _ = performer.advance(performer.start(2), decisions, signal, DT)
    kept = state.characters.tobytes()
    (one, a), (two, b) = (performer.advance(state, decisions, signal, DT) for _ in range(2))
    assert state.characters.tobytes() == kept
    assert one.characters.tobytes() == two.characters.tobytes()
    assert np.array_equal(a.rotation, b.rotation)
    with pytest.raises(ValueError, match="read-only"):
        a.rotation[0] = 0.0


def test_eyes_and_lids_follow_the_draws_that_every_company_shares(library: UnitLibrary) -> None:
    performer, life = Performer(library), LifeConfig()
    decisions, signal = still(library, performer, 3)
    state = performer.start(3, seed=4)
    joy, zero = EMOTIONS.index("joy"), np.zeros(3, dtype=np.int64)
    keys = character_keys(4 ^ 0x11FE, 0, 3)
    right, up, wait, size = uniform(keys, zero, zero, 4).T
    first, second = uniform(keys, zero + 1, zero, 2).T
    seen = np.zeros((3, 2), dtype=bool)
    for _ in range(180):
        before, (state, _) = state.characters, performer.advance(state, decisions, signal, DT)
        now = state.characters
        for who in np.flatnonzero((before["darts"] == 0) & (now["darts"] == 1)):
            far = 0.0 if size[who] < 0.33 else 2.0 * life.dart_size[joy]
            wanted = (right[who] - 0.5) * 2.0 * far, (up[who] - 0.5) * far
            np.testing.assert_allclose(now["dart"][who], wanted, rtol=1e-5)
            assert now["dart_left_s"][who] == pytest.approx((0.35 + 1.3 * wait[who]) / life.darts_per_s[joy])
            seen[who, 0] = True
        for who in np.flatnonzero((before["blinks"] == 0) & (now["blinks"] == 1)):
            rest = (0.3 + 1.4 * first[who]) * 60.0 / life.blinks_per_min[joy]
            assert now["blink_left_s"][who] == pytest.approx(0.3 if second[who] < 0.125 else rest)
            seen[who, 1] = True
    assert seen.all()


def test_performers_and_states_travel_between_processes(library: UnitLibrary) -> None:
    performer = Performer(library)
    decisions, signal = still(library, performer, 3)
    state, _ = performer.advance(performer.start(3, seed=2), decisions, signal, DT)
    there, moved = pickle.loads(pickle.dumps((performer, state)))
    mine, theirs = performer.advance(state, decisions, signal, DT)[1], there.advance(moved, decisions, signal, DT)[1]
    assert np.array_equal(mine.rotation, theirs.rotation)
    assert np.array_equal(mine.gaze, theirs.gaze)
