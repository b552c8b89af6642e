"""Paints the two face layers into textures on the GPU, only when the expression changed."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from game.face.mesh import DrawList, Layer, Sheet, ribbons
from game.render.device import PREMULTIPLIED, Device, Owner, layout

__all__ = ["FACE_MM", "FacePainter", "hidden_face"]

FACE_MM = 340.0  # side of the square of head-rest space that the texture shows
_SIZES = (256, 384, 512, 768, 1024)
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

    def __init__(self, device: Device, program: moderngl.Program, size: int) -> None:
        super().__init__()
        self._device = device
        self._program = program
        self.texture = self.own(device.context.texture((size, size), 4))
        self.texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self.texture.repeat_x = self.texture.repeat_y = False
        self._target = self.own(device.context.framebuffer([self.texture]))
        self._capacity = (0, 0)
        self._mesh = Owner()
        self._reserve(_FIRST_VERTICES, 3 * _FIRST_VERTICES)
        self._target.clear()

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

    def paint(self, layer: Layer) -> None:
        self._target.use()
        self._target.clear()
        if layer.triangle.size:
            self._reserve(len(layer.position), layer.triangle.size)
            self._place.write(_floats(layer.position))
            self._ink.write(_floats(layer.colour))
            self._index.write(np.ascontiguousarray(layer.triangle, dtype=np.uint32))
            self._array.render(vertices=layer.triangle.size)

    def release(self) -> None:
        self._mesh.release()
        super().release()


def _floats(array: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.ascontiguousarray(array, dtype=np.float32)


class FacePainter(Owner):
    """The textures ``under`` (painted on the skin) and ``over`` (drawn once more over the hair), premultiplied.

    The shapes bring their own feathered edges, so no multisampling is needed. The textures are as large as the face
    on the screen asks for, at most ``max_size``: never so much larger that mipmaps were needed, which cost a software
    rasteriser more than the painting.
    """

    def __init__(self, device: Device, max_size: int) -> None:
        super().__init__()
        self._device = device
        self._program = self.own(device.program("face_paint.vert.glsl", "face_paint.frag.glsl"))
        self._max_size = max_size
        self._layers: tuple[_LayerTarget, _LayerTarget] | None = None
        self._size = 0
        self._shown: DrawList | None = None
        self.fit(FACE_MM)

    @property
    def under(self) -> moderngl.Texture:
        return self._targets()[0].texture

    @property
    def over(self) -> moderngl.Texture:
        return self._targets()[1].texture

    def _targets(self) -> tuple[_LayerTarget, _LayerTarget]:
        assert self._layers is not None, "fit makes them"
        return self._layers

    def fit(self, face_px: float) -> None:
        """Choose the texture size for a face whose 340 mm square covers so many pixels of the picture's height."""
        # Up to two texels to a pixel, the linear filter still sees all of them.
        size = next((size for size in _SIZES if size >= 1.7 * face_px), _SIZES[-1])
        size = min(size, self._max_size)
        if size != self._size:
            self._drop()
            self._size = size
            self._layers = (
                _LayerTarget(self._device, self._program, size),
                _LayerTarget(self._device, self._program, size),
            )
            self._shown = None

    def paint(self, face: DrawList) -> None:
        """Paint a draw list; the same object again costs nothing."""
        if face is self._shown:
            return
        self._shown = face
        context = self._device.context
        context.enable_only(moderngl.BLEND)
        context.blend_func = PREMULTIPLIED
        under, over = self._targets()
        under.paint(face.under)
        over.paint(face.over)

    def _drop(self) -> None:
        if self._layers is not None:
            self._device.nowhere.use()
            for layer in self._layers:
                layer.release()
        self._layers = None

    def release(self) -> None:
        self._drop()
        super().release()
