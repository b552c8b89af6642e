"""Bulbs, flags and lanterns in motion, drawn every frame over the still picture."""

from __future__ import annotations

from collections.abc import Sequence

import moderngl
import numpy as np
from numpy.typing import NDArray

from game.render.character_drawing import CharacterDrawing
from game.render.device import PREMULTIPLIED, Device, Owner, layout, set_uniforms
from game.render.levels import Level
from game.render.model import CharacterModel
from game.render.moving import MovingMesh

__all__ = ["MovingDrawing"]

_REACH = 5.5  # a halo is so many times larger than its lamp


class MovingDrawing(Owner):
    """The moving things of one stall at one quality level; the Frame block must be bound when they are drawn."""

    def __init__(self, device: Device, meshes: Sequence[MovingMesh], level: Level) -> None:
        super().__init__()
        self._context = device.context
        self._things = [
            (moving, self.own(CharacterDrawing(device, _model(moving), level, lamps=True))) for moving in meshes
        ]
        self._program = self.own(device.program("glow.vert.glsl", "glow.frag.glsl"))
        set_uniforms(self._program, reach=_REACH)
        lamps = np.concatenate([moving.lamp[moving.lamp[:, 3] > 0] for moving in meshes]).astype(np.float32)
        self._lamps = len(lamps)
        if self._lamps:
            corner = self.own(device.context.buffer(np.array([-1, -1, 1, -1, -1, 1, 1, 1], dtype=np.float32)))
            entries = [
                layout(self._program, corner, corner="2f"),
                layout(self._program, self.own(device.context.buffer(lamps)), lamp="4f/i"),
            ]
            self._halos = self.own(device.vertex_array(self._program, entries))

    def pose(self, time_s: float, world_to_clip: NDArray[np.float64], size: tuple[int, int]) -> None:
        """Skin all of them for a moment."""
        for moving, drawing in self._things:
            drawing.pose(moving.matrices(time_s), world_to_clip, size)

    def draw(self, target: moderngl.Framebuffer) -> None:
        """Draw all of them into ``target``, against its depth."""
        target.use()
        for _, drawing in self._things:
            drawing.draw()

    def draw_halos(self, target: moderngl.Framebuffer, lamps: float) -> None:
        """Add the halos where the lamps are on."""
        if not self._lamps or lamps <= 0.0:
            return
        target.use()
        self._context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        self._context.blend_func = PREMULTIPLIED
        target.depth_mask = False
        self._halos.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=self._lamps)
        target.depth_mask = True


def _model(moving: MovingMesh) -> CharacterModel:
    return CharacterModel("moving", {len(moving.mesh.triangle): moving.mesh}, None, len(moving.pivot))
