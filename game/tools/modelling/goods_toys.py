"""Toys of wood and plush: kokeshi, spinning top, kendama, teddy bear. Each stands on (0, 0, 0) and faces +Z."""

from __future__ import annotations

from functools import partial

import numpy as np

from game.tools.modelling.fields import Field, Floats, cone, ellipsoid, sphere, union
from game.tools.modelling.goods_shapes import (
    banded,
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
    stroke,
    tassel,
)
from game.tools.modelling.lofts import lathe, loft, smooth_curve
from game.tools.modelling.mesh import Mesh, joined, split_at_level
from game.tools.modelling.parts import Part

__all__ = ["kendama", "kokeshi", "spinning_top", "teddy_bear"]

_HEAD_Y = 0.205
_HEAD_R = 0.047


def _round(profile: list[tuple[float, float]], lift: float, flat: Floats) -> tuple[Floats, Floats]:
    """Arc (azimuth in radians, height) on a turned body whose outline is ``profile``."""
    line = smooth_curve(np.array(profile), 60)
    radius = np.interp(flat[:, 1], line[:, 1], line[:, 0]) + lift
    normal = np.stack([np.sin(flat[:, 0]), np.zeros(len(flat)), np.cos(flat[:, 0])], 1)
    return normal * radius[:, None] + np.stack([0 * radius, flat[:, 1], 0 * radius], 1), normal


def kokeshi() -> list[Part]:
    """A turned doll: bobbed black hair with red ribbons, a kimono of chrysanthemums, a shy painted face."""
    outline = [
        (0.030, 0.0),
        (0.046, 0.002),
        (0.050, 0.020),
        (0.046, 0.075),
        (0.037, 0.125),
        (0.034, 0.152),
        (0.020, 0.168),
    ]
    body = spun([(0.001, 0.0), *outline], 24, 20)
    parts: list[Part] = []
    rest = body
    for colour, low, high in (
        *(("red", 0.0, 0.012), ("mustard", 0.0125, 0.017), ("green", 0.0175, 0.0225)),
        *(("green", 0.128, 0.133), ("red", 0.1335, 0.146), ("mustard", 0.1465, 0.151)),
    ):
        band, rest = banded(rest, low, high)
        parts.append(part("band", colour, band, 0.9))
    parts.append(part("body", "wood_pale", rest, 0.9))
    surface = partial(_round, outline, 0.0)
    for azimuth in np.radians([0, 72, 144, 216, 288]):
        a = float(azimuth)
        for y, r, lobes in ((0.072, 0.017, 12), (0.108, 0.010, 10)):
            shift = 0.0 if y < 0.1 else 0.5
            parts.append(part("flower", "red", _petals(a + shift, y, r, lobes, surface), 0.0))
            parts.append(part("flower_heart", "mustard", _petals(a + shift, y, r * 0.34, 6, surface, 0.0016), 0.0))
        for side in (-1.0, 1.0):
            leaf = np.array([(0.0, 0.0), (0.12, 0.004), (0.34, 0.016), (0.26, 0.002), (0.14, -0.006)])
            placed = np.stack([a + side * leaf[:, 0] + side * 0.30, 0.044 + leaf[:, 1]], 1)
            parts.append(part("leaf", "green", inlay(placed, surface, 0.0008), 0.0))
    return parts + _kokeshi_head()


def _petals(azimuth: float, y: float, radius: float, lobes: int, surface: object, lift: float = 0.0010) -> Mesh:
    flower = star(0.0, 0.0, radius, lobes, 0.30, 0.5, steps=4)
    return inlay(flower / (0.045, 1.0) + (azimuth, y), surface, lift, 2)  # type: ignore[arg-type]


def _kokeshi_head() -> list[Part]:
    ball = ellipsoid((0, _HEAD_Y, 0), (_HEAD_R, _HEAD_R * 0.96, _HEAD_R))
    t = np.linspace(-np.pi / 2, np.pi / 2, 21)
    globe = lathe(np.stack([_HEAD_R * np.cos(t) + 1e-4, _HEAD_Y + _HEAD_R * 0.96 * np.sin(t)], 1), 28)
    x, y, z = ((globe.position - (0, _HEAD_Y, 0)) / _HEAD_R).T
    azimuth = np.abs(np.arctan2(x, z))
    fringe = y - 0.50 + 0.10 * np.cos(azimuth * 2)
    bob = np.minimum(azimuth - 1.05, y + 0.42)
    hair, face = split_at_level(globe, np.maximum(fringe, bob))
    parts = [part("face", "wood_pale", face, 0.9), part("hair", "dark", hair, 1.0)]
    surface = onto(ball, (0, _HEAD_Y, 0.12), (1, 0, 0), (0, 1, 0))

    def line(points: list[tuple[float, float]], width: float, colour: str, name: str) -> None:
        path = smooth_curve(np.array(points), 10)
        position, normal = surface(path)
        taper = width * (0.4 + 0.6 * np.sin(np.pi * np.linspace(0.05, 0.95, 10)))
        parts.append(part(name, colour, loft(position + normal * 0.0005, normal, taper, 0.0006, 4, "round"), 0.0))

    for side in (-1.0, 1.0):
        line([(side * 0.026, -0.003), (side * 0.017, 0.0035), (side * 0.008, -0.0015)], 0.0015, "dark", "eye")
        line([(side * 0.027, 0.012), (side * 0.017, 0.0165), (side * 0.009, 0.0135)], 0.0009, "dark", "brow")
        blush = inlay(disc(side * 0.025, -0.014, (0.008, 0.0055), 16), surface, 0.0008, 2)
        parts.append(part("cheek", "pink", blush, 0.0))
        # A ribbon and a tuft at each ear.
        tuft = ellipsoid((side * 0.047, _HEAD_Y + 0.004, 0.004), (0.011, 0.022, 0.017))
        low, high = (side * 0.047 - 0.02, _HEAD_Y - 0.03, -0.03), (side * 0.047 + 0.02, _HEAD_Y + 0.04, 0.03)
        parts.append(part("tuft", "dark", solid(tuft, low, high, 0.004, 160), 0.8))
        loop = ellipsoid((side * 0.046, _HEAD_Y + 0.031, 0.006), (0.0065, 0.0125, 0.0085))
        low, high = (side * 0.046 - 0.02, _HEAD_Y + 0.01, -0.02), (side * 0.046 + 0.02, _HEAD_Y + 0.05, 0.03)
        parts.append(part("ribbon", "red", solid(loop, low, high, 0.003, 140), 0.6))
    line([(-0.0022, -0.011), (0.0, -0.0128), (0.0022, -0.011)], 0.0010, "dark", "nose")
    lips = inlay(disc(0.0, -0.0215, (0.0040, 0.0026), 12), surface, 0.0008)
    parts.append(part("mouth", "red", lips, 0.0))
    return parts


def spinning_top() -> list[Part]:
    """A big top in five rings of colour, leaning in a turned cup, its cord coiled before it."""
    outline = [
        *((0.001, 0.0), (0.007, 0.010), (0.013, 0.018), (0.050, 0.038), (0.076, 0.050), (0.081, 0.060), (0.075, 0.069)),
        *((0.040, 0.074), (0.016, 0.078), (0.010, 0.092), (0.011, 0.112), (0.008, 0.119), (0.001, 0.121)),
    ]
    rest = spun(outline, 36, 34)
    pieces = []
    for colour, border in (("mustard", 0.018), ("cream", 0.030), ("teal", 0.044), ("cream", 0.050), ("red", 0.068)):
        radius = np.hypot(rest.position[:, 0], rest.position[:, 2])
        rest, ring = split_at_level(rest, radius - border)
        pieces.append((colour, ring))
    pieces.append(("blue", rest))
    tilt = partial(leaning, degrees=(-9.0, 0.0, -11.0), at=(0.0, 0.030, -0.012))
    parts = [part("top", colour, tilt(mesh), 1.0 if colour == "blue" else 0.6) for colour, mesh in pieces]
    for k in range(10):
        spot = star(0.0, 0.0, 0.0062, 5, 0.45, 1.2)

        def surface(flat: Floats, turn: float = k * 36.0) -> tuple[Floats, Floats]:
            a = np.radians(turn)
            radius = 0.059
            place = np.stack(
                [radius * np.sin(a) + flat[:, 0], np.full(len(flat), 0.0722), radius * np.cos(a) + flat[:, 1]], 1
            )
            return place, np.tile([0.0, 1.0, 0.0], (len(flat), 1))

        parts.append(part("star", "mustard", tilt(inlay(spot, surface, 0.0006)), 0.0))
    cup = spun(
        [(0.001, 0.002), (0.034, 0.0), (0.040, 0.006), (0.026, 0.018), (0.027, 0.030), (0.036, 0.043), (0.030, 0.042)]
        + [(0.018, 0.030), (0.001, 0.028)],
        28,
        18,
    )
    parts.append(part("cup", "wood_dark", cup.placed((0, 0, -0.012)), 0.9))
    turn = np.linspace(0, 2 * np.pi * 3.2, 44)
    radius = 0.010 + 0.0088 * turn / (2 * np.pi)
    coil = np.stack([0.050 + radius * np.cos(turn), np.full(44, 0.0042), 0.072 + radius * np.sin(turn)], 1)
    tail = [(0.010, 0.0042, 0.094), (-0.030, 0.0042, 0.092), (-0.060, 0.0042, 0.072)]
    parts.append(part("cord", "cream", cord(np.vstack([coil, tail]), 0.0040, 64, 6), 0.5))
    parts.append(part("knot", "red", leaning(tassel(0.026, 0.008), (0, 20, -80), (-0.062, 0.009, 0.070)), 0.6))
    return parts


def kendama() -> list[Part]:
    """Ken and ball: the red ball on the spike, three cups, the cord hanging in a loop."""
    ken = spun(
        [
            (0.001, 0.004),
            (0.018, 0.003),
            (0.026, 0.0),
            (0.0275, 0.004),
            (0.017, 0.018),
            (0.0115, 0.032),
            (0.0155, 0.060),
        ]
        + [(0.0145, 0.090), (0.011, 0.112), (0.0085, 0.140), (0.003, 0.180)],
        24,
        26,
    )
    ring, wood = banded(ken, 0.056, 0.064)
    parts = [part("ken", "wood_pale", wood, 0.9), part("ken_ring", "red", ring, 0.9)]
    cups = spun(
        [(0.001, -0.040), (0.020, -0.046), (0.0285, -0.052), (0.0300, -0.050), (0.0240, -0.030), (0.0150, -0.014)]
        + [(0.0150, 0.014), (0.0215, 0.028), (0.0265, 0.046), (0.0250, 0.048), (0.018, 0.042), (0.001, 0.037)],
        24,
        28,
    )
    near, cups = banded(cups, -0.029, -0.0235)
    far, cups = banded(cups, 0.0235, 0.029)
    across = partial(leaning, degrees=(0.0, 0.0, 90.0), at=(0.0, 0.112, 0.0))
    parts += [
        part("cups", "wood_pale", across(cups), 0.9),
        part("cups_band", "mustard", across(joined([near, far])), 0.9),
    ]
    t = np.linspace(-np.pi / 2, np.pi / 2, 21)
    ball = lathe(np.stack([0.045 * np.cos(t) + 1e-4, 0.045 * np.sin(t)], 1), 30)
    stripe, red = banded(ball, -0.0025, 0.0105)
    thin, red = banded(red, 0.0155, 0.0185)
    cap = lathe([(0.0001, 0.0462), (0.0075, 0.0456), (0.0105, 0.0440)], 16)
    seat = partial(leaning, degrees=(9.0, 0.0, -7.0), at=(0.003, 0.183, 0.002))
    parts += [
        part("ball", "red", seat(red), 1.0),
        part("ball_stripe", "cream", seat(stripe), 1.0),
        part("ball_line", "mustard", seat(thin), 1.0),
        part("ball_cap", "wood_dark", seat(cap), 0.0),
    ]
    for k in range(5):
        a = k * 72.0

        def surface(flat: Floats, turn: float = a) -> tuple[Floats, Floats]:
            azimuth = np.radians(turn) + flat[:, 0] / 0.038
            y = np.clip(-0.021 + flat[:, 1], -0.044, 0.044)
            r = np.sqrt(0.045**2 - y**2)
            place = np.stack([r * np.sin(azimuth), y, r * np.cos(azimuth)], 1)
            return place, place / 0.045

        parts.append(part("star", "cream", seat(inlay(star(0, 0, 0.0085, 5, 0.52, 1.2), surface, 0.0007, 2)), 0.0))
    string = [
        *((0.0, 0.112, 0.014), (0.024, 0.094, 0.034), (0.058, 0.040, 0.050), (0.064, 0.010, 0.046)),
        *((0.082, 0.006, 0.020), (0.090, 0.050, 0.004), (0.078, 0.130, -0.004), (0.046, 0.172, 0.004)),
    ]
    parts.append(part("string", "cream", cord(string, 0.0018, 40, 5), 0.5))
    bead = spun([(0.0005, -0.006), (0.006, -0.003), (0.006, 0.003), (0.0005, 0.006)], 12, 7)
    parts.append(part("bead", "teal", leaning(bead, (0, 0, 0), (0.0635, 0.018, 0.047)), 0.6))
    return parts


def _bear_field() -> Field:
    """Sitting, head up, legs forward; the skin uneven as plush is."""
    head = union(
        0.014,
        ellipsoid((0, 0.172, 0.004), (0.052, 0.046, 0.044)),
        ellipsoid((0, 0.158, 0.042), (0.025, 0.020, 0.018)),
    )
    ears = [ellipsoid((side * 0.043, 0.211, -0.002), (0.021, 0.020, 0.012)) for side in (-1.0, 1.0)]
    trunk = union(
        0.020, ellipsoid((0, 0.078, 0), (0.056, 0.062, 0.048)), ellipsoid((0, 0.115, 0.0), (0.042, 0.032, 0.036))
    )
    arms = [cone((side * 0.044, 0.116, 0.004), (side * 0.080, 0.072, 0.034), 0.0185, 0.0200) for side in (-1.0, 1.0)]
    legs = [
        union(
            0.008,
            cone((side * 0.036, 0.034, 0.014), (side * 0.055, 0.026, 0.066), 0.0255, 0.0235),
            ellipsoid((side * 0.057, 0.034, 0.078), (0.022, 0.031, 0.016)),
        )
        for side in (-1.0, 1.0)
    ]
    tail = sphere((0, 0.036, -0.050), 0.016)
    bear = union(0.008, union(0.006, trunk, *legs), *arms, tail)
    whole = union(0.006, bear, union(0.005, head, *ears))

    def nap(p: Floats) -> Floats:
        return np.asarray(whole(p) + 0.0009 * np.sin(p[:, 0] * 260) * np.sin(p[:, 1] * 260) * np.sin(p[:, 2] * 260))

    return cut_below(nap)


def teddy_bear() -> list[Part]:
    """An old friend: honey plush, one patched knee, a stitched smile, felt pads and a red bow."""
    whole = _bear_field()
    plush = solid(whole, (-0.12, -0.01, -0.08), (0.12, 0.25, 0.11), 0.0042, 2600)
    muzzle_level = 1.0 - np.linalg.norm((plush.position - (0, 0.158, 0.048)) / (0.0262, 0.0212, 0.024), axis=1)
    muzzle, plush = split_at_level(plush, muzzle_level)
    pads = []
    for side in (-1.0, 1.0):
        level = 1.0 - np.linalg.norm((plush.position - (side * 0.057, 0.036, 0.096)) / (0.0155, 0.0225, 0.012), axis=1)
        pad, plush = split_at_level(plush, level)
        level = 1.0 - np.linalg.norm((plush.position - (side * 0.043, 0.2115, 0.012)) / (0.0125, 0.0120, 0.009), axis=1)
        ear, plush = split_at_level(plush, level)
        pads += [pad, ear]
    parts = [part("plush", "plush", plush, 1.0), part("muzzle", "plush_pale", muzzle, 0.8)]
    parts += [part("pad", "plush_pale", pad, 0.8) for pad in pads]
    front = onto(whole, (0, 0, 0.2), (1, 0, 0), (0, 1, 0), 0.3)

    def thread(points: list[tuple[float, float]], width: float, colour: str) -> None:
        path = smooth_curve(np.array(points), 8)
        position, normal = front(path)
        parts.append(part("thread", colour, loft(position + normal * 0.0006, normal, width, 0.0009, 4, "round"), 0.0))

    for side in (-1.0, 1.0):
        at, normal = front(np.array([(side * 0.0215, 0.1785)]))
        button = spun([(0.001, -0.001), (0.0075, 0.0), (0.0066, 0.0040), (0.0005, 0.0052)], 14, 7)
        parts.append(part("eye", "dark", leaning(button, (78, side * 22, 0), at[0] - normal[0] * 0.001), 0.5))
        glint = leaning(
            lathe([(0.0022, 0.0), (0.0001, 0.0006)], 8), (84, 0, 0), at[0] + normal[0] * 0.0046 + (-0.002, 0.0024, 0.0)
        )
        parts.append(part("glint", "cream", glint, 0.0))
        thread([(side * 0.0285, 0.192), (side * 0.022, 0.196), (side * 0.015, 0.194)], 0.0012, "stitch")
        thread([(0, 0.1495), (side * 0.006, 0.1455), (side * 0.0125, 0.1485)], 0.0012, "stitch")
        for k in (-1, 0, 1):
            thread([(side * 0.057 + k * 0.007, 0.060), (side * 0.057 + k * 0.007, 0.052)], 0.0010, "stitch")
    thread([(0, 0.158), (0, 0.1495)], 0.0011, "stitch")
    nose = inlay(star(0, 0.164, 0.0098, 3, 0.28, 0.6, -90), front, 0.0014, 3)
    parts.append(part("nose", "dark", nose, 0.0))
    # A patch on the belly, sewn on with big stitches.
    patch = np.array([(-0.034, 0.090), (-0.010, 0.094), (-0.008, 0.066), (-0.032, 0.062)])
    corners = np.vstack([np.linspace(patch[k], patch[(k + 1) % 4], 5)[:-1] for k in range(4)])
    parts.append(part("patch", "teal_cloth", inlay(corners, front, 0.0014, 3), 0.0))
    for k, corner in enumerate(corners):
        if k % 2:
            middle = corner + (corners.mean(0) - corner) * 0.14
            out = corner - (corners.mean(0) - corner) * 0.16
            thread([(float(middle[0]), float(middle[1])), (float(out[0]), float(out[1]))], 0.0011, "cream")
    for y0, y1 in ((0.120, 0.100), (0.096, 0.080), (0.074, 0.060)):
        thread([(0.012, y0 - 0.006), (0.012, y1)], 0.0008, "stitch")
    return parts + _bow()


def _bow() -> list[Part]:
    parts = []
    for side in (-1.0, 1.0):
        loop = union(
            0.006,
            cone((side * 0.006, 0.131, 0.046), (side * 0.030, 0.139, 0.044), 0.0050, 0.0125),
            ellipsoid((side * 0.031, 0.139, 0.043), (0.011, 0.014, 0.008)),
        )
        low, high = (min(0.0, side * 0.055), 0.105, 0.020), (max(0.0, side * 0.055), 0.165, 0.07)
        parts.append(part("bow", "red_cloth", solid(loop, low, high, 0.0034, 260), 0.7))
        tail = [(side * 0.004, 0.129, 0.048), (side * 0.012, 0.112, 0.055), (side * 0.022, 0.096, 0.056)]
        path = smooth_curve(np.array(tail), 7)
        end = loft(path, np.tile([0.0, 0.1, 1.0], (7, 1)), np.linspace(0.004, 0.0095, 7), 0.0016, 6, "band")
        parts.append(part("bow_end", "red_cloth", end, 0.6))
    knot = spun([(0.0005, -0.008), (0.0075, -0.005), (0.0075, 0.005), (0.0005, 0.008)], 12, 7)
    parts.append(part("bow_knot", "red_cloth", leaning(knot, (0, 0, 0), (0, 0.131, 0.050)), 0.7))
    fold = stroke([(-0.030, 0.1385, 0.0515), (-0.018, 0.136, 0.0535), (-0.008, 0.133, 0.054)], 0.0008, 0.0006, 5)
    parts.append(part("fold", "red_deep", fold, 0.0))
    return parts
