"""The game's message of the moment, at the top of whatever is on screen; it goes by itself."""

from __future__ import annotations

from game.app.session import Session
from game.app.ui import PALETTE, Canvas, Rect, fade

__all__ = ["draw_notice"]

SIZE = 16.0
CARDS_W = 392.0
"""What the cards on the right of table and talk take."""
BELOW_BAR = 70.0


def draw_notice(session: Session, canvas: Canvas, scene: str) -> None:
    """scene: of the screen below, which says where there is room."""
    strength = session.notices.strength(session.ticks, still=session.settings.reduced_motion)
    if strength <= 0.0:
        return
    room = canvas.width - (CARDS_W if scene in {"table", "talk"} else 0.0)
    text = session.notices.told[-1].text
    width = min(canvas.measure(text, SIZE) + 44, room - 48)
    rows = canvas.rows(text, width - 40, SIZE)
    width = min(max(canvas.measure(row, SIZE) for row in rows) * max(canvas.text_scale, 1.0) + 44, room - 48)
    step = SIZE * canvas.text_scale * 1.3
    box = Rect((room - width) / 2, BELOW_BAR if scene == "market" else 16.0, width, len(rows) * step + 18)
    canvas.panel(box, fade(PALETTE["shade"], 1.5 * strength), radius=16)
    for i, row in enumerate(rows):
        y = box.y + 8 + i * step
        canvas.text(box.x + box.w / 2, y, row, SIZE, fade(PALETTE["white"], strength), align="center", whole=True)
