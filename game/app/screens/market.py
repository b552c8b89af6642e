"""The street: three stalls side by side, the clock, the purse, the list, and where to walk next."""

from __future__ import annotations

from game.app.afternoon import is_closed
from game.app.input import Action
from game.app.screens.history import HistoryScreen
from game.app.screens.street import draw_sky, draw_stall, draw_top
from game.app.session import MenuScreen, Screen, Session
from game.app.ui import INK, PALETTE, Button, Buttons, Canvas, Rect, fade

__all__ = ["MarketScreen", "WalkScreen"]

CARD_W, CARD_H, GAP = 380.0, 436.0, 26.0
WALK_S = 1.1
"""Seconds of walking up to a stall: long enough for what is seen there to be made ready."""


class MarketScreen(MenuScreen):
    """Walk to a stall, look at the list, sit down for a while, or go home."""

    scene = "market"

    def __init__(self) -> None:
        self._buttons = Buttons(across=True)

    def handle(self, session: Session, action: Action) -> Screen | None:
        if action.kind == "back":
            from game.app.screens.title import TitleScreen

            return TitleScreen()
        if action.kind == "key" and action.key == "h" and session.notices.told:
            return HistoryScreen(self)
        pressed = self._buttons.handle(action)
        if pressed == "list":
            from game.app.screens.wish_list import WishListScreen

            return WishListScreen(self)
        if pressed == "pause":
            session.pause()
        elif pressed == "go_home":
            from game.app.screens.epilogue import EpilogueScreen

            return EpilogueScreen()
        elif pressed in session.market.stalls:
            place = next(b.rect for b in self._buttons.buttons if b.id == pressed)
            session.walk_to(pressed)
            return WalkScreen(pressed, place)
        return None

    def draw(self, session: Session, canvas: Canvas) -> None:
        s, market, closed = session.strings, session.market, is_closed(session.market.bazaar, session.afternoon)
        draw_sky(session, canvas)
        draw_top(session, canvas)
        names = market.order
        left = (canvas.width - len(names) * CARD_W - (len(names) - 1) * GAP) / 2
        top = 84.0 + (canvas.height - 720) / 2
        buttons = []
        for i, name in enumerate(names):
            place = Rect(left + i * (CARD_W + GAP), top, CARD_W, CARD_H)
            stall = market.stalls.get(name)
            ready = stall is not None and stall.stage is not None and not closed
            buttons.append(Button(name, "", place, enabled=ready, key=str(i + 1)))
        foot = top + CARD_H + 22
        buttons += self._foot(session, canvas, foot, closed)
        self._buttons.lay(buttons)
        for button in buttons[: len(names)]:
            draw_stall(session, canvas, button, focused=button.id == self._buttons.focus, closed=closed)
        self._buttons.draw(canvas, lambda c, b, f: None if b.id in names else paint_plain(c, b, f))
        self._draw_list(session, canvas, Rect(left, foot, CARD_W * 2 + GAP - 10, 148))
        if closed:
            words = s("market_closed")
            width = canvas.measure(words, 20, "bold") + 48
            note = Rect((canvas.width - width) / 2, top + 150, width, 50)
            canvas.panel(note, PALETTE["paper_warm"], radius=14, border=3, shadow=14)
            canvas.text(canvas.width / 2, note.y + 12, words, 20, INK, font="bold", align="center")

    def _foot(self, session: Session, canvas: Canvas, y: float, closed: bool) -> list[Button]:
        s, bazaar = session.strings, session.market.bazaar
        left, width = (canvas.width + 3 * CARD_W + 2 * GAP) / 2 - CARD_W, CARD_W
        pause = s("pause", minutes=round(bazaar.costs.pause))
        return [
            Button("list", s("look_at_list"), Rect(left, y, width, 44), key="l", size=18),
            Button("pause", pause, Rect(left, y + 52, width, 44), enabled=not closed, key="w", size=18),
            Button("go_home", s("leave_market"), Rect(left, y + 104, width, 44), key="g", size=18),
        ]

    def _draw_list(self, session: Session, canvas: Canvas, room: Rect) -> None:
        s, afternoon, market = session.strings, session.afternoon, session.market
        canvas.panel(room, radius=10, border=2, shadow=10)
        canvas.text(room.x + 22, room.y + 12, s("wish_list"), 19, INK, font="title")
        rows = list(afternoon.wishes)
        step = (room.w - 44) / 2
        for i, wish in enumerate(rows):
            x, y = room.x + 22 + (i % 2) * step, room.y + 46 + (i // 2) * 46
            got = wish.item in afternoon.owned(wish.stall)
            draw_box(canvas, x, y + 5, got)
            script = market.stalls[wish.stall].script if wish.stall in market.stalls else None
            name = script.items[wish.item].name.get(s.language) if script and wish.item in script.items else wish.item
            canvas.text(x + 28, y - 1, name, 18, INK, font="bold")
            text = market.wish(wish.stall, wish.item)
            where = f"{text.who.get(s.language)} · {script.title.get(s.language) if script else s('not_open')}"
            canvas.text(x + 28, y + 20, where, 14, PALETTE["faint"])


def paint_plain(canvas: Canvas, button: Button, focused: bool) -> None:
    """A plain button of the foot."""
    Buttons(focus=button.id if focused else "", buttons=[button]).draw(canvas)


def draw_box(canvas: Canvas, x: float, y: float, ticked: bool) -> None:
    """A box of the list, ticked where the thing is yours."""
    canvas.panel(Rect(x, y, 18, 18), PALETTE["white"], radius=4, border=2)
    if ticked:
        canvas.lines([(x + 3, y + 9), (x + 8, y + 15), (x + 20, y - 3)], 3.5, PALETTE["teal"])


class WalkScreen(MenuScreen):
    """Walking up to a stall: its picture comes nearer until one stands before it."""

    scene = "table"

    def __init__(self, stall: str, place: Rect) -> None:
        self._stall, self._place, self._ticks = stall, place, 0

    def handle(self, session: Session, action: Action) -> Screen | None:
        return self._arrived(session) if action.kind in {"confirm", "click", "back"} else None

    def after_tick(self, session: Session) -> Screen | None:
        self._ticks += 1
        still = session.settings.reduced_motion
        return self._arrived(session) if self._ticks >= WALK_S * 30 * (0.4 if still else 1.0) else None

    def _arrived(self, session: Session) -> Screen:
        from game.app.screens.table import TableScreen

        return TableScreen()

    def draw(self, session: Session, canvas: Canvas) -> None:
        share = min(self._ticks / (WALK_S * 30), 1.0)
        near = share * share * (3 - 2 * share)
        a, whole = self._place, Rect(0, 0, canvas.width, canvas.height)
        if session.settings.reduced_motion:
            canvas.panel(whole, fade(PALETTE["shade"], max(1.0 - 2.5 * share, 0.0)), radius=0)
            return
        grown = Rect(
            a.x * (1 - near), a.y * (1 - near), a.w + (whole.w - a.w) * near, a.h * 0.76 + (whole.h - a.h * 0.76) * near
        )
        alpha = 1.0 - max(share - 0.62, 0.0) / 0.38
        canvas.panel(whole, fade(PALETTE["shade"], 1.2 * (1 - near)), radius=0)
        canvas.picture(f"card:{self._stall}", grown, alpha=alpha, cover=True)
