"""After a talk: the price tag turned over, what was felt while you spoke, what the body told, and what else could
have been."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import cos, pi

import numpy as np
from numpy.typing import NDArray

from game.app.input import Action
from game.app.screens.curve import draw_curve
from game.app.session import MenuScreen, Screen, Session
from game.app.talk import TalkState, ask_money
from game.app.tells import Clip, Tell, TellWatch
from game.app.tokens import draw_token
from game.app.ui import INK, PALETTE, Button, Buttons, Canvas, Rect, fade
from game.app.whatif import WhatIf, turning_point
from game.app.world import Mark
from game.face import FaceParams

__all__ = ["OutcomeScreen"]

TABS = ("curve", "body", "else")
PAUSE_TICKS = 24
"""Between two runs of the replay the last picture stands for so long."""
TURN_TICKS = 40


@dataclass
class OutcomeScreen(MenuScreen):
    """Shows the talk that just ended. The afternoon has been booked when it appears."""

    scene = "outcome"

    talk: TalkState
    marks: tuple[Mark, ...]
    watch: TellWatch
    otherwise: WhatIf | None
    buttons: Buttons = field(default_factory=lambda: Buttons(focus="to_stall"))
    tab: str = "curve"
    chosen: int = 1
    ticks: int = 0

    @staticmethod
    def of(session: Session) -> OutcomeScreen:
        """Book the talk that has ended and show it."""
        talk, marks = session.world.talk, session.world.marks
        assert talk is not None
        session.watch.finish(session.assets)
        screen = OutcomeScreen(talk, marks, session.watch, turning_point(session.assets.talk, marks, talk))
        screen.chosen = marks.index(screen.otherwise.mark) if screen.otherwise is not None else len(marks) - 1
        session.end_talk()
        return screen

    # --- the replay ----------------------------------------------------------------------------------------------
    @property
    def clip(self) -> Clip | None:
        """The seconds that are played beside the sheet, while the body is being talked about."""
        return self.watch.clip if self.tab == "body" else None

    def _frame(self, clip: Clip) -> int:
        return min(self.ticks % (len(clip.matrices) + PAUSE_TICKS), len(clip.matrices) - 1)

    def played(self) -> tuple[NDArray[np.float32], FaceParams] | None:
        """The body and the face of the replay now; None where nothing is played."""
        clip = self.clip
        if clip is None:
            return None
        at = self._frame(clip)
        return clip.matrices[at], clip.bare[at]

    def after_tick(self, session: Session) -> Screen | None:
        self.ticks += 1
        return None

    # --- input ---------------------------------------------------------------------------------------------------
    def handle(self, session: Session, action: Action) -> Screen | None:
        from game.app.screens.epilogue import EpilogueScreen
        from game.app.screens.table import TableScreen

        if action.kind in {"left", "right"}:
            way = 1 if action.kind == "right" else -1
            if self.buttons.focus in {f"tab:{name}" for name in TABS}:
                self._turn_to(TABS[(TABS.index(self.tab) + way) % len(TABS)])
                self.buttons.focus = f"tab:{self.tab}"
            elif len(self.marks) > 1:
                self.chosen = (self.chosen - 1 + way) % (len(self.marks) - 1) + 1
            return None
        pressed = self.buttons.handle(action)
        if pressed == "to_stall" or action.kind == "back":
            return TableScreen()
        if pressed == "leave_market":
            return EpilogueScreen()
        if pressed and pressed.startswith("tab:"):
            self._turn_to(pressed.partition(":")[2])
        elif pressed and pressed.startswith("move:"):
            self.chosen = int(pressed.partition(":")[2])
        return None

    def _turn_to(self, tab: str) -> None:
        self.tab, self.ticks = tab, 0

    # --- drawing -------------------------------------------------------------------------------------------------
    def draw(self, session: Session, canvas: Canvas) -> None:
        s = session.strings
        box = Rect(canvas.width - 640, 30, 608, canvas.height - 60)
        canvas.panel(box, border=3, shadow=16, radius=24)
        self._draw_head(session, canvas, box)
        buttons = []
        for i, name in enumerate(TABS):
            place = Rect(box.x + 32 + i * 184, box.y + 168, 176, 38)
            buttons.append(Button(f"tab:{name}", s(f"tab_{name}"), place, key=str(i + 1), size=16))
        room = Rect(box.x + 36, box.y + 222, box.w - 72, box.h - 222 - 80)
        if self.tab == "curve":
            buttons += self._draw_curve(session, canvas, room)
        elif self.tab == "body":
            self._draw_body(session, canvas, room)
        else:
            self._draw_else(session, canvas, room)
        several = len(session.market.order) > 1
        foot = Rect(box.x + 36, box.y + box.h - 64, 262, 46)
        buttons.append(Button("to_stall", s("to_stall"), foot, size=18))
        if not several:
            buttons.append(
                Button("leave_market", s("leave_market"), Rect(box.x + box.w - 298, foot.y, 262, 46), size=18)
            )
        self.buttons.lay(buttons)
        self.buttons.draw(canvas, self._paint)
        self._draw_tag(session, canvas)

    def _paint(self, canvas: Canvas, button: Button, focused: bool) -> None:
        if button.id.startswith("move:"):
            return
        here = button.id == f"tab:{self.tab}"
        if here:
            canvas.panel(
                Rect(button.rect.x, button.rect.y + 8, button.rect.w, button.rect.h), PALETTE["teal"], radius=14
            )
        Buttons(focus=button.id if focused else "", buttons=[button]).draw(canvas)

    def _draw_head(self, session: Session, canvas: Canvas, box: Rect) -> None:
        s, talk, script = session.strings, self.talk, session.assets.talk.script
        won = talk.deal_price > 0
        x, y, right = box.x + 36, box.y + 18, box.x + box.w - 36
        width = canvas.text(x, y, s("deal" if won else "no_deal"), 34, PALETTE["teal" if won else "red"], font="title")
        ending = script.endings.get(str(talk.beat.ended))
        if ending is not None:
            caption = Rect(x + width + 22, y + 4, right - x - width - 22, 44)
            canvas.paragraph(caption, ending.caption.get(s.language), 16, PALETTE["faint"], middle=True)
        y += 54
        canvas.text(x, y, script.items[talk.item].name.get(s.language), 20, INK, font="bold")
        canvas.text(right, y, f"{s('list_price')} {session.money(talk.list_price)}", 17, align="right")
        name, y = script.person.name.get(s.language), y + 28
        lowest = session.money(ask_money(talk.list_price, talk.bargain.lowest))
        if won:
            canvas.text(x, y, s("paid", money=session.money(talk.deal_price)), 18)
            canvas.text(right, y, s("share", share=f"{talk.surplus:.0%}"), 17, align="right")
            canvas.bar(Rect(x, y + 28, box.w - 72, 10), talk.surplus, PALETTE["teal"], fade(PALETTE["line"], 0.18))
        else:
            canvas.text(x, y, s("lowest", name=name, money=lowest), 18, PALETTE["faint"])

    def _draw_curve(self, session: Session, canvas: Canvas, room: Rect) -> list[Button]:
        s = session.strings
        name = session.assets.talk.script.person.name.get(s.language)
        canvas.text(room.x, room.y, s("what_was_felt", name=name), 17, INK, font="bold")
        plot = Rect(room.x, room.y + 30, room.w, room.h - 30 - 66 - 92)
        draw_curve(session, canvas, plot, self.marks, self.chosen)
        if not 0 < self.chosen < len(self.marks):
            return []
        mark = self.marks[self.chosen]
        y = room.y + room.h - 88
        head = s("move_head", round=self.chosen, quality=s(f"taken_{mark.quality}"))
        canvas.text(room.x, y, head, 16, PALETTE["teal"], font="bold")
        canvas.text(
            room.x + room.w,
            y,
            s("ask_then", money=session.money(ask_money(self.talk.list_price, mark.ask))),
            15,
            PALETTE["faint"],
            align="right",
        )
        offer = "" if mark.choice is None or mark.choice.offer is None else session.money(mark.choice.offer)
        words = mark.text(s.language).replace("{offer}", offer)
        if offer and offer not in words:
            words = f"{words} ({offer})"
        spot = room.w - (150 if mark.guess else 0)
        canvas.paragraph(Rect(room.x, y + 24, spot, 60), words, 19, INK, middle=True)
        if mark.guess:
            draw_token(canvas, room.x + room.w - 118, y + 52, 17, mark.guess)
            sign = "=" if mark.guess == mark.label else "≠"
            canvas.text(room.x + room.w - 84, y + 38, sign, 24, INK, font="bold", align="center")
            draw_token(canvas, room.x + room.w - 50, y + 52, 17, mark.label)
        steps = max(len(self.marks) - 1, 1)
        width = (plot.w - 44) / steps
        return [
            Button(f"move:{i}", "", Rect(plot.x + 22 + i * width - width / 2, plot.y, width, plot.h + 34), key="")
            for i in range(1, len(self.marks))
        ]

    def _draw_body(self, session: Session, canvas: Canvas, room: Rect) -> None:
        s = session.strings
        if not self.watch.tells:
            canvas.paragraph(Rect(room.x, room.y + 20, room.w, 80), s("no_tells"), 19, PALETTE["faint"])
            return
        side = 168.0
        for i, tell in enumerate(self.watch.tells):
            y = room.y + i * (room.h / 3)
            height = min(room.h / 3 - 10, side * 0.72)
            picture = Rect(room.x, y, height * 1.28, height)
            canvas.panel(picture, fade(PALETTE["line"], 0.2), radius=8)
            canvas.picture(f"tell:{i}", picture, cover=True)
            best = self.watch.clip is not None and self.watch.clip.tell is tell
            canvas.panel(
                picture,
                (0, 0, 0, 0),
                radius=8,
                border=4 if best else 2,
                border_colour=PALETTE["red" if best else "line"],
            )
            self._draw_tell(session, canvas, Rect(picture.x + picture.w + 18, y, room.w - picture.w - 18, height), tell)
        if self.clip is not None:
            self._draw_replay_note(session, canvas)

    def _draw_tell(self, session: Session, canvas: Canvas, room: Rect, tell: Tell) -> None:
        s = session.strings
        title = session.assets.planner.library.units[tell.unit].title(s.language)
        when = s("at_greeting") if tell.round == 0 else s("after_move", round=tell.round)
        canvas.text(room.x, room.y, when, 14, PALETTE["faint"])
        canvas.paragraph(Rect(room.x, room.y + 19, room.w, 26), title, 20, INK)
        draw_token(canvas, room.x + 14, room.y + 63, 13, tell.feeling)
        canvas.text(room.x + 36, room.y + 51, f"{s('felt')}: {s(tell.feeling)} {tell.felt:.1f}".rstrip(), 16, INK)
        if tell.face != tell.feeling:
            draw_token(canvas, room.x + 14, room.y + 95, 13, tell.face)
            canvas.text(room.x + 36, room.y + 83, s("face_said", feeling=s(tell.face)), 16, PALETTE["faint"])

    def _draw_replay_note(self, session: Session, canvas: Canvas) -> None:
        clip = self.clip
        assert clip is not None
        s, bare = session.strings, self._frame(clip) > clip.drop
        words = s("mask_off" if bare else "as_you_saw")
        width = canvas.measure(words, 18, "bold") + 36
        note = Rect(32, 30, width, 40)
        canvas.panel(note, PALETTE["red" if bare else "shade"], radius=20)
        canvas.text(note.x + 18, note.y + 8, words, 18, PALETTE["white"], font="bold")

    def _draw_else(self, session: Session, canvas: Canvas, room: Rect) -> None:
        s, other = session.strings, self.otherwise
        if other is None:
            canvas.paragraph(Rect(room.x, room.y + 20, room.w, 80), s("nothing_else"), 20, INK)
            return
        offer = "" if other.choice.offer is None else session.money(other.choice.offer)
        y = room.y + 6
        for key, words, colour in (
            ("you_said", other.mark.text(s.language), "faint"),
            ("you_could", other.line(s.language), "teal"),
        ):
            canvas.text(room.x, y, s(key, round=other.mark.round), 15, PALETTE[colour], font="bold")
            bubble = Rect(room.x, y + 24, room.w, 66)
            canvas.panel(bubble, PALETTE["white"], radius=14, border=2, border_colour=PALETTE[colour])
            text = Rect(bubble.x + 18, bubble.y + 6, bubble.w - 36, 54)
            canvas.paragraph(text, words.replace("{offer}", offer), 19, INK, middle=True)
            y += 104
        canvas.paragraph(Rect(room.x, y + 4, room.w, 110), self.sentence(session), 20, INK)

    def sentence(self, session: Session) -> str:
        """What the other word would have brought, in one sentence."""
        s, other, talk = session.strings, self.otherwise, self.talk
        assert other is not None
        ask = session.money(ask_money(talk.list_price, talk.bargain.ask))
        then = session.money(ask_money(talk.list_price, other.state.bargain.ask))
        if other.state.deal_price and talk.deal_price:
            key, a, b = "else_cheaper", session.money(other.state.deal_price), session.money(talk.deal_price)
        elif other.state.deal_price:
            key, a, b = "else_deal", session.money(other.state.deal_price), ""
        else:
            key, a, b = "else_ask", then, ask
        words = s(key, money=a, instead=b)
        if other.felt - other.felt_then >= 0.05:
            feeling = s("else_feeling", feeling=s(other.feeling), a=f"{other.felt_then:.1f}", b=f"{other.felt:.1f}")
            return f"{words}{feeling}"
        return words + s("full_stop")

    def _draw_tag(self, session: Session, canvas: Canvas) -> None:
        """The price tag beside the sheet turns over: what was asked, then what would have done."""
        s, talk = session.strings, self.talk
        share = (
            1.0
            if session.settings.reduced_motion
            else min(self.ticks / TURN_TICKS, 1.0)
            if self.tab == "curve"
            else 1.0
        )
        turn = cos(pi * share)
        back = turn < 0
        width = max(210 * abs(turn), 6.0)
        tag = Rect(140 - width / 2, canvas.height - 130, width, 96)
        canvas.panel(tag, PALETTE["paper_warm"] if back else PALETTE["white"], radius=10, border=3, shadow=12)
        if width < 150:
            return
        label = s("lowest_tag") if back else s("asking")
        money = talk.bargain.lowest if back else talk.bargain.ask
        middle = tag.x + tag.w / 2
        canvas.text(middle, tag.y + 14, label, 15, PALETTE["faint"], align="center")
        price = session.money(ask_money(talk.list_price, money))
        canvas.text(middle, tag.y + 38, price, 32, PALETTE["red"], font="title", align="center")
