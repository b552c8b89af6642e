"""Soak: hours of play in one process, afternoon after afternoon, and whether memory or GL objects grow meanwhile."""

from __future__ import annotations

import argparse
import gc
import resource
import sys
from dataclasses import replace
from pathlib import Path

import moderngl
import numpy as np

from game.app.bench_rows import Row, row
from game.app.opening import open_session
from game.app.screens import TalkScreen
from game.app.session import Session
from game.app.talk import Choice
from game.app.window import Window
from game.app.world import TICK_S, Intent
from game.core.errors import BadInput
from game.render import Device, level_named

__all__ = ["rows", "soak"]

SIZE = (320, 180)
DRAW_TICKS = 150
"""A frame every five seconds: enough for whatever a frame might keep."""
MEASURES = 20
GL_KINDS = (moderngl.Buffer, moderngl.Texture, moderngl.Framebuffer, moderngl.Program, moderngl.VertexArray)


def resident_mb() -> float:
    """Memory of this process now (where the system tells), else the most it has had."""
    pages = Path("/proc/self/statm")
    if pages.is_file():
        return int(pages.read_text().split()[1]) * resource.getpagesize() / 2**20
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most / (2**20 if sys.platform == "darwin" else 2**10)


def gl_objects() -> int:
    """How many GL objects Python still holds."""
    gc.collect()
    return sum(isinstance(thing, GL_KINDS) for thing in gc.get_objects())


def _intent(session: Session, rng: np.random.Generator) -> Intent:
    """Go on when a line has been heard; say something now and then."""
    world = session.world
    if world.speech is not None:
        return Intent(proceed=bool(rng.random() < 0.05))
    if world.waiting and world.talk is not None and rng.random() < 0.03:
        able = [choice for choice in world.talk.beat.choices if choice.available and choice.act != "offer"]
        return Intent(choice=Choice(able[int(rng.integers(len(able)))].id))
    return Intent()


class _Player(TalkScreen):
    """The talk's screen, played by chance."""

    def __init__(self, session: Session, rng: np.random.Generator) -> None:
        super().__init__()
        self._session, self._rng = session, rng

    def intent(self) -> Intent:
        return _intent(self._session, self._rng)


def soak(hours: float, seed: int = 1) -> list[tuple[float, float, int]]:
    """Play; (hours, megabytes, GL objects) at even distances. Raises BadInput for a length that is none."""
    if not 0.0 < hours <= 100.0:
        raise BadInput("--hours", expected="above 0, at most 100", seen=hours)
    device = Device.headless(*SIZE)
    session = open_session(argparse.Namespace(language="en", stall="flea", seed=seed, mode="full", overlay=False))
    session.taken_up, session.designed = False, True  # nothing of this is saved
    rng = np.random.default_rng(seed)
    window = Window(session, device, level=level_named("low"), screen=_Player(session, rng))
    window.populate()
    ticks = max(round(hours * 3600 / TICK_S), MEASURES)
    found: list[tuple[float, float, int]] = []
    try:
        for tick in range(ticks):
            if session.world.talk is None or session.world.over:
                _next_talk(session, rng)
            window.advance(TICK_S * 1.000001)
            if tick % DRAW_TICKS == 0:
                window.draw()
            if tick % (ticks // MEASURES) == ticks // MEASURES - 1:
                found.append((session.ticks * TICK_S / 3600, resident_mb(), gl_objects()))
    finally:
        window.close()
        device.release()
    return found


def _next_talk(session: Session, rng: np.random.Generator) -> None:
    """Another thing, another language now and then."""
    if session.world.over:
        session.end_talk()
    session.world = replace(session.world, language=("en", "ja")[int(rng.integers(2))])
    items = list(session.assets.talk.script.items)
    session.begin_talk(items[int(rng.integers(len(items)))])


def rows(hours: float = 0.25) -> list[Row]:
    """Growth from a fifth of the way on, when everything has been met, to the end."""
    found = soak(hours)
    (begin_h, begin_mb, begin_gl), (end_h, end_mb, end_gl) = found[MEASURES // 5], found[-1]
    span = max(end_h - begin_h, 1e-9)
    return [
        row(f"soak: memory after {end_h:.2f} h", [end_mb], unit="MB", floor=begin_mb),
        row("soak: growth of memory", [(end_mb - begin_mb) / span], unit="MB/h", wanted="<= 2"),
        row(f"soak: GL objects after {end_h:.2f} h", [float(end_gl)], unit="", floor=float(begin_gl)),
    ]
