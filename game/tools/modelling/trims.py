"""What is laid on cloth: lines and bands that follow a field, buttons, crests, folded squares."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from game.tools.modelling.fields import Field, Floats, Ints, gradient, normals, unit
from game.tools.modelling.lofts import lathe, loft, smooth_curve
from game.tools.modelling.mesh import Mesh
from game.tools.modelling.parts import Detail, Part

__all__ = ["Weigh", "disc_on", "knob", "laid_band", "laid_line", "lapel_line", "on_front", "part_of", "patch_on"]

Weigh = Callable[[Floats], Floats]


def part_of(name: str, material: str, mesh: Mesh, weigh: Weigh, outline: float, trim: bool = False) -> Part:
    """A part bound by a function of its rest position."""
    return Part(name, material, mesh, weigh(mesh.position), outline, trim)


def on_front(field: Field, x: ArrayLike, y: ArrayLike, stand_off: float) -> tuple[Floats, Floats]:
    """Points (n, 3) on the front of a body at ``stand_off`` metres, and its normals there."""
    across, height = np.broadcast_arrays(np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64))
    p = np.stack([across, height, np.full(len(across), 0.12)], 1)
    for _ in range(10):
        slope = gradient(field, p)
        p[:, 2] -= np.clip((field(p) - stand_off) / np.maximum(slope[:, 2], 0.3), -0.03, 0.03)
    return p, normals(field, p, 4e-3)


def laid_line(
    field: Field, points: ArrayLike, count: int, stand_off: float, free_above: float = 9.0
) -> tuple[Floats, Floats]:
    """A smooth line through rough ``points`` (m, 3), drawn onto the field; -> (count, 3) and the directions outward.

    Above the height ``free_above`` it stays where the rough points have it.
    """
    line = smooth_curve(points, count)
    held = line[:, 1] < free_above
    for _ in range(25):
        slope = gradient(field, line)
        step = (field(line) - stand_off) / np.maximum((slope**2).sum(1), 0.2)
        line = line - slope * (held * np.clip(step, -0.02, 0.02))[:, None]
        line[1:-1] = 0.5 * line[1:-1] + 0.25 * (line[:-2] + line[2:])
    out = normals(field, line, 5e-3)
    for _ in range(8):
        out[1:-1] = 0.5 * out[1:-1] + 0.25 * (out[:-2] + out[2:])
    return line, unit(out)


def laid_band(
    field: Field,
    points: ArrayLike,
    stand_off: float,
    half_width: ArrayLike,
    half_thickness: float,
    rings: int,
    sides: int,
) -> Mesh:
    """A flat band along a line on a field; half_width may change along it."""
    line, out = laid_line(field, points, rings, stand_off)
    width = np.asarray(half_width, dtype=np.float64)
    if width.ndim:
        width = np.interp(np.linspace(0, 1, rings), np.linspace(0, 1, len(width)), width)
    return loft(line, out, width, half_thickness, sides, "band")


def lapel_line(
    field: Field, opening_y: Sequence[float], opening_x: Sequence[float], hem: float
) -> tuple[Floats, Floats]:
    """Centre line of a coat's lapels around its opening and behind the neck, and the outward direction along it."""
    y = np.linspace(hem + 0.005, 0.925, 30)
    right = np.stack([np.interp(y, opening_y, opening_x) + 0.006, y, np.full(30, 0.10)], 1)
    neck = np.array(
        [
            (0.058, 0.952, 0.050),
            (0.066, 0.970, 0.012),
            (0.065, 0.981, -0.030),
            (0.043, 0.988, -0.064),
            (0, 0.991, -0.077),
        ]
    )
    half = np.vstack([right, neck])
    line = smooth_curve(np.vstack([half, half[::-1][1:] * (-1, 1, 1)]), 150)
    on_coat = line[:, 1] < 0.945
    for _ in range(25):
        slope = gradient(field, line)
        step = slope * (field(line) / np.maximum((slope**2).sum(1), 0.2))[:, None]
        line[on_coat] -= step[on_coat]
        line[1:-1] = 0.5 * line[1:-1] + 0.25 * (line[:-2] + line[2:])
    out = normals(field, line)
    for _ in range(12):
        out[1:-1] = 0.5 * out[1:-1] + 0.25 * (out[:-2] + out[2:])
    return line, unit(out)


def knob(at: Floats, out: Floats, radius: float, height: float, detail: Detail) -> Mesh:
    """A round button with a rim, standing on ``at`` toward ``out``."""
    profile = [
        *((0.0, 0.0), (radius, 0.0), (radius, 0.6 * height), (0.86 * radius, height), (0.70 * radius, 0.86 * height)),
        (0.45 * radius, 0.70 * height),
        (0.0, 0.66 * height),
    ]
    mesh = lathe(profile, detail.sides(22, 8))
    up = unit(out)
    right = unit(np.cross(up, (0.1, 0.2, 1.0)))
    turn = np.stack([right, up, np.cross(right, up)], 1)
    return Mesh(mesh.position @ turn.T + at, mesh.normal @ turn.T, mesh.triangle)


def disc_on(
    field: Field, at: Floats, radius: Callable[[Floats], tuple[Floats, Floats]], detail: Detail, stand_off: float
) -> Mesh:
    """A flat figure laid on a field around ``at``: ``radius(angle)`` -> its inner and outer edge, metres."""
    turns = detail.sides(56, 24)
    angle = np.linspace(0.0, 2 * np.pi, turns, endpoint=False)
    inner, outer = radius(angle)
    out = normals(field, np.asarray(at, dtype=np.float64)[None], 9e-3)[0]
    right = unit(np.cross((0.0, 1.0, 0.0), out))
    up = np.cross(out, right)
    rings = [inner + (outer - inner) * k / 3 for k in range(4)]
    p = np.concatenate([at + (r * np.cos(angle))[:, None] * right + (r * np.sin(angle))[:, None] * up for r in rings])
    for _ in range(12):
        slope = gradient(field, p, 6e-3)
        along = np.maximum(slope @ out, 0.3)
        p = p - out * ((field(p) - stand_off) / along)[:, None]
    k, j = (v.ravel() for v in np.meshgrid(np.arange(3), np.arange(turns), indexing="ij"))
    a, b = k * turns + j, k * turns + (j + 1) % turns
    triangle: Ints = np.vstack([np.stack([a, b, b + turns], 1), np.stack([a, b + turns, a + turns], 1)])
    corner = p[triangle]
    facing = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) @ out
    if facing.sum() < 0:
        triangle = np.ascontiguousarray(triangle[:, ::-1])
    return Mesh(p, normals(field, p, 9e-3), triangle)


def patch_on(field: Field, corners: ArrayLike, stand_off: float, half_thickness: float, detail: Detail) -> Mesh:
    """A thin cushion over a quadrilateral on a field. corners: (4, 3) rough places, around the patch."""
    a, b, c, d = np.asarray(corners, dtype=np.float64)
    n = detail.rings(9, 4)
    u, v = (x.ravel() for x in np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij"))
    p = (
        ((1 - u) * (1 - v))[:, None] * a
        + (u * (1 - v))[:, None] * b
        + (u * v)[:, None] * c
        + ((1 - u) * v)[:, None] * d
    )
    centre = np.mean([a, b, c, d], 0)[None]
    out = normals(field, centre, 9e-3)[0]
    rim = np.minimum(np.minimum(u, 1 - u), np.minimum(v, 1 - v)) < 1e-9
    height = stand_off + half_thickness * np.where(rim, -1.0, 1.0)
    for _ in range(12):
        slope = gradient(field, p, 4e-3)
        p = p - out * ((field(p) - height) / np.maximum(slope @ out, 0.3))[:, None]
    k, j = (x.ravel() for x in np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij"))
    q = k * n + j
    triangle: Ints = np.vstack([np.stack([q, q + n, q + n + 1], 1), np.stack([q, q + n + 1, q + 1], 1)])
    corner = p[triangle]
    if (np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) @ out).sum() < 0:
        triangle = np.ascontiguousarray(triangle[:, ::-1])
    return Mesh(p, normals(field, p, 6e-3), triangle)
