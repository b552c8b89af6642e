"""The pieces a tick is made of: bilinear quaternions, limbs, collisions, rows, transitions' curves."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from game.animation import bilinear as bl
from game.animation import channels as ch
from game.animation import collision, limbs
from game.animation import rows as rw
from game.core import quaternion as quat
from game.core.errors import BadInput
from game.core.humanoid import REFERENCE
from game.embos import MotionUnit, UnitLibrary, Variant


def random_quaternions(shape: tuple[int, ...], seed: int = 0) -> np.ndarray:
    return quat.normalize(np.random.default_rng(seed).normal(size=(*shape, 4))).astype(np.float32)


def test_bilinear_maps_are_the_quaternion_algebra() -> None:
    a, b = random_quaternions((3, 5), 1), random_quaternions((3, 5), 2)
    np.testing.assert_allclose(bl.multiply(a, b), quat.multiply(a, b), atol=1e-6)
    np.testing.assert_allclose(bl.rotation_matrix(a), quat.to_matrix(a), atol=1e-6)
    back = bl.from_matrix(np.ascontiguousarray(quat.to_matrix(a)))
    np.testing.assert_allclose(np.abs((back * a).sum(-1)), 1.0, atol=1e-6)
    half_turns = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], dtype=np.float32)
    back = bl.from_matrix(quat.to_matrix(half_turns))
    np.testing.assert_allclose(np.abs((back * half_turns).sum(-1)), 1.0, atol=1e-6)


ARM = limbs.limbs_of(np.array([0.216]), np.array([0.206]), np.array([limbs.ARM]))
LEG = limbs.limbs_of(np.array([0.216]), np.array([0.206]), np.array([limbs.STRAIGHT]))


def solved(elbow_deg: float, target: object, kind: limbs.Limbs = LEG) -> tuple[np.ndarray, np.ndarray]:
    """A limb along x, bent by elbow_deg, sent to a target -> where its end comes to lie, the two rotations."""
    angle = np.radians(elbow_deg)
    joint = np.array([0.216, 0, 0])
    end = joint + 0.206 * np.array([np.cos(angle), 0, np.sin(angle)])
    goal = end if target is None else np.asarray(target)
    points = np.array([np.zeros(3), joint, end, goal], dtype=np.float32).T[:, :, None, None]
    hinge = limbs.HINGE_WEIGHT_M * np.array([0, 1, 0], dtype=np.float32)[:, None, None]
    opened, swing = limbs.solve_limbs(kind, points, hinge)
    fix = bl.product(swing[:, None], opened[:, ::2])[..., 0, 0].T
    upper, lower = (Rotation.from_quat(q) for q in fix)
    return upper.apply(joint) + lower.apply(end - joint), fix


@pytest.mark.parametrize("elbow", [0.0, 20.0, 90.0, 140.0])
@pytest.mark.parametrize("target", [(0.2, 0.1, 0.2), (-0.1, 0.25, 0.15), (0.05, -0.3, 0.1), (0.12, 0.0, 0.02)])
def test_limbs_reach_their_targets(elbow: float, target: tuple[float, float, float]) -> None:
    np.testing.assert_allclose(solved(elbow, target)[0], target, atol=2e-3)


def test_a_limb_that_is_there_stays_as_it_is() -> None:
    np.testing.assert_allclose(np.abs(solved(70.0, None, ARM)[1][:, 3]), 1.0, atol=1e-6)


@pytest.mark.parametrize("share", [limbs.ARM, limbs.STRAIGHT, (0.985, 0.999)])
def test_a_reach_ends_softly_and_never_runs_ahead_of_what_is_asked(share: tuple[float, float]) -> None:
    full = 0.422
    asked = np.linspace(0.9, 1.1, 200)
    kind = limbs.limbs_of(np.array([0.216]), np.array([0.206]), np.array([share]))
    got = np.array([np.linalg.norm(solved(40.0, (a * full, 0, 0), kind)[0]) for a in asked]) / full
    assert got.max() < share[1] + 1e-3
    assert (np.diff(got) < np.diff(asked) + 4e-4).all()


def test_reach_is_clamped_softly() -> None:
    full = 0.422
    distances = np.linspace(0.85, 1.3, 60) * full
    ratio = np.array([np.linalg.norm(solved(40.0, (d, 0, 0), ARM)[0]) for d in distances]) / full
    np.testing.assert_allclose(ratio[distances < 0.92 * full], (distances / full)[distances < 0.92 * full], atol=3e-3)
    assert ratio.max() < limbs.ARM[1] + 1e-3
    assert (np.diff(ratio) > -1e-3).all()


def body_maps() -> np.ndarray:
    rest = REFERENCE.rest_model.astype(np.float32)
    return collision.body_frames(rest[None, [REFERENCE.index[name] for name in collision.BODY_JOINTS]])


def at_points(**where: tuple[float, float, float]) -> np.ndarray:
    """(1, 14, 4) both hands' points far away but for some: left_1 is the left palm."""
    points = np.full((1, 2, 7, 4), 5.0, dtype=np.float32)
    points[..., 3] = 1.0
    for name, place in where.items():
        hand, _, point = name.partition("_")
        points[0, ("left", "right").index(hand), int(point), :3] = place
    return points.reshape(1, 14, 4)


def test_points_inside_the_body_are_pushed_to_its_surface_and_others_left_alone() -> None:
    maps = body_maps()
    assert collision.push_out(maps, at_points()) is None
    palm = np.array([0.0, 0.82, 0.10])  # the left palm 1 cm inside the breast
    push = collision.push_out(maps, at_points(left_1=tuple(palm)))
    assert push is not None
    assert push[0, 0, 2] > 0.02
    assert abs(push[0, 0, 0]) < 1e-3
    assert not push[0, 1].any()
    again = collision.push_out(maps, at_points(left_1=tuple(palm + push[0, 0])))
    assert again is not None
    assert np.linalg.norm(again[0, 0]) < 0.25 * np.linalg.norm(push[0, 0])


def test_the_gradient_is_that_of_the_distance() -> None:
    maps = body_maps()
    rng = np.random.default_rng(3)
    points = np.ones((1, 40, 4), dtype=np.float32)
    points[..., :3] = np.array([0, 0.9, 0]) + rng.normal(size=(1, 40, 3)) * 0.2
    distance, away = collision.body_distance(maps, points)
    assert distance.shape == (1, 6, 40)
    np.testing.assert_allclose(np.linalg.norm(away, axis=2), 1.0, atol=1e-4)
    points[..., :3] += 1e-3 * away[:, 0].swapaxes(-1, -2)
    moved, _ = collision.body_distance(maps, points)
    assert (moved[:, 0] > distance[:, 0]).all()


def test_hands_on_the_table_are_lifted_and_below_its_edge_drawn_back() -> None:
    maps = body_maps()
    push = collision.push_out(maps, at_points(left_0=(0.2, 0.58, 0.4), right_0=(-0.3, 0.50, 0.14)))
    assert push is not None
    np.testing.assert_allclose(0.58 + push[0, 0, 1], 0.585 + 0.027 + 0.004, atol=1e-3)
    assert push[0, 1, 2] < -0.005
    assert abs(push[0, 1, 1]) < 0.01


def test_a_looped_span_has_no_seam() -> None:
    rng = np.random.default_rng(0)
    walk = np.cumsum(rng.normal(size=(90, ch.CHANNELS)) * 0.004, axis=0) + rw.REST_ROW
    loop = rw.seamless_loop(walk.astype(np.float32))
    np.testing.assert_array_equal(loop[0], loop[-1])
    steps = np.abs(np.diff(np.concatenate([loop, loop[1:3]]), axis=0))[:, : ch.ROOT.stop]
    assert steps.max() < 3 * np.abs(np.diff(walk, axis=0)).max()


def test_traces_of_a_unit_begin_and_end_with_nothing() -> None:
    count = 40
    u = np.linspace(0, 1, count)
    q = np.tile(quat.IDENTITY, (count, ch.JOINTS, 1))
    q[:, REFERENCE.index["chest"]] = quat.from_axis_angle(np.array([1.0, 0, 0]), 0.4 * np.sin(np.pi * u) + 0.2 * u)
    rows = rw.take_rows(q, np.tile(REFERENCE.rest_translation[0], (count, 1))).span(slice(None), np.array([2, 2]))
    added = rw.additive_rows(rows, np.zeros(len(ch.PARTS), dtype=bool), 1.0)
    chest = added[:, 4 * REFERENCE.index["chest"]]
    np.testing.assert_allclose(chest[[0, -1]], 0.0, atol=1e-6)
    np.testing.assert_allclose(chest[count // 2], np.sin(0.2), atol=0.01)
    assert not added[:, ch.WRIST].any()


def test_units_without_motion_or_with_unknown_contacts_are_refused(library: UnitLibrary) -> None:
    from game.animation.motion_bank import bake

    seven = np.full(7, 0.5)
    bare = MotionUnit("bare", "posture", seven, seven, seven)
    with pytest.raises(BadInput, match="bare"):
        bake(UnitLibrary([bare]), ("posture",))
    span = (Variant(2, "joy", 0.0, 2.0, 0.0, 2.0),)
    odd = MotionUnit("odd", "posture", seven, seven, seven, contacts={"left_hand": "moon"}, variants=span)
    with pytest.raises(BadInput, match=r"moon.*|table"):
        bake(UnitLibrary([odd], library.clips), ("posture",))
