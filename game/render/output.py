"""The end of a frame: the finished scene, without samples and at full size, where the interface can be drawn on it."""

from __future__ import annotations

import moderngl
import numpy as np

from game.render.device import Device, Owner, layout
from game.render.targets import Box, FrameTargets, copy_box

__all__ = ["Output"]


class Output(Owner):
    """Brings the scene to where it is shown."""

    def __init__(self, device: Device) -> None:
        super().__init__()
        self._context = device.context
        program = self.own(device.program("screen.vert.glsl", "picture.frag.glsl"))
        corner = self.own(device.context.buffer(np.array([-1, -1, 3, -1, -1, 3], dtype=np.float32)))
        self._enlarged = self.own(device.vertex_array(program, [layout(program, corner, corner="2f")]))

    def finish(
        self, targets: FrameTargets, changed: Box, window: moderngl.Framebuffer | None, *, over: bool
    ) -> moderngl.Framebuffer:
        """The picture that is shown; ``over``: something will be drawn on it. ``changed``: what differs from the last
        frame, of a picture with samples."""
        context = self._context
        picture = targets.work
        if targets.samples:
            copy_box(context, targets.resolved, targets.work, changed)
            picture = targets.resolved
        smaller = targets.size != targets.full
        # What is drawn on top must not stay in a picture that the next frame only mends.
        if window is None and not smaller and not (targets.samples and over):
            return picture
        output = targets.output if window is None else window
        if window is not None:
            window.viewport = (0, 0, *targets.full)
        output.use()
        if smaller:
            context.enable_only(moderngl.NOTHING)
            texture = picture.color_attachments[0]
            assert isinstance(texture, moderngl.Texture)
            texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
            texture.use(0)
            self._enlarged.render()
        else:
            context.copy_framebuffer(output, picture)
        return output
