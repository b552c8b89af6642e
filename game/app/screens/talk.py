"""The talk: subtitles, choices, the offer dial, and whatever the overlays show on top."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from game.app.input import Action
from game.app.overlays import draw_overlays
from game.app.overlays.timer import draw_timer
from game.app.reading import Reader
from game.app.screens.inspect import InspectScreen
from game.app.session import Screen, Session, change_setting, take_back
from game.app.talk import MONEY_STEP, Choice, ask_money
from game.app.tokens import draw_token
from game.app.ui import INK, PALETTE, Button, Buttons, Canvas, Rect, fade, paint_button
from game.app.world import Intent
from game.core.emotion_space import EMOTIONS
from game.face import FaceParams
from game.story import Choice as StoryChoice

__all__ = ["TalkScreen"]

CARD_WIDTH, WIDER = 372.0, 130.0
"""The cards' width, and how much wider they become where letters are twice as large."""
OVERLAY_KEYS = {"f1": "feelings", "f2": "units", "f3": "networks"}
STANDING = {"offer": "b", "wait": "w", "leave": "g"}


def grown(canvas: Canvas) -> float:
    """How far the player has enlarged the text: 0 as drawn, 1 twice as large."""
    return min(max(canvas.text_scale - 1.0, 0.0), 1.0)


def card_width(canvas: Canvas) -> float:
    """Width of the cards on the right."""
    return CARD_WIDTH + WIDER * grown(canvas)


def words_height(canvas: Canvas) -> float:
    """Height of the box with what is being said."""
    return 118.0 + 52.0 * grown(canvas)


def next_token(token: str, *, back: bool = False) -> str:
    """The token after another, around the circle; none lies between the last and the first."""
    around = ("", *EMOTIONS)
    return around[(around.index(token) + (-1 if back else 1)) % len(around)]


def _takes_up(session: Session, action: Action) -> bool:
    """Whether the player reaches for the thing talked about."""
    talk = session.world.talk
    if action.kind == "click":
        return talk is not None and session.pointed == talk.item
    return action.kind == "key" and action.key == "i"


class TalkScreen:
    """Watch, choose what to say, say a price with it or not, wait, or go."""

    scene = "talk"

    def __init__(self) -> None:
        self._buttons = Buttons()
        self._with_offer = False
        self._amount = 0
        self._intent = Intent()
        self._guess = ""
        self._reader = Reader()

    @property
    def offering(self) -> bool:
        """Whether an offer lies on the table, not yet said."""
        return self._with_offer

    # --- input ---------------------------------------------------------------------------------------------------
    def handle(self, session: Session, action: Action) -> Screen | None:
        if action.kind == "back":
            from game.app.screens.title import TitleScreen

            return TitleScreen()
        if action.kind == "key" and action.key == "h" and (session.world.backlog or session.notices.told):
            from game.app.screens.history import HistoryScreen

            return HistoryScreen(self)
        if action.kind == "key" and action.key == "tab":
            self._reader.skipping = not self._reader.skipping
            return None
        if action.kind == "key" and action.key == "a":
            change_setting(session, "auto_forward")
            return None
        if action.kind == "key" and action.key == "backspace":
            self._guess = ""
            take_back(session)
            return None
        if action.kind == "key" and action.key in OVERLAY_KEYS:
            session.overlays ^= {OVERLAY_KEYS[action.key]}
            return None
        world = session.world
        if world.talk is not None and _takes_up(session, action):
            return InspectScreen(world.talk.item, self)
        if world.over:
            if action.kind in {"confirm", "click"}:
                from game.app.screens.outcome import OutcomeScreen

                return OutcomeScreen.of(session)
            return None
        if not world.waiting:
            if action.kind in {"confirm", "click"}:
                self._intent = Intent(proceed=True)
            return None
        self._choose(session, action)
        return None

    def _choose(self, session: Session, action: Action) -> None:
        step = MONEY_STEP * (10 if action.fast else 1)
        if action.kind in {"left", "right"}:
            self._turn(session, step if action.kind == "right" else -step)
            return
        if action.kind == "key" and action.key == "t":
            self._guess = next_token(self._guess, back=action.fast)
            return
        if action.kind == "wheel":
            self._turn(session, action.amount * MONEY_STEP)
            return
        pressed = self._buttons.handle(action)
        if pressed is None:
            return
        if pressed.startswith("token:"):
            feeling = pressed.partition(":")[2]
            self._guess = "" if feeling == self._guess else feeling
        elif pressed == "dial":
            self._with_offer = not self._with_offer
        elif pressed in {"less", "more"}:
            self._turn(session, (-1 if pressed == "less" else 1) * MONEY_STEP * (10 if action.fast else 5))
        elif pressed == "meet":
            self._with_offer, self._amount = True, self._limit(session)
        else:
            self._say(session, pressed)

    def _say(self, session: Session, choice_id: str) -> None:
        assert session.world.talk is not None
        act = session.world.talk.beat.choice(choice_id).act
        carries = act == "offer" or (self._with_offer and act not in {"wait", "leave"})
        self._intent = Intent(choice=Choice(choice_id, self._amount if carries else None), guess=self._guess)
        self._guess = ""
        if carries:
            self._with_offer = False

    def _limit(self, session: Session) -> int:
        talk = session.world.talk
        assert talk is not None
        return max(min(ask_money(talk.list_price, talk.bargain.ask), talk.purse // MONEY_STEP * MONEY_STEP), MONEY_STEP)

    def _turn(self, session: Session, change: int) -> None:
        self._with_offer = True
        self._amount = min(max(self._amount + change, MONEY_STEP), self._limit(session))

    def intent(self) -> Intent:
        intent, self._intent = self._intent, Intent()
        return intent

    def after_tick(self, session: Session) -> Screen | None:
        settings = session.settings
        auto, everything = settings.auto_forward, settings.skip_unread
        if self._reader.goes_on(session.world, session.stall, session.read, auto=auto, everything=everything):
            self._intent = replace(self._intent, proceed=True)
        talk = session.world.talk
        if talk is not None and (self._amount == 0 or self._amount > self._limit(session)):
            start = talk.bargain.offer or 0.6
            self._amount = min(round(start * talk.list_price / MONEY_STEP) * MONEY_STEP, self._limit(session))
        return None

    def played(self) -> tuple[NDArray[np.float32], FaceParams] | None:
        return None

    # --- drawing -------------------------------------------------------------------------------------------------
    def draw(self, session: Session, canvas: Canvas) -> None:
        self._draw_price(session, canvas)
        if session.world.waiting:
            self._draw_choices(session, canvas)
        else:
            self._buttons.lay([])
        self._draw_subtitles(session, canvas)
        if session.settings.captions:
            self._draw_caption(session, canvas)
        draw_overlays(session, canvas)

    def _draw_price(self, session: Session, canvas: Canvas) -> None:
        s, talk = session.strings, session.world.talk
        if talk is None:
            return
        box = Rect(canvas.width - card_width(canvas) - 20, 18, card_width(canvas), 74)
        canvas.panel(box, border=2, shadow=10)
        item = session.assets.talk.script.items[talk.item]
        canvas.text(box.x + 16, box.y + 9, item.name.get(s.language), 19, INK, font="bold")
        rounds = session.assets.talk.market.rounds
        done = min(talk.bargain.round + (0 if talk.ended else 1), rounds)
        canvas.text(box.x + 16, box.y + 41, s("purse", money=session.money(talk.purse)), 16, PALETTE["faint"])
        canvas.text(
            box.x + 190, box.y + 41, s("round", round=done, rounds=rounds), 16, PALETTE["faint"], align="center"
        )
        right = box.x + box.w - 16
        paid = talk.deal_price > 0
        canvas.text(right, box.y + 7, s("paid_price" if paid else "asking"), 14, PALETTE["faint"], align="right")
        ask = session.money(talk.deal_price if paid else ask_money(talk.list_price, talk.bargain.ask))
        canvas.text(right, box.y + 24, ask, 31, PALETTE["red"], font="title", align="right")

    def _draw_choices(self, session: Session, canvas: Canvas) -> None:
        s, talk = session.strings, session.world.talk
        assert talk is not None
        left, y = canvas.width - card_width(canvas) - 20, 106.0
        options = list(talk.beat.choices)
        lines = [c for c in options if c.act not in STANDING]
        buttons: list[Button] = []
        height = (74.0 if len(lines) <= 4 else 60.0) + 16.0 * grown(canvas)
        for i, choice in enumerate(lines):
            note = choice.reason.get(s.language) if choice.reason is not None and not choice.available else ""
            buttons.append(
                Button(
                    choice.id,
                    self._shown(session, choice),
                    Rect(left, y, card_width(canvas), height),
                    enabled=choice.available,
                    key=str(i + 1),
                    badge=str(i + 1),
                    note=note,
                    size=18,
                )
            )
            y += height + 8
        buttons += self._dial(session, canvas, left, y)
        y += 56
        standing = [c for c in options if c.act in STANDING]
        width = (card_width(canvas) - 8 * (len(standing) - 1)) / max(len(standing), 1)
        for i, choice in enumerate(standing):
            place = Rect(left + i * (width + 8), y, width, 44)
            key = STANDING[choice.act]
            buttons.append(Button(choice.id, s(choice.act), place, enabled=choice.available, key=key, size=17))
        buttons += self._tokens(session, canvas)
        self._buttons.lay(buttons)
        self._buttons.draw(canvas, self._paint)
        draw_timer(session, canvas, Rect(left, 96, card_width(canvas), 6))
        # What a short button will say, in full, before it is said.
        focused = next((c for c in standing if c.id == self._buttons.focus), None)
        if focused is not None:
            words = Rect(left, y + 50, card_width(canvas), 42)
            canvas.panel(words, fade(PALETTE["shade"], 1.2), radius=12)
            room = Rect(left + 14, y + 54, card_width(canvas) - 28, 36)
            canvas.paragraph(room, self._shown(session, focused), 16, PALETTE["white"], middle=True)
        # The keys have the room that is left below, and take of it what they need.
        top = y + (98.0 if focused is not None else 52.0)
        wide, free = card_width(canvas) - 24, canvas.height - 16 - 8 - top
        rows, _, step = canvas.fitted(s("hint_talk"), wide, free, 13)
        if len(rows) * step <= free + 2:
            hint = Rect(left, canvas.height - 22 - len(rows) * step, card_width(canvas), len(rows) * step + 8)
            canvas.panel(hint, fade(PALETTE["shade"], 0.8), radius=12)
            canvas.paragraph(Rect(left + 12, hint.y + 4, wide, free), s("hint_talk"), 13, PALETTE["white"])

    def _tokens(self, session: Session, canvas: Canvas) -> list[Button]:
        """The seven tokens, in a column at the left: the hands rest above the words, and they are what is to be read.
        Laying one costs nothing."""
        s, size, step = session.strings, 34.0, 42.0
        words = s(self._guess) if self._guess else s("token_hint")
        height = len(EMOTIONS) * step + 6.0
        left, top = 20.0, canvas.height - 54.0 - words_height(canvas) - height
        label = Rect(left, top - 38.0, canvas.measure(words, 15) + 28.0, 32.0)
        canvas.panel(label, fade(PALETTE["shade"], 1.2), radius=16)
        canvas.text(label.x + 14, label.y + 6, words, 15, PALETTE["white"])
        canvas.panel(Rect(left, top, size + 14, height), fade(PALETTE["shade"], 0.95), radius=24)
        return [
            Button(f"token:{name}", "", Rect(left + 7, top + 7 + i * step, size, size))
            for i, name in enumerate(EMOTIONS)
        ]

    def _paint(self, canvas: Canvas, button: Button, focused: bool) -> None:
        name = button.id.partition(":")[2]
        if not name:
            paint_button(canvas, button, focused)
            return
        x, y = button.rect.middle
        if focused:
            canvas.dot(x, y, button.rect.w / 2 + 3, PALETTE["gold"])
        draw_token(canvas, x, y, button.rect.w / 2 - 1, name, chosen=name == self._guess)

    def _dial(self, session: Session, canvas: Canvas, left: float, y: float) -> list[Button]:
        s = session.strings
        text = s("offer_with", money=session.money(self._amount)) if self._with_offer else s("no_offer")
        if self._with_offer:
            canvas.panel(Rect(left - 4, y - 4, card_width(canvas) + 8, 56), fade(PALETTE["red"], 0.9), radius=18)
        return [
            Button("less", "−", Rect(left, y, 44, 48), size=24),
            Button("dial", text, Rect(left + 50, y, card_width(canvas) - 168, 48), key="o", size=17),
            Button("more", "+", Rect(left + card_width(canvas) - 112, y, 44, 48), size=24),
            Button("meet", s("meet"), Rect(left + card_width(canvas) - 62, y, 62, 48), key="p", size=14),
        ]

    def _shown(self, session: Session, choice: StoryChoice) -> str:
        return choice.text(session.strings.language).replace("{offer}", session.money(self._amount))

    def _draw_caption(self, session: Session, canvas: Canvas) -> None:
        """What the body does, in words: for players who cannot see it, or want to learn to."""
        library = session.assets.planner.library
        units = [library.units[i] for i in session.world.body.decisions.unit[0] if i >= 0]
        words = " · ".join(unit.title(session.strings.language) for unit in units if not unit.is_rest)
        if not words:
            return
        width = canvas.measure(words, 16) + 32
        left = 20 + (canvas.width - card_width(canvas) - 60 - width) / 2
        canvas.panel(
            Rect(left, canvas.height - 128 - words_height(canvas), width, 30), fade(PALETTE["shade"], 1.2), radius=15
        )
        canvas.text(left + 16, canvas.height - 123 - words_height(canvas), words, 16, PALETTE["white"])

    def _draw_subtitles(self, session: Session, canvas: Canvas) -> None:
        world, s = session.world, session.strings
        line = world.speech.line if world.speech is not None else (world.backlog[-1] if world.backlog else None)
        if line is None:
            return
        room = canvas.width - card_width(canvas) - 60
        width = min(room, 700.0 + 60.0 * grown(canvas))
        box = Rect(20 + (room - width) / 2, canvas.height - 20 - words_height(canvas), width, words_height(canvas))
        resting = world.speech is None
        canvas.panel(box, fade(PALETTE["paper"], 0.86 if resting else 1.0), border=3, shadow=12, radius=20)
        names = {
            "shopkeeper": session.assets.talk.script.person.name.get(s.language),
            "player": s("you"),
            "narrator": "",
        }
        name = names[line.speaker]
        if name:
            tag = canvas.measure(name, 18, "bold") + 32
            colour = PALETTE["red"] if line.speaker == "shopkeeper" else PALETTE["indigo"]
            canvas.panel(Rect(box.x + 22, box.y - 17, tag, 34), colour, radius=17)
            canvas.text(box.x + 38, box.y - 12, name, 18, PALETTE["white"], font="bold")
        text = line.text(world.language)
        shown = None
        if world.speech is not None and not world.speech.hurried:
            shown = world.speech.timed.visible(world.time_s - world.speech.started_s)
        colour = INK if line.speaker != "narrator" else PALETTE["faint"]
        canvas.paragraph(Rect(box.x + 28, box.y + 22, box.w - 70, box.h - 32), text, 24, colour, shown=shown)
        if not resting or world.over:
            beat = 0.5 + 0.5 * abs((world.time_s * 1.4) % 2.0 - 1.0)
            x, y = box.x + box.w - 40, box.y + box.h - 30 + 4 * beat
            canvas.lines([(x, y), (x + 9, y + 9), (x + 18, y)], 4, PALETTE["red"])
