"""The renderer's benchmark: the whole game frame at each quality level, and the bare scene as the floor."""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable

import numpy as np

from game.app.bench_rows import Row, row
from game.app.play import Window, open_session
from game.app.session import Session
from game.render import LEVELS, Device
from game.render.bench_floor import BareScene

__all__ = ["measure_ms", "rows"]

FRAMES = 40


def measure_ms(draw: Callable[[], None], device: Device, frames: int = FRAMES) -> list[float]:
    """Milliseconds of finished frames."""
    for _ in range(4):
        draw()
    device.context.finish()
    times = []
    for _ in range(frames):
        start = time.perf_counter()
        draw()
        device.context.finish()
        times.append((time.perf_counter() - start) * 1e3)
    return times


def _talk_window(device: Device) -> Window:
    from game.app.afternoon import visit_stall
    from game.app.screens import TalkScreen
    from game.app.world import enter_talk

    args = argparse.Namespace(language="en", stall="flea", seed=1, mode="full", overlay=False)
    session: Session = open_session(args)
    window = Window(session, device)
    window.populate()
    item = next(iter(session.assets.talk.script.items))
    talk = visit_stall(session.assets.talk, session.afternoon, item)
    session.world = enter_talk(session.assets, session.world, talk)
    window.screen = TalkScreen()
    for _ in range(180):  # until the camera rests
        window.advance(1 / 30)
    return window


def rows(size: tuple[int, int] = (1280, 720)) -> list[Row]:
    """The frame of a talk (character, stall, subtitles, price) while it moves; ticks are not part of the time.

    Frames and floors are drawn in turns, so that whatever else the machine does falls on both.
    """
    device = Device.headless(*size)
    window = _talk_window(device)
    bare = {samples: BareScene(device, samples) for samples in (0, 4)}
    wants = {"default": "<= 20 ms", "ultra": "<= 33 ms", "high": "<= 33 ms"}
    result = []
    for level in LEVELS:
        window.renderer.set_level(level)
        times: list[float] = []
        floor: list[float] = []
        for _ in range(FRAMES // 4):
            window.advance(1 / 30)
            times += measure_ms(window.draw, device, 4)
            floor += measure_ms(bare[level.samples].draw, device, 4)
        name = f"frame {size[0]}x{size[1]} {level.name} on {device.name[:24]}"
        wanted = wants.get(level.name, "")
        result.append(row(name, times, unit="ms", floor=statistics.median(floor), wanted=wanted))
        result[-1] |= {"p99": float(np.percentile(times, 99)), "floor_min": min(floor)}
    for scene in bare.values():
        scene.release()
    window.close()
    device.release()
    return result
