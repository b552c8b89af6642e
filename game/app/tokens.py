"""Seven wordless tokens, "I think you feel …": a small face each, told apart by its lines as well as its colour."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, pi, sin

from game.app.ui import FEELING_COLOURS, INK, PALETTE, Canvas, Rect

__all__ = ["draw_token"]

# Strokes in a face of radius 1, y downward: brows, then the mouth. Eyes are dots at (±.36, -.12).
_BROWS: dict[str, Sequence[tuple[float, float, float, float]]] = {
    "anger": [(-0.62, -0.52, -0.18, -0.28), (0.62, -0.52, 0.18, -0.28)],
    "fear": [(-0.60, -0.34, -0.22, -0.56), (0.60, -0.34, 0.22, -0.56)],
    "sadness": [(-0.62, -0.30, -0.20, -0.46), (0.62, -0.30, 0.20, -0.46)],
    "disgust": [(-0.60, -0.34, -0.16, -0.34), (0.62, -0.58, 0.20, -0.40)],
    "surprise": [(-0.58, -0.56, -0.20, -0.62), (0.58, -0.56, 0.20, -0.62)],
}
_WAVE = [(-0.42, 0.50), (-0.22, 0.38), (0.0, 0.52), (0.22, 0.38), (0.42, 0.50)]


def _mouth(feeling: str) -> list[tuple[float, float]]:
    if feeling == "joy":
        return [(0.52 * cos(a), 0.16 + 0.42 * sin(a)) for a in (pi * i / 8 for i in range(9))]
    if feeling == "sadness":
        return [(0.40 * cos(a), 0.66 - 0.26 * sin(a)) for a in (pi * i / 8 for i in range(9))]
    if feeling == "fear":
        return _WAVE
    if feeling == "anger":
        return [(-0.40, 0.56), (-0.16, 0.40), (0.16, 0.40), (0.40, 0.56)]
    if feeling == "disgust":
        return [(-0.40, 0.40), (0.0, 0.46), (0.42, 0.26)]
    if feeling == "surprise":
        return [(0.20 * cos(a), 0.46 + 0.24 * sin(a)) for a in (2 * pi * i / 12 for i in range(13))]
    return [(-0.34, 0.44), (0.34, 0.44)]


def draw_token(canvas: Canvas, x: float, y: float, radius: float, feeling: str, *, chosen: bool = False) -> None:
    """A token around (x, y). ``chosen``: lifted, with a ring."""
    if chosen:
        canvas.dot(x, y, radius + 6, PALETTE["red"])
        canvas.dot(x, y, radius + 3, PALETTE["white"])
    edge = max(radius * 0.11, 1.5)
    canvas.panel(
        Rect(x - radius, y - radius, 2 * radius, 2 * radius),
        FEELING_COLOURS[feeling], radius=radius, border=edge, border_colour=INK,
    )  # fmt: skip
    width = max(radius * 0.13, 1.6)
    for side in (-1, 1):
        ex, ey = x + side * 0.36 * radius, y - 0.12 * radius
        if feeling == "joy":
            canvas.lines([(ex - 0.16 * radius, ey), (ex, ey - 0.16 * radius), (ex + 0.16 * radius, ey)], width, INK)
        else:
            canvas.dot(ex, ey, radius * (0.15 if feeling in {"surprise", "fear"} else 0.11), INK)
    for a, b, c, d in _BROWS.get(feeling, ()):
        canvas.lines([(x + a * radius, y + b * radius), (x + c * radius, y + d * radius)], width, INK)
    canvas.lines([(x + a * radius, y + b * radius) for a, b in _mouth(feeling)], width, INK)
    if feeling == "sadness":
        canvas.dot(x + 0.40 * radius, y + 0.20 * radius, radius * 0.10, PALETTE["white"])
