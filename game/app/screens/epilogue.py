"""What the afternoon came to."""

from __future__ import annotations

from game.app.input import Action
from game.app.session import MenuScreen, Screen, Session
from game.app.ui import INK, PALETTE, Button, Buttons, Canvas, Rect, fade

__all__ = ["EpilogueScreen"]


class EpilogueScreen(MenuScreen):
    """The evening: what you carry home."""

    scene = "market"

    def __init__(self) -> None:
        self._buttons = Buttons(across=True)

    def handle(self, session: Session, action: Action) -> Screen | None:
        from game.app.screens.title import TitleScreen, first_screen

        pressed = self._buttons.handle(action)
        if pressed == "another_day":
            session.open_day(again=True)
            return first_screen(session)
        return TitleScreen() if pressed or action.kind == "back" else None

    def draw(self, session: Session, canvas: Canvas) -> None:
        s, afternoon = session.strings, session.afternoon
        height = 230.0 + 34 * len(afternoon.bought)
        box = Rect((canvas.width - 640) / 2, (canvas.height - height) / 2, 640, height)
        canvas.panel(box, border=3, shadow=16, radius=22)
        canvas.text(canvas.width / 2, box.y + 24, s("day_over"), 34, INK, font="title", align="center")
        if afternoon.bought:
            total = s("bought", count=len(afternoon.bought), money=session.money(afternoon.purse))
        else:
            total = s("nothing_bought")
        canvas.text(canvas.width / 2, box.y + 80, total, 19, INK, align="center")
        for i, bought in enumerate(afternoon.bought):
            y = box.y + 122 + i * 34
            stall = session.market.stalls.get(bought.stall)
            item = stall.script.items.get(bought.item) if stall is not None else None
            canvas.text(box.x + 60, y, bought.item if item is None else item.name.get(s.language), 18)
            price = f"{session.money(bought.price)}  /  {session.money(bought.list_price)}"
            canvas.text(box.x + 430, y, price, 17, align="right")
            canvas.bar(Rect(box.x + 450, y + 5, 130, 12), bought.surplus, PALETTE["teal"], fade(PALETTE["line"], 0.2))
        y = box.y + height - 70
        self._buttons.lay(
            [
                Button("another_day", s("another_day"), Rect(canvas.width / 2 - 256, y, 248, 48)),
                Button("title", s("to_title"), Rect(canvas.width / 2 + 8, y, 248, 48)),
            ]
        )
        self._buttons.draw(canvas)
