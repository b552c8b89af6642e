"""Signed distance fields: a field maps points (n, 3) metres to distances (n,) metres, negative inside.

Primitives and operators after I. Quilez, "Distance functions" and "Smooth minimum" (cubic polynomial form). The
ellipsoid is his first-order bound, exact at the surface to first order, which Newton projection needs.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Field",
    "Floats",
    "Ints",
    "box",
    "capsule",
    "cone",
    "ellipsoid",
    "gradient",
    "intersection",
    "mirrored",
    "normals",
    "offset",
    "plane",
    "project",
    "ring",
    "smooth_max",
    "smooth_min",
    "smoothstep",
    "sphere",
    "subtraction",
    "union",
    "unit",
]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Field = Callable[[Floats], Floats]


def _vector(values: ArrayLike) -> Floats:
    return np.asarray(values, dtype=np.float64)


def unit(vectors: ArrayLike) -> Floats:
    """Vectors (..., 3) scaled to length 1 (a zero vector stays zero)."""
    array = _vector(vectors)
    return np.asarray(array / np.maximum(np.linalg.norm(array, axis=-1, keepdims=True), 1e-12))


def smoothstep(low: float, high: float, x: Floats) -> Floats:
    """GLSL's smoothstep; ``low > high`` falls instead of rising."""
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def sphere(centre: ArrayLike, radius: float) -> Field:
    c = _vector(centre)
    return lambda p: np.asarray(np.linalg.norm(p - c, axis=1) - radius)


def ellipsoid(centre: ArrayLike, radii: ArrayLike, axes: Floats | None = None) -> Field:
    """``axes``: (3, 3), its columns are the local axes; the world's where None."""
    c, r = _vector(centre), _vector(radii)

    def field(p: Floats) -> Floats:
        q = p - c if axes is None else (p - c) @ axes
        k0 = np.linalg.norm(q / r, axis=1)
        k1 = np.linalg.norm(q / (r * r), axis=1)
        return np.asarray(k0 * (k0 - 1.0) / np.maximum(k1, 1e-9))

    return field


def capsule(start: ArrayLike, end: ArrayLike, radius: float) -> Field:
    a, b = _vector(start), _vector(end)
    ab = b - a
    length2 = float(ab @ ab)

    def field(p: Floats) -> Floats:
        t = np.clip((p - a) @ ab / length2, 0.0, 1.0)
        return np.asarray(np.linalg.norm(p - a - t[:, None] * ab, axis=1) - radius)

    return field


def cone(start: ArrayLike, end: ArrayLike, start_radius: float, end_radius: float) -> Field:
    """A capsule whose radius changes linearly (Quilez' round cone)."""
    a, b = _vector(start), _vector(end)
    ba = b - a
    l2 = float(ba @ ba)
    rr = start_radius - end_radius
    a2 = l2 - rr * rr
    il2 = 1.0 / l2

    def field(p: Floats) -> Floats:
        pa = p - a
        y = pa @ ba
        z = y - l2
        v = pa * l2 - y[:, None] * ba
        x2 = (v * v).sum(1)
        y2, z2 = y * y * l2, z * z * l2
        k = np.sign(rr) * rr * rr * x2
        d = (np.sqrt(np.maximum(x2 * a2 * il2, 0.0)) + y * rr) * il2 - start_radius
        d = np.where(np.sign(y) * a2 * y2 < k, np.sqrt(x2 + y2) * il2 - start_radius, d)
        return np.asarray(np.where(np.sign(z) * a2 * z2 > k, np.sqrt(x2 + z2) * il2 - end_radius, d))

    return field


def box(centre: ArrayLike, half: ArrayLike, radius: float = 0.0, axes: Floats | None = None) -> Field:
    """A box of half sizes ``half`` with edges rounded by ``radius`` (which the half sizes include)."""
    c, h = _vector(centre), _vector(half) - radius

    def field(p: Floats) -> Floats:
        q = np.abs(p - c if axes is None else (p - c) @ axes) - h
        return np.asarray(np.linalg.norm(np.maximum(q, 0.0), axis=1) + np.minimum(q.max(1), 0.0) - radius)

    return field


def plane(point: ArrayLike, normal: ArrayLike) -> Field:
    """Half space: negative on the side away from ``normal``."""
    o, n = _vector(point), unit(normal)
    return lambda p: np.asarray((p - o) @ n)


def ring(centre: ArrayLike, radius: float, thickness: float, axis: int = 1) -> Field:
    """A torus about the coordinate axis ``axis`` (0 = x, 1 = y, 2 = z)."""
    c = _vector(centre)
    first, second = (i for i in range(3) if i != axis)

    def field(p: Floats) -> Floats:
        q = p - c
        return np.asarray(np.hypot(np.hypot(q[:, first], q[:, second]) - radius, q[:, axis]) - thickness)

    return field


def smooth_min(a: Floats, b: Floats, k: float) -> Floats:
    """Cubic smooth minimum: differs from min only where |a - b| < k, by at most k/6."""
    h = np.maximum(k - np.abs(a - b), 0.0) / k
    return np.asarray(np.minimum(a, b) - h * h * h * k / 6.0)


def smooth_max(a: Floats, b: Floats, k: float) -> Floats:
    return -smooth_min(-a, -b, k)


def union(k: float, *fields: Field) -> Field:
    """Union with joins rounded over ``k`` metres."""

    def field(p: Floats) -> Floats:
        d = fields[0](p)
        for other in fields[1:]:
            d = smooth_min(d, other(p), k)
        return d

    return field


def intersection(k: float, *fields: Field) -> Field:
    def field(p: Floats) -> Floats:
        d = fields[0](p)
        for other in fields[1:]:
            d = smooth_max(d, other(p), k)
        return d

    return field


def subtraction(k: float, base: Field, *cutters: Field) -> Field:
    def field(p: Floats) -> Floats:
        d = base(p)
        for cutter in cutters:
            d = smooth_max(d, -cutter(p), k)
        return d

    return field


def offset(field: Field, grow_m: float) -> Field:
    return lambda p: field(p) - grow_m


def mirrored(field: Field) -> Field:
    """The +X half of ``field``, mirrored to both sides."""

    def both(p: Floats) -> Floats:
        q = p.copy()
        q[:, 0] = np.abs(q[:, 0])
        return field(q)

    return both


def gradient(field: Field, points: Floats, step_m: float = 4e-4) -> Floats:
    """Central differences, (n, 3)."""
    result = np.empty_like(points)
    for axis in range(3):
        shift = np.zeros(3)
        shift[axis] = step_m
        result[:, axis] = field(points + shift) - field(points - shift)
    return np.asarray(result / (2.0 * step_m))


def normals(field: Field, points: Floats, step_m: float = 6e-4) -> Floats:
    """Unit outward normals from the field; a wide step smooths the folds of cloth."""
    return unit(gradient(field, points, step_m))


def project(field: Field, points: Floats, rounds: int = 2) -> Floats:
    """Newton steps onto the zero level (no step longer than 10 mm)."""
    for _ in range(rounds):
        slope = gradient(field, points)
        step = field(points) / np.maximum((slope * slope).sum(1), 0.2)
        points = points - slope * np.clip(step, -0.01, 0.01)[:, None]
    return points
