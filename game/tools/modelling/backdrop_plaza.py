"""Behind the toys: a sunny plaza by the sea front, a ferris wheel, a carousel, kites and balloons in a bright sky."""

from __future__ import annotations

import itertools

import numpy as np

from game.tools.modelling.backdrop_canvas import HORIZON, Air, Canvas, person

__all__ = ["AIR", "paint_plaza"]

AIR = Air(haze=(255.0, 243.0, 212.0), share=0.20, glow=(0.34, 0.30, 0.16), glow_at=(0.16, 0.12))

_BRIGHT = (0xEF6B57, 0xF4B63F, 0x4FB3A8, 0xF7EAD0, 0x6C8FD6, 0xE889A8)


def paint_plaza(canvas: Canvas, rng: np.random.Generator) -> None:
    """High summer: everything in clear colours, the wheel's gondolas like sweets."""
    canvas.gradient(0, 400, [(0, 0x3FA9E6), (0.42, 0x8ED3F0), (0.85, 0xFCEFC6), (1, 0xFFE3A6)])
    _clouds(canvas, rng)
    _sea(canvas)
    _town(canvas, rng)
    _wheel(canvas, 960, 178, 158)
    _ground(canvas, rng)
    _carousel(canvas, 300, 418, 1.15)
    for x, y, size, stripe in (
        (620.0, 410.0, 0.9, 0xEF6B57),
        (1190.0, 470.0, 1.45, 0x4FB3A8),
        (30.0, 486.0, 1.6, 0xF4B63F),
    ):
        _booth(canvas, rng, x, y, size, stripe)
    for x, y, size, clothes, hair in (
        *((500.0, 432.0, 1.0, 0xF2C14E, 0x5A3A30), (530.0, 436.0, 0.72, 0xE86A5C, 0x3A3038)),
        *((742.0, 428.0, 1.0, 0x5FA9C8, 0x7A4A34), (820.0, 452.0, 1.2, 0xF09A86, 0x40303C)),
        *((858.0, 456.0, 0.8, 0x7CC08A, 0x8A5A3C), (1060.0, 512.0, 1.55, 0x8F7FC8, 0x4A3434)),
        *((170.0, 520.0, 1.55, 0xEFA94A, 0x3C3440), (222.0, 526.0, 1.1, 0x5AB4A4, 0x6A4030)),
    ):
        person(canvas, x, y, size, clothes, hair)
    _balloons(canvas, rng, 862, 380)
    _kite(canvas, 250, 70, 40, 0xEF6B57, 0xFFF3D6)
    _kite(canvas, 610, 46, 32, 0xF4B63F, 0x4FB3A8)
    _kite(canvas, 1180, 66, 30, 0x6C8FD6, 0xFFF3D6)
    for _ in range(24):
        x, y, radius = rng.uniform(0, 1280), rng.uniform(120, 520), rng.uniform(8, 24)
        canvas.oval(x, y, radius, radius, 0xFFF6C8, rng.uniform(0.08, 0.24))


def _clouds(canvas: Canvas, rng: np.random.Generator) -> None:
    for x, y, size in ((120, 130, 1.3), (470, 96, 1.1), (730, 150, 0.8), (1240, 140, 1.2)):
        for k in range(9):
            inner = abs(4 - abs(k - 4))
            radius = (20 + inner * 9) * size
            dx, dy = rng.normal(0, 7), rng.normal(0, 4)
            canvas.oval(x + (k - 4) * 27 * size + dx, y - inner * 10 * size + dy, radius, radius, 0xFFFDF4, 0.9)
        canvas.oval(x, y + 26 * size, 130 * size, 14 * size, 0xD8ECF2, 0.8)


def _sea(canvas: Canvas) -> None:
    canvas.rectangle(-10, HORIZON - 20, 1290, HORIZON + 10, 0x59B4CE)
    for k in range(18):
        canvas.oval(k * 74 + 20, HORIZON - 12 + (k % 3) * 6, 36, 1.6, 0xDFF3F0, 0.7)


def _town(canvas: Canvas, rng: np.random.Generator) -> None:
    walls, roofs = (0xFBE7C0, 0xF7D3B4, 0xFFF2D8, 0xF3C9B0), (0xE07A5F, 0xD9694E, 0x6FA8A0, 0xE2A24F)
    for x in [*range(-20, 640, 88), *range(1090, 1330, 84)]:
        height, width = rng.uniform(58, 112), rng.uniform(70, 98)
        base = HORIZON - height
        canvas.rectangle(x, base, x + width, HORIZON + 6, walls[rng.integers(4)])
        canvas.polygon([(x - 7, base), (x + width / 2, base - 32), (x + width + 7, base)], roofs[rng.integers(4)])
        for i in range(2):
            for j in range(2):
                left, top = x + 13 + i * width * 0.45, base + 14 + j * 34
                canvas.rectangle(left, top, left + 15, top + 19, 0x8FBACB, 0.85)
        canvas.rectangle(x + 8, HORIZON - 22, x + width - 8, HORIZON - 14, _BRIGHT[rng.integers(6)], 0.9)
    for x in range(-30, 1330, 74):
        r = rng.uniform(16, 30)
        canvas.oval(x, HORIZON - 10, r * 1.2, r, 0x7DBB62, 0.95)
        canvas.oval(x - r * 0.3, HORIZON - 18, r * 0.6, r * 0.45, 0xB4DC78, 0.9)


def _line(canvas: Canvas, a: tuple[float, float], b: tuple[float, float], width: float, colour: int) -> None:
    along = np.array(b) - a
    side = np.array([-along[1], along[0]]) / max(float(np.hypot(*along)), 1e-6) * width / 2
    corners = (a + side, b + side, b - side, a - side)
    canvas.polygon([(float(p[0]), float(p[1])) for p in corners], colour)


def _wheel(canvas: Canvas, x: float, y: float, radius: float) -> None:
    for side in (-1, 1):
        _line(canvas, (x, y), (x + side * radius * 0.55, HORIZON + 80), 11, 0xF6F0E2)
    for k in range(16):
        a = 2 * np.pi * k / 16 + 0.1
        _line(canvas, (x, y), (x + radius * np.cos(a), y + radius * np.sin(a)), 3.2, 0xF3E6DA)
    for r, width in ((radius, 7.0), (radius * 0.62, 4.0)):
        ring = np.linspace(0, 2 * np.pi, 73)
        for a, b in itertools.pairwise(ring.tolist()):
            start = (x + r * np.cos(a), y + r * np.sin(a))
            _line(canvas, start, (x + r * np.cos(b), y + r * np.sin(b)), width, 0xF2765F if r == radius else 0xFFF4DE)
    for k in range(16):
        a = 2 * np.pi * k / 16 + 0.1
        cx, cy = x + radius * np.cos(a), y + radius * np.sin(a)
        colour = _BRIGHT[k % 6]
        canvas.pill(cx - 13, cy + 2, cx + 13, cy + 26, 9, colour)
        canvas.rectangle(cx - 9, cy + 7, cx + 9, cy + 15, 0xE8F4F4, 0.9)
        canvas.polygon([(cx - 15, cy + 4), (cx, cy - 9), (cx + 15, cy + 4)], colour)
    canvas.oval(x, y, 19, 19, 0xF4B63F)
    canvas.oval(x, y, 10, 10, 0xFFF4DE)


def _ground(canvas: Canvas, rng: np.random.Generator) -> None:
    canvas.gradient(HORIZON + 2, 720, [(0, 0xF4DDA8), (0.4, 0xE8C58C), (1, 0xD2A272)])
    for k in range(-9, 26):
        canvas.polygon(
            [(640 + (k - 8) * 40, HORIZON + 4), (640 + (k - 8) * 40 + 7, HORIZON + 4)]
            + [(640 + (k - 8) * 190 + 26, 720), (640 + (k - 8) * 190, 720)],
            0xF9E8BE,
            0.45,
        )
    for row in (290.0, 330.0, 392.0, 480.0, 600.0):
        canvas.rectangle(-10, row, 1290, row + (row - HORIZON) * 0.05, 0xF9E8BE, 0.4)
    for _ in range(26):
        x, y = rng.uniform(0, 1280), rng.uniform(HORIZON + 10, 720)
        canvas.oval(x, y, rng.uniform(30, 90), rng.uniform(2, 6), 0xC78F62, 0.16)


def _carousel(canvas: Canvas, x: float, y: float, s: float) -> None:
    half = 128 * s
    canvas.oval(x, y - 6 * s, half, 16 * s, 0xD9694E)
    canvas.rectangle(x - half * 0.9, y - 118 * s, x + half * 0.9, y - 10 * s, 0xF3D9B4, 0.55)
    canvas.rectangle(x - 22 * s, y - 128 * s, x + 22 * s, y - 8 * s, 0xF6E8CC)
    for k in range(7):
        px = x - half * 0.86 + k * half * 0.287
        canvas.rectangle(px - 2, y - 122 * s, px + 2, y - 8 * s, 0xE0A23C)
        canvas.oval(px, y - (46 + 12 * (k % 2)) * s, 19 * s, 13 * s, (0xFFF6E6, 0xEBC08C, 0xC98D86)[k % 3])
        canvas.oval(px + 15 * s, y - (60 + 12 * (k % 2)) * s, 8 * s, 11 * s, (0xFFF6E6, 0xEBC08C, 0xC98D86)[k % 3])
    for k in range(12):
        a, b = x - half * 1.06 + k * half * 0.1767, x - half * 1.06 + (k + 1) * half * 0.1767
        colour = (0xEF6B57, 0xFFF3D6)[k % 2]
        canvas.polygon([(x, y - 196 * s), (b, y - 124 * s), (a, y - 124 * s)], colour)
        canvas.oval((a + b) / 2, y - 124 * s, (b - a) / 2, 13 * s, colour)
    canvas.polygon([(x, y - 222 * s), (x + 30 * s, y - 212 * s), (x, y - 202 * s)], 0xF4B63F)
    canvas.rectangle(x - 2, y - 222 * s, x + 1, y - 190 * s, 0x9A6A44)


def _booth(canvas: Canvas, rng: np.random.Generator, x: float, y: float, s: float, stripe: int) -> None:
    half, top = 92 * s, y - 168 * s
    canvas.rectangle(x - half * 0.92, top + 50 * s, x + half * 0.92, y - 46 * s, 0x9C6B52, 0.7)
    canvas.rectangle(x - half, y - 52 * s, x + half, y, 0xE9B46A)
    canvas.rectangle(x - half, y - 52 * s, x + half, y - 45 * s, 0xFBE0A6)
    for k in range(8):
        a, b = x - half * 1.14 + k * half * 0.285, x - half * 1.14 + (k + 1) * half * 0.285
        colour = stripe if k % 2 else 0xFFF6E2
        ta, tb = x + (a - x) * 0.78, x + (b - x) * 0.78
        canvas.polygon([(ta, top), (tb, top), (b, top + 52 * s), (a, top + 52 * s)], colour)
        canvas.oval((a + b) / 2, top + 52 * s, (b - a) / 2, (b - a) / 2, colour)
    for k in range(8):
        px = x - half * 0.84 + k * half * 0.24
        canvas.oval(px, y - 62 * s - rng.uniform(0, 8) * s, 9 * s, 13 * s, _BRIGHT[rng.integers(6)])


def _balloons(canvas: Canvas, rng: np.random.Generator, x: float, y: float) -> None:
    for k in range(9):
        bx, by = x + rng.normal(0, 26), y - 108 + rng.normal(0, 24)
        _line(canvas, (x - 4, y), (bx, by + 14), 1.2, 0xC9A98A)
        canvas.oval(bx, by, 15, 18, _BRIGHT[k % 6], 0.96)
        canvas.oval(bx - 5, by - 7, 4, 5, 0xFFFFFF, 0.55)


def _kite(canvas: Canvas, x: float, y: float, size: float, colour: int, second: int) -> None:
    canvas.polygon([(x, y - size), (x + size * 0.72, y), (x, y + size * 1.2), (x - size * 0.72, y)], colour)
    canvas.polygon([(x, y - size), (x + size * 0.72, y), (x, y)], second)
    canvas.polygon([(x - size * 0.72, y), (x, y), (x, y + size * 1.2)], second)
    before = (x, y + size * 1.2)
    for k in range(1, 7):
        after = (x + size * 0.5 * np.sin(k * 1.3), y + size * (1.2 + 0.42 * k))
        _line(canvas, before, after, 2, 0xFFF6E2)
        if k % 2:
            canvas.polygon(
                [(after[0] - 9, after[1] - 5), (after[0] + 9, after[1] + 5), (after[0] + 9, after[1] - 5)], colour
            )
        before = after
