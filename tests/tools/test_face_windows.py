"""The face windows on a virtual display, driven by real mouse and key events."""

from __future__ import annotations

import importlib.util
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from game.face import Face, load_expressions, load_face
from game.tools.face.ratings_file import read_ratings
from tests.virtual_screen import VirtualScreen

pytestmark = pytest.mark.window
SIZE = (640, 360)


@pytest.fixture
def desk(tmp_path: Path) -> Iterator[VirtualScreen]:
    desk = VirtualScreen(tmp_path, SIZE)
    yield desk
    desk.close()


def open_face(desk: VirtualScreen, *words: str) -> None:
    desk.open("run_game.py", "face", *words, "--size", f"{SIZE[0]}x{SIZE[1]}")


@pytest.mark.skipif(importlib.util.find_spec("imgui_bundle") is None, reason="needs the tools extra")
def test_authoring_drag_take_name_and_save(desk: VirtualScreen) -> None:
    out = desk.folder / "named.yaml"
    open_face(desk, "--save-to", str(out))
    steps = [
        "mousemove 105 120 mousedown 1",
        "mousemove 45 70",
        "mouseup 1",
        "key 2",
        "key ctrl+s",
        "sleep 1",
        "key ctrl+a",
    ]
    desk.until(out.exists, "the file", steps=(*steps, "type --delay 40 from_a_test", "key Return"))
    found = load_expressions(out, load_face().model.parts)
    assert list(found) == ["from_a_test"]
    assert found["from_a_test"].face != Face()


def test_rating_survives_a_window_that_is_killed(desk: VirtualScreen) -> None:
    out, parts = desk.folder / "r.csv", load_face().model.parts
    words = ("rate", "--rater", "yuki", "--out", str(out), "--parts")
    open_face(desk, *words)

    def rated() -> int:
        return len(read_ratings(out, parts)) if out.exists() and out.stat().st_size else 0

    # The pad's middle is at (966, 314) of 1280 × 720; a click right of it and above is pleasant and awake.
    steps = ("mousemove 545 107 click 1", "key Return")
    desk.until(lambda: rated() > 0, "a rating", steps=steps)
    assert desk.program is not None
    desk.program.send_signal(signal.SIGKILL)
    desk.program.wait(10)
    before = read_ratings(out, parts)
    first = before[0]
    assert (first.rater, first.valence, first.arousal) == (
        "yuki",
        pytest.approx(0.5, abs=0.02),
        pytest.approx(0.4, abs=0.02),
    )
    open_face(desk, *words)
    desk.until(lambda: rated() > len(before), "another rating", steps=steps)
    after = read_ratings(out, parts)
    assert len({r.face for r in after}) == len(after), "no face was asked twice"
    assert after[: len(before)] == before
