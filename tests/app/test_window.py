"""The real window on a virtual display, played with real key and mouse events: to a deal, and to a refusal."""

from __future__ import annotations

import json
import os
import shutil
import struct
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
SIZE = (640, 360)

pytestmark = pytest.mark.window


class Desk:
    """A virtual screen with the game on it. Keys and clicks go through the X server like a person's."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        self.folder = folder
        self.display = f":{70 + os.getpid() % 900}"
        self.server = subprocess.Popen(
            [
                "Xvfb",
                self.display,
                "-screen",
                "0",
                f"{SIZE[0]}x{SIZE[1]}x24",
                "-fbdir",
                str(folder),
                "+extension",
                "GLX",
                "-noreset",  # else the server starts anew, deaf for a moment, whenever its last client leaves
            ],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self.environment = os.environ | {
            "DISPLAY": self.display,
            "MCG_USER_FOLDER": str(folder / "user"),
            "SDL_AUDIODRIVER": "dummy",
            "SDL_VIDEODRIVER": "x11",
        }
        self.log = (folder / "game.log").open("w+")
        self.until(lambda: (folder / "Xvfb_screen0").exists(), "the virtual display")
        time.sleep(0.3)
        self.game = subprocess.Popen(
            [sys.executable, "run_game.py", "play", "--size", f"{SIZE[0]}x{SIZE[1]}", *arguments],
            cwd=ROOT,
            env=self.environment,
            stdout=self.log,
            stderr=subprocess.STDOUT,
        )

    def until(self, done: Callable[[], bool], what: str, limit_s: float = 90.0, keys: tuple[str, ...] = ()) -> None:
        """Press keys in turn until something has come true."""
        end, turn = time.monotonic() + limit_s, 0
        while not done():
            assert time.monotonic() < end, f"{what} did not come within {limit_s:g} s; {self.said()}"
            if keys:
                assert self.game.poll() is None, f"the game ended before {what}: {self.said()}"
                self.send("key", keys[turn % len(keys)])
                turn += 1
            time.sleep(0.15)

    def said(self) -> str:
        return "the game says: " + (self.folder / "game.log").read_text()[-500:]

    def send(self, *words: str) -> None:
        subprocess.run(["xdotool", *words], env=self.environment, check=False, timeout=10)

    def click(self, x: float, y: float) -> None:
        """Click at reference coordinates of the 1280 × 720 layout."""
        self.send("mousemove", str(round(x * SIZE[0] / 1280)), str(round(y * SIZE[1] / 720)))
        time.sleep(0.15)
        self.send("click", "1")

    def screen(self) -> np.ndarray:
        """(h, w, 3) of what the virtual display shows now (its frame buffer is a file in XWD form)."""
        raw = (self.folder / "Xvfb_screen0").read_bytes()
        header, colours = struct.unpack(">I", raw[:4])[0], struct.unpack(">I", raw[76:80])[0]
        start = header + colours * 12
        pixels = np.frombuffer(raw, np.uint8, SIZE[0] * SIZE[1] * 4, start).reshape(SIZE[1], SIZE[0], 4)
        return pixels[:, :, 2::-1]

    def saved(self) -> dict:
        path = self.folder / "user" / "autosave.json"
        return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}

    def close(self) -> None:
        for process in (self.game, self.server):
            if process.poll() is None:
                process.terminate()
                try:
                    process.wait(10)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait(10)
        self.log.close()


@pytest.fixture
def open_desk(tmp_path: Path) -> Iterator[Callable[..., Desk]]:
    missing = [name for name in ("Xvfb", "xdotool") if shutil.which(name) is None]
    if missing:
        assert not os.environ.get("MCG_REQUIRE_WINDOW"), f"{missing} must be installed here"
        pytest.skip(f"needs {' and '.join(missing)} (Debian: xvfb xdotool)")
    desks: list[Desk] = []

    def make(*arguments: str) -> Desk:
        desks.append(Desk(tmp_path, *arguments))
        return desks[-1]

    yield make
    for desk in desks:
        desk.close()


def drawn(desk: Desk) -> bool:
    """Whether the stall is on the screen: a blank window has a single colour."""
    screen = desk.screen()
    return float(screen.std()) > 30 and len(np.unique(screen.reshape(-1, 3)[::37], axis=0)) > 300


def test_a_game_from_the_title_to_a_deal_and_to_a_refusal(open_desk) -> None:
    desk = open_desk("--seed", "3", "--stall", "flea")
    desk.until(lambda: drawn(desk), "the first picture")
    title = desk.screen().astype(int)

    desk.click(224, 359)  # Go to the market
    desk.until(lambda: float(np.abs(desk.screen().astype(int) - title)[:, 440:].mean()) > 8, "the list")
    sheet = desk.screen().astype(int)
    desk.send("key", "space")  # fold it up
    desk.until(lambda: float(np.abs(desk.screen().astype(int) - sheet).mean()) > 8, "the table")
    desk.click(1066, 128)  # the first thing on the list
    desk.until(lambda: bool(desk.saved().get("talk")), "the talk")

    # Hear her out, set the dial to the asking price (P), and offer it (B).
    desk.until(lambda: bool(desk.saved()["afternoon"]["bought"]), "the deal", keys=("space", "p", "b"))
    first = desk.saved()["afternoon"]
    assert first["talks"] == 1
    assert first["purse"] == first["budget"] - first["bought"][0]["price"]

    # Back to the table, the next thing, and walk away from it (G).
    desk.until(lambda: bool(desk.saved().get("talk")), "the next talk", keys=("space", "2"))
    desk.until(lambda: desk.saved()["afternoon"]["talks"] == 2, "the refusal", keys=("space", "g"))
    second = desk.saved()["afternoon"]
    assert len(second["bought"]) == 1
    assert second["stalls"]["flea"]["annoyance"] == 1
    assert drawn(desk)

    desk.until(lambda: desk.game.poll() is not None, "the end", keys=("Escape",))
    assert desk.game.returncode == 0, desk.said()


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
