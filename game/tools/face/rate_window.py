"""``face rate``: the window around a sitting. A face on the left, the circumplex on the right, everything by mouse or
keys; nothing in here decides anything about ratings."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence

import moderngl
import numpy as np
import pygame

from game.app.arguments import avatar_of
from game.app.avatar import Avatar
from game.app.play import need_display
from game.app.ui import INK, PALETTE, Button, Buttons, Canvas, Rect, fade
from game.core import EMOTIONS, BadInput
from game.face import Face, FaceAsset, Parts, load_face
from game.render import Device, FontSet, Hud, level_named
from game.tools.face.avatar_ratings import expressions_to_rate, look_of
from game.tools.face.heads import HeadStudio
from game.tools.face.pad import Pad
from game.tools.face.ratings_file import RatingLog
from game.tools.face.sitting import Sitting, single_part_faces, whole_faces

__all__ = ["RateScreen", "run_rating"]

HEAD = 640
DEFAULT_WHOLE = 52
_ARROWS = {pygame.K_LEFT: (-1, 0), pygame.K_RIGHT: (1, 0), pygame.K_UP: (0, 1), pygame.K_DOWN: (0, -1)}
_CONFIRM = {pygame.K_RETURN, pygame.K_KP_ENTER, pygame.K_SPACE}


def faces_to_rate(args: argparse.Namespace, parts: Parts) -> list[Face]:
    """The faces that the command line asks for."""
    if args.parts:
        return single_part_faces(parts)
    if args.faces is not None:
        return whole_faces(parts, args.faces, args.seed)
    return single_part_faces(parts) + whole_faces(parts, DEFAULT_WHOLE, args.seed)


class RateScreen:
    """Layout and input of the rating window, in the 1280 × 720 reference pixels of the game's canvas."""

    def __init__(self, sitting: Sitting, clock: Callable[[], str]) -> None:
        self.sitting = sitting
        self.pad = Pad(716, 64, 500)
        self.running = True
        self._clock = clock
        self._dragging = False
        self._warned = False
        self._buttons = Buttons()

    def handle(self, event: pygame.event.Event, to_reference: Callable[[tuple[int, int]], tuple[float, float]]) -> bool:
        """One event. True where another face is to be shown: events behind it wait until it has been."""
        if event.type == pygame.QUIT:
            return self._leave()
        if event.type == pygame.KEYDOWN:
            return self._key(event)
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            at = to_reference(event.pos)
            pressed = next((b.id for b in self._buttons.buttons if b.enabled and b.rect.holds(at)), None)
            if pressed is not None:
                return self._press(pressed)
            if self.pad.rect.holds(at):
                self._dragging = True
                self.sitting.place(*self.pad.to_point(at))
        elif event.type == pygame.MOUSEMOTION:
            at = to_reference(event.pos)
            over = next((b.id for b in self._buttons.buttons if b.rect.holds(at)), "")
            self._buttons.focus = over
            if self._dragging:
                self.sitting.place(*self.pad.to_point(at))
        elif event.type == pygame.MOUSEBUTTONUP and event.button == 1 and self._dragging:
            self._dragging = False
            self.sitting.place(*self.pad.to_point(to_reference(event.pos)))
        return False

    def _key(self, event: pygame.event.Event) -> bool:
        command = event.mod & (pygame.KMOD_CTRL | pygame.KMOD_META)
        if event.key == pygame.K_ESCAPE:
            return self._leave()
        if event.key == pygame.K_BACKSPACE or (event.key == pygame.K_z and command):
            return self._press("undo")
        if event.key in _CONFIRM:
            return self._press("next")
        if event.key in _ARROWS:
            self.sitting.nudge(*_ARROWS[event.key], fine=bool(event.mod & pygame.KMOD_SHIFT))
        elif pygame.K_1 <= event.key <= pygame.K_7:
            self.sitting.call(event.key - pygame.K_1)
        elif pygame.K_KP_1 <= event.key <= pygame.K_KP_7:
            self.sitting.call(event.key - pygame.K_KP_1)
        return False

    def _press(self, button: str) -> bool:
        self._dragging = False
        if button == "undo":
            return self.sitting.undo()
        if button == "next":
            return self.sitting.confirm(self._clock())
        self.sitting.call(EMOTIONS.index(button))
        return False

    def _leave(self) -> bool:
        """Close; a point that has been set is a rating and is kept. Where it cannot be, the first try only says so."""
        unsaved = self.sitting.point is not None and not self.sitting.confirm(self._clock())
        self.running = unsaved and not self._warned
        self._warned = unsaved
        return True

    def draw(self, canvas: Canvas, head: moderngl.Texture | None) -> None:
        """Everything but the background."""
        sitting = self.sitting
        k = canvas.hud.width / canvas.width
        canvas.panel(Rect(37, 37, HEAD + 6, HEAD + 6), PALETTE["line"], radius=10)
        if head is not None:
            canvas.hud.image(head, 40 * k, 40 * k, HEAD * k, HEAD * k)
        else:
            canvas.panel(Rect(40, 40, HEAD, HEAD), PALETTE["paper_warm"], radius=8)
            canvas.text(360, 300, "All faces are rated.", 40, INK, font="bold", align="center")
            canvas.text(360, 360, "Thank you! Everything is saved.", 26, INK, align="center")
        title = "How does this face feel?"
        canvas.text(716, 20, title, 26, INK, font="bold")
        canvas.text(1216, 26, f"{sitting.done} of {sitting.total}", 20, PALETTE["faint"], align="right")
        self.pad.draw(canvas, text=18)
        if sitting.point is not None:
            self.pad.cross(canvas, *sitting.point, radius=13)
        self._lay()
        self._buttons.draw(canvas, self._paint)
        canvas.bar(Rect(716, 572, 500, 6), sitting.done / max(sitting.total, 1), PALETTE["teal"], PALETTE["paper_warm"])
        keys = "Click or arrows: place it.  1–7: name it, or not.  Enter: next.  Backspace: undo."
        note = sitting.message or (keys if sitting.face is not None else "Close the window, or Backspace: undo.")
        size = 16.0
        while canvas.measure(note, size) > 550 and size > 10:
            size -= 1
        canvas.text(716, 690, note, size, PALETTE["red"] if sitting.message else PALETTE["faint"])

    def _lay(self) -> None:
        active = self.sitting.face is not None
        names = [
            Button(name, name, Rect(716 + i * 72, 588, 68, 38), enabled=active, key=str(i + 1), size=15)
            for i, name in enumerate(EMOTIONS)
        ]
        ready = active and self.sitting.point is not None
        self._buttons.buttons = [
            *names,
            Button("undo", "Undo", Rect(716, 636, 150, 46), size=20),
            Button("next", "Next face", Rect(880, 636, 336, 46), enabled=ready, size=22),
        ]

    def _paint(self, canvas: Canvas, button: Button, focused: bool) -> None:
        chosen = button.id == self.sitting.name
        strong = chosen or (button.id == "next" and button.enabled)
        alpha = 1.0 if button.enabled else 0.45
        fill = PALETTE["teal"] if strong else PALETTE["paper_warm"] if focused else PALETTE["white"]
        canvas.panel(button.rect, fade(fill, alpha), radius=10, border=2, border_colour=fade(PALETTE["line"], alpha))
        colour = PALETTE["white"] if strong else INK
        middle = button.rect.x + button.rect.w / 2
        top = button.rect.y + (button.rect.h - button.size * 1.27) / 2
        if button.key:
            canvas.text(button.rect.x + 5, button.rect.y + 1, button.key, 11, fade(colour, 0.7 * alpha))
        canvas.text(middle, top, button.label, button.size, fade(colour, alpha), align="center")


def _now() -> str:
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())


class _RateWindow:
    """The pygame window: events in, one picture out, only when something has changed."""

    def __init__(self, device: Device, asset: FaceAsset, screen: RateScreen, avatar: Avatar | None = None) -> None:
        self.device, self.screen, self._asset, self._avatar = device, screen, asset, avatar
        self._studio = HeadStudio(HEAD, context=device.context, level=level_named("high"), avatar=avatar)
        self._hud = Hud(device, FontSet.for_language("en"))
        self._head: moderngl.Texture | None = None
        self._shown: Face | str | None = None

    def draw(self) -> None:
        """Show the state of things."""
        face = self.screen.sitting.face
        if face != self._shown:
            self._shown = face
            if self._head is not None:
                self._head.release()
            self._head = None if face is None else self._picture(face)
        screen = self.device.context.screen
        screen.viewport = (0, 0, *self.device.size)
        screen.use()
        screen.clear(0.984, 0.955, 0.89, 1.0)
        self._hud.begin(self.device.size)
        self.screen.draw(Canvas(self._hud), self._head)
        self._hud.end()
        pygame.display.flip()

    def _picture(self, face: Face | str) -> moderngl.Texture:
        parts = self._asset.model.parts
        if isinstance(face, str):
            assert self._avatar is not None, "only an avatar has named expressions"
            pixels = self._studio.draw_look(look_of(self._avatar, face))
        else:
            pixels = self._studio.draw(parts.params(parts.numbers(face)))
        opaque = np.dstack([pixels, np.full(pixels.shape[:2], 255, np.uint8)])
        return self.device.context.texture(pixels.shape[1::-1], 4, np.ascontiguousarray(opaque).tobytes())

    def to_reference(self, at: tuple[int, int]) -> tuple[float, float]:
        """Window pixels to reference pixels."""
        shown = pygame.display.get_window_size()
        ratio = self.device.size[0] / max(shown[0], 1)
        scale = min(self.device.size[0] / 1280.0, self.device.size[1] / 720.0)
        return at[0] * ratio / scale, at[1] * ratio / scale

    def run(self) -> None:
        """Until the window is closed. Clicks made while a face was being drawn wait for it in their order."""
        self.draw()
        waiting: list[pygame.event.Event] = []
        while self.screen.running:
            waiting += pygame.event.get() or [pygame.event.wait(200)]
            while waiting and self.screen.running:
                event = waiting.pop(0)
                if event.type in {pygame.VIDEORESIZE, pygame.WINDOWSIZECHANGED}:
                    self.device.resize(*pygame.display.get_window_size())
                elif self.screen.handle(event, self.to_reference):
                    break
            if self.screen.running:
                self.draw()

    def close(self) -> None:
        if self._head is not None:
            self._head.release()
        self._hud.release()
        self._studio.close()


def run_rating(args: argparse.Namespace) -> int:
    """Open the window and rate until all faces are done or it is closed."""
    asset = load_face(args.face_folder)
    avatar = avatar_of(args)
    faces: Sequence[Face | str]
    if avatar is None:
        faces = faces_to_rate(args, asset.model.parts)
    elif args.parts or args.faces is not None:
        raise BadInput("--avatar", expected="neither --parts nor --faces: all its expressions are rated", seen="both")
    else:
        faces = expressions_to_rate(avatar)
    need_display()
    known = asset.model.parts if avatar is None else tuple(avatar.expressions)
    sitting = Sitting(RatingLog(args.out, known), faces, args.rater, args.seed)
    device = Device.window(args.size[0], args.size[1], "How does this face feel?")
    window = _RateWindow(device, asset, RateScreen(sitting, _now), avatar)
    try:
        window.run()
    finally:
        window.close()
        device.release()
        pygame.display.quit()
    print(f"{sitting.done} of {sitting.total} faces rated by {sitting.rater} in {args.out}")
    return 0
