"""A foreign avatar on the GPU: morphed on the CPU where the face changed, skinned once per frame, drawn as MToon."""

from __future__ import annotations

from math import cos, sin
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from game.formats import ToonMaterial, ToonTexture
from game.render.avatar_model import AvatarLook, AvatarModel, AvatarRun
from game.render.device import PREMULTIPLIED, Device, Owner, layout, set_uniforms
from game.render.levels import Level
from game.render.model import MAX_JOINTS

__all__ = ["AvatarDrawing"]

_MARGIN_PX = 12
_SRGB8_ALPHA8 = 0x8C43  # GL decodes each texel before it filters
_STILL = 1e-4  # morph weights that moved less are not drawn again


class AvatarDrawing(Owner):
    """Buffers, pictures and programs of one avatar; called like CharacterDrawing, and ``look`` before ``pose``."""

    def __init__(self, device: Device, model: AvatarModel, level: Level) -> None:
        super().__init__()
        self._context, self._nowhere, self._model = device.context, device.nowhere, model
        self._look = model.still()
        geometry = model.geometry
        self._rest = np.hstack([geometry.position, geometry.normal, np.ones((len(geometry.position), 1))])
        self._rest = np.ascontiguousarray(self._rest, dtype=np.float32)
        self._joints = self.own(device.context.buffer(reserve=MAX_JOINTS * 48, dynamic=True))
        self._place = self.own(device.context.buffer(self._rest, dynamic=True))
        self._index = self._buffer(geometry.triangle)
        self._make_pictures(device)
        self._make_skinning(device)
        self._make_drawing(device, level)
        self._make_shadow(device, level)

    def _buffer(self, array: NDArray[np.generic]) -> moderngl.Buffer:
        return self.own(self._context.buffer(np.ascontiguousarray(array)))

    def _make_pictures(self, device: Device) -> None:
        self._white = self.own(device.context.texture((1, 1), 4, b"\xff" * 4))
        self._textures: dict[tuple[int, bool, tuple[bool, bool]], moderngl.Texture] = {}
        for material in self._model.materials:
            for texture in (material.lit_texture, material.shade_texture, material.emissive_texture):
                if texture is not None and texture.image in self._model.pictures:
                    key = (texture.image, texture.nearest, texture.wrap)
                    if key not in self._textures:
                        self._textures[key] = self.own(_upload(device, self._model.pictures[texture.image], texture))

    def _picture(self, texture: ToonTexture | None) -> moderngl.Texture:
        if texture is None:
            return self._white
        return self._textures.get((texture.image, texture.nearest, texture.wrap), self._white)

    def _make_skinning(self, device: Device) -> None:
        geometry = self._model.geometry
        varyings = ["clip", "terms", "shadow_place", "line"]
        program = self.own(device.program("skin.vert.glsl", varyings=varyings, defines={"CAST_SIZE": 0}))
        self._bones = self._buffer(np.hstack([geometry.joint, geometry.weight]))
        entries = [
            layout(program, self._place, position="3f", normal="3f", outline="1f"),
            layout(program, self._bones, joint="4u1", weight="4f1"),
        ]
        self._skinning = self.own(device.vertex_array(program, entries))
        count = len(geometry.position)
        self._captured = [self.own(device.context.buffer(reserve=count * 16)) for _ in range(4)]

    def _make_drawing(self, device: Device, level: Level) -> None:
        geometry = self._model.geometry
        clip, terms, place, line = self._captured
        surface = self._buffer(geometry.uv)
        tint, width = self._buffer(geometry.colour), self._buffer(self._model.width)
        self._fills: dict[tuple[bool, str], tuple[moderngl.Program, moderngl.VertexArray]] = {}
        self._lines: dict[bool, tuple[moderngl.Program, moderngl.VertexArray]] = {}
        for run in self._model.runs:
            material = self._model.materials[run.material]
            key = _fill_key(material)
            if key not in self._fills:
                flags = {"UNLIT": int(key[0]), "CUT": int(key[1] == "mask"), "BLEND": int(key[1] == "blend")}
                program = self.own(
                    device.program(
                        "avatar.vert.glsl",
                        "avatar.frag.glsl",
                        defines={**flags, "TAPS": max(level.shadow_taps, 1), "SHADOW_SIZE": level.shadow_size},
                    )
                )
                set_uniforms(program, shadow_map=1, lit_picture=4, shade_picture=5, glow_picture=6)
                entries = [
                    layout(program, clip, clip="4f"),
                    layout(program, terms, terms="4f"),
                    layout(program, place, shadow_place="4f"),
                    layout(program, surface, uv="2f"),
                    layout(program, tint, tint="4f1"),
                ]
                self._fills[key] = (program, self.own(device.vertex_array(program, entries, self._index)))
            cut = material.alpha == "mask"
            if material.outline_mode != "none" and cut not in self._lines:
                program = self.own(
                    device.program("avatar_line.vert.glsl", "avatar_line.frag.glsl", defines={"CUT": int(cut)})
                )
                set_uniforms(program, lit_picture=4)
                entries = [
                    layout(program, clip, clip="4f"),
                    layout(program, line, line="4f"),
                    layout(program, width, width="1f"),
                    layout(program, surface, uv="2f"),
                    layout(program, tint, tint="4f1"),
                ]
                self._lines[cut] = (program, self.own(device.vertex_array(program, entries, self._index)))

    def _make_shadow(self, device: Device, level: Level) -> None:
        context = device.context
        program = self.own(device.program("shadow_character.vert.glsl", "empty.frag.glsl"))
        # Nothing is pushed: an avatar's head casts where it is.
        still = self._buffer(np.zeros(len(self._rest), dtype=np.float32))
        entries = [
            layout(program, self._place, position="3f", _normal="3f", _outline="1f"),
            layout(program, still, push="1f"),
            layout(program, self._bones, joint="4u1", weight="4f1"),
        ]
        self._caster = self.own(device.vertex_array(program, entries, self._index))
        self.shadow_map = self.own(context.depth_texture((level.shadow_size, level.shadow_size)))
        self.shadow_map.compare_func = "<="
        self.shadow_map.repeat_x = self.shadow_map.repeat_y = False
        self._shadow_target = self.own(context.framebuffer([], self.shadow_map))

    def look(self, look: AvatarLook) -> None:
        """Take on an expression: morph targets are added up only when they changed."""
        changed = np.abs(look.morph - self._look.morph).max(initial=0.0) > _STILL
        before, self._look = self._look, look
        if not changed:
            self._look = AvatarLook(before.morph, look.colours, look.shifts)
            return
        rows = self._rest.copy()
        for slot in np.flatnonzero(np.abs(look.morph) > _STILL).tolist():
            vertex, way = self._model.moved[slot]
            rows[vertex, :6] += look.morph[slot] * way
        self._place.write(rows)

    def pose(
        self,
        skin_matrices: NDArray[np.float32],
        world_to_clip: NDArray[np.float64],
        size: tuple[int, int],
        *,
        whole: bool = True,
        cast: bool = True,
    ) -> tuple[int, int, int, int]:
        """Draw the shadow map, if ``cast``, and skin the mesh; skin_matrices (k, 4, 4).

        ``whole`` is for people with legs apart: an avatar always is whole.

        Returns the picture box (x, y, width, height) that encloses the mesh.
        """
        del whole
        rows = np.ascontiguousarray(skin_matrices[:, :3, :], dtype=np.float32)
        self._joints.write(rows)
        self._joints.bind_to_uniform_block(1)
        if cast:
            self._cast()
        self._nowhere.use()
        self._skinning.transform(self._captured, moderngl.POINTS, vertices=len(self._rest))
        corners = self._model.joint_box
        world = np.einsum("jrc,jkc->jkr", rows[:, :, :3], corners) + rows[:, None, :, 3]
        clip = world.reshape(-1, 3) @ world_to_clip[:, :3].T + world_to_clip[:, 3]
        if (clip[:, 3] < 0.05).any():
            return (0, 0, *size)
        pixels = (clip[:, :2] / clip[:, 3:4] * 0.5 + 0.5) * size
        margin = _MARGIN_PX + round(0.02 * size[1])  # morph targets reach beyond the boxes
        low = np.clip(np.floor(pixels.min(axis=0)).astype(int) - margin, 0, size)
        high = np.clip(np.ceil(pixels.max(axis=0)).astype(int) + margin, 0, size)
        return (int(low[0]), int(low[1]), int(high[0] - low[0]), int(high[1] - low[1]))

    def _cast(self) -> None:
        """Draw the shadow map: back faces, and both sides of what has no back."""
        context = self._context
        self._shadow_target.use()
        self._shadow_target.clear(depth=1.0)
        context.depth_func = "<"
        context.cull_face = "front"
        for run in self._model.runs:
            material = self._model.materials[run.material]
            if material.alpha != "blend":
                context.enable_only(moderngl.DEPTH_TEST | (0 if material.double_sided else moderngl.CULL_FACE))
                self._caster.render(vertices=run.count, first=run.first)
        context.cull_face = "back"

    def draw(self, face: moderngl.Texture) -> None:
        """Shade and outline into the bound framebuffer; the painted face is not for avatars."""
        del face
        self.shadow_map.use(1)
        context = self._context
        context.depth_func = "<"
        for run in self._model.runs:
            material = self._model.materials[run.material]
            flags = moderngl.DEPTH_TEST | (0 if material.double_sided else moderngl.CULL_FACE)
            if material.alpha == "blend":
                flags |= moderngl.BLEND
                context.blend_func = PREMULTIPLIED
                context.depth_func = "<="
            context.enable_only(flags)
            context.fbo.depth_mask = material.writes_depth
            self._fill(run, material)
            context.fbo.depth_mask = True
            context.depth_func = "<"
            if material.outline_mode != "none" and material.outline_width > 0.0 and material.alpha != "blend":
                context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
                context.cull_face = "front"
                self._line(run, material)
                context.cull_face = "back"

    def draw_over(self, face_over: moderngl.Texture) -> None:
        """Avatars have no second face layer."""
        del face_over

    def _fill(self, run: AvatarRun, material: ToonMaterial) -> None:
        program, array = self._fills[_fill_key(material)]
        self._picture(material.lit_texture).use(4)
        self._picture(material.shade_texture).use(5)
        self._picture(material.emissive_texture).use(6)
        set_uniforms(
            program,
            **self._surface(run, material),
            shade=self._colour(run, "shade", material.shade)[:3],
            glow=self._colour(run, "emissive", material.emissive)[:3],
            rim=self._colour(run, "rim", material.rim)[:3],
            rim_shape=(material.rim_power, material.rim_lift),
            toon_shape=(material.shift, material.toony),
        )
        array.render(vertices=run.count, first=run.first)

    def _line(self, run: AvatarRun, material: ToonMaterial) -> None:
        program, array = self._lines[material.alpha == "mask"]
        self._picture(material.lit_texture).use(4)
        set_uniforms(
            program,
            **self._surface(run, material),
            in_metres=float(material.outline_mode == "world"),
            ink=self._colour(run, "outline", material.outline)[:3],
            ink_lit=material.outline_lit if material.kind == "mtoon" else 0.0,
        )
        array.render(vertices=run.count, first=run.first)

    def _surface(self, run: AvatarRun, material: ToonMaterial) -> dict[str, Any]:
        texture = material.lit_texture or ToonTexture(-1)
        sx, sy, ox, oy = self._look.shifts.get(run.material, (1.0, 1.0, 0.0, 0.0))
        scale, offset = texture.scale, texture.offset
        return {
            # An expression's transform comes on top of the material's own.
            "place": (offset[0] * sx + ox, offset[1] * sy + oy, scale[0] * sx, scale[1] * sy),
            "spin": (cos(texture.rotation_rad), sin(texture.rotation_rad)),
            "lit": self._colour(run, "lit", material.lit),
            "cutoff": material.cutoff,
        }

    def _colour(self, run: AvatarRun, what: str, own: tuple[float, ...]) -> tuple[float, ...]:
        """Linear factors."""
        return self._look.colours.get((run.material, what), own)


def _fill_key(material: ToonMaterial) -> tuple[bool, str]:
    return (material.kind == "unlit", material.alpha if material.alpha in ("mask", "blend") else "opaque")


def _upload(device: Device, picture: NDArray[np.uint8], texture: ToonTexture) -> moderngl.Texture:
    height, width = picture.shape[:2]
    made = device.context.texture((width, height), 4, picture.tobytes(), internal_format=_SRGB8_ALPHA8)
    if texture.nearest:
        made.filter = (moderngl.LINEAR, moderngl.NEAREST)
    else:
        made.build_mipmaps()
        made.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    made.repeat_x, made.repeat_y = texture.wrap
    return made
