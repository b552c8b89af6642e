"""Specks of dust drifting in the sun before the stall: the little life a picture needs while nobody moves."""

from __future__ import annotations

import moderngl
import numpy as np

from game.render.device import PREMULTIPLIED, Device, Owner, layout, set_uniforms

__all__ = ["Motes"]

_COUNT, _SEED = 22, 7


class Motes(Owner):
    """A handful of soft specks; where they are follows from the time alone, so replays show the same."""

    def __init__(self, device: Device) -> None:
        super().__init__()
        self._context = context = device.context
        self._program = self.own(device.program("motes.vert.glsl", "motes.frag.glsl"))
        seeds = np.random.default_rng(_SEED).random((_COUNT, 4)).astype(np.float32)
        corner = self.own(context.buffer(np.array([-1, -1, 1, -1, -1, 1, 1, 1], dtype=np.float32)))
        seed = self.own(context.buffer(seeds))
        entries = [layout(self._program, corner, corner="2f"), layout(self._program, seed, seed="4f/i")]
        self._array = self.own(device.vertex_array(self._program, entries))

    def draw(self, time_s: float, aspect: float) -> None:
        """Add the specks to the bound framebuffer."""
        self._context.enable_only(moderngl.BLEND)
        self._context.blend_func = PREMULTIPLIED
        set_uniforms(self._program, time_s=time_s, aspect=aspect)
        self._array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=_COUNT)
