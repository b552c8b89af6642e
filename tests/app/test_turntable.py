"""Looking at persons: the turntable's sheet, who is known, and the camera that follows a taller head."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from game.app.cli import main
from game.app.stage import load_stage
from game.render import CLOSEUP, HERO
from game.render.assets import load_picture


def test_a_sheet_of_eight_views_differs_from_view_to_view(tmp_path: Path) -> None:
    out = tmp_path / "mira.png"
    assert main(["turntable", "mira", "--size", "80x140", "--out", str(out)]) == 0
    sheet = load_picture(out).astype(int)
    assert sheet.shape == (280, 320, 3)
    views = [sheet[y : y + 140, x : x + 80] for y in (0, 140) for x in range(0, 320, 80)]
    for a in range(8):
        for b in range(a):
            assert np.abs(views[a] - views[b]).mean() > 1.0
    # She stands in the middle, with room above and below.
    figure = np.abs(views[0] - views[0][:, :1]).max(axis=2) > 40
    rows = np.flatnonzero(figure.any(axis=1))
    assert 2 < rows[0] < 25
    assert 120 < rows[-1] < 139


def test_an_unknown_person_is_one_line_with_who_there_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["turntable", "nobody", "--out", str(tmp_path / "x.png")]) == 2
    said = capsys.readouterr().err
    assert "genzo" in said
    assert "mira" in said
    assert said.count("\n") == 1


def test_close_shots_follow_the_head_and_shots_of_the_stall_stay() -> None:
    mira, genzo = load_stage("mira"), load_stage("genzo")
    assert mira.lift_m == pytest.approx(0.0, abs=1e-6)
    assert 0.05 < genzo.lift_m < 0.2
    assert mira.framed(CLOSEUP) == CLOSEUP
    assert genzo.framed(HERO) == HERO
    raised = genzo.framed(CLOSEUP)
    assert raised.target[1] - CLOSEUP.target[1] == pytest.approx(genzo.lift_m, rel=0.2)
    assert raised.eye[1] - raised.target[1] == pytest.approx(CLOSEUP.eye[1] - CLOSEUP.target[1])


def test_each_person_brings_a_face_of_their_own() -> None:
    mira, genzo = load_stage("mira").face, load_stage("genzo").face
    assert mira.age == 0.0
    assert genzo.age > 0.5
    assert mira.iris != genzo.iris
