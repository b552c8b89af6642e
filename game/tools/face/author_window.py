"""``face`` alone: the authoring window. Drag a point on the circumplex, choose among proposals drawn on the real head,
lock regions, compare two, save as a named expression. What can be done is in author.py; this is only its surface.

Needs imgui-bundle (the `tools` extra).
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import pygame
from imgui_bundle import imgui

from game.app.play import need_display
from game.core import ASSETS, DIALOGUE, EMOTIONS
from game.face import Face, load_face
from game.render import Device, level_named
from game.tools.face.author import Author, Change
from game.tools.face.author_pad import PadWidget
from game.tools.face.gallery import Gallery
from game.tools.face.heads import HeadStudio
from game.tools.face.sheet import part_names, rank_colour
from game.tools.windows.imgui_backend import ImguiBackend
from game.tools.windows.style import FONT_SIZE, colour, load_fonts, set_style

__all__ = ["AuthorWindow", "open_author"]

HEAD = 360
IDLE_S = 0.25
FOCUS_FRAMES = 6
"""ImGui gives a text field the keys some frames after it was asked to; what is typed meanwhile waits this long."""
COMMAND_FRAMES = 2
"""ImGui takes in what is typed in a frame before it carries out a Ctrl key of the same one: what follows waits."""
_COMMAND = pygame.KMOD_CTRL | pygame.KMOD_META
_ARROWS = {pygame.K_LEFT: (-1, 0), pygame.K_RIGHT: (1, 0), pygame.K_UP: (0, 1), pygame.K_DOWN: (0, -1)}
_LOCKS = {pygame.K_e: "eyes", pygame.K_b: "eyebrows", pygame.K_m: "mouth", pygame.K_s: "skin"}
_RANKS = "1234567890-="
_HELP = (
    "arrows: move (shift: finer)   1 … = : take a proposal   D: different",
    "E B M S: lock   F1 F2: keep A, B   F3 F4: take A, B   Ctrl Z, Y, S",
)


class AuthorWindow:
    """Layout in reference pixels of 1280 × 720, scaled to the window."""

    def __init__(self, device: Device, author: Author) -> None:
        self.device, self.author = device, author
        self._backend = ImguiBackend(device.context)
        self._fonts = load_fonts()
        set_style()
        studio = HeadStudio(HEAD, context=device.context, level=level_named("high"))
        self._studio = studio
        self._gallery = Gallery(self._backend, studio, author.parts)
        self._pad = PadWidget(author)
        self._hovered: Face | None = None
        self._name = self._label = ""
        self._focus_name = False
        self._focus_frames = 0
        self.running = True
        self._k = 1.0

    # -- input -------------------------------------------------------------------------------------------------------

    def handle(self, event: pygame.event.Event) -> None:
        """One event of the window."""
        if event.type == pygame.QUIT:
            self.running = False
        elif event.type in {pygame.VIDEORESIZE, pygame.WINDOWSIZECHANGED}:
            self.device.resize(*pygame.display.get_window_size())
        else:
            ratio = self.device.size[0] / max(pygame.display.get_window_size()[0], 1)
            self._backend.feed(event, ratio)
            if event.type == pygame.KEYDOWN and not self._backend.typing:
                self._key(event)

    def _key(self, event: pygame.event.Event) -> None:
        author = self.author
        if event.mod & _COMMAND:
            shift = bool(event.mod & pygame.KMOD_SHIFT)
            if event.key == pygame.K_y or (event.key == pygame.K_z and shift):
                author.redo()
            elif event.key == pygame.K_z:
                author.undo()
            elif event.key == pygame.K_s:
                self._focus_name, self._focus_frames = True, FOCUS_FRAMES
        elif event.key in _ARROWS:
            author.nudge(*_ARROWS[event.key], fine=bool(event.mod & pygame.KMOD_SHIFT))
        elif event.key in _LOCKS:
            author.lock(_LOCKS[event.key])
        elif event.key == pygame.K_d:
            author.vary(not author.draft.diverse)
        elif event.key in (pygame.K_F1, pygame.K_F2):
            author.keep(event.key - pygame.K_F1)
        elif event.key in (pygame.K_F3, pygame.K_F4):
            author.recall(event.key - pygame.K_F3)
        elif event.unicode and event.unicode in _RANKS:
            author.choose(_RANKS.index(event.unicode))

    # -- drawing -----------------------------------------------------------------------------------------------------

    def draw(self, elapsed_s: float) -> bool:
        """One frame; True where pictures are still to come."""
        waiting = self._gallery.work()
        size = self.device.size
        screen = self.device.context.screen
        screen.viewport = (0, 0, *size)
        screen.use()
        screen.clear(0.984, 0.955, 0.89, 1.0)
        self._k = min(size[0] / 1280.0, size[1] / 720.0)
        self._backend.begin(size, elapsed_s)
        imgui.set_next_window_pos(imgui.ImVec2(0, 0))
        imgui.set_next_window_size(imgui.ImVec2(*(float(v) for v in size)))
        flags = imgui.WindowFlags_
        imgui.begin("face", None, flags.no_decoration | flags.no_move | flags.no_background)
        imgui.push_font(self._fonts.body, FONT_SIZE * self._k)
        hovered, self._hovered = self._hovered, None
        self._left(hovered)
        self._proposals()
        self._compare()
        self._face()
        self._save()
        imgui.pop_font()
        imgui.end()
        self._backend.end(size)
        pygame.display.flip()
        return waiting

    def _at(self, x: float, y: float) -> imgui.ImVec2:
        return imgui.ImVec2(x * self._k, y * self._k)

    def _go(self, x: float, y: float) -> None:
        imgui.set_cursor_screen_pos(self._at(x, y))

    def _text(
        self, x: float, y: float, text: str, name: str = "ink", size: float = FONT_SIZE, bold: bool = False
    ) -> None:
        imgui.push_font(self._fonts.bold if bold else self._fonts.body, size * self._k)
        imgui.get_window_draw_list().add_text(self._at(x, y), colour(name), text)
        imgui.pop_font()

    def _picture(
        self, face: Face, x: float, y: float, size: float, edge: int, width: float = 2.0, change: Change = ()
    ) -> None:
        """A face in a frame, or an empty place until it is drawn."""
        lines = imgui.get_window_draw_list()
        low, high = self._at(x, y), self._at(x + size, y + size)
        picture = self._gallery.get(face, change)
        if picture is None:
            lines.add_rect_filled(low, high, colour("blank"))
        else:
            lines.add_image(picture.ref, low, high)
        lines.add_rect(low, high, edge, rounding=3 * self._k, thickness=width * self._k)

    def _left(self, hovered: Face | None) -> None:
        author, draft = self.author, self.author.draft
        self._text(14, 10, "What should the face say?", bold=True, size=24)
        self._pad.draw(14, 44, 392, self._k, self._fonts, hovered)
        for i, name in enumerate(EMOTIONS):
            self._go(14 + i * 56.3, 444)
            imgui.push_font(self._fonts.body, 16.5 * self._k)
            named = draft.emotion == i
            if named:
                imgui.push_style_color(imgui.Col_.button, colour("chosen"))
            if imgui.button(name, self._at(54, 26)):
                author.go_to(i)
            if named:
                imgui.pop_style_color()
            imgui.pop_font()
        self._go(14, 482)
        changed, diverse = imgui.checkbox("different from each other", draft.diverse)
        if changed:
            author.vary(diverse)
        self._go(14, 518)
        imgui.set_next_item_width(150 * self._k)
        changed, spread = imgui.slider_float("wanted spread", draft.spread, 0.0, 0.6, "%.2f")
        if changed:
            author.slide(spread)
        if imgui.is_item_deactivated():
            author.drop()
        for i, (label, able, act) in enumerate(
            (("Undo", author.can_undo, author.undo), ("Redo", author.can_redo, author.redo))
        ):
            self._go(250 + i * 80, 480)
            imgui.begin_disabled(not able)
            if imgui.button(label, self._at(74, 30)):
                act()
            imgui.end_disabled()
        valence, arousal = draft.point
        self._text(14, 560, f"valence {valence:+.2f}    arousal {arousal:+.2f}", bold=True)
        self._text(14, 590, f"{len(author.asset.search)} faces; parts: {author.parts.ratings}"[:60], "faint", 16)
        for i, row in enumerate(_HELP):
            self._text(14, 672 + i * 19, row, "faint", 16)

    def _proposals(self) -> None:
        author = self.author
        self._text(420, 10, "Proposals", bold=True, size=24)
        for rank, found in enumerate(author.found):
            x, y = 420 + (rank % 4) * 122, 44 + (rank // 4) * 150
            chosen = found.face == author.draft.face
            self._go(x, y)
            if imgui.invisible_button(f"proposal{rank}", self._at(116, 142)):
                author.choose(rank)
            over = imgui.is_item_hovered()
            if over:
                self._hovered = found.face
                imgui.set_tooltip("\n".join(part_names(author.parts, found.face)))
            edge = imgui.get_color_u32(imgui.ImVec4(*rank_colour(rank)))
            self._picture(found.face, x, y, 116, edge, 5.0 if chosen else 4.0 if over else 2.0)
            mean = found.proposal.mean
            self._text(x + 1, y + 118, f"{_RANKS[rank]}", size=19, bold=True)
            self._text(x + 18, y + 119, f"{mean[0]:+.2f} {mean[1]:+.2f}", "faint", 16)

    def _compare(self) -> None:
        author = self.author
        self._text(420, 500, "Compare", bold=True, size=24)
        for slot, letter in enumerate("AB"):
            x = 420 + slot * 244
            face = author.draft.kept[slot]
            if face is None:
                lines = imgui.get_window_draw_list()
                lines.add_rect(self._at(x, 530), self._at(x + 150, 680), colour("line"), 4 * self._k, 1.5 * self._k)
                self._text(x + 66, 588, letter, "faint", 30, True)
            else:
                self._go(x, 530)
                imgui.dummy(self._at(150, 150))
                if imgui.is_item_hovered():
                    self._hovered = face
                self._picture(
                    face, x, 530, 150, colour("red" if slot == 0 else "blue"), 3.0, author.draft.kept_change[slot]
                )
                mean, _ = author.gaussian(face)
                numbers = f"{letter}  {mean[0]:+.2f} {mean[1]:+.2f}   log p {author.density(face):+.2f}"
                self._text(x, 684, numbers, "ink", 18)
            self._go(x + 156, 530)
            if imgui.button(f"Keep\nas {letter}", self._at(74, 50)):
                author.keep(slot)
            self._go(x + 156, 586)
            imgui.begin_disabled(face is None)
            if imgui.button(f"Take {letter}", self._at(74, 34)):
                author.recall(slot)
            imgui.end_disabled()

    def _face(self) -> None:
        author, face = self.author, self.author.draft.face
        self._text(926, 10, "The face", bold=True, size=24)
        self._picture(face, 926, 44, 340, colour("line"), 2.5, author.draft.change)
        mean, _ = author.gaussian(face)
        self._text(926, 390, f"says {mean[0]:+.2f} {mean[1]:+.2f}    log p {author.density(face):+.2f}", bold=True)
        for i, (region, part) in enumerate(zip(author.parts.regions, face.parts, strict=True)):
            y = 418 + i * 36
            self._text(926, y + 4, region.name, size=18)
            self._go(1000, y)
            imgui.set_next_item_width(190 * self._k)
            labels = [str(label.get("en", name)) for label, name in zip(region.labels, region.names, strict=True)]
            changed, number = imgui.combo(f"##{region.name}", region.index(part), labels, 16)
            if changed:
                author.put(region.name, region.names[number])
            self._go(1200, y)
            changed, _ = imgui.checkbox(f"lock##{region.name}", region.name in author.draft.locked)
            if changed:
                author.lock(region.name)

    def _save(self) -> None:
        author = self.author
        self._text(926, 570, "Name it for the dialogue", bold=True)
        self._go(926, 594)
        imgui.set_next_item_width(150 * self._k)
        if self._focus_name:
            imgui.set_keyboard_focus_here()
            self._focus_name = False
        flags = imgui.InputTextFlags_
        entered, self._name = imgui.input_text_with_hint("##name", "name", self._name, flags.enter_returns_true)
        self._go(1082, 594)
        imgui.set_next_item_width(112 * self._k)
        again, self._label = imgui.input_text_with_hint("##label", "label", self._label, flags.enter_returns_true)
        self._go(1200, 593)
        pressed = imgui.button("Save", self._at(66, 32))
        if (entered or again or pressed) and author.save(self._name, self._label):
            self._name = self._label = ""
        self._go(926, 634)
        imgui.set_next_item_width(268 * self._k)
        named = author.faces_named()
        if imgui.begin_combo("##named", f"open one of {len(named)}"):
            for name, face in named.items():
                if imgui.selectable(name, author.expression(name) == (author.draft.face, author.draft.change))[0]:
                    author.open(name)
                if imgui.is_item_hovered():
                    self._hovered = face
            imgui.end_combo()
        self._message()

    def _message(self) -> None:
        text = self.author.message
        if text:
            imgui.push_font(self._fonts.body, 16.5 * self._k)
            self._go(926, 670)
            imgui.push_text_wrap_pos(1270 * self._k)
            name = "red" if self.author.failed else "green"
            imgui.push_style_color(imgui.Col_.text, colour(name))
            imgui.text_wrapped(text)
            imgui.pop_style_color()
            imgui.pop_text_wrap_pos()
            imgui.pop_font()

    def run(self) -> None:
        """Until the window is closed; draws while something moves, rests otherwise."""
        pygame.key.start_text_input()
        pygame.key.set_repeat(350, 40)
        before = time.perf_counter()
        busy, hold = 3, 0
        waiting: list[pygame.event.Event] = []
        while self.running:
            waiting += pygame.event.get()
            if not waiting and busy <= 0:
                waiting = [pygame.event.wait(int(IDLE_S * 1000))]
            # ImGui needs a few frames to settle after every event: hover, focus, fading.
            busy = 4 if waiting else busy - 1
            self._focus_frames = 0 if self._backend.typing else max(self._focus_frames - 1, 0)
            hold = max(hold - 1, 0)
            while waiting and not self._focus_frames and not hold:
                event = waiting.pop(0)
                self.handle(event)
                if event.type == pygame.KEYDOWN and event.mod & _COMMAND:
                    hold = COMMAND_FRAMES
            now = time.perf_counter()
            if self.draw(now - before):
                busy = max(busy, 2)
            before = now

    def close(self) -> None:
        """Give the GL objects back."""
        self._gallery.release()
        self._backend.release()
        self._studio.close()


def open_author(args: argparse.Namespace) -> int:
    """Open the window; returns when it is closed."""
    folder: Path = args.face_folder
    save_to = args.save_to or folder / "expressions.yaml"
    # The game's own expressions are also listed where dialogue lines look for them.
    shipped = save_to.resolve() == (ASSETS / "face" / "expressions.yaml").resolve()
    author = Author(load_face(folder), save_to, DIALOGUE / "faces.yaml" if shipped else None)
    need_display()
    device = Device.window(args.size[0], args.size[1], "Faces")
    window = AuthorWindow(device, author)
    try:
        window.run()
    finally:
        window.close()
        device.release()
        pygame.display.quit()
    return 0
