"""A HUD that draws what it is told, notes every text it draws, and can leave the letters out."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from game.app.ui import Colour
from game.render import Hud
from game.tools.crawl.paper import OPAQUE, Box

__all__ = ["Letters", "ProbeHud"]


@dataclass(frozen=True)
class Letters:
    """A drawn text: its box in design pixels, and where and how it lies in the picture.

    left_px, top_px: of its first pixel; shown_px: how wide what is shown of it is, None for all of it.
    """

    box: Box
    role: str
    size_px: int
    colour: Colour
    left_px: int
    top_px: int
    outline: Colour | None = None
    shown_px: int | None = None

    @property
    def disabled(self) -> bool:
        """Whether it is drawn faded: what cannot be used need not invite."""
        return self.colour[3] < 0.7


@dataclass
class ProbeHud:
    """Stands before a real HUD. letters: whether texts are drawn; written: those that were, or would have been."""

    hud: Hud
    letters: bool = True
    written: list[Letters] = field(default_factory=list)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.hud, name)

    def rect(self, x: float, y: float, width: float, height: float, **look: Any) -> None:
        """A box; one that nothing shines through hides the texts under it, as it is meant to."""
        box = Box(x, y, width, height)
        if look.get("fill", (0.0, 0.0, 0.0, 0.0))[3] >= OPAQUE:
            self.written = [w for w in self.written if w.box.shared(box) < 0.98 * w.box.w * w.box.h]
        self.hud.rect(x, y, width, height, **look)

    def text(
        self, text: str, x: float, y: float, *, size: float = 24.0, colour: Colour = (1.0, 1.0, 1.0, 1.0),
        role: str = "body", align: float = 0.0, outline: Colour | None = None, shown: int | None = None,
    ) -> float:  # fmt: skip
        """A text, noted and, with letters, drawn."""
        hud = self.hud
        width, height = hud.measure(text, size, role)
        if text.strip() and shown != 0:
            box = Box(x - align * width, y, width, height, text, size)
            part = None
            if shown is not None and shown < len(text):
                part = round(hud.measure(text[:shown], size, role)[0] * hud.scale)
            left, top = round(x * hud.scale - align * width * hud.scale), round(y * hud.scale)
            self.written.append(Letters(box, role, hud.size_px(size), colour, left, top, outline, part))
        if not self.letters:
            return width
        return hud.text(text, x, y, size=size, colour=colour, role=role, align=align, outline=outline, shown=shown)
