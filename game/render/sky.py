"""Clouds that drift across the painted sky, and only there: the painting says where its sky is blue."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from game.render.daylight import Daylight
from game.render.device import PREMULTIPLIED, Device, Owner, layout, set_uniforms

__all__ = ["Sky", "cloud_picture", "sky_cells", "sky_share"]

Floats = NDArray[np.floating[Any]]

LOWEST = 0.74  # of the painting's height: no cloud drifts lower
_CELL = 6  # texels of the mask: side of a rectangle that is drawn if there is sky in it
_STEP = 8  # the mask is so much coarser than the painting, which is blurred anyway
_SIZE = (384, 48)
_SEED, _CLOUDS = 21, 11


def sky_share(backdrop: NDArray[np.uint8]) -> Floats:
    """(h/8, w/8) in 0..1: how much blue sky a painting (h, w, 3) shows, first row at the top."""
    r, g, b = (backdrop[::_STEP, ::_STEP, i].astype(np.float64) / 255.0 for i in range(3))
    blue = np.clip((np.minimum(g - 0.6 * r - 0.4 * b, b - g) + 0.045) / 0.05, 0.0, 1.0)
    blue *= np.clip((b - r - 0.06) / 0.10, 0.0, 1.0)
    # What is blue far below is no sky: flags, windows, awnings.
    up = 1.0 - np.arange(len(blue)) / len(blue)
    return np.asarray(blue * np.clip((up - LOWEST) / 0.06, 0.0, 1.0)[:, None])


def sky_cells(share: Floats) -> NDArray[np.float64]:
    """(n, 4) left, low, right, high of rectangles that hold all sky of a mask (h, w), first row at the bottom, in
    parts of its width and height; mirrored at both sides, as the painting is where a camera turns beyond it.

    They share edges and never overlap.
    """
    height, width = share.shape
    # The filter reaches into the next texel.
    blue: NDArray[np.bool_] = sliding_window_view(np.pad(share > 0.0, 1), (3, 3)).max(axis=(2, 3))
    cells: list[tuple[float, float, float, float]] = []
    for low in range(0, height, _CELL):
        rows = blue[low : low + _CELL]
        any_blue = [bool(rows[:, x : x + _CELL].any()) for x in range(0, width, _CELL)]
        first: int | None = None
        for number, is_blue in enumerate([*any_blue, False]):
            if is_blue and first is None:
                first = number
            elif not is_blue and first is not None:
                right = min(number * _CELL, width)
                cells.append((first * _CELL / width, low / height, right / width, min(low + _CELL, height) / height))
                first = None
    own = np.array(cells, dtype=np.float64).reshape(-1, 4)
    left, right = own[:, [2, 1, 0, 3]] * (-1, 1, -1, 1), own[:, [2, 1, 0, 3]] * (-1, 1, -1, 1) + (2, 0, 2, 0)
    return np.concatenate([left, own, right])


def cloud_picture() -> Floats:
    """(h, w) cover of a strip of clouds in 0..1 that repeats sideways, first row at the bottom."""
    rng, (width, height) = np.random.default_rng(_SEED), _SIZE
    x, y = np.meshgrid(np.arange(width) / height, np.arange(height) / height)
    around = width / height
    cover = np.zeros((height, width))
    for _ in range(_CLOUDS):
        cx, base, size = rng.random() * around, 0.15 + 0.6 * rng.random(), 0.10 + 0.12 * rng.random()
        for k in range(7):
            px = cx + (k - 3) * 0.55 * size + 0.1 * size * rng.standard_normal()
            radius = size * (1.0 - 0.11 * abs(k - 3)) * (0.75 + 0.5 * rng.random())
            dx = (x - px + 0.5 * around) % around - 0.5 * around
            d = np.hypot(dx * 0.8, y - base) / radius
            puff = np.clip((1.0 - d) * 2.2, 0.0, 1.0) * np.clip((y - base + 0.35 * size) / (0.7 * size), 0.0, 1.0)
            cover = np.maximum(cover, puff * puff * (3.0 - 2.0 * puff))
    return np.asarray(cover * np.clip((1.0 - y) * 5.0, 0.0, 1.0))


class Sky(Owner):
    """The drifting clouds of one backdrop (h, w, 3) uint8, first row at the top."""

    def __init__(self, device: Device, backdrop: NDArray[np.uint8]) -> None:
        super().__init__()
        self._context = device.context
        self._program = self.own(device.program("strip.vert.glsl", "sky.frag.glsl"))
        set_uniforms(self._program, mask=0, clouds=1, lowest=LOWEST)
        share = sky_share(backdrop)[::-1]
        self._mask = self._picture(share)
        self._cells = sky_cells(share)
        self._clouds = self._picture(cloud_picture())
        self._clouds.repeat_x = True
        corner = self.own(device.context.buffer(np.array([-1, -1, 1, -1, -1, 1, 1, 1], dtype=np.float32)))
        self._span = self.own(device.context.buffer(reserve=max(len(self._cells), 1) * 16, dynamic=True))
        self._place: tuple[float, float, float, float] | None = None  # for which the spans are
        self._shown = 0
        entries = [layout(self._program, corner, corner="2f"), layout(self._program, self._span, span="4f/i")]
        self._array = self.own(device.vertex_array(self._program, entries))

    def _picture(self, share: Floats) -> moderngl.Texture:
        height, width = share.shape
        data = np.rint(share * 255.0).astype(np.uint8)
        texture = self.own(self._context.texture((width, height), 1, np.ascontiguousarray(data), alignment=1))
        texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        texture.repeat_x = texture.repeat_y = False
        return texture

    def draw(
        self, target: moderngl.Framebuffer, place: tuple[float, float, float, float], time_s: float, day: Daylight
    ) -> None:
        """Lay the clouds of a moment over the far plane of ``target``; ``place``: as the backdrop is placed."""
        if place != self._place:
            scale, offset = np.tile(place[:2], 2), np.tile(place[2:], 2)
            spans = (self._cells - offset) / scale * 2.0 - 1.0
            spans = spans[(spans[:, :2] < 1.0).all(axis=1) & (spans[:, 2:] > -1.0).all(axis=1)].astype(np.float32)
            self._place, self._shown = place, len(spans)
            if len(spans):
                self._span.write(spans)
        if not self._shown:
            return
        target.use()
        self._context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        self._context.depth_func = "<="
        self._context.blend_func = PREMULTIPLIED
        target.depth_mask = False
        self._mask.use(0)
        self._clouds.use(1)
        tint = tuple(float(v) for v in 0.55 * day.sky + 0.45 * day.horizon)
        set_uniforms(self._program, place=place, drift=time_s * 0.0021, tint=tint)
        self._array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=self._shown)
        target.depth_mask = True
