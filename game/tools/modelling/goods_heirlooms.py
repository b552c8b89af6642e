"""Antiques, the stately: folding fan and incense burner. Each stands on (0, 0, 0) and faces +Z."""

from __future__ import annotations

from functools import partial

import numpy as np

from game.tools.modelling.fields import (
    Field,
    Floats,
    cone,
    ellipsoid,
    intersection,
    plane,
    smooth_max,
    sphere,
    subtraction,
    union,
)
from game.tools.modelling.goods_shapes import (
    cord,
    cut_below,
    disc,
    inlay,
    leaning,
    onto,
    part,
    solid,
    spun,
    star,
    tassel,
)
from game.tools.modelling.lofts import lathe, loft, rounded_box, sheet, smooth_curve
from game.tools.modelling.mesh import split_at_level
from game.tools.modelling.parts import Part

__all__ = ["folding_fan", "incense_burner"]

_FAN_PIVOT = (0.0, 0.040, 0.0)
_FAN_HALF_RAD = 1.26
_FAN_FOLDS = 14


def _fan_leaf(z: float, u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """u from left to right over the folds, v from the inner to the outer edge."""
    angle = (2 * u - 1) * _FAN_HALF_RAD
    radius = 0.075 + 0.125 * v
    zigzag = np.abs((u * _FAN_FOLDS) % 1.0 * 2 - 1)
    depth = z + (zigzag - 0.5) * (0.003 + 0.006 * v)
    return radius * np.sin(angle), _FAN_PIVOT[1] + radius * np.cos(angle), depth


def _fan_figures(angle: Floats, radius: Floats) -> dict[str, Floats]:
    """Level functions over (angle, radius) in metres of arc: above 0 inside the painted figure."""
    x, y = angle * 0.15, radius

    def leaf(cx: float, cy: float, size: float, turn: float) -> Floats:
        dx, dy = x - cx, y - cy
        r, a = np.hypot(dx, dy), np.arctan2(dx, dy) + turn
        lobes = np.abs(np.cos(2.5 * a)) ** 1.7 * (0.78 + 0.22 * np.cos(a))
        stalk = np.minimum(0.0016 - np.abs(r * np.sin(a)), np.where(np.cos(a) < 0, size * 0.95 - r, -1.0))
        return np.asarray(np.maximum(size * (0.26 + 0.74 * lobes) - r, stalk))

    red = np.max(
        [leaf(-0.100, 0.150, 0.038, 0.4), leaf(0.012, 0.166, 0.030, -0.9), leaf(0.132, 0.128, 0.032, 2.1)], axis=0
    )
    amber = np.max(
        [leaf(-0.040, 0.128, 0.028, -0.5), leaf(0.112, 0.172, 0.024, 0.7), leaf(-0.152, 0.116, 0.024, 1.2)], axis=0
    )
    stream = np.max([0.0030 - np.abs(y - 0.104 - k * 0.012 - 0.006 * np.sin(x * 34 + k)) for k in range(3)], axis=0)
    stream = np.minimum(stream, 0.085 - np.abs(x - 0.040))
    sun = 0.030 - np.hypot(x - 0.062, y - 0.146)
    return {"maple_red": red, "gold": amber, "stream_blue": stream, "sun_gold": sun}


def folding_fan() -> list[Part]:
    """An open fan on a lacquered stand: maple leaves over a stream on gold-dusted paper, bamboo ribs behind."""
    parts = []
    for front in (True, False):
        z = 0.0012 if front else -0.0012
        facing = (0.0, 0.0, 1.0 if front else -1.0)
        columns, rows = (6 * _FAN_FOLDS + 1, 17) if front else (2 * _FAN_FOLDS + 1, 3)
        mesh = sheet(partial(_fan_leaf, z), columns, rows, facing)
        x, y = mesh.position[:, 0], mesh.position[:, 1] - _FAN_PIVOT[1]
        if not front:
            rim, plain = split_at_level(mesh, np.hypot(x, y) - 0.188)
            parts += [part("leaf_back", "paper", plain, 1.0), part("leaf_edge", "plum", rim, 1.0), *_poem()]
            continue
        # Painted from the top layer down, so that each figure covers those after it.
        rest = mesh
        for colour in ("maple_red", "gold", "stream_blue", "sun_gold"):
            x, y = rest.position[:, 0], rest.position[:, 1] - _FAN_PIVOT[1]
            inside, rest = split_at_level(rest, _fan_figures(np.arctan2(x, y), np.hypot(x, y))[colour])
            material = {"sun_gold": "old_gold"}.get(colour, colour)
            parts.append(part("painting", material, inside, 0.0))
        x, y = rest.position[:, 0], rest.position[:, 1] - _FAN_PIVOT[1]
        edge, rest = split_at_level(rest, np.hypot(x, y) - 0.194)
        parts += [part("leaf", "paper", rest, 1.0), part("leaf_edge", "plum", edge, 1.0)]
    for k in range(_FAN_FOLDS + 1):
        angle = (2 * k / _FAN_FOLDS - 1) * _FAN_HALF_RAD
        guard = k in (0, _FAN_FOLDS)
        width, colour = (0.0058, "lacquer") if guard else (0.0034, "bamboo")
        end = 0.203 if guard else 0.196
        r = np.array([-0.016, 0.03, 0.075, end])
        z = 0.0040 * (k % 2) - 0.0045 if not guard else 0.0
        path = np.stack([r * np.sin(angle), _FAN_PIVOT[1] + r * np.cos(angle), np.full(4, z)], 1)
        widths = width * np.array([1.2, 1.0, 0.9, 0.8])
        rib = loft(path, np.tile([0.0, 0, 1], (4, 1)), widths, 0.006 if guard else 0.0018, 6, "band")
        parts.append(part("rib", colour, rib, 0.6))
    for z in (0.008, -0.008):
        rivet = spun([(0.0065, -0.002), (0.0065, 0.001), (0.0005, 0.003)], 12, 5)
        parts.append(part("rivet", "gold", leaning(rivet, (90 if z > 0 else -90, 0, 0), (0, _FAN_PIVOT[1], z)), 0.4))
    # The stand: a foot, two curved arms that cradle the guards, and a tassel from the rivet.
    foot = rounded_box((0, 0.008, 0), (0.070, 0.008, 0.036), 0.006, cuts=4)
    parts.append(part("foot", "lacquer", foot, 1.0))
    parts.append(
        part("foot_line", "old_gold", rounded_box((0, 0.0090, 0), (0.0706, 0.0012, 0.0366), 0.001, cuts=3), 0.0)
    )
    for side in (-1.0, 1.0):
        arm = [
            (side * 0.014, 0.012, -0.016),
            (side * 0.040, 0.040, -0.018),
            (side * 0.072, 0.062, -0.016),
            (side * 0.086, 0.064, 0.002),
            (side * 0.090, 0.074, 0.014),
        ]
        radius = np.interp(np.linspace(0, 1, 9), [0, 0.3, 1.0], [0.0075, 0.0062, 0.002])
        parts.append(part("arm", "dark_wood", cord(arm, radius, 9, 7), 0.8))
    post = spun([(0.009, 0.014), (0.007, 0.026), (0.010, 0.034), (0.004, 0.036)], 12, 7)
    parts.append(part("post", "dark_wood", leaning(post, (0, 0, 0), (0, 0, 0.0)), 0.6))
    string = [(0, 0.040, 0.010), (0.014, 0.034, 0.024), (0.030, 0.024, 0.034), (0.044, 0.012, 0.044)]
    parts.append(part("string", "silk", cord(string, 0.0017, 12), 0.4))
    threads = leaning(tassel(0.026, 0.0075), (78, 40, 0), (0.046, 0.0085, 0.046))
    parts.append(part("tassel", "silk", threads, 0.6))
    return parts


def _poem() -> list[Part]:
    """Four lines in a quick hand on the back, one to a fold, from right to left as seen from there."""
    parts = []
    wobble = np.array([0.0, 1.0, -0.7, 0.5, -1.0, 0.8, -0.4, 0.9, -0.2])
    for line, fold in enumerate((3, 4, 5, 6, 9)):
        u = (fold + 0.5) / _FAN_FOLDS
        v = np.linspace(0.86, 0.30 + 0.07 * line, 9)
        swing = 0.010 * np.roll(wobble, line) / _FAN_FOLDS * 14 * 0.35
        x, y, _ = _fan_leaf(0.0, u + swing * 0.6, v)
        path = smooth_curve(np.stack([x, y, np.full(9, -0.0075)], 1), 15)
        width = 0.0008 + 0.0012 * np.abs(np.sin(np.arange(15) * 1.9 + line))
        parts.append(part("poem", "ink", loft(path, np.tile([0.0, 0, -1], (15, 1)), width, 0.0005, 4, "round"), 0.0))
    seal = star(0.0, 0.0, 0.006, 4, 0.10, 1.0, 45.0)
    x, y, _ = _fan_leaf(0.0, np.array([9.5 / _FAN_FOLDS]), np.array([0.20]))
    at = np.array([float(x[0]), float(y[0])])

    def surface(flat: Floats) -> tuple[Floats, Floats]:
        return np.column_stack([flat, np.full(len(flat), -0.0075)]), np.tile([0.0, 0.0, -1.0], (len(flat), 1))

    parts.append(part("seal", "vermilion", inlay(seal + at, surface, 0.0), 0.0))
    return parts


def incense_burner() -> list[Part]:
    """Bronze on three legs, cloud scrolls and verdigris, a pierced lid with a lion-dog for a knob."""
    belly = ellipsoid((0, 0.078, 0), (0.074, 0.048, 0.074))
    neck = _drum(0.052, 0.108, 0.016)
    legs = [
        union(
            0.008,
            cone((0.052 * s, 0.050, 0.052 * c), (0.066 * s, 0.020, 0.066 * c), 0.017, 0.010),
            cone((0.066 * s, 0.020, 0.066 * c), (0.062 * s, 0.006, 0.062 * c), 0.010, 0.013),
        )
        for s, c in ((float(np.sin(a)), float(np.cos(a))) for a in (np.pi / 6 * k for k in (0, 4, 8)))
    ]
    ears = [
        union(
            0.004,
            cone((side * 0.064, 0.098, 0), (side * 0.094, 0.116, 0), 0.0085, 0.0075),
            cone((side * 0.094, 0.116, 0), (side * 0.090, 0.150, 0), 0.0075, 0.008),
            cone((side * 0.090, 0.150, 0), (side * 0.074, 0.152, 0), 0.008, 0.006),
        )
        for side in (-1.0, 1.0)
    ]
    pot = union(0.010, union(0.012, belly, neck), *legs, *ears)
    pot = cut_below(pot)
    body = solid(pot, (-0.125, -0.01, -0.10), (0.125, 0.18, 0.10), 0.0045, 1500)
    rim = spun([(0.046, 0.122), (0.060, 0.120), (0.064, 0.126), (0.060, 0.132), (0.048, 0.132)], 30, 10)
    patina, bronze = split_at_level(
        body,
        0.010
        - np.abs(body.position[:, 1] - 0.101)
        + 0.004 * np.sin(5 * np.arctan2(body.position[:, 0], body.position[:, 2])),
    )
    feet, bronze = split_at_level(bronze, 0.018 - bronze.position[:, 1] + 0.003 * np.sin(bronze.position[:, 0] * 300))
    parts = [
        part("pot", "bronze", bronze, 1.0),
        part("patina", "verdigris", patina, 1.0),
        part("feet", "verdigris", feet, 1.0),
        part("rim", "old_gold", rim, 0.6),
    ]
    surface = partial(_around_belly, (0.074, 0.048, 0.074), 0.078)
    for k in range(6):
        azimuth = 2 * np.pi * k / 6 + np.pi / 6
        for dx, dy, r in ((-0.015, 0.0, 0.0115), (0.0, 0.006, 0.0135), (0.014, -0.001, 0.0105)):
            x, y = float(azimuth * 0.074 + dx), dy - 0.004
            parts.append(part("scroll", "old_gold", inlay(disc(x, y, r, 14), surface, 0.0012, 2), 0.0))
            parts.append(part("scroll", "bronze_deep", inlay(disc(x, y, r * 0.72, 12), surface, 0.0020, 1), 0.0))
            eye = disc(x + r * 0.15, y, r * 0.38, 9)
            parts.append(part("scroll", "old_gold", inlay(eye, surface, 0.0025, 1), 0.0))
    # The lid: a dome, truly pierced (a shell with holes), dark within.
    dome = intersection(
        0.002,
        subtraction(
            0.001, ellipsoid((0, 0.130, 0), (0.052, 0.042, 0.052)), ellipsoid((0, 0.130, 0), (0.046, 0.036, 0.046))
        ),
        plane((0, 0.132, 0), (0, -1, 0)),
    )
    holes = []
    for ring, count, height, size in ((0, 10, 0.142, 0.0072), (1, 8, 0.1575, 0.0058)):
        for k in range(count):
            a = 2 * np.pi * (k + 0.5 * ring) / count
            out = np.array([np.sin(a), 0.5 + 0.5 * ring, np.cos(a)])
            at = np.array([0.05 * np.sin(a) * (1 - 0.33 * ring), height, 0.05 * np.cos(a) * (1 - 0.33 * ring)])
            holes.append(cone(at - out * 0.014, at + out * 0.014, size * 0.9, size))
    lid = subtraction(0.0015, dome, *holes)
    parts.append(part("lid", "bronze", solid(lid, (-0.06, 0.125, -0.06), (0.06, 0.18, 0.06), 0.0019, 1500), 0.7))
    ash = lathe([(0.0475, 0.133), (0.044, 0.150), (0.028, 0.163), (0.001, 0.166)], 20)
    parts.append(part("ash", "ash", ash, 0.0))
    lion = union(
        0.008,
        ellipsoid((0, 0.180, -0.004), (0.013, 0.013, 0.017)),
        sphere((0, 0.199, 0.008), 0.0125),
        cone((0.009, 0.180, 0.010), (0.010, 0.170, 0.016), 0.0055, 0.006),
        cone((-0.009, 0.180, 0.010), (-0.010, 0.170, 0.016), 0.0055, 0.006),
        cone((0, 0.184, -0.018), (0, 0.206, -0.022), 0.007, 0.004),
        ellipsoid((0, 0.195, 0.019), (0.0075, 0.0055, 0.006)),
        sphere((0.009, 0.208, 0.004), 0.0042),
        sphere((-0.009, 0.208, 0.004), 0.0042),
    )
    parts.append(part("lion", "old_gold", solid(lion, (-0.03, 0.16, -0.04), (0.03, 0.23, 0.04), 0.0026, 520), 0.7))
    for side in (-1.0, 1.0):
        eye = disc(side * 0.0045, 0.2025, 0.0017, 8)
        parts.append(part("lion_eye", "ink", inlay(eye, onto(lion, (0, 0, 0.06), (1, 0, 0), (0, 1, 0)), 0.0006), 0.0))
    base = spun([(0.001, 0.0), (0.090, 0.0), (0.094, 0.004), (0.090, 0.009), (0.080, 0.010), (0.001, 0.0105)], 32, 14)
    parts = [part(p.name, p.material, p.mesh.placed((0, 0.010, 0)), p.outline) for p in parts]
    parts += [part("base", "dark_wood", base, 0.9)]
    line = lathe([(0.0935, 0.0030), (0.0950, 0.0045), (0.0935, 0.0060)], 32)
    parts.append(part("base_line", "old_gold", line, 0.0))
    return parts


def _drum(radius: float, y: float, half: float) -> Field:
    return lambda p: smooth_max(np.hypot(p[:, 0], p[:, 2]) - radius, np.abs(p[:, 1] - y) - half, 0.008)


def _around_belly(radii: tuple[float, float, float], y: float, flat: Floats) -> tuple[Floats, Floats]:
    """Arc length round the belly and height above its middle -> places on an ellipsoid of revolution."""
    height = np.clip(flat[:, 1] / radii[1], -0.95, 0.95)
    r = radii[0] * np.sqrt(1 - height**2)
    angle = flat[:, 0] / radii[0]
    position = np.stack([r * np.sin(angle), y + flat[:, 1], r * np.cos(angle)], 1)
    normal = (position - (0, y, 0)) / np.square(np.array(radii))
    return position, normal / np.linalg.norm(normal, axis=1, keepdims=True)
