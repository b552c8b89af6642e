"""The painted market behind the stall: sky, roofs, trees, stalls, people, bunting; blurred, with warm haze.

Painted in the units of a 1280 x 720 view whose horizon lies at y = 262, the eye level of the camera, and scaled up.
Everything is blurred, so hard edges need no antialiasing of their own beyond being painted larger and reduced.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

from game.tools.modelling.fields import Floats

__all__ = ["BACKDROPS", "paint_backdrop"]

_VIEW = (1280, 720)
_SIZE = (2048, 1152)
_HORIZON = 262.0
_BLUR_VIEW_PX = 5.0
_HAZE = np.array([255.0, 236.0, 200.0])
_HAZE_SHARE = 0.22

Rgb = tuple[int, int, int]


def _rgb(colour: int) -> Rgb:
    return (colour >> 16 & 255, colour >> 8 & 255, colour & 255)


class _Canvas:
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


def _sky(canvas: _Canvas, rng: np.random.Generator) -> None:
    canvas.gradient(0, 400, [(0, 0x6CC3E8), (0.4, 0xA9DEEB), (0.85, 0xFCEFD0), (1, 0xFFE6B8)])
    for x, y, size in ((180, 95, 1.2), (560, 60, 0.9), (1010, 120, 1.3), (1230, 50, 0.8)):
        for k in range(8):
            inner = abs(4 - abs(k - 4))
            dx, dy = rng.normal(0, 8), rng.normal(0, 4)
            radius = (24 + inner * 7) * size
            canvas.oval(x + (k - 4) * 30 * size + dx, y - inner * 9 * size + dy, radius, radius, 0xFFFBF0, 0.85)


def _town(canvas: _Canvas, rng: np.random.Generator) -> None:
    walls, roofs = (0xF3D9B0, 0xEBC4A0, 0xF6E3C2, 0xD9BFA8), (0xC9694E, 0xB85B57, 0xD98A5B)
    for x in range(-20, 1320, 95):
        height, width = rng.uniform(70, 130), rng.uniform(80, 115)
        base = _HORIZON - height
        canvas.rectangle(x, base, x + width, _HORIZON, walls[rng.integers(4)])
        roof = [(x - 8, base), (x + width / 2, base - 38), (x + width + 8, base)]
        canvas.polygon(roof, roofs[rng.integers(3)])
        for i in range(2):
            for j in range(2):
                left, top = x + 16 + i * width * 0.45, base + 16 + j * 38
                canvas.rectangle(left, top, left + 16, top + 20, 0x9FB7BC, 0.8)
    for x in range(-40, 1340, 60):
        if rng.random() >= 0.62:
            continue
        y, radius = _HORIZON - rng.uniform(60, 120), rng.uniform(38, 62)
        for k in range(7):
            angle = rng.uniform(0, 2 * np.pi)
            leaf = (0x6FAF63, 0x86C06B, 0x5A9A62)[k % 3]
            cx, cy = x + np.cos(angle) * radius * 0.6, y + np.sin(angle) * radius * 0.45
            canvas.oval(cx, cy, radius * 0.62, radius * 0.62, leaf, 0.95)
        canvas.oval(x - radius * 0.3, y - radius * 0.4, radius * 0.4, radius * 0.4, 0xB5DC84, 0.8)


def _ground(canvas: _Canvas, rng: np.random.Generator) -> None:
    canvas.gradient(_HORIZON - 6, 720, [(0, 0xE9CFA2), (0.4, 0xDDB98A), (1, 0xC69A72)])
    for _ in range(40):
        x, y, rx, ry = rng.uniform(0, 1280), rng.uniform(_HORIZON, 720), rng.uniform(30, 90), rng.uniform(2, 6)
        canvas.oval(x, y, rx, ry, 0xFFF0CC, 0.25)


def _stall(canvas: _Canvas, rng: np.random.Generator, x: float, y: float, size: float, stripe: int) -> None:
    width, height = 190 * size, 170 * size
    left, right = x - width / 2, x + width / 2
    for a in (left, right - 6 * size):
        canvas.rectangle(a, y - height * 0.6, a + 6 * size, y, 0x7A4E38)
    canvas.rectangle(left + 6 * size, y - height * 0.62, right - 6 * size, y - height * 0.3, 0x8A5E4A, 0.75)
    canvas.rectangle(left - 4, y - height * 0.30, right + 4, y, 0xB9804F)
    canvas.rectangle(left - 4, y - height * 0.30, right + 4, y - height * 0.26, 0xE0AC73)
    count = 8
    for k in range(count):
        a, top = x - width * 0.56 + k * width * 1.12 / count, x - width * 0.46 + k * width * 0.92 / count
        b, top_b = a + width * 1.12 / count, top + width * 0.92 / count
        colour = stripe if k % 2 else 0xFFF3DC
        edge = y - height * 0.66
        canvas.polygon([(top, y - height), (top_b, y - height), (b, edge), (a, edge)], colour)
        canvas.oval((a + b) / 2, edge, (b - a) / 2, (b - a) / 2, colour)
    wares = (0xE8655A, 0xF2B84C, 0x5FA9A0, 0x7F8CD0, 0xF2E5C8, 0x86B86A)
    for k in range(9):
        top = y - height * 0.30 - rng.uniform(12, 30) * size
        middle = x - width * 0.44 + k * width * 0.1 + 9 * size
        canvas.oval(middle, top + 17 * size, 9 * size, 17 * size, wares[rng.integers(6)])


def _person(canvas: _Canvas, x: float, y: float, size: float, clothes: int, hair: int) -> None:
    s = size
    for side, colour in ((-1, 0x5B4A5E), (1, 0x54445A)):
        canvas.pill(x + side * 5 * s - 4 * s, y - 46 * s, x + side * 5 * s + 4 * s, y, 4 * s, colour)
        canvas.pill(x + side * 18 * s - 5 * s, y - 96 * s, x + side * 18 * s + 5 * s, y - 48 * s, 5 * s, clothes)
    canvas.pill(x - 16 * s, y - 100 * s, x + 16 * s, y - 38 * s, 13 * s, clothes)
    canvas.oval(x, y - 118 * s, 17 * s, 17 * s, 0xF2C6A2)
    angle = np.linspace(np.radians(170), np.radians(370), 24)
    cap = np.stack([x + 19 * s * np.cos(angle), y - 119 * s + 20 * s * np.sin(angle)], 1)
    canvas.polygon([(float(a), float(b)) for a, b in cap], hair)


def _bunting(canvas: _Canvas) -> None:
    colours = (0xE8655A, 0xF2B84C, 0x5FA9A0, 0xF7EAD0, 0x7F8CD0)
    for top, sag, count in ((66, 60, 16), (112, 44, 14)):
        for k in range(count):
            t = k / count
            x, y = -20 + t * 1320, top + sag * np.sin(np.pi * (t * 2 % 1))
            canvas.polygon([(x, y), (x + 44, y + 3), (x + 22, y + 50)], colours[k % 5], 0.95)


def _graded(image: Image.Image) -> Image.Image:
    """Blur, warm haze, and a glow of sun from the upper left."""
    blurred = image.filter(ImageFilter.GaussianBlur(_BLUR_VIEW_PX * _SIZE[0] / _VIEW[0]))
    pixels: Floats = np.asarray(blurred, dtype=np.float64)
    pixels = pixels * (1 - _HAZE_SHARE) + _HAZE * _HAZE_SHARE
    x, y = np.meshgrid(np.linspace(0, 1, _SIZE[0]), np.linspace(0, 1, _SIZE[1]))
    glow = np.exp(-(((x - 0.18) / 0.5) ** 2 + ((y - 0.15) / 0.5) ** 2))[..., None]
    pixels = pixels + (255 - pixels) * glow * (0.30, 0.26, 0.14)
    return Image.fromarray(np.clip(pixels.round(), 0, 255).astype(np.uint8))


def _market(canvas: _Canvas, rng: np.random.Generator) -> None:
    """A row of striped stalls before a town, people, bunting."""
    _sky(canvas, rng)
    _town(canvas, rng)
    _ground(canvas, rng)
    for x, y, size, stripe in (
        *((560.0, 430.0, 1.15, 0x9A78B8), (800.0, 436.0, 1.2, 0x74AF68), (330.0, 452.0, 1.35, 0xE8A94A)),
        *((1010.0, 462.0, 1.45, 0x5C86C6), (60.0, 520.0, 1.95, 0x4FA79A), (1250.0, 530.0, 2.0, 0xE08A5A)),
    ):
        _stall(canvas, rng, x, y, size, stripe)
    for x, y, size, clothes, hair in (
        *((470.0, 430.0, 1.05, 0xF0D080, 0x403848), (690.0, 424.0, 1.0, 0xD0906A, 0x303040)),
        *((880.0, 448.0, 1.15, 0x9C6FA8, 0x30303C), (918.0, 452.0, 1.2, 0x7AB080, 0x704030)),
        *((232.0, 500.0, 1.5, 0xE27D60, 0x4A3030), (290.0, 508.0, 1.4, 0x6AA0B8, 0xC08850)),
        *((1100.0, 545.0, 1.75, 0xD86A78, 0x503828), (420.0, 470.0, 1.2, 0xA8788C, 0x282838)),
    ):
        _person(canvas, x, y, size, clothes, hair)
    _bunting(canvas)
    for _ in range(26):
        x, y, radius = rng.uniform(0, 1280), rng.uniform(120, 520), rng.uniform(8, 24)
        canvas.oval(x, y, radius, radius, 0xFFF2C0, rng.uniform(0.08, 0.25))


BACKDROPS: Mapping[str, Callable[[_Canvas, np.random.Generator], None]] = {"market": _market}
"""Recipe name, as ``backdrop.recipe`` of a stall's YAML gives it -> what paints it."""


def paint_backdrop(path: Path, recipe: str, rng: np.random.Generator) -> None:
    """Write the 2048 x 1152 picture as PNG."""
    canvas = _Canvas()
    BACKDROPS[recipe](canvas, rng)
    path.parent.mkdir(parents=True, exist_ok=True)
    _graded(canvas.image).save(path, optimize=True)
