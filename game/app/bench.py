"""Measure speed against floors run beside it, in the same process.

examples:
  run_game.py bench
  run_game.py bench planner render --json
  run_game.py bench autoplay --inkjs DIR      beside inkjs (npm install inkjs in DIR)
  run_game.py bench soak --hours 8            does memory grow, or the number of GL objects? (not part of plain bench)
  run_game.py bench observer                  can the feeling be told from the body? (not part of plain bench)

A floor is the least code that does the same work: NumPy alone, a bare scene, a hand-written loop. Benchmarks are no
tests: absolute figures drift from machine to machine, the ratios tell.
"""

from __future__ import annotations

import argparse
import gc
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from game.app.bench_rows import Row, row
from game.core.paths import ROOT

__all__ = ["BENCHES", "add_arguments", "first_frame", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``bench``."""
    parser.add_argument("what", nargs="*", choices=[*BENCHES, []], metavar="WHAT", help=f"of {' '.join(BENCHES)}")
    parser.add_argument("--quick", action="store_true", help="observer: fewer performances, no second observers")
    parser.add_argument(
        "--inkjs", type=Path, metavar="DIR", help="autoplay: a folder where inkjs is installed, for comparison"
    )
    parser.add_argument("--hours", type=float, default=0.25, help="soak: simulated hours (default 0.25)")
    parser.add_argument("--json", action="store_true", help="machine-readable")


def pose() -> list[Row]:
    """Planner's units to skin matrices, for 1, 100 and 1000 characters."""
    from game.app import bench_pose

    return bench_pose.rows()


def planner() -> list[Row]:
    """Eq. 1 for 3 layers of 40 units."""
    from game.app import bench_planner

    return bench_planner.rows()


def render() -> list[Row]:
    """The whole frame by quality level, against a bare scene of that size."""
    from game.app import bench_render

    return bench_render.rows()


def autoplay(inkjs: Path | None = None) -> list[Row]:
    """Choices per second of the story engine and of whole talks, and talks per second with the body's planner.

    inkjs: a folder where ``npm install inkjs`` was run, to measure it beside ours on the same talk.
    """
    from game.app import bench_bodies, bench_talk

    return bench_talk.rows(inkjs) + bench_bodies.rows()


def first_frame() -> None:
    """What a start of the game does up to the first finished frame, without a display."""
    gc.disable()  # as game.app.cli.main
    from game.app.play import Window, open_session
    from game.render import Device

    args = argparse.Namespace(language="en", stall="flea", seed=1, mode="full", overlay=False)
    device = Device.headless(1280, 720)
    window = Window(open_session(args), device)
    window.renderer.drafts = True  # as in a window
    window.draw()
    device.context.finish()


def start() -> list[Row]:
    """Seconds from the start of the interpreter to the first frame."""
    code = "from game.app.bench import first_frame; first_frame()"
    # As on a player's machine: compiled modules are kept, one BLAS thread (run_game.py).
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    environment |= {"OPENBLAS_NUM_THREADS": "1", "PYGAME_HIDE_SUPPORT_PROMPT": "1"}
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, env=environment)
    seconds = []
    for _ in range(3):
        before = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, env=environment)
        seconds.append(time.perf_counter() - before)
    bare = []
    for _ in range(3):
        before = time.perf_counter()
        subprocess.run([sys.executable, "-c", "import numpy, scipy, pygame, moderngl"], cwd=ROOT, check=True)
        bare.append(time.perf_counter() - before)
    return [row("start: to the first frame", seconds, unit="s", floor=statistics.median(bare), wanted="<= 2.5 s")]


def observer(quick: bool = False) -> list[Row]:
    """What an observer who learnt from the takes tells from generated bodies; no speed, so not part of plain bench."""
    from game.app import bench_observer

    return bench_observer.rows(quick)


def soak(hours: float = 0.25) -> list[Row]:
    """Hours of play in one process: does anything grow? Not part of plain bench."""
    from game.app import bench_soak

    return bench_soak.rows(hours)


BENCHES: dict[str, Callable[[], list[Row]]] = {
    "pose": pose,
    "planner": planner,
    "render": render,
    "autoplay": autoplay,
    "start": start,
    "observer": observer,
    "soak": soak,
}


def run(args: argparse.Namespace) -> int:
    """Run the chosen benches and print one table, or one JSON document."""
    results: dict[str, list[dict[str, Any]]] = {}
    for name in args.what or [name for name in BENCHES if name not in {"observer", "soak"}]:
        if name == "observer":
            rows = observer(args.quick)
        elif name == "soak":
            rows = soak(args.hours)
        else:
            rows = autoplay(args.inkjs) if name == "autoplay" else BENCHES[name]()
        results[name] = rows
        if not args.json:
            _print(name, rows)
        if name == "observer" and not args.json:
            from game.app.bench_observer import show

            show(rows)
    if args.json:
        print(json.dumps(results, ensure_ascii=False))
    return 0


def _print(name: str, rows: list[Row]) -> None:
    print(f"\n{name}\n  {'what':<58}{'median':>11}{'min':>11}{'spread':>8}{'floor':>11}{'ratio':>7}  wanted")
    for item in rows:
        unit = item.get("unit", "")

        def shown(key: str, item: Row = item, unit: str = unit) -> str:
            value = item.get(key)
            return "–" if value is None else f"{value:,.4g} {unit}"

        ratio = item.get("ratio")
        spread = item.get("spread")
        print(
            f"  {item['name']:<58}{shown('median'):>11}{shown('min'):>11}"
            f"{'–' if spread is None else f'{spread:.0%}':>8}{shown('floor'):>11}"
            f"{'–' if ratio is None else f'{ratio:.2f}':>7}  {item.get('wanted', '')}"
        )
