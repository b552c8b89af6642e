"""Antiques from a scholar's room: ink stone with brush and rest, Noh mask. Each stands on (0, 0, 0) and faces +Z."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from game.tools.modelling.fields import (
    Field,
    Floats,
    box,
    cone,
    ellipsoid,
    intersection,
    offset,
    plane,
    sphere,
    subtraction,
    union,
)
from game.tools.modelling.goods_shapes import cord, cut_below, disc, inlay, leaning, onto, part, solid, tassel
from game.tools.modelling.lofts import lathe, loft, rounded_box, smooth_curve
from game.tools.modelling.mesh import Mesh, split_at_level
from game.tools.modelling.parts import Part

__all__ = ["ink_stone", "noh_mask"]


def ink_stone() -> list[Part]:
    """A slate with a carved rim and a pool of ink, an ink stick lettered in gold, a brush on five porcelain peaks."""
    slab = box((0, 0.016, 0), (0.078, 0.016, 0.054), 0.010)
    well = ellipsoid((-0.010, 0.040, -0.006), (0.056, 0.0155, 0.037))
    deep = ellipsoid((-0.044, 0.036, -0.008), (0.020, 0.022, 0.030))
    clouds = [
        sphere((x, 0.032, z), r)
        for x, z, r in (
            *((0.056, -0.034, 0.013), (0.040, -0.042, 0.011), (0.066, -0.020, 0.010), (0.062, 0.034, 0.009)),
            *((0.050, 0.041, 0.010), (0.024, -0.045, 0.008)),
        )
    ]
    stone = subtraction(0.005, slab, union(0.010, well, deep))
    stone = union(0.004, stone, *(intersection(0.003, c, plane((0, 0.0375, 0), (0, 1, 0))) for c in clouds))
    mesh = solid(cut_below(stone), (-0.09, -0.01, -0.07), (0.09, 0.06, 0.07), 0.0026, 2200)
    at = (-0.030, 0.012, 0.010)
    pool = inlay(disc(-0.0445, -0.0075, (0.0185, 0.027), 26), lambda flat: _level(0.0245, flat), 0.0)
    parts = [
        part("stone", "slate", mesh.placed(at), 1.0),
        part("ink", "ink", pool.placed(at), 0.0),
    ]
    for x, z in ((0.052, -0.036), (0.038, -0.043), (0.064, -0.022)):
        spiral = [
            (x + r * np.cos(t), 0.0392, z + r * np.sin(t))
            for t, r in ((a, 0.0075 - a * 0.0011) for a in np.linspace(0, 6.0, 8))
        ]
        parts.append(part("carving", "slate_light", cord(np.array(spiral) + at, 0.0009, 14, 5), 0.0))
    tray = rounded_box((0, 0.006, 0), (0.134, 0.006, 0.076), 0.005, cuts=5)
    lip = rounded_box((0, 0.0105, 0), (0.126, 0.0025, 0.068), 0.002, cuts=3)
    parts += [part("tray", "lacquer", tray, 1.0), part("tray_inside", "vermilion_deep", lip, 0.3)]
    # The ink stick leans on the stone's rim.
    stick = rounded_box((0, 0, 0), (0.040, 0.0065, 0.0115), 0.002, cuts=4)
    lean = partial(leaning, degrees=(0, 24, -20), at=(0.058, 0.056, 0.016))
    parts.append(part("stick", "ink", lean(stick), 0.7))
    parts.append(
        part("stick_end", "gold", lean(rounded_box((0.035, 0, 0), (0.0056, 0.0069, 0.0119), 0.002, cuts=3)), 0.0)
    )
    parts.append(
        part("stick_end", "vermilion", lean(rounded_box((-0.012, 0, 0), (0.0016, 0.0069, 0.0119), 0.001, cuts=3)), 0.0)
    )
    for x in (-0.002, 0.010, 0.022):
        for dx, dz, w, h in (
            (0, 0.0, 0.0042, 0.0007),
            (-0.003, 0.0, 0.0007, 0.005),
            (0.003, 0.0, 0.0007, 0.0042),
            (0, 0.0035, 0.0034, 0.0007),
        ):
            mark = rounded_box((x + dx, 0.0066, dz), (w, 0.0006, h), 0.0004, cuts=3)
            parts.append(part("character", "gold", lean(mark), 0.0))
    parts += _brush_rest()
    return parts


def _level(y: float, flat: Floats) -> tuple[Floats, Floats]:
    count = len(flat)
    return np.stack([flat[:, 0], np.full(count, y), flat[:, 1]], 1), np.tile([0.0, 1.0, 0.0], (count, 1))


def _brush_rest() -> list[Part]:
    """Five peaks in blue and white behind the stone, the brush lying in a saddle."""
    peaks = [
        cone((x, 0.012, 0), (x, h, 0), 0.017, 0.006)
        for x, h in ((-0.052, 0.036), (-0.027, 0.052), (0.0, 0.068), (0.027, 0.050), (0.052, 0.034))
    ]
    hills = cut_below(intersection(0.006, union(0.012, *peaks), box((0, 0.03, 0), (0.08, 0.05, 0.012), 0.006)))
    mesh = solid(hills, (-0.09, -0.005, -0.025), (0.09, 0.09, 0.025), 0.0034, 1000)
    tops, slopes = split_at_level(
        mesh,
        mesh.position[:, 1]
        - 0.034
        - 0.010 * np.cos(mesh.position[:, 0] * 115)
        + 0.002 * np.sin(mesh.position[:, 0] * 400),
    )
    at = (0.040, 0.012, -0.050)
    parts = [part("peaks", "porcelain", tops.placed(at), 0.9), part("slopes", "cobalt", slopes.placed(at), 0.9)]
    spine = [(-0.118, 0.071, -0.046), (-0.05, 0.063, -0.049), (0.060, 0.053, -0.050), (0.118, 0.047, -0.050)]
    parts.append(part("brush", "bamboo", cord(spine, 0.0050, 10, 9), 0.7))
    parts.append(
        part("brush_ring", "lacquer", cord([(-0.113, 0.0705, -0.046), (-0.122, 0.0716, -0.0458)], 0.0062, 4, 9), 0.5)
    )
    hair = [(-0.120, 0.0714, -0.046), (-0.136, 0.0728, -0.0456), (-0.156, 0.0725, -0.045)]
    parts.append(part("brush_hair", "cream", cord(hair[:2], [0.0060, 0.0072, 0.0066], 3, 9), 0.6))
    parts.append(part("brush_tip", "ink", cord(hair[1:], [0.0066, 0.0052, 0.0030, 0.0004], 4, 9), 0.6))
    loop = [
        (0.117, 0.047, -0.050),
        (0.128, 0.042, -0.044),
        (0.132, 0.034, -0.048),
        (0.126, 0.038, -0.054),
        (0.117, 0.047, -0.050),
    ]
    parts.append(part("brush_loop", "silk", cord(loop, 0.0013, 14), 0.4))
    return parts


def noh_mask() -> list[Part]:
    """Ko-omote, a young woman: white face, painted brows high on the forehead, parted hair; on a stand, with cords."""
    face = _mask_field()
    shell = subtraction(0.003, face, offset(face, -0.008), plane((0, 0, -0.006), (0, 0, 1)))
    shell = intersection(0.004, shell, plane((0, 0, -0.020), (0, 0, -1)))
    eyes = [
        ellipsoid((side * 0.0300, 0.018, 0.05), (0.0105, 0.0032, 0.08), _tilted(side * -0.07)) for side in (-1.0, 1.0)
    ]
    mouth = ellipsoid((0, -0.0500, 0.05), (0.0125, 0.0030, 0.08))
    cut = subtraction(0.0012, shell, *eyes, mouth)
    mesh = solid(cut, (-0.085, -0.115, -0.04), (0.085, 0.115, 0.08), 0.0026, 2400)
    inside = -0.004 - face(mesh.position)
    back, front = split_at_level(mesh, inside)
    # Black hair: down from the crown along both sides, parted in the middle.
    fx, fy = front.position[:, 0], front.position[:, 1]
    hairline = 0.068 - 0.55 * (np.abs(fx) / 0.07) ** 2.4 * 0.07 + 0.006 * np.exp(-((fx / 0.010) ** 2))
    hair, skin = split_at_level(front, fy - hairline - 0.018 * (1 - np.abs(fx) / 0.07))
    surface = onto(face, (0, 0, 0.12), (1, 0, 0), (0, 1, 0))
    items: list[tuple[str, str, Mesh, float]] = [
        ("mask", "mask_white", skin, 0.9),
        ("mask_hair", "ink", hair, 0.9),
        ("mask_back", "dark_wood", back, 0.6),
    ]

    def paint(name: str, colour: str, outline: Floats, lift: float = 0.0009, rings: int = 2) -> None:
        items.append((name, colour, inlay(outline, surface, lift, rings), 0.0))

    for side in (-1.0, 1.0):
        paint("brow", "brow_smoke", disc(side * 0.031, 0.0560, (0.0170, 0.0075), 24, side * -6), 0.0008, 3)
        paint("brow", "ink", disc(side * 0.031, 0.0565, (0.0125, 0.0046), 22, side * -6), 0.0014, 3)
        lid = [(-0.0145, -0.001), (-0.008, 0.0048), (0.0, 0.0062), (0.009, 0.0045), (0.0165, -0.0028)]
        lid += [(0.009, 0.0018), (0.0, 0.0032), (-0.008, 0.0018)]
        items.append(
            ("lid", "ink", _ribbon([(side * (0.030 + a), 0.018 + b) for a, b in lid[:5]], surface, 0.0016), 0.0)
        )
        items.append(
            (
                "lower_lid",
                "ink",
                _ribbon(
                    [(side * (0.030 + a), 0.0145 + b) for a, b in ((-0.010, 0.0006), (0, -0.0012), (0.010, 0.0004))],
                    surface,
                    0.0008,
                ),
                0.0,
            )
        )
        paint("cheek", "mask_blush", disc(side * 0.040, -0.022, (0.0150, 0.0110), 24), 0.0006, 3)
        items.append(
            (
                "nostril",
                "mask_shade",
                _ribbon(
                    [(side * 0.0035, -0.0215), (side * 0.0065, -0.0200), (side * 0.0080, -0.0175)], surface, 0.0008
                ),
                0.0,
            )
        )
        for k in range(3):
            strand = [
                (side * (0.004 + 0.004 * k), 0.084 - 0.004 * k),
                (side * (0.036 + 0.004 * k), 0.066 - 0.006 * k),
                (side * (0.058 + 0.002 * k), 0.030 - 0.010 * k),
                (side * (0.064 - 0.001 * k), -0.010 - 0.012 * k),
            ]
            items.append(("strand", "ink", _ribbon(strand, surface, 0.0007), 0.0))
    upper = [
        (-0.0205, -0.0470),
        (-0.010, -0.0425),
        (-0.004, -0.0412),
        (0, -0.0425),
        (0.004, -0.0412),
        (0.010, -0.0425),
        (0.0205, -0.0470),
        (0.010, -0.0475),
        (0, -0.0478),
        (-0.010, -0.0475),
    ]
    lower = [
        (-0.0185, -0.0495),
        (-0.010, -0.0525),
        (0, -0.0530),
        (0.010, -0.0525),
        (0.0185, -0.0495),
        (0.012, -0.0580),
        (0, -0.0612),
        (-0.012, -0.0580),
    ]
    paint("lip", "lip_red", np.array(upper), 0.0010, 2)
    paint("lip", "lip_red", np.array(lower), 0.0010, 2)
    # Dark behind the cuts: what one sees through eyes and mouth.
    lining = solid(offset(face, -0.0125), (-0.07, -0.09, -0.03), (0.07, 0.07, 0.07), 0.006, 320)
    items.append(("lining", "ink", lining, 0.0))
    tilt = partial(leaning, degrees=(-14.0, 0.0, 0.0), at=(0.0, 0.148, 0.004))
    parts = [part(name, colour, tilt(mesh), outline) for name, colour, mesh, outline in items]
    return parts + _mask_stand()


def _tilted(angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _mask_field() -> Field:
    """A full oval face, 21 cm high: soft cheeks, small chin, narrow nose, lips in relief."""
    head = union(
        0.050,
        ellipsoid((0, 0.022, 0.0), (0.073, 0.088, 0.048)),
        ellipsoid((0, -0.045, 0.004), (0.056, 0.058, 0.044)),
    )
    soft = union(
        0.022,
        head,
        ellipsoid((0.034, -0.016, 0.030), (0.024, 0.026, 0.018)),
        ellipsoid((-0.034, -0.016, 0.030), (0.024, 0.026, 0.018)),
        ellipsoid((0, -0.078, 0.030), (0.018, 0.014, 0.014)),
    )
    nose = union(
        0.006,
        cone((0, 0.020, 0.044), (0, -0.012, 0.056), 0.0050, 0.0085),
        sphere((0.007, -0.0155, 0.0500), 0.0058),
        sphere((-0.007, -0.0155, 0.0500), 0.0058),
    )
    lips = union(
        0.004,
        ellipsoid((0, -0.0448, 0.0470), (0.018, 0.0052, 0.0075)),
        ellipsoid((0, -0.0560, 0.0465), (0.016, 0.0060, 0.0075)),
    )
    sockets = [ellipsoid((side * 0.031, 0.018, 0.060), (0.021, 0.010, 0.016)) for side in (-1.0, 1.0)]
    return subtraction(0.014, union(0.012, union(0.016, soft, nose), lips), *sockets)


def _ribbon(
    points: list[tuple[float, float]], surface: Callable[[Floats], tuple[Floats, Floats]], width: float
) -> Mesh:
    """A painted line along a surface, thin at both ends."""
    line = smooth_curve(np.array(points), 10)
    position, normal = surface(line)
    taper = width * (0.35 + 0.65 * np.sin(np.pi * np.linspace(0.05, 0.95, 10)))
    return loft(position + normal * 0.0006, normal, taper, 0.0007, 4, "round")


def _mask_stand() -> list[Part]:
    parts = [
        part("foot", "dark_wood", rounded_box((0, 0.009, -0.006), (0.072, 0.009, 0.046), 0.007, cuts=5), 1.0),
        part("foot_line", "old_gold", rounded_box((0, 0.0100, -0.006), (0.0727, 0.0013, 0.0467), 0.001, cuts=3), 0.0),
    ]
    pole = cord(
        [(0, 0.014, -0.026), (0, 0.09, -0.030), (0, 0.160, -0.040)], [0.010, 0.008, 0.0075, 0.007, 0.007, 0.006], 6, 10
    )
    parts.append(part("pole", "dark_wood", pole, 0.8))
    for side in (-1.0, 1.0):
        rest = cord(
            [
                (0, 0.052, -0.024),
                (side * 0.024, 0.044, -0.006),
                (side * 0.030, 0.046, 0.020),
                (side * 0.031, 0.056, 0.032),
            ],
            [0.0065, 0.006, 0.006, 0.0055, 0.005, 0.0045, 0.004],
            7,
            8,
        )
        parts.append(part("rest", "dark_wood", rest, 0.7))
        # Cords from the ears, one falling to the foot, with a tassel each.
        x = side * 0.070
        string = [
            (x, 0.158, -0.010),
            (x + side * 0.014, 0.132, -0.006),
            (x + side * 0.010, 0.090, 0.004),
            (x + side * 0.016, 0.056, 0.010),
        ]
        parts.append(part("cord", "plum", cord(string, 0.0028, 16), 0.5))
        parts.append(
            part("tassel", "plum", leaning(tassel(0.046, 0.0105), (0, 0, 0), (x + side * 0.016, 0.054, 0.010)), 0.7)
        )
        band = lathe([(0.0076, -0.013), (0.0080, -0.008)], 12)
        parts.append(part("tassel_band", "gold", leaning(band, (0, 0, 0), (x + side * 0.016, 0.054, 0.010)), 0.0))
    return parts
