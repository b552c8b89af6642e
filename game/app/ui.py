"""The interface's own small toolkit: a canvas in reference pixels, the palette, buttons that mouse and keys share.

All layouts are written for 1280 × 720 reference pixels. A window of another shape gives a larger canvas in one
direction; ``Canvas.scale`` maps reference pixels to device pixels, so text and lines stay crisp at any size.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from game.app.gallery import Gallery
from game.app.input import Action
from game.render import Hud

__all__ = ["INK", "PALETTE", "Button", "Buttons", "Canvas", "Colour", "Rect", "fade", "hex_colour", "paint_button"]

Colour = tuple[float, float, float, float]


def hex_colour(text: str, alpha: float = 1.0) -> Colour:
    """``RRGGBB`` and an alpha in [0, 1]."""
    return (int(text[0:2], 16) / 255, int(text[2:4], 16) / 255, int(text[4:6], 16) / 255, alpha)


PALETTE: dict[str, Colour] = {
    "paper": hex_colour("FFF6E4", 0.95),
    "paper_warm": hex_colour("FFE9BF", 0.98),
    "line": hex_colour("6E4034"),
    "red": hex_colour("D23F32"),
    "teal": hex_colour("2A7B78"),
    "indigo": hex_colour("34608A"),
    "gold": hex_colour("E0982F"),
    "shade": hex_colour("2B1630", 0.62),
    "faint": hex_colour("7A5C4F"),
    "white": hex_colour("FFFDF6"),
}
INK: Colour = hex_colour("3B1A1C")

FEELING_COLOURS: dict[str, Colour] = {
    "anger": hex_colour("D8402F"),
    "fear": hex_colour("7A5BA8"),
    "joy": hex_colour("EBA52C"),
    "sadness": hex_colour("3F74B5"),
    "disgust": hex_colour("6B8F3A"),
    "surprise": hex_colour("E0709A"),
    "neutral": hex_colour("9A8B80"),
}


def fade(colour: Colour, alpha: float) -> Colour:
    """The same colour with its alpha multiplied."""
    return (colour[0], colour[1], colour[2], colour[3] * alpha)


@dataclass(frozen=True)
class Rect:
    """x, y, width, height in reference pixels, y downward."""

    x: float
    y: float
    w: float
    h: float

    @property
    def middle(self) -> tuple[float, float]:
        """The centre."""
        return self.x + self.w / 2, self.y + self.h / 2

    def holds(self, at: tuple[float, float] | None) -> bool:
        """Whether a point lies inside."""
        return at is not None and self.x <= at[0] < self.x + self.w and self.y <= at[1] < self.y + self.h


LABEL_MOST = 1.2
"""Labels in fixed places grow so far; what is to be read (lines, choices, letters) grows as far as the player likes."""


class Canvas:
    """Drawing in reference pixels on the renderer's HUD, never narrower than 1280 nor lower than 720 of them.

    ``text_scale`` enlarges text only (accessibility); ``contrast`` makes sheets opaque, edges firm and text black or
    white. ``scale``: device pixels per reference pixel.
    """

    def __init__(
        self,
        hud: Hud,
        language: str = "en",
        text_scale: float = 1.0,
        pictures: Gallery | None = None,
        contrast: bool = False,
    ) -> None:
        self.contrast = contrast
        self.hud = hud
        self.pictures = pictures
        self._k = min(1.0, hud.width / 1280.0)
        self.width = hud.width / self._k
        self.height = hud.height / self._k
        self.scale = hud.scale * self._k
        self.language = language
        self.text_scale = text_scale

    def to_reference(self, at_px: tuple[float, float]) -> tuple[float, float]:
        """Device pixels to reference pixels."""
        return at_px[0] / self.scale, at_px[1] / self.scale

    def panel(
        self,
        rect: Rect,
        fill: Colour = PALETTE["paper"],
        *,
        radius: float = 16.0,
        border: float = 0.0,
        border_colour: Colour = PALETTE["line"],
        shadow: float = 0.0,
    ) -> None:
        """A rounded rectangle, perhaps with a border and a soft shadow."""
        k = self._k
        if self.contrast:
            fill, border_colour = _firm(fill), _firm(border_colour)
        self.hud.rect(
            rect.x * k, rect.y * k, rect.w * k, rect.h * k,
            fill=fill, radius=min(radius, rect.h / 2) * k, border=border * k, edge=border_colour, shadow=shadow * k,
        )  # fmt: skip

    def gradient(self, rect: Rect, top: Colour, bottom: Colour) -> None:
        """A box that runs from one colour to another."""
        k = self._k
        self.hud.rect(rect.x * k, rect.y * k, rect.w * k, rect.h * k, fill=top, fill_bottom=bottom)

    def text(
        self,
        x: float,
        y: float,
        text: str,
        size: float,
        colour: Colour = INK,
        *,
        font: str = "body",
        align: str = "left",
        shown: int | None = None,
        whole: bool = False,
    ) -> float:
        """One row of text with its top at y; returns its width. ``shown``: only so many characters (typing).

        Labels in fixed places grow with ``text_scale`` up to LABEL_MOST only; ``whole``: part of a text, all the way.
        """
        k = self._k
        at = {"left": 0.0, "center": 0.5, "right": 1.0}[align]
        size *= self._scale(whole) * k
        if self.contrast:
            colour = _black_or_white(colour)
        return self.hud.text(text, x * k, y * k, size=size, colour=colour, role=font, align=at, shown=shown) / k

    def _scale(self, whole: bool) -> float:
        return self.text_scale if whole else min(self.text_scale, LABEL_MOST)

    def measure(self, text: str, size: float, font: str = "body") -> float:
        """Width of a label in reference pixels."""
        return self.hud.measure(text, size * self._scale(False) * self._k, font)[0] / self._k

    def rows(self, text: str, width: float, size: float, font: str = "body") -> list[str]:
        """The text broken to a width."""
        return self.hud.wrap(text, width * self._k, size * self.text_scale * self._k, font)

    def fitted(self, text: str, width: float, height: float, size: float) -> tuple[list[str], float, float]:
        """The text broken and shrunk until it fits: its rows, their size, and from one row to the next."""
        for shrink in (1.0, 0.92, 0.84, 0.76, 0.68, 0.6):
            rows = self.rows(text, width, size * shrink)
            step = size * shrink * self.text_scale * 1.27
            if len(rows) * step <= height + 2:
                break
        return rows, size * shrink, step

    def paragraph(
        self,
        rect: Rect,
        text: str,
        size: float,
        colour: Colour = INK,
        *,
        shown: int | None = None,
        middle: bool = False,
    ) -> None:
        """Wrapped text inside a rectangle, shrunk until it fits. ``shown``: only so many characters (typing);
        ``middle``: centred from top to bottom."""
        rows, size, step = self.fitted(text, rect.w, rect.h, size)
        y = rect.y + max((rect.h - len(rows) * step) / 2, 0.0) if middle else rect.y
        left = shown
        for i, row in enumerate(rows):
            if left is not None and left <= 0:
                return
            self.text(rect.x, y + i * step, row, size, colour, shown=left, whole=True)
            left = None if left is None else left - len(row) - 1

    def lines(self, points: Sequence[tuple[float, float]], width: float, colour: Colour) -> None:
        """An antialiased polyline."""
        k = self._k
        self.hud.polyline([(x * k, y * k) for x, y in points], colour, width * k)

    def dot(self, x: float, y: float, radius: float, colour: Colour) -> None:
        """A filled circle."""
        k = self._k
        self.hud.circle(x * k, y * k, radius * k, fill=colour)

    def picture(self, name: str, rect: Rect, *, alpha: float = 1.0, cover: bool = False) -> bool:
        """A picture of the gallery; ``cover`` cuts it to the rectangle's shape. False where there is none."""
        found = self.pictures.get(name) if self.pictures is not None else None
        if found is None:
            return False
        k, piece = self._k, (0.0, 0.0, 1.0, 1.0)
        if cover:
            own, wanted = found.width / found.height, rect.w / rect.h
            u, v = min(wanted / own, 1.0), min(own / wanted, 1.0)
            piece = ((1 - u) / 2, (1 - v) / 2, u, v)
        self.hud.image(found, rect.x * k, rect.y * k, rect.w * k, rect.h * k, piece=piece, tint=(1.0, 1.0, 1.0, alpha))
        return True

    def bar(self, rect: Rect, share: float, colour: Colour, back: Colour) -> None:
        """A horizontal bar filled to a share in [0, 1]."""
        self.panel(rect, back, radius=rect.h / 2)
        if share > 0.004:
            self.panel(Rect(rect.x, rect.y, max(rect.w * min(share, 1.0), rect.h), rect.h), colour, radius=rect.h / 2)


def _brightness(colour: Colour) -> float:
    return 0.30 * colour[0] + 0.59 * colour[1] + 0.11 * colour[2]


def _firm(colour: Colour) -> Colour:
    """What is more than a veil becomes opaque, and light or dark enough for black or white text on it."""
    if colour[3] < 0.3:
        return colour
    light = _brightness(colour)
    if light > 0.75:
        return (1.0, 1.0, 1.0, 1.0)
    k = min(1.0, 0.30 / max(light, 1e-6))
    return (colour[0] * k, colour[1] * k, colour[2] * k, 1.0)


def _black_or_white(colour: Colour) -> Colour:
    return (1.0, 1.0, 1.0, colour[3]) if _brightness(colour) > 0.6 else (0.0, 0.0, 0.0, colour[3])


@dataclass(frozen=True)
class Button:
    """Something to press. ``key``: the key that presses it at once; ``badge``: what stands in its round mark."""

    id: str
    label: str
    rect: Rect
    enabled: bool = True
    key: str = ""
    badge: str = ""
    note: str = ""
    size: float = 19.0


_WAYS = {"left": (-1, 0), "right": (1, 0), "up": (0, -1), "down": (0, 1)}


@dataclass
class Buttons:
    """A group of buttons with one focus, moved by arrows and by the mouse. Rebuilt by its screen every frame.

    across: left and right move the focus too, to what lies there."""

    focus: str = ""
    across: bool = False
    buttons: list[Button] = field(default_factory=list)
    mouse: tuple[float, float] | None = None

    def lay(self, buttons: list[Button]) -> None:
        """Take this frame's buttons; a focus that is gone moves to the first that can be pressed."""
        self.buttons = buttons
        if self.focus not in {b.id for b in buttons if b.enabled}:
            self.focus = next((b.id for b in buttons if b.enabled), "")

    def handle(self, action: Action) -> str | None:
        """The id of the button this action presses, if any; moves the focus on the way."""
        able = [b for b in self.buttons if b.enabled]
        if action.kind == "pointer":
            self.mouse = action.at
            for button in able:
                if button.rect.holds(action.at):
                    self.focus = button.id
        elif action.kind == "click":
            self.mouse = action.at
            return next((b.id for b in able if b.rect.holds(action.at)), None)
        elif self.across and action.kind in _WAYS and able:
            self.focus = self._toward(able, *_WAYS[action.kind])
        elif action.kind in {"up", "down"} and able:
            at = next((i for i, b in enumerate(able) if b.id == self.focus), 0)
            self.focus = able[(at + (1 if action.kind == "down" else -1)) % len(able)].id
        elif action.kind == "confirm":
            return self.focus or None
        elif action.kind == "key":
            return next((b.id for b in able if b.key == action.key), None)
        return None

    def _toward(self, able: list[Button], dx: int, dy: int) -> str:
        """The nearest button in a direction, else the one that has the focus."""
        here = next((b for b in able if b.id == self.focus), able[0])
        x, y = here.rect.middle
        best, nearest = here.id, float("inf")
        for button in able:
            bx, by = button.rect.middle
            ahead, aside = (bx - x) * dx + (by - y) * dy, abs((bx - x) * dy) + abs((by - y) * dx)
            if ahead > 4 and ahead + 2 * aside < nearest:
                best, nearest = button.id, ahead + 2 * aside
        return best

    def draw(self, canvas: Canvas, paint: Callable[[Canvas, Button, bool], None] | None = None) -> None:
        """Draw them all, the focused one raised."""
        for button in self.buttons:
            (paint or paint_button)(canvas, button, button.id == self.focus)


def paint_button(canvas: Canvas, button: Button, focused: bool) -> None:
    """A button as most are: paper, raised where it has the focus."""
    rect, alpha = button.rect, 1.0 if button.enabled else 0.55
    if focused and canvas.contrast:  # a firm double ring: the warm fill is gone
        canvas.panel(Rect(rect.x - 6, rect.y - 6, rect.w + 12, rect.h + 12), (0.0, 0.0, 0.0, 1.0), radius=18)
        canvas.panel(Rect(rect.x - 3, rect.y - 3, rect.w + 6, rect.h + 6), (1.0, 1.0, 0.0, 1.0), radius=16)
    fill = PALETTE["paper_warm"] if focused else PALETTE["paper"]
    edge = PALETTE["red"] if focused else PALETTE["line"]
    canvas.panel(
        rect, fade(fill, alpha), radius=14, border=3 if focused else 2, border_colour=fade(edge, alpha), shadow=8
    )
    left = rect.x + 16
    if button.badge:
        colour = PALETTE["red"] if focused else PALETTE["teal"]
        canvas.dot(rect.x + 24, rect.y + rect.h / 2, 13, fade(colour, alpha))
        canvas.text(
            rect.x + 24, rect.y + rect.h / 2 - 10, button.badge, 15, PALETTE["white"], font="bold", align="center"
        )
        left = rect.x + 48
    room = Rect(left, rect.y + 8, rect.x + rect.w - 14 - left, rect.h - 14 - (18 if button.note else 0))
    if button.badge:
        canvas.paragraph(room, button.label, button.size, fade(INK, alpha), middle=True)
    else:
        size = button.size
        while canvas.measure(button.label, size) > rect.w - 24 and size > 10:
            size -= 1
        top = rect.y + (rect.h - size * min(canvas.text_scale, LABEL_MOST) * 1.27) / 2
        canvas.text(rect.x + rect.w / 2, top, button.label, size, fade(INK, alpha), align="center")
    if button.note:
        canvas.text(left, rect.y + rect.h - 24, button.note, 14, fade(PALETTE["faint"], alpha))
