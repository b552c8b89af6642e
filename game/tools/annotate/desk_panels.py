"""Beside the motion: the span in hand, the live statistics, what two annotators see differently, the repertoire."""

from __future__ import annotations

import math

from imgui_bundle import imgui

from game.app.ui import FEELING_COLOURS
from game.core.emotion_space import EMOTIONS
from game.tools.annotate.desk_actions import Actions
from game.tools.annotate.desk_figure import Figure
from game.tools.annotate.desk_pen import LAYER_TITLES, Box, Pen
from game.tools.annotate.desk_repertoire import behaviours_of
from game.tools.annotate.desk_table import TRACK_ORDER
from game.tools.annotate.document import Mark
from game.tools.annotate.statistics import Statistics
from game.tools.windows.style import colour

__all__ = ["Panels"]


class Panels:
    """The right side of the desk."""

    def __init__(self, actions: Actions, pen: Pen) -> None:
        self.actions, self.desk, self.pen = actions, actions.desk, pen
        self._figure = Figure(actions, pen)
        self._search = ""
        self._edited: tuple[Mark, str, str] | None = None
        self._path = ""

    def draw(self, box: Box) -> None:
        """One frame in a box of the window."""
        x, y, w, h = box
        pen = self.pen
        pen.box(x, y, w, h, colour("paper"), 5.0)
        imgui.set_cursor_screen_pos(imgui.ImVec2(x, y))
        imgui.begin_child("panels", imgui.ImVec2(w, h), imgui.ChildFlags_.always_use_window_padding)
        imgui.push_font(pen.fonts.body, 17 * pen.k)
        if imgui.begin_tab_bar("tabs"):
            for title, page in (
                ("Span", self._span), ("Statistics", self._statistics), ("Agreement", self._agreement),
                ("Repertoire", self._figure.draw),
            ):  # fmt: skip
                if imgui.begin_tab_item(title)[0]:
                    imgui.begin_child("page")
                    page()
                    imgui.end_child()
                    imgui.end_tab_item()
            imgui.end_tab_bar()
        imgui.pop_font()
        imgui.end_child()
        pen.frame(x, y, w, h, colour("line", 0.45), 1.2, 5.0)

    # -- the span in hand --------------------------------------------------------------------------------------------
    def _span(self) -> None:
        desk, mark = self.desk, self.desk.one
        if mark is None:
            self._take()
            return
        self._bold(desk.repertoire[mark.behaviour].label["en"] if mark.behaviour in desk.repertoire else mark.behaviour)
        imgui.same_line()
        imgui.text_disabled(mark.layer)
        frames = f"{desk.document.frame_of(mark.start_s)} – {desk.document.frame_of(mark.end_s)}"
        imgui.text(f"{mark.start_s:.3f} – {mark.end_s:.3f} s      {mark.length_s:.3f} s      frames {frames}")
        if mark.confidence is not None:
            imgui.text_colored(self._tint("red"), f"proposed, {100 * mark.confidence:.0f} % sure")
            self._buttons(("Accept  A", desk.accept), ("Reject  R", desk.reject))
        if self._edited is None or self._edited[0] != mark:
            self._edited = mark, mark.words, mark.note
        _, words, note = self._edited
        words, words_done = self._field("words", "words it goes with", words)
        note, note_done = self._field("note", "note", note)
        self._edited = mark, words, note
        if words_done and words != mark.words:
            desk.change(words=words)
        elif note_done and note != mark.note:
            desk.change(note=note)
        stroke = "no stroke marked" if mark.stroke_s is None else f"stroke at {mark.stroke_s:.3f} s"
        imgui.align_text_to_frame_padding()
        imgui.text(stroke)
        imgui.same_line()
        self._buttons(("Stroke here  K", desk.stroke_here))
        self._buttons(
            ("Split  S", desk.split_here), ("Merge  M", desk.merge), ("Loop  L", desk.loop_selection),
            ("Delete  Del", desk.delete),
        )  # fmt: skip
        imgui.separator()
        self.choose_behaviour(mark.layer)

    def _field(self, name: str, hint: str, text: str) -> tuple[str, bool]:
        """A text field; its text, and whether it has just been left or finished with Enter."""
        if self.actions.typing == name:
            imgui.set_keyboard_focus_here()
            self.actions.typing = ""
        imgui.set_next_item_width(-1)
        entered, text = imgui.input_text_with_hint(f"##{name}", hint, text, imgui.InputTextFlags_.enter_returns_true)
        return text, entered or imgui.is_item_deactivated_after_edit()

    def choose_behaviour(self, layer: str, *, close: bool = False) -> bool:
        """A list to search; True once one has been chosen."""
        if self.actions.searching:
            imgui.set_keyboard_focus_here()
            self.actions.searching, self._search = False, ""
        imgui.set_next_item_width(-1)
        hint = f"search a {layer}  (B)"
        entered, self._search = imgui.input_text_with_hint(
            f"##search{close}", hint, self._search, imgui.InputTextFlags_.enter_returns_true
        )
        found = behaviours_of(self.desk.repertoire, layer, self._search)
        if entered and found:
            self.desk.set_behaviour(found[0].name)
            self._search = ""
            return True
        now = self.desk.one
        for number, behaviour in enumerate(found):
            at = imgui.get_cursor_screen_pos()
            side = 11 * self.pen.k
            self.pen.box(at.x + 2, at.y + 5 * self.pen.k, side, side, self.pen.hue(behaviour.name, 0.55, 0.88), 2.0)
            imgui.dummy(imgui.ImVec2(side + 4, side))
            imgui.same_line()
            chosen = behaviour.name == (self.desk.brush[layer] if now is None else now.behaviour)
            marker = "   (Enter)" if self._search and number == 0 else ""
            if imgui.selectable(f"{behaviour.label.get('en', behaviour.name)}{marker}##{behaviour.name}", chosen)[0]:
                self.desk.set_behaviour(behaviour.name)
                return True
        return False

    def _take(self) -> None:
        """Without a span in hand: the take itself."""
        desk, document = self.desk, self.desk.document
        if len(desk.selected) > 1:
            self._bold(f"{len(desk.selected)} spans")
            self._buttons(("Merge  M", desk.merge), ("Accept  A", desk.accept), ("Delete  Del", desk.delete))
            imgui.separator()
        self._bold(document.take)
        imgui.text_disabled(f"{document.length_s:.1f} s, {document.frames} frames, version {document.version}")
        imgui.set_next_item_width(180 * self.pen.k)
        if imgui.begin_combo("emotion", document.emotion or "which of the seven?"):
            for emotion in EMOTIONS:
                if imgui.selectable(emotion, emotion == document.emotion)[0]:
                    desk.describe(emotion=emotion)
            imgui.end_combo()
        for what in ("author", "note", "licence"):
            imgui.set_next_item_width(-90 * self.pen.k)
            changed, text = imgui.input_text(what, getattr(document, what))
            if changed:
                desk.describe(**{what: text})
        waiting = len(desk.proposals())
        self._buttons(("Propose  P", self.actions.propose))
        if waiting:
            imgui.text_colored(self._tint("red"), f"proposed, to be looked at: {waiting}")
            self._buttons(
                ("Accept all", lambda: desk.accept(everything=True)),
                ("Reject all", lambda: desk.reject(everything=True)),
            )
        imgui.separator()
        imgui.text_disabled(f"new {desk.layer} spans will be")
        self.choose_behaviour(desk.layer)

    # -- statistics --------------------------------------------------------------------------------------------------
    def _statistics(self) -> None:
        desk = self.desk
        figures = self.actions.statistics()
        mark = desk.one
        name = mark.behaviour if mark is not None else desk.brush[desk.layer]
        self._profile(name, figures)
        self._missing(figures)
        self._bold("Intensity (eq. 2), duration and waiting time (eq. 3)")
        emotion = desk.document.emotion
        if not emotion:
            imgui.text_wrapped("Say on the page Span (nothing selected) which emotion this take shows.")
            return
        column = EMOTIONS.index(emotion)
        imgui.text_disabled(f"in {emotion}, of {len(figures.annotated_s)} takes of this folder")
        flags = imgui.TableFlags_.row_bg | imgui.TableFlags_.sizing_stretch_prop
        for layer in TRACK_ORDER:
            rows = [u for u in figures.units if u.layer == layer and u.exists[column]]
            if not rows or not imgui.begin_table(f"units {layer}", 4, flags):
                continue
            for title in (LAYER_TITLES[layer], "I", "L_d s", "L_w s"):
                imgui.table_setup_column(title, 0, 3.4 if title == LAYER_TITLES[layer] else 1.0)
            imgui.table_headers_row()
            for unit in sorted(rows, key=lambda u: -float(u.intensity[column])):
                imgui.table_next_row()
                imgui.table_next_column()
                imgui.text(unit.title())
                values = (unit.intensity[column], unit.duration_s[column], unit.waiting_s[column])
                for value, form in zip(values, ("{:.2f}", "{:.2f}", "{:.1f}"), strict=True):
                    imgui.table_next_column()
                    imgui.text(form.format(float(value)))
            imgui.end_table()
        self._transitions(name, figures)

    def _profile(self, name: str, figures: Statistics) -> None:
        """Bars per emotion, the paper's figure 4."""
        pen, profile = self.pen, figures.profile(name)
        known = self.desk.repertoire.get(name)
        self._bold(f"Emotion profile: {name if known is None else known.label.get('en', name)}")
        if profile is None:
            imgui.text_disabled("nobody has marked it yet")
            return
        at, k = imgui.get_cursor_screen_pos(), pen.k
        height, wide = 96 * k, imgui.get_content_region_avail().x / len(EMOTIONS)
        for i, emotion in enumerate(EMOTIONS):
            x, value = at.x + i * wide, float(profile[i])
            tint = _packed(FEELING_COLOURS[emotion])
            pen.box(x + 6 * k, at.y + 18 * k, wide - 12 * k, height - 18 * k, colour("blank", 0.6), 2.0)
            tall = (height - 18 * k) * value
            pen.box(x + 6 * k, at.y + height - tall, wide - 12 * k, tall, tint, 2.0)
            pen.text(x + 8 * k, at.y, f"{value:.2f}", "ink" if value > 0 else "faint", 14)
            pen.text(x + 4 * k, at.y + height + 2 * k, emotion, "ink", 13.5, room=wide - 4 * k)
        imgui.dummy(imgui.ImVec2(wide * len(EMOTIONS), height + 22 * k))

    def _missing(self, figures: Statistics) -> None:
        desk, own = self.desk, next((m for m in figures.missing if m.take == self.desk.document.take), None)
        if own is None:
            return
        told = [f"{own.unannotated_s:.1f} s without a posture"] if own.unannotated else []
        told += [f"{own.proposals} proposals to look at"] if own.proposals else []
        told += [f"{own.strokeless} gestures without a stroke"] if own.strokeless else []
        self._bold("Still to do")
        imgui.text_wrapped("; ".join(told) or "nothing: this take is complete")
        for number, (start, end) in enumerate(own.unannotated[:12]):
            if imgui.small_button(f"{start:.1f} – {end:.1f} s##{number}"):
                desk.clock.go_to(start)
                desk.view.fit(max(start - 1.0, 0.0), min(end + 1.0, desk.document.length_s))
            if number % 4 != 3 and number + 1 < len(own.unannotated[:12]):
                imgui.same_line()

    def _transitions(self, name: str, figures: Statistics) -> None:
        after = sorted(figures.transitions.get(name, {}).items(), key=lambda item: -item[1])
        before = sorted(((a, row[name]) for a, row in figures.transitions.items() if name in row), key=lambda i: -i[1])
        self._bold("Transitions")
        for title, rows in (("from", before), ("to", after)):
            text = ", ".join(f"{other.replace('_', ' ')} {count}×" for other, count in rows[:8])
            imgui.text_wrapped(f"{title}: {text or 'none'}")

    # -- agreement ---------------------------------------------------------------------------------------------------
    def _agreement(self) -> None:
        actions, desk = self.actions, self.desk
        imgui.text_wrapped("A second annotation of this take (YAML), to see where two people differ:")
        imgui.set_next_item_width(-80 * self.pen.k)
        if self.actions.second_name and not self._path:
            self._path = self.actions.second_name
        entered, self._path = imgui.input_text_with_hint(
            "##second", "somebody.yaml", self._path, imgui.InputTextFlags_.enter_returns_true
        )
        imgui.same_line()
        if imgui.button("Compare") or entered:
            actions.compare_with(desk.sheet.bvh.parent / self._path)
        result = actions.agreement()
        if result is None:
            return
        for layer in TRACK_ORDER:
            kappa = result.kappa[layer]
            value = "nothing to disagree about" if math.isnan(kappa) else f"kappa {kappa:.3f}"
            self._bold(LAYER_TITLES[layer])
            imgui.same_line(120 * self.pen.k)
            imgui.text(f"{value}, {100 * result.observed[layer]:.1f} % of the frames alike")
        self._bold(f"Stretches that differ: {len(result.differences)}")
        for number, d in enumerate(result.differences):
            told = f"{d.start_s:7.2f} – {d.end_s:.2f} s   {d.first or '–'} / {d.second or '–'}##{number}"
            if imgui.selectable(told, False)[0]:
                desk.layer = d.layer
                desk.clock.go_to(d.start_s)
                desk.view.fit(max(d.start_s - 2.0, 0.0), min(d.end_s + 2.0, desk.document.length_s))

    # -- pieces ------------------------------------------------------------------------------------------------------
    def _bold(self, text: str) -> None:
        imgui.push_font(self.pen.fonts.bold, 18 * self.pen.k)
        imgui.text(text)
        imgui.pop_font()

    def _tint(self, name: str) -> imgui.ImVec4:
        return imgui.color_convert_u32_to_float4(colour(name))

    def _buttons(self, *buttons: tuple[str, object]) -> None:
        for number, (title, act) in enumerate(buttons):
            if number:
                imgui.same_line()
            if imgui.button(title) and callable(act):
                act()


def _packed(tint: tuple[float, ...]) -> int:
    return int(imgui.color_convert_float4_to_u32(imgui.ImVec4(float(tint[0]), float(tint[1]), float(tint[2]), 1.0)))
