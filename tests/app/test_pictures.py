"""snapshot and film: right size, right feelings, one seed one picture, clear refusals."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from game.app.cli import main
from game.render.assets import load_picture

pytestmark = pytest.mark.gl


def snap(folder: Path, name: str, *words: str) -> np.ndarray:
    path = folder / name
    code = main(["snapshot", "--size", "480x270", "--level", "low", "--seconds", "1", "--out", str(path), *words])
    assert code == 0
    return load_picture(path).astype(int)


def test_snapshots_show_the_feeling_and_repeat_exactly(tmp_path) -> None:
    joy = snap(tmp_path, "joy.png", "--emotion", "joy=0.9")
    again = snap(tmp_path, "again.png", "--emotion", "joy=0.9")
    fear = snap(tmp_path, "fear.png", "--emotion", "fear=0.9")
    assert joy.shape == (270, 480, 3)
    assert np.array_equal(joy, again)
    assert np.abs(joy - fear).mean() > 3
    overlay = snap(tmp_path, "overlay.png", "--emotion", "joy=0.9", "--overlay")
    assert np.abs(overlay - joy)[:90, :110].mean() > 10
    hidden = snap(tmp_path, "hidden.png", "--emotion", "joy=0.9", "--mode", "body")
    assert np.abs(hidden - joy)[60:140, 180:300].mean() > 2


def test_a_strip_has_all_its_pictures(tmp_path) -> None:
    path = tmp_path / "strip.png"
    words = ["film", "--emotion", "anger=0.9", "--seconds", "2", "--every", "0.5", "--strip", "--columns", "2"]
    assert main([*words, "--size", "160x180", "--level", "low", "--out", str(path)]) == 0
    strip = load_picture(path)
    assert strip.shape == (360, 320, 3)
    cells = [strip[y : y + 180, x : x + 160].astype(int) for y in (0, 180) for x in (0, 160)]
    assert all(np.abs(a - b).mean() > 0.3 for a, b in pairwise(cells))


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["snapshot", "--out", "x.jpg"], ".png"),
        (["snapshot", "--seconds", "-1", "--out", "x.png"], "0 to 3600"),
        (["film", "--seconds", "100", "--every", "0.1", "--strip", "--out", "x.png"], "at most 200"),
        (["film", "--every", "0.5", "--out", "x.png"], "a folder"),
        (["snapshot", "--out", "/no/such/folder/x.png"], "a folder that exists"),
    ],
)
def test_bad_arguments_give_one_line(capsys, words, says) -> None:
    assert main(words) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert says in error
