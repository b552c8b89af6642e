"""The stall's body: posts and cloth front, the table's boards, the runner (the bargaining spot), the tray of coins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from game.core.humanoid import TABLE_FRONT_Z_M, TABLE_TOP_M
from game.tools.modelling.fields import Floats
from game.tools.modelling.goods_shapes import disc, inlay, star, turned
from game.tools.modelling.lofts import lathe, rounded_box, sheet
from game.tools.modelling.mesh import Mesh
from game.tools.modelling.parts import Part
from game.tools.modelling.pieces import Colour, Moving

__all__ = ["Boards", "Front", "Runner", "Tray", "flat_ends"]

_TOP = TABLE_TOP_M
_HALF_WIDTH_M = 1.5
_LINE_LIFT_M = 0.0004

Surface = tuple[Floats, Floats, Floats]


@dataclass(frozen=True)
class Front:
    """Front rail, pleated skirt, valance, four posts. valance: the colours in turn; edge: its lower border."""

    wood: Colour
    skirt: Colour
    valance: tuple[Colour, ...]
    edge: Literal["scallops", "points", "straight"]

    def still(self) -> Mapping[str, list[Part]]:
        rail = rounded_box((0, _TOP - 0.075, 0.725), (_HALF_WIDTH_M, 0.045, 0.018))
        parts = [Part("rail", self.wood, rail, None)]
        skirt = sheet(
            lambda u, v: (
                _HALF_WIDTH_M * (2 * u - 1),
                _TOP - 0.045 - 0.54 * v,
                0.756 + (0.006 + 0.022 * v) * np.sin(u * 92 + 1.3 * np.sin(u * 23)),
            ),
            320,
            6,
        )
        parts.append(Part("skirt", self.skirt, skirt, None, 0.0))
        lower = {"scallops": _scallop, "points": _point, "straight": _straight}[self.edge]
        for k in range(20):
            x0 = -_HALF_WIDTH_M + k * 0.15
            colour = self.valance[k % len(self.valance)]
            parts.append(Part("valance", colour, sheet(partial(lower, x0), 16, 6), None, 0.6))
        for side in (-1.0, 1.0):
            for z, height in ((0.70, 1.75), (-0.42, 1.90)):
                post = lathe([(0.001, 0), (0.030, 0), (0.030, 0.4), (0.030, 1.0), (0.030, height), (0.001, height)], 24)
                parts.append(Part("post", self.wood, flat_ends(post).placed((side * 1.08, 0, z)), None))
        return {"scene": parts}

    def moving(self) -> Sequence[Moving]:
        return ()


def _scallop(x0: float, u: Floats, v: Floats) -> Surface:
    """One scallop of 15 cm along the table's front edge."""
    y = _TOP + 0.004 - (0.045 + 0.060 * np.sin(np.pi * u) ** 0.7) * v
    return x0 + 0.15 * u, y, 0.764 + 0.006 * np.sin(u * np.pi) + 0.002 * v


def _point(x0: float, u: Floats, v: Floats) -> Surface:
    y = _TOP + 0.004 - (0.040 + 0.075 * (1 - np.abs(2 * u - 1))) * v
    return x0 + 0.15 * u, y, 0.764 + 0.006 * np.sin(u * np.pi) + 0.002 * v


def _straight(x0: float, u: Floats, v: Floats) -> Surface:
    return x0 + 0.15 * u, _TOP + 0.004 - 0.072 * v, 0.764 + 0.003 * np.sin(u * np.pi) + 0.002 * v


def flat_ends(post: Mesh) -> Mesh:
    """Sideways normals for a cylinder whose caps nobody sees."""
    normal = post.normal * (1.0, 0.0, 1.0)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return Mesh(post.position, np.where(length > 0.1, normal / np.maximum(length, 0.1), post.normal), post.triangle)


@dataclass(frozen=True)
class Boards:
    """The table's top: three boards of uneven length in each of five rows, with a few painted lines of grain."""

    first: Colour
    second: Colour
    grain: Colour

    def still(self) -> Mapping[str, list[Part]]:
        parts = []
        rows = np.linspace(0.16, TABLE_FRONT_Z_M, 6)
        for i in range(5):
            cuts = (-_HALF_WIDTH_M, -0.42 + 0.17 * (i % 3), 0.62 - 0.2 * (i % 2), _HALF_WIDTH_M)
            for k in range(3):
                x0, x1, z0, z1 = cuts[k], cuts[k + 1], rows[i], rows[i + 1]
                centre = ((x0 + x1) / 2, _TOP - 0.016 - 0.0015 * ((i + k) % 2), (z0 + z1) / 2)
                board = rounded_box(centre, ((x1 - x0) / 2 - 0.0012, 0.016, (z1 - z0) / 2 - 0.0012), 0.005)
                colour = (self.first, self.second, self.first)[(i * 2 + k) % 3]
                parts.append(Part("board", colour, board, None, 0.6))
                # a few grain lines, painted flat
                for line in range(3):
                    z = z0 + (z1 - z0) * (0.25 + 0.25 * line)
                    start = x0 + 0.1 + 0.13 * ((i * 3 + k * 2 + line * 5) % 4)
                    end = min(start + 0.22 + 0.1 * ((i + line) % 3), x1 - 0.06)
                    if end > start + 0.05:
                        y = _TOP - 0.0015 * ((i + k) % 2) + _LINE_LIFT_M
                        parts.append(Part("grain", self.grain, _grain(start, end, z, y), None, 0.0))
        return {"table": parts}

    def moving(self) -> Sequence[Moving]:
        return ()


def _grain(x0: float, x1: float, z: float, y: float) -> Mesh:
    return sheet(
        lambda u, v: (
            x0 + (x1 - x0) * u,
            np.full_like(u, y),
            z + 0.003 * np.sin(u * 5 + z * 90) + (v - 0.5) * 0.0030 * np.sin(np.pi * u),
        ),
        12,
        2,
        (0, 1, 0),
    )


@dataclass(frozen=True)
class Runner:
    """The bargaining spot: a cloth with two borders and a woven pattern.

    diamonds: small ones along both edges; brocade: rows of round crests with petals; checks: a quilt of squares.
    """

    cloth: Colour
    border: Colour
    figure: Colour
    second: Colour
    pattern: Literal["diamonds", "brocade", "checks"]

    def still(self) -> Mapping[str, list[Part]]:
        parts = []
        layers = (
            (self.border, 0.360, 0.755, 0.360, 0.0030, 0.6),
            (self.cloth, 0.335, 0.750, 0.330, 0.0045, 0.0),
            (self.border, 0.320, 0.748, 0.312, 0.0055, 0.0),
            (self.cloth, 0.312, 0.748, 0.304, 0.0065, 0.0),
        )
        for colour, half, front, depth, height, outline in layers:
            cloth = sheet(partial(_cloth, half, front, depth, height), 12, 6, (0, 1, 0))
            parts.append(Part("runner", colour, cloth, None, outline))
        drawn = {"diamonds": self._diamonds, "brocade": self._brocade, "checks": self._checks}[self.pattern]
        return {"table": parts + drawn()}

    def moving(self) -> Sequence[Moving]:
        return ()

    def _diamonds(self) -> list[Part]:
        parts = []
        for k in range(9):
            x = -0.26 + k * 0.065
            for z in (0.723, 0.460):
                corner = np.array([(x - 0.014, z), (x, z + 0.012), (x + 0.014, z), (x, z - 0.012)])
                position = np.stack([corner[:, 0], np.full(4, _TOP + 0.0075), corner[:, 1]], 1)
                normal = np.tile([0.0, 1.0, 0.0], (4, 1))
                figure = Mesh(position, normal, np.array([[0, 1, 2], [0, 2, 3]]))
                parts.append(Part("diamond", self.figure, figure, None, 0.0))
        return parts

    def _brocade(self) -> list[Part]:
        parts = []
        for row, z in enumerate((0.500, 0.585, 0.670)):
            for k in range(7 - row % 2):
                x = -0.258 + 0.043 * (row % 2) + k * 0.086
                parts.append(_woven("crest", self.figure, disc(x, z, 0.029, 20), 0))
                parts.append(_woven("crest_ground", self.cloth, disc(x, z, 0.0255, 20), 1))
                parts.append(_woven("crest_flower", self.figure, star(x, z, 0.021, 5, 0.45), 2))
                parts.append(_woven("crest_heart", self.second, disc(x, z, 0.0055, 8), 3))
        for k in range(8):
            for z in (0.456, 0.736):
                x = -0.2975 + k * 0.085
                diamond = np.array([(x - 0.020, z), (x, z + 0.006), (x + 0.020, z), (x, z - 0.006)])
                parts.append(_woven("diamond", self.second, diamond, 0))
        return parts

    def _checks(self) -> list[Part]:
        parts = []
        size = 0.052
        for row in range(5):
            for k in range(12):
                x, z = -0.286 + k * size, 0.480 + row * size
                if (row + k) % 2 == 0:
                    half = size / 2 - 0.002
                    square = np.array(
                        [(x - half, z - half), (x - half, z + half), (x + half, z + half), (x + half, z - half)]
                    )
                    parts.append(_woven("check", self.figure if row % 2 else self.second, square, 0))
                    parts.append(_woven("star", self.border, star(x, z, 0.016, 5, 0.55, 1.4, -90), 1))
        return parts


def _cloth(half: float, front: float, depth: float, height: float, u: Floats, v: Floats) -> Surface:
    return half * (2 * u - 1), np.full_like(u, _TOP + height), front - depth * v


def _woven(name: str, colour: str, outline: Floats, layer: int) -> Part:
    def surface(flat: Floats) -> tuple[Floats, Floats]:
        height = np.full(len(flat), _TOP + 0.0072 + 0.0004 * layer)
        return np.stack([flat[:, 0], height, flat[:, 1]], 1), np.tile([0.0, 1.0, 0.0], (len(flat), 1))

    return Part(name, colour, inlay(outline, surface, 0.0), None, 0.0)


@dataclass(frozen=True)
class Tray:
    """A saucer with coins, on the right of the runner."""

    dish: Colour
    coins: Colour

    def still(self) -> Mapping[str, list[Part]]:
        outline = [(0.001, 0.004), (0.060, 0.004), (0.066, 0.014), (0.070, 0.014), (0.068, 0.001), (0.001, 0.001)]
        at = np.array([0.30, _TOP + 0.006, 0.60])
        parts = [Part("tray", self.dish, turned(outline, 40, 4).placed(at), None, 0.8)]
        coin = lathe([(0.001, 0), (0.014, 0), (0.0155, 0.001), (0.0155, 0.0035), (0.014, 0.0045), (0.001, 0.0045)], 18)
        for k in range(9):
            radius, angle = 0.034 * np.sqrt(k / 9), k * 2.4
            place = at + (radius * np.cos(angle), 0.004 + 0.0045 * (k % 3), radius * np.sin(angle))
            parts.append(Part("coin", self.coins, coin.placed(place), None, 0.5))
        return {"table": parts}

    def moving(self) -> Sequence[Moving]:
        return ()
