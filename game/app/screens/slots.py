"""Saving and loading: eight places with their pictures."""

from __future__ import annotations

from game.app.input import Action
from game.app.opening import resume_game
from game.app.screens.street import draw_sky
from game.app.session import MenuScreen, Screen, Session
from game.app.settings import user_folder
from game.app.slots import AUTOSAVE, QUICK, SLOTS, SlotInfo, look_into
from game.app.ui import INK, PALETTE, Button, Buttons, Canvas, Rect, fade
from game.core.errors import BadInput

__all__ = ["SlotsScreen"]


class SlotsScreen(MenuScreen):
    """``saving``: a slot is written (autosave is not offered); else it is taken up. ``before``: where back leads."""

    scene = "title"

    def __init__(self, before: Screen, *, saving: bool) -> None:
        self._before, self._saving = before, saving
        self._buttons = Buttons(across=True)
        self.slots = tuple(look_into(user_folder(), name) for name in SLOTS)
        self.wanted: str = ""
        """A slot that the window is asked to write (it alone has the picture)."""

    def handle(self, session: Session, action: Action) -> Screen | None:
        pressed = self._buttons.handle(action)
        if action.kind == "back" or pressed == "back":
            return self._before
        if not pressed:
            return None
        if self._saving:
            self.wanted = pressed
            return None
        from game.app.screens.table import TableScreen

        try:
            resume_game(session, user_folder() / f"{pressed}.json")
        except BadInput as error:
            session.say(session.strings("save_kept", reason=str(error)[:120]))
            return None
        session.say("")
        return TableScreen.where_it_was(session)

    def written(self) -> Screen:
        """The same places, looked into again."""
        return SlotsScreen(self._before, saving=self._saving)

    def draw(self, session: Session, canvas: Canvas) -> None:
        s = session.strings
        draw_sky(session, canvas)
        whole = Rect(0, 0, canvas.width, canvas.height)
        canvas.panel(whole, fade(PALETTE["shade"], 0.85), radius=0)
        canvas.text(
            canvas.width / 2,
            34,
            s("save" if self._saving else "load"),
            36,
            PALETTE["white"],
            font="title",
            align="center",
        )
        left, width, height = (canvas.width - 1180) / 2, 280.0, 238.0
        buttons = []
        for i, slot in enumerate(self.slots):
            place = Rect(left + (i % 4) * 300, 104 + (i // 4) * 262, width, height)
            able = slot.name != AUTOSAVE if self._saving else slot.day > 0
            buttons.append(Button(slot.name, "", place, enabled=able))
        buttons.append(Button("back", s("back"), Rect(canvas.width / 2 - 110, 640, 220, 48)))
        self._buttons.lay(buttons)
        for slot, button in zip(self.slots, buttons, strict=False):
            self._draw_slot(session, canvas, slot, button)
        self._buttons.draw(
            canvas, lambda c, b, f: None if b.id in SLOTS else Buttons(b.id if f else "", False, [b]).draw(c)
        )

    def _draw_slot(self, session: Session, canvas: Canvas, slot: SlotInfo, button: Button) -> None:
        s, place, focused = session.strings, button.rect, button.id == self._buttons.focus
        alpha = 1.0 if button.enabled else 0.55
        edge = PALETTE["gold"] if focused else PALETTE["line"]
        canvas.panel(
            place, fade(PALETTE["paper"], alpha), radius=14, border=5 if focused else 2, border_colour=edge, shadow=12
        )
        view = Rect(place.x + 12, place.y + 12, place.w - 24, (place.w - 24) * 9 / 16)
        canvas.panel(view, fade(PALETTE["line"], 0.25 * alpha), radius=6)
        if slot.picture is not None and canvas.pictures is not None:
            name = f"slot:{slot.name}"
            if canvas.pictures.get(name) is None:
                canvas.pictures.put(name, slot.picture)
            canvas.picture(name, view, cover=True)
        names = {AUTOSAVE: s("autosave"), QUICK: s("quick_save")}
        title = names.get(slot.name) or s("slot", number=slot.name.removeprefix("slot"))
        y = view.y + view.h + 8
        canvas.text(view.x, y, title, 17, fade(INK, alpha), font="bold")
        if slot.unreadable:
            canvas.paragraph(Rect(view.x, y + 24, view.w, 34), slot.unreadable, 13, PALETTE["red"])
        elif slot.day:
            bazaar, stall = session.market.bazaar, session.market.stalls.get(slot.stall)
            where = slot.stall if stall is None else stall.script.title.get(s.language)
            when = f"{s('day', day=slot.day)} · {bazaar.clock(slot.minutes)}"
            canvas.text(view.x + view.w, y + 1, session.money(slot.purse), 15, PALETTE["faint"], align="right")
            canvas.text(view.x, y + 25, when, 15, fade(INK, alpha))
            canvas.text(view.x, y + 43, where, 14, PALETTE["faint"])
        else:
            canvas.text(view.x, y + 25, s("empty"), 15, PALETTE["faint"])
