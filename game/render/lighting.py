"""The light of the picture and the block of values that all passes of one frame share."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from game.render.camera import Camera, look_at, orthographic
from game.render.daylight import DESIGN_SHARE, Daylight, daylight
from game.render.device import Device, Owner
from game.render.mood import MARKET_MOOD, Mood

__all__ = ["STALL_LIGHT", "STUDIO_LIGHT", "TABLE_LIGHT", "FrameBlock", "LightBox", "Lights"]


def _unit(x: float, y: float, z: float) -> NDArray[np.float64]:
    v = np.array([x, y, z])
    return np.asarray(v / np.linalg.norm(v))


@dataclass(frozen=True, eq=False)
class Lights:
    """Directions toward the sun and the two back lights, unit vectors, and what the hour makes of the colours."""

    sun: NDArray[np.float64]
    warm: NDArray[np.float64]
    cool: NDArray[np.float64]
    day: Daylight

    @classmethod
    def market(cls, day_share: float = DESIGN_SHARE, mood: Mood = MARKET_MOOD) -> Lights:
        """The light at a share of the afternoon, in a stall's own colours; towards evening lamps are alike anywhere."""
        day = daylight(day_share)
        own = 1.0 - 0.5 * day.lamps
        tints = {name: 1.0 + own * (np.array(getattr(mood, name)) - 1.0) for name in ("lit", "shade", "deep", "rim")}
        far = 1.0 + own * (np.array(mood.far) - 1.0)
        day = replace(
            day,
            **{name: getattr(day, name) * tint for name, tint in tints.items()},
            **{name: getattr(day, name) * far for name in ("sky", "horizon", "ground")},
        )
        return cls(np.asarray(day.sun), _unit(0.75, 0.45, -0.55), _unit(-0.8, 0.25, -0.5), day)


@dataclass(frozen=True)
class LightBox:
    """The part of the world a shadow map covers: centre, half extents and depth range along the sun's axis, metres."""

    centre: tuple[float, float, float]
    half_width: float
    half_height: float
    near: float
    far: float
    bias: float  # in 0..1 depth

    def world_to_light(self, sun: NDArray[np.float64]) -> NDArray[np.float64]:
        centre = np.array(self.centre)
        view = look_at(centre + sun * 4.0, centre)
        return orthographic(self.half_width, self.half_height, self.near, self.far) @ view


STALL_LIGHT = LightBox((0.0, 0.95, 0.1), 1.25, 0.9, 2.4, 5.6, 0.0)  # everything that stands still
TABLE_LIGHT = LightBox((0.03, 0.93, 0.08), 0.62, 0.62, 2.9, 5.1, 0.0012)  # the upper body behind the table
STUDIO_LIGHT = LightBox((0.0, 0.70, 0.0), 0.95, 0.95, 2.6, 6.2, 0.0010)  # the whole person


_WARM_GLOW, _COOL_GLOW = (0.16, 0.13, 0.09), (0.022, 0.0385, 0.0715)
"""What the back lights add at the edges of even the darkest colour."""
_ROWS = 22


class FrameBlock(Owner):
    """The std140 block ``Frame`` of frame.glsl on the GPU."""

    HEAD_PUSH_M = 0.03
    FEATHER_PX = 1.3

    def __init__(self, device: Device) -> None:
        super().__init__()
        self._buffer = self.own(device.context.buffer(reserve=_ROWS * 16, dynamic=True))
        self._written: tuple[object, ...] = ()
        self._world_to_clip = np.eye(4)

    def write(
        self,
        camera: Camera,
        lights: Lights,
        box: LightBox,
        size: tuple[int, int],
        line_px: float,
    ) -> NDArray[np.float64]:
        """Fill the block for a picture of ``size`` pixels and bind it; returns world to clip (4, 4).

        ``line_px`` is the outline width of a picture 720 pixels high.
        """
        self._buffer.bind_to_uniform_block(0)
        if self._written == (camera, lights, box, size, line_px):
            return self._world_to_clip
        self._written = (camera, lights, box, size, line_px)
        width, height = size
        aspect = width / height
        projection = camera.projection(aspect)
        world_to_clip = projection @ camera.view()
        scale = height / 720.0
        rows = np.zeros((_ROWS, 4), dtype=np.float32)
        rows[0:4] = world_to_clip.T
        rows[4:8] = box.world_to_light(lights.sun).T
        rows[8, :3], rows[9, :3], rows[10, :3] = lights.sun, lights.warm, lights.cool
        rows[11, :3] = camera.eye
        rows[12] = (width, height, line_px * scale, self.FEATHER_PX * max(1.0, scale**0.5))
        rows[13] = (projection[2, 3], -projection[2, 2], box.bias, self.HEAD_PUSH_M)
        day = lights.day
        rows[14:17, :3] = day.lit, day.shade, day.deep
        rows[17:19, :3] = 0.55 * day.rim, np.array(_WARM_GLOW) * day.rim
        rows[19:21, :3] = 0.165 * day.shade, np.array(_COOL_GLOW) * day.shade
        rows[21, :3] = day.rim
        rows[14, 3] = day.lamps
        self._buffer.write(rows)
        self._world_to_clip = world_to_clip
        return world_to_clip
