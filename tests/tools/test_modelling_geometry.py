"""The modeller's tools: fields, meshing, lofts, cuts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from game.core.paths import ASSETS
from game.tools.modelling.cap import Cap
from game.tools.modelling.curls import CurlyMass, grown, overgrown
from game.tools.modelling.fields import capsule, cone, ellipsoid, gradient, project, smooth_min, sphere, union
from game.tools.modelling.lofts import lathe, loft, rounded_box, sheet, smooth_curve
from game.tools.modelling.mesh import Mesh, joined, split_at_level, vertex_normals
from game.tools.modelling.spec import load_character
from game.tools.modelling.spec_hair import CurlSpec
from game.tools.modelling.surface import Sculpt


@pytest.fixture
def points() -> np.ndarray:
    return np.random.default_rng(7).uniform(-0.2, 0.2, (400, 3))


def signed_volume(mesh: Mesh) -> float:
    a, b, c = (mesh.position[mesh.triangle[:, k]] for k in range(3))
    return float(np.einsum("ni,ni->", a, np.cross(b, c)) / 6)


def area(mesh: Mesh) -> float:
    a, b, c = (mesh.position[mesh.triangle[:, k]] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def open_edges(mesh: Mesh) -> int:
    edges = np.sort(np.vstack([mesh.triangle[:, [0, 1]], mesh.triangle[:, [1, 2]], mesh.triangle[:, [2, 0]]]), axis=1)
    return int((np.unique(edges, axis=0, return_counts=True)[1] != 2).sum())


def test_a_cone_of_equal_radii_is_a_capsule(points):
    a, b = (0.0, -0.05, 0.02), (0.03, 0.08, 0.0)
    np.testing.assert_allclose(cone(a, b, 0.04, 0.04)(points), capsule(a, b, 0.04)(points), atol=1e-9)


def test_distances_grow_by_one_metre_per_metre(points):
    for field in (
        sphere((0, 0, 0), 0.1),
        capsule((0, 0, 0), (0, 0.1, 0), 0.03),
        cone((0, 0, 0), (0, 0.1, 0), 0.05, 0.02),
    ):
        slope = np.linalg.norm(gradient(field, points + 1e-3), axis=1)
        assert np.quantile(np.abs(slope - 1.0), 0.97) < 1e-3


def test_smooth_minimum_rounds_only_near_the_join():
    a, b = np.array([0.0, 0.0, 0.0]), np.array([1.0, 0.05, 0.0])
    np.testing.assert_allclose(smooth_min(a, b, 0.1), [0.0, -0.1 * 0.5**3 / 6, -0.1 / 6])


def test_projection_lands_on_the_field(points):
    field = union(0.03, sphere((0.02, 0, 0), 0.08), ellipsoid((-0.06, 0, 0), (0.06, 0.04, 0.05)))
    near = points[np.abs(field(points)) < 0.03]
    assert len(near) > 20
    assert np.abs(field(project(field, near, 4))).max() < 1e-4


def test_sculpt_gives_a_closed_outward_mesh_of_the_wanted_size():
    sculpt = Sculpt(sphere((0.01, 0.02, 0.0), 0.05), (-0.07, -0.06, -0.08), (0.09, 0.10, 0.08), 0.006)
    mesh = sculpt.mesh(600)
    assert len(mesh.triangle) == pytest.approx(600, rel=0.1)
    assert open_edges(mesh) == 0
    assert signed_volume(mesh) == pytest.approx(4 / 3 * np.pi * 0.05**3, rel=0.05)
    radius = np.linalg.norm(mesh.position - (0.01, 0.02, 0.0), axis=1)
    np.testing.assert_allclose(radius, 0.05, atol=2e-5)
    np.testing.assert_allclose(mesh.normal, (mesh.position - (0.01, 0.02, 0.0)) / radius[:, None], atol=1e-3)


def test_a_cut_keeps_the_area_and_separates_exactly():
    mesh = rounded_box((0, 0, 0), (0.1, 0.06, 0.04), 0.01)
    above, below = split_at_level(mesh, mesh.position[:, 1] - 0.013)
    assert area(above) + area(below) == pytest.approx(area(mesh))
    assert above.position[:, 1].min() == pytest.approx(0.013)
    assert below.position[:, 1].max() == pytest.approx(0.013)
    nothing, everything = split_at_level(mesh, np.full(len(mesh.position), -1.0))
    assert len(nothing.triangle) == 0
    assert len(everything.triangle) == len(mesh.triangle)


@pytest.mark.parametrize("profile", ["lens", "band", "round"])
def test_lofts_are_closed_and_face_outward(profile):
    path = smooth_curve([(0, 0, 0), (0.05, 0.1, 0), (0, 0.2, 0.03)], 12)
    mesh = loft(path, np.tile([0.0, 0.0, 1.0], (12, 1)), 0.02, 0.01, 8, profile)
    assert open_edges(mesh) == 0
    assert signed_volume(mesh) > 0


def test_a_closed_loft_joins_its_ends():
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    ring = np.stack([np.cos(angle), np.zeros(24), np.sin(angle)], 1) * 0.1
    mesh = loft(ring, ring, 0.01, 0.01, 8, "round", closed=True)
    assert open_edges(mesh) == 0
    # Pappus: the section's area (an octagon) times the way of its centre
    assert signed_volume(mesh) == pytest.approx(2 * np.sqrt(2) * 0.01**2 * 2 * np.pi * 0.1, rel=0.03)


def test_lathe_sheet_and_box_face_outward():
    jar = lathe([(0.0005, 0), (0.03, 0.001), (0.03, 0.05), (0.0005, 0.051)], 24)
    assert signed_volume(jar) == pytest.approx(np.pi * 0.03**2 * 0.05, rel=0.05)
    box = rounded_box((0.2, 0.1, 0), (0.03, 0.02, 0.01), 0.004, turn_y_rad=0.5)
    assert signed_volume(box) == pytest.approx(8 * 0.03 * 0.02 * 0.01, rel=0.12)
    cloth = sheet(lambda u, v: (u, v * 0, v), 5, 4, (0, 1, 0))
    np.testing.assert_allclose(cloth.normal, np.tile([0, 1, 0], (20, 1)), atol=1e-9)


def test_mirroring_and_joining_keep_normals_outward():
    box = rounded_box((0.2, 0, 0), (0.03, 0.02, 0.01), 0.004)
    both = joined([box, box.mirrored()])
    assert signed_volume(both) == pytest.approx(2 * signed_volume(box))
    facing = (vertex_normals(both.position, both.triangle) * both.normal).sum(1)
    assert facing.min() > 0.5


def on_ball(azimuth_deg: np.ndarray, polar_deg: np.ndarray, lift_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    a, p = np.radians(azimuth_deg), np.radians(polar_deg)
    out = np.stack([np.sin(a) * np.sin(p), np.cos(p), np.cos(a) * np.sin(p)], axis=1)
    return out * (0.06 + lift_m)[:, None], out


def test_curls_grow_out_of_one_body_and_keep_their_tips_in_coarse_meshes():
    row = CurlSpec((-60.0, 60.0), (70.0, 70.0), 3, 0.07, 0.022, 0.012, roll_deg=50.0)
    locks = list(grown([row], on_ball))
    box = np.full(3, 0.12)
    mass = CurlyMass(overgrown(sphere((0, 0, 0), 0.06), locks), sphere((0, 0, 0), 0.04), -box, box)
    for target in (4000, 900):
        mesh = mass.mesh(target)
        assert len(mesh.triangle) == pytest.approx(target, rel=0.1)
        assert open_edges(mesh) == 0
        assert signed_volume(mesh) > 4 / 3 * np.pi * 0.06**3
        reach = np.linalg.norm(mesh.position[None] - np.array([k.path[-1] for k in locks])[:, None], axis=2).min(axis=1)
        assert reach.max() < 0.006
        corner = mesh.position[mesh.triangle]
        facing = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        assert ((facing * mesh.normal[mesh.triangle].sum(axis=1)).sum(axis=1) > 0).mean() > 0.97


def test_what_lies_in_the_head_has_no_triangles():
    box = np.full(3, 0.12)
    whole = CurlyMass(sphere((0, 0, 0), 0.06), sphere((0, 0, -0.05), 0.001), -box, box).mesh(800)
    half = CurlyMass(sphere((0, 0, 0), 0.06), sphere((0, 0, -0.1), 0.1), -box, box).mesh(800)
    assert whole.position[:, 2].min() < -0.059
    assert half.position[:, 2].min() > -0.045
    assert half.position[:, 2].max() > 0.059


def test_hair_turns_its_hook_the_way_it_is_told():
    row = CurlSpec((0.0, 0.0), (90.0, 90.0), 1, 0.06, 0.02, 0.0, turns=0.4, hand=1.0, roll_deg=0.0, uneven=0.0)
    (left,), (right,) = grown([row], on_ball), grown([replace(row, hand=-1.0)], on_ball)
    assert left.path[-1, 0] > left.path[:, 0].min() + 0.005
    np.testing.assert_allclose(right.path * (-1, 1, 1), left.path, atol=1e-12)
    assert left.radius[-1] < 0.3 * left.radius.max()
    (out,) = grown([replace(row, roll_deg=90.0)], on_ball)
    assert np.linalg.norm(out.path, axis=1).max() > 0.07 > np.linalg.norm(left.path, axis=1).max()


def test_a_cap_keeps_its_dome_at_every_level_of_detail():
    cap = Cap(load_character(ASSETS / "characters" / "daimon.yaml").cap, np.zeros(3))
    crown = cap.crown
    tall = np.ptp(crown.mesh(2600).position @ cap.turn, axis=0)
    for target in (600, 345, 174):
        mesh = crown.mesh(target)
        assert len(mesh.triangle) == pytest.approx(target, rel=0.05)
        np.testing.assert_allclose(np.ptp(mesh.position @ cap.turn, axis=0), tall, atol=0.004)
