"""The frame graph: bake what stands still, restore the picture, skin once, draw the person, interface on top."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from game.face.mesh import DrawList
from game.render.avatar_drawing import AvatarDrawing
from game.render.avatar_model import AvatarModel
from game.render.character_drawing import CharacterDrawing
from game.render.crowd import CrowdLook
from game.render.crowd_drawing import CrowdDrawing
from game.render.daylight import DESIGN_SHARE, stepped
from game.render.device import PREMULTIPLIED, Device, Owner
from game.render.face_painter import FACE_MM, FacePainter, hidden_face
from game.render.frame_times import FrameTimes
from game.render.hud import Hud
from game.render.item_drawing import ItemDrawing, ItemView
from game.render.levels import DEFAULT, Level
from game.render.lighting import STUDIO_LIGHT, TABLE_LIGHT, FrameBlock, LightBox, Lights
from game.render.model import CharacterModel, StaticMesh
from game.render.mood import MARKET_MOOD
from game.render.motes import Motes
from game.render.moving_drawing import MovingDrawing
from game.render.output import Output
from game.render.scene_drawing import BakeKey, SceneDrawing, backdrop_place
from game.render.silhouette import scene_cells
from game.render.sky import Sky
from game.render.targets import Box, FrameTargets
from game.render.text import FontSet
from game.render.view import FrameView

__all__ = ["Renderer"]

_Drawing = CharacterDrawing | AvatarDrawing

_STALE_S = 0.1  # a shadow map older than this is drawn anew
_FACE_AT = (0.0, 1.2, 0.1)  # about where the face is, m


@dataclass
class _Canvas:
    """The pictures of one size, and what is in them."""

    targets: FrameTargets
    baked: BakeKey | None = None
    is_draft: bool = False
    cells: NDArray[np.float32] | None = None  # what of a person the baked picture hides
    seen: BakeKey | None = None  # of the last frame
    turning: bool = False  # the camera moved between the last two frames
    item: tuple[object, ...] = ()  # what is baked in the place of the stall


class Renderer(Owner):
    """Draws FrameViews of one person at one stall.

    ``model`` and ``stall`` may be None where nobody, or nothing, is to be drawn (menus, the bench's floor).
    ``backdrop`` is (h, w, 3) uint8, first row at the top. ``level`` may be changed between frames (``set_level``).
    """

    def __init__(
        self,
        device: Device,
        model: CharacterModel | AvatarModel | None,
        stall: StaticMesh | None = None,
        backdrop: NDArray[np.uint8] | None = None,
        level: Level = DEFAULT,
        fonts: FontSet | None = None,
    ) -> None:
        super().__init__()
        self.device = device
        self._model = model
        self._scene = self.own(SceneDrawing(device, stall, backdrop))
        self._frame = self.own(FrameBlock(device))
        self._mood = MARKET_MOOD if stall is None else stall.mood
        self._lights = Lights.market(mood=self._mood)
        self._motes = self.own(Motes(device))
        self.hud = self.own(Hud(device, fonts))
        self._hidden_face = hidden_face()
        self._face: DrawList | None = None
        self._canvas: _Canvas | None = None
        self._character: _Drawing | None = None
        self._painter: FacePainter | None = None
        self._moving: MovingDrawing | None = None
        self._crowd: CrowdDrawing | None = None
        self._sky: Sky | None = None
        self._moving_meshes = stall.moving if stall is not None else ()
        self._stall, self._backdrop = stall, backdrop
        self._item: ItemDrawing | None = None
        self._item_seen: ItemView | None = None
        # In a window, a camera that keeps moving is drawn with fewer samples; single pictures are always finished.
        self.drafts = device.windowed
        self._frames = 0
        self._light: LightBox | None = None  # for which the shadow map was drawn …
        self._cast_s = 0.0  # … and when
        self._shown: moderngl.Framebuffer | None = None
        self.times = FrameTimes(device)
        self.scale = 1.0  # share of the picture's sides at which the scene is drawn; the interface never is smaller
        self._output = self.own(Output(device))
        self.level = level
        self.set_level(level)

    def set_stage(
        self,
        model: CharacterModel | AvatarModel | None,
        stall: StaticMesh | None,
        backdrop: NDArray[np.uint8] | None,
    ) -> None:
        """Draw another person at another stall from the next frame on; interface and fonts stay."""
        self._drop_level()
        self._drop_item()
        self._owned.remove(self._scene)
        self._scene.release()
        self._scene = self.own(SceneDrawing(self.device, stall, backdrop))
        self._model, self._face = model, None
        self._stall, self._backdrop = stall, backdrop
        self._moving_meshes = stall.moving if stall is not None else ()
        self._mood = MARKET_MOOD if stall is None else stall.mood
        self._lights = Lights.market(self._lights.day.share, self._mood)
        self.set_level(self.level)

    def set_level(self, level: Level) -> None:
        """Change the quality; the next frame uses it."""
        self._drop_level()
        self.level = level
        if isinstance(self._model, AvatarModel):
            self._character = AvatarDrawing(self.device, self._model, level)
            self._painter = FacePainter(self.device, level.face_size)
        elif self._model is not None:
            self._character = CharacterDrawing(self.device, self._model, level)
            self._painter = FacePainter(self.device, level.face_size)
        if level.clouds and self._backdrop is not None:
            self._sky = Sky(self.device, self._backdrop)
        if self._moving_meshes:
            self._moving = MovingDrawing(self.device, self._moving_meshes, level)

    def set_scale(self, scale: float) -> None:
        """Draw the scene at a share of the picture's sides, from the next frame on."""
        if scale != self.scale:
            self.scale = scale
            self._drop_canvas()

    def _drop_canvas(self) -> None:
        if self._canvas is not None:
            self.device.nowhere.use()
            self._canvas.targets.release()
        self._canvas = self._shown = None

    def _drop_level(self) -> None:
        self.device.nowhere.use()
        self._drop_canvas()
        for part in (self._character, self._painter, self._moving, self._sky):
            if part is not None:
                part.release()
        self._character = self._painter = self._moving = self._sky = None
        self._light = None

    def meet(self, looks: Sequence[CrowdLook]) -> None:
        """Passers-by from now on: a frame's ``crowd`` has their matrices, in this order."""
        if self._crowd is not None:
            self._crowd.release()
        self._crowd = CrowdDrawing(self.device, looks) if looks else None

    def _drop_item(self) -> None:
        if self._item is not None:
            self._item.release()
        self._item = None

    def release(self) -> None:
        self.meet(())
        self._drop_item()
        self._drop_level()
        super().release()

    def draw(self, view: FrameView) -> None:
        """Draw one frame at the device's size, into its window or, without one, to be read back."""
        self.device.ensure_alive()
        size = self.device.size
        self.times.next_frame()
        if self._canvas is None or self._canvas.targets.full != size:
            self._drop_canvas()
            self._canvas = self._make_canvas(size, self.scale)
        self._shown = self._draw(view, self._canvas, self.device.context.screen if self.device.windowed else None)

    def snapshot(self, view: FrameView, size: tuple[int, int]) -> NDArray[np.uint8]:
        """Draw one picture of any size beside the running frames: (height, width, 3) uint8, first row at the top."""
        self.device.ensure_alive()
        canvas = self._make_canvas(size)
        self._light = None
        try:
            return _pixels(self._draw(view, canvas, None), size)
        finally:
            self._light = None
            self.device.nowhere.use()
            canvas.targets.release()

    def read_pixels(self) -> NDArray[np.uint8]:
        """The last frame as (height, width, 3) uint8, first row at the top."""
        if self._shown is None:
            raise RuntimeError("nothing has been drawn yet")
        self.device.ensure_alive()
        pixels = _pixels(self._shown, self.device.size)
        if self.device.windowed:
            _ = self.device.context.error  # moderngl asks the window for an attachment, which GL minds but obeys
        return pixels

    def _make_canvas(self, size: tuple[int, int], scale: float = 1.0) -> _Canvas:
        return _Canvas(FrameTargets(self.device, size, min(self.level.samples, self.device.max_samples), scale))

    def _draw(self, view: FrameView, canvas: _Canvas, window: moderngl.Framebuffer | None) -> moderngl.Framebuffer:
        """Draw a frame into the canvas and, if given, the window; returns where it can be read."""
        if view.item is not None and self._stall is not None:
            return self._draw_item(view.item, view, canvas, window)
        targets = canvas.targets
        canvas.item = ()
        day_share = stepped(view.day_share) if view.show_stall else DESIGN_SHARE
        key = BakeKey(view.camera, targets.size, view.show_stall, view.hidden_items, day_share, view.near)
        self._light_up(day_share)
        with self.times.measured("bake"):
            self._bake(key, canvas)
        box = self._prepare(view, targets, canvas.cells)
        # A whole copy costs a software rasteriser less than one cut to a box: it is a plain move of memory. All that is
        # drawn elsewhere was drawn before it: going back to a picture begun costs it the whole picture once more.
        targets.work.use()
        self.device.context.copy_framebuffer(targets.work, targets.bake.still)
        if view.show_stall:
            self._draw_life(view, targets)
        if box is not None and self._character is not None and self._painter is not None:
            with self.times.measured("person"):
                self._draw_character(view, self._character, self._painter, targets, box)
        self._frames += 1
        return self._show(view, targets, window)

    def _draw_item(
        self, item: ItemView, view: FrameView, canvas: _Canvas, window: moderngl.Framebuffer | None
    ) -> moderngl.Framebuffer:
        """One item of the stall, large, in the place of the scene."""
        assert self._stall is not None
        if self._item is None or self._item.group != item.group:
            self._drop_item()
            self._item = ItemDrawing(self.device, self._stall, item, self._backdrop)
        self._light_up(stepped(view.day_share))
        targets = canvas.targets
        draft = self.drafts and self._item_seen is not None and item != self._item_seen
        wanted = (item, self._lights.day.share, draft)
        if canvas.item not in {wanted, (*wanted[:2], False)}:
            self._item.draw(item, targets.size, targets.bake, self.level.line_px, self._lights, draft=draft)
            canvas.item = wanted
        canvas.baked, self._item_seen = None, item
        targets.work.use()
        self.device.context.copy_framebuffer(targets.work, targets.bake.still)
        self._frames += 1
        return self._show(view, targets, window)

    def _light_up(self, day_share: float) -> None:
        if self._lights.day.share != day_share:
            self._lights = Lights.market(day_share, self._mood)
            self._light = None

    def _bake(self, key: BakeKey, canvas: _Canvas) -> None:
        """See that the baked picture fits."""
        turned = canvas.seen is not None and key.camera != canvas.seen.camera
        # The very first picture is a draft too: it is there sooner, and the next one is whole.
        draft = self.drafts and (self._frames == 0 or (turned and canvas.turning))
        canvas.turning, canvas.seen = turned, key
        if key == canvas.baked and (draft or not canvas.is_draft):
            return
        self._scene.bake(key, canvas.targets.bake, self.level.line_px, self._lights, draft=draft)
        canvas.baked, canvas.is_draft, canvas.cells = key, draft, None
        if self.device.software and not draft and isinstance(self._character, CharacterDrawing):
            (width, height), depth = key.size, canvas.targets.bake.still.depth_attachment
            assert isinstance(depth, moderngl.Texture)
            pixels = np.frombuffer(depth.read(), np.float32).reshape(height, width)
            canvas.cells = scene_cells(pixels, key.camera.projection(width / height))

    def _prepare(self, view: FrameView, targets: FrameTargets, cells: NDArray[np.float32] | None) -> Box | None:
        """Everything that is drawn or skinned aside: passers-by, face, meshes, the shadow map.

        cells: what of the person the scene hides. Returns the box of the picture that the person covers, None where
        there is nobody.
        """
        light = TABLE_LIGHT if view.show_stall else STUDIO_LIGHT
        world_to_clip = self._frame.write(view.camera, self._lights, light, targets.size, self.level.line_px)
        if self._crowd is not None and self._crowd_shown(view) and view.crowd is not None:
            with self.times.measured("crowd"):
                eye, day = np.array(view.camera.eye), self._lights.day
                self._crowd.prepare(view.crowd, targets.size, eye, world_to_clip, day, self.level.people)
        character, painter = self._character, self._painter
        if character is not None and painter is not None:
            with self.times.measured("face"):
                self._paint_face(view, painter, targets.size)
        with self.times.measured("skin"):
            if self._moving is not None and view.show_stall:
                self._moving.pose(view.time_s, world_to_clip, targets.size)
            if character is None or painter is None:
                return None
            if isinstance(character, AvatarDrawing):
                if view.look is not None:
                    character.look(view.look)
            else:
                character.stand_behind(cells)
            # Frames far apart, as those of a film strip, have each a shadow of their own.
            late = not 0.0 <= view.time_s - self._cast_s <= _STALE_S
            cast = late or self._frames % self.level.shadow_every == 0 or self._light is not light
            self._light = light
            self._cast_s = view.time_s if cast else self._cast_s
            return character.pose(view.skin_matrices, world_to_clip, targets.size, whole=not view.show_stall, cast=cast)

    def _crowd_shown(self, view: FrameView) -> bool:
        return self._crowd is not None and view.crowd is not None and view.show_stall and self.level.people > 0

    def _draw_life(self, view: FrameView, targets: FrameTargets) -> None:
        """Clouds, passers-by and what sways."""
        crowd = self._crowd if self._crowd_shown(view) else None
        with self.times.measured("life"):
            if self._sky is not None:
                place = backdrop_place(view.camera, targets.size[0] / targets.size[1])
                self._sky.draw(targets.work, place, view.time_s, self._lights.day)
            if crowd is not None:
                crowd.lay(targets.work)
            if self._moving is not None:
                self._moving.draw(targets.work)
                self._moving.draw_halos(targets.work, self._lights.day.lamps)

    def _paint_face(self, view: FrameView, painter: FacePainter, size: tuple[int, int]) -> None:
        tan_half = view.camera.tan_half_height(size[0] / size[1])
        painter.fit(FACE_MM * 1e-3 / (2.0 * tan_half * view.camera.distance_m(_FACE_AT)) * size[1])
        if view.face is not None:
            self._face = view.face
        if not view.show_face:
            painter.paint(self._hidden_face)
        elif self._face is not None:
            painter.paint(self._face)

    def _draw_character(
        self, view: FrameView, character: _Drawing, painter: FacePainter, targets: FrameTargets, box: Box
    ) -> None:
        targets.work.use()
        if targets.person is None or targets.bake.behind is None:
            character.draw(painter.under)
            self._draw_shadow_on_table(view, character, targets)
            character.draw_over(painter.over)
            return
        # Samples are for the person alone, whose edges move: the scene behind was drawn with samples when it was baked,
        # and all else has soft edges of its own. That spares a whole picture of samples every frame.
        self._draw_shadow_on_table(view, character, targets)
        targets.person.use()
        self.device.context.copy_framebuffer(targets.person, targets.bake.behind)
        character.draw(painter.under)
        character.draw_over(painter.over)
        self._output.lay(targets, box)

    def _draw_shadow_on_table(self, view: FrameView, character: _Drawing, targets: FrameTargets) -> None:
        context = self.device.context
        context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        context.blend_func = PREMULTIPLIED
        targets.work.depth_mask = False
        assert character.shadow_map is not None, "a person casts a shadow"
        character.shadow_map.use(1)
        targets.bake.dark.texture.use(3)
        receiver = self._scene.receiver(view.show_stall, self.level.shadow_taps, self.level.shadow_size)
        receiver.render(moderngl.TRIANGLE_STRIP)
        targets.work.depth_mask = True

    def _show(
        self, view: FrameView, targets: FrameTargets, window: moderngl.Framebuffer | None
    ) -> moderngl.Framebuffer:
        with self.times.measured("output"):
            picture = self._output.finish(targets, window)
            picture.use()
            if view.show_stall and view.item is None:
                self._motes.draw(view.time_s, targets.full[0] / targets.full[1])
        if view.hud is not None:
            with self.times.measured("interface"):
                self.hud.begin(targets.full)
                view.hud(self.hud)
                self.hud.end()
        return picture


def _pixels(source: moderngl.Framebuffer, size: tuple[int, int]) -> NDArray[np.uint8]:
    width, height = size
    data = source.read(viewport=(0, 0, width, height), components=4)  # RGBA reads faster than RGB
    return np.ascontiguousarray(np.frombuffer(data, np.uint8).reshape(height, width, 4)[::-1, :, :3])
