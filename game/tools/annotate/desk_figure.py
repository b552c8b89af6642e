"""The repertoire's page: a small figure whose parts say what a behaviour uses and locks; a click changes it."""

from __future__ import annotations

from imgui_bundle import imgui

from game.core.errors import BadInput
from game.core.paths import ASSETS
from game.tools.annotate.desk_actions import Actions
from game.tools.annotate.desk_pen import LAYER_TITLES, Pen
from game.tools.annotate.desk_repertoire import add_behaviour, next_state, put_parts
from game.tools.windows.style import colour

__all__ = ["Figure"]

_PARTS: dict[str, tuple[float, float, float, float]] = {
    "head": (88, 4, 64, 52), "gaze": (100, 18, 40, 10), "face": (100, 32, 40, 16), "spine": (86, 62, 68, 86),
    "right_arm": (48, 66, 32, 74), "left_arm": (160, 66, 32, 74), "right_hand": (40, 146, 34, 28),
    "left_hand": (166, 146, 34, 28), "legs": (88, 154, 64, 96),
}  # fmt: skip
"""Part -> x, y, width, height; seen from the front, so that the person's right is on the left."""
_DRAWN = ("legs", "spine", "right_arm", "left_arm", "right_hand", "left_hand", "head", "gaze", "face")


class Figure:
    """Page of the repertoire."""

    def __init__(self, actions: Actions, pen: Pen) -> None:
        self.actions, self.desk, self.pen = actions, actions.desk, pen
        self._new = ""

    @property
    def shipped(self) -> bool:
        """Whether the repertoire is the game's own, which is not for a take's annotator to change."""
        return self.actions.behaviours.resolve().is_relative_to(ASSETS.resolve())

    def draw(self) -> None:
        """One frame inside the page."""
        desk, pen, k = self.desk, self.pen, self.pen.k
        mark = desk.one
        name = mark.behaviour if mark is not None else desk.brush[desk.layer]
        behaviour = desk.repertoire.get(name)
        if behaviour is None:
            imgui.text_wrapped(f"{name} is not in the repertoire.")
            return
        imgui.push_font(pen.fonts.bold, 18 * k)
        imgui.text(behaviour.label.get("en", name))
        imgui.pop_font()
        imgui.text_disabled(f"{behaviour.layer}, {name} in {self.actions.behaviours.name}")
        corner = imgui.get_cursor_screen_pos()
        for part in _DRAWN:
            x, y, w, h = (v * 1.15 * k for v in _PARTS[part])
            x, y = x + corner.x, y + corner.y
            state = "uses" if part in behaviour.uses else "locks" if part in behaviour.locks else ""
            tint = {"uses": colour("green", 0.75), "locks": colour("blue", 0.65), "": colour("blank")}[state]
            imgui.set_cursor_screen_pos(imgui.ImVec2(x, y))
            imgui.set_next_item_allow_overlap()
            clicked = imgui.invisible_button(f"part {part}", imgui.ImVec2(w, h))
            over = imgui.is_item_hovered()
            pen.box(x, y, w, h, tint, 10.0)
            pen.frame(x, y, w, h, colour("red" if over else "line"), 2.0 if over else 1.0, 10.0)
            if over:
                imgui.set_tooltip(f"{part.replace('_', ' ')}: {state or 'free'}")
            if clicked:
                self._click(name, part)
        x, y = corner.x + 250 * k, corner.y + 10 * k
        for tint, title in (
            (colour("green", 0.75), "uses: carries the meaning"), (colour("blue", 0.65), "locks: must stay"),
            (colour("blank"), "free"),
        ):  # fmt: skip
            pen.box(x, y + 3 * k, 14 * k, 14 * k, tint, 3.0)
            pen.text(x + 20 * k, y, title, "ink", 15)
            y += 24 * k
        pen.text(x, y + 6 * k, "click a part to change it", "faint", 15)
        pen.text(corner.x, corner.y + 296 * k, "seen from the front: its left is on the right", "faint", 14)
        imgui.set_cursor_screen_pos(imgui.ImVec2(corner.x, corner.y + 318 * k))
        imgui.dummy(imgui.ImVec2(1, 1))
        contacts = ", ".join(f"{hand.replace('_', ' ')} on {frame}" for hand, frame in behaviour.contacts.items())
        imgui.text_wrapped(f"contacts: {contacts or 'none'}")
        if self.shipped:
            imgui.text_wrapped(
                "This is the game's own repertoire: it can be read here, not changed. "
                "Copy assets/motion/behaviours.yaml beside the folder of your takes to have one of your own."
            )
        else:
            self._new_behaviour()

    def _new_behaviour(self) -> None:
        imgui.separator()
        imgui.text_disabled(f"a new behaviour of the layer {LAYER_TITLES[self.desk.layer].lower()} (up, down: another)")
        imgui.set_next_item_width(-80 * self.pen.k)
        entered, self._new = imgui.input_text_with_hint(
            "##new", "name, such as hand_in_hair", self._new, imgui.InputTextFlags_.enter_returns_true
        )
        imgui.same_line()
        if imgui.button("Add") or entered:
            try:
                self.desk.repertoire = add_behaviour(self.actions.behaviours, self._new, self.desk.layer)
            except (BadInput, OSError) as error:
                self.desk.tell(str(error), failed=True)
                return
            self.pen.learn(self.desk.repertoire)
            self.desk.set_behaviour(self._new)
            self._new = ""

    def _click(self, name: str, part: str) -> None:
        if self.shipped:
            self.desk.tell(
                "the game's own repertoire is read only; copy behaviours.yaml beside your takes", failed=True
            )
            return
        behaviour = self.desk.repertoire[name]
        uses, locks = next_state(behaviour, part)
        try:
            self.desk.repertoire = put_parts(self.actions.behaviours, name, uses, locks)
        except (BadInput, OSError) as error:
            self.desk.tell(str(error), failed=True)
            return
        self.desk.tell(f"{name}: {part.replace('_', ' ')} changed in {self.actions.behaviours.name}")
