"""What stands behind the shopkeeper: folding screen, shelf with wares, wooden crates; and signs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from game.tools.modelling.fields import Floats
from game.tools.modelling.goods_shapes import disc, inlay, leaning, spun
from game.tools.modelling.lofts import lathe, rounded_box
from game.tools.modelling.parts import Part
from game.tools.modelling.pieces import Colour, Moving, Vector

__all__ = ["FoldingScreen", "Shelf"]

Surface = Callable[[Floats], tuple[Floats, Floats]]


@dataclass(frozen=True)
class FoldingScreen:
    """A painted screen in zigzag, from ``left`` to the right at depth z: a pine, moss banks, clouds of gold leaf."""

    left: float
    panels: int
    width: float
    top: float
    z: float
    frame: Colour
    ground: Colour
    cloud: Colour
    pine: Colour
    trunk: Colour

    def still(self) -> Mapping[str, list[Part]]:
        parts = []
        step = self.width * np.cos(np.radians(22))
        for k in range(self.panels):
            turn = 22.0 if k % 2 else -22.0
            at = (self.left + (k + 0.5) * step, self.top / 2, self.z)
            half = (self.width / 2 - 0.004, self.top / 2, 0.010)
            board = leaning(rounded_box((0, 0, 0), half, 0.004, cuts=3), (0, turn, 0), at)
            field = leaning(
                rounded_box((0, 0, 0), (half[0] - 0.016, half[1] - 0.016, 0.0115), 0.002, cuts=3), (0, turn, 0), at
            )
            parts.append(Part("screen", self.frame, board, None, 0.7))
            parts.append(Part("screen", self.ground, field, None, 0.0))
            parts += self._painting(k, turn, at, half[0] - 0.018)
        return {"scene": parts}

    def moving(self) -> Sequence[Moving]:
        return ()

    def _painting(self, panel: int, turn: float, at: Vector, half: float) -> list[Part]:
        """The picture runs over all panels: x counts from the screen's left edge, y from the ground."""
        angle = np.radians(turn)
        normal = np.array([np.sin(angle), 0.0, np.cos(angle)])
        right = np.array([np.cos(angle), 0.0, -np.sin(angle)])
        middle = (panel + 0.5) * self.width
        low, high = middle - half, middle + half

        def surface(flat: Floats) -> tuple[Floats, Floats]:
            inside = np.clip(flat[:, 0], low, high) - middle
            position = np.array(at) + inside[:, None] * right + (flat[:, 1] - self.top / 2)[:, None] * (0, 1, 0)
            return position, np.tile(normal, (len(flat), 1))

        parts = []

        def paint(colour: str, outline: Floats, layer: int) -> None:
            reach = outline[:, 0]
            if reach.min() < high - 0.004 and reach.max() > low + 0.004:
                clipped = np.stack([np.clip(reach, low, high), np.clip(outline[:, 1], 0.0, self.top - 0.02)], 1)
                parts.append(Part("painting", colour, inlay(clipped, surface, 0.0124 + 0.0005 * layer), None, 0.0))

        whole = self.panels * self.width
        for x, y, rx in (
            (0.16, 1.16, 0.22),
            (0.62, 1.20, 0.26),
            (0.90, 1.02, 0.20),
            (0.30, 0.74, 0.24),
            (0.95, 0.70, 0.2),
        ):
            for lobe in (-0.6, 0.0, 0.55):
                paint(self.cloud, disc(x * whole + lobe * rx, y, (rx * 0.62, 0.034), 20), 0)
        trunk = np.array([(0.30, 0.40), (0.40, 0.72), (0.36, 0.92), (0.50, 1.10)]) * (whole, 1.0)
        for a, b, w in zip(trunk[:-1], trunk[1:], (0.038, 0.030, 0.022), strict=True):
            side = np.array([1.0, 0.12]) * w
            paint(self.trunk, np.array([a - side, a + side, b + side * 0.8, b - side * 0.8]), 1)
        for x, y, r in (
            (0.50, 1.14, 0.13),
            (0.62, 1.03, 0.11),
            (0.24, 1.00, 0.12),
            (0.40, 0.84, 0.10),
            (0.18, 0.84, 0.09),
        ):
            for dx, dy, s in ((-0.7, -0.02, 0.7), (0.0, 0.03, 1.0), (0.75, -0.03, 0.65)):
                paint(self.pine, disc(x * whole + dx * r, y + dy, (r * s, r * 0.42 * s), 22), 2)
        return parts


@dataclass(frozen=True)
class Shelf:
    """Boards between uprights, with jars, bowls, boxes and scrolls in the colours of ``wares``."""

    left: float
    width: float
    levels: tuple[float, ...]
    z: float
    depth: float
    wood: Colour
    dark: Colour
    wares: tuple[Colour, ...]

    def still(self) -> Mapping[str, list[Part]]:
        parts = []
        middle, half = self.left + self.width / 2, self.width / 2
        for y in self.levels:
            board = rounded_box((middle, y, self.z), (half, 0.011, self.depth / 2), 0.004, cuts=4)
            parts.append(Part("board", self.wood, board, None, 0.7))
        tall = max(self.levels)
        for x in (self.left + 0.02, self.left + self.width - 0.02):
            post = rounded_box((x, tall / 2, self.z), (0.016, tall / 2 + 0.02, self.depth / 2 + 0.004), 0.005, cuts=4)
            parts.append(Part("upright", self.wood, post, None, 0.8))
        back = rounded_box((middle, tall / 2, self.z - self.depth / 2), (half - 0.02, tall / 2, 0.006), 0.003, cuts=3)
        parts.append(Part("back", self.dark, back, None, 0.0))
        for row, y in enumerate(self.levels):
            for k in range(int(self.width / 0.135)):
                x = self.left + 0.095 + k * 0.135
                if x < self.left + self.width - 0.06:
                    parts += self._ware(row * 7 + k, np.array([x, y + 0.011, self.z + 0.01 * ((k * 3 + row) % 3 - 1)]))
        return {"scene": parts}

    def moving(self) -> Sequence[Moving]:
        return ()

    def _ware(self, number: int, at: Floats) -> list[Part]:
        """Jar, bowl stack, gourd bottle, scrolls, or box; which one follows from its number."""
        colour = self.wares[(number * 5 + number // 7 + 1) % len(self.wares)]
        second = self.wares[(number * 3 + 2) % len(self.wares)]
        kind = (number * 3 + number // 7 * 2) % 5
        if kind == 0:
            jar = [
                (0.001, 0),
                (0.026, 0.001),
                (0.044, 0.035),
                (0.046, 0.062),
                (0.026, 0.094),
                (0.024, 0.104),
                (0.028, 0.108),
                (0.020, 0.106),
            ]
            return [Part("jar", colour, spun(jar, 18, 14).placed(at), None, 0.7)]
        if kind == 1:
            bowl = [
                (0.001, 0.002),
                (0.018, 0.0),
                (0.020, 0.007),
                (0.042, 0.028),
                (0.046, 0.036),
                (0.040, 0.033),
                (0.001, 0.012),
            ]
            mesh = spun(bowl, 18, 9)
            return [
                Part("bowl", (colour, second)[k % 2], mesh.placed(at + (0.003 * k, 0.021 * k, 0)), None, 0.7)
                for k in range(3)
            ]
        if kind == 2:
            gourd = [
                (0.001, 0),
                (0.030, 0.002),
                (0.040, 0.032),
                (0.020, 0.062),
                (0.026, 0.086),
                (0.012, 0.108),
                (0.010, 0.130),
                (0.014, 0.134),
            ]
            return [Part("bottle", colour, spun(gourd, 18, 14).placed(at), None, 0.7)]
        if kind == 3:
            parts = []
            for k, (dx, dy) in enumerate(((-0.026, 0.020), (0.022, 0.020), (-0.002, 0.058))):
                roll = lathe([(0.001, -0.062), (0.020, -0.062), (0.021, 0.0), (0.020, 0.062), (0.001, 0.062)], 16)
                knob = lathe([(0.001, -0.072), (0.008, -0.071), (0.008, 0.071), (0.001, 0.072)], 10)
                place = at + (dx, dy, 0)
                shade = (second, colour, second)[k]
                parts.append(Part("scroll", shade, leaning(roll, (90, 0, 0), place), None, 0.7))
                parts.append(Part("scroll_end", self.dark, leaning(knob, (90, 0, 0), place), None, 0.5))
            return parts
        box = rounded_box(at + (0, 0.036, 0), (0.046, 0.036, 0.040), 0.005, cuts=4)
        lid = rounded_box(at + (0, 0.072, 0), (0.049, 0.010, 0.043), 0.004, cuts=4)
        tie = rounded_box(at + (0, 0.042, 0), (0.006, 0.042, 0.0435), 0.002, cuts=3)
        return [
            Part("box", second, box, None, 0.7),
            Part("box_lid", second, lid, None, 0.7),
            Part("box_tie", colour, tie, None, 0.0),
        ]
