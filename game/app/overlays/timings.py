"""The frame graph on F8: each pass with its milliseconds, the last two seconds of frames, quality and size."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from game.app.ui import PALETTE, Canvas, Rect, fade
from game.render import PASSES, Renderer

__all__ = ["FRAMES_SHOWN", "draw_timings"]

FRAMES_SHOWN = 120
BUDGET_MS = 20.0


def draw_timings(renderer: Renderer, frames_ms: Sequence[float], canvas: Canvas) -> None:
    """At the top left. ``frames_ms``: the last frames' intervals, newest last."""
    times = renderer.times
    width, row = 300.0, 19.0
    box = Rect(14, 14, width, 96 + row * (len(PASSES) + 1))
    canvas.panel(box, fade(PALETTE["shade"], 1.35), radius=14)
    x, right = box.x + 14, box.x + width - 14
    scene = f"{round(renderer.scale * 100)} %"
    canvas.text(x, box.y + 9, f"{renderer.device.name[:20]} · {renderer.level.name} · {scene}", 13, PALETTE["white"])
    canvas.text(right - 62, box.y + 28, "CPU", 12, PALETTE["paper_warm"], align="right")
    canvas.text(right, box.y + 28, "GPU ms", 12, PALETTE["paper_warm"], align="right")
    y = box.y + 46
    for name in PASSES:
        cpu, gpu = times.cpu_ms.get(name), times.gpu_ms.get(name)
        canvas.text(x, y, name, 13, PALETTE["white"])
        share = min(max(cpu or 0.0, gpu or 0.0) / BUDGET_MS, 1.0)
        canvas.bar(Rect(x + 74, y + 7, 88, 5), share, PALETTE["gold"], fade(PALETTE["white"], 0.15))
        canvas.text(right - 62, y, "–" if cpu is None else f"{cpu:.2f}", 13, PALETTE["white"], align="right")
        canvas.text(right, y, "–" if gpu is None else f"{gpu:.2f}", 13, PALETTE["white"], align="right")
        y += row
    recent = np.array(frames_ms[-FRAMES_SHOWN:] or [0.0])
    middle, late = np.percentile(recent, (50, 99))
    canvas.text(x, y + 2, f"frame {middle:.1f} ms · 99 % {late:.1f} ms", 13, PALETTE["paper_warm"])
    room = Rect(x, y + 22, right - x, 30)
    step = room.w / FRAMES_SHOWN
    points = [
        (room.x + i * step, room.y + room.h * (1.0 - min(v / (2.0 * BUDGET_MS), 1.0))) for i, v in enumerate(recent)
    ]
    canvas.lines([(room.x, room.y + room.h / 2), (room.x + room.w, room.y + room.h / 2)], 1, fade(PALETTE["red"], 0.8))
    if len(points) > 1:
        canvas.lines(points, 1.5, PALETTE["gold"])
