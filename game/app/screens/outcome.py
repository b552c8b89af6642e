"""After a talk: the price tag turned over, and what was felt while you spoke."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from game.app.input import Action
from game.app.session import MenuScreen, Screen, Session
from game.app.talk import TalkState, ask_money
from game.app.ui import FEELING_COLOURS, INK, PALETTE, Button, Buttons, Canvas, Rect, fade
from game.app.world import Mark
from game.core.emotion_space import SIX

__all__ = ["OutcomeScreen"]

QUALITY_COLOURS = {"right": PALETTE["teal"], "neutral": PALETTE["faint"], "wrong": PALETTE["red"]}


@dataclass
class OutcomeScreen(MenuScreen):
    """Shows the talk that just ended. The afternoon has been booked when it appears."""

    scene = "outcome"

    talk: TalkState
    marks: tuple[Mark, ...]
    buttons: Buttons

    @staticmethod
    def of(session: Session) -> OutcomeScreen:
        """Book the talk that has ended and show it."""
        talk = session.world.talk
        assert talk is not None
        screen = OutcomeScreen(talk, session.world.marks, Buttons())
        session.end_talk()
        return screen

    def handle(self, session: Session, action: Action) -> Screen | None:
        from game.app.screens.epilogue import EpilogueScreen
        from game.app.screens.table import TableScreen

        pressed = self.buttons.handle(action)
        if pressed == "to_stall" or action.kind == "back":
            return TableScreen()
        if pressed == "leave_market":
            return EpilogueScreen()
        return None

    def draw(self, session: Session, canvas: Canvas) -> None:
        s, talk, script = session.strings, self.talk, session.assets.talk.script
        box = Rect(canvas.width - 640, 36, 608, canvas.height - 72)
        canvas.panel(box, border=3, shadow=16, radius=24)
        won = talk.deal_price > 0
        x, y = box.x + 36, box.y + 24
        canvas.text(x, y, s("deal" if won else "no_deal"), 38, PALETTE["teal" if won else "red"], font="title")
        ending = script.endings.get(str(talk.beat.ended))
        if ending is not None:
            canvas.paragraph(Rect(x, y + 52, box.w - 72, 52), ending.caption.get(s.language), 18, PALETTE["faint"])
        y += 110
        name = script.person.name.get(s.language)
        right = box.x + box.w - 36
        canvas.text(x, y, script.items[talk.item].name.get(s.language), 21, INK, font="bold")
        canvas.text(right, y, f"{s('list_price')} {session.money(talk.list_price)}", 18, align="right")
        y += 32
        if won:
            canvas.text(x, y, s("paid", money=session.money(talk.deal_price)), 20)
            canvas.text(right, y, s("share", share=f"{talk.surplus:.0%}"), 18, align="right")
            canvas.bar(Rect(x, y + 32, box.w - 72, 14), talk.surplus, PALETTE["teal"], fade(PALETTE["line"], 0.18))
            y += 56
        lowest = session.money(ask_money(talk.list_price, talk.bargain.lowest))
        canvas.text(x, y, s("lowest", name=name, money=lowest), 18, PALETTE["faint"])
        bottom = box.y + box.h - 66
        top = y + 74
        self._draw_curve(session, canvas, Rect(x, top, box.w - 72, min(bottom - 88 - top, 240)), name)
        self.buttons.lay(
            [
                Button("to_stall", s("to_stall"), Rect(x, box.y + box.h - 66, 250, 48)),
                Button("leave_market", s("leave_market"), Rect(box.x + box.w - 286, box.y + box.h - 66, 250, 48)),
            ]
        )
        self.buttons.draw(canvas)

    def _draw_curve(self, session: Session, canvas: Canvas, room: Rect, name: str) -> None:
        """The hidden feelings from move to move, with the player's moves below."""
        s = session.strings
        canvas.text(room.x, room.y - 30, s("what_was_felt", name=name), 18, INK, font="bold")
        canvas.panel(room, fade(PALETTE["line"], 0.08), radius=12)
        felt = np.array([mark.felt[:6] for mark in self.marks])
        steps = max(len(self.marks) - 1, 1)
        xs = [room.x + 18 + i * (room.w - 36) / steps for i in range(len(self.marks))]
        legend = room.x
        for k, feeling in enumerate(SIX):
            if felt[:, k].max() < 0.15:
                continue
            colour = FEELING_COLOURS[feeling]
            points = [(x, room.y + room.h - 14 - v * (room.h - 28)) for x, v in zip(xs, felt[:, k], strict=True)]
            if len(points) > 1:
                canvas.lines(points, 3.5, colour)
            for x, y in points:
                canvas.dot(x, y, 4.5, colour)
            canvas.dot(legend + 8, room.y + room.h + 54, 6, colour)
            legend += 22 + canvas.text(legend + 20, room.y + room.h + 44, s(feeling), 15, PALETTE["faint"]) + 16
        for x, mark in zip(xs[1:], self.marks[1:], strict=True):
            colour = QUALITY_COLOURS.get(mark.quality, PALETTE["faint"])
            canvas.lines([(x, room.y + 6), (x, room.y + room.h - 4)], 1.5, fade(colour, 0.5))
            canvas.dot(x, room.y + room.h + 14, 9, colour)
            sign = {"right": "+", "wrong": "–"}.get(mark.quality, "·")
            canvas.text(x, room.y + room.h + 4, sign, 15, PALETTE["white"], font="bold", align="center")
