"""Toys of printed tin: robot and wind-up bird. Each stands on (0, 0, 0) and faces +Z."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from game.tools.modelling.fields import Floats, cone, ellipsoid, union
from game.tools.modelling.goods_shapes import (
    cord,
    cylinder,
    disc,
    facing,
    inlay,
    leaning,
    onto,
    part,
    solid,
    spun,
    stroke,
)
from game.tools.modelling.lofts import lathe, loft, rounded_box, smooth_curve
from game.tools.modelling.mesh import split_at_level
from game.tools.modelling.parts import Part

__all__ = ["tin_robot", "wind_up_bird"]


def _key(at: tuple[float, float, float], degrees: tuple[float, float, float]) -> list[Part]:
    """A winding key: a shaft along +Y and two lobes with holes."""
    parts = [part("key", "brass", leaning(cylinder(0.0042, 0.016, 10), degrees, at), 0.5)]
    angle = np.linspace(0, 2 * np.pi, 18, endpoint=False)
    for side in (-1.0, 1.0):
        ring = np.stack([side * 0.0135 + 0.0105 * np.cos(angle), 0.022 + 0.0125 * np.sin(angle), 0 * angle], 1)
        lobe = loft(ring, np.tile([0.0, 0, 1], (18, 1)), 0.0042, 0.0026, 6, "round", True)
        parts.append(part("key", "brass", leaning(lobe, degrees, at), 0.7))
    return parts


def tin_robot() -> list[Part]:
    """Square and proud: a gauge in the chest, lamp eyes, claws, an antenna, rivets, and a key in his back."""
    parts: list[Part] = []

    def block(
        name: str, colour: str, at: tuple[float, float, float], half: tuple[float, float, float], r: float
    ) -> None:
        parts.append(part(name, colour, rounded_box(at, half, r, cuts=3), 0.9))

    for side in (-1.0, 1.0):
        block("foot", "red", (side * 0.034, 0.014, 0.010), (0.026, 0.014, 0.038), 0.008)
        for k in range(3):
            leg = cylinder(0.0165 - 0.001 * (k % 2), 0.0075, 14, 0.003).placed((side * 0.032, 0.034 + 0.0135 * k, 0))
            parts.append(part("leg", "steel", leg, 0.6))
        shoulder = leaning(cylinder(0.017, 0.012, 16, 0.003), (0, 0, 90), (side * 0.077, 0.146, 0))
        parts.append(part("shoulder", "red", shoulder, 0.8))
        for k in range(4):
            bend = k / 3
            at = (side * (0.086 + 0.010 * bend), 0.128 - 0.040 * bend, 0.006 + 0.030 * bend**2)
            parts.append(
                part("arm", "steel", leaning(cylinder(0.0115, 0.0068, 12, 0.0028), (-38 * bend, 0, side * 12), at), 0.6)
            )
        wrist = leaning(cylinder(0.0145, 0.0075, 14, 0.002), (-48, 0, side * 10), (side * 0.0975, 0.0785, 0.045))
        parts.append(part("wrist", "mustard", wrist, 0.7))
        for claw in (-1.0, 1.0):
            x = side * 0.098
            jaw = [
                (x, 0.072, 0.052),
                (x + claw * 0.013, 0.066, 0.060),
                (x + claw * 0.012, 0.056, 0.071),
                (x + claw * 0.003, 0.051, 0.076),
            ]
            parts.append(part("claw", "red", cord(jaw, [0.0055, 0.0056, 0.005, 0.0045, 0.004, 0.0022], 6, 7), 0.7))
        ear = leaning(cylinder(0.012, 0.006, 14, 0.002), (0, 0, 90), (side * 0.051, 0.212, 0))
        parts.append(part("ear", "red", ear, 0.7))
    block("body", "tin_blue", (0, 0.122, 0), (0.062, 0.050, 0.040), 0.010)
    block("hip", "steel", (0, 0.073, 0), (0.050, 0.007, 0.032), 0.004)
    block("neck", "steel", (0, 0.176, 0), (0.020, 0.007, 0.018), 0.004)
    block("head", "tin_blue", (0, 0.211, 0), (0.045, 0.030, 0.035), 0.009)
    block("panel", "cream", (0, 0.126, 0.0405), (0.048, 0.034, 0.0025), 0.002)
    face = partial(facing, 0.0432)
    parts.append(part("gauge_rim", "brass", inlay(disc(-0.020, 0.131, 0.0205, 28), face, 0.0004), 0.0))
    parts.append(part("gauge", "white", inlay(disc(-0.020, 0.131, 0.0175, 28), face, 0.0009), 0.0))
    wedge = np.array(
        [
            (-0.020, 0.131),
            *((-0.020 + 0.0160 * np.cos(a), 0.131 + 0.0160 * np.sin(a)) for a in np.linspace(0.05, 0.85, 5)),
        ]
    )
    parts.append(part("gauge_red", "red", inlay(wedge, face, 0.0013), 0.0))
    for k in range(7):
        turn = np.pi * (k / 6) * 0.94 + 0.1
        tick = [(-0.020 + r * np.cos(turn), 0.131 + r * np.sin(turn), 0.0448) for r in (0.0125, 0.0142, 0.0158)]
        parts.append(part("tick", "dark", stroke(tick, 0.0008, 0.0004, 3), 0.0))
    needle = [(-0.016, 0.127, 0.0455), (-0.022, 0.134, 0.0455), (-0.0285, 0.1425, 0.0455)]
    parts.append(part("needle", "dark", stroke(needle, 0.0012, 0.0005, 3), 0.0))
    for k, colour in enumerate(("red", "mustard", "green")):
        lamp = spun([(0.0068, 0.0), (0.006, 0.004), (0.0005, 0.006)], 14, 6)
        parts.append(part("lamp", colour, leaning(lamp, (90, 0, 0), (0.016 + k * 0.014, 0.146, 0.043)), 0.4))
    for k in range(4):
        parts.append(
            part(
                "vent",
                "dark",
                rounded_box((0.029, 0.113 + k * 0.0066, 0.0437), (0.0155, 0.0017, 0.0008), 0.0006, cuts=2),
                0.0,
            )
        )
    stripes = ("red", "mustard", "red", "mustard", "red", "mustard", "red")
    for k, colour in enumerate(stripes):
        parts.append(
            part(
                "stripe",
                colour,
                rounded_box((-0.036 + k * 0.012, 0.0985, 0.0437), (0.0048, 0.0035, 0.0008), 0.0006, cuts=2),
                0.0,
            )
        )
    for x in (-1.0, 1.0):
        for y in (0.080, 0.164):
            for z in (0.0405, -0.0405):
                rivet = spun([(0.0036, 0.0), (0.003, 0.0018), (0.0004, 0.0026)], 8, 4)
                place = (x * 0.054, y, z)
                parts.append(part("rivet", "brass", leaning(rivet, (90 if z > 0 else -90, 0, 0), place), 0.0))
        eye_rim = leaning(cylinder(0.0150, 0.004, 20, 0.002), (90, 0, 0), (x * 0.0195, 0.217, 0.036))
        parts.append(part("eye_rim", "brass", eye_rim, 0.6))
        glass = spun([(0.0118, 0.0), (0.0100, 0.0045), (0.0050, 0.0075), (0.0004, 0.0082)], 18, 8)
        parts.append(part("eye", "lamp", leaning(glass, (90, 0, 0), (x * 0.0195, 0.217, 0.0395)), 0.4))
        pupil = inlay(disc(x * 0.0195 - 0.001, 0.2165, 0.0042, 12), partial(facing, 0.0478), 0.0)
        parts.append(part("pupil", "dark", pupil, 0.0))
    block("mouth", "dark", (0, 0.193, 0.0345), (0.024, 0.0065, 0.0018), 0.001)
    for k in range(6):
        parts.append(
            part(
                "tooth",
                "cream",
                rounded_box((-0.019 + k * 0.0076, 0.193, 0.0362), (0.0026, 0.0048, 0.0008), 0.0006, cuts=2),
                0.0,
            )
        )
    block("brow", "red", (0, 0.243, 0.004), (0.030, 0.0035, 0.026), 0.003)
    parts.append(part("antenna", "steel", cord([(0, 0.244, 0), (0, 0.262, 0), (0, 0.280, 0)], 0.0022, 4, 8), 0.5))
    spring = np.linspace(0, 8 * np.pi, 32)
    coil = np.stack([0.0058 * np.cos(spring), 0.247 + 0.0008 * spring, 0.0058 * np.sin(spring)], 1)
    parts.append(part("spring", "brass", cord(coil, 0.0013, 40, 4), 0.3))
    t = np.linspace(-np.pi / 2, np.pi / 2, 9)
    bulb = lathe(np.stack([0.0095 * np.cos(t) + 1e-4, 0.287 + 0.0095 * np.sin(t)], 1), 14)
    parts.append(part("bulb", "red", bulb, 0.8))
    block("back", "tin_deep", (0, 0.124, -0.0405), (0.040, 0.030, 0.002), 0.0015)
    back = [
        (0, 0.150),
        (0.010, 0.128),
        (0.034, 0.126),
        (0.015, 0.112),
        (0.021, 0.096),
        (0, 0.106),
        (-0.021, 0.096),
        (-0.015, 0.112),
        (-0.034, 0.126),
        (-0.010, 0.128),
    ]

    def behind(flat: Floats) -> tuple[Floats, Floats]:
        return np.column_stack([flat, np.full(len(flat), -0.0428)]), np.tile([0.0, 0.0, -1.0], (len(flat), 1))

    parts.append(part("back_star", "mustard", inlay(np.array(back), behind, 0.0004), 0.0))
    return parts + _key((0, 0.122, -0.056), (-90.0, 0.0, 0.0))


def wind_up_bird() -> list[Part]:
    """A tin songbird in turquoise and yellow: printed feathers, jointed wings, big feet, the key on its back."""
    body = union(
        0.016,
        ellipsoid((0, 0.086, 0), (0.046, 0.045, 0.056)),
        ellipsoid((0, 0.126, 0.030), (0.037, 0.036, 0.036)),
        cone((0, 0.088, -0.044), (0, 0.104, -0.096), 0.017, 0.007),
    )
    mesh = solid(body, (-0.06, 0.03, -0.12), (0.06, 0.18, 0.08), 0.0042, 2000)
    p = mesh.position
    breast = 0.94 - np.linalg.norm((p - (0, 0.078, 0.046)) / (0.043, 0.048, 0.052), axis=1)
    front, rest = split_at_level(mesh, breast)
    band, front = split_at_level(
        front, 0.14 - (0.94 - np.linalg.norm((front.position - (0, 0.078, 0.046)) / (0.043, 0.048, 0.052), axis=1))
    )
    cap, rest = split_at_level(rest, rest.position[:, 1] - 0.142 - 0.25 * (rest.position[:, 2] - 0.03))
    tail, rest = split_at_level(rest, -0.060 - rest.position[:, 2])
    stripe, tail = split_at_level(tail, 0.005 - np.abs(tail.position[:, 2] + 0.078))
    parts = [
        part("bird", "turquoise", rest, 1.0),
        part("breast", "mustard", front, 1.0),
        part("breast_rim", "orange", band, 1.0),
        part("cap", "blue", cap, 1.0),
        part("tail", "blue", tail, 1.0),
        part("tail_stripe", "cream", stripe, 1.0),
    ]
    crest = union(
        0.004,
        *(
            cone((0, 0.156, 0.026 - 0.010 * k), (0, 0.180 - 0.006 * k, 0.010 - 0.016 * k), 0.006, 0.003)
            for k in range(3)
        ),
    )
    parts.append(part("crest", "orange", solid(crest, (-0.015, 0.14, -0.05), (0.015, 0.19, 0.05), 0.003, 260), 0.7))
    for up, tip in ((1.0, 0.0995), (-1.0, 0.094)):
        beak = cone((0, 0.124 + up * 0.0035, 0.062), (0, 0.1215 + up * 0.0005, tip), 0.0098, 0.0016)
        parts.append(part("beak", "orange", solid(beak, (-0.02, 0.10, 0.045), (0.02, 0.14, 0.11), 0.0026, 220), 0.7))
    for side in (-1.0, 1.0):
        look = onto(body, (side * 0.09, 0, 0), (0, 0, -side), (0, 1, 0))

        paint = partial(_painted, parts, look, side)
        paint("eye_ring", "white", disc(0.042, 0.133, 0.0105, 20), 0.0008)
        paint("eye", "dark", disc(0.043, 0.133, 0.0066, 16), 0.0016, 1)
        paint("glint", "white", disc(0.045, 0.1355, 0.0020, 8), 0.0022, 1)
        paint("cheek", "pink", disc(0.050, 0.1165, (0.0062, 0.0046), 14), 0.0008)
        for row in range(3):
            for k in range(3 - row % 2):
                z, y = 0.004 + k * 0.011 + 0.0055 * (row % 2), 0.060 + row * 0.0085
                paint("feather", "cream", disc(z, y, (0.0044, 0.0036), 10), 0.0008, 1)
        # The wing: a tin plate with three printed rows, hinged at a rivet.
        wing = _wing(side)
        parts += wing
        leg = cord(
            [(side * 0.018, 0.052, 0.006), (side * 0.020, 0.028, 0.004), (side * 0.022, 0.008, 0.010)], 0.0034, 7, 7
        )
        parts.append(part("leg", "brass", leg, 0.5))
        foot = union(
            0.006,
            *(
                cone((side * 0.022, 0.006, 0.004), (side * 0.022 + dx, 0.0052, dz), 0.0062, 0.0050)
                for dx, dz in ((-0.013, 0.036), (0.0, 0.041), (0.013, 0.036), (0.0, -0.020))
            ),
        )
        low, high = (side * 0.022 - 0.03, -0.004, -0.04), (side * 0.022 + 0.03, 0.02, 0.06)
        parts.append(part("foot", "orange", solid(foot, low, high, 0.0034, 320), 0.7))
    return parts + _key((0, 0.135, -0.022), (-28.0, 0.0, 0.0))


def _painted(
    parts: list[Part],
    look: Callable[[Floats], tuple[Floats, Floats]],
    side: float,
    name: str,
    colour: str,
    outline: Floats,
    lift: float,
    rings: int = 2,
) -> None:
    """Add a patch on the bird's side; the outline counts forward and up."""
    parts.append(part(name, colour, inlay(outline * (-side, 1.0), look, lift, rings), 0.0))


def _wing(side: float) -> list[Part]:
    path = smooth_curve([(0, 0.106, 0.026), (0, 0.098, 0.000), (0, 0.088, -0.032), (0, 0.084, -0.066)], 14)
    path[:, 0] = side * (0.047 + 0.010 * np.sin(np.pi * np.linspace(0.05, 0.75, 14)))
    out = np.tile([side, 0.25, 0.0], (14, 1))
    width = 0.025 * np.sin(np.pi * np.linspace(0.20, 0.98, 14)) ** 0.8 + 0.001
    plate = loft(path, out, width, 0.0034, 10, "round")
    share = (0.026 - plate.position[:, 2]) / 0.092
    tip, rest = split_at_level(plate, share - 0.62 - 0.05 * np.sin(plate.position[:, 1] * 420))
    middle, root = split_at_level(
        rest, (0.026 - rest.position[:, 2]) / 0.092 - 0.36 - 0.05 * np.sin(rest.position[:, 1] * 420)
    )
    rivet = spun([(0.0052, 0.0), (0.0042, 0.0024), (0.0004, 0.0034)], 12, 5)
    return [
        part("wing", "blue", tip, 0.9),
        part("wing", "mustard", middle, 0.9),
        part("wing", "orange", root, 0.9),
        part("rivet", "brass", leaning(rivet, (0, 0, -90 * side), (side * 0.0530, 0.102, 0.012)), 0.3),
    ]
