"""Meshes swept along paths or turned on a lathe, in NumPy: hair clumps, lapels, trims, bows, vases, boxes, sheets."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from game.tools.modelling.fields import Floats, Ints, unit
from game.tools.modelling.mesh import Mesh, vertex_normals

__all__ = ["Profile", "bezier", "lathe", "loft", "rounded_box", "sheet", "smooth_curve"]

Profile = Literal["lens", "band", "round"]


def smooth_curve(points: ArrayLike, count: int) -> Floats:
    """(count, d) points of the Catmull-Rom spline through ``points`` (n, d), ends included."""
    p = np.asarray(points, dtype=np.float64)
    p = np.vstack([2 * p[0] - p[1], p, 2 * p[-1] - p[-2]])
    t = np.linspace(0.0, len(p) - 3 - 1e-9, count)
    i = t.astype(int)
    u = (t - i)[:, None]
    a, b, c, d = p[i], p[i + 1], p[i + 2], p[i + 3]
    return np.asarray(0.5 * (2 * b + (c - a) * u + (2 * a - 5 * b + 4 * c - d) * u**2 + (3 * b - a - 3 * c + d) * u**3))


def bezier(points: ArrayLike, count: int) -> Floats:
    """(count, d) points of the cubic Bezier curve of four control points (4, d)."""
    p = np.asarray(points, dtype=np.float64)
    u = np.linspace(0.0, 1.0, count)[:, None]
    return np.asarray((1 - u) ** 3 * p[0] + 3 * u * (1 - u) ** 2 * p[1] + 3 * u * u * (1 - u) * p[2] + u**3 * p[3])


def _section(profile: Profile, sides: int) -> Floats:
    """(sides, 2) outline of a section: x across the width, y outward, both within [-1, 1]."""
    angle = np.linspace(0.0, 2 * np.pi, sides, endpoint=False)
    c, s = np.cos(angle), np.sin(angle)
    if profile == "lens":  # ridged outside, softly flattened inside
        return np.stack([np.sign(c) * np.abs(c) ** 0.9, np.where(s > 0, np.abs(s) ** 1.25, -0.55 * np.abs(s))], 1)
    if profile == "band":
        return np.stack([np.sign(c) * np.abs(c) ** 0.45, np.sign(s) * np.abs(s) ** 0.6], 1)
    return np.stack([c, s], 1)


def _grid_triangles(rows: int, columns: int, wrap_columns: bool, wrap_rows: bool) -> Ints:
    """Two triangles per cell of a (rows, columns) grid of vertices."""
    row = np.arange(rows if wrap_rows else rows - 1)
    column = np.arange(columns if wrap_columns else columns - 1)
    r, c = (x.ravel() for x in np.meshgrid(row, column, indexing="ij"))
    r2, c2 = (r + 1) % rows, (c + 1) % columns
    a, b, d, e = r * columns + c, r * columns + c2, r2 * columns + c, r2 * columns + c2
    return np.vstack([np.stack([a, b, e], 1), np.stack([a, e, d], 1)])


def loft(
    path: Floats,
    outward: Floats,
    half_width: ArrayLike,
    half_thickness: ArrayLike,
    sides: int = 12,
    profile: Profile = "lens",
    closed: bool = False,
) -> Mesh:
    """Sweep a section along ``path`` (n, 3).

    outward: (n, 3), the direction the section's y axis leans to. half_width, half_thickness: scalars or (n,), metres.
    closed: join the last ring to the first instead of capping both ends.
    """
    count = len(path)
    tangent = np.roll(path, -1, 0) - np.roll(path, 1, 0) if closed else np.gradient(path, axis=0)
    tangent = unit(tangent)
    out = unit(outward - (outward * tangent).sum(1, keepdims=True) * tangent)
    across = np.cross(tangent, out)
    section = _section(profile, sides)
    width = np.broadcast_to(np.asarray(half_width, dtype=np.float64), (count,))
    thickness = np.broadcast_to(np.asarray(half_thickness, dtype=np.float64), (count,))
    rings = (
        path[:, None]
        + across[:, None] * (section[None, :, :1] * width[:, None, None])
        + out[:, None] * (section[None, :, 1:] * thickness[:, None, None])
    )
    position = rings.reshape(-1, 3)
    triangle = _grid_triangles(count, sides, True, closed)
    if not closed:
        position = np.vstack([position, path[0], path[-1]])
        j = np.arange(sides)
        k, last = count * sides, (count - 1) * sides
        start = np.stack([np.full(sides, k), (j + 1) % sides, j], 1)
        end = np.stack([np.full(sides, k + 1), last + j, last + (j + 1) % sides], 1)
        triangle = np.vstack([triangle, start, end])
    normal = vertex_normals(position, triangle)
    ring_count = count * sides
    away = position[:ring_count] - np.repeat(path, sides, 0)
    if (normal[:ring_count] * away).sum(1).mean() < 0:
        triangle, normal = np.ascontiguousarray(triangle[:, ::-1]), -normal
    return Mesh(position, normal, triangle)


def lathe(profile: ArrayLike, sides: int = 48, centre: ArrayLike = (0.0, 0.0, 0.0)) -> Mesh:
    """Turn ``profile`` (n, 2), rows (radius, height) from bottom to top, about the vertical axis through ``centre``."""
    outline = np.asarray(profile, dtype=np.float64)
    angle = np.linspace(0.0, 2 * np.pi, sides, endpoint=False)
    radius, height = outline[:, :1], outline[:, 1:]
    position = np.stack(
        [radius * np.sin(angle), np.broadcast_to(height, (len(outline), sides)), radius * np.cos(angle)], -1
    ).reshape(-1, 3) + np.asarray(centre)
    triangle = _grid_triangles(len(outline), sides, True, False)
    return Mesh(position, vertex_normals(position, triangle), triangle)


def sheet(
    surface: Callable[[Floats, Floats], Sequence[Floats]], columns: int, rows: int, facing: Sequence[float] = (0, 0, 1)
) -> Mesh:
    """A parametric surface: ``surface(u, v)`` -> x, y, z for u, v in [0, 1]; its normals lean to ``facing``."""
    u, v = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows), indexing="ij")
    x, y, z = surface(u.ravel(), v.ravel())
    position = np.stack(np.broadcast_arrays(x, y, z), 1).astype(np.float64)
    triangle = _grid_triangles(columns, rows, False, False)
    normal = vertex_normals(position, triangle)
    if (normal @ np.asarray(facing, dtype=np.float64)).mean() < 0:
        triangle, normal = np.ascontiguousarray(triangle[:, ::-1]), -normal
    return Mesh(position, normal, triangle)


def rounded_box(
    centre: ArrayLike, half: ArrayLike, radius: float = 0.006, turn_y_rad: float = 0.0, cuts: int = 6
) -> Mesh:
    """A box with rounded edges: each face is a grid of a cube swollen to a sphere and moved out to the corners."""
    size = np.asarray(half, dtype=np.float64) - radius
    line = np.tan(np.linspace(-np.pi / 4, np.pi / 4, cuts))
    a, b = (x.ravel() for x in np.meshgrid(line, line, indexing="ij"))
    positions: list[Floats] = []
    directions: list[Floats] = []
    triangles: list[Ints] = []
    grid = _grid_triangles(cuts, cuts, False, False)
    for axis in range(3):
        for sign in (1.0, -1.0):
            cube = np.zeros((len(a), 3))
            cube[:, axis], cube[:, (axis + 1) % 3], cube[:, (axis + 2) % 3] = sign, a, b
            direction = unit(cube)
            corner = np.where(np.abs(cube) < 1e-6, 0.0, np.sign(cube)) * size
            positions.append(corner + direction * radius)
            directions.append(direction)
            triangles.append((grid[:, ::-1] if sign > 0 else grid) + len(a) * len(triangles))
    mesh = Mesh(np.vstack(positions), np.vstack(directions), np.vstack(triangles).astype(np.int64))
    return mesh.placed(np.asarray(centre, dtype=np.float64), turn_y_rad)
