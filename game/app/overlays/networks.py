"""The three networks, drawn live: every unit a node, the way on from the running one as weighted edges, and the four
factors of eq. 1 for the running unit and the runner-up."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np

from game.app.overlays.units import LAYER_COLOURS
from game.app.session import Session
from game.app.ui import PALETTE, Canvas, Rect, fade
from game.embos import Candidate

__all__ = ["draw_networks"]

FACTORS = ("continuity", "linkage", "time", "state")


def draw_networks(session: Session, canvas: Canvas) -> None:
    """Three rings side by side, a factor table under each."""
    world, s, planner = session.world, session.strings, session.assets.planner
    if world.body.signal is None:
        return
    width = canvas.width - 420.0
    canvas.panel(Rect(10, 10, width, min(canvas.height - 164, 560)), fade(PALETTE["shade"], 1.25), radius=18)
    canvas.text(10 + width / 2, 18, s("network_title"), 16, PALETTE["white"], align="center")
    explained = planner.explain(world.body.planner, world.body.signal, 0)
    column = width / len(explained)
    for i, candidates in enumerate(explained):
        x = 10 + i * column
        layer = candidates[0].layer
        canvas.text(x + column / 2, 42, s(layer), 18, LAYER_COLOURS[layer], font="bold", align="center")
        _draw_ring(session, canvas, candidates, (x + column / 2, 172.0), min(column * 0.36, 96.0))
        _draw_table(session, canvas, candidates[:2], Rect(x + 12, 306, column - 24, canvas.height - 480))


def _draw_ring(
    session: Session, canvas: Canvas, candidates: list[Candidate], centre: tuple[float, float], radius: float
) -> None:
    ordered = sorted(candidates, key=lambda c: c.unit)
    colour = LAYER_COLOURS[ordered[0].layer]
    place = {}
    for i, candidate in enumerate(ordered):
        angle = 2 * pi * i / len(ordered) - pi / 2
        # Large networks are drawn as two rings, so that their numbers stay apart.
        r = radius * (1.12 if i % 2 == 0 else 0.84) if len(ordered) > 20 else radius
        place[candidate.unit] = (centre[0] + r * cos(angle), centre[1] + r * sin(angle))
    running = candidates[0]
    strongest = max((c.score for c in candidates), default=0.0)
    start = np.array(place[running.unit])
    for candidate in candidates[1:]:
        if candidate.linkage > 0 and candidate.continuity > 0.12:
            end = np.array(place[candidate.unit])
            canvas.lines([tuple(start), tuple(end)], 1.0 + 2.0 * candidate.continuity, fade(colour, 0.34))
    for rank, candidate in enumerate(candidates):
        x, y = place[candidate.unit]
        share = candidate.score / strongest if strongest > 0 else 0.0
        shade = colour if candidate.linkage > 0 else (0.5, 0.42, 0.45, 1.0)
        canvas.dot(x, y, 5 + 5 * share, fade(shade, 0.45 + 0.5 * share))
        if rank < 2:
            canvas.dot(x, y, 12 if rank == 0 else 9, PALETTE["white"] if rank == 0 else fade(PALETTE["white"], 0.6))
            canvas.dot(x, y, 9 if rank == 0 else 7, colour)
        canvas.text(x, y - 8, str(candidate.unit), 11, PALETTE["white"], font="bold", align="center")


def _draw_table(session: Session, canvas: Canvas, pair: list[Candidate], room: Rect) -> None:
    s, library = session.strings, session.assets.planner.library
    colour = LAYER_COLOURS[pair[0].layer]
    y = room.y
    for rank, candidate in enumerate(pair):
        paint = PALETTE["white"] if rank == 0 else fade(PALETTE["white"], 0.65)
        title = f"{candidate.unit}  {library.units[candidate.unit].title(s.language)}"
        canvas.text(room.x, y, title, 15, paint, font="bold")
        canvas.text(room.x + room.w, y, f"{candidate.score:.3f}", 14, paint, align="right")
        y += 22
        for factor in FACTORS:
            value = float(getattr(candidate, factor))
            canvas.text(room.x, y - 3, s(factor), 12, paint)
            canvas.bar(Rect(room.x + 82, y + 2, room.w - 124, 7), value, fade(colour, paint[3]), (1, 1, 1, 0.14))
            canvas.text(room.x + room.w, y - 3, f"{value:.2f}", 12, paint, align="right")
            y += 17
        if rank == 0:
            canvas.paragraph(Rect(room.x, y + 2, room.w, 36), candidate.reason, 12, fade(PALETTE["white"], 0.85))
            y += 38
            if candidate.source:  # the take and span that is playing
                canvas.text(room.x, y - 2, candidate.source, 12, fade(colour, 0.95))
                y += 17
        y += 8
