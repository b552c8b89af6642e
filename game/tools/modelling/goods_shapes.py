"""What the goods are made with: sculpted solids, turned bodies, painted lines, inlays on a surface, turning a mesh."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from game.tools.modelling.fields import Field, Floats, normals, smooth_max, unit
from game.tools.modelling.lofts import lathe, loft, smooth_curve
from game.tools.modelling.mesh import Mesh, joined, split_at_level
from game.tools.modelling.parts import Part
from game.tools.modelling.surface import Sculpt

__all__ = [
    "Corner",
    "Good",
    "banded",
    "cord",
    "cut_below",
    "cylinder",
    "disc",
    "facing",
    "inlay",
    "leaning",
    "onto",
    "part",
    "solid",
    "spun",
    "standing",
    "star",
    "stroke",
    "tassel",
    "turned",
]

Good = Callable[[], list[Part]]
Corner = tuple[float, float, float]


def part(name: str, material: str, mesh: Mesh, outline: float = 0.9) -> Part:
    return Part(name, material, mesh, None, outline)


def solid(field: Field, low: Corner, high: Corner, cell: float, count: int) -> Mesh:
    """About ``count`` triangles of the field within a box."""
    return Sculpt(field, low, high, cell).mesh(count)


def standing(field: Field) -> Field:
    """Cut flat just above the table, with a rounded edge."""
    return lambda p: smooth_max(field(p), 0.001 - p[:, 1], 0.006)


def cut_below(field: Field) -> Field:
    """Cut flat at the table, with a nearly sharp edge."""
    return lambda p: smooth_max(field(p), 0.0005 - p[:, 1], 0.003)


def turned(profile: Sequence[tuple[float, float]], sides: int = 40, rounds: int = 7) -> Mesh:
    """A lathe body through a few outline points, smoothed."""
    return lathe(smooth_curve(profile, rounds * len(profile) + 8), sides)


def stroke(points: Sequence[Corner], half_width: float, half_thickness: float, count: int = 10) -> Mesh:
    """A painted line: a thin ribbon through the points, facing +Z."""
    path = smooth_curve(np.array(points), count)
    return loft(path, np.tile([0.0, 0.0, 1.0], (count, 1)), half_width, half_thickness, 5, "round")


def spun(profile: Sequence[tuple[float, float]], sides: int, steps: int) -> Mesh:
    """A lathe body through a few outline points, smoothed into ``steps`` rings."""
    return lathe(smooth_curve(profile, steps), sides)


def tassel(length: float, radius: float) -> Mesh:
    """A bundle of threads below (0, 0, 0), tied near the top."""
    outline = [(0.08, -1.0), (1.0, -0.97), (0.72, -0.30), (0.56, -0.17), (0.74, -0.02), (0.08, 0.10)]
    return spun([(r * radius, y * length) for r, y in outline], 12, 12)


def cord(points: ArrayLike, radius: ArrayLike, count: int, sides: int = 6) -> Mesh:
    """A round string through the points; ``radius`` may be one per ring."""
    path = smooth_curve(points, count)
    # A cord may run any way: its sections lean to whatever lies farthest from its first direction.
    lean = np.eye(3)[int(np.argmin(np.abs(path[-1] - path[0])))]
    return loft(path, np.tile(lean, (count, 1)), radius, radius, sides, "round")


def banded(mesh: Mesh, low: float, high: float) -> tuple[Mesh, Mesh]:
    """(the band of the mesh between two heights, the rest)."""
    upper, below = split_at_level(mesh, mesh.position[:, 1] - low)
    above, band = split_at_level(upper, upper.position[:, 1] - high)
    return band, joined([above, below])


def facing(z: float, flat: Floats) -> tuple[Floats, Floats]:
    """The plane at depth z, seen from +Z."""
    return np.column_stack([flat, np.full(len(flat), z)]), np.tile([0.0, 0.0, 1.0], (len(flat), 1))


def cylinder(radius: float, half: float, sides: int = 16, edge: float = 0.0012) -> Mesh:
    """About +Y, its middle at the origin."""
    return lathe(
        [(1e-4, -half), (radius - edge, -half), (radius, -half + edge), (radius, half - edge), (radius - edge, half)]
        + [(1e-4, half)],
        sides,
    )


def leaning(mesh: Mesh, degrees: tuple[float, float, float], at: ArrayLike = (0.0, 0.0, 0.0)) -> Mesh:
    """Turned about X, then Y, then Z, and moved to ``at``."""
    a, b, c = np.radians(degrees)
    about_x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    about_y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    about_z = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
    rotation = about_z @ about_y @ about_x
    return Mesh(mesh.position @ rotation.T + np.asarray(at), mesh.normal @ rotation.T, mesh.triangle)


def disc(x: float, y: float, radius: float | tuple[float, float], count: int = 16, turn_deg: float = 0.0) -> Floats:
    """Outline (count, 2) of a circle or, with two radii, of an ellipse turned by ``turn_deg``."""
    rx, ry = (radius, radius) if isinstance(radius, float | int) else radius
    angle = np.linspace(0.0, 2 * np.pi, count, endpoint=False)
    turn = np.radians(turn_deg)
    px, py = rx * np.cos(angle), ry * np.sin(angle)
    return np.stack([x + px * np.cos(turn) - py * np.sin(turn), y + px * np.sin(turn) + py * np.cos(turn)], 1)


def star(
    x: float,
    y: float,
    radius: float,
    lobes: int,
    depth: float,
    sharp: float = 1.0,
    turn_deg: float = 90.0,
    steps: int = 8,
) -> Floats:
    """Outline of a flower or star: ``lobes`` tips at ``radius``, hollows ``depth`` (0..1) deep, ``steps`` to a lobe."""
    angle = np.linspace(0.0, 2 * np.pi, lobes * steps, endpoint=False)
    wave = (0.5 + 0.5 * np.cos(lobes * angle)) ** sharp
    r = radius * (1.0 - depth * (1.0 - wave))
    turn = np.radians(turn_deg)
    return np.stack([x + r * np.cos(angle + turn), y + r * np.sin(angle + turn)], 1)


def inlay(
    outline: ArrayLike,
    surface: Callable[[Floats], tuple[Floats, Floats]],
    lift_m: float = 0.0008,
    rings: int = 1,
) -> Mesh:
    """A flat patch painted on a surface.

    outline: (n, 2), star-shaped about its mean. surface: (m, 2) -> positions and normals (m, 3). rings: how many
    times the patch is cut between rim and middle, so that it can follow a curved surface.
    """
    rim = np.asarray(outline, dtype=np.float64)
    count, middle = len(rim), np.asarray(outline, dtype=np.float64).mean(0)
    shares = [k / rings for k in range(rings, 0, -1)]
    flat = np.vstack([middle + (rim - middle) * s for s in shares] + [middle[None]])
    position, normal = surface(flat)
    k = np.arange(count)
    after = (k + 1) % count
    triangles = []
    for ring in range(rings - 1):
        a, b = ring * count, (ring + 1) * count
        triangles += [np.stack([a + k, a + after, b + after], 1), np.stack([a + k, b + after, b + k], 1)]
    inner = (rings - 1) * count
    triangles.append(np.stack([inner + k, inner + after, np.full(count, rings * count)], 1))
    triangle = np.vstack(triangles)
    corner = position[triangle]
    facing = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    if (facing * normal[triangle].sum(1)).sum() < 0:
        triangle = np.ascontiguousarray(triangle[:, ::-1])
    return Mesh(position + normal * lift_m, normal, triangle)


def onto(
    field: Field, origin: ArrayLike, right: ArrayLike, up: ArrayLike, reach_m: float = 0.2
) -> Callable[[Floats], tuple[Floats, Floats]]:
    """A surface for ``inlay``: flat coordinates on the plane (origin, right, up), cast along −(right × up).

    The rays start at the plane and march to the field's surface; those that miss stay where they gave up.
    """
    o, r, u = np.asarray(origin, dtype=np.float64), unit(right), unit(up)
    away = np.cross(r, u)

    def surface(flat: Floats) -> tuple[Floats, Floats]:
        start = o + flat[:, :1] * r + flat[:, 1:] * u
        travel = np.zeros(len(start))
        for _ in range(60):
            travel = np.minimum(travel + 0.8 * field(start - away * travel[:, None]), reach_m)
        position = start - away * travel[:, None]
        return position, normals(field, position)

    return surface
