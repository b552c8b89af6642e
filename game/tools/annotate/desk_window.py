"""The annotation desk's window: motion, transport, panels and time line on one sheet of paper.

Needs imgui-bundle (the `tools` extra). What can be done is in desk_state.py and desk_actions.py; this is its surface.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path

import pygame
from imgui_bundle import imgui

from game.app.play import need_display
from game.core.paths import ASSETS
from game.embos.clip_shelf import ClipShelf
from game.embos.findings import Findings
from game.render import Device
from game.tools.annotate.command import repertoire_of
from game.tools.annotate.desk_actions import STYLES, Actions
from game.tools.annotate.desk_dialogs import Dialogs
from game.tools.annotate.desk_keys import binding_of
from game.tools.annotate.desk_motion import VIEWS, MotionPictures, draw_stick, pose_at
from game.tools.annotate.desk_panels import Panels
from game.tools.annotate.desk_pen import Box, Pen
from game.tools.annotate.desk_repertoire import project_behaviours
from game.tools.annotate.desk_sheet import Sheet
from game.tools.annotate.desk_state import Desk
from game.tools.annotate.desk_timeline import Timeline
from game.tools.annotate.desk_view import SPEEDS
from game.tools.windows.imgui_backend import ImguiBackend
from game.tools.windows.style import colour, load_fonts, set_style

__all__ = ["DeskWindow", "open_desk"]

IDLE_S = 0.2
_BAR, _TRANSPORT, _STATUS, _SIDE, _GAP = 46.0, 44.0, 28.0, 430.0, 8.0
_SPEED_NAMES = {0.125: "1/8", 0.25: "1/4", 0.5: "1/2", 1.0: "1×"}


class DeskWindow:
    """Sizes are for a window 900 pixels high; ``_k`` scales them."""

    def __init__(self, device: Device, actions: Actions) -> None:
        self.device, self.actions, self.desk = device, actions, actions.desk
        self._backend = ImguiBackend(device.context)
        self._fonts = load_fonts()
        set_style()
        self.pen = Pen(self._fonts, self.desk.repertoire)
        self._pictures = MotionPictures(device.context, self._backend)
        self._timeline = Timeline(self.desk, self.pen)
        self._panels = Panels(actions, self.pen)
        self._dialogs = Dialogs(actions, self.pen, self._timeline, self._panels)
        self._k = 1.0
        self._down: set[int] = set()

    # -- input -------------------------------------------------------------------------------------------------------
    def handle(self, event: pygame.event.Event) -> None:
        """One event of the window."""
        if event.type == pygame.QUIT:
            self.actions.quit()
        elif event.type in {pygame.VIDEORESIZE, pygame.WINDOWSIZECHANGED}:
            self.device.resize(*pygame.display.get_window_size())
        else:
            ratio = self.device.size[0] / max(pygame.display.get_window_size()[0], 1)
            self._backend.feed(event, ratio)
            if event.type == pygame.KEYDOWN and not self._backend.typing and not self._dialogs.asking:
                binding = binding_of(event.key, event.mod, event.unicode)
                if binding is not None and (binding.again or event.key not in self._down):
                    binding.run(self.actions)
            self._follow_keys(event)

    def _follow_keys(self, event: pygame.event.Event) -> None:
        """Which keys are held: their repetitions, above all those of a slow frame, must not switch things twice."""
        if event.type == pygame.KEYDOWN:
            self._down.add(event.key)
        elif event.type == pygame.KEYUP:
            self._down.discard(event.key)
        elif event.type == pygame.WINDOWFOCUSLOST:
            self._down.clear()

    # -- drawing -----------------------------------------------------------------------------------------------------
    def _layout(self) -> tuple[Box, Box, Box, Box, Box]:
        """Boxes of motion, transport, panels, time line, last line."""
        w, h = self.device.size
        k = self._k
        gap, side = _GAP * k, min(_SIDE * k, 0.36 * w)
        line_h = 0.34 * h
        status = (gap, h - _STATUS * k, w - 2 * gap, _STATUS * k)
        timeline = (gap, status[1] - line_h, w - 2 * gap, line_h)
        top = _BAR * k
        transport = (gap, timeline[1] - _TRANSPORT * k, w - side - 3 * gap, _TRANSPORT * k)
        motion = (gap, top, w - side - 3 * gap, transport[1] - top)
        panels = (w - side - gap, top, side, timeline[1] - gap - top)
        return motion, transport, panels, timeline, status

    def _motion_boxes(self, motion: Box) -> list[Box]:
        x, y, w, h = motion
        count = len(self.desk.sheets)
        columns = count if count <= 3 else (count + 1) // 2
        rows = (count + columns - 1) // columns
        gap = 4.0 * self._k
        wide, tall = (w - gap * (columns - 1)) / columns, (h - gap * (rows - 1)) / rows
        return [(x + (i % columns) * (wide + gap), y + (i // columns) * (tall + gap), wide, tall) for i in range(count)]

    def draw(self, elapsed_s: float) -> bool:
        """One frame; True where the next one should follow at once."""
        size = self.device.size
        self._k = self.pen.k = min(size[0] / 1440.0, size[1] / 900.0)
        self.actions.tick(elapsed_s)
        boxes = self._layout()
        views = self._motion_boxes(boxes[0])
        clock, orbit = self.desk.clock, self.actions.orbit
        if self.actions.style != "stick":
            for i, (sheet, view) in enumerate(zip(self.desk.sheets, views, strict=True)):
                pixels = (max(int(view[2]), 16), max(int(view[3]), 16))
                stall = self.actions.style == "stall"
                camera = orbit.camera(pixels[0] / pixels[1])
                self._pictures.draw(i, sheet.clip, clock.time_s, camera, pixels, stall=stall)
        screen = self.device.context.screen
        screen.viewport = (0, 0, *size)
        screen.use()
        screen.clear(0.984, 0.955, 0.89, 1.0)
        self._backend.begin(size, elapsed_s)
        imgui.set_next_window_pos(imgui.ImVec2(0, 0))
        imgui.set_next_window_size(imgui.ImVec2(float(size[0]), float(size[1])))
        flags = imgui.WindowFlags_
        fixed = flags.no_decoration | flags.no_move | flags.no_background | flags.no_bring_to_front_on_focus
        imgui.begin("desk", None, fixed | flags.no_nav_inputs | flags.no_scroll_with_mouse)
        imgui.push_font(self._fonts.body, 17 * self._k)
        self._bar(size[0])
        for i, view in enumerate(views):
            self._motion(i, view)
        self._transport(boxes[1])
        self._panels.draw(boxes[2])
        agreed = self.actions.agreement()
        self._timeline.draw(boxes[3], () if agreed is None else agreed.differences)
        self._status(boxes[4])
        self._dialogs.draw(size)
        imgui.pop_font()
        imgui.end()
        self._backend.end(size)
        pygame.display.flip()
        return clock.playing or self.actions.job is not None

    def _bar(self, width: float) -> None:
        desk, pen, k = self.desk, self.pen, self._k
        imgui.set_cursor_screen_pos(imgui.ImVec2(_GAP * k, 9 * k))
        for i, sheet in enumerate(desk.sheets):
            if i:
                imgui.same_line()
            chosen = i == desk.active
            if chosen:
                imgui.push_style_color(imgui.Col_.button, colour("chosen"))
            dirty = " *" if sheet.history.dirty else ""
            if imgui.button(f"{sheet.now.take}{dirty}##{i}"):
                desk.take(i)
            if chosen:
                imgui.pop_style_color()
        buttons = (
            ("Undo", desk.undo, "Ctrl Z"), ("Redo", desk.redo, "Ctrl Y"), ("Propose", self.actions.propose, "P"),
            ("Save", desk.save, "Ctrl S"), ("Try it", self.actions.try_it, "F5: save, count the units, into the game"),
            ("Keys", self.actions.toggle_help, "F1"),
        )  # fmt: skip
        total = sum(pen.width(title, 17) + 26 * k for title, _, _ in buttons)
        imgui.same_line()
        imgui.set_cursor_screen_pos(imgui.ImVec2(width - total - _GAP * k, 9 * k))
        for title, act, keys in buttons:
            if imgui.button(title):
                act()
            imgui.set_item_tooltip(keys)
            imgui.same_line()

    def _motion(self, index: int, box: Box) -> None:
        x, y, w, h = box
        desk, pen, k, sheet = self.desk, self.pen, self._k, self.desk.sheets[index]
        picture = self._pictures.texture(index) if self.actions.style != "stick" else None
        corner, end = imgui.ImVec2(x, y), imgui.ImVec2(x + w, y + h)
        if picture is not None:
            pen.lines.add_image(picture.ref, corner, end)
        else:
            pen.box(x, y, w, h, colour("paper"), 5.0)
            pen.lines.push_clip_rect(corner, end, True)
            pose = pose_at(sheet.clip, desk.clock.time_s)
            draw_stick(pen.lines, pose, self.actions.orbit.camera(w / h), (x, y), (w, h))
            pen.lines.pop_clip_rect()
        pen.frame(x, y, w, h, colour("red" if index == desk.active and len(desk.sheets) > 1 else "line", 0.7), 1.5, 2.0)
        imgui.set_cursor_screen_pos(corner)
        flags = imgui.ButtonFlags_
        every = flags.mouse_button_left | flags.mouse_button_right | flags.mouse_button_middle
        imgui.invisible_button(f"motion{index}", imgui.ImVec2(w, h), every)
        io, orbit = imgui.get_io(), self.actions.orbit
        if imgui.is_item_active():
            if imgui.is_mouse_dragging(0, 2.0):
                orbit.turn(io.mouse_delta.x, io.mouse_delta.y)
            elif imgui.is_mouse_dragging(1, 1.0) or imgui.is_mouse_dragging(2, 1.0):
                orbit.pan(io.mouse_delta.x, io.mouse_delta.y, h)
        if imgui.is_item_hovered():
            if io.mouse_wheel:
                orbit.zoom(io.mouse_wheel)
            if imgui.is_mouse_clicked(0) and index != desk.active:
                desk.take(index)
        self._captions(sheet, x + 12 * k, y + 8 * k)
        over = desk.clock.time_s >= sheet.clip.length_s
        if over:
            pen.text(x + 12 * k, y + h - 28 * k, "this take has ended", "faint", 15)

    def _captions(self, sheet: Sheet, x: float, y: float) -> None:
        """What the layers say at the play head, over the picture."""
        pen, k, time_s = self.pen, self._k, self.desk.clock.time_s
        title = sheet.now.take + (f", {sheet.now.emotion}" if sheet.now.emotion else "")
        pen.text(x, y, title, "ink", 18, bold=True)
        y += 26 * k
        for layer in ("posture", "mannerism", "gesture"):
            mark = sheet.now.at(layer, time_s)
            if mark is not None:
                known = self.desk.repertoire.get(mark.behaviour)
                text = mark.behaviour if known is None else known.label.get("en", mark.behaviour)
                pen.box(x, y, pen.width(text, 16) + 14 * k, 22 * k, pen.hue(mark.behaviour, alpha=0.92), 4.0)
                pen.text(x + 7 * k, y + 2 * k, text, "ink", 16)
                y += 26 * k
        word = next((w for w in sheet.now.spoken if w.start_s <= time_s < w.end_s), None)
        if word is not None:
            pen.text(x, y, f"“{word.text}”", "blue", 17)

    def _transport(self, box: Box) -> None:
        desk, k, clock = self.desk, self._k, self.desk.clock
        x, y, _, _ = box
        imgui.set_cursor_screen_pos(imgui.ImVec2(x, y + 7 * k))
        wide = imgui.ImVec2(64 * k, 0)
        self._switch("|<", False, lambda: self.actions.step(-(10**9)), "Home: to the start")
        self._switch("<", False, lambda: self.actions.step(-1), "one frame back")
        if imgui.button("Pause" if clock.playing else "Play", wide):
            clock.toggle()
        imgui.same_line()
        self._switch(">", False, lambda: self.actions.step(1), "one frame on")
        self._switch("Loop", clock.loop is not None, desk.loop_selection, "L: the selected span over and over")
        for speed in SPEEDS:
            self._switch(_SPEED_NAMES[speed], speed == clock.speed, lambda s=speed: setattr(clock, "speed", s), "speed")
        self._switch("Snap", desk.snap, self.actions.toggle_snap, "X: edges are drawn to edges, words, frames")
        self._clock_face(x, y)
        for style in STYLES:
            chosen = self.actions.style == style
            self._switch(style.capitalize(), chosen, lambda s=style: setattr(self.actions, "style", s), "C: the next")
        for number, view in enumerate(VIEWS, 1):
            self._switch(view.capitalize(), False, lambda v=view: self.actions.orbit.look_from(v), f"{number}")

    def _clock_face(self, x: float, y: float) -> None:
        """Time and frame of the play head."""
        clock, k = self.desk.clock, self._k
        at = imgui.get_cursor_screen_pos()
        text = f"{clock.time_s:7.3f} s   {clock.frame:5d}"
        self.pen.text(at.x + 4 * k, at.y + 3 * k, text, "ink", 18, bold=True)
        imgui.dummy(imgui.ImVec2(150 * k, 20 * k))
        imgui.same_line()

    def _switch(self, title: str, on: bool, act: object, tip: str) -> None:
        if on:
            imgui.push_style_color(imgui.Col_.button, colour("chosen"))
        pressed = imgui.button(title)
        if on:
            imgui.pop_style_color()
        imgui.set_item_tooltip(tip)
        if pressed and callable(act):
            act()
        imgui.same_line()

    def _status(self, box: Box) -> None:
        x, y, w, _ = box
        desk, k = self.desk, self._k
        self.pen.text(x + 4 * k, y + 4 * k, desk.message, "red" if desk.failed else "green", 16.5, room=w - 330 * k)
        kept = f"{len(desk.unsaved)} unsaved, kept every 2 s" if desk.unsaved else "all saved"
        self.pen.text(x + w - 320 * k, y + 4 * k, f"{kept}      F1: keys", "faint", 16.5)

    def run(self) -> None:
        """Until the window is closed; draws while something moves, rests otherwise."""
        pygame.key.start_text_input()
        pygame.key.set_repeat(300, 33)
        before, busy = time.perf_counter(), 3
        waiting: list[pygame.event.Event] = []
        while not self.actions.done:
            waiting += pygame.event.get()
            if not waiting and busy <= 0:
                waiting = [pygame.event.wait(int(IDLE_S * 1000))]
            # ImGui needs a few frames to settle after every event: hover, focus, fading.
            busy = 4 if waiting else busy - 1
            for event in waiting:
                self.handle(event)
            waiting.clear()
            now = time.perf_counter()
            if self.draw(now - before):
                busy = max(busy, 2)
            before = now

    def close(self) -> None:
        """Give the GL objects back."""
        self._pictures.release()
        self._backend.release()


def open_desk(args: argparse.Namespace, takes: Sequence[Path]) -> int:
    """Open the window; returns when it is closed. Raises BadInput for takes that cannot be read."""
    args.behaviours = args.behaviours or project_behaviours(takes, ASSETS / "motion" / "behaviours.yaml")
    shelf = ClipShelf()
    findings, sheets = Findings(), []
    for path in takes:
        with findings.collect():
            sheets.append(Sheet.open(path, args.author, shelf))
    findings.raise_first()
    desk = Desk(sheets, repertoire_of(args))
    actions = Actions(desk, args.behaviours, args.learn, shelf)
    refused = [sheet.refusal for sheet in desk.sheets if sheet.refusal]
    desk.tell(refused[0] if refused else "F1 shows every key", failed=bool(refused))
    need_display()
    device = Device.window(args.size[0], args.size[1], "Annotation desk")
    window = DeskWindow(device, actions)
    actions.read_ahead()
    try:
        window.run()
    finally:
        window.close()
        device.release()
        pygame.display.quit()
    return 0
