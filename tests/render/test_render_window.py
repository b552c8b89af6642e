"""The device on a real window of a virtual display, in a process of its own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.window
ROOT = Path(__file__).resolve().parents[2]

SCRIPT = """
import sys
import numpy as np
import pygame
from game.core import ASSETS
from game.render import Device, FontSet, FrameView, Renderer, load_picture, load_stall, rgba

pygame.display.init()
device = Device.window(480, 270, "test")
assert device.windowed and device.size == (480, 270)
renderer = Renderer(
    device,
    None,
    load_stall(ASSETS / "stalls" / "flea.glb"),
    load_picture(ASSETS / "stalls" / "flea_backdrop.png"),
    fonts=FontSet.for_language("en"),
)

def hud(brush):
    brush.rect(0, 0, 100, 100, fill=rgba("#00ff00"))

view = FrameView(np.zeros((60, 4, 4), np.float32), hud=hud)
for size in ((480, 270), (400, 225)):
    device.resize(*size)
    renderer.draw(view)
    pixels = renderer.read_pixels()
    assert pixels.shape == (size[1], size[0], 3)
    assert tuple(pixels[10, 10]) == (0, 255, 0)
    assert pixels[60:].std() > 30
    pygame.display.flip()
    assert device.context.error == "GL_NO_ERROR"
renderer.release()
device.release()
pygame.quit()
print("drawn")
"""


def test_a_window_shows_frames_at_every_size() -> None:
    xvfb = shutil.which("xvfb-run")
    if xvfb is None:
        pytest.skip("xvfb-run is not installed (apt-get install xvfb)")
    result = subprocess.run(
        [xvfb, "-a", "-s", "-screen 0 640x480x24", sys.executable, "-c", SCRIPT],
        cwd=ROOT,
        env=os.environ | {"SDL_VIDEODRIVER": "x11", "SDL_AUDIODRIVER": "dummy"},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert result.stdout.strip().endswith("drawn"), result.stderr[-800:]
