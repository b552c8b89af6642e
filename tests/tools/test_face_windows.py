"""The face windows on a virtual display, driven by real mouse and key events."""

from __future__ import annotations

import importlib.util
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from game.core import ROOT
from game.face import Face, load_expressions, load_face
from game.tools.face.ratings_file import read_ratings

pytestmark = pytest.mark.window
SIZE = "640x360"


class Desk:
    """A virtual screen and one window on it."""

    def __init__(self, folder: Path, number: int) -> None:
        self.folder = folder
        self._display = f":{number}"
        self._environment = os.environ | {"DISPLAY": self._display, "SDL_VIDEODRIVER": "x11"}
        self._server = subprocess.Popen(
            [
                "Xvfb",
                self._display,
                "-noreset",
                "-screen",
                "0",
                f"{SIZE}x24",
                "-fbdir",
                str(folder),
                "+extension",
                "GLX",
            ],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self.window: subprocess.Popen[bytes] | None = None
        self.log = folder / "log"
        end = time.monotonic() + 20
        while not (folder / "Xvfb_screen0").exists() and time.monotonic() < end:
            time.sleep(0.1)
        time.sleep(0.3)

    def open(self, *words: str) -> None:
        with self.log.open("wb") as log:
            self.window = subprocess.Popen(
                [sys.executable, "run_game.py", "face", *words, "--size", SIZE],
                cwd=ROOT, env=self._environment, stdout=log, stderr=subprocess.STDOUT,
            )  # fmt: skip

    def until(self, done: Callable[[], bool], steps: list[str], limit_s: float = 60.0) -> None:
        """Repeat the steps until something has come true: the first ones come before the window."""
        end = time.monotonic() + limit_s
        while not done():
            assert time.monotonic() < end, self.log.read_text()
            assert self.window is not None
            assert self.window.poll() is None, self.log.read_text()
            for step in steps:
                subprocess.run(["xdotool", *step.split()], env=self._environment, check=False, timeout=10)
                time.sleep(0.4)

    def close(self) -> None:
        for process in (self.window, self._server):
            if process is not None and process.poll() is None:
                process.terminate()
                process.wait(10)


@pytest.fixture
def desk(tmp_path: Path) -> Iterator[Desk]:
    if not (shutil.which("Xvfb") and shutil.which("xdotool")):
        pytest.skip("needs Xvfb and xdotool")
    desk = Desk(tmp_path, 1100 + os.getpid() % 800)
    yield desk
    desk.close()


@pytest.mark.skipif(importlib.util.find_spec("imgui_bundle") is None, reason="needs the tools extra")
def test_authoring_drag_take_name_and_save(desk: Desk) -> None:
    out = desk.folder / "named.yaml"
    desk.open("--save-to", str(out))
    steps = ["mousemove 105 120 mousedown 1", "mousemove 45 70", "mouseup 1", "key 2", "key ctrl+s", "key ctrl+a"]
    desk.until(out.exists, [*steps, "type --delay 40 from_a_test", "key Return"])
    found = load_expressions(out, load_face().model.parts)
    assert list(found) == ["from_a_test"]
    assert found["from_a_test"].face != Face()


def test_rating_survives_a_window_that_is_killed(desk: Desk) -> None:
    out, parts = desk.folder / "r.csv", load_face().model.parts
    words = ("rate", "--rater", "yuki", "--out", str(out), "--parts")
    desk.open(*words)

    def rated() -> int:
        return len(read_ratings(out, parts)) if out.exists() and out.stat().st_size else 0

    # The pad's middle is at (966, 314) of 1280 × 720; a click right of it and above is pleasant and awake.
    steps = ["mousemove 545 107 click 1", "key Return"]
    desk.until(lambda: rated() > 0, steps)
    assert desk.window is not None
    desk.window.send_signal(signal.SIGKILL)
    desk.window.wait(10)
    before = read_ratings(out, parts)
    first = before[0]
    assert (first.rater, first.valence, first.arousal) == (
        "yuki",
        pytest.approx(0.5, abs=0.02),
        pytest.approx(0.4, abs=0.02),
    )
    desk.open(*words)
    desk.until(lambda: rated() > len(before), steps)
    after = read_ratings(out, parts)
    assert len({r.face for r in after}) == len(after), "no face was asked twice"
    assert after[: len(before)] == before
