"""The crawler measures what the game would draw: every fault that is put there is found, and no other."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from game.app.cli import main
from game.app.loading import load_step_assets
from game.app.shots import SHOTS
from game.app.ui import Rect
from game.render import FontSet
from game.tools.crawl import PaperCanvas, PaperHud
from game.tools.crawl.hands import on_picture
from game.tools.crawl.visit import beats_of


@pytest.fixture
def canvas() -> PaperCanvas:
    return PaperCanvas(PaperHud(FontSet.for_language("en")), "en", 1.0)


def kinds(canvas: PaperCanvas) -> list[str]:
    return [fault.kind for fault in canvas.paper.faults]


def test_good_pictures_have_no_faults(canvas: PaperCanvas) -> None:
    canvas.panel(Rect(100, 100, 400, 60))
    canvas.text(116, 110, "How much is the vase?", 20)
    canvas.text(700, 110, "on no panel at all", 20)
    canvas.panel(Rect(690, 100, 300, 60))  # hides it
    canvas.text(700, 110, "over what is hidden", 20)
    canvas.paragraph(Rect(100, 300, 400, 100), "A few words that fit. " * 4, 20)
    assert kinds(canvas) == []


def test_every_kind_of_fault_is_seen(canvas: PaperCanvas) -> None:
    canvas.panel(Rect(100, 100, 200, 40))
    canvas.text(110, 105, "This is far too long for its panel, is it not?", 20)
    canvas.text(130, 107, "upon it", 20)
    canvas.text(1250, 20, "beyond the edge", 20)
    canvas.text(400, 400, "a rune \u16a0", 20)
    canvas.paragraph(Rect(100, 500, 60, 20), "so many words in so little room " * 3, 20)
    assert kinds(canvas)[:4] == ["overflow", "overlap", "offscreen", "glyph"]
    assert kinds(canvas)[4] == "overflow"
    assert "rows" in canvas.paper.faults[4].detail


@pytest.fixture(scope="module")
def broken(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A stall with something wrong in every way: a line behind a condition far too long, a wording with a rune, a node
    with more choices than the picture has room for."""
    text = (Path(__file__).parents[1] / "story" / "tiny.yaml").read_text(encoding="utf-8")
    many = "".join(
        f'      - {{id: m{i}, act: praise, once: false, en: "Choice {i}", ja: "選択{i}"}}\n' for i in range(14)
    )
    for old, new in (
        ("stall: tiny", "stall: flea"),
        ("cup", "vase"),
        ("pot", "teapot_gold"),
        ('"Hello!"', '"' + "unendingly much to say " * 60 + '"'),
        ('en: "Nice."', 'en: "Nice \u16a0."'),
        ("nodes:\n", "nodes:\n  many:\n    lines: []\n    choices:\n" + many),
        ("    to: hub\n", "    to: many\n"),
    ):
        assert old in text
        text = text.replace(old, new, 1 if old == "    to: hub\n" else -1)
    path = tmp_path_factory.mktemp("broken") / "flea.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_broken_stall_is_flagged_for_every_fault(
    broken: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # Nearer than any person could stand: the hands have no room.
    monkeypatch.setitem(SHOTS, "talk", replace(SHOTS["talk"], fov_deg=9.0))
    words = [
        "crawl",
        str(broken),
        "--language",
        "en",
        "--seconds",
        "1",
        "--no-pixels",
        "--json",
        "--out",
        str(tmp_path),
    ]
    assert main(words) == 1
    told = json.loads(capsys.readouterr().out)["findings"]
    texts = [row for row in told if row["kind"] != "hands"]
    assert {row["scale"] for row in texts if row["kind"] == "overflow" and "unendingly" in row["text"]} == {1.0, 2.0}
    assert any(row["kind"] == "glyph" and "\u16a0" in row["text"] for row in texts)
    assert {row["node"] for row in texts if row["kind"] == "offscreen"} >= {"many"}
    assert {row["hand"] for row in told if row["kind"] == "hands"} == {"left", "right"}
    page = (tmp_path / "crawl.html").read_text(encoding="utf-8")
    assert "unendingly" in page
    assert "<svg" in page


def test_every_line_and_every_wording_is_laid_out_whatever_its_conditions(broken: Path) -> None:
    assets = load_step_assets(str(broken), body=False)
    script = assets.talk.script
    shown = [talk.beat for node in script.nodes for talk in beats_of(assets, node)]
    lines = {line.id for beat in shown for line in beat.lines}
    assert lines == {line.id for node in script.nodes.values() for say in node.says for line in say.lines}
    offered = {choice.id for beat in shown for choice in beat.choices}
    assert offered == {choice.id for choice in script.all_choices()}
    assert not any("{" in line.en + line.ja for beat in shown for line in beat.lines)


def test_hands_are_seen_where_the_camera_sees_them() -> None:
    camera = SHOTS["talk"]
    middle = on_picture(camera, np.array([camera.target]))
    assert np.allclose(middle, 0.0, atol=1e-6)
    left = on_picture(camera, np.array([[3.0, 1.0, 0.0], [0.3, 0.95, 0.1]]))
    assert np.abs(left[0]).max() > 1.0
    assert np.abs(left[1]).max() < 1.0
