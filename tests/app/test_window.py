"""The real window on a virtual display, played with real key and mouse events: to a deal, and to a refusal."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.virtual_screen import VirtualScreen

ROOT = Path(__file__).resolve().parents[2]
SIZE = (640, 360)

pytestmark = pytest.mark.window


class Desk(VirtualScreen):
    """A virtual screen with the game on it."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        super().__init__(folder, SIZE)
        self.open("run_game.py", "play", "--size", f"{SIZE[0]}x{SIZE[1]}", *arguments)

    def press(self, done: Callable[[], bool], what: str, *keys: str) -> None:
        """Press keys in turn until something has come true."""
        self.until(done, what, steps=tuple(f"key {key}" for key in keys), pause_s=0.15)

    def click(self, x: float, y: float) -> None:
        """Click at reference coordinates of the 1280 × 720 layout."""
        at = f"{round(x * SIZE[0] / 1280)} {round(y * SIZE[1] / 720)}"
        self.send(f"mousemove {at} sleep 0.15 click 1")

    def saved(self) -> dict:
        path = self.folder / "user" / "autosave.json"
        return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


@pytest.fixture
def open_desk(tmp_path: Path) -> Iterator[Callable[..., Desk]]:
    desks: list[Desk] = []

    def make(*arguments: str) -> Desk:
        desks.append(Desk(tmp_path, *arguments))
        return desks[-1]

    yield make
    for desk in desks:
        desk.close()


def drawn(desk: Desk) -> bool:
    """Whether the stall is on the screen: a blank window has a single colour."""
    screen = desk.pixels()
    return float(screen.std()) > 30 and len(np.unique(screen.reshape(-1, 3)[::37], axis=0)) > 300


def test_a_game_from_the_title_to_a_deal_and_to_a_refusal(open_desk) -> None:
    desk = open_desk("--seed", "3", "--stall", "flea")
    desk.until(lambda: drawn(desk), "the first picture")
    title = desk.pixels().astype(int)

    desk.click(224, 359)  # Go to the market
    desk.until(lambda: float(np.abs(desk.pixels().astype(int) - title)[:, 440:].mean()) > 8, "the list")
    sheet = desk.pixels().astype(int)
    desk.send("key space")  # fold it up
    desk.until(lambda: float(np.abs(desk.pixels().astype(int) - sheet).mean()) > 8, "the table")
    desk.click(1066, 128)  # the first thing on the list
    desk.until(lambda: bool(desk.saved().get("talk")), "the talk")

    # Hear her out, set the dial to the asking price (P), and offer it (B).
    desk.press(lambda: bool(desk.saved()["afternoon"]["bought"]), "the deal", "space", "p", "b")
    first = desk.saved()["afternoon"]
    assert first["talks"] == 1
    assert first["purse"] == first["budget"] - first["bought"][0]["price"]

    # Back to the table, the next thing, and walk away from it (G).
    desk.press(lambda: bool(desk.saved().get("talk")), "the next talk", "space", "2")
    desk.press(lambda: desk.saved()["afternoon"]["talks"] == 2, "the refusal", "space", "g")
    second = desk.saved()["afternoon"]
    assert len(second["bought"]) == 1
    assert second["stalls"]["flea"]["annoyance"] == 1
    assert drawn(desk)

    desk.press(desk.ended, "the end", "Escape")
    assert desk.program is not None
    assert desk.program.returncode == 0, desk.said()


def test_without_a_display_one_line_says_what_to_do() -> None:
    environment = {k: v for k, v in os.environ.items() if k not in {"DISPLAY", "WAYLAND_DISPLAY"}}
    environment |= {"SDL_VIDEODRIVER": "x11"}
    done = subprocess.run(
        [sys.executable, "run_game.py"], cwd=ROOT, env=environment, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 2
    assert done.stderr.startswith("error: ")
    assert done.stderr.count("\n") == 1
    assert "autoplay" in done.stderr
