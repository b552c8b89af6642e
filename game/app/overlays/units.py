"""The active node of each network at the bottom left: index and name, as in the paper's figure 6."""

from __future__ import annotations

from game.app.session import Session
from game.app.ui import PALETTE, Canvas, Rect, fade

__all__ = ["LAYER_COLOURS", "draw_units"]

LAYER_COLOURS = {
    "posture": (0.36, 0.62, 0.86, 1.0),
    "gesture": (0.95, 0.66, 0.28, 1.0),
    "mannerism": (0.55, 0.80, 0.52, 1.0),
}


def draw_units(session: Session, canvas: Canvas) -> None:
    """One row per layer: how far through its duration the unit is, its index, its name."""
    world, s = session.world, session.strings
    library, decisions = session.assets.planner.library, world.body.decisions
    top = canvas.height - 356.0
    canvas.panel(Rect(14, top, 366, 100), PALETTE["shade"], radius=14)
    for row, layer in enumerate(session.assets.planner.tables.layers):
        y = top + 10 + row * 29
        index = int(decisions.unit[0, row])
        colour = LAYER_COLOURS[layer]
        canvas.text(26, y, s(layer), 14, colour)
        if index < 0:
            continue
        unit = library.units[index]
        canvas.text(138, y - 1, f"{index}", 16, PALETTE["white"], font="bold", align="right")
        canvas.text(148, y - 1, unit.title(s.language), 16, PALETTE["white"])
        duration = float(decisions.duration_s[0, row])
        if duration > 0:
            share = (world.time_s - float(decisions.start_time_s[0, row])) / duration
            canvas.bar(Rect(26, y + 20, 342, 3), min(max(share, 0.0), 1.0), colour, fade(colour, 0.2))
