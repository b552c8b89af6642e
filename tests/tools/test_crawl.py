"""The crawler measures what the game would draw: every fault that is put there is found, and no other."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from game.app.cli import main
from game.app.shots import SHOTS
from game.app.ui import Rect
from game.core.paths import DIALOGUE
from game.render import FontSet
from game.tools.crawl import PaperCanvas, PaperHud
from game.tools.crawl.hands import on_picture


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


def test_a_line_that_is_too_long_is_found_in_its_language_and_shown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(DIALOGUE, tmp_path / "dialogue")
    script = tmp_path / "dialogue" / "flea.yaml"
    text = script.read_text(encoding="utf-8")
    old = 'en: "Hello! Mind the cloth'
    assert old in text
    script.write_text(text.replace(old, 'en: "' + "unendingly much to say " * 60, 1), encoding="utf-8")
    words = ["crawl", str(script), "--language", "en", "--no-hands", "--json", "--out", str(tmp_path / "out")]
    assert main(words) == 1
    told = json.loads(capsys.readouterr().out)
    assert told["measured"] > 100
    found = {(row["kind"], row["scale"]) for row in told["findings"] if "unendingly" in row["text"]}
    assert ("overflow", 2.0) in found
    page = (tmp_path / "out" / "crawl.html").read_text(encoding="utf-8")
    assert "unendingly" in page
    assert "<svg" in page


def test_hands_are_seen_where_the_camera_sees_them() -> None:
    camera = SHOTS["talk"]
    middle = on_picture(camera, np.array([camera.target]))
    assert np.allclose(middle, 0.0, atol=1e-6)
    left = on_picture(camera, np.array([[3.0, 1.0, 0.0], [0.3, 0.95, 0.1]]))
    assert np.abs(left[0]).max() > 1.0
    assert np.abs(left[1]).max() < 1.0
