"""The committed stall: groups, goods, materials, and what the builder still makes."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from scipy.spatial import cKDTree

from game.core.errors import BadInput
from game.core.humanoid import TABLE_TOP_M
from game.core.paths import ASSETS
from game.formats import GltfFile, read_gltf
from game.tools.modelling.goods import GOODS
from game.tools.modelling.goods_flea import cups
from game.tools.modelling.stall import load_stall

FOLDER = ASSETS / "stalls"
ITEMS = {"teapot_gold", "books", "vase", "lucky_cat", "teapot_teal", "cups", "alarm_clock"}


@pytest.fixture(scope="module")
def stall() -> GltfFile:
    return read_gltf(FOLDER / "flea.glb")


def positions(stall: GltfFile, group: str) -> np.ndarray:
    node = stall.nodes[stall.node_index[group]]
    return np.vstack([p.attributes["POSITION"] for p in stall.meshes[node.mesh].primitives])


def test_groups_and_goods_are_complete(stall):
    groups = {node.extras["group"] for node in stall.nodes}
    assert groups == {"scene", "table", "awning"} | {f"item:{item}" for item in ITEMS}
    assert set(GOODS) == ITEMS
    assert stall.findings == []


def test_vertices_are_finite_and_normals_unit(stall):
    for mesh in stall.meshes:
        for primitive in mesh.primitives:
            assert np.isfinite(primitive.attributes["POSITION"]).all()
            np.testing.assert_allclose(np.linalg.norm(primitive.attributes["NORMAL"], axis=1), 1.0, atol=1e-4)
            extras = stall.materials[primitive.material].extras
            assert extras["class"] in ("cloth", "gloss", "flat")
            assert len(extras["lit"]) == len(extras["shade"]) == len(extras["deep"]) == 3


def test_the_goods_stand_on_the_table_and_leave_its_middle_free(stall):
    for item in ITEMS:
        points = positions(stall, f"item:{item}")
        anchor = stall.nodes[stall.node_index[f"item:{item}"]].extras["anchor"]
        assert points[:, 1].min() >= TABLE_TOP_M - 3e-3
        assert points[:, 1].min() < anchor[1] + 0.012
        assert np.abs(points[:, 0]).min() > 0.25
        assert points[:, 2].min() > 0.16
        assert points[:, 2].max() < 0.74


def test_the_table_top_is_at_its_height(stall):
    table = positions(stall, "table")
    boards = table[np.abs(table[:, 0]) > 1.0]
    assert boards[:, 1].max() == pytest.approx(TABLE_TOP_M, abs=2e-3)


def test_the_builder_still_makes_the_committed_cups(stall):
    placing = next(p for p in load_stall(FOLDER / "flea.yaml").goods if p.item == "cups")
    committed = cKDTree(positions(stall, "item:cups"))
    for part in cups():
        placed = part.mesh.placed((placing.at[0], TABLE_TOP_M, placing.at[1]), placing.turn_rad)
        distance, _ = committed.query(placed.position)
        assert distance.max() < 1e-4


def test_the_backdrop_is_a_wide_picture():
    head = (FOLDER / "flea_backdrop.png").read_bytes()[:26]
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    width, height, depth, colour = struct.unpack(">IIBB", head[16:26])
    assert (width, height, depth, colour) == (2048, 1152, 8, 2)


def test_unknown_goods_are_refused_with_their_place(tmp_path):
    slip = tmp_path / "flea.yaml"
    text = (FOLDER / "flea.yaml").read_text(encoding="utf-8")
    slip.write_text(text.replace("item: vase", "item: vaze"), encoding="utf-8")
    with pytest.raises(BadInput, match=r"flea\.yaml:\d+:\d+.*vase"):
        load_stall(slip)
