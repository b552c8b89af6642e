"""The goods of the flea market: a grandmother's household. Each stands on (0, 0, 0) and faces +Z."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from game.tools.modelling.fields import (
    Field,
    Floats,
    cone,
    ellipsoid,
    intersection,
    offset,
    plane,
    ring,
    smooth_max,
    sphere,
    union,
)
from game.tools.modelling.goods_shapes import Good, banded, part, solid, standing, stroke, turned
from game.tools.modelling.lofts import loft, rounded_box, smooth_curve
from game.tools.modelling.mesh import Mesh
from game.tools.modelling.parts import Part

__all__ = ["FLEA_GOODS", "cups"]


def teapot(material: str, scale: float) -> list[Part]:
    """Round body, bent spout to +X, ring handle, lid with a knob."""
    s = scale
    body = ellipsoid((0, 0.055 * s, 0), np.array([0.066, 0.054, 0.066]) * s)
    bend = np.array([0.095, 0.070, 0]) * s
    spout = union(
        0.006 * s,
        cone(np.array([0.045, 0.045, 0]) * s, bend, 0.020 * s, 0.012 * s),
        cone(bend, np.array([0.115, 0.105, 0]) * s, 0.012 * s, 0.009 * s),
    )
    handle = ring(np.array([-0.072, 0.060, 0]) * s, 0.040 * s, 0.0085 * s, axis=2)
    pot = standing(union(0.006 * s, union(0.012 * s, body, spout), handle))
    low, high = (-0.14 * s, -0.01 * s, -0.09 * s), (0.14 * s, 0.13 * s, 0.09 * s)
    lid_profile = [
        *((0.040, 0.098), (0.034, 0.106), (0.020, 0.115), (0.006, 0.118)),
        *((0.009, 0.126), (0.012, 0.134), (0.001, 0.142)),
    ]
    lid = turned([(r * s, y * s) for r, y in lid_profile], 28, 4)
    foot = turned([(0.030 * s, 0.0), (0.040 * s, 0.001), (0.041 * s, 0.006 * s), (0.036 * s, 0.010 * s)], 28, 2)
    return [
        part("teapot", material, solid(pot, low, high, 0.0045, 3600), 1.0),
        part("teapot_lid", material, lid),
        part("teapot_foot", material, foot, 0.6),
    ]


def books() -> list[Part]:
    parts = []
    base = 0.0
    for width, height, cover, turn in (
        (0.115, 0.020, "blue", 0.21),
        (0.105, 0.024, "red_cloth", -0.10),
        (0.095, 0.018, "leaf", 0.31),
    ):
        parts.append(part("book", cover, rounded_box((0, base + height, 0), (width, height, 0.075), 0.004, turn)))
        # The pages show on three sides, a little inside the cover.
        block = rounded_box((0.004, base + height, 0.004), (width - 0.004, height - 0.006, 0.0755), 0.002, turn)
        parts.append(part("pages", "paper", block, 0.4))
        for x in (-0.62, 0.62):
            c, s = np.cos(turn), np.sin(turn)
            at = np.array([x * width * c, base + height, -x * width * s])
            parts.append(part("book_band", "gold", rounded_box(at, (0.004, height + 0.0008, 0.0754), 0.002, turn), 0.0))
        base += 2 * height
    return parts


def vase() -> list[Part]:
    """Porcelain with blue bands, and seven flowers."""
    s = 1.25
    profile = [
        *((0.001, 0), (0.034, 0.002), (0.052, 0.050), (0.056, 0.090), (0.030, 0.135)),
        *((0.020, 0.155), (0.028, 0.175), (0.024, 0.174), (0.015, 0.150)),
    ]
    rest = turned([(r * s, y * s) for r, y in profile], 40, 6)
    parts = []
    for low, high in ((0.052, 0.060), (0.070, 0.100), (0.108, 0.113)):
        band, rest = banded(rest, low * s, high * s)
        parts.append(part("vase_band", "blue", band, 0.9))
    parts.append(part("vase", "porcelain", rest))
    for k in range(7):
        angle, height = k * 2.4, 0.30 + 0.07 * np.sin(k * 3.1)
        radius = 0.074 + 0.022 * np.cos(k * 1.7)
        tip = np.array([radius * np.cos(angle), height, radius * 0.8 * np.sin(angle)])
        mouth = np.array([0.0, 0.19, 0.0])
        stem = smooth_curve([mouth, (mouth + tip) / 2 + (0, 0.02, 0), tip], 10)
        parts.append(part("stem", "green", loft(stem, np.tile([0.0, 0, 1], (10, 1)), 0.004, 0.004, 6, "round"), 0.5))
        parts += _flower(tip, k)
    for k in range(4):
        angle = 0.7 + k * 1.6
        reach = np.array([0.085 * np.cos(angle), 0.25 + 0.02 * (k % 2), 0.07 * np.sin(angle)])
        path = smooth_curve(np.array([(0, 0.19, 0), reach * (0.6, 0.93, 0.6), reach]), 9)
        width = 0.014 * np.sin(np.pi * np.clip(np.linspace(0.12, 1.0, 9), 0, 1)) + 0.001
        leaf = loft(path, np.tile([0.0, 1.0, 0.3], (9, 1)), width, 0.002, 6)
        parts.append(part("leaf", "leaf", leaf, 0.6))
    return parts


def _flower(tip: Floats, number: int) -> list[Part]:
    petals = [
        ellipsoid(tip + (np.cos(a) * 0.022, np.sin(a) * 0.022, 0.004), (0.017, 0.017, 0.010))
        for a in np.arange(5) * 2 * np.pi / 5 + number
    ]
    low, high = tuple(tip - 0.055), tuple(tip + 0.055)
    bloom = solid(union(0.002, *petals), low, high, 0.004, 420)
    heart = turned([(0.011, 0.0), (0.009, 0.006), (0.0005, 0.009)], 12, 3)
    # The lathe turns about +Y; a flower looks at the customer.
    heart = Mesh(
        heart.position[:, [0, 2, 1]] * (1, -1, 1) + tip + (0, 0, 0.010),
        heart.normal[:, [0, 2, 1]] * (1, -1, 1),
        heart.triangle,
    )
    return [
        part("flower", ("pink", "porcelain", "gold")[number % 3], bloom, 0.7),
        part("flower_heart", "red" if number % 3 == 2 else "gold", heart, 0.4),
    ]


def cups() -> list[Part]:
    parts = []
    for x, z, material in ((-0.045, -0.03, "porcelain"), (0.045, 0.03, "pink")):
        outline = [
            *((0.001, 0.002), (0.018, 0.002), (0.022, 0.008), (0.033, 0.050)),
            *((0.035, 0.056), (0.031, 0.056), (0.020, 0.012), (0.001, 0.010)),
        ]
        cup = turned(outline, 32, 4)
        band, rest = banded(cup, 0.040, 0.046)
        parts.append(part("cup", material, rest.placed((x, 0, z)), 0.8))
        parts.append(part("cup_band", "blue" if material == "porcelain" else "red", band.placed((x, 0, z)), 0.8))
    return parts


def alarm_clock() -> list[Part]:
    def drum(radius: float, half_depth: float, z: float, k: float) -> Field:
        return lambda p: smooth_max(np.hypot(p[:, 0], p[:, 1] - 0.075) - radius, np.abs(p[:, 2] - z) - half_depth, k)

    case = solid(drum(0.068, 0.030, 0.0, 0.014), (-0.09, -0.01, -0.06), (0.09, 0.17, 0.06), 0.004, 2400)
    dial = solid(drum(0.054, 0.005, 0.028, 0.003), (-0.07, 0.0, 0.0), (0.07, 0.15, 0.05), 0.003, 1400)
    parts = [part("clock", "red", case, 1.0), part("dial", "paper", dial, 0.5)]
    for side in (1.0, -1.0):
        bell = union(
            0.004,
            intersection(
                0.004, sphere((side * 0.042, 0.142, 0), 0.026), plane((side * 0.036, 0.136, 0), (-side * 0.35, -1, 0))
            ),
            cone((side * 0.04, 0.135, 0), (side * 0.030, 0.115, 0), 0.006, 0.006),
        )
        low, high = (side * 0.042 - 0.04, 0.09, -0.04), (side * 0.042 + 0.04, 0.19, 0.04)
        parts.append(part("bell", "gold", solid(bell, low, high, 0.003, 900), 0.7))
        leg = cone((side * 0.035, 0.02, 0), (side * 0.05, 0.005, 0), 0.008, 0.006)
        low, high = (side * 0.04 - 0.03, -0.01, -0.02), (side * 0.04 + 0.03, 0.04, 0.02)
        parts.append(part("leg", "gold", solid(leg, low, high, 0.004, 200), 0.6))
    handle = stroke([(-0.03, 0.165, 0), (0, 0.186, 0), (0.03, 0.165, 0)], 0.004, 0.004, 12)
    parts.append(part("clock_handle", "gold", handle, 0.6))
    for angle, length in ((0.87, 0.036), (-0.70, 0.026)):
        tip = (np.sin(angle) * length, 0.075 + np.cos(angle) * length, 0.035)
        middle = (tip[0] / 2, (tip[1] + 0.075) / 2, 0.035)
        parts.append(part("hand", "dark", stroke([(0, 0.075, 0.035), middle, tip], 0.0032, 0.0015, 4), 0.0))
    for k in range(12):
        s, c = np.sin(k * np.pi / 6), np.cos(k * np.pi / 6)
        near, far = 0.044, 0.051 if k % 3 == 0 else 0.048
        points = [(s * r, 0.075 + c * r, 0.0335) for r in (near, (near + far) / 2, far)]
        parts.append(part("tick", "dark", stroke(points, 0.0022 if k % 3 == 0 else 0.0014, 0.001, 3), 0.0))
    return parts


def lucky_cat() -> list[Part]:
    """A beckoning cat: one paw up, red collar with a bell, a gold coin on the belly."""
    s = 1.12

    def at(x: float, y: float, z: float) -> Floats:
        return np.array([x, y, z]) * s

    def size(*radii: float) -> Floats:
        return np.array(radii) * s

    body = union(
        0.03 * s,
        ellipsoid(at(0, 0.055, 0), size(0.062, 0.058, 0.050)),
        ellipsoid(at(0, 0.150, 0.004), size(0.064, 0.054, 0.054)),
        ellipsoid(at(0.034, 0.018, 0.038), size(0.024, 0.018, 0.026)),
        ellipsoid(at(-0.034, 0.018, 0.038), size(0.024, 0.018, 0.026)),
    )
    ears = union(
        0.001, *(cone(at(k * 0.038, 0.178, 0), at(k * 0.052, 0.222, 0), 0.026 * s, 0.006 * s) for k in (1, -1))
    )
    arm = union(
        0.012,
        cone(at(-0.050, 0.085, 0.020), at(-0.088, 0.125, 0.035), 0.020 * s, 0.019 * s),
        cone(at(-0.088, 0.125, 0.035), at(-0.086, 0.178, 0.045), 0.019 * s, 0.022 * s),
    )
    tail = cone(at(0.045, 0.035, -0.040), at(0.082, 0.075, -0.045), 0.015 * s, 0.012 * s)
    cat = standing(union(0.012 * s, union(0.014 * s, union(0.012 * s, body, ears), arm), tail))
    low, high = (-0.14, -0.01, -0.09), (0.13, 0.28, 0.10)
    parts = [part("cat", "porcelain", solid(cat, low, high, 0.0045, 5200), 0.9)]
    collar = ring(at(0, 0.104, 0), 0.050 * s, 0.0085 * s)
    parts.append(part("collar", "red", solid(collar, (-0.08, 0.09, -0.08), (0.08, 0.15, 0.08), 0.004, 1500), 0.6))
    bell = sphere(at(0, 0.092, 0.058), 0.016 * s)
    parts.append(part("bell", "gold", solid(bell, (-0.03, 0.07, 0.03), (0.03, 0.14, 0.10), 0.004, 500), 0.7))

    def coin(p: Floats) -> Floats:
        oval = np.hypot((p[:, 0] - 0.028 * s) / 0.8, p[:, 1] - 0.050 * s) - 0.026 * s
        return smooth_max(oval, np.abs(p[:, 2] - 0.055 * s) - 0.006, 0.004)

    parts.append(part("coin", "gold", solid(coin, (-0.02, 0.0, 0.03), (0.08, 0.12, 0.09), 0.003, 900), 0.7))
    for k in (1.0, -1.0):
        eye = [(k * 0.040, 0.156, 0.046), (k * 0.030, 0.166, 0.053), (k * 0.019, 0.156, 0.058)]
        parts.append(part("eye", "dark", stroke([tuple(at(*p)) for p in eye], 0.0034, 0.003), 0.0))
        blush = ellipsoid(at(k * 0.040, 0.137, 0.049), size(0.011, 0.008, 0.006))
        low, high = (k * 0.045 - 0.025, 0.13, 0.03), (k * 0.045 + 0.025, 0.18, 0.08)
        parts.append(part("cheek", "pink", solid(blush, low, high, 0.003, 220), 0.0))
        inner = intersection(
            0.003,
            cone(at(k * 0.041, 0.186, 0.014), at(k * 0.050, 0.212, 0.008), 0.017 * s, 0.005 * s),
            plane(at(0, 0, 0.006), (0, 0, -1)),
        )
        inner = intersection(0.002, inner, offset(cat, 0.0032))
        low, high = (k * 0.05 - 0.04, 0.17, -0.02), (k * 0.05 + 0.04, 0.27, 0.05)
        parts.append(part("ear", "pink", solid(inner, low, high, 0.003, 400), 0.0))
        for row in (0, 1):
            whisker = [(k * 0.046, 0.146 - row * 0.010, 0.0475), (k * 0.057, 0.147 - row * 0.012, 0.036)]
            ends = [
                tuple(at(*whisker[0])),
                tuple(at(*((np.array(whisker[0]) + whisker[1]) / 2 + (0, 0, 0.003)))),
                tuple(at(*whisker[1])),
            ]
            parts.append(part("whisker", "dark", stroke(ends, 0.0010, 0.001, 5), 0.0))
    smile = [
        (-0.013, 0.142, 0.0590),
        (-0.006, 0.137, 0.0600),
        (0, 0.143, 0.0605),
        (0.006, 0.137, 0.0600),
        (0.013, 0.142, 0.0590),
    ]
    parts.append(part("smile", "dark", stroke([tuple(at(*p)) for p in smile], 0.0023, 0.002, 16), 0.0))
    nose = ellipsoid(at(0, 0.148, 0.059), size(0.006, 0.004, 0.004))
    parts.append(part("nose", "red", solid(nose, (-0.02, 0.15, 0.05), (0.02, 0.18, 0.08), 0.002, 200), 0.0))
    return parts


FLEA_GOODS: Mapping[str, Good] = {
    "teapot_gold": lambda: teapot("gold", 0.95),
    "teapot_teal": lambda: teapot("teal", 1.25),
    "books": books,
    "vase": vase,
    "lucky_cat": lucky_cat,
    "cups": cups,
    "alarm_clock": alarm_clock,
}
"""Item id -> its parts."""
