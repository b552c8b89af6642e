"""Before a talk: the goods on the table with their price tags, and the purse."""

from __future__ import annotations

from game.app.afternoon import visit_stall
from game.app.input import Action
from game.app.session import MenuScreen, Screen, Session
from game.app.ui import INK, PALETTE, Button, Buttons, Canvas, Rect, fade
from game.app.world import enter_talk

__all__ = ["DayOverScreen", "TableScreen"]


class TableScreen(MenuScreen):
    """Pick a thing to ask about, or leave the market."""

    scene = "table"

    def __init__(self) -> None:
        self._buttons = Buttons()

    @staticmethod
    def where_it_was(session: Session) -> Screen:
        """The talk that is under way, else the table."""
        from game.app.screens.talk import TalkScreen

        return TalkScreen() if session.world.talk is not None else TableScreen()

    def handle(self, session: Session, action: Action) -> Screen | None:
        pressed = self._buttons.handle(action)
        if action.kind == "back":
            from game.app.screens.title import TitleScreen

            return TitleScreen()
        if pressed == "leave":
            return DayOverScreen()
        if pressed and pressed in session.assets.talk.script.items:
            from game.app.screens.talk import TalkScreen

            talk = visit_stall(session.assets.talk, session.afternoon, pressed)
            session.world = enter_talk(session.assets, session.world, talk)
            return TalkScreen()
        return None

    def draw(self, session: Session, canvas: Canvas) -> None:
        s, items = session.strings, session.assets.talk.script.items
        left = canvas.width - 396
        canvas.panel(Rect(left - 16, 24, 396, 78 + 66 * (len(items) + 1)), fade(PALETTE["shade"], 0.75), radius=22)
        canvas.text(left, 38, s("pick"), 20, PALETTE["white"])
        canvas.text(left, 66, s("purse", money=session.money(session.afternoon.purse)), 18, PALETTE["paper_warm"])
        owned = session.afternoon.owned
        buttons = []
        for i, item in enumerate(items.values()):
            label = item.name.get(s.language)
            price = s("sold") if item.id in owned else f"{s('list_price')} {session.money(item.list_price)}"
            buttons.append(
                Button(
                    item.id,
                    label,
                    Rect(left, 98 + i * 66, 364, 58),
                    enabled=item.id not in owned,
                    key=str(i + 1),
                    badge=str(i + 1),
                    note=price,
                    size=18,
                )
            )
        buttons.append(Button("leave", s("leave_market"), Rect(left + 60, 98 + len(items) * 66, 244, 46), size=18))
        self._buttons.lay(buttons)
        self._buttons.draw(canvas)
        if session.message:
            canvas.text(24, canvas.height - 40, session.message, 15, PALETTE["white"])


class DayOverScreen(MenuScreen):
    """What the afternoon came to."""

    def __init__(self) -> None:
        self._buttons = Buttons()

    def handle(self, session: Session, action: Action) -> Screen | None:
        if self._buttons.handle(action) or action.kind == "back":
            from game.app.screens.title import TitleScreen

            return TitleScreen()
        return None

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
            name = session.assets.talk.script.items[bought.item].name.get(s.language)
            canvas.text(box.x + 60, y, name, 18)
            canvas.text(
                box.x + 430,
                y,
                f"{session.money(bought.price)}  /  {session.money(bought.list_price)}",
                17,
                align="right",
            )
            canvas.bar(Rect(box.x + 450, y + 5, 130, 12), bought.surplus, PALETTE["teal"], fade(PALETTE["line"], 0.2))
        self._buttons.lay([Button("title", s("to_title"), Rect(canvas.width / 2 - 120, box.y + height - 70, 240, 48))])
        self._buttons.draw(canvas)
