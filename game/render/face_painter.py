"""Paints the two face layers into textures on the GPU, only when the expression changed."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from game.face.mesh import DrawList, Layer, Sheet, ribbons
from game.render.device import PREMULTIPLIED, Device, Owner, layout

__all__ = ["FacePainter", "hidden_face"]

_FIRST_VERTICES = 4096


def hidden_face() -> DrawList:
    """A blank face with two guide lines, for showing body language alone."""
    sheet = Sheet()
    lines = np.array([np.linspace((0.0, 110.0), (0.0, -165.0), 12), np.linspace((-140.0, -36.0), (140.0, -36.0), 12)])
    ink = np.array([170.0, 95.0, 80.0, 255.0]) / 255.0 / 3.0
    ribbons(sheet, lines, 3.0, np.stack([ink, ink]))
    return DrawList(sheet.layer(), Sheet().layer())


class _LayerTarget(Owner):
    """Texture, framebuffer and growing buffers of one layer."""

    def __init__(self, device: Device, program: moderngl.Program, size: int, mipmaps: bool) -> None:
        super().__init__()
        self._device = device
        self._program = program
        self._mipmaps = mipmaps
        self.texture = self.own(device.context.texture((size, size), 4))
        self.texture.repeat_x = self.texture.repeat_y = False
        self._target = self.own(device.context.framebuffer([self.texture]))
        self._capacity = (0, 0)
        self._mesh = Owner()
        self._reserve(_FIRST_VERTICES, 3 * _FIRST_VERTICES)
        self._target.clear()
        self._finish()

    def _reserve(self, vertices: int, corners: int) -> None:
        if vertices <= self._capacity[0] and corners <= self._capacity[1]:
            return
        self._mesh.release()
        self._capacity = (max(vertices, 2 * self._capacity[0]), max(corners, 2 * self._capacity[1]))
        context, own = self._device.context, self._mesh.own
        self._place = own(context.buffer(reserve=self._capacity[0] * 8, dynamic=True))
        self._ink = own(context.buffer(reserve=self._capacity[0] * 16, dynamic=True))
        self._index = own(context.buffer(reserve=self._capacity[1] * 4, dynamic=True))
        self._array = own(
            self._device.vertex_array(
                self._program,
                [layout(self._program, self._place, position="2f"), layout(self._program, self._ink, ink="4f")],
                self._index,
            )
        )

    def _finish(self) -> None:
        if self._mipmaps:
            self.texture.build_mipmaps()
        self.texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR if self._mipmaps else moderngl.LINEAR, moderngl.LINEAR)

    def paint(self, layer: Layer) -> None:
        self._target.use()
        self._target.clear()
        if layer.triangle.size:
            self._reserve(len(layer.position), layer.triangle.size)
            self._place.write(_floats(layer.position))
            self._ink.write(_floats(layer.colour))
            self._index.write(np.ascontiguousarray(layer.triangle, dtype=np.uint32))
            self._array.render(vertices=layer.triangle.size)
        self._finish()

    def release(self) -> None:
        self._mesh.release()
        super().release()


def _floats(array: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.ascontiguousarray(array, dtype=np.float32)


class FacePainter(Owner):
    """The textures ``under`` (painted on the skin) and ``over`` (drawn once more over the hair), premultiplied.

    The shapes bring their own feathered edges, so no multisampling is needed; mipmaps keep small faces calm.
    """

    def __init__(self, device: Device, size: int) -> None:
        super().__init__()
        self._context = device.context
        program = self.own(device.program("face_paint.vert.glsl", "face_paint.frag.glsl"))
        self._under = self.own(_LayerTarget(device, program, size, mipmaps=True))
        self._over = self.own(_LayerTarget(device, program, size, mipmaps=True))
        self._shown: DrawList | None = None

    @property
    def under(self) -> moderngl.Texture:
        return self._under.texture

    @property
    def over(self) -> moderngl.Texture:
        return self._over.texture

    def paint(self, face: DrawList) -> None:
        """Paint a draw list; the same object again costs nothing."""
        if face is self._shown:
            return
        self._shown = face
        context = self._context
        context.enable_only(moderngl.BLEND)
        context.blend_func = PREMULTIPLIED
        self._under.paint(face.under)
        self._over.paint(face.over)
