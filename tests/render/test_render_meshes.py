from __future__ import annotations

from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from game.core import BadInput
from game.render.camera import HERO, Camera, look_at
from game.render.grading import grade
from game.render.model import (
    CharacterMesh,
    CharacterModel,
    Material,
    Part,
    StaticMesh,
    WhenAsked,
    joint_boxes,
    merge_character,
    merge_static,
)
from game.render.silhouette import Sight, SightFinder, find_edges, scene_cells

CLOTH = Material("coat", "cloth", (0.2, 0.4, 0.5), (0.1, 0.2, 0.4), (0.1, 0.1, 0.3))


def cube(material: Material = CLOTH) -> Part:
    """A cube of side 2 around the origin, eight shared corners, joint 0."""
    corner = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangle = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], np.uint32)
    weight = np.tile(np.array([255, 0, 0, 0], np.uint8), (8, 1))
    return Part(
        "body",
        material,
        corner,
        corner / np.sqrt(np.float32(3)),
        np.ones(8, np.float32),
        triangle,
        np.zeros((8, 4), np.uint8),
        weight,
    )


def clip_of(mesh, eye=(0.0, 0.0, 6.0)):
    camera = Camera(eye, (0.0, 0.0, 0.0), 40.0)
    points = np.hstack([mesh.position, np.ones((len(mesh.position), 1))])
    return (points @ camera.view_projection(16 / 9).T).astype(np.float32)


def look(position, triangle, clip, size=None) -> Sight:
    """What is seen of a mesh in a picture of ``size``; None: what is in front."""
    edges = find_edges(position, triangle, np.ones(len(position), np.float32))
    finder = SightFinder(len(position), triangle, [0], edges)
    finder.clip[:] = clip
    return finder.look(len(position), len(triangle), len(edges.adjacency), 1, size, 2.0)


def squares(*places: tuple[float, float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Squares that look along z: centre, depth and half side of each -> position, triangle."""
    corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    position = [[x + h * i, y + h * j, z] for x, y, z, h in places for i, j in corner]
    triangle = [[4 * k + i for i in face] for k in range(len(places)) for face in ((0, 1, 2), (0, 2, 3))]
    return np.array(position, np.float32), np.array(triangle, np.int32)


def seen(*places: tuple[float, float, float, float], size=(640, 360)) -> set[int]:
    """Which of the squares are drawn."""
    position, triangle = squares(*places)
    clip = clip_of(cast(CharacterMesh, SimpleNamespace(position=position)))
    return set((look(position, triangle, clip, size).triangle // 4).ravel().tolist())


def test_the_silhouette_of_a_cube_seen_from_the_front_is_its_front_square() -> None:
    mesh = merge_character([cube()], 1)
    for size in (None, (640, 360)):
        sight = look(mesh.position, mesh.triangle, clip_of(mesh), size)
        assert sight.counts == (2,)
        assert (mesh.position[sight.triangle][:, :, 2] == 1).all()
        edges = {frozenset(map(tuple, mesh.position[row[1:3]])) for row in sight.line}
        assert len(edges) == 4
        assert all(point[2] == 1 for edge in edges for point in edge)


def test_a_face_behind_another_is_left_out_unless_something_of_it_looks_out() -> None:
    front, behind = (0.0, 0.0, 1.0, 0.5), (0.0, 0.0, 0.0, 0.4)
    assert seen(front, behind) == {0}
    assert seen(behind, front) == {1}, "whatever the order"
    assert seen(front, (0.3, 0.0, 0.0, 0.4)) == {0, 1}, "it looks out at the right"
    assert seen(front, (0.0, 0.0, 0.0, 0.7)) == {0, 1}, "it looks out all around"
    assert seen(front, (0.0, 0.0, 0.9999, 0.4)) == {0, 1}, "what is as near as that may shimmer through"
    assert seen(front, behind, size=None) == {0, 1}, "hidden faces were not to be looked for"


def test_a_slit_of_two_pixels_shows_what_is_behind() -> None:
    """A pixel here is 1.2 cm."""
    left, right = (-0.515, 0.0, 1.0, 0.5), (0.515, 0.0, 1.0, 0.5)
    assert seen(left, right, (0.0, 0.0, 0.9, 0.4)) == {0, 1, 2}
    closed = (0.5, 0.0, 1.0, 0.5)
    assert seen((-0.5, 0.0, 1.0, 0.5), closed, (0.0, 0.0, 0.9, 0.4)) == {0, 1}


def test_what_the_scene_hides_is_left_out_and_what_looks_over_it_stays() -> None:
    """A wall two metres before the square; the depth is that of a picture of 640 × 360, first row at the bottom."""
    projection = Camera((0.0, 0.0, 6.0), (0.0, 0.0, 0.0), 40.0).projection(16 / 9)
    wall = (-projection[2, 2] + projection[2, 3] / 4.0) * 0.5 + 0.5
    position, triangle = squares((0.0, 0.0, 0.0, 0.5))
    finder = SightFinder(4, triangle, [0], find_edges(position, triangle, np.ones(4, np.float32)))
    finder.clip[:] = clip_of(cast(CharacterMesh, SimpleNamespace(position=position)))
    for height, wanted in ((360, 0), (180, 2), (0, 2)):
        depth = np.ones((360, 640), np.float32)
        depth[:height] = wall
        cells = scene_cells(depth, projection)
        if height:
            assert cells.max() == pytest.approx(0.25, rel=1e-4)
        finder.stand_behind(cells)
        assert len(finder.look(4, 2, 5, 1, (640, 360), 2.0).triangle) == wanted
    finder.stand_behind(scene_cells(np.full((360, 640), wall, np.float32), projection))
    assert len(finder.look(4, 2, 5, 1, (640, 360), 2.0).line) == 0
    assert len(finder.look(4, 2, 5, 1, (320, 180), 2.0).triangle) == 2, "of another picture"
    finder.stand_behind(None)
    assert len(finder.look(4, 2, 5, 1, (640, 360), 2.0).triangle) == 2


def test_outlines_of_hidden_faces_are_left_out() -> None:
    position, triangle = squares((0.0, 0.0, 1.0, 0.5), (0.0, 0.0, 0.0, 0.3))
    clip = clip_of(cast(CharacterMesh, SimpleNamespace(position=position)))
    assert set((look(position, triangle, clip, (640, 360)).line // 4).ravel().tolist()) == {0}
    assert len(look(position, triangle, clip).line) == 8


def test_faces_that_reach_behind_the_eye_stay() -> None:
    """The eye is at z = 6."""
    position = np.array([[-1, -1, 0], [1, -1, 0], [0, 1, 7], [-1, -1, 2], [1, -1, 2], [0, 1, 2]], np.float32)
    triangle = np.array([[0, 1, 2], [3, 4, 5]], np.int32)
    clip = clip_of(cast(CharacterMesh, SimpleNamespace(position=position)))
    assert len(look(position, triangle, clip, (640, 360)).triangle) == 2


def test_what_is_no_number_neither_traps_nor_reads_elsewhere() -> None:
    position, triangle = squares((0.0, 0.0, 1.0, 0.5), (0.0, 0.0, 0.0, 0.3))
    for odd in (np.nan, np.inf, -np.inf, 3e38, 1e-38):
        look(position, triangle, np.full((8, 4), odd, np.float32), (640, 360))
        clip = clip_of(cast(CharacterMesh, SimpleNamespace(position=position)))
        clip[3] = (odd, -odd, 0.0, 1.0)
        look(position, triangle, clip, (640, 360))


def test_edges_are_shared_across_split_vertices() -> None:
    part = cube()
    order = part.triangle.ravel()
    split = part.position[order]
    edges = find_edges(split, np.arange(36, dtype=np.int32).reshape(-1, 3), np.ones(36, np.float32))
    assert len(edges.adjacency) == 18
    assert (edges.face >= 0).all()


def test_a_border_edge_counts_where_its_face_is_in_front() -> None:
    position = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
    triangle = np.array([[0, 1, 2]], np.int32)
    clip = np.hstack([position, np.ones((3, 1))]).astype(np.float32)
    assert len(look(position, triangle, clip).line) == 3
    assert len(look(position, triangle, clip * np.array([-1, 1, 1, 1], np.float32)).line) == 0


def test_parts_without_outline_have_no_edges() -> None:
    part = replace(cube(), outline=np.zeros(8, np.float32))
    assert len(merge_character([part], 1).edges.adjacency) == 0


def test_meshes_are_read_only_and_legs_come_last(model: CharacterModel) -> None:
    for mesh in model.meshes.values():
        assert not mesh.position.flags.writeable
        above = mesh.above
        assert 0 < above.vertices < len(mesh.position)
        assert mesh.triangle[: above.triangles].max() < above.vertices
        assert mesh.edges.adjacency[: above.edges].max() < above.vertices
        assert sum(run.count for run in mesh.runs) == mesh.triangle.size
        assert [run.first for run in mesh.runs] == list(np.cumsum([0] + [run.count for run in mesh.runs[:-1]]))
        legs = sum(run.count for run in mesh.runs if run.group == "legs")
        assert legs == 3 * (len(mesh.triangle) - above.triangles)


def test_the_finest_mesh_within_the_wish_is_chosen(model: CharacterModel) -> None:
    sizes = sorted(model.meshes)
    assert model.mesh(10**6) is model.meshes[sizes[-1]]
    assert model.mesh(sizes[0] + 1) is model.meshes[sizes[0]]
    assert model.mesh(1) is model.meshes[sizes[0]]


def test_posed_joint_boxes_enclose_the_blended_mesh(model: CharacterModel, skin_matrices) -> None:
    mesh = model.mesh(15_000)
    weight = mesh.weight / np.float32(255)
    blended = np.einsum("vk,vkrc->vrc", weight, skin_matrices[mesh.joint])
    world = np.einsum("vrc,vc->vr", blended[:, :3, :3], mesh.position) + blended[:, :3, 3]
    corners = np.einsum("jrc,jkc->jkr", skin_matrices[:, :3, :3], mesh.joint_box) + skin_matrices[:, None, :3, 3]
    low, high = corners.reshape(-1, 3).min(axis=0), corners.reshape(-1, 3).max(axis=0)
    assert (world >= low - 1e-4).all()
    assert (world <= high + 1e-4).all()


def test_joints_without_vertices_get_a_box_on_the_mesh() -> None:
    part = cube()
    boxes = joint_boxes(part.position, part.joint, part.weight, 3)
    assert boxes.shape == (3, 8, 3)
    assert np.abs(boxes).max() <= 1


@pytest.mark.parametrize(
    ("part", "joints", "message"),
    [
        (cube(replace(CLOTH, kind="silk")), 1, "class hair, face"),
        (replace(cube(), joint=None), 1, "joints and weights"),
        (cube(), 257, "1 to 256 joints"),
        (replace(cube(), joint=np.full((8, 4), 7, np.uint8)), 3, "joints below 3"),
    ],
)
def test_what_cannot_be_drawn_is_refused(part: Part, joints: int, message: str) -> None:
    with pytest.raises(BadInput, match=message):
        merge_character([part], joints)


def test_static_parts_keep_their_groups(stall: StaticMesh) -> None:
    assert {"scene", "table", "awning", "item:lucky_cat"} <= stall.groups
    assert stall.anchors["item:lucky_cat"][1] == pytest.approx(0.585, abs=0.02)
    two = merge_static([cube(), replace(cube(), group="item:cube")], {"item:cube": (0.0, 0.0, 0.0)})
    assert two.groups == {"body", "item:cube"}


def test_look_at_puts_the_target_on_the_axis() -> None:
    view = look_at((1.0, 2.0, 3.0), (0.0, 1.0, 0.0))
    seen = view @ np.array([0.0, 1.0, 0.0, 1.0])
    assert seen[:2] == pytest.approx(0, abs=1e-12)
    assert seen[2] == pytest.approx(-np.sqrt(11))


def test_a_narrow_picture_keeps_the_width_of_the_composition() -> None:
    wide, narrow = HERO.projection(16 / 9), HERO.projection(4 / 3)
    assert narrow[0, 0] == pytest.approx(wide[0, 0])
    assert narrow[1, 1] < wide[1, 1]
    assert HERO.projection(21 / 9)[1, 1] == pytest.approx(wide[1, 1])


def test_grading_keeps_black_and_white_and_order() -> None:
    grey = grade(np.repeat(np.linspace(0, 1, 11)[:, None], 3, axis=1))
    assert grey[0] == pytest.approx(0, abs=1e-4)
    assert grey[-1] == pytest.approx(1, abs=1e-6)
    assert (np.diff(grey, axis=0) > 0).all()


def test_a_level_of_detail_is_put_together_when_it_is_asked_for() -> None:
    asked: list[int] = []

    def make(triangles: int) -> CharacterMesh:
        asked.append(triangles)
        return cast(CharacterMesh, triangles)

    model = CharacterModel("x", WhenAsked({n: partial(make, n) for n in (40_000, 25_000, 15_000)}), None, 1)
    assert asked == []
    assert model.mesh(30_000) == model.mesh(25_000) == 25_000
    assert asked == [25_000], "and only once"
    model.make_all()
    assert sorted(asked) == [15_000, 25_000, 40_000]
