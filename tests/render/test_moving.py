"""Things that move by themselves: a function of the time, about their pivots, and lamps that come on."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from game.core import BadInput, Where
from game.render import FrameView, Renderer
from game.render.coarse import coarser, loose_pieces
from game.render.model import Material, Part
from game.render.moving import Motion, moving_meshes, read_motion

HERE = Where(Path("stall.glb"))


def cube(group: str = "sway:flags", at: tuple[float, float, float] = (0.0, 0.0, 0.0), name: str = "paper") -> Part:
    corner = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float32) * 0.1 + np.float32(at)
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6)]
    normal = corner - corner.mean(axis=0)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    material = Material(name, "flat", (1, 1, 1), (0.5, 0.5, 0.5), (0.2, 0.2, 0.2))
    return Part(group, material, corner, normal, np.ones(8, np.float32), np.array(faces, np.uint32))


def things(count: int, motion: Motion):
    parts = [cube(at=(0.3 * i, 1.0, 0.0)) for i in range(count)]
    return [(part, motion, np.tile(part.position[2], (8, 1)).astype(np.float32)) for part in parts]


def test_the_markets_bulbs_hang_each_from_its_own_pivot(stall) -> None:
    (moving,) = stall.moving
    assert len(moving.pivot) == 15
    assert (moving.lamp[:, 3] > 0).all()
    assert len(moving.mesh.triangle) < 15 * 200, "small things are coarse"
    place = moving.mesh.position
    joint = moving.mesh.joint[:, 0]
    assert (place[:, 1] <= moving.pivot[joint, 1] + 0.006).all(), "a bulb hangs below its pivot"


def test_lanterns_are_lamps_and_flags_are_not() -> None:
    motion = Motion((0.0, 0.0, 1.0), 0.1, 2.0)
    parts = [cube("sway:lanterns_1", name="lantern"), cube("sway:lanterns_1", name="lantern_rib"), cube("sway:flags_2")]
    (moving,) = moving_meshes([(part, motion, np.tile(part.position[2], (8, 1))) for part in parts])
    assert sorted((moving.lamp[:, 3] > 0).tolist()) == [False, True]
    assert (moving.mesh.extra[:, 0] > 0).sum() == 8, "the paper glows, its ribs do not"


def test_a_sway_turns_about_the_pivot_within_its_amplitude_and_passes_through_rest() -> None:
    (moving,) = moving_meshes(things(3, Motion((0.0, 0.0, 1.0), np.radians(6.0), 2.0)))
    angles = []
    for time_s in np.arange(0.0, 30.0, 0.1):
        turn = moving.matrices(time_s)
        kept = (turn[:, :3, :3] @ moving.pivot[:, :, None])[..., 0] + turn[:, :3, 3]
        np.testing.assert_allclose(kept, moving.pivot, atol=1e-6)
        angles.append(np.degrees(np.arctan2(turn[:, 1, 0], turn[:, 0, 0])))
    swing = np.array(angles)
    assert np.abs(swing).max() <= 6.0 + 1e-4
    assert swing.max() > 4.0
    assert swing.min() < -4.0
    assert np.abs(np.corrcoef(swing.T)[0, 1]) < 0.999, "neighbours do not swing as one"


def test_a_spin_goes_round_once_a_period() -> None:
    (moving,) = moving_meshes(things(1, Motion((0.0, 0.0, 1.0), None, 4.0)))
    first, half, round_s = (moving.matrices(t)[0, :2, 0] for t in (0.0, 2.0, 4.0))
    np.testing.assert_allclose(first, -half, atol=1e-6)
    np.testing.assert_allclose(first, round_s, atol=1e-6)


def test_more_things_than_joints_become_several_meshes() -> None:
    meshes = moving_meshes(things(600, Motion((1.0, 0.0, 0.0), 0.1, 2.0)))
    assert [len(moving.pivot) for moving in meshes] == [256, 256, 88]


@pytest.mark.parametrize(
    "extras",
    [
        {"sway": {"axis": [0, 0, 0], "amplitude_deg": 3, "period_s": 2}},
        {"sway": {"axis": [1, 0], "amplitude_deg": 3, "period_s": 2}},
        {"sway": {"axis": [1, 0, 0], "period_s": 2}},
        {"spin": {"axis": [1, 0, 0], "period_s": 0}},
        {"spin": {"axis": [1, 0, 0], "period_s": float("nan")}},
        {"spin": 3},
    ],
)
def test_a_motion_that_makes_no_sense_is_refused_with_its_place(extras) -> None:
    with pytest.raises(BadInput, match=r"stall\.glb"):
        read_motion(extras, HERE)


def test_nodes_without_motion_stand_still() -> None:
    assert read_motion({"group": "table"}, HERE) is None


def test_coarser_keeps_shape_and_facing() -> None:
    fine = cube()
    assert len(coarser(fine, 0.01).triangle) == len(fine.triangle)
    small = coarser(fine, 0.06)
    assert len(coarser(fine, 1.0).triangle) == 0
    np.testing.assert_allclose(np.linalg.norm(small.normal, axis=1), 1.0, rtol=1e-5)


def test_loose_pieces_are_told_apart() -> None:
    one, two = cube(), cube(at=(5.0, 0.0, 0.0))
    both = replace(
        one, position=np.vstack([one.position, two.position]), triangle=np.vstack([one.triangle, two.triangle + 8])
    )
    assert loose_pieces(both.triangle).tolist() == [0] * 8 + [1] * 8


@pytest.mark.gl
def test_bulbs_move_with_time_alone_and_glow_in_the_evening(device, stall, backdrop, skin_matrices) -> None:
    renderer = Renderer(device, None, stall, backdrop)

    def top(**more) -> np.ndarray:
        renderer.draw(FrameView(skin_matrices, **more))
        return renderer.read_pixels()[25:60].astype(int)

    try:
        still, moved, again = top(time_s=0.4), top(time_s=1.3), top(time_s=0.4)
        noon, evening = top(day_share=0.0), top(day_share=1.0)
    finally:
        renderer.release()
    assert (np.abs(still - moved).max(axis=2) > 20).sum() > 40
    assert np.array_equal(still, again)
    bulbs = evening.min(axis=2) > 190
    assert bulbs.sum() > 100, "lit glass"
    assert evening[~bulbs].mean() < noon[~bulbs].mean()
