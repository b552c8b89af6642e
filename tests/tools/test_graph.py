"""Pictures of the tree: everything is on them, nothing overlaps, the dead is red, logs warm what they passed."""

from __future__ import annotations

import gzip
import itertools
import json
import random
import re
import shutil
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from game.app.cli import main
from game.core.errors import BadInput
from game.core.paths import DIALOGUE
from game.story import load_script
from game.tools.graph import dot_of, graph_of, page_of, read_heat, svg_of
from game.tools.graph.layout import Box, lay_out
from game.tools.graph.svg import _arranged

BROKEN = Path(__file__).resolve().parents[1] / "data" / "dialogue_broken"
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def flea():
    return load_script(DIALOGUE / "flea.yaml")


@pytest.fixture(scope="module")
def graph(flea):
    return graph_of(flea)


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    path = tmp_path_factory.mktemp("log") / "log.jsonl"
    assert main(["autoplay", "--episodes", "30", "--seed", "3", "--stall", "flea", "--out", str(path)]) == 0
    return path


def _cards(text: str) -> dict[str, ET.Element]:
    return {
        group.attrib["data-id"]: group for group in ET.fromstring(text).iter(f"{SVG}g") if "data-id" in group.attrib
    }


def _texts(element: ET.Element) -> str:
    return " ".join(text.text or "" for text in element.iter(f"{SVG}text"))


def _overlap(a: Box, b: Box) -> bool:
    return a.x < b.x + b.w and b.x < a.x + a.w and a.y < b.y + b.h and b.y < a.y + a.h


def test_every_node_choice_and_condition_is_on_the_picture(flea, graph):
    cards = _cards(svg_of(graph))
    assert set(flea.nodes) <= set(cards)
    assert {f"outcome {kind}" for kind in flea.outcomes} <= set(cards)
    assert "praise" in _texts(ET.fromstring(svg_of(graph)))
    assert "if item == 'vase'" in _texts(cards["re_praise_vase"])
    assert "a steady hand" in _texts(cards["re_praise_vase"]).lower()
    shown = {row.id for card in graph.cards.values() for row in card.arrivals}
    led_somewhere = {c.id for c in flea.all_choices() if any(b.target in flea.nodes for b in c.to)}
    assert shown == led_somewhere
    assert "迷いのない手" in _texts(_cards(svg_of(graph_of(flea, "ja")))["re_praise_vase"])


def test_cards_and_frames_do_not_overlap_and_the_page_is_no_ribbon(graph):
    heights = dict.fromkeys(graph.cards, 90.0)
    found = _arranged(graph, heights, 6)
    framed = {name for names in graph.groups.values() for name in names}
    free = [box for name, box in found.cards.items() if name not in framed] + list(found.frames.values())
    assert not any(_overlap(a, b) for a, b in itertools.combinations(free, 2))
    for key, names in graph.groups.items():
        inside = [found.cards[name] for name in names]
        assert not any(_overlap(a, b) for a, b in itertools.combinations(inside, 2))
        frame = found.frames[key]
        assert all(frame.x < box.x and box.x + box.w < frame.x + frame.w for box in inside)
        assert all(frame.y < box.y and box.y + box.h < frame.y + frame.h for box in inside)
    width, height = map(float, re.search(r'viewBox="0 0 (\d+) (\d+)"', svg_of(graph)).groups())
    assert 0.8 < width / height < 2.6


@pytest.mark.parametrize("seed", range(8))
def test_layers_go_from_left_to_right_whatever_the_graph(seed):
    rng = random.Random(seed)
    names = [f"n{i}" for i in range(rng.randint(1, 40))]
    sizes = {name: (rng.uniform(50, 300), rng.uniform(30, 200)) for name in names}
    edges = [(rng.choice(names), rng.choice(names)) for _ in range(rng.randint(0, 80))]
    layout = lay_out(sizes, edges, names[:1])
    assert set(layout.boxes) == set(names)
    assert not any(_overlap(a, b) for a, b in itertools.combinations(layout.boxes.values(), 2))
    assert all((box.w, box.h) == sizes[name] for name, box in layout.boxes.items())
    for (source, target), points in layout.bends.items():
        xs = [layout.boxes[source].x, *(x for x, _ in points), layout.boxes[target].x]
        assert xs == sorted(xs), "a kept edge never runs back"
    assert lay_out(sizes, edges, names[:1]) == layout


def test_the_dead_is_red(tiny_path):
    unreached = graph_of(load_script(BROKEN / "unreachable.yaml"))
    (dead,) = [card.id for card in unreached.cards.values() if card.dead]
    assert "#c4291c" in ET.tostring(_cards(svg_of(unreached))[dead], encoding="unicode")
    assert "color=red" in next(row for row in dot_of(unreached).splitlines() if row.startswith(f'  "{dead}" ['))
    never = graph_of(load_script(BROKEN / "never_needed.yaml"))
    rows = [row for card in never.cards.values() for row in card.arrivals if row.id == "brag"]
    assert rows
    assert all(row.dead for row in rows)
    alive = graph_of(load_script(tiny_path))
    assert not any(card.dead or any(row.dead for row in card.arrivals) for card in alive.cards.values())


@pytest.fixture
def tiny_path() -> Path:
    return Path(__file__).resolve().parents[1] / "story" / "tiny.yaml"


def test_heat_counts_what_the_log_passed(flea, graph, log):
    heat = read_heat(log, flea)
    packed = log.with_suffix(".jsonl.gz")
    packed.write_bytes(gzip.compress(log.read_bytes()))
    assert read_heat(packed, flea) == heat
    rows = [json.loads(row) for row in log.read_text(encoding="utf-8").splitlines()]
    assert heat.talks == 30
    assert heat.nodes[flea.start] == 30
    assert heat.choices.total() == len(rows)
    assert heat.nodes["deal"] == sum("deal" in row["nodes"] for row in rows) > 0
    silent = [node.id for node in flea.nodes.values() if not node.says and node.id not in {flea.start, "talk"}]
    assert any(heat.nodes[name] for name in silent), "nodes that say nothing are counted, too"
    assert all(heat.nodes[name] >= sum(name in row["nodes"] for row in rows) for name in flea.nodes)
    cards = _cards(svg_of(graph, heat))
    assert str(heat.nodes["talk"]) in _texts(cards["talk"]).replace(",", "")
    unvisited = next(name for name in flea.nodes if not heat.nodes[name])
    assert "stroke-dasharray" in ET.tostring(cards[unvisited], encoding="unicode")
    assert f"{heat.nodes['talk']} visits" in dot_of(graph, heat)


@pytest.mark.parametrize(
    "row", ["no json", '{"nodes": 3}', "[1]", '{"stall": "flea", "nodes": [], "node": 2, "choice": "x"}', ""]
)
def test_other_logs_are_refused_with_their_row(tmp_path, flea, log, row):
    path = tmp_path / "bad.jsonl"
    path.write_text(log.read_text(encoding="utf-8").split("\n")[0] + "\n" + row + "\n", encoding="utf-8")
    with pytest.raises(BadInput, match=r"bad\.jsonl:2"):
        read_heat(path, flea)


def test_logs_of_other_stalls_and_torn_ones_are_told_apart(tmp_path, log):
    toys = load_script(DIALOGUE / "toys.yaml")
    with pytest.raises(BadInput, match=r"talks at toys but saw 'flea'"):
        read_heat(log, toys)
    both = tmp_path / "both.jsonl"
    text = log.read_text(encoding="utf-8")
    both.write_text(text + text.replace('"stall":"flea"', '"stall":"toys"'), encoding="utf-8")
    assert read_heat(both, toys).talks == 30, "a log of several stalls warms each by its own"
    torn = tmp_path / "torn.jsonl.gz"
    torn.write_bytes(gzip.compress(text.encode())[:-200])
    with pytest.raises(BadInput, match=r"torn\.jsonl\.gz"):
        read_heat(torn, toys)


def test_the_page_is_whole_and_its_words_cannot_break_out(graph, tiny_path, tmp_path):
    page = page_of(graph)
    assert page.count("<svg") == 1
    assert "http" not in page.replace("http://www.w3.org/2000/svg", "")
    data = json.loads(re.search(r"const DATA=(.*);\n", page)[1])
    assert data["re_praise_vase"]["lines"]
    hostile = tmp_path / "tiny.yaml"
    evil = "</script><img src=x onerror=alert(1)>@DATA@"
    text = tiny_path.read_text(encoding="utf-8")
    hostile.write_text(text.replace('en: "I see."', f'en: "{evil}"'), encoding="utf-8")
    for drawn in (page_of(graph_of(load_script(hostile))), svg_of(graph_of(load_script(hostile)))):
        assert "<img" not in drawn
        assert drawn.count("</script>") <= 1
    dot = dot_of(graph_of(load_script(hostile)))
    assert dot.count('"') % 2 == 0


@pytest.mark.skipif(shutil.which("node") is None, reason="checks the page's script with Node.js")
def test_the_pages_script_is_javascript(graph, tmp_path):
    script = re.search(r"<script>(.*)</script>", page_of(graph), re.S)[1]
    (tmp_path / "page.js").write_text(script, encoding="utf-8")
    subprocess.run(["node", "--check", str(tmp_path / "page.js")], check=True, timeout=60)


def test_the_command(tmp_path, capsys, log):
    for ending in ("svg", "html", "dot"):
        out = tmp_path / f"flea.{ending}"
        assert main(["graph", "flea", "-o", str(out), "--heat", str(log), "--json"]) == 0
        told = json.loads(capsys.readouterr().out)
        assert told["nodes"] >= 60
        assert told["dead"] == []
        assert out.stat().st_size > 10_000
    assert main(["graph", "flea", "-o", str(tmp_path / "flea.pdf")]) == 2
    assert "ends in .svg" in capsys.readouterr().err
    assert main(["graph", "fleaa", "-o", str(tmp_path / "x.svg")]) == 2
    assert "flea" in capsys.readouterr().err
    assert main(["graph", "flea", "-o", str(tmp_path / "x.svg"), "--heat", str(tmp_path / "none")]) == 2
    assert not (tmp_path / "x.svg").exists()
