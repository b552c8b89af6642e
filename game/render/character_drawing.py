"""One person on the GPU: skinned once per frame into buffers that shading, outline and overlay share."""

from __future__ import annotations

from itertools import accumulate

import moderngl
import numpy as np
from numpy.typing import NDArray

from game.face import DEFAULT_STYLE
from game.render.device import PREMULTIPLIED, Device, Owner, layout, set_uniforms
from game.render.face_planes import face_planes
from game.render.levels import Level
from game.render.model import MAX_JOINTS, CharacterMesh, CharacterModel, Run, ShadowMesh
from game.render.silhouette import SightFinder
from game.render.weave import weave_tiles

__all__ = ["CharacterDrawing"]

_Draw = tuple[moderngl.VertexArray, int, int]  # what to draw with: first corner, number of corners

_CLASSES = {"hair": "HAIR", "face": "FACE", "skin": "SKIN", "gloss": "GLOSS", "woven": "WOVEN", "cloth": "", "flat": ""}
_LINE_REACH = 1.4  # outlines are so many times wider where they are widest, with their feather
_MARGIN_PX = 6  # outline, feather and rounding outside the mesh's own box


class CharacterDrawing(Owner):
    """Buffers and programs of one person at one quality level.

    lamps: the first of a vertex's extras is how much it glows when the lamps are on.

    Per frame: ``pose`` (joint matrices, shadow map), ``draw`` (colour), ``draw_over`` (brows over the hair).
    The Frame block must be bound; the face texture is given to the draw calls.
    """

    def __init__(self, device: Device, model: CharacterModel, level: Level, *, lamps: bool = False) -> None:
        super().__init__()
        self._context, self._nowhere = device.context, device.nowhere
        self._mesh = mesh = model.mesh(level.triangles)
        self._joints = self.own(device.context.buffer(reserve=MAX_JOINTS * 48, dynamic=True))
        self._sight = (
            SightFinder(len(mesh.position), mesh.triangle, [run.first // 3 for run in mesh.runs], mesh.edges)
            if device.software
            else None
        )
        # What moves beside the person is too small to hide anything of itself.
        self._hides, self._line_px, self._size = not lamps, level.line_px, device.size
        self._whole = True
        self._make_skinning(device, mesh, level if model.shadow is not None else None)
        self._make_drawing(device, mesh, level, lamps)
        self._make_surfaces(device, model, level)
        self._make_outline(device, mesh)
        self._make_over(device, mesh)
        self.shadow_map: moderngl.Texture | None = None
        if model.shadow is not None:
            self._make_shadow(device, model.shadow, level)

    def _buffer(self, array: NDArray[np.generic]) -> moderngl.Buffer:
        return self.own(self._context.buffer(np.ascontiguousarray(array)))

    def _make_skinning(self, device: Device, mesh: CharacterMesh, level: Level | None) -> None:
        count = len(mesh.position)
        program = self.own(
            device.program(
                "skin.vert.glsl",
                varyings=["clip", "terms", "sun", "line"],
                defines={"CAST_SIZE": 0 if level is None else level.shadow_size},
            )
        )
        set_uniforms(program, shadow_map=1)
        place = self._buffer(np.hstack([mesh.position, mesh.normal, mesh.outline[:, None]]).astype(np.float32))
        bones = self._buffer(np.hstack([mesh.joint, mesh.weight]))
        self._skinning = self.own(
            device.vertex_array(
                program,
                [
                    layout(program, place, position="3f", normal="3f", outline="1f"),
                    layout(program, bones, joint="4u1", weight="4f1"),
                ],
            )
        )
        self._captured = [self.own(device.context.buffer(reserve=count * size)) for size in (16, 16, 8, 16)]

    def _make_drawing(self, device: Device, mesh: CharacterMesh, level: Level, lamps: bool) -> None:
        clip, terms, sun, _ = self._captured
        self._palette = self._buffer(mesh.palette)
        self._extra = self._buffer(mesh.extra)
        self._index = self.own(device.context.buffer(np.ascontiguousarray(mesh.triangle), dynamic=True))
        self._draws: list[tuple[moderngl.VertexArray, Run]] = []
        self._faces: list[moderngl.Program] = []
        for run in mesh.runs:
            kind = _CLASSES[run.kind] if level.weaves or run.kind != "woven" else ""
            flags = {name: int(kind == name) for name in ("SKIN", "FACE", "HAIR", "GLOSS", "WOVEN")}
            flags["LAMP"] = int(lamps)
            program = self.own(
                device.program(
                    "character.vert.glsl",
                    "character.frag.glsl",
                    defines=flags,
                )
            )
            set_uniforms(program, face_texture=2, weaves=7, planes=8)
            if run.kind == "face":
                self._faces.append(program)
            array = self.own(
                device.vertex_array(
                    program,
                    [
                        layout(program, clip, clip="4f"),
                        layout(program, terms, terms="4f"),
                        layout(program, sun, sun="2f"),
                        layout(program, self._palette, lit="3f1", shade="3f1", deep="3f1", _="3x"),
                        layout(program, self._extra, extra="4f"),
                    ],
                    self._index,
                )
            )
            self._draws.append((array, run))

    def _make_surfaces(self, device: Device, model: CharacterModel, level: Level) -> None:
        """What the shaders look up: the face's planes, the motifs of patterned cloth."""
        self._head = model.head
        self._planes: moderngl.Texture | None = None
        self._weaves: moderngl.TextureArray | None = None
        if self._faces:
            planes = face_planes(DEFAULT_STYLE) if model.planes is None else model.planes
            self._planes = self.own(device.context.texture(planes.shape[::-1], 1, planes.tobytes(), alignment=1))
            self._planes.repeat_x = self._planes.repeat_y = False
        woven = [run for run in self._mesh.runs if run.kind == "woven"]
        if level.weaves and woven:
            corners = [self._mesh.triangle.reshape(-1)[r.first : r.first + r.count] for r in woven]
            tiles = weave_tiles(set(np.unique(self._mesh.extra[np.concatenate(corners), 2]).astype(int).tolist()))
            self._weaves = self.own(
                device.context.texture_array((*tiles.shape[:0:-1], len(tiles)), 1, tiles.tobytes(), alignment=1)
            )

    def _make_outline(self, device: Device, mesh: CharacterMesh) -> None:
        clip, _, _, line = self._captured
        program = self.own(device.program("outline.vert.glsl", "outline.frag.glsl", "outline.geom.glsl"))
        self._edges = self.own(device.context.buffer(np.ascontiguousarray(mesh.edges.adjacency), dynamic=True))
        self._outline = self.own(
            device.vertex_array(
                program,
                [
                    layout(program, clip, clip="4f"),
                    layout(program, line, line="4f"),
                    layout(program, self._palette, _a="3x", _b="3x", deep="3f1", _c="3x"),
                ],
                self._edges,
            )
        )

    def _make_over(self, device: Device, mesh: CharacterMesh) -> None:
        """Only the triangles of the face that can carry brows, lashes, vein and sweat."""
        kept = []
        for run in mesh.runs:
            if run.kind == "face":
                triangle = mesh.triangle.reshape(-1)[run.first : run.first + run.count].reshape(-1, 3)
                u, v, share = (mesh.extra[triangle, i] for i in range(3))
                kept.append(triangle[((u > 0) & (u < 1) & (v > 0) & (v < 0.66) & (share > 0)).all(axis=1)])
        triangle = np.concatenate(kept) if kept else np.zeros((0, 3), np.int32)
        self._over: moderngl.VertexArray | None = None
        if len(triangle):
            program = self.own(device.program("over.vert.glsl", "over.frag.glsl"))
            set_uniforms(program, face_texture=2)
            self._over = self.own(
                device.vertex_array(
                    program,
                    [
                        layout(program, self._captured[0], clip="4f"),
                        layout(program, self._extra, extra="4f"),
                    ],
                    self._buffer(triangle),
                )
            )

    def _make_shadow(self, device: Device, mesh: ShadowMesh, level: Level) -> None:
        context = device.context
        self._shadow_triangles, self._shadow_above = len(mesh.triangle), mesh.above
        program = self.own(device.program("shadow_character.vert.glsl", "empty.frag.glsl"))
        place = self._buffer(np.hstack([mesh.position, mesh.push[:, None]]).astype(np.float32))
        bones = self._buffer(np.hstack([mesh.joint, mesh.weight]))
        self._caster = self.own(
            device.vertex_array(
                program,
                [
                    layout(program, place, position="3f", push="1f"),
                    layout(program, bones, joint="4u1", weight="4f1"),
                ],
                self._buffer(mesh.triangle),
            )
        )
        self.shadow_map = self.own(context.depth_texture((level.shadow_size, level.shadow_size)))
        self.shadow_map.compare_func = "<="
        self.shadow_map.repeat_x = self.shadow_map.repeat_y = False
        self._shadow_target = self.own(context.framebuffer([], self.shadow_map))

    def pose(
        self,
        skin_matrices: NDArray[np.float32],
        world_to_clip: NDArray[np.float64],
        size: tuple[int, int],
        *,
        whole: bool = True,
        cast: bool = True,
    ) -> tuple[int, int, int, int]:
        """Draw the shadow map, if ``cast``, and skin the mesh; without legs unless ``whole``. skin_matrices (j, 4, 4).

        Returns the picture box (x, y, width, height) that encloses the mesh.
        """
        self._whole, self._size = whole, size
        rows = np.ascontiguousarray(skin_matrices[:, :3, :], dtype=np.float32)
        self._joints.write(rows)
        self._joints.bind_to_uniform_block(1)
        for program in self._faces:
            set_uniforms(program, head_left=skin_matrices[self._head, :3, 0])
        if self.shadow_map is not None:
            if cast:
                self._cast()
            self.shadow_map.use(1)
        self._nowhere.use()
        count = len(self._mesh.position) if whole else self._mesh.above.vertices
        self._skinning.transform(self._captured, moderngl.POINTS, vertices=count)
        return self._screen_box(rows, world_to_clip, size)

    def stand_behind(self, scene: NDArray[np.float32] | None) -> None:
        """Leave out what the scene hides (``scene_cells``), where the CPU looks for what is seen."""
        if self._sight is not None:
            self._sight.stand_behind(scene)

    def _screen_box(
        self, rows: NDArray[np.float32], world_to_clip: NDArray[np.float64], size: tuple[int, int]
    ) -> tuple[int, int, int, int]:
        corners = self._mesh.joint_box
        count = min(len(corners), len(rows))
        world = np.einsum("jrc,jkc->jkr", rows[:count, :, :3], corners[:count]) + rows[:count, None, :, 3]
        clip = world.reshape(-1, 3) @ world_to_clip[:, :3].T + world_to_clip[:, 3]
        if (clip[:, 3] < 0.05).any():  # something is beside or behind the eye
            return (0, 0, *size)
        pixels = (clip[:, :2] / clip[:, 3:4] * 0.5 + 0.5) * size
        low = np.clip(np.floor(pixels.min(axis=0)).astype(int) - _MARGIN_PX, 0, size)
        high = np.clip(np.ceil(pixels.max(axis=0)).astype(int) + _MARGIN_PX, 0, size)
        return (int(low[0]), int(low[1]), int(high[0] - low[0]), int(high[1] - low[1]))

    def _cast(self) -> None:
        """Draw the shadow map: back faces only, so that the coarse mesh does not speckle the fine one."""
        context = self._context
        self._shadow_target.use()
        self._shadow_target.clear(depth=1.0)
        context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        context.depth_func = "<"
        context.cull_face = "front"
        self._caster.render(vertices=3 * (self._shadow_triangles if self._whole else self._shadow_above))
        context.cull_face = "back"

    def draw(self, face: moderngl.Texture | None = None) -> None:
        """Shade and outline into the bound framebuffer; ``face`` for meshes that have one."""
        context = self._context
        context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        context.depth_func = "<"
        if face is not None:
            face.use(2)
        if self._planes is not None:
            self._planes.use(8)
        if self._weaves is not None:
            self._weaves.use(7)
        runs = [(array, run.first, run.count) for array, run in self._draws if self._whole or run.group == "above"]
        corners = 4 * (len(self._mesh.edges.adjacency) if self._whole else self._mesh.above.edges)
        if self._sight is not None:
            runs, corners = self._select(runs, self._sight)
        for array, first, count in runs:
            if count:
                array.render(vertices=count, first=first)
        if corners:
            context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
            context.blend_func = PREMULTIPLIED
            context.fbo.depth_mask = False
            self._outline.render(moderngl.LINES_ADJACENCY, vertices=corners)
            context.fbo.depth_mask = True

    def _select(self, runs: list[_Draw], finder: SightFinder) -> tuple[list[_Draw], int]:
        """Write what is seen of this pose to the index buffers; returns what to draw of them."""
        mesh, above = self._mesh, self._mesh.above
        vertices, triangles, edges = (
            (len(mesh.position), len(mesh.triangle), len(mesh.edges.adjacency))
            if self._whole
            else (above.vertices, above.triangles, above.edges)
        )
        self._captured[0].read_into(finder.clip, vertices * 16)
        line_px = _LINE_REACH * self._line_px * self._size[1] / 720.0 + 1.0
        sight = finder.look(vertices, triangles, edges, len(runs), self._size if self._hides else None, line_px)
        self._index.write(sight.triangle)
        if len(sight.line):
            self._edges.write(sight.line)
        counts = [3 * count for count in sight.counts]
        firsts = accumulate(counts[:-1], initial=0)
        shown = zip(runs, firsts, counts, strict=True)
        return [(array, first, count) for (array, _, _), first, count in shown], sight.line.size

    def draw_over(self, face_over: moderngl.Texture) -> None:
        """Draw the second face layer over the hair."""
        if self._over is None:
            return
        context = self._context
        context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE | moderngl.BLEND)
        context.blend_func = PREMULTIPLIED
        context.fbo.depth_mask = False
        face_over.use(2)
        self._over.render()
        context.fbo.depth_mask = True
