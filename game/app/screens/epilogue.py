"""The evening: what the afternoon came to, told and counted, and the way to another day."""

from __future__ import annotations

from game.app.input import Action
from game.app.score import Part, load_epilogue, score_of
from game.app.screens.street import draw_sky
from game.app.session import MenuScreen, Screen, Session
from game.app.tokens import draw_token
from game.app.ui import INK, PALETTE, Button, Buttons, Canvas, Rect, fade

__all__ = ["EpilogueScreen"]


class EpilogueScreen(MenuScreen):
    """Left the evening in words, right the points and what they stand on."""

    scene = "market"

    def __init__(self) -> None:
        self._buttons = Buttons(across=True)
        self._texts = load_epilogue()

    def handle(self, session: Session, action: Action) -> Screen | None:
        from game.app.screens.title import TitleScreen, first_screen

        pressed = self._buttons.handle(action)
        if pressed == "another_day":
            session.open_day(again=True)
            return first_screen(session)
        return TitleScreen() if pressed or action.kind == "back" else None

    def draw(self, session: Session, canvas: Canvas) -> None:
        s, afternoon, market = session.strings, session.afternoon, session.market
        draw_sky(session, canvas)
        canvas.panel(Rect(0, 0, canvas.width, canvas.height), fade(PALETTE["shade"], 0.55), radius=0)
        left = (canvas.width - 1200) / 2
        height = canvas.height - 64
        page = Rect(left, 32, 720, height)
        canvas.panel(page, PALETTE["white"], radius=10, border=2, shadow=20)
        canvas.text(page.x + 44, page.y + 30, s("day_over"), 34, INK, font="title")
        told = self._texts.tell(
            market.bazaar, afternoon, market.order, market.wishes, s.language, session.money(afternoon.purse)
        )
        room = Rect(page.x + 44, page.y + 88, page.w - 88, page.h - 116)
        _draw_told(canvas, room, told)
        score = score_of(afternoon)
        side = Rect(left + 740, 32, 460, height)
        canvas.panel(side, border=3, radius=20, shadow=20)
        canvas.text(side.x + 32, side.y + 26, self._texts.rank(score).get(s.language), 25, PALETTE["red"], font="title")
        canvas.text(side.x + 32, side.y + 66, s("score_total", points=score.total), 20, INK, font="bold")
        y = side.y + 106
        for part in score.parts:
            y = _draw_part(session, canvas, Rect(side.x + 32, y, side.w - 64, 58), part)
        self._draw_bag(session, canvas, Rect(side.x + 32, y + 4, side.w - 64, side.y + side.h - 132 - y))
        foot = side.y + side.h - 116
        self._buttons.lay(
            [
                Button("another_day", s("another_day"), Rect(side.x + 32, foot, side.w - 64, 44), size=18),
                Button("title", s("to_title"), Rect(side.x + 32, foot + 52, side.w - 64, 44), size=18),
            ]
        )
        self._buttons.draw(canvas)

    def _draw_bag(self, session: Session, canvas: Canvas, room: Rect) -> None:
        """What was bought, and the tokens that were laid: guess over truth."""
        s, afternoon, market = session.strings, session.afternoon, session.market
        y = room.y
        readings = afternoon.readings[-10:]
        rows = max(int((room.h - (82 if readings else 0)) // 25), 0)
        for bought in afternoon.bought[:rows]:
            stall = market.stalls.get(bought.stall)
            item = stall.script.items.get(bought.item) if stall is not None else None
            name = bought.item if item is None else item.name.get(s.language)
            star = "★ " if afternoon.wished(bought.stall, bought.item) else ""
            canvas.text(room.x, y, f"{star}{name}", 16)
            price = f"{session.money(bought.price)} / {session.money(bought.list_price)}"
            canvas.text(room.x + room.w, y, price, 15, PALETTE["faint"], align="right")
            y += 25
        if readings:
            y += 6
            for i, reading in enumerate(readings):
                x = room.x + 17 + i * 40
                draw_token(canvas, x, y + 14, 13, reading.guess)
                draw_token(canvas, x, y + 44, 13, reading.felt)
                sign = "=" if reading.right else "≠"
                colour = PALETTE["teal" if reading.right else "red"]
                canvas.text(x, y + 58, sign, 15, colour, font="bold", align="center")


def _draw_told(canvas: Canvas, room: Rect, paragraphs: list[str]) -> None:
    """Paragraphs below each other, all of a size that fits."""
    for size in (20.0, 19.0, 18.0, 17.0, 16.0, 15.0, 14.0, 13.0, 12.0, 11.0, 10.0):
        rows = [canvas.rows(text, room.w, size) for text in paragraphs]
        step = size * canvas.text_scale * 1.32
        if sum(len(r) for r in rows) * step + (len(rows) - 1) * step * 0.6 <= room.h:
            break
    y = room.y
    for block in rows:
        for row in block:
            canvas.text(room.x, y, row, size, whole=True)
            y += step
        y += step * 0.6


def _draw_part(session: Session, canvas: Canvas, room: Rect, part: Part) -> float:
    s = session.strings
    canvas.text(room.x, room.y, s(part.key), 17, INK, font="bold")
    points = f"{part.points} / {part.most}" if part.most else str(part.points)
    canvas.text(room.x + room.w, room.y, points, 17, INK, font="bold", align="right")
    canvas.text(room.x, room.y + 21, s(f"{part.key}_why", **part.why), 14, PALETTE["faint"])
    if part.most:
        bar = Rect(room.x, room.y + 42, room.w, 7)
        canvas.bar(bar, part.points / part.most, PALETTE["teal"], fade(PALETTE["line"], 0.18))
    return room.y + room.h
