"""The least a toon frame of this size can be, as the floor that benchmarks measure the real frame against."""

from __future__ import annotations

import moderngl
import numpy as np

from game.render.camera import HERO
from game.render.device import Device, Owner, layout, set_uniforms
from game.render.lighting import TABLE_LIGHT, FrameBlock, Lights

__all__ = ["BareScene"]

_RINGS, _SIDES, _JOINTS, _SHADOW_SIZE = 100, 100, 60, 1024


class BareScene(Owner):
    """One skinned tube: 60 joints, 20 000 triangles, a 1024² shadow map, three tones; nothing else.

    ``samples`` 0 or 4. ``draw`` draws one frame with the joints bent by ``time_s`` and waits until it is finished.
    """

    def __init__(self, device: Device, samples: int = 0) -> None:
        super().__init__()
        self._device, self._context = device, device.context
        context = device.context
        rings, sides = np.meshgrid(np.arange(_RINGS + 1), np.arange(_SIDES), indexing="ij")
        angle = sides / _SIDES * 2.0 * np.pi
        normal = np.stack([np.cos(angle), np.zeros_like(angle), np.sin(angle)], axis=-1).reshape(-1, 3)
        height = rings / _RINGS * 0.9 + 0.55
        position = normal * 0.22
        position[:, 1] = height.ravel()
        along = rings.ravel() / _RINGS * (_JOINTS - 1)
        first = np.minimum(along.astype(int), _JOINTS - 2)
        joint = np.stack([first, first + 1, first, first], axis=1).astype(np.uint8)
        share = (along - first)[:, None]
        weight = np.rint(np.hstack([1.0 - share, share, 0 * share, 0 * share]) * 255).astype(np.uint8)
        a = (np.arange(_RINGS)[:, None] * _SIDES + np.arange(_SIDES)).ravel()
        b = (np.arange(_RINGS)[:, None] * _SIDES + (np.arange(_SIDES) + 1) % _SIDES).ravel()
        triangle = np.concatenate([np.stack([a, a + _SIDES, b]), np.stack([b, a + _SIDES, b + _SIDES])], axis=1).T
        place = self.own(context.buffer(np.hstack([position, normal]).astype(np.float32)))
        bones = self.own(context.buffer(np.hstack([joint, weight])))
        index = self.own(context.buffer(np.ascontiguousarray(triangle, dtype=np.int32)))
        self._arrays = []
        for depth_only, fragment in ((1, "empty.frag.glsl"), (0, "bare.frag.glsl")):
            program = self.own(device.program("bare.vert.glsl", fragment, defines={"DEPTH_ONLY": depth_only}))
            set_uniforms(program, shadow_map=1)
            entries = [
                layout(program, place, position="3f", normal="3f"),
                layout(program, bones, joint="4u1", weight="4f1"),
            ]
            self._arrays.append(self.own(device.vertex_array(program, entries, index)))
        self._shadow = self.own(context.depth_texture((_SHADOW_SIZE, _SHADOW_SIZE)))
        self._shadow.compare_func = "<="
        self._shadow_target = self.own(context.framebuffer([], self._shadow))
        size = device.size
        colour = self.own(context.texture(size, 4, samples=samples))
        depth = self.own(context.depth_texture(size, samples=samples))
        self._target = self.own(context.framebuffer([colour], depth))
        self._resolved: moderngl.Framebuffer | None = None
        if samples:
            self._resolved = self.own(context.framebuffer([self.own(context.texture(size, 4))]))
        self._frame = self.own(FrameBlock(device))
        self._joints = self.own(context.buffer(reserve=64 * 48, dynamic=True))

    def release(self) -> None:
        self._device.nowhere.use()
        super().release()

    def draw(self, time_s: float = 0.0) -> None:
        """One frame."""
        context = self._context
        rows = np.tile(np.eye(3, 4, dtype=np.float32), (_JOINTS, 1, 1))
        rows[:, 0, 3] = 0.03 * np.sin(time_s * 2.0 + np.arange(_JOINTS) * 0.1)
        self._joints.write(rows)
        self._joints.bind_to_uniform_block(1)
        self._frame.write(HERO, Lights.market(), TABLE_LIGHT, self._device.size, 1.7)
        context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        context.depth_func = "<"
        for target, array in zip((self._shadow_target, self._target), self._arrays, strict=True):
            target.use()
            target.clear(0.8, 0.7, 0.6, 1.0, depth=1.0)
            self._shadow.use(1)
            array.render()
        if self._resolved is not None:
            context.copy_framebuffer(self._resolved, self._target)
        context.finish()
