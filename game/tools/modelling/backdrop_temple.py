"""Behind the antiques: the shaded court of a temple, its plaster wall and tiled roofs under old trees."""

from __future__ import annotations

import numpy as np

from game.tools.modelling.backdrop_canvas import HORIZON, Air, Canvas, person
from game.tools.modelling.fields import Floats

__all__ = ["AIR", "paint_temple"]

AIR = Air(haze=(214.0, 224.0, 220.0), share=0.15, glow=(0.20, 0.22, 0.14), glow_at=(0.30, 0.10))


def paint_temple(canvas: Canvas, rng: np.random.Generator) -> None:
    """Cool morning shade, with light falling through the leaves in patches."""
    canvas.gradient(0, 400, [(0, 0x8FB9C4), (0.45, 0xBFD6CC), (0.8, 0xF0E9CC), (1, 0xF3E2BC)])
    _far_hills(canvas)
    _pagoda(canvas, 905, 1.0)
    _hall(canvas)
    _foliage(canvas, rng, HORIZON - 62, 46, (0x4E806A, 0x639372, 0x437264), 24, 0.9)
    _ground(canvas, rng)
    _wall(canvas)
    for x, size in ((205.0, 1.15), (1085.0, 1.3)):
        _stone_lantern(canvas, x, 470.0, size)
    _trunk(canvas, 60, 92, 700)
    _trunk(canvas, 1215, 110, 720)
    _trunk(canvas, 372, 34, 440)
    for x, y, size, clothes, hair in (
        *((446.0, 446.0, 1.1, 0x4F6688, 0x33333F), (486.0, 450.0, 1.05, 0xA8706C, 0x4A3A38)),
        *((842.0, 452.0, 1.2, 0x6F5C86, 0x5E5A62), (1000.0, 474.0, 1.3, 0x748466, 0x2C2D38)),
    ):
        person(canvas, x, y, size, clothes, hair)
    _canopy(canvas, rng)
    _light_shafts(canvas)
    for _ in range(30):
        x, y, radius = rng.uniform(0, 1280), rng.uniform(60, 420), rng.uniform(6, 20)
        canvas.oval(x, y, radius, radius, 0xF7F3C8, rng.uniform(0.08, 0.26))


def _far_hills(canvas: Canvas) -> None:
    for top, swell, colour in ((150.0, 34.0, 0xA9C3BE), (186.0, 24.0, 0x93B3A6)):
        x = np.linspace(-20, 1300, 60)
        ridge = top + swell * np.sin(x / 170 + top) + swell * 0.4 * np.sin(x / 61)
        canvas.polygon(
            [(-20, HORIZON + 20), *map(tuple, np.stack([x, ridge], 1).tolist()), (1300, HORIZON + 20)], colour
        )


def _eaves(canvas: Canvas, x: float, y: float, half: float, rise: float, colour: int, under: int) -> None:
    """A roof with upturned corners, its ridge at y - rise."""
    t = np.linspace(-1, 1, 61)
    edge = y - 0.34 * rise * np.abs(t) ** 4
    slope = _slope(np.abs(t), y, rise)
    lower = [(float(x + half * a), float(b)) for a, b in zip(t, edge, strict=True)]
    upper = [(float(x + half * a), float(b)) for a, b in zip(t[::-1], np.minimum(slope, edge)[::-1], strict=True)]
    canvas.polygon(lower + upper, colour)
    canvas.polygon([*lower, *[(px, py + 0.13 * rise) for px, py in lower[::-1]]], under)
    for k in range(-9, 10):
        a = k / 10
        top, foot = float(_slope(np.array([abs(a * 0.8)]), y, rise)[0]), y - 0.34 * rise * a**4
        canvas.polygon(
            [(x + half * a * 0.8, top), (x + half * a * 0.8 + 2, top), (x + half * a + 2, foot), (x + half * a, foot)],
            0x4B5B68,
            0.5,
        )


def _slope(t: Floats, y: float, rise: float) -> Floats:
    """Height of the roof's upper outline: level along the ridge, then a hollow curve down to the corners."""
    s = np.clip((t - 0.52) / 0.48, 0.0, 1.0)
    return np.asarray(y - rise + 0.66 * rise * (1 - (1 - s) ** 2.2))


def _pagoda(canvas: Canvas, x: float, size: float) -> None:
    y = HORIZON
    for level in range(4):
        half = (78 - level * 11) * size
        base = y - (28 + level * 44) * size
        canvas.rectangle(x - half * 0.55, base - 30 * size, x + half * 0.55, base + 8 * size, 0xB7766A)
        canvas.rectangle(x - half * 0.55, base - 8 * size, x + half * 0.55, base - 2 * size, 0xE9D6BC, 0.8)
        _eaves(canvas, x, base - 26 * size, half, 24 * size, 0x667784, 0x57504F)
    canvas.rectangle(x - 2, y - 232 * size, x + 2, y - 176 * size, 0x8A6A4C)


def _hall(canvas: Canvas) -> None:
    """The main hall on the left, white walls between dark posts under a great grey roof."""
    canvas.rectangle(250, 168, 690, HORIZON + 6, 0xE6DECB)
    for x in range(250, 700, 55):
        canvas.rectangle(x, 160, x + 11, HORIZON + 8, 0x6E4A42)
    canvas.rectangle(250, 196, 690, 204, 0x7A5348)
    for x in range(316, 640, 110):
        canvas.rectangle(x, 206, x + 44, HORIZON + 4, 0x4C4A55, 0.85)
        for k in range(4):
            canvas.rectangle(x + 9 + k * 10, 206, x + 11 + k * 10, HORIZON, 0xC9A46A, 0.7)
    _eaves(canvas, 470, 170, 300, 122, 0x5F7180, 0x534A4C)
    canvas.rectangle(312, 40, 628, 54, 0x46545F)


def _wall(canvas: Canvas) -> None:
    """The court's wall: a stone foot, plaster with five pale lines, a tiled cap; it recedes to the right."""

    def band(near0: float, near1: float, far0: float, far1: float, colour: int, alpha: float = 1.0) -> None:
        canvas.polygon([(-20, near0), (1300, far0), (1300, far1), (-20, near1)], colour, alpha)

    band(226, 392, 244, 356, 0xCFC8BE)
    band(330, 392, 314, 356, 0xB3ADA9)
    for k in range(5):
        a, b = 262 + k * 17, 266 + k * 11
        band(a, a + 3.5, b, b + 2.5, 0xE2DCCD)
    band(372, 400, 344, 362, 0xA9A08F)
    for x in range(-10, 1300, 108):
        canvas.rectangle(x, 232 + x * 0.012, x + 13, 394 - x * 0.026, 0x7A5A4E, 0.85)
    patches = ((130, 290, 40), (262, 312, 30), (520, 286, 46), (590, 330, 26), (770, 296, 38), (905, 318, 30))
    for x, y, r in (*patches, (1100, 292, 34)):
        for k in range(4):
            canvas.oval(x + (k - 1.5) * r * 0.8, y + (k % 2) * r * 0.5, r * 0.62, r * 0.42, 0xFFF3D0, 0.55)
    band(206, 234, 230, 250, 0x4E5F6E)
    band(232, 240, 248, 254, 0x4A4A55)
    for left in range(-14, 1300, 22):
        canvas.oval(left + 8, 233.36 + left * 0.013, 8, 7, 0x71828E)


def _ground(canvas: Canvas, rng: np.random.Generator) -> None:
    canvas.gradient(HORIZON + 60, 720, [(0, 0xAFA996), (0.4, 0x979080), (1, 0x786F66)])
    for _ in range(44):
        x, y = rng.uniform(0, 1280), rng.uniform(400, 720)
        canvas.oval(x, y, rng.uniform(30, 100), rng.uniform(3, 9), 0xF2E7BE, rng.uniform(0.15, 0.4))
    for _ in range(22):
        x, y = rng.uniform(0, 1280), rng.uniform(390, 720)
        canvas.oval(x, y, rng.uniform(60, 150), rng.uniform(5, 14), 0x6E7A76, 0.22)


def _stone_lantern(canvas: Canvas, x: float, y: float, s: float) -> None:
    canvas.rectangle(x - 26 * s, y - 12 * s, x + 26 * s, y, 0x86897F)
    canvas.rectangle(x - 9 * s, y - 84 * s, x + 9 * s, y - 10 * s, 0x979A8E)
    canvas.rectangle(x - 27 * s, y - 96 * s, x + 27 * s, y - 82 * s, 0x86897F)
    canvas.rectangle(x - 19 * s, y - 128 * s, x + 19 * s, y - 95 * s, 0xA4A698)
    canvas.rectangle(x - 9 * s, y - 122 * s, x + 9 * s, y - 101 * s, 0xF6D58C)
    canvas.polygon(
        [(x - 42 * s, y - 124 * s), (x - 16 * s, y - 152 * s), (x + 16 * s, y - 152 * s), (x + 42 * s, y - 124 * s)],
        0x7C8077,
    )
    canvas.oval(x, y - 158 * s, 8 * s, 10 * s, 0x8E9187)
    canvas.oval(x - 12 * s, y - 149 * s, 15 * s, 5 * s, 0x8FA874, 0.7)


def _trunk(canvas: Canvas, x: float, width: float, foot: float) -> None:
    """An old tree: leaning trunk with light on its left side, roots spread on the ground."""
    half = width / 2
    canvas.polygon(
        [
            (x - half * 0.7, -10),
            (x + half * 0.8, -10),
            (x + half, foot - 60),
            (x + half * 1.9, foot),
            (x - half * 1.8, foot),
        ]
        + [(x - half, foot - 60)],
        0x5B4A47,
    )
    canvas.polygon(
        [(x - half * 0.6, -10), (x - half * 0.2, -10), (x - half * 0.4, foot - 40), (x - half, foot - 40)],
        0x8A7462,
        0.75,
    )
    canvas.oval(x + half * 0.3, foot * 0.55, half * 0.30, half * 0.5, 0x46393C, 0.6)


def _foliage(
    canvas: Canvas, rng: np.random.Generator, y: float, radius: float, greens: tuple[int, ...], count: int, alpha: float
) -> None:
    for k in range(count):
        x, r = -30 + 1340 * (k + rng.random()) / count, radius * rng.uniform(0.6, 1.15)
        for _ in range(5):
            dx, dy = rng.normal(0, r * 0.55), rng.normal(0, r * 0.35)
            canvas.oval(x + dx, y + dy, r * 0.62, r * 0.55, greens[rng.integers(len(greens))], alpha)


def _canopy(canvas: Canvas, rng: np.random.Generator) -> None:
    """Boughs from above, dark first, then leaves that catch the light; a maple on the right glows."""
    deep, middle, light = (0x3F6B5C, 0x4A7663, 0x36604F), (0x5F8F66, 0x6E9C6A), (0x9FC27C, 0xB9D28A)
    for share, greens, spread in ((1.0, deep, 1.0), (0.8, middle, 0.8), (0.5, light, 0.55)):
        for side, reach in ((0.0, 400.0), (1280.0, 430.0)):
            for _ in range(round(56 * share)):
                t = rng.random()
                x = side + (1 if side == 0 else -1) * reach * t**0.9
                y = 120 * (1 - t) ** 1.4 * spread + rng.normal(14, 20)
                r = rng.uniform(14, 34) * (1.15 - 0.4 * t)
                canvas.oval(x, y, r * 1.2, r * 0.8, greens[rng.integers(len(greens))], 0.92)
    for _ in range(46):
        t = rng.random()
        x, y, r = 1290 - 280 * t, 150 * (1 - t) + rng.normal(36, 20), rng.uniform(10, 22)
        canvas.oval(x, y, r * 1.2, r * 0.8, (0xC9694E, 0xD98A5B, 0xB85450)[rng.integers(3)], 0.85)


def _light_shafts(canvas: Canvas) -> None:
    for x, width in ((300.0, 60.0), (430.0, 36.0), (610.0, 80.0), (860.0, 44.0)):
        canvas.polygon([(x, 0), (x + width * 0.6, 0), (x + width * 2.4 + 150, 470), (x + 120, 470)], 0xFFF6CF, 0.13)
