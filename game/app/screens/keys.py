"""Which key does what: every command can be given another key. Arrows, return, space and escape stay as they are."""

from __future__ import annotations

from game.app.input import COMMANDS, Action
from game.app.session import MenuScreen, Screen, Session, keep_keys
from game.app.ui import INK, Button, Buttons, Canvas, Rect

__all__ = ["KeysScreen"]


class KeysScreen(MenuScreen):
    """Press a row, then the key it shall have; a key that was another's changes places with it."""

    def __init__(self, before: Screen) -> None:
        self._before = before
        self._buttons = Buttons(across=True)
        self.asking = ""
        """The command that waits for its new key."""

    def handle(self, session: Session, action: Action) -> Screen | None:
        if self.asking:
            if action.kind == "key" and action.raw:
                keep_keys(session, self.asking, action.raw)
            if action.kind in {"key", "back", "confirm", "click"}:
                self.asking = ""
            return None
        pressed = self._buttons.handle(action)
        if action.kind == "back" or pressed == "back":
            return self._before
        if pressed == "usual":
            keep_keys(session, "", "")
        elif pressed in COMMANDS:
            self.asking = pressed
        return None

    def draw(self, session: Session, canvas: Canvas) -> None:
        s, keys = session.strings, session.settings.keys
        rows = (len(COMMANDS) + 1) // 2
        left = (canvas.width - 960) / 2
        canvas.panel(Rect(left - 40, 40, 1040, 158 + 56 * rows), border=3, shadow=14)
        canvas.text(canvas.width / 2, 58, s("keys"), 32, INK, font="title", align="center")
        buttons = []
        for i, command in enumerate(COMMANDS):
            key = s("press_key") if command == self.asking else keys.get(command, command).upper()
            place = Rect(left + (i // rows) * 490, 112 + (i % rows) * 56, 470, 48)
            buttons.append(Button(command, f"{s(f'key_{command}')}:  {key}", place, size=17))
        y = 122 + rows * 56
        buttons.append(Button("usual", s("usual_keys"), Rect(canvas.width / 2 - 240, y, 230, 46), size=17))
        buttons.append(Button("back", s("back"), Rect(canvas.width / 2 + 10, y, 230, 46), size=17))
        self._buttons.lay(buttons)
        self._buttons.draw(canvas)
