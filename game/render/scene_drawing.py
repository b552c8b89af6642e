"""The standing scene: stall, goods and backdrop, baked once per camera into a graded picture with depth."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import radians, tan

import moderngl
import numpy as np
from numpy.typing import NDArray

from game.render.camera import HERO, Camera
from game.render.daylight import DESIGN_SHARE
from game.render.device import Device, Owner, layout, set_uniforms
from game.render.foreground import Foreground
from game.render.lighting import STALL_LIGHT, FrameBlock, Lights
from game.render.model import Run, StaticMesh
from game.render.targets import BakeTargets

__all__ = ["BakeKey", "SceneDrawing", "backdrop_place"]

_SHADOW_SIZE = 1536
_NO_SHADOW = ("awning", "sway", "spin")  # it would shade the whole stall; what moves casts none either
_STUDIO_TOP, _STUDIO_BOTTOM = (252, 243, 226), (228, 199, 168)
_DARK_FLOOR = 0.80
_HORIZON = 1.0 - 262.0 / 720.0  # height of the painted horizon in the backdrop, from below
# The strip of the table, and of the studio's floor, on which the character's shadow falls. The strip is no wider than
# the shadow map reaches: every pixel of it costs a look into the map.
_TABLE = np.array([[x, 0.594, z] for x in (-0.75, 1.0) for z in (0.16, 0.755)], dtype=np.float32)
_FLOOR = np.array([[x, 0.0, z] for x in (-3.0, 3.0) for z in (-3.0, 3.0)], dtype=np.float32)

WIDE = 1.45
"""Width to height from which on the near layer's corners lie outside what is told."""


@dataclass(frozen=True)
class BakeKey:
    """What the baked picture depends on."""

    camera: Camera
    size: tuple[int, int]
    stall: bool
    hidden: frozenset[str]
    day_share: float = DESIGN_SHARE
    near: bool = True


class SceneDrawing(Owner):
    """Stall and goods on the GPU. ``backdrop`` (h, w, 3) uint8, first row at the top."""

    def __init__(self, device: Device, mesh: StaticMesh | None, backdrop: NDArray[np.uint8] | None) -> None:
        super().__init__()
        self._context = context = device.context
        self._mesh = mesh
        self._screen = self.own(context.buffer(np.array([-1, -1, 3, -1, -1, 3], dtype=np.float32)))
        self._backdrop_program, self._backdrop = self._fullscreen(device, "backdrop.frag.glsl")
        self._blur_program, self._blur = self._fullscreen(device, "blur.frag.glsl")
        self._post_program, self._post = self._fullscreen(device, "post.frag.glsl")
        set_uniforms(self._post_program, blurred=1)
        self._pictures = {True: self._picture(backdrop), False: self._picture(_studio())}
        self.shadow_map = self.own(context.depth_texture((_SHADOW_SIZE, _SHADOW_SIZE)))
        self.shadow_map.compare_func = "<="
        self.shadow_map.repeat_x = self.shadow_map.repeat_y = False
        self._shadow_target = self.own(context.framebuffer([], self.shadow_map))
        self._frame = self.own(FrameBlock(device))
        self._lights = Lights.market()
        self._foreground = self.own(Foreground(device, "none" if mesh is None else mesh.mood.near))
        if mesh is not None:
            self._make_mesh(device, mesh)
        self._make_receiver(device)

    def _fullscreen(self, device: Device, fragment: str) -> tuple[moderngl.Program, moderngl.VertexArray]:
        program = self.own(device.program("screen.vert.glsl", fragment))
        array = device.vertex_array(program, [layout(program, self._screen, corner="2f")])
        return program, self.own(array)

    def _picture(self, rgb: NDArray[np.uint8] | None) -> moderngl.Texture:
        image = _studio() if rgb is None else rgb
        texture = self._context.texture(
            (image.shape[1], image.shape[0]), 3, np.ascontiguousarray(image[::-1]), alignment=1
        )
        texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        texture.repeat_x = texture.repeat_y = False
        return self.own(texture)

    def _make_mesh(self, device: Device, mesh: StaticMesh) -> None:
        context = device.context
        place = self.own(context.buffer(np.hstack([mesh.position, mesh.normal, mesh.outline[:, None]])))
        self._place, self._outline = place, mesh.outline[:, None]
        palette = self.own(context.buffer(np.ascontiguousarray(mesh.palette)))
        index = self.own(context.buffer(np.ascontiguousarray(mesh.triangle)))

        def array(program: moderngl.Program) -> moderngl.VertexArray:
            entries = [
                layout(program, place, position="3f", normal="3f", outline="1f"),
                layout(program, palette, lit="3f1", shade="3f1", deep="3f1", _="3x"),
            ]
            return self.own(device.vertex_array(program, entries, index))

        self._shaders: dict[str, moderngl.Program] = {}
        self._arrays: dict[str, moderngl.VertexArray] = {}
        for kind in {run.kind for run in mesh.runs}:
            flags = {"GLOSS": int(kind == "gloss"), "FLAT": int(kind == "flat")}
            program = self.own(
                device.program(
                    "static.vert.glsl", "static.frag.glsl", defines={**flags, "TAPS": 4, "SHADOW_SIZE": _SHADOW_SIZE}
                )
            )
            set_uniforms(program, shadow_map=1)
            self._shaders[kind], self._arrays[kind] = program, array(program)
        self._hull = array(self.own(device.program("hull.vert.glsl", "hull.frag.glsl")))
        self._caster = array(self.own(device.program("shadow_static.vert.glsl", "empty.frag.glsl")))
        corner = mesh.triangle.reshape(-1)
        self._lined = [run for run in mesh.runs if mesh.outline[corner[run.first : run.first + run.count]].any()]

    def _make_receiver(self, device: Device) -> None:
        """The surface on which the moving character's shadow falls."""
        self._receivers: dict[tuple[int, int, bool], tuple[moderngl.Program, moderngl.VertexArray]] = {}
        self._receiver_buffer = {
            stall: self.own(device.context.buffer(corners)) for stall, corners in ((True, _TABLE), (False, _FLOOR))
        }
        self._device = device

    def receiver(self, stall: bool, taps: int, shadow_size: int) -> moderngl.VertexArray:
        """The strip that catches the character's shadow; expects its shadow map at unit 1, the dark picture at 3."""
        key = (taps, shadow_size, stall)
        if key not in self._receivers:
            program = self.own(
                self._device.program(
                    "table_shadow.vert.glsl",
                    "table_shadow.frag.glsl",
                    defines={"TAPS": max(taps, 1), "SHADOW_SIZE": shadow_size},
                )
            )
            set_uniforms(program, shadow_map=1, dark_picture=3)
            entry = layout(program, self._receiver_buffer[stall], position="3f")
            self._receivers[key] = (program, self.own(self._device.vertex_array(program, [entry])))
        return self._receivers[key][1]

    def move(self, position: NDArray[np.float32], normal: NDArray[np.float32]) -> None:
        """Give the mesh's vertices other places and normals, (v, 3) each."""
        self._place.write(np.hstack([position, normal, self._outline]))

    def bake(self, key: BakeKey, targets: BakeTargets, line_px: float, lights: Lights, *, draft: bool = False) -> None:
        """Draw everything that stands still into ``targets``: the graded picture, its depth, and the dark picture.

        A ``draft`` is drawn without samples where that saves any, for the frames of a moving camera.
        """
        context = self._context
        raw = targets.raw_draft if draft else targets.raw
        runs = self._runs(key)
        self._lights = lights
        self._frame.write(key.camera, lights, STALL_LIGHT, key.size, line_px)
        self._cast(runs)
        raw.use()
        raw.clear(depth=1.0)
        self._draw_backdrop(key, 1.0)
        self._shade(runs, sun_share=1.0)
        self._draw_hulls(runs)
        # Before a stall, not an item in the hand; in a narrow picture it would stand before the hands.
        wide = key.size[0] >= WIDE * key.size[1]
        if wide and key.near and any(run.group == "table" for run in runs):
            self._foreground.draw(key.camera)
        targets.resolve(raw)
        self._make_bloom(targets)
        self._grade(targets, targets.still, key.stall)
        raw.use()
        if key.stall:
            context.enable_only(moderngl.DEPTH_TEST)
            context.depth_func = "<="
            self._shade([run for run in runs if run.group == "table"], sun_share=0.0)
        else:
            self._draw_backdrop(key, _DARK_FLOOR)
        targets.resolve_colour(raw)
        self._grade(targets, targets.dark.target, key.stall)

    def _runs(self, key: BakeKey) -> list[Run]:
        if self._mesh is None or not key.stall:
            return []
        return [run for run in self._mesh.runs if run.group not in key.hidden]

    def _cast(self, runs: Iterable[Run]) -> None:
        self._shadow_target.use()
        self._shadow_target.clear(depth=1.0)
        self._context.enable_only(moderngl.DEPTH_TEST)
        self._context.depth_func = "<"
        for run in runs:
            if run.group.split(":")[0] not in _NO_SHADOW:
                self._caster.render(vertices=run.count, first=run.first)

    def _draw_backdrop(self, key: BakeKey, gain: float) -> None:
        self._context.enable_only(moderngl.NOTHING)
        self._pictures[key.stall].use(0)
        aspect = key.size[0] / key.size[1]
        place = backdrop_place(key.camera, aspect) if key.stall else (1.0, 1.0, 0.0, 0.0)
        day, plain = self._lights.day, np.ones(3)
        set_uniforms(
            self._backdrop_program,
            place=place,
            gain=gain,
            eye_level=(_HORIZON, day.lamps if key.stall else 0.0, 16.0 / 9.0, 0.0),
            sky=day.sky if key.stall else plain,
            horizon=day.horizon if key.stall else plain,
            ground=day.ground if key.stall else plain,
        )
        self._backdrop.render()

    def _shade(self, runs: Iterable[Run], sun_share: float) -> None:
        self._context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self._context.cull_face = "back"
        self.shadow_map.use(1)
        for run in runs:
            set_uniforms(self._shaders[run.kind], sun_share=sun_share)
            self._arrays[run.kind].render(vertices=run.count, first=run.first)

    def _draw_hulls(self, runs: Iterable[Run]) -> None:
        context = self._context
        context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        context.cull_face = "front"
        shown = set(runs)
        for run in self._lined if self._mesh is not None else ():
            if run in shown:
                self._hull.render(vertices=run.count, first=run.first)
        context.cull_face = "back"

    def _make_bloom(self, targets: BakeTargets) -> None:
        self._context.enable_only(moderngl.NOTHING)
        width, height = targets.blur[0].texture.size
        source = targets.plain
        for picture, texel_step in zip(targets.blur, ((1.0 / width, 0.0), (0.0, 1.0 / height)), strict=True):
            picture.target.use()
            source.texture.use(0)
            set_uniforms(self._blur_program, texel_step=texel_step)
            self._blur.render()
            source = picture

    def _grade(self, targets: BakeTargets, target: moderngl.Framebuffer, stall: bool) -> None:
        self._context.enable_only(moderngl.NOTHING)
        target.use()
        target.depth_mask = False
        targets.plain.texture.use(0)
        targets.blur[1].texture.use(1)
        set_uniforms(self._post_program, vignette=1.0 if stall else 0.4)
        self._post.render()
        target.depth_mask = True


def _studio() -> NDArray[np.uint8]:
    """A plain warm gradient, (64, 4, 3), for pictures of the person alone."""
    t = np.linspace(0.0, 1.0, 64)[:, None, None]
    colour = np.array(_STUDIO_TOP) * (1 - t) + np.array(_STUDIO_BOTTOM) * t
    return np.broadcast_to(colour, (64, 4, 3)).astype(np.uint8)


def backdrop_place(camera: Camera, aspect: float) -> tuple[float, float, float, float]:
    """Scale and offset that carry picture coordinates (0..1) to the painting: a far plane that fills the hero camera.

    Works in tangents of the view angles: the painted horizon stays at eye level, turning pans and zooming zooms.
    """
    half_height = tan(radians(HERO.fov_deg) / 2.0)
    half_width = half_height * 16.0 / 9.0
    eye, target = np.array(camera.eye), np.array(camera.target)
    forward = target - eye
    yaw = np.arctan2(forward[0], -forward[2])
    pitch = np.arctan2(forward[1], np.hypot(forward[0], forward[2]))
    own = camera.tan_half_height(aspect)
    scale_x, scale_y = own * aspect / half_width, own / half_height
    horizon = 0.5 - np.tan(pitch) / own * 0.5  # height of true eye level in this picture
    offset_x = 0.5 - 0.5 * scale_x + 0.5 * float(np.clip(yaw, -0.6, 0.6)) / half_width
    return (scale_x, scale_y, offset_x, float(_HORIZON - horizon * scale_y))
