"""The committed stalls: groups, goods, materials, what moves, and what the builder still makes of their YAML."""

from __future__ import annotations

import struct
from functools import cache

import numpy as np
import pytest
from scipy.spatial import cKDTree

from game.core.errors import BadInput
from game.core.humanoid import TABLE_TOP_M
from game.core.paths import ASSETS, DIALOGUE
from game.formats import GltfFile, read_gltf
from game.story import load_script
from game.tools.modelling.goods import GOODS
from game.tools.modelling.stall import load_stall

FOLDER = ASSETS / "stalls"
STALLS = sorted(path.stem for path in FOLDER.glob("*.yaml"))
SAMPLE = {"flea": "cups", "antiques": "tea_bowl", "toys": "kendama"}
"""One item of each stall that is quick to model."""


@cache
def read(name: str) -> GltfFile:
    return read_gltf(FOLDER / f"{name}.glb")


def positions(stall: GltfFile, group: str) -> np.ndarray:
    node = stall.nodes[stall.node_index[group]]
    return np.vstack([p.attributes["POSITION"] for p in stall.meshes[node.mesh].primitives])


def triangle_count(stall: GltfFile, group: str) -> int:
    node = stall.nodes[stall.node_index[group]]
    return sum(p.indices.size // 3 for p in stall.meshes[node.mesh].primitives)


@pytest.mark.parametrize("name", STALLS)
def test_groups_and_goods_are_those_of_the_yaml(name) -> None:
    stall, spec = read(name), load_stall(FOLDER / f"{name}.yaml")
    groups = {node.extras["group"] for node in stall.nodes}
    still = {group for group in groups if not group.startswith(("sway:", "spin:"))}
    assert still == {"scene", "table", "awning"} | {f"item:{placing.item}" for placing in spec.goods}
    assert len(spec.goods) == 7
    assert stall.findings == []
    for placing in spec.goods:
        anchor = stall.nodes[stall.node_index[f"item:{placing.item}"]].extras["anchor"]
        assert anchor == pytest.approx([placing.at[0], TABLE_TOP_M + placing.height, placing.at[1]], abs=1e-6)


def test_every_item_is_on_some_stall() -> None:
    assert set(GOODS) == {placing.item for name in STALLS for placing in load_stall(FOLDER / f"{name}.yaml").goods}


@pytest.mark.parametrize("name", STALLS)
def test_what_the_dialogue_sells_stands_on_the_table(name) -> None:
    script = load_script(DIALOGUE / f"{name}.yaml")
    assert set(script.items) == {placing.item for placing in load_stall(FOLDER / f"{name}.yaml").goods}


@pytest.mark.parametrize("name", STALLS)
def test_vertices_are_finite_and_normals_unit(name) -> None:
    stall = read(name)
    for mesh in stall.meshes:
        for primitive in mesh.primitives:
            assert np.isfinite(primitive.attributes["POSITION"]).all()
            np.testing.assert_allclose(np.linalg.norm(primitive.attributes["NORMAL"], axis=1), 1.0, atol=1e-4)
            extras = stall.materials[primitive.material].extras
            assert extras["class"] in ("cloth", "gloss", "flat")
            assert len(extras["lit"]) == len(extras["shade"]) == len(extras["deep"]) == 3


@pytest.mark.parametrize("name", STALLS)
def test_the_goods_stand_on_the_table_and_leave_its_middle_free(name) -> None:
    stall = read(name)
    for group, node in ((n.name, n) for n in stall.nodes if n.name.startswith("item:")):
        points = positions(stall, group)
        assert points[:, 1].min() >= TABLE_TOP_M - 4e-3, group
        assert points[:, 1].min() < node.extras["anchor"][1] + 0.012, group
        assert np.abs(points[:, 0]).min() > 0.25, group
        assert points[:, 2].min() > 0.16, group
        assert points[:, 2].max() < 0.74, group


@pytest.mark.parametrize("name", STALLS)
def test_an_item_has_its_price_card_where_the_yaml_puts_it(name) -> None:
    stall, spec = read(name), load_stall(FOLDER / f"{name}.yaml")
    for placing in spec.goods:
        if placing.card:
            near = cKDTree(positions(stall, f"item:{placing.item}")[:, [0, 2]])
            assert near.query(placing.card[:2])[0] < 0.01, placing.item


@pytest.mark.parametrize("name", STALLS)
def test_the_table_top_is_at_its_height(name) -> None:
    table = positions(read(name), "table")
    boards = table[np.abs(table[:, 0]) > 1.0]
    assert boards[:, 1].max() == pytest.approx(TABLE_TOP_M, abs=2e-3)


@pytest.mark.parametrize("name", [name for name in STALLS if name != "flea"])
def test_goods_shown_large_are_detailed_but_not_heavy(name) -> None:
    stall = read(name)
    for node in stall.nodes:
        if node.name.startswith("item:"):
            assert 1500 <= triangle_count(stall, node.name) <= 9000, node.name


@pytest.mark.parametrize("name", [name for name in STALLS if name != "flea"])
def test_what_moves_says_how_and_about_which_point(name) -> None:
    stall = read(name)
    moving = [node for node in stall.nodes if node.name.startswith(("sway:", "spin:"))]
    assert moving
    for node in moving:
        kind = node.name.split(":")[0]
        motion = node.extras[kind]
        assert np.linalg.norm(motion["axis"]) == pytest.approx(1.0, abs=0.01)
        assert motion["period_s"] > 0.5
        assert kind == "spin" or 0 < motion["amplitude_deg"] < 30
        for primitive in stall.meshes[node.mesh].primitives:
            pivot, position = primitive.attributes["_PIVOT"], primitive.attributes["POSITION"]
            assert pivot.shape == position.shape
            assert np.linalg.norm(position - pivot, axis=1).max() < 1.0


@pytest.mark.parametrize("name", sorted(SAMPLE))
def test_the_builder_still_makes_the_committed_item(name) -> None:
    item = SAMPLE[name]
    placing = next(p for p in load_stall(FOLDER / f"{name}.yaml").goods if p.item == item)
    committed = cKDTree(positions(read(name), f"item:{item}"))
    for part in GOODS[item]():
        placed = part.mesh.placed((placing.at[0], TABLE_TOP_M, placing.at[1]), placing.turn_rad)
        distance, _ = committed.query(placed.position)
        assert distance.max() < 1e-4


@pytest.mark.parametrize("name", STALLS)
def test_the_backdrop_is_a_wide_picture(name) -> None:
    head = (FOLDER / f"{name}_backdrop.png").read_bytes()[:26]
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    width, height, depth, colour = struct.unpack(">IIBB", head[16:26])
    assert (width, height, depth, colour) == (2048, 1152, 8, 2)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("item: vase", "item: vaze", "vase"),
        ("recipe: market", "recipe: marked", "market"),
        ("pattern: diamonds", "pattern: dots", "diamonds | brocade | checks"),
        ("dish: dark_wood", "dish: darkwood", "an entry of the palette"),
        ("piece: bulbs", "piece: bulb", "bulbs"),
        ("sways: false", "sways: 3", "true or false"),
        ("on: books", "on: shelf", "books"),
        ("item: cups", "item: vase", "twice"),
        ("colours: [cream, red_cloth]", "colours: []", "at least one"),
        ("at: [-0.62, 0.36]", "at: [-0.62]", "2 numbers"),
        ("ink: dark}", "ink: darc}", "an entry of the palette"),
    ],
)
def test_slips_in_the_yaml_are_refused_with_their_place(tmp_path, old, new, says) -> None:
    text = (FOLDER / "flea.yaml").read_text(encoding="utf-8")
    assert old in text
    slip = tmp_path / "flea.yaml"
    slip.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(BadInput) as caught:
        load_stall(slip)
    message = str(caught.value)
    assert "\n" not in message
    assert says in message
    assert "flea.yaml:" in message
