"""The framebuffers of one picture size: the baked still picture, the moving one, and what is shown."""

from __future__ import annotations

import moderngl

from game.render.device import Device, Owner

__all__ = ["BakeTargets", "Box", "FrameTargets", "Picture", "copy_box", "union"]

Box = tuple[int, int, int, int]  # x, y (from below), width, height in pixels
BAKE_SAMPLES = 4


def union(a: Box, b: Box) -> Box:
    """The smallest box around both."""
    x, y = min(a[0], b[0]), min(a[1], b[1])
    return (x, y, max(a[0] + a[2], b[0] + b[2]) - x, max(a[1] + a[3], b[1] + b[3]) - y)


def copy_box(context: moderngl.Context, target: moderngl.Framebuffer, source: moderngl.Framebuffer, box: Box) -> None:
    """Copy colour and depth (as far as both have it) inside the box; resolves samples. ``target`` stays bound."""
    target.scissor = box
    target.use()
    context.copy_framebuffer(target, source)
    target.scissor = None  # type: ignore[assignment]  # moderngl takes None; its stub forgets
    target.use()


def _target(owner: Owner, device: Device, size: tuple[int, int], samples: int) -> moderngl.Framebuffer:
    """A framebuffer with colour and depth."""
    context = device.context
    colour = owner.own(context.texture(size, 4, samples=samples))
    depth = owner.own(context.depth_texture(size, samples=samples))
    return owner.own(context.framebuffer([colour], depth))


class Picture(Owner):
    """A colour texture and the framebuffer to draw into it."""

    def __init__(self, device: Device, size: tuple[int, int]) -> None:
        super().__init__()
        self.texture = self.own(device.context.texture(size, 4))
        self.texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self.texture.repeat_x = self.texture.repeat_y = False
        self.target = self.own(device.context.framebuffer([self.texture]))


class BakeTargets(Owner):
    """What baking needs and leaves behind; ``still`` has as many samples as the moving picture.

    raw: ungraded scene with samples of its own; raw_draft: with as few as may be; still: graded colour and depth;
    dark: graded, in full shadow.
    """

    def __init__(self, device: Device, size: tuple[int, int], samples: int) -> None:
        super().__init__()
        self._context = device.context
        # Samples can only be copied to a picture of as many samples, or of none.
        self.raw = _target(self, device, size, min(samples or BAKE_SAMPLES, device.max_samples))
        # Where the moving picture has no samples, a draft needs none either.
        self.raw_draft = self.raw if samples else _target(self, device, size, 0)
        self.still = _target(self, device, size, samples)
        self.plain = self.own(Picture(device, size))
        self.dark = self.own(Picture(device, size))
        small = (max(1, size[0] // 4), max(1, size[1] // 4))
        self.blur = (self.own(Picture(device, small)), self.own(Picture(device, small)))

    def resolve(self, raw: moderngl.Framebuffer) -> None:
        """Copy the raw colour to ``plain`` and the raw depth to ``still``."""
        self._context.copy_framebuffer(self.still, raw)
        self.resolve_colour(raw)

    def resolve_colour(self, raw: moderngl.Framebuffer) -> None:
        self._context.copy_framebuffer(self.plain.target, raw)


class FrameTargets(Owner):
    """Everything that depends on the picture's size and samples.

    size: of the scene; full: of the picture with the interface, where the scene is drawn smaller.
    work: the still picture with the character drawn into it; resolved: the same without samples; output: with the
    interface. Without samples, work takes the place of the others.
    """

    def __init__(self, device: Device, full: tuple[int, int], samples: int, scale: float = 1.0) -> None:
        super().__init__()
        size = (max(1, round(full[0] * scale)), max(1, round(full[1] * scale)))
        self.size, self.full, self.samples = size, full, samples
        self.bake = self.own(BakeTargets(device, size, samples))
        self.work = _target(self, device, size, samples)
        self.resolved = self.own(Picture(device, size)).target if samples else self.work
        self.output = self.own(Picture(device, full)).target if samples or size != full else self.work
