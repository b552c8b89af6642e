"""The hidden feelings from move to move: felt as lines with marks of their own, the mask as a dashed line."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from game.app.session import Session
from game.app.tokens import draw_token
from game.app.ui import FEELING_COLOURS, INK, PALETTE, Canvas, Colour, Rect, fade
from game.app.world import Mark
from game.core.emotion_space import SIX

__all__ = ["QUALITY_SIGNS", "draw_curve"]

QUALITY_COLOURS = {"right": PALETTE["teal"], "neutral": PALETTE["faint"], "wrong": PALETTE["red"]}
QUALITY_SIGNS = {"right": "+", "wrong": "–"}
WORTH_DRAWING = 0.15


def draw_curve(session: Session, canvas: Canvas, room: Rect, marks: tuple[Mark, ...], chosen: int) -> None:
    """``chosen``: the move (1 …) that is being looked at; its place is marked."""
    s = session.strings
    canvas.panel(room, fade(PALETTE["line"], 0.08), radius=12)
    felt = np.array([mark.felt[:6] for mark in marks])
    shown = np.array([mark.shown[:6] for mark in marks])
    steps = max(len(marks) - 1, 1)
    xs = [room.x + 22 + i * (room.w - 44) / steps for i in range(len(marks))]

    def at(value: float) -> float:
        return room.y + room.h - 14 - value * (room.h - 28)

    if 0 < chosen < len(marks):
        canvas.panel(Rect(xs[chosen] - 17, room.y, 34, room.h + 34), fade(PALETTE["gold"], 0.45), radius=12)
    for x, mark in zip(xs[1:], marks[1:], strict=True):
        colour = QUALITY_COLOURS.get(mark.quality, PALETTE["faint"])
        canvas.lines([(x, room.y + 6), (x, room.y + room.h - 4)], 1.5, fade(colour, 0.5))
        canvas.dot(x, room.y + room.h + 17, 10, colour)
        sign = QUALITY_SIGNS.get(mark.quality, "·")
        canvas.text(x, room.y + room.h + 6, sign, 16, PALETTE["white"], font="bold", align="center")
        if mark.guess:
            draw_token(canvas, x, room.y + 16, 10, mark.guess)
    mask = int(shown.max(axis=0).argmax())
    if shown[:, mask].max() >= WORTH_DRAWING:
        points = [(x, at(v)) for x, v in zip(xs, shown[:, mask], strict=True)]
        _dashed(canvas, points, fade(FEELING_COLOURS[SIX[mask]], 0.9))
    legend = room.x
    for k, feeling in enumerate(SIX):
        if felt[:, k].max() < WORTH_DRAWING:
            continue
        colour = FEELING_COLOURS[feeling]
        points = [(x, at(v)) for x, v in zip(xs, felt[:, k], strict=True)]
        if len(points) > 1:
            canvas.lines(points, 3.5, colour)
        for x, y in points:
            canvas.dot(x, y, 4.5, colour)
        draw_token(canvas, points[-1][0] + 13, points[-1][1], 8, feeling)
        draw_token(canvas, legend + 10, room.y + room.h + 50, 9, feeling)
        legend += 24 + canvas.text(legend + 24, room.y + room.h + 40, s(feeling), 15, INK) + 14
    if shown[:, mask].max() >= WORTH_DRAWING:
        y = room.y + room.h + 50
        _dashed(canvas, [(legend, y), (legend + 34, y)], FEELING_COLOURS[SIX[mask]])
        canvas.text(legend + 42, y - 10, s("the_face", feeling=s(SIX[mask])), 15, PALETTE["faint"])


def _dashed(canvas: Canvas, points: list[tuple[float, float]], colour: Colour) -> None:
    for (x0, y0), (x1, y1) in pairwise(points):
        length = float(np.hypot(x1 - x0, y1 - y0))
        count = max(int(length / 11), 1)
        for i in range(count):
            a, b = i / count, (i + 0.55) / count
            canvas.lines(
                [(x0 + (x1 - x0) * a, y0 + (y1 - y0) * a), (x0 + (x1 - x0) * b, y0 + (y1 - y0) * b)], 2.4, colour
            )
