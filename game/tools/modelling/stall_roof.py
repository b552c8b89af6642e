"""What hangs over the stall: striped awning or split curtain, strings of bulbs, flags and paper lanterns."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from game.tools.modelling.fields import Floats
from game.tools.modelling.goods_shapes import cord, disc, inlay, leaning, turned
from game.tools.modelling.lofts import lathe, loft, sheet
from game.tools.modelling.mesh import Mesh, joined, split_at_level
from game.tools.modelling.parts import Part
from game.tools.modelling.pieces import Colour, Hanging, Moving, Vector

__all__ = ["Awning", "Bulbs", "Bunting", "Lanterns", "Noren", "two_sided"]

Surface = tuple[Floats, Floats, Floats]


@dataclass(frozen=True)
class Awning:
    """Striped roof, sagging a little, with a scalloped edge toward the customer. colours: the stripes in turn."""

    colours: tuple[Colour, ...]

    def still(self) -> Mapping[str, list[Part]]:
        parts = []
        edges = np.linspace(-1.35, 1.35, 19)
        for k, (x0, x1) in enumerate(itertools.pairwise(edges)):
            colour = self.colours[k % len(self.colours)]
            width = x1 - x0
            roof = sheet(partial(_roof, x0, width), 4, 12, (0, 1, 0))
            edge = sheet(partial(_roof_edge, x0, width), 14, 6)
            parts += [Part("roof", colour, roof, None, 0.0), Part("scallop", colour, edge, None, 0.8)]
        return {"awning": parts}

    def moving(self) -> Sequence[Moving]:
        return ()


def _roof(x0: float, width: float, u: Floats, v: Floats) -> Surface:
    return x0 + width * u, 1.86 - 0.34 * v - 0.07 * v * (1 - v), -0.45 + 1.35 * v


def _roof_edge(x0: float, width: float, u: Floats, v: Floats) -> Surface:
    y = 1.525 - (0.055 + 0.050 * np.sin(np.pi * u) ** 0.6) * v
    return x0 + width * u, y, 0.905 + 0.010 * np.sin(np.pi * u) + 0.006 * v


@dataclass(frozen=True)
class Bulbs:
    """A sagging string of bulbs behind the shopkeeper's head. sways: each bulb swings on the string by itself."""

    string: Colour
    glass: Colour
    sways: bool

    def _bulbs(self) -> Sequence[Hanging]:
        glass = turned([(0.0005, -0.058), (0.014, -0.052), (0.020, -0.036), (0.014, -0.018), (0.008, -0.012)], 14, 2)
        cap = turned([(0.009, -0.016), (0.009, 0.002), (0.001, 0.003)], 8, 1)
        hanging = []
        for k in range(15):
            place = np.array([-1.12 + k * 0.16, 0.0, -0.40])
            place[1] = _string_height(place[:1])[0]
            bulb = Part("bulb", self.glass, glass.placed(place), None, 0.6)
            socket = Part("socket", self.string, cap.placed(place), None, 0.5)
            hanging.append(Hanging((float(place[0]), float(place[1]), float(place[2])), (bulb, socket)))
        return hanging

    def still(self) -> Mapping[str, list[Part]]:
        x = np.linspace(-1.2, 1.2, 60)
        path = np.stack([x, _string_height(x), np.full(60, -0.40)], 1)
        string = loft(path, np.tile([0.0, 0, 1], (60, 1)), 0.0035, 0.0035, 6, "round")
        parts = [Part("string", self.string, string, None, 0.4)]
        if not self.sways:
            parts += [part for bulb in self._bulbs() for part in bulb.parts]
        return {"awning": parts}

    def moving(self) -> Sequence[Moving]:
        return (Moving("bulbs", "sway", (1.0, 0.0, 0.0), 7.0, 2.6, self._bulbs()),) if self.sways else ()


def _string_height(x: Floats) -> Floats:
    return np.asarray(1.66 - 0.13 * np.abs(np.sin((x + 1.2) / 0.8 * np.pi)))


@dataclass(frozen=True)
class Bunting:
    """Flags on a sagging string between two points. drop: how far the string sags; size: width of a flag, metres."""

    start: Vector
    end: Vector
    drop: float
    count: int
    size: float
    string: Colour
    colours: tuple[Colour, ...]

    def _path(self, share: Floats) -> Floats:
        start, end = np.array(self.start), np.array(self.end)
        line: Floats = start + (end - start) * share[:, None]
        line[:, 1] -= self.drop * 4 * share * (1 - share)
        return line

    def still(self) -> Mapping[str, list[Part]]:
        path = self._path(np.linspace(0.0, 1.0, 40))
        string = loft(path, np.tile([0.0, 0, 1], (40, 1)), 0.003, 0.003, 5, "round")
        return {"awning": [Part("string", self.string, string, None, 0.4)]}

    def moving(self) -> Sequence[Moving]:
        along = np.array(self.end) - np.array(self.start)
        axis = along / np.linalg.norm(along)
        flags = []
        for k in range(self.count):
            middle = (k + 0.5) / self.count
            half = 0.5 * self.size / float(np.linalg.norm(along))
            a, top, b = self._path(np.array([middle - half, middle, middle + half]))
            flag = partial(_flag, a, b, self.size * 1.15)
            colour = self.colours[k % len(self.colours)]
            pivot = (float(top[0]), float(top[1]), float(top[2]))
            flags.append(Hanging(pivot, (Part("flag", colour, two_sided(sheet(flag, 7, 6)), None, 0.7),)))
        return (Moving("bunting", "sway", (float(axis[0]), float(axis[1]), float(axis[2])), 12.0, 2.2, flags),)


def _flag(a: Floats, b: Floats, height: float, u: Floats, v: Floats) -> Surface:
    """A pennant: the full width at the string, a point below, bellied a little by the wind."""
    x = 0.5 + (u - 0.5) * (1 - v)
    place = a + (b - a) * x[:, None]
    return place[:, 0], place[:, 1] - height * v, place[:, 2] + 0.010 * np.sin(np.pi * v) + 0.004 * np.sin(6 * u)


def two_sided(front: Mesh) -> Mesh:
    """The same sheet with a back of its own: back faces are not drawn."""
    back = Mesh(front.position - front.normal * 0.0008, -front.normal, np.ascontiguousarray(front.triangle[:, ::-1]))
    return joined([front, back])


@dataclass(frozen=True)
class Noren:
    """A split curtain under the eaves. bottoms: the height of each panel's lower edge from left to right, metres.

    marked: the panels (counted from 0) that carry a round crest; a band of ``trim`` runs along every lower edge.
    """

    bottoms: tuple[float, ...]
    marked: tuple[int, ...]
    half_width: float
    z: float
    cloth: Colour
    trim: Colour
    crest: Colour
    rod: Colour

    def still(self) -> Mapping[str, list[Part]]:
        rod = leaning(lathe([(0.001, 0), (0.014, 0), (0.014, 1.0), (0.014, 2.0), (0.001, 2.0)], 16), (0, 0, -90))
        scale = self.half_width + 0.05
        bar = Mesh(rod.position * (scale, 1, 1) + (-scale, _ROD_Y_M, self.z), rod.normal, rod.triangle)
        return {"awning": [Part("rod", self.rod, bar, None)]}

    def moving(self) -> Sequence[Moving]:
        panels = []
        edges = np.linspace(-self.half_width, self.half_width, len(self.bottoms) + 1)
        for k, bottom in enumerate(self.bottoms):
            x0, x1 = float(edges[k]) + 0.004, float(edges[k + 1]) - 0.004
            panel = partial(_panel, x0, x1, _ROD_Y_M, bottom, self.z, float(k))
            parts = [Part("noren", self.cloth, two_sided(sheet(panel, 8, 6)), None, 0.8)]
            rim = partial(_panel, x0, x1, bottom + 0.020, bottom + 0.012, self.z + 0.0030, float(k))
            parts.append(Part("noren_trim", self.trim, sheet(rim, 8, 2), None, 0.0))
            if k in self.marked:
                parts += self._mark((x0 + x1) / 2, bottom + 0.095, x1 - x0, k)
            panels.append(Hanging(((x0 + x1) / 2, _ROD_Y_M, self.z), parts))
        return (Moving("noren", "sway", (1.0, 0.0, 0.0), 3.0, 3.4, panels),)

    def _mark(self, x: float, y: float, width: float, panel: int) -> list[Part]:
        """A ring round three willow leaves."""

        def surface(flat: Floats) -> tuple[Floats, Floats]:
            # Where the panel bulges: the same formula as the cloth's, at this height.
            z = self.z + _bulge(flat[:, 0], (_ROD_Y_M - flat[:, 1]) / (_ROD_Y_M - y + 0.095), float(panel))
            normal = np.tile([0.0, 0.0, 1.0], (len(flat), 1))
            return np.stack([flat[:, 0], flat[:, 1], z], 1), normal

        radius = min(0.062, width * 0.3)
        parts = [Part("mark", self.crest, _ring(x, y, radius, radius * 0.86, surface, 0.0085), None, 0.0)]
        for k in range(3):
            turn = 90.0 + 120.0 * k
            cx, cy = x + radius * 0.42 * np.cos(np.radians(turn)), y + radius * 0.42 * np.sin(np.radians(turn))
            leaf = disc(float(cx), float(cy), (radius * 0.40, radius * 0.17), 10, turn)
            parts.append(Part("mark", self.crest, inlay(leaf, surface, 0.0085, 2), None, 0.0))
        return parts


def _ring(
    x: float, y: float, outer: float, inner: float, surface: Callable[[Floats], tuple[Floats, Floats]], lift: float
) -> Mesh:
    """A flat ring painted on a surface."""
    angle = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
    around = np.stack([np.cos(angle), np.sin(angle)], 1)
    position, normal = surface(np.vstack([around * outer, around * inner]) + (x, y))
    k, after = np.arange(24), (np.arange(24) + 1) % 24
    triangle = np.vstack([np.stack([k, after, after + 24], 1), np.stack([k, after + 24, k + 24], 1)])
    return Mesh(position + normal * lift, normal, triangle)


_ROD_Y_M = 1.53


def _bulge(x: Floats, v: Floats, panel: float) -> Floats:
    return np.asarray((0.004 + 0.016 * v) * np.sin(x * 18 + panel * 1.7) + 0.010 * v)


def _panel(x0: float, x1: float, top: float, bottom: float, z: float, k: float, u: Floats, v: Floats) -> Surface:
    x, y = x0 + (x1 - x0) * u, top + (bottom - top) * v
    return x, y, z + _bulge(x, (_ROD_Y_M - y) / (_ROD_Y_M - bottom), k)


@dataclass(frozen=True)
class Lanterns:
    """Paper lanterns on cords. at: x, y (middle), z each; radius and height of the paper body, metres."""

    at: tuple[Vector, ...]
    radius: float
    height: float
    paper: Colour
    shadow: Colour
    rib: Colour
    cap: Colour
    mark: Colour

    def still(self) -> Mapping[str, list[Part]]:
        return {}

    def moving(self) -> Sequence[Moving]:
        hanging = [Hanging((x, y + self.height / 2 + 0.16, z), self._lantern(x, y, z)) for x, y, z in self.at]
        return (Moving("lanterns", "sway", (0.35, 0.0, 0.94), 4.0, 3.8, hanging),)

    def _lantern(self, x: float, y: float, z: float) -> list[Part]:
        r, h = self.radius, self.height / 2
        t = np.linspace(-1.0, 1.0, 8)
        swell = _swell(t) * r
        sides = 16  # few, and the same for all its parts: what moves is drawn anew in every frame
        body = lathe(np.stack([swell, t * h], 1), sides)
        glow, lower = split_at_level(body, body.position[:, 1] - t[2] * h + 1e-6)
        parts = [("paper", self.paper, glow, 0.9), ("paper", self.shadow, lower, 0.9)]
        for k in range(2, 7):
            y0 = float(t[k] * h)
            rib = lathe([(swell[k] + 0.0008, y0 - 0.0013), (swell[k] + 0.0008, y0 + 0.0013)], sides)
            parts.append(("rib", self.rib, rib, 0.0))
        for sign in (1.0, -1.0):
            cap = lathe([(r * 0.62, -0.012), (r * 0.64, 0.002), (r * 0.56, 0.014), (0.004, 0.015)], 12)
            parts.append(("cap", self.cap, leaning(cap, (0 if sign > 0 else 180, 0, 0), (0, sign * h, 0)), 0.9))
        parts.append(("cord", self.cap, cord([(0, h, 0), (0, h + 0.3, 0.001)], 0.003, 2, 4), 0.4))
        threads = lathe([(0.001, -0.068), (0.013, -0.066), (0.009, -0.020), (0.0075, -0.011), (0.0095, 0.0)], 7)
        parts.append(("tassel", self.mark, leaning(threads, (0, 0, 0), (0, -h - 0.016, 0)), 0.7))

        def surface(flat: Floats) -> tuple[Floats, Floats]:
            level = np.clip(flat[:, 1] / h, -1, 1)
            radius = r * _swell(level) * 1.02
            angle = flat[:, 0] / r
            normal = np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], 1)
            return normal * radius[:, None] + np.stack([angle * 0, flat[:, 1], angle * 0], 1), normal

        for k in range(3):
            turn = 90.0 + 120.0 * k
            cx, cy = 0.40 * r * np.cos(np.radians(turn)), 0.40 * r * np.sin(np.radians(turn))
            leaf = disc(float(cx), float(cy), (0.36 * r, 0.15 * r), 10, turn)
            parts.append(("mark", self.mark, inlay(leaf, surface, 0.002, 2), 0.0))
        return [Part(name, colour, mesh.placed((x, y, z)), None, outline) for name, colour, mesh, outline in parts]


def _swell(level: Floats) -> Floats:
    """Radius of a lantern's paper, as a share of the largest, at -1 (foot) to 1 (top)."""
    return np.asarray(0.52 + 0.48 * np.sqrt(np.maximum(1 - (level * 0.94) ** 2, 0.0)))
