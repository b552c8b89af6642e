"""The flea market behind the stall: a row of striped stalls before a town, people, bunting."""

from __future__ import annotations

import numpy as np

from game.tools.modelling.backdrop_canvas import HORIZON, Air, Canvas, person

__all__ = ["AIR", "bunting", "paint_market"]

AIR = Air(haze=(255.0, 236.0, 200.0), share=0.22, glow=(0.30, 0.26, 0.14), glow_at=(0.18, 0.15))


def _sky(canvas: Canvas, rng: np.random.Generator) -> None:
    canvas.gradient(0, 400, [(0, 0x6CC3E8), (0.4, 0xA9DEEB), (0.85, 0xFCEFD0), (1, 0xFFE6B8)])
    for x, y, size in ((180, 95, 1.2), (560, 60, 0.9), (1010, 120, 1.3), (1230, 50, 0.8)):
        for k in range(8):
            inner = abs(4 - abs(k - 4))
            dx, dy = rng.normal(0, 8), rng.normal(0, 4)
            radius = (24 + inner * 7) * size
            canvas.oval(x + (k - 4) * 30 * size + dx, y - inner * 9 * size + dy, radius, radius, 0xFFFBF0, 0.85)


def _town(canvas: Canvas, rng: np.random.Generator) -> None:
    walls, roofs = (0xF3D9B0, 0xEBC4A0, 0xF6E3C2, 0xD9BFA8), (0xC9694E, 0xB85B57, 0xD98A5B)
    for x in range(-20, 1320, 95):
        height, width = rng.uniform(70, 130), rng.uniform(80, 115)
        base = HORIZON - height
        canvas.rectangle(x, base, x + width, HORIZON, walls[rng.integers(4)])
        roof = [(x - 8, base), (x + width / 2, base - 38), (x + width + 8, base)]
        canvas.polygon(roof, roofs[rng.integers(3)])
        for i in range(2):
            for j in range(2):
                left, top = x + 16 + i * width * 0.45, base + 16 + j * 38
                canvas.rectangle(left, top, left + 16, top + 20, 0x9FB7BC, 0.8)
    for x in range(-40, 1340, 60):
        if rng.random() >= 0.62:
            continue
        y, radius = HORIZON - rng.uniform(60, 120), rng.uniform(38, 62)
        for k in range(7):
            angle = rng.uniform(0, 2 * np.pi)
            leaf = (0x6FAF63, 0x86C06B, 0x5A9A62)[k % 3]
            cx, cy = x + np.cos(angle) * radius * 0.6, y + np.sin(angle) * radius * 0.45
            canvas.oval(cx, cy, radius * 0.62, radius * 0.62, leaf, 0.95)
        canvas.oval(x - radius * 0.3, y - radius * 0.4, radius * 0.4, radius * 0.4, 0xB5DC84, 0.8)


def _ground(canvas: Canvas, rng: np.random.Generator) -> None:
    canvas.gradient(HORIZON - 6, 720, [(0, 0xE9CFA2), (0.4, 0xDDB98A), (1, 0xC69A72)])
    for _ in range(40):
        x, y, rx, ry = rng.uniform(0, 1280), rng.uniform(HORIZON, 720), rng.uniform(30, 90), rng.uniform(2, 6)
        canvas.oval(x, y, rx, ry, 0xFFF0CC, 0.25)


def _stall(canvas: Canvas, rng: np.random.Generator, x: float, y: float, size: float, stripe: int) -> None:
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


def bunting(canvas: Canvas) -> None:
    """Two rows of flags across the sky."""
    colours = (0xE8655A, 0xF2B84C, 0x5FA9A0, 0xF7EAD0, 0x7F8CD0)
    for top, sag, count in ((66, 60, 16), (112, 44, 14)):
        for k in range(count):
            t = k / count
            x, y = -20 + t * 1320, top + sag * np.sin(np.pi * (t * 2 % 1))
            canvas.polygon([(x, y), (x + 44, y + 3), (x + 22, y + 50)], colours[k % 5], 0.95)


def paint_market(canvas: Canvas, rng: np.random.Generator) -> None:
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
        person(canvas, x, y, size, clothes, hair)
    bunting(canvas)
    for _ in range(26):
        x, y, radius = rng.uniform(0, 1280), rng.uniform(120, 520), rng.uniform(8, 24)
        canvas.oval(x, y, radius, radius, 0xFFF2C0, rng.uniform(0.08, 0.25))
