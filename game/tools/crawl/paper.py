"""A HUD that measures instead of drawing: where every box and every text would be, and what is wrong with that.

Faults: ``offscreen``, text or a button beyond the picture; ``glyph``, a character no font has; ``overflow``, a text
that runs out of the panel it begins on, or a paragraph higher than its room; ``overlap``, two texts on one another.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from game.app.ui import INK, Canvas, Colour, Rect
from game.render import FontSet

__all__ = ["Box", "Fault", "PaperCanvas", "PaperHud"]

SLACK = 2.0
"""Design pixels by which a text may pass its panel: nobody sees that."""
OPAQUE = 0.8
"""A panel hides what lies under it from this alpha on."""
OVERLAP = 0.25
"""Texts that share more of the smaller one's area than this cannot both be read."""


@dataclass(frozen=True)
class Box:
    """A rectangle in design pixels; text: what stands in it, "" for a panel."""

    x: float
    y: float
    w: float
    h: float
    text: str = ""
    size: float = 0.0
    alpha: float = 1.0

    @property
    def right(self) -> float:
        return self.x + self.w

    @property
    def bottom(self) -> float:
        return self.y + self.h

    def shared(self, other: Box) -> float:
        """Area of what both cover."""
        wide = min(self.right, other.right) - max(self.x, other.x)
        high = min(self.bottom, other.bottom) - max(self.y, other.y)
        return max(wide, 0.0) * max(high, 0.0)

    def core(self) -> Box:
        """Without the room above and below the letters."""
        return Box(self.x, self.y + 0.28 * self.h, self.w, 0.5 * self.h, self.text, self.size)


@dataclass(frozen=True)
class Fault:
    """Something wrong with the picture. box: where."""

    kind: str
    text: str
    detail: str
    box: Box


class PaperHud:
    """Takes what a ``Hud`` takes; keeps boxes and faults."""

    def __init__(self, fonts: FontSet, size: tuple[int, int] = (1280, 720)) -> None:
        self._fonts = fonts
        self.scale = size[1] / 720.0
        self.width, self.height = size[0] / self.scale, 720.0
        self.panels: list[Box] = []
        self.texts: list[Box] = []
        self.faults: list[Fault] = []

    def size_px(self, size: float) -> int:
        """Device pixels of a text size, as the real one has it."""
        return max(6, round(size * self.scale))

    def measure(self, text: str, size: float = 24.0, role: str = "body") -> tuple[float, float]:
        """Width and height of one line."""
        px = self.size_px(size)
        return self._fonts.width(text, role, px) / self.scale, self._fonts.height(role, px) / self.scale

    def wrap(self, text: str, width: float, size: float = 24.0, role: str = "body") -> list[str]:
        """The text in lines of at most ``width``."""
        return self._fonts.wrap(text, role, self.size_px(size), width * self.scale)

    def rect(self, x: float, y: float, w: float, h: float, *, fill: Colour, **look: Any) -> None:
        """A panel; an opaque one hides the texts under it."""
        box = Box(x, y, w, h, alpha=fill[3])
        if fill[3] >= OPAQUE:
            self.texts = [text for text in self.texts if text.shared(box) < 0.98 * text.w * text.h]
        self.panels.append(box)

    def text(
        self, text: str, x: float, y: float, *, size: float = 24.0, role: str = "body", align: float = 0.0,
        shown: int | None = None, **look: Any,
    ) -> float:  # fmt: skip
        """A line of text; its faults are noted."""
        if not text.strip() or shown == 0:
            return self.measure(text, size, role)[0]
        width, height = self.measure(text, size, role)
        box = Box(x - align * width, y, width, height, text, size)
        self._judge(box, role)
        self.texts.append(box)
        return width

    def glow(self, *place: Any, **look: Any) -> None:
        """Light has no edge to measure."""

    def circle(self, x: float, y: float, radius: float, **look: Any) -> None:
        """A mark."""

    def line(self, *place: Any, **look: Any) -> None:
        """A line."""

    def polyline(self, *place: Any, **look: Any) -> None:
        """Lines."""

    def image(self, *place: Any, **look: Any) -> None:
        """A picture."""

    def _judge(self, box: Box, role: str) -> None:
        missing = self._fonts.missing(box.text, role)
        if missing:
            self._fault("glyph", box, f"no glyph for {missing!r}")
        core = box.core()
        if box.x < -SLACK or box.right > self.width + SLACK or core.y < 0 or core.bottom > self.height:
            self._fault("offscreen", box, f"x {box.x:.0f} to {box.right:.0f}, y {box.y:.0f} to {box.bottom:.0f}")
            return
        under = self._panel_under(core)
        if under is not None:
            over = max(box.right - under.right, under.x - box.x, core.bottom - under.bottom)
            if over > SLACK:
                self._fault("overflow", box, f"{over:.0f} px out of its panel of {under.w:.0f} x {under.h:.0f}")
        for other in self.texts:
            theirs = other.core()
            small = min(core.w * core.h, theirs.w * theirs.h)
            if core.shared(theirs) > OVERLAP * small:
                self._fault("overlap", box, f"lies on {other.text[:60]!r}")
                return

    def _panel_under(self, core: Box) -> Box | None:
        """The last panel under a text's begin, middle or end that is large enough to be meant for it."""
        y = core.y + core.h / 2
        for panel in reversed(self.panels):
            if not panel.y <= y <= panel.bottom or panel.h < core.h or panel.w <= 24:
                continue
            if any(panel.x <= core.x + share * core.w <= panel.right for share in (0.0, 0.5, 1.0)):
                return panel
        return None

    def _fault(self, kind: str, box: Box, detail: str) -> None:
        self.faults.append(Fault(kind, box.text, detail, box))


class PaperCanvas(Canvas):
    """The canvas on paper: a paragraph that does not fit even at its smallest is a fault."""

    def __init__(self, hud: PaperHud, language: str, text_scale: float, contrast: bool = False) -> None:
        super().__init__(hud, language, text_scale, None, contrast)  # type: ignore[arg-type]
        self.paper = hud

    def paragraph(
        self, rect: Rect, text: str, size: float, colour: Colour = INK, *, shown: int | None = None,
        middle: bool = False,
    ) -> None:  # fmt: skip
        """As on screen, and measured."""
        smallest = 0.6
        rows: Sequence[str] = self.rows(text, rect.w, size * smallest)
        need = len(rows) * size * smallest * self.text_scale * 1.27
        if need > rect.h + 2:
            box = Box(rect.x, rect.y, rect.w, need, text, size * smallest)
            self.paper.faults.append(
                Fault("overflow", text, f"{len(rows)} rows, {need:.0f} px high in a room of {rect.h:.0f}", box)
            )
        super().paragraph(rect, text, size, colour, shown=shown, middle=middle)
