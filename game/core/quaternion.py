"""Unit quaternions as (..., 4) float arrays in x, y, z, w order (as glTF and SciPy store them).

Everything broadcasts over leading axes. Rotations act on column vectors: ``multiply(a, b)`` rotates by b first.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.floating[Any]]

__all__ = [
    "IDENTITY",
    "align",
    "between",
    "conjugate",
    "exp",
    "from_axis_angle",
    "from_euler",
    "from_matrix",
    "log",
    "multiply",
    "nlerp",
    "normalize",
    "rotate",
    "slerp",
    "to_euler",
    "to_matrix",
]

IDENTITY: Floats = np.array([0.0, 0.0, 0.0, 1.0])
IDENTITY.setflags(write=False)


def normalize(q: ArrayLike) -> Floats:
    """(..., 4) -> unit length. A zero quaternion becomes the identity."""
    q = np.asarray(q, dtype=np.result_type(np.asarray(q), np.float32))
    length = np.sqrt(np.einsum("...i,...i->...", q, q))[..., None]
    return np.asarray(np.where(length > 1e-12, q / np.maximum(length, 1e-12), IDENTITY.astype(q.dtype)))


def multiply(a: Floats, b: Floats) -> Floats:
    """Hamilton product, (..., 4) x (..., 4): first b, then a."""
    ax, ay, az, aw = a[..., 0], a[..., 1], a[..., 2], a[..., 3]
    bx, by, bz, bw = b[..., 0], b[..., 1], b[..., 2], b[..., 3]
    x = aw * bx + ax * bw + ay * bz - az * by
    product = np.empty((*x.shape, 4), dtype=x.dtype)
    product[..., 0] = x
    product[..., 1] = aw * by - ax * bz + ay * bw + az * bx
    product[..., 2] = aw * bz + ax * by - ay * bx + az * bw
    product[..., 3] = aw * bw - ax * bx - ay * by - az * bz
    return product


def conjugate(q: Floats) -> Floats:
    """The inverse of a unit quaternion."""
    return q * np.array([-1.0, -1.0, -1.0, 1.0], dtype=q.dtype)


def rotate(q: Floats, v: Floats) -> Floats:
    """Rotate (..., 3) vectors by (..., 4) quaternions."""
    # Component by component: three times as fast as np.cross, which moves axes about and writes whole arrays twice.
    x, y, z, w = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    a, b, c = v[..., 0], v[..., 1], v[..., 2]
    ta, tb, tc = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return np.stack(
        [a + w * ta + (y * tc - z * tb), b + w * tb + (z * ta - x * tc), c + w * tc + (x * tb - y * ta)], axis=-1
    )


def align(q: Floats, reference: Floats) -> Floats:
    """Flip q into the hemisphere of reference, so that blending takes the short way."""
    return np.asarray(np.where((q * reference).sum(-1, keepdims=True) < 0.0, -q, q))


def nlerp(a: Floats, b: Floats, t: ArrayLike) -> Floats:
    """Normalised linear blend, t in [0, 1] broadcast over (...,)."""
    w = np.asarray(t)[..., None]
    return normalize(a * (1.0 - w) + align(b, a) * w)


def slerp(a: Floats, b: Floats, t: ArrayLike) -> Floats:
    """Spherical blend with constant angular speed, t broadcast over (...,)."""
    return multiply(a, exp(log(multiply(conjugate(a), align(b, a))) * np.asarray(t)[..., None]))


def log(q: Floats) -> Floats:
    """Rotation vector (..., 3), radians, of a unit quaternion; length at most pi after taking the short way."""
    q = np.where(q[..., 3:] < 0.0, -q, q)
    s = np.sqrt(np.einsum("...i,...i->...", q[..., :3], q[..., :3]))[..., None]
    angle = 2.0 * np.arctan2(s, q[..., 3:])
    return np.asarray(np.where(s > 1e-8, q[..., :3] * (angle / np.maximum(s, 1e-8)), 2.0 * q[..., :3]))


def exp(rotation_vector: ArrayLike) -> Floats:
    """Quaternion of a rotation vector (..., 3) in radians."""
    r = np.asarray(rotation_vector, dtype=np.result_type(np.asarray(rotation_vector), np.float32))
    half = 0.5 * np.sqrt(np.einsum("...i,...i->...", r, r))[..., None]
    scale = np.where(half > 1e-8, np.sin(half) / np.maximum(2.0 * half, 1e-16), 0.5)
    return np.concatenate([r * scale, np.cos(half)], axis=-1)


def from_axis_angle(axis: ArrayLike, angle_rad: ArrayLike) -> Floats:
    """axis (..., 3) need not be unit; angle (...,) in radians."""
    a = np.asarray(axis, dtype=np.float64)
    a = a / np.linalg.norm(a, axis=-1, keepdims=True)
    return exp(a * np.asarray(angle_rad)[..., None])


_AXES = {"X": np.array([1.0, 0, 0]), "Y": np.array([0, 1.0, 0]), "Z": np.array([0, 0, 1.0])}


def from_euler(order: str, angles_rad: ArrayLike) -> Floats:
    """Intrinsic rotations, left to right on column vectors: order "ZXY" is R = Rz · Rx · Ry. angles: (..., n)."""
    angles = np.asarray(angles_rad, dtype=np.float64)
    q: Floats = np.broadcast_to(IDENTITY, (*angles.shape[:-1], 4))
    for i, axis in enumerate(order.upper()):
        q = multiply(q, exp(_AXES[axis] * angles[..., i, None]))
    return q


def to_euler(order: str, q: Floats) -> Floats:
    """Inverse of from_euler for three different axes ("ZXY", "XYZ", …) -> (..., 3) radians."""
    i, j, k = ("XYZ".index(c) for c in order.upper())
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    m = to_matrix(q)
    middle = np.arcsin(np.clip(sign * m[..., i, k], -1.0, 1.0))
    first = np.arctan2(-sign * m[..., j, k], m[..., k, k])
    last = np.arctan2(-sign * m[..., i, j], m[..., i, i])
    locked = np.abs(m[..., i, k]) > 1.0 - 1e-9
    first = np.where(locked, np.arctan2(sign * m[..., k, j], m[..., j, j]), first)
    last = np.where(locked, 0.0, last)
    return np.stack([first, middle, last], axis=-1)


def to_matrix(q: Floats) -> Floats:
    """(..., 4) -> (..., 3, 3)."""
    x, y, z, w = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    m = np.empty((*q.shape[:-1], 3, 3), dtype=q.dtype)
    m[..., 0, 0] = 1 - 2 * (y * y + z * z)
    m[..., 0, 1] = 2 * (x * y - w * z)
    m[..., 0, 2] = 2 * (x * z + w * y)
    m[..., 1, 0] = 2 * (x * y + w * z)
    m[..., 1, 1] = 1 - 2 * (x * x + z * z)
    m[..., 1, 2] = 2 * (y * z - w * x)
    m[..., 2, 0] = 2 * (x * z - w * y)
    m[..., 2, 1] = 2 * (y * z + w * x)
    m[..., 2, 2] = 1 - 2 * (x * x + y * y)
    return m


def from_matrix(m: ArrayLike) -> Floats:
    """(..., 3, 3) rotation matrices -> (..., 4), w >= 0."""
    r = np.asarray(m, dtype=np.float64)
    xx, yy, zz = r[..., 0, 0], r[..., 1, 1], r[..., 2, 2]
    candidates = np.stack(
        [
            np.stack(
                [
                    1 + xx - yy - zz,
                    r[..., 1, 0] + r[..., 0, 1],
                    r[..., 0, 2] + r[..., 2, 0],
                    r[..., 2, 1] - r[..., 1, 2],
                ],
                -1,
            ),
            np.stack(
                [
                    r[..., 1, 0] + r[..., 0, 1],
                    1 - xx + yy - zz,
                    r[..., 2, 1] + r[..., 1, 2],
                    r[..., 0, 2] - r[..., 2, 0],
                ],
                -1,
            ),
            np.stack(
                [
                    r[..., 0, 2] + r[..., 2, 0],
                    r[..., 2, 1] + r[..., 1, 2],
                    1 - xx - yy + zz,
                    r[..., 1, 0] - r[..., 0, 1],
                ],
                -1,
            ),
            np.stack(
                [
                    r[..., 2, 1] - r[..., 1, 2],
                    r[..., 0, 2] - r[..., 2, 0],
                    r[..., 1, 0] - r[..., 0, 1],
                    1 + xx + yy + zz,
                ],
                -1,
            ),
        ],
        axis=-2,
    )
    best = np.argmax(np.stack([xx, yy, zz, xx + yy + zz], -1), axis=-1)
    q: Floats = np.take_along_axis(candidates, best[..., None, None], axis=-2)[..., 0, :]
    q = normalize(q)
    return np.asarray(np.where(q[..., 3:] < 0, -q, q))


def between(a: ArrayLike, b: ArrayLike) -> Floats:
    """The smallest rotation that takes direction a to direction b, both (..., 3)."""
    u = np.asarray(a, dtype=np.float64)
    v = np.asarray(b, dtype=np.float64)
    u = u / np.maximum(np.linalg.norm(u, axis=-1, keepdims=True), 1e-12)
    v = v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-12)
    w = 1.0 + (u * v).sum(-1, keepdims=True)
    # Opposite directions: any axis across u will do.
    other = np.where(np.abs(u[..., :1]) < 0.9, np.array([1.0, 0, 0]), np.array([0, 1.0, 0]))
    q = np.where(
        w > 1e-6, np.concatenate([np.cross(u, v), w], -1), np.concatenate([np.cross(u, other), np.zeros_like(w)], -1)
    )
    return normalize(q)
