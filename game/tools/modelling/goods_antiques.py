"""Antiques, the small and precious: pocket watch, lacquer box, tea bowl. Each stands on (0, 0, 0) and faces +Z."""

from __future__ import annotations

from functools import partial

import numpy as np

from game.tools.modelling.fields import Floats, unit
from game.tools.modelling.goods_shapes import cord, disc, facing, inlay, leaning, part, spun, star, stroke, tassel
from game.tools.modelling.lofts import lathe, loft, rounded_box, sheet, smooth_curve
from game.tools.modelling.mesh import Mesh, joined, split_at_level
from game.tools.modelling.parts import Part

__all__ = ["lacquer_box", "pocket_watch", "tea_bowl"]

_WATCH_TILT_DEG = -24.0
_WATCH_AT = (0.012, 0.098, -0.004)


def _forward(mesh: Mesh) -> Mesh:
    """A lathe body turned so that its top looks to +Z."""
    return leaning(mesh, (90.0, 0.0, 0.0))


def pocket_watch() -> list[Part]:
    """An open hunter watch on a plum cushion: engraved lid, enamel dial, blued hands, a chain down to the table."""
    parts: list[Part] = []
    watch: list[tuple[str, str, Mesh, float]] = []
    outline = [(0.001, -0.020), (0.040, -0.020), (0.058, -0.012), (0.064, 0.0), (0.060, 0.009), (0.0545, 0.0115)]
    case = _forward(spun([*outline, (0.0515, 0.008)], 36, 16))
    watch.append(("case", "gold", case, 1.0))
    # A milled rim: fine teeth round the edge.
    for k in range(36):
        tooth = rounded_box((0.0638, 0, 0), (0.0016, 0.0014, 0.0045), 0.001, cuts=2)
        watch.append(("milling", "old_gold", leaning(tooth, (0, 0, 10.0 * k)), 0.0))
    face = partial(facing, 0.0085)
    watch.append(("dial", "enamel", inlay(disc(0, 0, 0.0525, 32), face, 0.0), 0.0))
    watch.append(("track", "ink", inlay(disc(0, 0, 0.0490, 32), face, 0.0004), 0.0))
    watch.append(("dial", "enamel", inlay(disc(0, 0, 0.0482, 32), face, 0.0007), 0.0))
    watch.append(("subdial", "old_gold", inlay(disc(0, -0.024, 0.0125, 24), face, 0.0010), 0.0))
    watch.append(("subdial", "enamel", inlay(disc(0, -0.024, 0.0112, 24), face, 0.0013), 0.0))
    for k in range(12):
        s, c = float(np.sin(k * np.pi / 6)), float(np.cos(k * np.pi / 6))
        if k == 6:
            continue
        width = 0.0026 if k % 3 == 0 else 0.0013
        near = 0.034 if k % 3 == 0 else 0.037
        # Numerals as bundles of bars, as Roman ones read from afar.
        for bar in (-1, 1) if k % 3 else (-1, 0, 1):
            side = bar * width * 1.15
            a = (s * near + c * side, c * near - s * side, 0.0095)
            b = (s * 0.0455 + c * side, c * 0.0455 - s * side, 0.0095)
            m = tuple((p + q) / 2 for p, q in zip(a, b, strict=True))
            watch.append(("numeral", "ink", stroke([a, (m[0], m[1], m[2]), b], width * 0.42, 0.0006, 3), 0.0))
    # Ten to two.
    for angle, length, width in ((0.96, 0.026, 0.0027), (-1.047, 0.040, 0.0021)):
        s, c = float(np.sin(angle)), float(np.cos(angle))
        hand = np.array([(-0.5, -0.10), (-1.0, 0.45), (-0.35, 0.55), (0, 1.0), (0.35, 0.55), (1.0, 0.45), (0.5, -0.10)])
        outline = np.stack([hand[:, 0] * width, hand[:, 1] * length], 1) @ np.array([[c, -s], [s, c]])
        watch.append(("hand", "blued", inlay(outline, face, 0.0022), 0.0))
    second = np.array([(-0.0007, 0.0), (0.0007, 0.0), (0.0003, 0.010), (-0.0003, 0.010)]) @ np.array(
        [[0.6, -0.8], [0.8, 0.6]]
    )
    watch.append(("second_hand", "vermilion", inlay(second + (0, -0.024), face, 0.0020), 0.0))
    arbor = spun([(0.0035, 0.0), (0.003, 0.003), (0.0004, 0.004)], 10, 4)
    watch.append(("arbor", "gold", leaning(arbor, (90, 0, 0), (0, 0, 0.0095)), 0.0))
    # Pendant, crown and bow at the top.
    stem = spun([(0.010, 0.0), (0.0085, 0.008), (0.0055, 0.010), (0.0055, 0.014)], 12, 6)
    crown = spun([(0.008, 0.0), (0.0105, 0.002), (0.0105, 0.010), (0.007, 0.013), (0.0005, 0.0135)], 16, 10)
    watch.append(("stem", "gold", leaning(stem, (0, 0, 0), (0, 0.058, -0.004)), 0.7))
    watch.append(("crown", "old_gold", leaning(crown, (0, 0, 0), (0, 0.071, -0.004)), 0.7))
    around = np.linspace(0, 2 * np.pi, 20, endpoint=False)
    bow = np.stack([0.019 * np.sin(around), 0.089 + 0.017 * np.cos(around), np.full(20, -0.004)], 1)
    watch.append(("bow", "gold", loft(bow, np.tile([0.0, 0, 1], (20, 1)), 0.0030, 0.0030, 6, "round", True), 0.7))
    # The lid swings open on the left, engraved inside: sun rays round a chrysanthemum.
    outline = [(0.001, -0.0075), (0.036, -0.0065), (0.056, -0.001), (0.060, 0.004), (0.0575, 0.005), (0.052, 0.001)]
    lid = _forward(spun([*outline, (0.030, -0.003), (0.001, -0.004)], 32, 16))
    lid_parts = [("lid", "gold", lid, 1.0)]
    inner = partial(facing, 0.0)
    lid_parts.append(("mirror", "old_gold", inlay(disc(0, 0, 0.046, 28), inner, 0.0014), 0.0))
    lid_parts.append(("engraving", "gold", inlay(star(0, 0, 0.044, 16, 0.22, 0.6), inner, 0.0020), 0.0))
    lid_parts.append(("engraving", "old_gold", inlay(star(0, 0, 0.029, 12, 0.30, 0.7), inner, 0.0025), 0.0))
    lid_parts.append(("engraving", "gold", inlay(star(0, 0, 0.020, 8, 0.38, 0.8), inner, 0.0030), 0.0))
    lid_parts.append(("engraving", "old_gold", inlay(disc(0, 0, 0.006, 14), inner, 0.0035), 0.0))
    for name, colour, mesh, line in lid_parts:
        # Hinged at x = -60 mm: opened by 118 degrees from closed, so its inside looks half to the front.
        opened = leaning(leaning(mesh, (0, 0, 0), (0.062, 0, 0)), (0, 62, 0))
        mirrored = Mesh(opened.position * (-1, 1, 1), opened.normal * (-1, 1, 1), opened.triangle[:, ::-1])
        watch.append((name, colour, leaning(mirrored, (0, 0, 0), (-0.062, 0.0, 0.008)), line))
    hinge = spun([(0.001, -0.014), (0.0042, -0.013), (0.0042, 0.013), (0.001, 0.014)], 8, 5)
    hinge = leaning(hinge, (0, 0, 0), (-0.064, 0, 0.008))
    watch.append(("hinge", "old_gold", hinge, 0.5))
    for name, colour, mesh, line in watch:
        parts.append(part(name, colour, leaning(mesh, (_WATCH_TILT_DEG, 0, 0), _WATCH_AT), line))
    # Cushioned stand behind it.
    cushion = rounded_box((0.0, 0.0, 0.0), (0.066, 0.050, 0.020), 0.018, cuts=6)
    parts.append(part("cushion", "plum", leaning(cushion, (_WATCH_TILT_DEG, 0, 0), (0.012, 0.062, -0.040)), 0.9))
    base = rounded_box((0.004, 0.011, 0.0), (0.082, 0.011, 0.056), 0.006, cuts=4)
    rim = rounded_box((0.004, 0.0225, 0.0), (0.076, 0.0035, 0.050), 0.003, cuts=3)
    parts += [part("base", "dark_wood", base, 1.0), part("base_cloth", "plum", rim, 0.4)]
    back = rounded_box((0.0, 0.0, 0.0), (0.070, 0.056, 0.005), 0.004, cuts=4)
    parts.append(part("easel", "dark_wood", leaning(back, (_WATCH_TILT_DEG, 0, 0), (0.012, 0.070, -0.062)), 0.9))
    parts += _chain()
    return parts


def _chain() -> list[Part]:
    """Links from the bow over the cushion's side down to the table, every second one turned."""
    path = smooth_curve(
        [(0.016, 0.186, -0.044), (0.050, 0.182, -0.020), (0.084, 0.120, 0.010), (0.094, 0.040, 0.036)]
        + [(0.090, 0.008, 0.064), (0.056, 0.006, 0.078), (0.020, 0.006, 0.070), (-0.012, 0.006, 0.082)]
        + [(-0.044, 0.006, 0.074)],
        120,
    )
    walked = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    steps = np.arange(0.0, walked[-1], 0.0168)
    path = np.stack([np.interp(steps, walked, path[:, i]) for i in range(3)], 1)
    tangent = unit(np.gradient(path, axis=0))
    angle = np.linspace(0, 2 * np.pi, 7, endpoint=False)
    links = []
    for k, (at, along) in enumerate(zip(path, tangent, strict=True)):
        side = unit(np.cross(along, (0.2, 1.0, 0.1) if k % 2 else (0.9, 0.1, 0.4)))
        ring = at + 0.0105 * np.cos(angle)[:, None] * along + 0.0052 * np.sin(angle)[:, None] * side
        across = np.tile(unit(np.cross(along, side)), (7, 1))
        links.append(loft(ring, across, 0.0018, 0.0018, 4, "round", True))
    bar = cord(
        [(-0.054, 0.006, 0.056), (-0.056, 0.0065, 0.072), (-0.058, 0.006, 0.090)],
        [0.002, 0.0032, 0.0036, 0.0032, 0.002],
        5,
        8,
    )
    return [part("chain", "gold", joined(links), 0.45), part("chain_bar", "gold", bar, 0.5)]


def lacquer_box() -> list[Part]:
    """A two-tiered black box with maki-e: plum branch under the moon on the lid, waves round the sides; a silk cord."""
    w, d = 0.092, 0.070
    parts = [
        part("box", "lacquer", rounded_box((0, 0.030, 0), (w, 0.026, d), 0.010, cuts=5), 1.0),
        part("box", "lacquer", rounded_box((0, 0.078, 0), (w, 0.021, d), 0.010, cuts=5), 1.0),
        part("lid", "lacquer", rounded_box((0, 0.111, 0), (w + 0.003, 0.013, d + 0.003), 0.009, cuts=5), 1.0),
        part("rim", "gold", rounded_box((0, 0.0565, 0), (w + 0.0006, 0.0016, d + 0.0006), 0.0015, cuts=4), 0.0),
        part("rim", "gold", rounded_box((0, 0.0985, 0), (w + 0.0036, 0.0015, d + 0.0036), 0.0014, cuts=4), 0.0),
    ]
    for x in (-1.0, 1.0):
        for z in (-1.0, 1.0):
            foot = rounded_box((x * (w - 0.016), 0.004, z * (d - 0.016)), (0.014, 0.005, 0.014), 0.003, cuts=3)
            parts.append(part("foot", "vermilion", foot, 0.6))

    def top(flat: Floats) -> tuple[Floats, Floats]:
        count = len(flat)
        return np.stack([flat[:, 0], np.full(count, 0.1242), -flat[:, 1]], 1), np.tile([0.0, 1, 0], (count, 1))

    def painted(name: str, colour: str, outline: Floats, layer: int) -> None:
        parts.append(part(name, colour, inlay(outline, top, 0.0003 * (1 + layer)), 0.0))

    painted("moon", "old_gold", disc(0.046, 0.030, 0.023, 28), 0)
    for x, y, r in ((-0.050, 0.040, 0.012), (-0.036, 0.043, 0.009), (0.064, 0.004, 0.010), (0.050, 0.001, 0.008)):
        painted("cloud", "old_gold", disc(x, y, (r * 1.7, r * 0.5), 16), 1)
    branch = [(-0.084, -0.048), (-0.056, -0.030), (-0.034, -0.024), (-0.010, -0.004), (0.018, 0.002), (0.050, 0.022)]
    parts.append(_branch(branch, 0.0040, top))
    parts.append(_branch([(-0.034, -0.024), (-0.022, -0.036), (0.004, -0.040), (0.030, -0.034)], 0.0026, top))
    parts.append(_branch([(-0.010, -0.004), (-0.016, 0.014), (-0.010, 0.030)], 0.0022, top))
    for k, (x, y, r) in enumerate(
        ((-0.036, -0.012, 0.014), (0.004, 0.010, 0.013), (0.030, 0.012, 0.012), (0.008, -0.034, 0.013))
        + ((-0.014, 0.026, 0.011), (0.034, -0.030, 0.010), (0.056, 0.030, 0.008), (-0.060, -0.040, 0.008))
    ):
        painted("blossom", "pearl" if k % 3 else "vermilion", star(x, y, r, 5, 0.34, 0.55, 90 + k * 25), 4)
        painted("heart", "gold", star(x, y, r * 0.42, 5, 0.55, 1.0, 54 + k * 25), 5)
    for sign in (1.0, -1.0):
        parts += _waves(w, d, sign)
        parts += _waves(d, w, sign, sideways=True)
    parts += _silk_cord(w, d)
    return parts


def _branch(points: list[tuple[float, float]], width: float, surface: object) -> Part:
    """A brushed line on the lid, tapering."""
    path = smooth_curve(np.array(points), 14)
    flat = np.stack([path[:, 0], np.full(14, 0.1246), -path[:, 1]], 1)
    taper = width * np.linspace(1.0, 0.35, 14)
    return part("branch", "gold", loft(flat, np.tile([0.0, 1, 0], (14, 1)), taper, 0.0007, 5, "round"), 0.0)


def _waves(w: float, d: float, sign: float, sideways: bool = False) -> list[Part]:
    """Seigaiha: rows of nested arcs along the lower tier, and drifting petals above."""

    def side(flat: Floats) -> tuple[Floats, Floats]:
        depth = np.full(len(flat), sign * d)
        zero, one = np.zeros(len(flat)), np.full(len(flat), sign)
        if sideways:
            return np.stack([depth, flat[:, 1], -sign * flat[:, 0]], 1), np.stack([one, zero, zero], 1)
        return np.stack([sign * flat[:, 0], flat[:, 1], depth], 1), np.stack([zero, zero, one], 1)

    parts = []
    step = 0.0225
    count = int((w - 0.012) / step * 2)
    angle = np.linspace(0, np.pi, 8)
    for row in range(2):
        for k in range(count - row):
            x = (k - (count - 1 - row) / 2) * step
            y = 0.012 + row * 0.0085
            for ring, colour in ((0.0112, "gold"), (0.0088, "lacquer"), (0.0066, "old_gold"), (0.0040, "lacquer")):
                arc = np.stack([x + ring * np.cos(angle), y + ring * 1.1 * np.sin(angle)], 1)
                lift = 0.0003 + 0.0003 * (1 - row) * 4 + 0.0002 * round((0.0112 - ring) / 0.0024)
                parts.append(part("wave", colour, inlay(arc, side, lift), 0.0))
    for k in range(5):
        x, y = -w * 0.75 + k * w * 0.37, 0.074 + 0.011 * np.sin(k * 2.3)
        petal = star(x, float(y), 0.0085, 5, 0.36, 0.6, 90 + k * 40)
        parts.append(part("petal", ("pearl", "old_gold")[k % 2], inlay(petal, side, 0.0008), 0.0))
    return parts


def _silk_cord(w: float, d: float) -> list[Part]:
    """Vermilion cord round the middle with a bow and two tassels in front."""
    parts = []
    around = [
        *((0, 0.1285, 0), (0, 0.1285, -d * 0.8), (0, 0.122, -d - 0.006), (0, 0.06, -d - 0.006), (0, 0.006, -d * 0.95)),
        *(
            (0, 0.0045, -d * 0.5),
            (0, 0.0045, d * 0.5),
            (0, 0.006, d * 0.95),
            (0, 0.06, d + 0.006),
            (0, 0.122, d + 0.006),
            (0, 0.1285, d * 0.8),
            (0, 0.1285, 0),
        ),
    ]
    for shift in (-0.0036, 0.0036):
        parts.append(part("cord", "silk", cord(np.array(around) + (shift, 0, 0), 0.0036, 34, 5), 0.5))
    # The bow lies flat on the lid's front half, its ends hang over the edge.
    for side in (-1.0, 1.0):
        loop = [
            *((0, 0.131, 0.030), (side * 0.030, 0.140, 0.020), (side * 0.052, 0.136, 0.030)),
            *((side * 0.040, 0.133, 0.044), (0.0, 0.132, 0.034)),
        ]
        parts.append(part("bow", "silk", cord(loop, 0.0040, 14, 6), 0.6))
        tail = [
            (0, 0.132, 0.034),
            (side * 0.018, 0.132, 0.058),
            (side * 0.028, 0.118, 0.0785),
            (side * 0.030, 0.098, 0.079),
        ]
        parts.append(part("tail", "silk", cord(tail, 0.0036, 9, 5), 0.5))
        end = (side * 0.030, 0.096, 0.079)
        parts.append(part("tassel", "silk", leaning(tassel(0.034, 0.0095), (0, 0, 0), end), 0.6))
        band = lathe([(0.0069, -0.0095), (0.0072, -0.0060)], 12)
        parts.append(part("tassel_band", "gold", leaning(band, (0, 0, 0), end), 0.0))
    knot = spun([(0.0005, -0.009), (0.008, -0.005), (0.008, 0.005), (0.0005, 0.009)], 12, 8)
    parts.append(part("knot", "silk", leaning(knot, (90, 0, 0), (0, 0.133, 0.033)), 0.7))
    return parts


def tea_bowl() -> list[Part]:
    """A raku bowl: dark clay foot, celadon glaze running down in tears, gold seams where it was mended."""
    outer = [
        *((0.001, 0.004), (0.026, 0.003), (0.033, 0.0), (0.036, 0.004), (0.034, 0.011), (0.052, 0.017), (0.071, 0.036)),
        *((0.079, 0.062), (0.080, 0.088), (0.078, 0.101), (0.0765, 0.1055), (0.0738, 0.1035), (0.0728, 0.096)),
    ]
    inner = [
        (0.0735, 0.1030),
        (0.0728, 0.096),
        (0.073, 0.066),
        (0.064, 0.040),
        (0.044, 0.024),
        (0.020, 0.019),
        (0.001, 0.018),
    ]
    body = _wobbled(lathe(smooth_curve(outer, 32), 44))
    radius = np.hypot(body.position[:, 0], body.position[:, 2])
    # Tears of glaze: long and short, thick at the lower end.
    edge = np.where(radius < 0.030, 0.05, _edge(body))
    glaze, clay = split_at_level(body, body.position[:, 1] - edge)
    lip, glaze = split_at_level(
        glaze, glaze.position[:, 1] - 0.098 - 0.003 * np.sin(4 * np.arctan2(*glaze.position[:, [0, 2]].T))
    )
    tears, glaze = split_at_level(glaze, 0.013 - (glaze.position[:, 1] - _edge(glaze)))
    parts = [
        part("clay", "clay", clay, 0.9),
        part("glaze", "celadon", Mesh(glaze.position + glaze.normal * 0.0012, glaze.normal, glaze.triangle), 1.0),
        part("tears", "celadon_deep", Mesh(tears.position + tears.normal * 0.0014, tears.normal, tears.triangle), 0.5),
        part("lip", "glaze_rust", Mesh(lip.position + lip.normal * 0.0012, lip.normal, lip.triangle), 0.7),
    ]
    well = _wobbled(lathe(smooth_curve(inner, 16), 44))
    tea, inside = split_at_level(well, 0.036 - well.position[:, 1])
    parts += [part("inside", "celadon", inside, 0.3), part("pool", "celadon_deep", tea, 0.0)]
    for path in (
        [(0.15, 0.104), (0.05, 0.088), (0.22, 0.070), (0.10, 0.052), (0.30, 0.036)],
        [(0.22, 0.070), (0.48, 0.066), (0.62, 0.078), (0.86, 0.070)],
        [(0.62, 0.078), (0.66, 0.094), (0.60, 0.105)],
        [(-2.4, 0.104), (-2.2, 0.084), (-2.45, 0.064), (-2.3, 0.044)],
    ):
        parts.append(part("seam", "gold", _seam(np.array(path), outer), 0.0))
    cloth = sheet(
        lambda u, v: (0.094 * (2 * u - 1), 0.0022 + 0.0012 * np.sin(9 * u) * np.sin(7 * v), 0.080 * (2 * v - 1)),
        10,
        10,
        (0, 1, 0),
    )
    rim = sheet(lambda u, v: (0.086 * (2 * u - 1), np.full_like(u, 0.0042), 0.072 * (2 * v - 1)), 6, 6, (0, 1, 0))
    parts += [
        part("cloth", "old_gold", leaning(cloth, (0, 18, 0), (0, 0, 0)), 0.6),
        part("cloth", "plum", leaning(rim, (0, 18, 0), (0, 0, 0)), 0.0),
    ]
    return parts


def _edge(mesh: Mesh) -> Floats:
    angle = np.arctan2(mesh.position[:, 0], mesh.position[:, 2])
    return np.asarray(
        0.036 + 0.011 * np.sin(3 * angle + 0.7) + 0.007 * np.sin(7 * angle) + 0.005 * np.sin(13 * angle + 2.0)
    )


def _wobbled(mesh: Mesh) -> Mesh:
    """Made by hand: not quite round."""
    x, y, z = mesh.position.T
    angle = np.arctan2(x, z)
    swell = 1.0 + 0.022 * np.sin(2 * angle + 0.4) * np.clip(y / 0.1, 0, 1) + 0.010 * np.sin(5 * angle + y * 60)
    lift = 0.0030 * np.sin(3 * angle + 1.0) * np.clip((y - 0.06) / 0.045, 0, 1)
    return Mesh(np.stack([x * swell, y + lift, z * swell], 1), mesh.normal, mesh.triangle)


def _seam(path: Floats, outer: list[tuple[float, float]]) -> Mesh:
    """A gold line on the bowl through (azimuth, height) points."""
    line = smooth_curve(path, 13)
    profile = smooth_curve(outer, 80)[20:]
    order = np.argsort(profile[:, 1])
    radius = np.interp(line[:, 1], profile[order, 1], profile[order, 0]) + 0.0016
    position = np.stack([radius * np.sin(line[:, 0]), line[:, 1], radius * np.cos(line[:, 0])], 1)
    ring = Mesh(position, position, np.zeros((0, 3), np.int64))
    position = _wobbled(ring).position
    outward = unit(position * (1, 0, 1))
    return loft(position, outward, 0.0017, 0.0010, 5, "round")
