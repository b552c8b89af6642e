"""ꟻLIP: how different two pictures look to an eye that flips between them, for every pixel.

Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: "ꟻLIP: A Difference Evaluator for Alternating
Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020. Colours are filtered by what the eye resolves at that
distance (section 4.1), compared in a Hunt-adjusted Lab space by the HyAB distance (4.2 to 4.4), and made larger where
an edge or a point appears or goes (5 and 6).
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import correlate1d

__all__ = ["PIXELS_PER_DEGREE", "flip"]

Floats = NDArray[np.float64]

PIXELS_PER_DEGREE = 67.02
"""A 0.7 m wide screen of 3840 pixels seen from 0.7 m: the paper's default."""

# Table 1: contrast sensitivity as sums of Gaussians (a1, b1, a2, b2) for light, red-green, blue-yellow.
_SENSITIVITY = ((1.0, 0.0047, 0.0, 1e-5), (1.0, 0.0053, 0.0, 1e-5), (34.1, 0.04, 13.5, 0.025))
_QC, _QF = 0.7, 0.5
_PC, _PT = 0.4, 0.95
_FEATURE_DEGREES = 0.082

_XYZ = np.array(
    [
        [10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
        [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
        [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382],
    ]
)
"""Linear sRGB to XYZ (D65)."""
_RGB = np.linalg.inv(_XYZ)
_WHITE = _XYZ.sum(axis=1)


def flip(expected: NDArray[np.uint8], got: NDArray[np.uint8], per_degree: float = PIXELS_PER_DEGREE) -> Floats:
    """(h, w) in [0, 1]: 0 looks the same, 1 as different as can be. Two (h, w, 3) sRGB pictures of one size."""
    a, b = _opponent(_linear(expected)), _opponent(_linear(got))
    colour = _colour_difference(_seen(a, per_degree), _seen(b, per_degree))
    feature = _feature_difference(a[..., 0], b[..., 0], per_degree)
    return np.asarray(colour ** (1.0 - feature))


def _linear(pixels: NDArray[np.uint8]) -> Floats:
    table = np.arange(256) / 255.0
    table = np.where(table <= 0.04045, table / 12.92, ((table + 0.055) / 1.055) ** 2.4)
    return np.asarray(table[pixels])


def _opponent(linear: Floats) -> Floats:
    """YyCxCz, a linear relative of Lab: what the eye's filters work on."""
    x, y, z = np.moveaxis(linear @ _XYZ.T / _WHITE, -1, 0)
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], axis=-1)


def _seen(opponent: Floats, per_degree: float) -> Floats:
    """Hunt-adjusted Lab of what is left of the picture at that distance."""
    kernels = _sensitivity_kernels(per_degree)
    sharp = [_filtered(opponent[..., i], kernels[i]) for i in range(3)]
    y = (sharp[0] + 16.0) / 116.0
    xyz = np.stack([sharp[1] / 500.0 + y, y, y - sharp[2] / 200.0], axis=-1) * _WHITE
    return _hunt(_lab(np.clip(xyz @ _RGB.T, 0.0, 1.0)))


def _filtered(channel: Floats, kernel: tuple[tuple[float, Floats], ...]) -> Floats:
    """A sum of separable Gaussians, each with its share."""
    out = np.zeros_like(channel)
    for share, row in kernel:
        out += share * correlate1d(correlate1d(channel, row, axis=0, mode="nearest"), row, axis=1, mode="nearest")
    return out


@cache
def _sensitivity_kernels(per_degree: float) -> tuple[tuple[tuple[float, Floats], ...], ...]:
    """For each channel its Gaussians as (share, row); all shares of a channel sum to one."""
    widest = max(max(b1, b2) for _, b1, _, b2 in _SENSITIVITY)
    radius = math.ceil(3.0 * math.sqrt(widest / (2.0 * math.pi**2)) * per_degree)
    x = np.arange(-radius, radius + 1) / per_degree
    kernels = []
    for a1, b1, a2, b2 in _SENSITIVITY:
        parts = []
        for a, b in ((a1, b1), (a2, b2)):
            if a > 0.0:
                row = np.exp(-(math.pi**2) * x**2 / b)
                parts.append((a * math.sqrt(math.pi / b) * row.sum() ** 2, row / row.sum()))
        whole = sum(weight for weight, _ in parts)
        kernels.append(tuple((weight / whole, row) for weight, row in parts))
    return tuple(kernels)


def _lab(linear: Floats) -> Floats:
    ratio = linear @ _XYZ.T / _WHITE
    limit = 6.0 / 29.0
    f = np.where(ratio > limit**3, np.cbrt(ratio), ratio / (3.0 * limit**2) + 4.0 / 29.0)
    x, y, z = np.moveaxis(f, -1, 0)
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], axis=-1)


def _hunt(lab: Floats) -> Floats:
    """Colours look more colourful in the light."""
    return np.stack([lab[..., 0], 0.01 * lab[..., 0] * lab[..., 1], 0.01 * lab[..., 0] * lab[..., 2]], axis=-1)


def _hyab(a: Floats, b: Floats) -> Floats:
    d = a - b
    return np.asarray(np.abs(d[..., 0]) + np.hypot(d[..., 1], d[..., 2]))


def _colour_difference(a: Floats, b: Floats) -> Floats:
    """In [0, 1]: small differences get most of the range (equation 3 and section 4.4)."""
    green, blue = (_hunt(_lab(np.array([[corner]]))) for corner in ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]))
    most = float(_hyab(green, blue)[0, 0]) ** _QC
    powered = _hyab(a, b) ** _QC
    bend = _PC * most
    return np.asarray(
        np.where(powered < bend, _PT / bend * powered, _PT + (powered - bend) / (most - bend) * (1.0 - _PT))
    )


def _feature_difference(a: Floats, b: Floats, per_degree: float) -> Floats:
    """In [0, 1]: edges and points that are in one picture only (equations 4 to 6)."""
    edge = np.abs(_feature(a, per_degree, 1) - _feature(b, per_degree, 1))
    point = np.abs(_feature(a, per_degree, 2) - _feature(b, per_degree, 2))
    return np.asarray(np.clip(np.maximum(edge, point) / math.sqrt(2.0), 0.0, 1.0) ** _QF)


def _feature(light: Floats, per_degree: float, derivative: int) -> Floats:
    """Strength of edges (first derivative of a Gaussian) or points (second)."""
    level = (light + 16.0) / 116.0
    spread = 0.5 * _FEATURE_DEGREES * per_degree
    x = np.arange(-math.ceil(3.0 * spread), math.ceil(3.0 * spread) + 1, dtype=np.float64)
    smooth = np.exp(-(x**2) / (2.0 * spread**2))
    across = -x * smooth if derivative == 1 else (x**2 / spread**2 - 1.0) * smooth
    # Positive and negative weights sum to one each over the whole two-dimensional kernel.
    across = np.where(across > 0.0, across / across[across > 0.0].sum(), across / -across[across < 0.0].sum())
    smooth = smooth / smooth.sum()
    parts = [
        correlate1d(correlate1d(level, across, axis=axis, mode="nearest"), smooth, axis=1 - axis, mode="nearest")
        for axis in (0, 1)
    ]
    return np.asarray(np.hypot(*parts))
