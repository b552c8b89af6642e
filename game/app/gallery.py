"""Pictures the interface shows: named textures, made from pixels and given back together."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from game.render import Device

__all__ = ["Gallery"]


class Gallery:
    """Textures by name. A picture put under a name that is taken replaces it."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self._textures: dict[str, moderngl.Texture] = {}

    def put(self, name: str, pixels: NDArray[np.uint8]) -> None:
        """pixels (h, w, 3), first row at the top."""
        self.drop(name)
        opaque = np.dstack([pixels, np.full(pixels.shape[:2], 255, np.uint8)])
        texture = self._device.context.texture(
            (pixels.shape[1], pixels.shape[0]), 4, np.ascontiguousarray(opaque).tobytes()
        )
        texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        texture.repeat_x = texture.repeat_y = False
        self._textures[name] = texture

    def get(self, name: str) -> moderngl.Texture | None:
        """A picture, None where there is none of that name."""
        return self._textures.get(name)

    def drop(self, name: str) -> None:
        """Give a picture back, if there is one."""
        found = self._textures.pop(name, None)
        if found is not None:
            found.release()

    def names(self) -> frozenset[str]:
        """What there is."""
        return frozenset(self._textures)

    def release(self) -> None:
        """Give all of them back."""
        for name in list(self._textures):
            self.drop(name)
