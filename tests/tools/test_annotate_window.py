"""The annotation desk on a virtual display, driven by real mouse and key events."""

from __future__ import annotations

import importlib.util
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from game.core import ROOT
from game.core.paths import ASSETS
from game.formats.bvh import read_bvh, write_bvh
from game.tools.annotate.files import autosave_path, read_document

pytestmark = [
    pytest.mark.window,
    pytest.mark.skipif(importlib.util.find_spec("imgui_bundle") is None, reason="needs the tools extra"),
]
SIZE = "720x450"


class Screen:
    """A virtual screen with the desk on it."""

    def __init__(self, folder: Path, number: int) -> None:
        self.environment = os.environ | {"DISPLAY": f":{number}", "SDL_VIDEODRIVER": "x11"}
        self.log = folder / "log"
        self.window: subprocess.Popen[bytes] | None = None
        self.server = subprocess.Popen(
            ["Xvfb", f":{number}", "-noreset", "-screen", "0", f"{SIZE}x24", "-fbdir", str(folder)]
            + ["+extension", "GLX"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        end = time.monotonic() + 20
        while not (folder / "Xvfb_screen0").exists() and time.monotonic() < end:
            time.sleep(0.1)
        time.sleep(0.3)

    def open(self, take: Path) -> subprocess.Popen[bytes]:
        with self.log.open("wb") as log:
            self.window = subprocess.Popen(
                [sys.executable, "run_game.py", "annotate", str(take), "--size", SIZE],
                cwd=ROOT, env=self.environment, stdout=log, stderr=subprocess.STDOUT,
            )  # fmt: skip
        return self.window

    def until(self, done: Callable[[], bool], steps: list[str]) -> None:
        """Repeat the steps until something has come true: the first ones come before the window."""
        end = time.monotonic() + (90.0 if steps else 30.0)
        while not done():
            assert time.monotonic() < end, self.log.read_text()
            assert self.window is not None
            assert self.window.poll() is None, self.log.read_text()
            for step in steps:
                self.send(step)
                time.sleep(0.4)
            time.sleep(0.1)

    def send(self, step: str) -> None:
        """What mouse and keys do, in one go."""
        subprocess.run(["xdotool", *step.split()], env=self.environment, check=False, timeout=10)

    def close(self) -> None:
        for process in (self.window, self.server):
            if process is not None and process.poll() is None:
                process.terminate()
                process.wait(10)


@pytest.fixture
def screen(tmp_path: Path) -> Iterator[Screen]:
    if not (shutil.which("Xvfb") and shutil.which("xdotool")):
        pytest.skip("needs Xvfb and xdotool")
    screen = Screen(tmp_path, 1100 + os.getpid() % 800)
    yield screen
    screen.close()


def _gestures(notes: Path) -> int:
    kept = autosave_path(notes)
    return kept.read_text().count("layer: gesture") if kept.exists() else 0


def test_a_take_is_annotated_from_nothing_and_survives_a_window_that_is_killed(screen: Screen, tmp_path: Path) -> None:
    take = tmp_path / "short.bvh"
    clip = read_bvh(ASSETS / "motion" / "takes" / "neutral.bvh").clip
    write_bvh(replace(clip, rotation=clip.rotation[:150].copy(), translation=clip.translation[:150].copy()), take)
    notes = take.with_suffix(".yaml")
    screen.open(take)
    drag = "mousemove 120 {y} mousedown 1|mousemove 300 {y}|mousemove 420 {y}|mouseup 1"
    screen.until(notes.exists, [*drag.format(y=322).split("|"), "key ctrl+s"])
    (posture,) = read_document(notes).marks
    assert (posture.layer, posture.behaviour) == ("posture", "upright")
    assert posture.length_s >= 1.0
    assert abs(posture.start_s * 30 - round(posture.start_s * 30)) < 0.02, "edges snap to frames"

    # A quick hand: arriving, pressing, moving and letting go may all lie within one frame. None of it may be lost.
    for number, x in enumerate((120, 300, 480), 1):
        at_once = f"mousemove 300 100 sleep 0.5 mousemove {x} 384 mousedown 1 mousemove {x + 90} 384 mouseup 1"
        screen.send(at_once)
        screen.until(lambda n=number: _gestures(notes) >= n, [])
        assert _gestures(notes) == number

    steps = ["key b", "type --delay 40 nod", "key Return"]
    screen.until(lambda: "nod" in autosave_path(notes).read_text(), steps)
    assert len(read_document(notes).marks) == 1, "what has not been saved is not in the file"
    assert screen.window is not None
    screen.window.send_signal(signal.SIGKILL)
    screen.window.wait(10)
    screen.open(take)
    screen.until(lambda: "nod" in notes.read_text(), ["key Return", "key ctrl+s"])
    assert [m.behaviour for m in read_document(notes).of_layer("gesture")] == ["point_at", "point_at", "nod"]
