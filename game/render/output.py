"""The person's layer laid over the scene, and the end of a frame: the scene at full size, for the interface."""

from __future__ import annotations

import moderngl
import numpy as np

from game.render.device import PREMULTIPLIED, Device, Owner, layout, set_uniforms
from game.render.targets import Box, FrameTargets

__all__ = ["Output"]


class Output(Owner):
    """Brings what was drawn to where it is shown."""

    def __init__(self, device: Device) -> None:
        super().__init__()
        self._device, self._context = device, device.context
        self._corner = self.own(device.context.buffer(np.array([-1, -1, 3, -1, -1, 3], dtype=np.float32)))
        self._enlarged = self._fullscreen("picture.frag.glsl")
        self._laid: dict[int, moderngl.VertexArray] = {}

    def _fullscreen(self, fragment: str, **defines: int) -> moderngl.VertexArray:
        program = self.own(self._device.program("screen.vert.glsl", fragment, defines=defines))
        set_uniforms(program, layer=0)
        return self.own(self._device.vertex_array(program, [layout(program, self._corner, corner="2f")]))

    def lay(self, targets: FrameTargets, box: Box) -> None:
        """Mean of the samples of the person's layer over the scene, inside the box; ``work`` stays bound."""
        assert targets.person is not None, "there is a layer only with samples"
        if targets.samples not in self._laid:
            self._laid[targets.samples] = self._fullscreen("layer.frag.glsl", SAMPLES=targets.samples)
        texture = targets.person.color_attachments[0]
        assert isinstance(texture, moderngl.Texture)
        targets.work.scissor = box
        targets.work.use()
        self._context.enable_only(moderngl.BLEND)
        self._context.blend_func = PREMULTIPLIED
        texture.use(0)
        self._laid[targets.samples].render()
        targets.work.scissor = None  # type: ignore[assignment]  # moderngl takes None; its stub forgets
        targets.work.use()

    def finish(self, targets: FrameTargets, window: moderngl.Framebuffer | None) -> moderngl.Framebuffer:
        """The picture that is shown, to draw the interface on."""
        smaller = targets.size != targets.full
        if window is None and not smaller:
            return targets.work
        output = targets.output if window is None else window
        if window is not None:
            window.viewport = (0, 0, *targets.full)
        output.use()
        if smaller:
            self._context.enable_only(moderngl.NOTHING)
            texture = targets.work.color_attachments[0]
            assert isinstance(texture, moderngl.Texture)
            texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
            texture.use(0)
            self._enlarged.render()
        else:
            self._context.copy_framebuffer(output, targets.work)
        return output
