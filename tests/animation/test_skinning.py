"""The rig: skinning against plain matrices, forearm twist, and spring bones that settle and stay outside."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from game.animation import Pose, Rig, SpringChain, SpringCollider, skin_loop
from game.animation.clearance import FINGER, HAND, SHAPE
from game.animation.fitting import BODY_PART, FIGURE_JOINT, FIGURE_LIMB, FIT
from game.animation.skin_loop import EYES, FOLD, JOINT, RIG, SPRUNG
from game.animation.springbones import COLLIDER, PIECE
from game.core import quaternion as quat
from game.core.compiled import Machine
from game.core.errors import BadInput
from game.core.humanoid import REFERENCE

DT = 1.0 / 30.0
BARE = np.tile(np.eye(4), (47, 1, 1))


def pose_of(rotation: np.ndarray, root: np.ndarray | None = None) -> Pose:
    n = len(rotation)
    base = np.tile(REFERENCE.rest_translation[0], (n, 1)) if root is None else root
    zero = np.zeros(n)
    return Pose(rotation.astype(np.float32), base.astype(np.float32), np.zeros((n, 2)), zero, zero)


def random_pose(n: int, seed: int = 0) -> Pose:
    rng = np.random.default_rng(seed)
    rotation = quat.exp(rng.normal(size=(n, len(REFERENCE), 3)) * 0.4)
    return pose_of(rotation, REFERENCE.rest_translation[0] + rng.normal(size=(n, 3)) * 0.05)


def rig_arrays() -> tuple[list[str], list[int], list[np.ndarray]]:
    """REFERENCE with twist joints and a hanging chain of three pieces behind the head."""
    names, parents = list(REFERENCE.names), list(REFERENCE.parents)
    rest = list(REFERENCE.rest_translation)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        names.append(f"{side}ForearmTwist")
        parents.append(REFERENCE.index[f"{side}LowerArm"])
        rest.append(np.array([0.103 * sign, 0, 0]))
    parent = REFERENCE.index["head"]
    for piece in range(4):
        names.append(f"tail{piece}")
        parents.append(parent)
        rest.append(np.array([0.0, 0.1, -0.2]) if piece == 0 else np.array([0.0, -0.08, -0.01]))
        parent = len(names) - 1
    return names, parents, rest


def binds() -> np.ndarray:
    """(J, 4, 4) inverse bind matrices of a mesh that was bound in whatever pose."""
    rng = np.random.default_rng(4)
    frames = [np.eye(4) for _ in rig_arrays()[0]]
    for frame in frames:
        frame[:3, :3], frame[:3, 3] = Rotation.random(random_state=rng).as_matrix(), rng.normal(size=3)
    return np.linalg.inv(frames)


def make_rig(
    *, springs: bool = False, radius: float = 0.05, colliders: bool = True, bind: np.ndarray | None = None
) -> Rig:
    names, parents, rest = rig_arrays()
    first = names.index("tail0")
    chain = SpringChain(
        joints=tuple(range(first, first + 4)),
        stiffness=(0.6,) * 3,
        gravity_power=(0.3,) * 3,
        gravity_dir=((0.0, -1.0, 0.0),) * 3,
        drag=(0.35,) * 3,
        hit_radius_m=(0.01,) * 3,
        colliders=(0, 1) if colliders else (),
    )
    balls = (
        SpringCollider(names.index("neck"), (0.0, 0.0, -0.15), radius),
        SpringCollider(names.index("chest"), (-0.1, 0.1, -0.1), 0.06, (0.1, 0.1, -0.1)),
    )
    return Rig.from_arrays(
        names,
        np.array(parents),
        np.array(rest),
        bind,
        chains=(chain,) if springs else (),
        colliders=balls if springs and colliders else (),
    )


def test_both_sides_mean_the_same_structs() -> None:
    machine = Machine(Path(skin_loop.__file__).with_name("skin.wasm"))
    count, told = machine.block(1, np.uint32), machine.block(300, np.uint32)
    machine.function("layout", "II")(count.address, told.address)
    wanted: list[int] = []
    for struct in (
        JOINT,
        FOLD,
        EYES,
        SPRUNG,
        PIECE,
        COLLIDER,
        RIG,
        FIGURE_JOINT,
        FIGURE_LIMB,
        BODY_PART,
        SHAPE,
        FINGER,
        HAND,
        FIT,
    ):
        assert struct.fields is not None
        wanted += [struct.itemsize, *(field[1] for field in struct.fields.values())]
    room = skin_loop.ROOM_BYTES
    wanted += [2 * 3 * 4, room["pull"], room["capsule"], room["turn"], room["model"]]
    assert told.data[: int(count.data[0])].tolist() == wanted


def test_skin_matrices_agree_with_plain_kinematics() -> None:
    rig, pose = make_rig(bind=binds()), random_pose(5)
    _, skin = rig.advance(rig.start(5), pose, DT)
    joints = rig.joint_matrices(pose)
    shift = np.tile(REFERENCE.rest_translation, (5, 1, 1))
    shift[:, 0] = pose.root
    position, rotation = REFERENCE.to_model(pose.rotation.astype(float), shift)
    for joint in range(len(REFERENCE)):
        model = np.tile(np.eye(4), (5, 1, 1))
        model[:, :3, :3] = quat.to_matrix(rotation[:, joint])
        model[:, :3, 3] = position[:, joint]
        np.testing.assert_allclose(joints[:, joint], model, atol=1e-5)
        np.testing.assert_allclose(skin[:, joint], model @ binds()[joint], atol=1e-4)
    # What hangs still on a joint goes with it.
    tail = rig.skeleton.index["tail3"]
    moved = joints[:, REFERENCE.index["head"]] @ np.array([0.0, 0.1 - 0.24, -0.2 - 0.03, 1.0])
    np.testing.assert_allclose(joints[:, tail, :3, 3], moved[:, :3], atol=1e-5)
    np.testing.assert_allclose(skin[:, tail], joints[:, tail] @ binds()[tail], atol=1e-4)


def test_a_crowd_is_skinned_like_one() -> None:
    rig, pose = make_rig(springs=True, bind=binds()), random_pose(150)
    state, skin = rig.advance(rig.start(150), pose, DT)
    state, after = rig.advance(state, random_pose(150, seed=1), DT)
    few = Pose(*(getattr(pose, f)[70:73] for f in ("rotation", "root", "gaze", "blink", "breath")))
    then = random_pose(150, seed=1)
    later = Pose(*(getattr(then, f)[70:73] for f in ("rotation", "root", "gaze", "blink", "breath")))
    own, own_skin = rig.advance(rig.start(3), few, DT)
    assert np.array_equal(own_skin, skin[70:73])
    assert np.array_equal(rig.advance(own, later, DT)[1], after[70:73])
    # A state is a value: what was begun from it can be begun again.
    assert np.array_equal(rig.advance(own, later, DT)[1], after[70:73])


def test_the_rest_pose_moves_nothing() -> None:
    names, parents, rest = rig_arrays()
    rig = Rig.from_arrays(names, np.array(parents), np.array(rest))
    still = pose_of(np.tile(quat.IDENTITY, (1, len(REFERENCE), 1)))
    np.testing.assert_allclose(rig.advance(rig.start(1), still, DT)[1][0], np.tile(np.eye(4), (47, 1, 1)), atol=1e-5)


@pytest.mark.parametrize("angle", [-2.2, -0.5, 0.0, 1.0, 2.4])
def test_the_forearm_takes_half_of_the_hands_twist(angle: float) -> None:
    rig = make_rig()
    q = np.tile(quat.IDENTITY, (1, len(REFERENCE), 1))
    bend = Rotation.from_euler("z", 0.5)
    q[0, REFERENCE.index["leftHand"]] = (bend * Rotation.from_euler("x", angle)).as_quat()
    model = rig.joint_matrices(pose_of(q))[0]
    arm, twist = (model[rig.skeleton.index[f"left{name}"], :3, :3] for name in ("LowerArm", "ForearmTwist"))
    np.testing.assert_allclose(Rotation.from_matrix(arm.T @ twist).as_rotvec(), [angle / 2, 0, 0], atol=1e-5)


def test_a_turned_rest_pose_is_retargeted() -> None:
    rest = np.array([[0.0, 0.8, 0.0], [0.0, 0.1, 0.0], [0.0, 0.1, 0.0]])
    turn = Rotation.from_euler("y", 90, degrees=True).as_quat()
    rig = Rig.from_arrays(
        ["hips", "spine", "chest"],
        np.array([-1, 0, 1]),
        rest,
        rest_rotation=np.array([quat.IDENTITY, turn, quat.IDENTITY]),
    )
    q = np.tile(quat.IDENTITY, (1, len(REFERENCE), 1))
    q[0, REFERENCE.index["spine"]] = Rotation.from_euler("x", 30, degrees=True).as_quat()
    model = rig.joint_matrices(pose_of(q))[0]
    wanted = (Rotation.from_euler("x", 30, degrees=True) * Rotation.from_quat(turn)).as_matrix()
    np.testing.assert_allclose(model[1, :3, :3], wanted, atol=1e-5)
    assert model[0, 1, 3] == pytest.approx(0.8)


def swing(rig: Rig, seconds: float, dt: float = DT, still_after: float = 0.6) -> tuple[np.ndarray, np.ndarray]:
    """A head that is thrown about and then held. rig: bound by identities, so that its skin matrices are its joints'.
    -> tails (F, S, 3), joint matrices (F, J, 4, 4)."""
    state = rig.start(1)
    tails, models = [], []
    for k in range(round(seconds / dt)):
        t = min(k * dt, still_after)
        q = np.tile(quat.IDENTITY, (1, len(REFERENCE), 1))
        q[:, REFERENCE.index["head"]] = quat.from_axis_angle(np.array([0.3, 1, 0]), np.array(0.9 * np.sin(9 * t)))
        state, model = rig.advance(state, pose_of(q), dt)
        tails.append(state.tail[0])
        models.append(model[0])
    return np.array(tails), np.array(models)


def test_springs_settle_and_keep_their_lengths() -> None:
    rig = make_rig(springs=True, colliders=False, bind=BARE)
    tails, models = swing(rig, 5.0)
    assert np.abs(np.diff(tails[:20], axis=0)).max() > 0.005
    assert np.abs(np.diff(tails[-5:], axis=0)).max() < 2e-4
    joints = [rig.skeleton.index[f"tail{i}"] for i in range(4)]
    gaps = np.linalg.norm(np.diff(models[:, joints][..., :3, 3], axis=1), axis=-1)
    np.testing.assert_allclose(gaps, np.hypot(0.08, 0.01), atol=1e-4)
    np.testing.assert_allclose(models[-1, joints[1:]][:, :3, 3], tails[-1], atol=1e-5)


def test_springs_never_enter_their_colliders() -> None:
    rig = make_rig(springs=True, bind=BARE)
    tails, models = swing(rig, 3.0, still_after=2.5)
    ball = models[:, rig.skeleton.index["neck"]] @ np.array([0.0, 0.0, -0.15, 1.0])
    distance = np.linalg.norm(tails - ball[:, None, :3], axis=-1)
    assert distance.min() > 0.05 + 0.01 - 2e-3
    chest = models[:, rig.skeleton.index["chest"]]
    a, b = chest @ np.array([-0.1, 0.1, -0.1, 1.0]), chest @ np.array([0.1, 0.1, -0.1, 1.0])
    way = (b - a)[:, None, :3]
    along = np.clip(((tails - a[:, None, :3]) * way).sum(-1, keepdims=True) / (way**2).sum(-1, keepdims=True), 0, 1)
    assert np.linalg.norm(tails - a[:, None, :3] - along * way, axis=-1).min() > 0.07 - 2e-3


def test_springs_hang_alike_at_thirty_and_sixty_ticks_a_second() -> None:
    rig = make_rig(springs=True, colliders=False, bind=BARE)
    slow, _ = swing(rig, 3.0)
    fast, _ = swing(rig, 3.0, dt=DT / 2)
    np.testing.assert_allclose(slow[-1], fast[-1], atol=3e-3)
    assert np.abs(slow - fast[::2][: len(slow)]).max() < 0.03


def test_at_sixty_ticks_a_step_is_vrms_own() -> None:
    rig = make_rig(springs=True, colliders=False, bind=BARE)
    tails, models = swing(rig, 0.5, dt=1 / 60)
    head = rig.skeleton.index["tail0"]
    above = models[:, rig.skeleton.index["head"]]
    origin = models[:, head, :3, 3]
    axis = rig.skeleton.rest_translation[head + 1]
    length = np.linalg.norm(axis)
    k = 12
    rest = above[k, :3, :3] @ (axis / length)
    wanted = (
        tails[k - 1, 0]
        + (tails[k - 1, 0] - tails[k - 2, 0]) * (1 - 0.35)
        + rest * 0.6 / 60
        + np.array([0, -1, 0]) * 0.3 / 60
    )
    wanted = origin[k] + (wanted - origin[k]) / np.linalg.norm(wanted - origin[k]) * length
    np.testing.assert_allclose(tails[k, 0], wanted, atol=1e-5)


def test_bad_chains_and_rigs_are_refused() -> None:
    names, parents, rest = rig_arrays()
    chain = SpringChain((0, 9), (1.0,), (0.0,), ((0, -1, 0),), (0.4,), (0.0,))
    with pytest.raises(BadInput, match="child of joint 0"):
        Rig.from_arrays(names, np.array(parents), np.array(rest), chains=[chain])
    with pytest.raises(BadInput, match="hips"):
        Rig.from_arrays(["a"], np.array([-1]), np.zeros((1, 3)))
    with pytest.raises(BadInput, match="inverse bind"):
        Rig.from_arrays(names, np.array(parents), np.array(rest), np.zeros((3, 4, 4)))


def test_what_hangs_on_a_swinging_joint_swings_along() -> None:
    """A strand that branches off another, and a joint that no chain has."""
    names, parents, rest = rig_arrays()
    first = names.index("tail0")
    for parent in (first + 1, first + 1, len(names) + 1):
        names.append(f"more{len(names)}")
        parents.append(parent)
        rest.append(np.array([0.05, -0.05, 0.0]))
    ornament, branch = len(names) - 3, len(names) - 2
    chains = [
        SpringChain(joints, (0.2,) * n, (0.3,) * n, ((0.0, -1.0, 0.0),) * n, (0.3,) * n, (0.0,) * n)
        for joints, n in ((tuple(range(first, first + 4)), 3), ((branch, branch + 1), 1))
    ]
    bare = np.tile(np.eye(4), (len(names), 1, 1))
    rig = Rig.from_arrays(names, np.array(parents), np.array(rest), bare, chains=chains)
    _, models = swing(rig, 0.6)
    carrier = models[:, first + 1]
    assert np.ptp(carrier[:, 0, 3]) > 0.02
    wanted = carrier @ np.array([0.05, -0.05, 0.0, 1.0])
    for joint in (ornament, branch):
        np.testing.assert_allclose(models[:, joint, :3, 3], wanted[:, :3], atol=1e-5)
