"""Displays that really go away: the server killed, the connection cut, the window destroyed. Nothing is lost."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.virtual_screen import VirtualScreen

pytestmark = pytest.mark.window

PROGRAM = """
import itertools, pathlib, sys
import pygame
from game.app.display_loss import watch_display
from game.render import Device

folder = pathlib.Path(sys.argv[1])
pygame.display.init()
device = Device.window(160, 90, "to be lost")

def keep():
    (folder / "kept").write_text("everything")

with watch_display(keep):
    for frame in itertools.count():
        pygame.event.get()
        device.context.screen.clear(frame % 60 / 60.0, 0.5, 0.5)
        pygame.display.flip()
        pygame.time.wait(20)
        if frame == 3:
            (folder / "drawing").touch()
        if (folder / "enough").exists():
            break
print("left in order")
"""


@pytest.fixture
def screen(tmp_path: Path) -> Iterator[VirtualScreen]:
    screen = VirtualScreen(tmp_path, (320, 180))
    yield screen
    screen.close()


@pytest.mark.parametrize(
    ("how", "why"),
    [
        ("the server is killed", "the display went away"),
        ("the connection is cut", "the display went away"),
        ("the window is destroyed", "the window was destroyed"),
        ("nothing", ""),
    ],
)
def test_a_display_that_is_lost_costs_one_line_and_nothing_else(
    screen: VirtualScreen, tmp_path: Path, how: str, why: str
) -> None:
    program = screen.open("-c", PROGRAM, str(tmp_path))
    screen.until((tmp_path / "drawing").exists, "a picture")
    (window,) = screen.send("search --onlyvisible --class .").split()
    if how == "the server is killed":
        screen.server.kill()
    elif how == "the connection is cut":
        screen.send(f"windowkill {window}")
    elif how == "the window is destroyed":
        screen.send(f"windowclose {window}")
    else:
        (tmp_path / "enough").touch()
    screen.until(screen.ended, "the end", limit_s=60.0)
    lines = [line for line in screen.log.read_text().splitlines() if "pygame" not in line]
    if not why:
        assert lines == ["left in order"]
        assert program.returncode == 0
        assert not (tmp_path / "kept").exists()
        return
    assert lines == [f"error: the picture was lost ({why}); the game was saved, start it again to go on"]
    assert program.returncode == 2
    assert (tmp_path / "kept").read_text() == "everything"
