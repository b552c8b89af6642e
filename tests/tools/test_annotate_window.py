"""The annotation desk on a virtual display, driven by real mouse and key events."""

from __future__ import annotations

import importlib.util
import signal
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from game.core.paths import ASSETS
from game.formats.bvh import read_bvh, write_bvh
from game.tools.annotate.files import autosave_path, read_document
from tests.virtual_screen import VirtualScreen

pytestmark = [
    pytest.mark.window,
    pytest.mark.skipif(importlib.util.find_spec("imgui_bundle") is None, reason="needs the tools extra"),
]
SIZE = (720, 450)


@pytest.fixture
def screen(tmp_path: Path) -> Iterator[VirtualScreen]:
    screen = VirtualScreen(tmp_path, SIZE)
    yield screen
    screen.close()


def annotate(screen: VirtualScreen, take: Path) -> None:
    screen.open("run_game.py", "annotate", str(take), "--size", f"{SIZE[0]}x{SIZE[1]}")


def _gestures(notes: Path) -> int:
    kept = autosave_path(notes)
    return kept.read_text().count("layer: gesture") if kept.exists() else 0


def test_a_take_is_annotated_from_nothing_and_survives_a_window_that_is_killed(
    screen: VirtualScreen, tmp_path: Path
) -> None:
    take = tmp_path / "short.bvh"
    clip = read_bvh(ASSETS / "motion" / "takes" / "neutral.bvh").clip
    write_bvh(replace(clip, rotation=clip.rotation[:150].copy(), translation=clip.translation[:150].copy()), take)
    notes = take.with_suffix(".yaml")
    annotate(screen, take)
    drag = "mousemove 120 {y} mousedown 1|mousemove 300 {y}|mousemove 420 {y}|mouseup 1"
    screen.until(notes.exists, "the file", steps=(*drag.format(y=322).split("|"), "key ctrl+s"))
    (posture,) = read_document(notes).marks
    assert (posture.layer, posture.behaviour) == ("posture", "upright")
    assert posture.length_s >= 1.0
    assert abs(posture.start_s * 30 - round(posture.start_s * 30)) < 0.02, "edges snap to frames"

    # A quick hand: arriving, pressing, moving and letting go may all lie within one frame. None of it may be lost.
    for number, x in enumerate((120, 300, 480), 1):
        at_once = f"mousemove 300 100 sleep 0.5 mousemove {x} 384 mousedown 1 mousemove {x + 90} 384 mouseup 1"
        screen.send(at_once)
        screen.until(lambda n=number: _gestures(notes) >= n, f"gesture {number}", limit_s=30.0)
        assert _gestures(notes) == number

    steps = ("key b", "type --delay 40 nod", "key Return")
    screen.until(lambda: "nod" in autosave_path(notes).read_text(), "the name", steps=steps)
    assert len(read_document(notes).marks) == 1, "what has not been saved is not in the file"
    assert screen.program is not None
    screen.program.send_signal(signal.SIGKILL)
    screen.program.wait(10)
    annotate(screen, take)
    screen.until(lambda: "nod" in notes.read_text(), "what was kept", steps=("key Return", "key ctrl+s"))
    assert [m.behaviour for m in read_document(notes).of_layer("gesture")] == ["point_at", "point_at", "nod"]
