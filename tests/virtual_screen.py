"""A virtual X screen for tests that open real windows, and keys and mouse that go through its server like a person's.

The server chooses a free display itself and says which once it listens (``-displayfd``): nothing waits by guess, and no
two screens of one machine, or of one process one after the other, ever meet. It never restarts when its last client
leaves, and goes away with its test, whatever became of the programs on it.
"""

from __future__ import annotations

import os
import select
import shutil
import struct
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[1]
START_S = 60.0


def need_tools() -> None:
    """Skip where there is no virtual screen, or fail where there has to be one."""
    missing = [name for name in ("Xvfb", "xdotool") if shutil.which(name) is None]
    if missing:
        assert not os.environ.get("MCG_REQUIRE_WINDOW"), f"{missing} must be installed here"
        pytest.skip(f"needs {' and '.join(missing)} (Debian: xvfb xdotool)")


class VirtualScreen:
    """A screen of ``size`` pixels with at most one program on it."""

    def __init__(self, folder: Path, size: tuple[int, int]) -> None:
        need_tools()
        self.folder, self.size = folder, size
        self.log = folder / "program.log"
        self.program: subprocess.Popen[bytes] | None = None
        told, tells = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(tells), "-noreset", "-nolisten", "tcp", "-fbdir", str(folder)]
            + ["-screen", "0", f"{size[0]}x{size[1]}x24", "+extension", "GLX"],
            pass_fds=[tells], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(tells)
        try:
            number = ""
            while not number.endswith("\n") and select.select([told], [], [], START_S)[0]:
                piece = os.read(told, 20).decode()
                if not piece:
                    break  # it has ended
                number += piece
        finally:
            os.close(told)
        if not number.endswith("\n"):
            self.close()
            pytest.fail("the virtual screen did not start")
        self.environment = os.environ | {
            "DISPLAY": f":{number.strip()}",
            "SDL_VIDEODRIVER": "x11",
            "SDL_AUDIODRIVER": "dummy",
            "MCG_USER_FOLDER": str(folder / "user"),
        }

    def open(self, *words: str) -> subprocess.Popen[bytes]:
        """Start ``python words…`` on the screen, in the place of what ran there before."""
        self._end(self.program)
        with self.log.open("wb") as log:
            self.program = subprocess.Popen(
                [sys.executable, *words], cwd=ROOT, env=self.environment, stdout=log, stderr=subprocess.STDOUT
            )
        return self.program

    def said(self) -> str:
        """The end of what the program has printed."""
        return self.log.read_text()[-1500:] if self.log.is_file() else ""

    def ended(self) -> bool:
        """Whether the program has."""
        return self.program is not None and self.program.poll() is not None

    def until(
        self, done: Callable[[], bool], what: str = "it", limit_s: float = 90.0, steps: tuple[str, ...] = (),
        pause_s: float = 0.4,
    ) -> None:  # fmt: skip
        """Take the steps in turn, all of them once and again, until something has come true."""
        end = time.monotonic() + limit_s
        while not done():
            assert time.monotonic() < end, f"{what} did not come within {limit_s:g} s; the program says: {self.said()}"
            assert not self.ended(), f"the program ended before {what}; it says: {self.said()}"
            for step in steps:
                self.send(step)
                time.sleep(pause_s)
                if done():
                    return
            time.sleep(0.1)

    def send(self, step: str) -> str:
        """What mouse and keys do, in one go, as xdotool has it."""
        done = subprocess.run(
            ["xdotool", *step.split()], env=self.environment, check=False, timeout=20, capture_output=True, text=True
        )
        return done.stdout

    def pixels(self) -> np.ndarray:
        """(h, w, 3) of what the screen shows now (its frame buffer is a file in XWD form)."""
        raw = (self.folder / "Xvfb_screen0").read_bytes()
        header, colours = struct.unpack(">I", raw[:4])[0], struct.unpack(">I", raw[76:80])[0]
        width, height = self.size
        pixels = np.frombuffer(raw, np.uint8, width * height * 4, header + colours * 12).reshape(height, width, 4)
        return pixels[:, :, 2::-1]

    def close(self) -> None:
        """End the program, and the screen in any case."""
        try:
            self._end(self.program)
        finally:
            self._end(self.server)

    @staticmethod
    def _end(process: subprocess.Popen[bytes] | None) -> None:
        if process is None or process.poll() is not None:
            return
        process.terminate()
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait(10)
