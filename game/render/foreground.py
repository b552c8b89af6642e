"""What stands between the eye and the stall, far out of focus, at the picture's lower corners: each stall's own.

It gives the picture a near layer: when the camera moves it passes by faster than everything else. Part of the baked
picture, so that it costs nothing while the camera rests.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from game.render.camera import HERO, Camera
from game.render.device import PREMULTIPLIED, Device, Owner, layout, set_uniforms

__all__ = ["CORNERS", "Foreground"]

Floats = NDArray[np.floating[Any]]
Colour = tuple[float, float, float]
Row = tuple[float, ...]

_LEAVES = ((0.20, 0.38, 0.24), (0.30, 0.48, 0.26), (0.42, 0.56, 0.28))
_FLOWERS = ((0.95, 0.55, 0.55), (0.98, 0.80, 0.46), (0.97, 0.90, 0.82), (0.86, 0.42, 0.46))
_NEEDLES = ((0.13, 0.27, 0.24), (0.19, 0.36, 0.27), (0.28, 0.45, 0.30))
_BARK = (0.27, 0.17, 0.17)
_BLOSSOMS = ((0.97, 0.80, 0.82), (0.99, 0.92, 0.90), (0.90, 0.52, 0.60))
_BALLOONS = ((0.24, 0.66, 0.62), (0.95, 0.72, 0.26), (0.91, 0.34, 0.28))
_WHEELS = (((0.93, 0.36, 0.30), (0.98, 0.93, 0.82)), ((0.98, 0.77, 0.28), (0.26, 0.62, 0.62)))
_PARALLAX = 0.07  # of what a thing so near would really move: corners stay corners in every shot
_NEAR_M = 0.75
_ZOOM = 0.45  # of the camera's zoom, as a power: in a close-up the corners do not grow over the goods


def _bloom(x: float, y: float, size: float, turn: float, petal: Colour, heart: Colour, soft: float) -> list[Row]:
    """Five petals around a heart; size: half a petal's length."""
    rows: list[Row] = []
    for k in range(5):
        a = k * 2.0 * np.pi / 5 + turn
        at = (x + 0.9 * size * np.cos(a) * 9 / 16 * 2, y + 0.9 * size * np.sin(a) * 2)
        rows.append((*at, size, 0.75 * size, a, soft, *petal, 0.92))
    rows.append((x, y, 0.45 * size, 0.45 * size, 0.0, soft + 0.1, *heart, 0.9))
    return rows


def _flowers(side: float) -> list[Row]:
    rng = np.random.default_rng(5 if side < 0 else 8)
    rows: list[Row] = []
    for k in range(16):
        along = rng.random()
        x, y = side * (1.04 - 0.16 * along * rng.random()), -1.08 + 0.30 * (1.0 - along) * rng.random()
        angle = np.pi / 2 + side * (0.9 * rng.random() - 0.1)
        rows.append((x, y, 0.10 + 0.05 * rng.random(), 0.026 + 0.014 * rng.random(), angle, 0.55, *_LEAVES[k % 3], 0.9))
    for k in range(5):
        x, y = side * (1.03 - 0.13 * rng.random()), -1.0 + 0.27 * rng.random()
        rows += _bloom(x, y, 0.034 + 0.016 * rng.random(), float(k), _FLOWERS[k % 4], (0.96, 0.74, 0.30), 0.5)
    return rows


def _limb(x: float, y: float, angle: float, length: float, thick: float) -> Row:
    """A piece of branch that begins at x, y; length, thickness of the picture's height."""
    reach = 0.5 * length
    return (
        x + 2 * reach * np.cos(angle) * 9 / 16,
        y + 2 * reach * np.sin(angle),
        reach,
        thick,
        angle,
        0.4,
        *_BARK,
        0.95,
    )


def _pine(side: float) -> list[Row]:
    """Three fans of needles on a branch that comes in from below."""
    rng = np.random.default_rng(13)
    rows = [_limb(side * 1.06, -1.04, np.pi / 2 + side * 0.75, 0.15, 0.012)]
    for x, y, size in ((0.985, -0.90, 1.0), (1.02, -0.72, 0.85), (0.895, -1.01, 0.9)):
        for k in range(22):
            a = np.pi / 2 + side * 0.25 + 1.25 * (2.0 * (k + rng.random()) / 22 - 1.0)
            reach = size * (0.030 + 0.008 * rng.random())
            at = (side * x + 2 * reach * np.cos(a) * 9 / 16, y + 2 * reach * np.sin(a))
            rows.append((*at, reach, 0.0052, a, 0.75, *_NEEDLES[k % 3], 0.9))
    return rows


def _plum(side: float) -> list[Row]:
    """A knotty branch in blossom."""
    rng = np.random.default_rng(4)
    up = np.pi / 2 + side * 0.55
    rows = [
        _limb(side * 1.05, -1.08, up, 0.17, 0.0125),
        _limb(side * 0.985, -0.83, up - side * 0.9, 0.12, 0.0075),
        _limb(side * 1.01, -0.95, up + side * 0.75, 0.11, 0.0080),
    ]
    for k, (x, y) in enumerate(
        ((0.985, -0.70), (0.93, -0.80), (1.01, -0.84), (0.885, -0.93), (0.965, -0.96), (0.93, -1.03))
    ):
        size = 0.021 + 0.007 * rng.random()
        rows += _bloom(side * x, y, size, 1.7 * k, _BLOSSOMS[k % 3], (0.80, 0.33, 0.36), 0.5)
    rows += [(side * x, y, 0.012, 0.012, 0.0, 0.6, *_BLOSSOMS[2], 0.9) for x, y in ((1.0, -0.62), (0.90, -0.72))]
    return rows


def _balloons(side: float) -> list[Row]:
    rows: list[Row] = []
    for (x, y, size), colour in zip(
        ((1.03, -0.66, 0.060), (0.94, -0.93, 0.056), (1.04, -0.98, 0.066)), _BALLOONS, strict=True
    ):
        dark = (0.72 * colour[0], 0.66 * colour[1], 0.76 * colour[2])
        rows.append((side * x, y - 2.0 * size, 0.012, 0.008, 0.0, 0.6, *dark, 0.95))
        rows.append((side * x, y, 1.06 * size, size, np.pi / 2, 0.28, *dark, 0.95))
        rows.append((side * x - 0.10 * size, y + 0.22 * size, 0.90 * size, 0.85 * size, np.pi / 2, 0.35, *colour, 0.95))
        rows.append((side * x - 0.5 * size, y + 0.8 * size, 0.24 * size, 0.15 * size, 0.9, 0.7, 1.0, 0.97, 0.92, 0.75))
    return rows


def _pinwheels(side: float) -> list[Row]:
    rows: list[Row] = []
    for (x, y, size), pair in zip(((0.965, -0.70, 0.046), (0.93, -1.0, 0.040)), _WHEELS, strict=True):
        rows.append((side * x, y - 0.30, 0.16, 0.006, np.pi / 2, 0.5, 0.86, 0.76, 0.60, 0.95))
        for k in range(8):
            a = k * np.pi / 4 + 0.3
            at = (side * x + 1.05 * size * np.cos(a) * 9 / 16 * 2, y + 1.05 * size * np.sin(a) * 2)
            rows.append((*at, size, 0.46 * size, a + 0.5, 0.35, *pair[k % 2], 0.95))
        rows.append((side * x, y, 0.26 * size, 0.26 * size, 0.0, 0.5, 0.86, 0.27, 0.24, 0.95))
    return rows


CORNERS: Mapping[str, tuple[Callable[[float], list[Row]], Callable[[float], list[Row]]]] = MappingProxyType(
    {"flowers": (_flowers, _flowers), "garden": (_pine, _plum), "fair": (_balloons, _pinwheels)}
)
"""What stands in the left and in the right lower corner (side −1 left, 1 right) -> rows of soft ellipses: x, y (clip
coordinates of a 16:9 picture), half length, half width (of the picture's height), angle, softness 0..1, red, green,
blue, cover."""


class Foreground(Owner):
    """The near layer; the Frame block must be bound when it is drawn. near: a name of CORNERS, or "none"."""

    def __init__(self, device: Device, near: str) -> None:
        super().__init__()
        self._context = device.context
        self._program = self.own(device.program("foreground.vert.glsl", "foreground.frag.glsl"))
        left, right = CORNERS.get(near, (None, None))
        drawn = [*(left(-1.0) if left else ()), *(right(1.0) if right else ())]
        rows = np.array(drawn, dtype=np.float32).reshape(-1, 10)
        self._count = len(rows)
        corner = self.own(device.context.buffer(np.array([-1, -1, 1, -1, -1, 1, 1, 1], dtype=np.float32)))
        place = self.own(device.context.buffer(rows if len(rows) else np.zeros((1, 10), np.float32)))
        entries = [
            layout(self._program, corner, corner="2f"),
            layout(self._program, place, box="4f/i", form="2f/i", paint="4f/i"),
        ]
        self._array = self.own(device.vertex_array(self._program, entries))

    def draw(self, camera: Camera) -> None:
        """Over the bound framebuffer."""
        if not self._count:
            return
        away = np.subtract(camera.eye, HERO.eye)
        zoom = HERO.tan_half_height(16 / 9) / camera.tan_half_height(16 / 9)
        shift = -_PARALLAX * away[:2] / (_NEAR_M * camera.tan_half_height(16 / 9)) * (9 / 16, 1.0)
        nearer = 1.0 + 0.5 * max(-float(away[2]), 0.0)
        self._context.enable_only(moderngl.BLEND)
        self._context.blend_func = PREMULTIPLIED
        set_uniforms(self._program, shift=(float(shift[0]), float(shift[1])), zoom=(zoom * nearer) ** _ZOOM)
        self._array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=self._count)
