"""Faces on the real head: a bust drawn by the game's own renderer, into pictures or for a texture of a window."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np
from numpy.typing import NDArray

from game.animation import Pose
from game.app.avatar import Avatar
from game.app.stage import StageShow, load_stage
from game.core import quaternion as quat
from game.core.humanoid import REFERENCE
from game.face import FIELDS, FaceParams
from game.render import Camera, Device, Level, Renderer, level_named
from game.render.avatar_model import AvatarLook

__all__ = ["BUST", "HeadStudio"]

Pixels = NDArray[np.uint8]
BUST = Camera((0.0, 1.235, 1.5), (0.0, 1.213, 0.0), 11.0)
"""Straight from the front, so that every rater sees the same: hair to collar fills a picture about as wide as high."""

_ARM_RAD = 1.25
_SETTLE_TICKS = 40


def _standing() -> Pose:
    """Looking straight ahead with the arms hanging: nothing but the face says anything."""
    rotation = np.zeros((1, len(REFERENCE), 4), dtype=np.float32)
    rotation[..., 3] = 1.0
    for side, sign in (("left", -1.0), ("right", 1.0)):
        rotation[0, REFERENCE.index[f"{side}UpperArm"]] = quat.from_axis_angle((0.0, 0.0, 1.0), sign * _ARM_RAD)
    root = np.asarray(REFERENCE.rest_translation[:1], dtype=np.float32)
    nothing = np.zeros(1, dtype=np.float32)
    return Pose(rotation, root, np.zeros((1, 2), dtype=np.float32), nothing, nothing)


class HeadStudio:
    """Draws one face after the other on the standing character, size × size pixels each.

    Without ``context`` it opens a device of its own through EGL; with the context of an open window it draws beside
    that window's pictures. Raises MissingPart without OpenGL.
    """

    def __init__(
        self,
        size: int,
        *,
        context: moderngl.Context | None = None,
        level: Level | None = None,
        avatar: Avatar | None = None,
    ) -> None:
        self.size = size
        self._own = context is None
        # A picture narrower than 16:9 keeps the width of its design: BUST's field is as wide as this square is high.
        self.device = Device.headless(size, size) if context is None else Device(context, (size, size), windowed=False)
        stage = load_stage(avatar=avatar)
        self._renderer = Renderer(
            self.device, stage.model, stage.stall, stage.backdrop, level=level or level_named("ultra")
        )
        self._show = StageShow(stage)
        pose = _standing()
        for _ in range(_SETTLE_TICKS):
            self._show.tick(pose, 1.0 / 30.0)

    def draw(self, params: FaceParams) -> Pixels:
        """(size, size, 3) picture of an expression (K,)."""
        self._renderer.draw(replace(self._show.frame(params, camera=BUST), show_stall=False))
        return self._renderer.read_pixels()

    def draw_look(self, look: AvatarLook) -> Pixels:
        """(size, size, 3) picture of an avatar's expression."""
        view = self._show.frame(np.zeros(len(FIELDS)), camera=BUST)
        self._renderer.draw(replace(view, look=look, show_stall=False))
        return self._renderer.read_pixels()

    def close(self) -> None:
        """Give the GL objects back; a context that was lent stays open."""
        self._renderer.release()
        if self._own:
            self.device.release()
