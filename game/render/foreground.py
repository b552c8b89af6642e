"""What stands between the eye and the stall, far out of focus: flowers and leaves at the picture's lower corners.

It gives the picture a near layer: when the camera moves it passes by faster than everything else. Part of the baked
picture, so that it costs nothing while the camera rests.
"""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from game.render.camera import HERO, Camera
from game.render.device import PREMULTIPLIED, Device, Owner, layout, set_uniforms

__all__ = ["Foreground", "flower_corner"]

Floats = NDArray[np.floating[Any]]

_LEAVES = ((0.20, 0.38, 0.24), (0.30, 0.48, 0.26), (0.42, 0.56, 0.28))
_FLOWERS = ((0.95, 0.55, 0.55), (0.98, 0.80, 0.46), (0.97, 0.90, 0.82), (0.86, 0.42, 0.46))
_PARALLAX = 0.07  # of what a thing so near would really move: corners stay corners in every shot
_NEAR_M = 0.75


def flower_corner(side: float, seed: int) -> Floats:
    """(n, 10) soft ellipses of one lower corner (side −1 left, 1 right): x, y (clip coordinates of a 16:9 picture),
    half length, half width (of the picture's height), angle, softness 0..1, red, green, blue, cover."""
    rng = np.random.default_rng(seed)
    rows = []
    for k in range(16):
        along = rng.random()
        x, y = side * (1.04 - 0.16 * along * rng.random()), -1.08 + 0.30 * (1.0 - along) * rng.random()
        angle = np.pi / 2 + side * (0.9 * rng.random() - 0.1)
        rows.append((x, y, 0.10 + 0.05 * rng.random(), 0.026 + 0.014 * rng.random(), angle, 0.55, *_LEAVES[k % 3], 0.9))
    for k in range(5):
        x, y = side * (1.03 - 0.13 * rng.random()), -1.0 + 0.27 * rng.random()
        size, colour = 0.034 + 0.016 * rng.random(), _FLOWERS[k % 4]
        for petal in range(5):
            a = petal * 2.0 * np.pi / 5 + k
            at = (x + 0.9 * size * np.cos(a) * 9 / 16 * 2, y + 0.9 * size * np.sin(a) * 2)
            rows.append((*at, size, 0.75 * size, a, 0.5, *colour, 0.92))
        rows.append((x, y, 0.45 * size, 0.45 * size, 0.0, 0.6, 0.96, 0.74, 0.30, 0.9))
    return np.array(rows)


class Foreground(Owner):
    """The near layer; the Frame block must be bound when it is drawn."""

    def __init__(self, device: Device) -> None:
        super().__init__()
        self._context = device.context
        self._program = self.own(device.program("foreground.vert.glsl", "foreground.frag.glsl"))
        rows = np.vstack([flower_corner(-1.0, 5), flower_corner(1.0, 8)]).astype(np.float32)
        corner = self.own(device.context.buffer(np.array([-1, -1, 1, -1, -1, 1, 1, 1], dtype=np.float32)))
        entries = [
            layout(self._program, corner, corner="2f"),
            layout(self._program, self.own(device.context.buffer(rows)), box="4f/i", form="2f/i", paint="4f/i"),
        ]
        self._array = self.own(device.vertex_array(self._program, entries))
        self._count = len(rows)

    def draw(self, camera: Camera) -> None:
        """Over the bound framebuffer."""
        away = np.subtract(camera.eye, HERO.eye)
        zoom = HERO.tan_half_height(16 / 9) / camera.tan_half_height(16 / 9)
        shift = -_PARALLAX * away[:2] / (_NEAR_M * camera.tan_half_height(16 / 9)) * (9 / 16, 1.0)
        nearer = 1.0 + 0.5 * max(-float(away[2]), 0.0)
        self._context.enable_only(moderngl.BLEND)
        self._context.blend_func = PREMULTIPLIED
        set_uniforms(self._program, shift=(float(shift[0]), float(shift[1])), zoom=zoom * nearer)
        self._array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=self._count)
