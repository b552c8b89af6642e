"""A thing in the hand: shown large, turned by mouse or keys, with its name and what one sees of it."""

from __future__ import annotations

from game.app.handling import Handling
from game.app.input import Action
from game.app.session import MenuScreen, Screen, Session
from game.app.ui import INK, PALETTE, Button, Buttons, Canvas, Rect, fade
from game.app.world import TICK_S

__all__ = ["InspectScreen"]

_TURNS = {"left": (-1.0, 0.0), "right": (1.0, 0.0), "up": (0.0, -1.0), "down": (0.0, 1.0)}
_ZOOM_KEYS = {"+": 1, "=": 1, "-": -1}


class InspectScreen(MenuScreen):
    """Look at one item; Esc, the button or a click in place goes back to the screen it came from.

    item: its id. before: where it came from.
    """

    def __init__(self, item: str, before: Screen) -> None:
        self.item = item
        self.handling = Handling()
        self.scene = before.scene
        self._before = before
        self._buttons = Buttons()

    def handle(self, session: Session, action: Action) -> Screen | None:
        if action.kind == "back" or (action.kind == "key" and action.key == "i"):
            return self._before
        if action.kind == "wheel":
            self.handling.zoom_by(action.amount)
        elif action.kind == "key" and action.key in _ZOOM_KEYS:
            self.handling.zoom_by(_ZOOM_KEYS[action.key])
        elif action.kind in _TURNS:
            self.handling.nudge(*_TURNS[action.kind])
        elif action.kind == "pointer" and action.at is not None:
            self._buttons.handle(action)
            self.handling.drag(action.at)
        elif action.kind == "release":
            if self.handling.let_go():
                return self._before
        elif action.kind == "click" and action.at is not None and self._buttons.handle(action) is None:
            self.handling.grab(action.at)
        elif action.kind in {"click", "confirm"}:
            return self._before
        return None

    def after_tick(self, session: Session) -> Screen | None:
        self.handling.tick(TICK_S, reduced_motion=session.settings.reduced_motion)
        return None

    def draw(self, session: Session, canvas: Canvas) -> None:
        s = session.strings
        item = session.assets.talk.script.items[self.item]
        about = item.about.get(s.language) if item.about is not None else ""
        width = min(canvas.width - 80, 820.0)
        rows = len(canvas.rows(about, width - 72, 21)) if about else 0
        height = 74 + rows * 27 * canvas.text_scale
        box = Rect((canvas.width - width) / 2, canvas.height - height - 62, width, height)
        canvas.panel(box, border=3, shadow=14, radius=22)
        canvas.text(canvas.width / 2, box.y + 16, item.name.get(s.language), 28, INK, font="title", align="center")
        if about:
            canvas.paragraph(Rect(box.x + 36, box.y + 60, width - 72, height - 66), about, 21)
        self._buttons.lay([Button("back", s("put_back"), Rect(canvas.width - 216, 24, 192, 46), size=18)])
        self._buttons.draw(canvas)
        hint = s("hint_inspect")
        wide = canvas.measure(hint, 14) + 32
        canvas.panel(
            Rect((canvas.width - wide) / 2, canvas.height - 46, wide, 30), fade(PALETTE["shade"], 0.9), radius=15
        )
        canvas.text(canvas.width / 2, canvas.height - 41, hint, 14, PALETTE["white"], align="center")
