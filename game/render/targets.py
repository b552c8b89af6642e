"""The framebuffers of one picture size: the baked still picture, the moving one, and what is shown."""

from __future__ import annotations

import moderngl

from game.render.device import Device, Owner

__all__ = ["BakeTargets", "Box", "FrameTargets", "Picture"]

Box = tuple[int, int, int, int]  # x, y (from below), width, height in pixels
BAKE_SAMPLES = 4


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
    """What baking needs and leaves behind.

    raw: ungraded scene with samples; raw_draft: with as few as may be; still: graded colour and depth, no samples;
    dark: graded, in full shadow; behind: no colour, the scene's depth with samples, None where the person has none.
    """

    def __init__(self, device: Device, size: tuple[int, int], samples: int) -> None:
        super().__init__()
        self._context = device.context
        # Samples can only be copied to a picture of as many samples, or of none.
        self.raw = _target(self, device, size, min(samples or BAKE_SAMPLES, device.max_samples))
        # Where the person has no samples, a draft needs none either.
        self.raw_draft = self.raw if samples else _target(self, device, size, 0)
        self.still = _target(self, device, size, 0)
        self.behind = _target(self, device, size, samples) if samples else None
        self.plain = self.own(Picture(device, size))
        self.dark = self.own(Picture(device, size))
        small = (max(1, size[0] // 4), max(1, size[1] // 4))
        self.blur = (self.own(Picture(device, small)), self.own(Picture(device, small)))

    def resolve(self, raw: moderngl.Framebuffer) -> None:
        """Copy the raw colour to ``plain`` and the raw depth to ``still`` and ``behind``."""
        self._context.copy_framebuffer(self.still, raw)
        self.resolve_colour(raw)
        if self.behind is not None:
            # Depth alone cannot be copied: its colour is wiped out afterwards.
            self._context.copy_framebuffer(self.behind, raw)
            self.behind.use()
            self.behind.depth_mask = False
            self.behind.clear()
            self.behind.depth_mask = True

    def resolve_colour(self, raw: moderngl.Framebuffer) -> None:
        self._context.copy_framebuffer(self.plain.target, raw)


class FrameTargets(Owner):
    """Everything that depends on the picture's size and samples.

    size: of the scene; full: of the picture with the interface, where the scene is drawn smaller.
    work: the still picture with everything that moves drawn into it; person: a layer with samples for the person alone,
    None without samples; output: with the interface, where the scene is drawn smaller.
    """

    def __init__(self, device: Device, full: tuple[int, int], samples: int, scale: float = 1.0) -> None:
        super().__init__()
        size = (max(1, round(full[0] * scale)), max(1, round(full[1] * scale)))
        self.size, self.full, self.samples = size, full, samples
        self.bake = self.own(BakeTargets(device, size, samples))
        self.work = _target(self, device, size, 0)
        self.person = _target(self, device, size, samples) if samples else None
        self.output = self.own(Picture(device, full)).target if size != full else self.work
