"""A wooden train: engine and two wagons on a strip of track. It stands on (0, 0, 0) and faces +Z, its head to −X."""

from __future__ import annotations

from functools import partial

import numpy as np

from game.tools.modelling.fields import Floats
from game.tools.modelling.goods_shapes import cord, cylinder, disc, facing, inlay, leaning, part, spun, star, stroke
from game.tools.modelling.lofts import lathe, rounded_box
from game.tools.modelling.parts import Part

__all__ = ["toy_train"]


def _wheel(x: float, y: float, z: float, radius: float, colour: str) -> list[Part]:
    """A spoked wheel in the plane of the train's side, seen from +Z and from −Z."""
    rim = [(1e-4, -0.0042), (radius, -0.0036), (radius, 0.0036), (1e-4, 0.0042)]
    tyre = leaning(lathe(rim, 16), (90, 0, 0), (x, y, z))
    parts = [part("tyre", "dark", tyre, 0.8)]
    side = 1.0 if z > 0 else -1.0

    def face(flat: Floats) -> tuple[Floats, Floats]:
        return np.column_stack([x + flat[:, 0], y + flat[:, 1], np.full(len(flat), z + side * 0.0043)]), np.tile(
            [0.0, 0.0, side], (len(flat), 1)
        )

    parts.append(part("wheel", colour, inlay(disc(0, 0, radius * 0.82, 18), face, 0.0002), 0.0))
    for k in range(4):
        parts.append(
            part(
                "hole",
                "dark",
                inlay(
                    disc(
                        radius * 0.46 * np.cos(k * np.pi / 2 + 0.78),
                        radius * 0.46 * np.sin(k * np.pi / 2 + 0.78),
                        radius * 0.19,
                        8,
                    ),
                    face,
                    0.0006,
                ),
                0.0,
            )
        )
    parts.append(part("hub", "brass", inlay(disc(0, 0, radius * 0.22, 10), face, 0.0010), 0.0))
    return parts


def toy_train() -> list[Part]:
    """A wooden engine with brass trim, a wagon of building blocks and one with passengers, on a strip of track."""
    parts: list[Part] = []

    def block(
        name: str,
        colour: str,
        at: tuple[float, float, float],
        half: tuple[float, float, float],
        r: float = 0.003,
        outline: float = 0.8,
    ) -> None:
        parts.append(part(name, colour, rounded_box(at, half, r, cuts=3), outline))

    for k in range(12):
        block("sleeper", "wood_dark", (-0.165 + k * 0.030, 0.0035, 0), (0.006, 0.0035, 0.036), 0.0015, 0.5)
    for z in (-0.020, 0.020):
        block("rail", "wood_pale", (0, 0.0085, z), (0.178, 0.0025, 0.004), 0.0012, 0.5)
    low = 0.012
    # The engine heads to −X, toward the middle of the stall.
    block("frame", "red", (-0.112, low + 0.020, 0), (0.058, 0.006, 0.024), 0.003)
    boiler = leaning(cylinder(0.0215, 0.037, 22, 0.003), (0, 0, 90), (-0.130, low + 0.046, 0))
    parts.append(part("boiler", "green", boiler, 1.0))
    for x in (-0.152, -0.124, -0.100):
        hoop = leaning(cylinder(0.0222, 0.0022, 22, 0.0006), (0, 0, 90), (x, low + 0.046, 0))
        parts.append(part("hoop", "brass", hoop, 0.4))
    nose = leaning(
        spun([(0.0195, 0.0), (0.018, 0.005), (0.008, 0.008), (0.0005, 0.009)], 20, 8),
        (0, 0, 90),
        (-0.167, low + 0.046, 0),
    )
    parts.append(part("nose", "dark", nose, 0.7))
    lamp = leaning(spun([(0.0085, 0.0), (0.0085, 0.007), (0.0005, 0.009)], 14, 6), (0, 0, 90), (-0.172, low + 0.048, 0))
    parts.append(part("lamp", "lamp", lamp, 0.5))
    chimney = spun(
        [(0.009, 0.0), (0.0085, 0.018), (0.0145, 0.032), (0.0150, 0.036), (0.0105, 0.036), (0.0085, 0.028)], 18, 12
    )
    parts.append(part("chimney", "dark", chimney.placed((-0.150, low + 0.064, 0)), 0.8))
    parts.append(
        part(
            "chimney_ring",
            "brass",
            lathe([(0.0146, -0.002), (0.0158, 0.0), (0.0146, 0.002)], 18).placed((-0.150, low + 0.0955, 0)),
            0.3,
        )
    )
    dome = spun([(0.0105, 0.0), (0.0105, 0.008), (0.006, 0.014), (0.0005, 0.0155)], 16, 8)
    parts.append(part("dome", "brass", dome.placed((-0.118, low + 0.064, 0)), 0.6))
    whistle = spun([(0.003, 0.0), (0.003, 0.012), (0.0045, 0.013), (0.0005, 0.018)], 10, 6)
    parts.append(part("whistle", "brass", whistle.placed((-0.102, low + 0.065, 0)), 0.4))
    block("cab", "green", (-0.074, low + 0.052, 0), (0.021, 0.028, 0.023), 0.003)
    block("cab_roof", "red", (-0.073, low + 0.084, 0), (0.027, 0.0045, 0.028), 0.004)
    for z in (-0.0236, 0.0236):
        block("window", "cream", (-0.074, low + 0.062, z), (0.0130, 0.0110, 0.0008), 0.0006, 0.0)
        block("window_glass", "sky", (-0.074, low + 0.062, z * 1.03), (0.0105, 0.0085, 0.0008), 0.0006, 0.0)
        rod = cord(
            [(-0.148, low + 0.010, z * 1.26), (-0.118, low + 0.012, z * 1.28), (-0.088, low + 0.010, z * 1.26)],
            0.0020,
            5,
            6,
        )
        parts.append(part("rod", "brass", rod, 0.4))
    block("number", "cream", (-0.0531, low + 0.046, 0), (0.0006, 0.010, 0.012), 0.0004, 0.0)
    plough = [(-0.170, low + 0.014), (-0.186, low - 0.004), (-0.170, low - 0.004)]
    for z in (-0.014, 0.0, 0.014):
        bars = [(x, y, z) for x, y in plough[:2]]
        parts.append(
            part(
                "plough",
                "red",
                cord([bars[0], ((bars[0][0] + bars[1][0]) / 2 - 0.003, low + 0.003, z), bars[1]], 0.0030, 4, 6),
                0.5,
            )
        )
    for z in (-0.0285, 0.0285):
        parts += _wheel(-0.088, low + 0.0145, z, 0.0145, "red")
        parts += _wheel(-0.118, low + 0.0145, z, 0.0145, "red")
        parts += _wheel(-0.148, low + 0.0105, z, 0.0105, "red")
    parts += _wagon(0.012, low, "mustard", "blue") + _blocks(0.012, low)
    parts += _wagon(0.120, low, "blue", "mustard") + _passengers(0.120, low)
    for x in (-0.046, 0.066):
        coupling = [(x - 0.010, low + 0.019, 0), (x, low + 0.015, 0), (x + 0.012, low + 0.019, 0)]
        parts.append(part("coupling", "brass", cord(coupling, 0.0024, 6, 6), 0.4))
    return parts


def _wagon(x: float, low: float, colour: str, trim: str) -> list[Part]:
    parts = [
        part("wagon", colour, rounded_box((x, low + 0.030, 0), (0.042, 0.016, 0.024), 0.004, cuts=4), 1.0),
        part("wagon_trim", trim, rounded_box((x, low + 0.0455, 0), (0.0435, 0.0026, 0.0255), 0.002, cuts=3), 0.5),
        part("wagon_floor", trim, rounded_box((x, low + 0.017, 0), (0.044, 0.003, 0.022), 0.002, cuts=3), 0.5),
        part("load", "wood_dark", rounded_box((x, low + 0.0476, 0), (0.037, 0.001, 0.019), 0.0008, cuts=2), 0.0),
    ]
    for z, sign in ((0.0243, 1.0), (-0.0243, -1.0)):

        def face(flat: Floats, z: float = z, sign: float = sign) -> tuple[Floats, Floats]:
            return np.column_stack([flat, np.full(len(flat), z)]), np.tile([0.0, 0.0, sign], (len(flat), 1))

        for k in range(3):
            spot = star(x - 0.025 + k * 0.025, low + 0.031, 0.0088, 5, 0.50, 1.2)
            parts.append(part("star", "cream", inlay(spot, face, 0.0003), 0.0))
    for z in (-0.0275, 0.0275):
        for dx in (-0.024, 0.024):
            parts += _wheel(x + dx, low + 0.0115, z, 0.0115, "red")
    return parts


def _blocks(x: float, low: float) -> list[Part]:
    parts = []
    for k, (dx, dy, dz, turn, colour) in enumerate(
        (
            *(
                (-0.022, 0.058, -0.004, 0.2, "red"),
                (0.000, 0.058, 0.004, -0.3, "teal"),
                (0.022, 0.058, -0.002, 0.15, "pink"),
            ),
            *((-0.010, 0.078, 0.000, 0.5, "cream"), (0.013, 0.078, 0.002, -0.15, "green")),
        )
    ):
        cube = rounded_box((0, 0, 0), (0.0100, 0.0100, 0.0100), 0.002, cuts=3).placed((x + dx, low + dy, dz), turn)
        parts.append(part("block", colour, cube, 0.7))
        mark = (star(0, 0, 0.006, 5, 0.5, 1.2), disc(0, 0, 0.0055, 12), star(0, 0, 0.0062, 4, 0.3, 0.6))[k % 3]
        plate = inlay(mark, partial(facing, 0.0103), 0.0)
        parts.append(
            part("mark", "mustard" if colour != "cream" else "red", plate.placed((x + dx, low + dy, dz), turn), 0.0)
        )
    return parts


def _passengers(x: float, low: float) -> list[Part]:
    """Three peg people in hats."""
    parts = []
    for k, (colour, hat) in enumerate((("red", "mustard"), ("teal", "red"), ("green", "blue"))):
        place = (x - 0.025 + k * 0.025, low + 0.046, 0.0)
        peg = spun([(0.0095, 0.0), (0.0095, 0.012), (0.006, 0.020), (0.004, 0.022)], 11, 7)
        t = np.linspace(-np.pi / 2, np.pi / 2, 8)
        head = lathe(np.stack([0.0090 * np.cos(t) + 1e-4, 0.030 + 0.0090 * np.sin(t)], 1), 12)
        cap = spun([(0.0112, 0.033), (0.0092, 0.0345), (0.0078, 0.042), (0.0004, 0.0435)], 11, 7)
        parts += [
            part("peg", colour, peg.placed(place), 0.7),
            part("peg_head", "wood_pale", head.placed(place), 0.7),
            part("peg_hat", hat, cap.placed(place), 0.6),
        ]
        for side in (-1.0, 1.0):
            eye = inlay(disc(side * 0.0030, 0.0305, 0.0010, 6), partial(facing, 0.0088), 0.0)
            parts.append(part("peg_eye", "dark", eye.placed(place), 0.0))
        smile = stroke([(-0.0026, 0.0272, 0.0087), (0, 0.0258, 0.0085), (0.0026, 0.0272, 0.0087)], 0.0006, 0.0003, 4)
        parts.append(part("peg_smile", "red", smile.placed(place), 0.0))
    return parts
