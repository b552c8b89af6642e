"""The title: the stall with its shopkeeper behind, the name of the game, a short menu."""

from __future__ import annotations

from game.app.input import Action
from game.app.screens.history import HistoryScreen
from game.app.screens.keys import KeysScreen
from game.app.screens.slots import SlotsScreen
from game.app.session import MenuScreen, Screen, Session, change_setting
from game.app.settings import CHOICES
from game.app.ui import INK, PALETTE, Button, Buttons, Canvas, Rect, fade

__all__ = ["SettingsScreen", "TitleScreen"]


class TitleScreen(MenuScreen):
    """Where the game begins and where an afternoon ends."""

    def __init__(self) -> None:
        self._buttons = Buttons()

    def handle(self, session: Session, action: Action) -> Screen | None:
        if action.kind == "key" and action.key == "h" and session.notices.told:
            return HistoryScreen(self)
        pressed = self._buttons.handle(action)
        if action.kind == "back":
            session.running = False
        elif pressed == "play":
            session.open_day()
            return first_screen(session)
        elif pressed == "continue":
            from game.app.screens.table import TableScreen

            return TableScreen.where_it_was(session)
        elif pressed == "language":
            change_setting(session, "language")
        elif pressed == "settings":
            return SettingsScreen(self)
        elif pressed in {"save", "load"}:
            return SlotsScreen(self, saving=pressed == "save")
        elif pressed == "quit":
            session.running = False
        return None

    def draw(self, session: Session, canvas: Canvas) -> None:
        s = session.strings
        left, width = 64.0, 320.0
        canvas.panel(Rect(40, 140, 470, 168), fade(PALETTE["shade"], 1.2), radius=26)
        title = s("title")
        rows = title.rsplit(" ", 1) if " " in title else [title]
        size = 48.0
        while max(canvas.measure(row, size, "title") for row in rows) > 420:
            size -= 1
        top = 158 if len(rows) > 1 else 190
        for i, row in enumerate(rows):
            canvas.text(left, top + i * size * 1.1, row, size, PALETTE["white"], font="title")
        canvas.text(left, 268, s("subtitle"), 17, fade(PALETTE["paper_warm"], 0.98))
        entries = ["play"]
        if session.world.talk is not None or session.afternoon.wishes:
            entries.insert(0, "continue")
            entries.append("save")
        entries += ["load", "language", "settings", "quit"]
        self._buttons.lay(
            [Button(name, s(name), Rect(left, 326 + i * 54, width, 46), size=19) for i, name in enumerate(entries)]
        )
        self._buttons.draw(canvas)
        if session.market.avatar is not None:
            line = s("avatar_line", line=session.market.avatar.licence)
            while len(line) > 2 and canvas.measure(line, 12) > canvas.width - 80:
                line = line[:-2].rstrip() + "…"
            wide = canvas.measure(line, 12)
            canvas.panel(
                Rect(canvas.width - wide - 34, canvas.height - 32, wide + 20, 23),
                fade(PALETTE["shade"], 0.88),
                radius=8,
            )
            canvas.text(canvas.width - 24 - wide, canvas.height - 29, line, 12, PALETTE["paper_warm"])


def first_screen(session: Session) -> Screen:
    """Where a day begins: the list over the street, or the only table there is."""
    from game.app.screens.market import MarketScreen
    from game.app.screens.table import TableScreen
    from game.app.screens.wish_list import WishListScreen

    return WishListScreen(MarketScreen() if len(session.market.order) > 1 else TableScreen())


class SettingsScreen(MenuScreen):
    """The player's settings, each pressed through its values."""

    def __init__(self, before: Screen) -> None:
        self._before = before
        self._buttons = Buttons(across=True)

    def handle(self, session: Session, action: Action) -> Screen | None:
        pressed = self._buttons.handle(action)
        if action.kind == "back" or pressed == "back":
            return self._before
        if pressed == "keys":
            return KeysScreen(self)
        if pressed in CHOICES:
            change_setting(session, pressed)
        return None

    def draw(self, session: Session, canvas: Canvas) -> None:
        s = session.strings
        left = (canvas.width - 960) / 2
        names = list(CHOICES)
        rows = (len(names) + 1) // 2
        canvas.panel(Rect(left - 40, 96, 1040, 166 + 62 * rows), border=3, shadow=14)
        canvas.text(canvas.width / 2, 116, s("settings"), 32, INK, font="title", align="center")
        buttons = [
            Button(name, _label(session, name), Rect(left + (i // rows) * 490, 172 + (i % rows) * 62, 470, 52))
            for i, name in enumerate(names)
        ]
        buttons.append(Button("keys", s("keys"), Rect(canvas.width / 2 - 230, 182 + rows * 62, 220, 48)))
        buttons.append(Button("back", s("back"), Rect(canvas.width / 2 + 10, 182 + rows * 62, 220, 48)))
        self._buttons.lay(buttons)
        self._buttons.draw(canvas)


def _label(session: Session, name: str) -> str:
    s, value = session.strings, getattr(session.settings, name)
    if name == "language":
        return s("language")
    if isinstance(value, bool):
        return s(name, value=s("on" if value else "off"))
    if isinstance(value, float):
        return s(name, value=f"{value:.0%}")
    return s(name, value=s(value) if value in s.texts else value)
