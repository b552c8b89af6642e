"""The time line: a ruler, the words, one track per layer; rows per behaviour where a track is unfolded."""

from __future__ import annotations

from dataclasses import dataclass

from imgui_bundle import imgui

from game.tools.annotate.agreement import Difference
from game.tools.annotate.desk_pen import LAYER_TITLES, Box, Pen
from game.tools.annotate.desk_state import Desk, Drag
from game.tools.annotate.desk_table import TRACK_ORDER
from game.tools.annotate.document import Mark
from game.tools.windows.style import colour

__all__ = ["Row", "Timeline", "rows_of"]

LABELS = 168.0
_RULER, _WORDS, _FOLDED, _MOST, _ROW, _HEAD, _MAP = 26.0, 24.0, 40.0, 64.0, 20.0, 22.0, 14.0
_EDGE = 5.0


@dataclass(frozen=True)
class Row:
    """One line of the time line, in pixels from its top. behaviour "" : all of the layer's; kind: words, track, row."""

    kind: str
    layer: str
    behaviour: str
    y: float
    height: float


def rows_of(desk: Desk, k: float, room: float = 0.0) -> list[Row]:
    """The words, then each layer: one track with everything, and under it a row per behaviour where it is unfolded.

    room: pixels there are; tracks grow to fill them.
    """
    rows: list[Row] = []
    spare = room / k - _RULER - (_WORDS if desk.document.spoken else 0.0)
    folded = max(_FOLDED, min(spare / len(TRACK_ORDER), _MOST)) if len(desk.folded) == len(TRACK_ORDER) else _FOLDED
    y = _RULER * k

    def add(kind: str, layer: str, behaviour: str, height: float) -> None:
        nonlocal y
        rows.append(Row(kind, layer, behaviour, y, height * k))
        y += height * k

    if desk.document.spoken:
        add("words", "", "", _WORDS)
    for layer in TRACK_ORDER:
        if layer in desk.folded:
            add("track", layer, "", folded)
            continue
        add("head", layer, "", _HEAD)
        shown = {m.behaviour for m in desk.document.of_layer(layer)} | {desk.brush[layer]}
        names = [name for name in desk.repertoire if name in shown]
        for name in [*names, *sorted(shown - set(names))]:
            add("row", layer, name, _ROW)
    return rows


class Timeline:
    """Draws the time line and turns the mouse into edits."""

    def __init__(self, desk: Desk, pen: Pen) -> None:
        self.desk, self.pen = desk, pen
        self.scroll = 0.0
        self.menu_s: float | None = None
        self.opened: Mark | None = None
        self._drag: Drag | None = None
        self._band: tuple[Row, float] | None = None
        self._held = ""
        self._hovered: tuple[Mark, str] | None = None

    def draw(self, box: Box, differences: tuple[Difference, ...]) -> None:
        """One frame in a box of the window."""
        desk, pen = self.desk, self.pen
        x, y, w, h = box
        k = pen.k
        left = x + LABELS * k
        desk.view.resize(w - LABELS * k)
        body = h - _MAP * k
        rows = rows_of(desk, k, body)
        below = max((rows[-1].y + rows[-1].height if rows else 0.0) - body, 0.0)
        self.scroll = min(max(self.scroll, 0.0), below)
        pen.box(x, y, w, h, colour("paper"), 5.0)
        imgui.set_cursor_screen_pos(imgui.ImVec2(x, y))
        flags = imgui.ButtonFlags_
        imgui.invisible_button(
            "time line", imgui.ImVec2(w, h),
            flags.mouse_button_left | flags.mouse_button_right | flags.mouse_button_middle,
        )  # fmt: skip
        hovered, active = imgui.is_item_hovered(), imgui.is_item_active()
        self._hovered = None
        pen.lines.push_clip_rect(imgui.ImVec2(x, y), imgui.ImVec2(x + w, y + body), True)
        self._tracks(rows, x, y, left, w, differences, hovered=hovered)
        self._ruler(left, x, y, w)
        self._band_ghost(left, y)
        self._heads(rows, left, y, x + w)
        pen.lines.pop_clip_rect()
        self._map(x, y + body, left, w)
        self._mouse(rows, x, y, left, w, body, hovered=hovered, active=active)
        pen.frame(x, y, w, h, colour("line", 0.45), 1.2, 5.0)

    # -- drawing -----------------------------------------------------------------------------------------------------
    def _ruler(self, left: float, x: float, y: float, w: float) -> None:
        desk, pen, k = self.desk, self.pen, self.pen.k
        pen.box(x, y, w, _RULER * k, colour("blank"), 5.0)
        frames = desk.view.px_s / desk.document.fps
        pen.text(x + 10 * k, y + 4 * k, "frames" if frames > 6 else "seconds", "faint", 15)
        pen.lines.push_clip_rect(imgui.ImVec2(left, y), imgui.ImVec2(x + w, y + _RULER * k), True)
        if frames > 6.0:
            first = int(max(desk.view.start_s, 0.0) * desk.document.fps)
            for frame in range(first, first + int(desk.view.width / frames) + 2):
                at = left + desk.view.x(frame / desk.document.fps)
                pen.line(at, y + (_RULER - 6) * k, at, y + _RULER * k, colour("line", 0.6))
        for time_s in desk.view.ticks(70.0 * k):
            at = left + desk.view.x(time_s)
            pen.line(at, y + 14 * k, at, y + _RULER * k, colour("line"))
            if frames > 6.0:
                label = f"{time_s:.2f} s · {round(time_s * desk.document.fps)}"
            else:
                label = f"{int(time_s // 60)}:{time_s % 60:02g}" if time_s >= 60 else f"{time_s:g}"
            pen.text(at + 4 * k, y + 2 * k, label, "ink", 14.5)
        pen.lines.pop_clip_rect()

    def _tracks(
        self, rows: list[Row], x: float, y: float, left: float, w: float, differences: tuple[Difference, ...], *,
        hovered: bool,
    ) -> None:  # fmt: skip
        desk, pen, k = self.desk, self.pen, self.pen.k
        for number, row in enumerate(rows):
            top = y + row.y - self.scroll
            if row.kind == "head":
                pen.box(x, top, w, row.height, colour("blank", 0.75))
            elif row.kind == "row" and number % 2:
                pen.box(x, top, w, row.height, colour("blank", 0.28))
            pen.line(x, top + row.height, x + w, top + row.height, colour("line", 0.18))
            self._label(row, x, top)
        pen.lines.push_clip_rect(imgui.ImVec2(left, y), imgui.ImVec2(x + w, y + 4000), True)
        for row in rows:
            top = y + row.y - self.scroll
            if row.kind == "words":
                for word in desk.document.spoken:
                    a, b = (left + desk.view.x(t) for t in (word.start_s, word.end_s))
                    pen.box(a, top + 3 * k, b - a - 1, row.height - 6 * k, colour("blue", 0.14), 3.0)
                    pen.text(a + 3 * k, top + 3 * k, word.text, "blue", 15, room=b - a - 4 * k)
            elif row.kind != "head":
                if row.kind == "track":
                    for start, end in desk.document.gaps(row.layer) if row.layer == "posture" else []:
                        a, b = (left + desk.view.x(t) for t in (start, end))
                        pen.box(a, top + row.height - 4 * k, b - a, 3 * k, colour("red", 0.35))
                for mark in desk.document.of_layer(row.layer):
                    if row.kind == "track" or mark.behaviour == row.behaviour:
                        self._mark(row, mark, left, top, hovered=hovered)
            if row.kind in {"track", "head"}:
                for d in differences:
                    if d.layer == row.layer:
                        a, b = (left + desk.view.x(t) for t in (d.start_s, d.end_s))
                        pen.box(a, top + 1, max(b - a, 2.0), 3.5 * k, colour("red"))
        pen.lines.pop_clip_rect()

    def _label(self, row: Row, x: float, top: float) -> None:
        desk, pen, k = self.desk, self.pen, self.pen.k
        if row.kind == "words":
            pen.text(x + 24 * k, top + 2 * k, "spoken words", "faint", 16)
            return
        if row.kind == "row":
            pen.box(x + 24 * k, top + 5 * k, 10 * k, 10 * k, pen.hue(row.behaviour, 0.55, 0.85), 2.0)
            bold = desk.brush[row.layer] == row.behaviour and desk.layer == row.layer
            label = self._title(row.behaviour)
            pen.text(x + 40 * k, top + 1 * k, label, "ink", 15, bold=bold, room=(LABELS - 46) * k)
            return
        middle = top + min(row.height, _HEAD * k) / 2 + (4 * k if row.height > 50 * k else 0)
        if desk.layer == row.layer:
            pen.box(x, top, 4 * k, row.height, colour("red"))
        pen.triangle(x + 14 * k, middle, 4.5, colour("line"), down=row.kind == "head")
        marks = desk.document.of_layer(row.layer)
        pen.text(x + 24 * k, middle - 11 * k, LAYER_TITLES[row.layer], "ink", 17, bold=True)
        pen.text(x + 130 * k, middle - 10 * k, f"{len(marks)}", "faint", 15)
        if row.kind == "track":
            pen.text(
                x + 24 * k, top + 20 * k, self._title(desk.brush[row.layer]), "faint", 14.5, room=(LABELS - 30) * k
            )

    def _title(self, name: str) -> str:
        known = self.desk.repertoire.get(name)
        return name if known is None else known.label.get("en", name)

    def _mark(self, row: Row, mark: Mark, left: float, top: float, *, hovered: bool) -> None:
        desk, pen, k = self.desk, self.pen, self.pen.k
        a, b = (left + desk.view.x(t) for t in (mark.start_s, mark.end_s))
        if b < left or a > left + desk.view.width:
            return
        pad = (4 if row.kind == "track" else 2) * k
        y, h = top + pad, row.height - 2 * pad
        proposal, chosen = mark.confidence is not None, mark in desk.selected
        pen.box(a, y, max(b - a - 1, 2.0), h, pen.hue(mark.behaviour, 0.42, 0.93, 0.4 if proposal else 1.0), 3.0)
        if proposal:
            pen.hatch(a, y, b - a - 1, h, pen.hue(mark.behaviour, 0.6, 0.72, 0.55))
        mouse = imgui.get_mouse_pos()
        over = hovered and a - _EDGE * k <= mouse.x <= b + _EDGE * k and y <= mouse.y <= y + h and mouse.x >= left
        if over:
            part = self._part(mark, a, b, mouse.x)
            if self._hovered is None or self._hovered[0] not in desk.selected:
                self._hovered = (mark, part)
        edge = colour("red") if chosen else pen.hue(mark.behaviour, 0.65, 0.55)
        pen.frame(a, y, max(b - a - 1, 2.0), h, edge, 2.4 if chosen else 1.0, 3.0)
        if mark.stroke_s is not None:
            at = left + desk.view.x(mark.stroke_s)
            pen.line(at, y, at, y + h, colour("ink"), 2.0)
            pen.triangle(at, y + 3 * k, 3.5, colour("ink"), down=True)
        if row.kind == "track":
            seen = max(a, left) + 6 * k
            room = b - seen - 4 * k
            pen.text(seen, y + 1 * k, self._title(mark.behaviour), "ink", 15.5, room=room)
            more = f"{100 * mark.confidence:.0f} % sure" if mark.confidence is not None else mark.words or mark.note
            if more:
                pen.text(seen, y + 15 * k, more, "faint", 14, room=room)

    def _part(self, mark: Mark, a: float, b: float, x: float) -> str:
        k = self.pen.k
        grip = min(_EDGE * k, max((b - a) / 4, 1.0))
        if mark.stroke_s is not None and mark in self.desk.selected:
            at = a + (mark.stroke_s - mark.start_s) * self.desk.view.px_s
            if abs(x - at) <= 4 * k and grip < x - a < b - a - grip:
                return "stroke"
        if x <= a + grip:
            return "start"
        return "end" if x >= b - grip else "move"

    def _heads(self, rows: list[Row], left: float, y: float, right: float) -> None:
        """Loop, the beginning set with the keyboard, and the play head."""
        desk, pen, k = self.desk, self.pen, self.pen.k
        bottom = y + (rows[-1].y + rows[-1].height if rows else 0.0) - self.scroll
        pen.lines.push_clip_rect(imgui.ImVec2(left, y), imgui.ImVec2(right, max(bottom, y + 60 * k)), True)
        if desk.clock.loop is not None:
            a, b = (left + desk.view.x(t) for t in desk.clock.loop)
            pen.box(a, y, b - a, 5 * k, colour("green", 0.8))
            pen.box(a, y, b - a, 4000, colour("green", 0.06))
        at = left + desk.view.x(desk.clock.time_s)
        if desk.begun_s is not None:
            begun = left + desk.view.x(desk.begun_s)
            pen.box(min(begun, at), y, abs(at - begun), 4000, colour("blue", 0.12))
            pen.line(begun, y, begun, bottom, colour("blue"), 2.0)
        pen.line(at, y, at, bottom, colour("red"), 1.6)
        pen.triangle(at, y + 8 * k, 7, colour("red"), down=True)
        pen.lines.pop_clip_rect()

    def _band_ghost(self, left: float, y: float) -> None:
        if self._band is None:
            return
        row, start = self._band
        desk, pen = self.desk, self.pen
        end = desk.snapped(desk.view.time(imgui.get_mouse_pos().x - left))
        a, b = sorted((left + desk.view.x(start), left + desk.view.x(end)))
        name = row.behaviour or desk.brush[row.layer]
        top = y + row.y - self.scroll
        pen.box(a, top + 2, b - a, row.height - 4, pen.hue(name, 0.4, 0.95, 0.6), 3.0)
        pen.text(b + 6, top + 4, f"{abs(end - start):.2f} s", "ink", 15)

    def _map(self, x: float, y: float, left: float, w: float) -> None:
        """The whole take in one strip, with the stretch that is shown."""
        desk, pen, k = self.desk, self.pen, self.pen.k
        width, h = desk.view.width, _MAP * k
        pen.box(x, y, w, h, colour("blank"), 0.0)
        scale = width / max(desk.view.length_s, 1e-3)
        for number, layer in enumerate(TRACK_ORDER):
            for mark in desk.document.of_layer(layer):
                tint = pen.hue(mark.behaviour, 0.55, 0.8, 0.5 if mark.confidence is not None else 1.0)
                at, length = left + mark.start_s * scale, max(mark.length_s * scale, 1.0)
                pen.box(at, y + (2 + number * 3.5) * k, length, 3 * k, tint)
        a = left + max(desk.view.start_s, 0.0) * scale
        b = left + min(desk.view.start_s + width / desk.view.px_s, desk.view.length_s) * scale
        pen.frame(a, y + 0.5, max(b - a, 6.0), h - 1, colour("line"), 1.6, 2.0)
        at = left + desk.clock.time_s * scale
        pen.line(at, y, at, y + h, colour("red"), 1.4)

    # -- the mouse ---------------------------------------------------------------------------------------------------
    def _mouse(
        self, rows: list[Row], x: float, y: float, left: float, w: float, body: float, *, hovered: bool, active: bool
    ) -> None:
        mouse, io = imgui.get_mouse_pos(), imgui.get_io()
        desk, k = self.desk, self.pen.k
        time_s = desk.view.time(mouse.x - left)
        row = next((r for r in rows if r.y <= mouse.y - y + self.scroll < r.y + r.height), None)
        if mouse.y < y + _RULER * k:
            row = None
        if hovered and not self._held:
            self._pointer(left, mouse)
            self._wheel(left, mouse, io)
        if hovered and imgui.is_mouse_clicked(0):
            self._press(row, left, mouse.x, mouse.y, time_s, y, body, more=bool(io.key_ctrl))
            self._twice = imgui.is_mouse_double_clicked(0)
        if hovered and imgui.is_mouse_released(1) and not self._held:
            if self._hovered is not None and self._hovered[0] not in desk.selected:
                desk.select(self._hovered[0])
            elif row is not None and row.layer:
                desk.layer = row.layer
            self.menu_s = time_s
        if active and imgui.is_mouse_dragging(2, 2.0):
            desk.view.pan(-io.mouse_delta.x)
        if self._held:
            self._hold(left, time_s, w)

    def _pointer(self, left: float, mouse: imgui.ImVec2) -> None:
        if self._hovered is None or mouse.x < left:
            return
        mark, part = self._hovered
        cursor = imgui.MouseCursor_.hand if part == "move" else imgui.MouseCursor_.resize_ew
        imgui.set_mouse_cursor(cursor)
        told = f"{self._title(mark.behaviour)}: {mark.start_s:.3f} to {mark.end_s:.3f} s, {mark.length_s:.2f} s"
        for more in (mark.words and f"words: {mark.words}", mark.note):
            told += f"\n{more}" if more else ""
        imgui.set_tooltip(told)

    def _wheel(self, left: float, mouse: imgui.ImVec2, io: imgui.IO) -> None:
        desk = self.desk
        if io.mouse_wheel_h:
            desk.view.pan(-60.0 * io.mouse_wheel_h)
        if io.mouse_wheel and (mouse.x < left or io.key_ctrl):
            self.scroll -= 30.0 * io.mouse_wheel
        elif io.mouse_wheel and io.key_shift:
            desk.view.pan(-80.0 * io.mouse_wheel)
        elif io.mouse_wheel:
            desk.view.zoom(1.25**io.mouse_wheel, mouse.x - left)

    def _press(
        self, row: Row | None, left: float, mx: float, my: float, time_s: float, y: float, body: float, *, more: bool
    ) -> None:
        desk = self.desk
        if my >= y + body:
            self._held = "map"
        elif mx < left:
            if row is not None and row.layer:
                desk.layer = row.layer
                if row.kind == "row":
                    desk.brush[row.layer] = row.behaviour
                else:
                    desk.folded ^= {row.layer}
        elif self._hovered is not None:
            mark, part = self._hovered
            if more:
                desk.select(mark, more=True)
            else:
                self._drag = desk.begin_drag(part, mark, time_s)
                self._held = "ready"
                self._from = mx
        elif row is None or row.kind in {"words", "head"}:
            self._held = "scrub"
        else:
            desk.layer = row.layer
            desk.select(None, more=more)
            self._band, self._held, self._from = (row, desk.snapped(time_s)), "band", mx

    def _hold(self, left: float, time_s: float, w: float) -> None:
        desk, mouse = self.desk, imgui.get_mouse_pos()
        released = not imgui.is_mouse_down(0)
        if self._held == "ready" and abs(mouse.x - self._from) > 3.0 * self.pen.k:
            self._held = "drag"
        if self._held == "scrub":
            desk.clock.playing = False
            desk.clock.go_to(edits_frame(time_s, desk.document.fps))
        elif self._held == "map":
            share = (mouse.x - left) / max(desk.view.width, 1.0)
            desk.view.start_s = share * desk.view.length_s - 0.5 * desk.view.width / desk.view.px_s
            desk.view.pan(0.0)
        elif self._held == "drag" and self._drag is not None:
            desk.drag(self._drag, time_s)
        if released:
            self._let_go(time_s, mouse.x)

    def _let_go(self, time_s: float, x: float) -> None:
        desk = self.desk
        if self._held == "band" and self._band is not None:
            row, start = self._band
            if abs(x - self._from) > 4.0 * self.pen.k:
                desk.create(row.layer, start, desk.snapped(time_s), row.behaviour or None)
            else:
                desk.clock.go_to(edits_frame(time_s, desk.document.fps))
        elif self._held == "ready" and self._drag is not None:
            if len(desk.selected) > 1:
                desk.select(self._drag.marks[0])
            if self._twice:  # asked for on letting go: whoever clicks a span and then drags it wants to drag it
                self.opened = self._drag.marks[0]
        self._held, self._drag, self._band = "", None, None

    _from = 0.0
    _twice = False


def edits_frame(time_s: float, fps: float) -> float:
    """The nearest frame's time."""
    return round(time_s * fps) / fps
