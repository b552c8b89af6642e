"""A canvas for painted backdrops, in units of a 1280 x 720 view whose horizon, the camera's eye level, lies at 262.

Everything is blurred in the end, so hard edges need no antialiasing of their own beyond being painted larger and
reduced.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

from game.tools.modelling.fields import Floats

__all__ = ["HORIZON", "Air", "Canvas", "person"]

_VIEW = (1280, 720)
_SIZE = (2048, 1152)
HORIZON = 262.0
"""Height of eye level from the top, in view units."""
_BLUR_VIEW_PX = 5.0

Rgb = tuple[int, int, int]


@dataclass(frozen=True)
class Air:
    """Haze that lies over the whole picture and the glow of the light's source.

    haze, glow: sRGB 0..255 and shares of white per channel; glow_at: 0..1 from the upper left.
    """

    haze: tuple[float, float, float]
    share: float
    glow: tuple[float, float, float]
    glow_at: tuple[float, float]


def _rgb(colour: int) -> Rgb:
    return (colour >> 16 & 255, colour >> 8 & 255, colour & 255)


class Canvas:
    """Flat shapes in view units; a shape with ``alpha`` below 1 is blended through a mask."""

    def __init__(self) -> None:
        self.image = Image.new("RGB", _SIZE)
        self._scale = _SIZE[0] / _VIEW[0]

    def _scaled(self, points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
        return [(x * self._scale, y * self._scale) for x, y in points]

    def polygon(self, points: Sequence[tuple[float, float]], colour: int, alpha: float = 1.0) -> None:
        scaled = self._scaled(points)
        if alpha >= 1.0:
            ImageDraw.Draw(self.image).polygon(scaled, fill=_rgb(colour))
            return
        x0, y0 = (int(np.floor(min(p[i] for p in scaled))) for i in (0, 1))
        x1, y1 = (int(np.ceil(max(p[i] for p in scaled))) + 1 for i in (0, 1))
        mask = Image.new("L", (max(x1 - x0, 1), max(y1 - y0, 1)))
        ImageDraw.Draw(mask).polygon([(x - x0, y - y0) for x, y in scaled], fill=round(255 * alpha))
        self.image.paste(_rgb(colour), (x0, y0, x0 + mask.width, y0 + mask.height), mask)

    def rectangle(self, x0: float, y0: float, x1: float, y1: float, colour: int, alpha: float = 1.0) -> None:
        self.polygon([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], colour, alpha)

    def oval(self, x: float, y: float, rx: float, ry: float, colour: int, alpha: float = 1.0) -> None:
        angle = np.linspace(0.0, 2 * np.pi, 40, endpoint=False)
        points = np.stack([x + rx * np.cos(angle), y + ry * np.sin(angle)], 1)
        self.polygon([(float(px), float(py)) for px, py in points], colour, alpha)

    def pill(self, x0: float, y0: float, x1: float, y1: float, radius: float, colour: int) -> None:
        (a, b), (c, d) = self._scaled([(x0, y0), (x1, y1)])
        ImageDraw.Draw(self.image).rounded_rectangle((a, b, c, d), radius * self._scale, fill=_rgb(colour))

    def gradient(self, y0: float, y1: float, stops: Sequence[tuple[float, int]]) -> None:
        """Vertical gradient over the full width between two heights; stops are (0..1, colour)."""
        top, bottom = round(y0 * self._scale), min(round(y1 * self._scale), _SIZE[1])
        t = np.linspace(0.0, 1.0, bottom - top)
        where = [s for s, _ in stops]
        column = np.stack([np.interp(t, where, [_rgb(c)[i] for _, c in stops]) for i in range(3)], 1)
        block = np.broadcast_to(column[:, None], (bottom - top, _SIZE[0], 3))
        self.image.paste(Image.fromarray(np.ascontiguousarray(block.round().astype(np.uint8))), (0, top))

    def graded(self, air: Air) -> Image.Image:
        """Blur, haze, and the glow of the light."""
        blurred = self.image.filter(ImageFilter.GaussianBlur(_BLUR_VIEW_PX * _SIZE[0] / _VIEW[0]))
        pixels: Floats = np.asarray(blurred, dtype=np.float64)
        pixels = pixels * (1 - air.share) + np.array(air.haze) * air.share
        x, y = np.meshgrid(np.linspace(0, 1, _SIZE[0]), np.linspace(0, 1, _SIZE[1]))
        at = air.glow_at
        glow = np.exp(-(((x - at[0]) / 0.5) ** 2 + ((y - at[1]) / 0.5) ** 2))[..., None]
        pixels = pixels + (255 - pixels) * glow * air.glow
        return Image.fromarray(np.clip(pixels.round(), 0, 255).astype(np.uint8))


def person(canvas: Canvas, x: float, y: float, size: float, clothes: int, hair: int) -> None:
    """A passer-by as a few flat shapes, feet at (x, y), 138 units tall at size 1."""
    s = size
    for side, colour in ((-1, 0x5B4A5E), (1, 0x54445A)):
        canvas.pill(x + side * 5 * s - 4 * s, y - 46 * s, x + side * 5 * s + 4 * s, y, 4 * s, colour)
        canvas.pill(x + side * 18 * s - 5 * s, y - 96 * s, x + side * 18 * s + 5 * s, y - 48 * s, 5 * s, clothes)
    canvas.pill(x - 16 * s, y - 100 * s, x + 16 * s, y - 38 * s, 13 * s, clothes)
    canvas.oval(x, y - 118 * s, 17 * s, 17 * s, 0xF2C6A2)
    angle = np.linspace(np.radians(170), np.radians(370), 24)
    cap = np.stack([x + 19 * s * np.cos(angle), y - 119 * s + 20 * s * np.sin(angle)], 1)
    canvas.polygon([(float(a), float(b)) for a, b in cap], hair)
