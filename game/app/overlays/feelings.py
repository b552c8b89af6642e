"""Emotion bars at the top left, as in the paper's figure 6: what is felt, and what is shown."""

from __future__ import annotations

from game.app.session import Session
from game.app.ui import FEELING_COLOURS, PALETTE, Canvas, Rect, fade
from game.core.emotion_space import EMOTIONS, with_neutral

__all__ = ["draw_feelings"]


def draw_feelings(session: Session, canvas: Canvas) -> None:
    """Seven rows, two bars each: full colour for the felt emotion, pale for the shown one."""
    world, s = session.world, session.strings
    felt = with_neutral(world.felt)
    canvas.panel(Rect(14, 14, 286, 234), PALETTE["shade"], radius=14)
    canvas.text(118, 20, s("felt"), 14, PALETTE["white"], font="bold")
    canvas.text(286, 20, s("shown"), 14, fade(PALETTE["white"], 0.7), align="right")
    for i, name in enumerate(EMOTIONS):
        y = 44 + i * 28
        colour = FEELING_COLOURS[name]
        canvas.text(26, y - 3, s(name), 15, PALETTE["white"])
        canvas.bar(Rect(112, y, 136, 9), float(felt[i]), colour, (1, 1, 1, 0.16))
        canvas.bar(Rect(112, y + 11, 136, 5), float(world.shown[i]), fade(colour, 0.65), (1, 1, 1, 0.12))
        canvas.text(288, y - 3, f"{felt[i]:.2f}", 14, PALETTE["white"], align="right")
