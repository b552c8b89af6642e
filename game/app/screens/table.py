"""Before a talk: the goods on the table with their price tags, and the purse."""

from __future__ import annotations

from game.app.afternoon import is_closed
from game.app.input import Action
from game.app.screens.history import HistoryScreen
from game.app.screens.inspect import InspectScreen
from game.app.session import MenuScreen, Screen, Session
from game.app.ui import PALETTE, Button, Buttons, Canvas, Rect, fade

__all__ = ["TableScreen"]


class TableScreen(MenuScreen):
    """Pick a thing to ask about, or walk on."""

    scene = "table"

    def __init__(self) -> None:
        self._buttons = Buttons()

    @staticmethod
    def where_it_was(session: Session) -> Screen:
        """The talk that is under way, else the street, or the only table there is."""
        from game.app.screens.market import MarketScreen
        from game.app.screens.talk import TalkScreen

        if session.world.talk is not None:
            return TalkScreen()
        return MarketScreen() if len(session.market.order) > 1 else TableScreen()

    def handle(self, session: Session, action: Action) -> Screen | None:
        if action.kind == "key" and action.key == "h" and session.notices.told:
            return HistoryScreen(self)
        items, pointed = session.assets.talk.script.items, session.pointed or ""
        if action.kind == "key" and action.key == "i":
            wanted = pointed or self._buttons.focus
            return InspectScreen(wanted, self) if wanted in items else None
        pressed = self._buttons.handle(action)
        if action.kind == "click" and pressed is None and pointed in items:
            if self._buttons.focus == pointed:
                return InspectScreen(pointed, self)
            self._buttons.focus = pointed
            return None
        if action.kind == "back" or pressed == "to_street":
            return self._away(session)
        if pressed == "leave":
            from game.app.screens.epilogue import EpilogueScreen

            return EpilogueScreen()
        if pressed and pressed in items:
            from game.app.screens.talk import TalkScreen

            session.begin_talk(pressed)
            return TalkScreen()
        return None

    def _draw_tag(self, session: Session, canvas: Canvas) -> None:
        """The name of the thing under the pointer, and how to look at it."""
        item, at = session.assets.talk.script.items.get(session.pointed or ""), self._buttons.mouse
        if item is None or at is None or any(button.rect.holds(at) for button in self._buttons.buttons):
            return
        name, hint = item.name.get(session.strings.language), session.strings("hint_look")
        width = max(canvas.measure(name, 18, "bold"), canvas.measure(hint, 13)) + 28
        left = min(max(at[0] - width / 2, 8.0), canvas.width - width - 8)
        top = max(at[1] - 74, 8.0)
        canvas.panel(Rect(left, top, width, 52), border=2, radius=14, shadow=8)
        canvas.text(left + width / 2, top + 6, name, 18, font="bold", align="center")
        canvas.text(left + width / 2, top + 30, hint, 13, PALETTE["faint"], align="center")

    @staticmethod
    def _away(session: Session) -> Screen:
        from game.app.screens.market import MarketScreen
        from game.app.screens.title import TitleScreen

        return MarketScreen() if len(session.market.order) > 1 else TitleScreen()

    def draw(self, session: Session, canvas: Canvas) -> None:
        s, script, afternoon = session.strings, session.assets.talk.script, session.afternoon
        items = script.items
        closed = is_closed(session.market.bazaar, afternoon)
        left = canvas.width - 396
        canvas.panel(Rect(left - 16, 24, 396, 104 + 66 * len(items) + 54), fade(PALETTE["shade"], 1.15), radius=22)
        canvas.text(left, 36, script.title.get(s.language), 23, PALETTE["white"], font="title")
        clock = session.market.bazaar.clock(afternoon.minutes)
        canvas.text(left + 364, 40, clock, 18, PALETTE["paper_warm"], font="bold", align="right")
        purse, asked = s("purse", money=session.money(afternoon.purse)), s("market_closed_short" if closed else "pick")
        canvas.text(left + 364, 70, purse, 17, PALETTE["paper_warm"], align="right")
        size, room = 17.0, 350.0 - canvas.measure(purse, 17)
        while canvas.measure(asked, size) > room and size > 11:
            size -= 0.5
        canvas.text(left, 70 + (17 - size) / 2, asked, size, PALETTE["white"])
        owned = afternoon.owned(script.stall)
        buttons = []
        for i, item in enumerate(items.values()):
            label = item.name.get(s.language)
            price = s("sold") if item.id in owned else f"{s('list_price')} {session.money(item.list_price)}"
            if afternoon.wished(script.stall, item.id) and item.id not in owned:
                price = f"{price} · ★ {s('on_list')}"
            buttons.append(
                Button(
                    item.id,
                    label,
                    Rect(left, 102 + i * 66, 364, 58),
                    enabled=item.id not in owned and not closed,
                    key=str(i + 1),
                    badge=str(i + 1),
                    note=price,
                    size=18,
                )
            )
        several = len(session.market.order) > 1
        away = Rect(left + 40, 106 + len(items) * 66, 284, 46)
        buttons.append(
            Button(
                "to_street" if several else "leave",
                s("to_street" if several else "leave_market"),
                away,
                key="g",
                size=18,
            )
        )
        self._buttons.lay(buttons)
        self._buttons.draw(canvas)
        self._draw_tag(session, canvas)
