"""The list in the pocket: four things, for whom and why. Shown in the morning, and whenever it is unfolded."""

from __future__ import annotations

from game.app.input import Action
from game.app.screens.market import draw_box
from game.app.screens.street import draw_sky
from game.app.session import MenuScreen, Screen, Session
from game.app.ui import INK, PALETTE, Button, Buttons, Canvas, Rect, fade

__all__ = ["WishListScreen"]


class WishListScreen(MenuScreen):
    """A sheet of paper over the street; any way on leads to ``after``."""

    scene = "market"

    def __init__(self, after: Screen) -> None:
        self._after = after
        self._buttons = Buttons()

    def handle(self, session: Session, action: Action) -> Screen | None:
        if self._buttons.handle(action) or action.kind == "back":
            return self._after
        return None

    def draw(self, session: Session, canvas: Canvas) -> None:
        s, afternoon, market = session.strings, session.afternoon, session.market
        draw_sky(session, canvas)
        canvas.panel(Rect(0, 0, canvas.width, canvas.height), fade(PALETTE["shade"], 0.6), radius=0)
        row_h = 92.0
        height = 190 + row_h * len(afternoon.wishes)
        sheet = Rect((canvas.width - 760) / 2, (canvas.height - height) / 2, 760, height)
        canvas.panel(sheet, PALETTE["white"], radius=8, border=2, shadow=24)
        canvas.panel(Rect(sheet.x + sheet.w / 2 - 60, sheet.y - 14, 120, 28), fade(PALETTE["gold"], 0.75), radius=3)
        x = sheet.x + 56
        canvas.text(x, sheet.y + 34, s("wish_list"), 34, INK, font="title")
        canvas.text(
            sheet.x + sheet.w - 56, sheet.y + 44, s("purse", money=session.money(afternoon.purse)), 20, INK,
            font="bold", align="right",
        )  # fmt: skip
        for i, wish in enumerate(afternoon.wishes):
            y = sheet.y + 100 + i * row_h
            canvas.lines([(x - 16, y + row_h - 14), (sheet.x + sheet.w - 40, y + row_h - 14)], 1.2, _RULE)
            draw_box(canvas, x, y + 8, wish.item in afternoon.owned(wish.stall))
            text, script = market.wish(wish.stall, wish.item), None
            if wish.stall in market.stalls:
                script = market.stalls[wish.stall].script
            item = script.items.get(wish.item) if script is not None else None
            name = wish.item if item is None else item.name.get(s.language)
            title = (
                f"{name}, {text.who.get(s.language)}" if s.language == "en" else f"{text.who.get(s.language)}、{name}"
            )
            canvas.text(x + 34, y, title, 22, INK, font="bold")
            canvas.text(x + 34, y + 32, text.why.get(s.language), 17, PALETTE["faint"])
            if item is not None and script is not None:
                right = sheet.x + sheet.w - 56
                canvas.text(right, y + 2, session.money(item.list_price), 19, INK, align="right")
                canvas.text(right, y + 32, script.title.get(s.language), 15, PALETTE["teal"], align="right")
        done = Rect(sheet.x + sheet.w / 2 - 130, sheet.y + height - 70, 260, 48)
        self._buttons.lay([Button("done", s("to_street"), done)])
        self._buttons.draw(canvas)


_RULE = fade(PALETTE["indigo"], 0.35)
