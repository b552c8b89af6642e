"""What dresses a toy seller's stall: wooden crates with balls, a bunch of balloons, pinwheels, a chalk board."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from game.tools.modelling.fields import Floats
from game.tools.modelling.goods_shapes import cord, disc, inlay, leaning, spun, star
from game.tools.modelling.lofts import lathe, loft, rounded_box, smooth_curve
from game.tools.modelling.mesh import Mesh, split_at_level
from game.tools.modelling.parts import Part
from game.tools.modelling.pieces import Colour, Hanging, Moving, Vector
from game.tools.modelling.stall_roof import two_sided

__all__ = ["Balloons", "ChalkBoard", "Crates", "Pinwheels"]

_LETTERS = (
    # hiragana "omocha", toys: strokes through points of a unit square, y upward
    (
        ((0.12, 0.70), (0.38, 0.73), (0.62, 0.76)),
        ((0.36, 0.94), (0.37, 0.60), (0.36, 0.22), (0.27, 0.12), (0.15, 0.20), (0.20, 0.36), (0.44, 0.47), (0.68, 0.44))
        + ((0.78, 0.28), (0.68, 0.12), (0.52, 0.10)),
        ((0.72, 0.86), (0.80, 0.80), (0.88, 0.72)),
    ),
    (
        ((0.48, 0.95), (0.40, 0.64), (0.37, 0.28), (0.48, 0.09), (0.70, 0.10), (0.82, 0.26), (0.80, 0.40)),
        ((0.20, 0.68), (0.42, 0.69), (0.66, 0.71)),
        ((0.18, 0.46), (0.42, 0.47), (0.66, 0.49)),
    ),
    (
        ((0.14, 0.74), (0.46, 0.76), (0.78, 0.79)),
        (
            (0.44, 0.95),
            (0.35, 0.64),
            (0.27, 0.38),
            (0.46, 0.53),
            (0.70, 0.52),
            (0.80, 0.33),
            (0.68, 0.13),
            (0.42, 0.06),
        ),
    ),
    (
        ((0.10, 0.36), (0.36, 0.48), (0.62, 0.54), (0.72, 0.42), (0.62, 0.30), (0.50, 0.30)),
        ((0.44, 0.70), (0.50, 0.60), (0.53, 0.54)),
        ((0.24, 0.58), (0.36, 0.28), (0.46, 0.02)),
    ),
)


@dataclass(frozen=True)
class Crates:
    """Slatted crates: at is the middle of each one's foot (x, y, z) and its turn; on top lie balls and blocks."""

    at: tuple[tuple[float, float, float, float], ...]
    half: Vector
    wood: Colour
    dark: Colour
    toys: tuple[Colour, ...]

    def still(self) -> Mapping[str, list[Part]]:
        parts = []
        for number, (x, y, z, turn) in enumerate(self.at):
            for part in self._crate() + self._filling(number):
                mesh = part.mesh.placed((x, y, z), float(np.radians(turn)))
                parts.append(Part(part.name, part.material, mesh, None, part.outline))
        return {"scene": parts}

    def moving(self) -> Sequence[Moving]:
        return ()

    def _crate(self) -> list[Part]:
        w, h, d = self.half
        parts = [
            Part(
                "inside",
                self.dark,
                rounded_box((0, h * 0.96, 0), (w - 0.012, h * 0.94, d - 0.012), 0.003, cuts=2),
                None,
                0.0,
            )
        ]
        for k in range(4):
            y = h * 2 * (k + 0.5) / 4
            for z, half in ((d, (w, h / 4 - 0.006, 0.007)), (-d, (w, h / 4 - 0.006, 0.007))):
                parts.append(Part("slat", self.wood, rounded_box((0, y, z), half, 0.003, cuts=3), None, 0.7))
            for x in (-w, w):
                parts.append(
                    Part("slat", self.wood, rounded_box((x, y, 0), (0.007, h / 4 - 0.006, d), 0.003, cuts=3), None, 0.7)
                )
        for x in (-1.0, 1.0):
            for z in (-1.0, 1.0):
                post = rounded_box((x * (w - 0.010), h, z * (d + 0.006)), (0.014, h + 0.002, 0.006), 0.003, cuts=3)
                parts.append(Part("post", self.wood, post, None, 0.7))
        return parts

    def _filling(self, number: int) -> list[Part]:
        w, h, d = self.half
        parts = []
        for k in range(5):
            colour = self.toys[(number * 3 + k * 2) % len(self.toys)]
            second = self.toys[(number * 3 + k * 2 + 3) % len(self.toys)]
            r = 0.036 + 0.010 * ((k * 7 + number) % 3)
            at = (-w * 0.74 + k * w * 0.37, h * 2 + r * 0.25, d * 0.35 * ((k % 2) * 2 - 1))
            t = np.linspace(-np.pi / 2, np.pi / 2, 13)
            ball = lathe(np.stack([r * np.cos(t) + 1e-4, r * np.sin(t)], 1), 20)
            band, rest = split_at_level(ball, r * 0.30 - np.abs(ball.position[:, 1]))
            tilt = (30.0 + 20 * k, 0.0, 40.0 - 25.0 * k)
            parts.append(Part("ball", colour, leaning(rest, tilt, at), None, 0.7))
            parts.append(Part("ball_band", second, leaning(band, tilt, at), None, 0.7))
        return parts


@dataclass(frozen=True)
class Balloons:
    """Bunches of balloons: each string is tied at ``tied``; at: middle of each balloon; radius in metres."""

    tied: Vector
    at: tuple[Vector, ...]
    radius: float
    string: Colour
    glint: Colour
    colours: tuple[Colour, ...]

    def still(self) -> Mapping[str, list[Part]]:
        return {}

    def moving(self) -> Sequence[Moving]:
        hanging = []
        for k, (x, y, z) in enumerate(self.at):
            hanging.append(Hanging(self.tied, self._balloon(np.array([x, y, z]), self.colours[k % len(self.colours)])))
        return (Moving("balloons", "sway", (0.0, 0.0, 1.0), 3.5, 4.4, hanging),)

    def _balloon(self, at: Floats, colour: str) -> list[Part]:
        r = self.radius
        skin = spun(
            [(0.0005, -1.26), (0.10, -1.22), (0.06, -1.16), (0.30, -0.98), (0.78, -0.45), (0.97, 0.10), (0.84, 0.62)]
            + [(0.45, 0.95), (0.001, 1.06)],
            24,
            20,
        )
        lean = float(np.degrees(np.arctan2(-(at[0] - self.tied[0]), at[1] - self.tied[1]))) * 0.6
        body = leaning(Mesh(skin.position * r, skin.normal, skin.triangle), (0, 0, lean), at)
        shine = inlay(disc(-0.34, 0.42, (0.10, 0.20), 14, -28), self._front, 0.0, 2)
        shine = leaning(Mesh(shine.position * r, shine.normal, shine.triangle), (0, 0, lean), at)
        foot = body.position[0] * (0, 1, 0) + at * (1, 0, 1)
        knot = np.array(
            [at[0] + np.sin(np.radians(lean)) * r * 1.25, at[1] - np.cos(np.radians(lean)) * r * 1.25, foot[2]]
        )
        end = np.array(self.tied)
        middle = (knot + end) / 2 + (0.02, -0.01, 0.0)
        line = cord(np.stack([knot, middle, end]), 0.0016, 12, 4)
        return [
            Part("balloon", colour, body, None, 0.9),
            Part("balloon_glint", self.glint, shine, None, 0.0),
            Part("balloon_string", self.string, line, None, 0.3),
        ]

    @staticmethod
    def _front(flat: Floats) -> tuple[Floats, Floats]:
        """A little in front of the unit balloon's skin."""
        depth = np.sqrt(np.maximum(1.13 - (flat**2).sum(1), 0.02))
        position = np.column_stack([flat, depth])
        return position, position / np.linalg.norm(position, axis=1, keepdims=True)


@dataclass(frozen=True)
class Pinwheels:
    """Paper windmills on sticks. at: the hub of each one (x, y, z); foot: the height where its stick begins."""

    at: tuple[Vector, ...]
    foot: float
    radius: float
    stick: Colour
    hub: Colour
    colours: tuple[Colour, ...]

    def still(self) -> Mapping[str, list[Part]]:
        sticks = []
        for x, y, z in self.at:
            pole = cord([(x, self.foot, z - 0.02), (x, (y + self.foot) / 2, z - 0.022), (x, y, z - 0.016)], 0.006, 4, 8)
            sticks.append(Part("stick", self.stick, pole, None, 0.6))
        return {"scene": sticks}

    def moving(self) -> Sequence[Moving]:
        hanging = []
        for number, place in enumerate(self.at):
            hanging.append(Hanging(place, self._wheel(np.array(place), number)))
        return (Moving("pinwheels", "spin", (0.0, 0.0, 1.0), 0.0, 3.2, hanging),)

    def _wheel(self, at: Floats, number: int) -> list[Part]:
        parts = []
        for blade in range(6):
            # A sail: from the hub out to the tip and back along the folded edge, which stands forward.
            turn = blade * 60.0 + number * 17.0
            a = np.array(
                [(0.0, 0.0, 0.0), (0.60, -0.22, 0.0), (1.0, 0.16, 0.03), (0.82, 0.56, 0.12), (0.30, 0.42, 0.18)]
            )
            triangle = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4]])
            corner = a * self.radius
            face = np.cross(
                corner[triangle[:, 1]] - corner[triangle[:, 0]], corner[triangle[:, 2]] - corner[triangle[:, 0]]
            )
            normal = np.tile(face.sum(0) / np.linalg.norm(face.sum(0)), (5, 1))
            sail = leaning(two_sided(Mesh(corner, normal, triangle)), (0, 0, turn), at)
            colour = self.colours[(blade + number) % len(self.colours)]
            parts.append(Part("sail", colour, sail, None, 0.6))
        hub = spun([(0.16, 0.10), (0.15, 0.18), (0.07, 0.24), (0.001, 0.25)], 12, 6)
        hub = Mesh(hub.position * self.radius, hub.normal, hub.triangle)
        parts.append(Part("hub", self.hub, leaning(hub, (90, 0, 0), at), None, 0.6))
        return parts


@dataclass(frozen=True)
class ChalkBoard:
    """A framed slate at ``at`` (its middle), leaning back and turned: the word for toys, a sun, stars, a wavy line."""

    at: Vector
    half: tuple[float, float]
    turn: float
    frame: Colour
    slate: Colour
    chalk: Colour
    colours: tuple[Colour, ...]

    def still(self) -> Mapping[str, list[Part]]:
        w, h = self.half
        parts = [
            Part("frame", self.frame, rounded_box((0, 0, 0), (w, h, 0.012), 0.005, cuts=4), None, 0.9),
            Part(
                "slate", self.slate, rounded_box((0, 0, 0.006), (w - 0.020, h - 0.020, 0.008), 0.002, cuts=3), None, 0.4
            ),
        ]
        for number, letter in enumerate(_LETTERS):
            size = w * 0.46
            corner = np.array([(number - 2) * size + 0.004, h * 0.02])
            for strokes in letter:
                self._chalk(parts, np.array(strokes) * size + corner, self.chalk, w * 0.022)
        angle = np.linspace(0, 2 * np.pi, 13)
        sun = np.array([-w * 0.52, -h * 0.42])
        self._chalk(parts, sun + h * 0.19 * np.stack([np.cos(angle), np.sin(angle)], 1), self.colours[0], w * 0.016)
        for k in range(8):
            ray = np.array([np.cos(k * np.pi / 4), np.sin(k * np.pi / 4)])
            self._chalk(parts, np.stack([sun + ray * h * r for r in (0.25, 0.29, 0.33)]), self.colours[0], w * 0.014)
        for k, x in enumerate((0.02, 0.34, 0.66)):
            spot = star(w * x, -h * (0.36 + 0.14 * (k % 2)), h * 0.15, 5, 0.55, 1.1, 80 + 20 * k)
            self._chalk(parts, np.vstack([spot, spot[:1]]), self.colours[(k + 1) % len(self.colours)], w * 0.013)
        wave = np.linspace(-0.84, 0.84, 15)
        underline = np.stack([wave * w, -h * 0.06 + 0.025 * h * np.sin(wave * 14)], 1)
        self._chalk(parts, underline, self.colours[2 % len(self.colours)], w * 0.014)
        return {"scene": [self._placed(part) for part in parts]}

    def moving(self) -> Sequence[Moving]:
        return ()

    def _chalk(self, parts: list[Part], points: Floats, colour: str, width: float) -> None:
        count = 6 * len(points)
        line = smooth_curve(points, min(count, 48))
        path = np.column_stack([line, np.full(len(line), 0.0150)])
        ribbon = loft(path, np.tile([0.0, 0, 1], (len(path), 1)), width, 0.0006, 4, "round")
        parts.append(Part("chalk", colour, ribbon, None, 0.0))

    def _placed(self, part: Part) -> Part:
        return Part(part.name, part.material, leaning(part.mesh, (-8, self.turn, 0), self.at), None, part.outline)
