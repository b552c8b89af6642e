"""Passers-by behind the stall: drawn small, out of focus and in the haze, then laid into the still picture.

They are drawn in a small picture of their own, blurred there, and copied only where the still picture shows the far
backdrop and only in the columns where somebody is, so that a whole crowd costs a software rasteriser little.
"""

from __future__ import annotations

from collections.abc import Sequence

import moderngl
import numpy as np
from numpy.typing import NDArray

from game.render.crowd import CrowdLook, CrowdMesh, CrowdView
from game.render.daylight import Daylight
from game.render.device import PREMULTIPLIED, Device, Owner, layout, set_uniforms
from game.render.model import MAX_JOINTS
from game.render.targets import Picture

__all__ = ["CrowdDrawing"]

_HEIGHT_PX = 180  # of the picture they are drawn in: as soft in every size of window
_MARGIN = 0.03  # of the picture's width and height, around a person: blur, arms
_HAZE = (0.97, 0.88, 0.74)
_HAZE_NEAR, _HAZE_PER_M = 0.16, 0.055  # at 7 m from the eye, and more for each metre beyond
Span = tuple[float, float, float, float]  # left, low, right, high in clip coordinates


class CrowdDrawing(Owner):
    """A fixed set of passers-by; a frame may show the first few of them."""

    def __init__(self, device: Device, looks: Sequence[CrowdLook]) -> None:
        super().__init__()
        self._device, self._context = device, device.context
        context = device.context
        self._program = self.own(device.program("crowd.vert.glsl", "crowd.frag.glsl"))
        self._ground = self.own(device.program("crowd_shadow.vert.glsl", "crowd_shadow.frag.glsl"))
        self._blur = self.own(device.program("strip.vert.glsl", "crowd_blur.frag.glsl"))
        self._lay = self.own(device.program("strip.vert.glsl", "picture.frag.glsl"))
        self._corner = self.own(context.buffer(np.array([-1, -1, 1, -1, -1, 1, 1, 1], dtype=np.float32)))
        self._spans = self.own(context.buffer(reserve=16 * max(len(looks), 1), dynamic=True))
        self._feet = self.own(context.buffer(reserve=16 * max(len(looks), 1), dynamic=True))
        self._joints = self.own(context.buffer(reserve=MAX_JOINTS * 48, dynamic=True))
        corner = layout(self._ground, self._corner, corner="2f")
        self._shadows = self.own(
            device.vertex_array(self._ground, [corner, layout(self._ground, self._feet, foot="4f/i")])
        )
        self._strips = [
            self.own(
                device.vertex_array(
                    program,
                    [layout(program, self._corner, corner="2f"), layout(program, self._spans, span="4f/i")],
                )
            )
            for program in (self._blur, self._lay)
        ]
        meshes: dict[int, tuple[moderngl.Buffer, moderngl.Buffer]] = {}
        self._people = [self._person(look, meshes) for look in looks]
        self._shown = 0  # strips that are prepared
        self._size = (0, 0)
        self._targets = Owner()

    def _person(
        self, look: CrowdLook, meshes: dict[int, tuple[moderngl.Buffer, moderngl.Buffer]]
    ) -> moderngl.VertexArray:
        mesh = look.mesh
        if id(mesh) not in meshes:
            meshes[id(mesh)] = self._shared(mesh)
        place, index = meshes[id(mesh)]
        colours = np.hstack([look.lit, look.shade])
        joint = np.hstack([mesh.joint[:, None], np.zeros((len(mesh.joint), 1), np.uint8)])
        paint = self.own(self._context.buffer(_bytes(colours, joint)))
        entries = [
            layout(self._program, place, position="3f", normal="3f", face_uv="2f"),
            layout(self._program, paint, lit="3f1", shade="3f1", joint="2u1"),
        ]
        return self.own(self._device.vertex_array(self._program, entries, index))

    def _shared(self, mesh: CrowdMesh) -> tuple[moderngl.Buffer, moderngl.Buffer]:
        place = np.hstack([mesh.position, mesh.normal, mesh.face_uv]).astype(np.float32)
        index = np.ascontiguousarray(mesh.triangle, dtype=np.int32)
        return self.own(self._context.buffer(place)), self.own(self._context.buffer(index))

    def release(self) -> None:
        self._targets.release()
        super().release()

    def _fit(self, size: tuple[int, int]) -> None:
        if self._size == size:
            return
        self._device.nowhere.use()
        self._targets.release()
        self._targets = Owner()
        height = min(_HEIGHT_PX, size[1])
        small = (max(1, round(size[0] * height / size[1])), height)
        self._sharp = self._targets.own(Picture(self._device, small))
        self._soft = self._targets.own(Picture(self._device, small))
        depth = self._targets.own(self._context.depth_texture(small))
        self._target = self._targets.own(self._context.framebuffer([self._sharp.texture], depth))
        self._size = size

    def prepare(
        self, view: CrowdView, size: tuple[int, int], eye: NDArray[np.float64],
        world_to_clip: NDArray[np.float64], day: Daylight, most: int,
    ) -> None:  # fmt: skip
        """Draw the first ``most`` passers-by into their small picture; the Frame block must be bound."""
        self._shown = 0
        count = min(len(view.matrices), len(self._people), most)
        boxes = [_box(view.place[i], float(view.tall_m[i]), world_to_clip) for i in range(count)]
        shown = [i for i in range(count) if boxes[i] is not None]
        if not shown:
            return
        self._fit(size)
        spans = _disjoint([box for box in boxes if box is not None])
        self._spans.write(np.array(spans, dtype=np.float32))
        self._draw_people(view, shown, eye, day)
        self._context.enable_only(moderngl.NOTHING)
        self._soft.target.use()
        self._soft.target.clear()  # a strip's edge looks at its neighbour
        self._sharp.texture.use(0)
        width, height = self._soft.texture.size
        set_uniforms(self._blur, texel=(1.0 / width, 1.0 / height))
        self._strips[0].render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(spans))
        self._shown = len(spans)

    def lay(self, target: moderngl.Framebuffer) -> None:
        """Lay what was prepared into ``target``, where its depth shows the far plane."""
        if not self._shown:
            return
        self._soft.texture.use(0)
        target.use()
        self._context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        self._context.depth_func = "<="
        self._context.blend_func = PREMULTIPLIED
        target.depth_mask = False
        self._strips[1].render(moderngl.TRIANGLE_STRIP, vertices=4, instances=self._shown)
        target.depth_mask = True

    def _draw_people(self, view: CrowdView, shown: Sequence[int], eye: NDArray[np.float64], day: Daylight) -> None:
        context, joints = self._context, self._joints
        self._target.use()
        self._target.clear(0.0, 0.0, 0.0, 0.0, depth=1.0)
        place = view.place[shown]
        feet = np.hstack([place, 0.24 * view.tall_m[shown][:, None]]).astype(np.float32)
        self._feet.write(feet)
        context.enable_only(moderngl.BLEND)
        context.blend_func = PREMULTIPLIED
        self._shadows.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(shown))
        context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        context.depth_func = "<"
        far = np.linalg.norm(place - eye, axis=1)
        haze = tuple(float(v) for v in np.clip(np.array(_HAZE) * day.horizon, 0.0, 1.0))
        joints.bind_to_uniform_block(1)
        for i, away in zip(shown, far.tolist(), strict=True):
            joints.write(np.ascontiguousarray(view.matrices[i][:, :3, :], dtype=np.float32))
            share = min(max(_HAZE_NEAR + _HAZE_PER_M * (away - 7.0), 0.05), 0.6)
            set_uniforms(self._program, haze=(*haze, share))
            self._people[i].render()


def _bytes(colours: NDArray[np.floating], joint: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.ascontiguousarray(np.hstack([np.rint(np.clip(colours, 0, 1) * 255).astype(np.uint8), joint]))


def _box(place: NDArray[np.floating], tall_m: float, world_to_clip: NDArray[np.float64]) -> Span | None:
    """Where a person is in the picture, in clip coordinates; None where they are outside."""
    half = 0.42 * tall_m
    corner = np.array([[x, y, 0.0, 0.0] for x in (-half, half) for y in (-0.06, tall_m + 0.08)])
    clip = (corner + np.append(place, 1.0)) @ world_to_clip.T
    if (clip[:, 3] < 0.5).any():
        return None
    points = clip[:, :2] / clip[:, 3:4]
    low, high = points.min(axis=0) - 2 * _MARGIN, points.max(axis=0) + 2 * _MARGIN
    if (high < -1.0).any() or (low > 1.0).any():
        return None
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _disjoint(boxes: Sequence[Span]) -> list[Span]:
    """Boxes that overlap sideways become one: nothing is laid into the picture twice."""
    result: list[Span] = []
    for left, low, right, high in sorted(boxes):
        if result and left <= result[-1][2]:
            before = result[-1]
            result[-1] = (before[0], min(low, before[1]), max(right, before[2]), max(high, before[3]))
        else:
            result.append((left, low, right, high))
    return result
