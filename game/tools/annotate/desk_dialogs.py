"""What lies over the desk: the sheet of keys, the menu under the right button, the search, questions."""

from __future__ import annotations

from collections.abc import Callable
from itertools import groupby

from imgui_bundle import imgui

from game.tools.annotate.desk_actions import Actions
from game.tools.annotate.desk_keys import BINDINGS
from game.tools.annotate.desk_panels import Panels
from game.tools.annotate.desk_pen import Pen
from game.tools.annotate.desk_timeline import Timeline
from game.tools.windows.style import colour

__all__ = ["Dialogs"]

_PLACES = {
    "Play": (24, 64), "Look": (24, 296), "Spans": (410, 64), "What it is": (800, 64), "Files and help": (800, 296),
}  # fmt: skip


class Dialogs:
    """Windows over the desk."""

    def __init__(self, actions: Actions, pen: Pen, timeline: Timeline, panels: Panels) -> None:
        self.actions, self.desk, self.pen = actions, actions.desk, pen
        self._timeline, self._panels = timeline, panels
        self._menu_s = 0.0

    @property
    def asking(self) -> bool:
        """Whether a question waits for its answer: keys mean nothing else until then."""
        return self.actions.leaving or any(sheet.offer is not None for sheet in self.desk.sheets)

    def draw(self, size: tuple[int, int]) -> None:
        """One frame."""
        if self.actions.help:
            self._keys(size)
        if self.actions.findings:
            self._findings(size)
        if self._timeline.menu_s is not None:
            self._menu_s, self._timeline.menu_s = self._timeline.menu_s, None
            imgui.open_popup("span menu")
        if self._timeline.opened is not None:
            self.desk.select(self._timeline.opened)
            self._timeline.opened, self.actions.searching = None, True
        if self.actions.searching and not imgui.is_popup_open("behaviour"):
            imgui.open_popup("behaviour")
        self._menu()
        self._behaviour(size)
        self._recovery(size)
        self._farewell(size)

    def _middle(self, size: tuple[int, int], w: float, h: float = 0.0) -> None:
        imgui.set_next_window_pos(imgui.ImVec2(size[0] / 2, size[1] / 2), 0, imgui.ImVec2(0.5, 0.5))
        imgui.set_next_window_size(imgui.ImVec2(w * self.pen.k, h * self.pen.k))

    def _keys(self, size: tuple[int, int]) -> None:
        k = self.pen.k
        self._middle(size, 1180, 560)
        flags = imgui.WindowFlags_
        imgui.push_style_color(imgui.Col_.window_bg, colour("paper"))
        imgui.begin("keys", None, flags.no_decoration | flags.no_move)
        at = imgui.get_window_pos()
        self.pen.text(at.x + 24 * k, at.y + 16 * k, "Keys", bold=True, size=24)
        told = "drag on a track: a new span; drag a span or its edges: move, trim; right button: menu; wheel: zoom"
        self.pen.text(at.x + 100 * k, at.y + 22 * k, told, "faint", 16)
        for group, rows in groupby(BINDINGS, lambda b: b.group):
            x, y = (v * k for v in _PLACES[group])
            self.pen.text(at.x + x, at.y + y, group, "red", 18, bold=True)
            y += 28 * k
            for row in rows:
                if row.keys:
                    self.pen.text(at.x + x, at.y + y, row.keys, "ink", 16, bold=True)
                    self.pen.text(at.x + x + 118 * k, at.y + y, row.does, "ink", 16)
                    y += 25 * k
        if imgui.is_mouse_clicked(0) and imgui.is_window_hovered():
            self.actions.help = False
        imgui.end()
        imgui.pop_style_color()

    def _findings(self, size: tuple[int, int]) -> None:
        k, findings = self.pen.k, self.actions.findings
        self._middle(size, 900, min(150.0 + 30.0 * len(findings), 560.0))
        imgui.push_style_color(imgui.Col_.window_bg, colour("paper"))
        imgui.begin("findings", None, imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_move)
        at = imgui.get_window_pos()
        many = "one thing is wrong" if len(findings) == 1 else f"{len(findings)} things are wrong"
        self.pen.text(at.x + 24 * k, at.y + 16 * k, "Nothing was written", "red", bold=True, size=22)
        told = f"{many}; the game goes on with the units it has"
        self.pen.text(at.x + 24 * k, at.y + 44 * k, told, "faint", 16)
        imgui.set_cursor_pos(imgui.ImVec2(20 * k, 74 * k))
        imgui.begin_child("list", imgui.ImVec2(860 * k, -56 * k))
        for line in findings:
            imgui.text_wrapped(line)
            imgui.spacing()
        imgui.end_child()
        imgui.set_cursor_pos_x(20 * k)
        if imgui.button("Close  Esc"):
            self.actions.findings = ()
        imgui.end()
        imgui.pop_style_color()

    def _menu(self) -> None:
        if not imgui.begin_popup("span menu"):
            return
        desk = self.desk
        chosen = bool(desk.selected)

        def item(title: str, keys: str, act: Callable[[], object], *, able: bool = True) -> None:
            if imgui.menu_item(title, keys, False, able)[0]:
                act()

        if chosen and len({m.layer for m in desk.selected}) == 1 and imgui.begin_menu("Behaviour"):
            if self._panels.choose_behaviour(desk.selected[0].layer, close=True):
                imgui.close_current_popup()
            imgui.end_menu()
        proposed = bool(desk.proposals(desk.selected))
        item("Accept", "A", desk.accept, able=proposed)
        item("Reject", "R", desk.reject, able=proposed)
        imgui.separator()
        item("Split at the play head", "S", desk.split_here, able=chosen)
        item("Merge", "M", desk.merge, able=chosen)
        item("Stroke at the play head", "K", desk.stroke_here, able=chosen)
        item("Loop", "L", desk.loop_selection, able=chosen)
        imgui.separator()
        item("Copy", "Ctrl C", desk.copy, able=chosen)
        item("Cut", "Ctrl X", self.actions.cut, able=chosen)
        item("Paste here", "", lambda: desk.paste(desk.snapped(self._menu_s)))
        item("Delete", "Del", desk.delete, able=chosen)
        imgui.end_popup()

    def _behaviour(self, size: tuple[int, int]) -> None:
        self._middle(size, 420, 520)
        if imgui.begin_popup("behaviour"):
            imgui.push_font(self.pen.fonts.body, 17 * self.pen.k)
            mark = self.desk.one
            layer = self.desk.layer if mark is None else mark.layer
            if self._panels.choose_behaviour(layer, close=True) or imgui.is_key_pressed(imgui.Key.escape):
                imgui.close_current_popup()
            imgui.pop_font()
            imgui.end_popup()

    def _recovery(self, size: tuple[int, int]) -> None:
        sheet = next((s for s in self.desk.sheets if s.offer is not None), None)
        if sheet is None or sheet.offer is None:
            return
        told = (
            f"An earlier session left unsaved work on {sheet.now.take}: {len(sheet.offer.marks)} spans, "
            f"where the file has {len(sheet.now.marks)}."
        )
        answer = self._question(size, "Unsaved work", told, ("Take it up", "Let it go"))
        if answer is not None:
            sheet.take_up(wanted=answer == 0)
            self.desk.tell("taken up; save to keep it" if answer == 0 else "let go")

    def _farewell(self, size: tuple[int, int]) -> None:
        if not self.actions.leaving:
            return
        names = ", ".join(sheet.now.take for sheet in self.desk.unsaved)
        answer = self._question(
            size, "Unsaved work", f"{names}: what has been changed is not saved.", ("Save", "Do not save", "Stay")
        )
        if answer == 0:
            self.actions.done = self.desk.save()
        elif answer == 1:
            for sheet in self.desk.unsaved:
                sheet.drop()
            self.actions.done = True
        if answer is not None:
            self.actions.leaving = False

    def _question(self, size: tuple[int, int], title: str, text: str, answers: tuple[str, ...]) -> int | None:
        self._middle(size, 480)
        imgui.open_popup(title)
        given = None
        if imgui.begin_popup_modal(title, None, imgui.WindowFlags_.no_move | imgui.WindowFlags_.always_auto_resize)[0]:
            imgui.text_wrapped(text)
            imgui.spacing()
            for number, answer in enumerate(answers):
                if number:
                    imgui.same_line()
                first = number == 0 and imgui.is_key_pressed(imgui.Key.enter)
                if imgui.button(answer) or first:
                    given = number
            if given is not None:
                imgui.close_current_popup()
            imgui.end_popup()
        return given
