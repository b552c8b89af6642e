"""A timed choice's time, as a bar that runs empty above the choices."""

from __future__ import annotations

from game.app.session import Session
from game.app.ui import PALETTE, Canvas, Rect

__all__ = ["draw_timer"]

_HURRY = 0.3


def draw_timer(session: Session, canvas: Canvas, place: Rect) -> None:
    """Nothing where no choice is timed. The colour tells the last third; the length tells it without colour."""
    left = session.world.time_left
    if left is not None:
        colour = PALETTE["red"] if left < _HURRY else PALETTE["gold"]
        canvas.bar(place, left, colour, PALETTE["shade"])
