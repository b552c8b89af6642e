"""The interface's brush: rounded boxes, lines, circles, pictures and text, batched into a few draw calls.

    hud.begin(size)                        # the renderer does this
    hud.rect(20, 600, 400, 80, fill=rgba("#fff6de"), radius=14, border=2, edge=rgba("#5b2a22"), shadow=10)
    hud.text("How much?", 40, 640, size=28, colour=rgba("#3b1a1c"))
    hud.end()                              # and this

Lengths are **design pixels** of a picture 720 high; ``hud.scale`` device pixels make one of them, and ``hud.width`` ×
``hud.height`` is the room there is (height is always 720). x runs right, y down from the top left corner. Things drawn
later lie on top. Text is drawn at device pixels, so it is crisp at every scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import atan2, hypot

import moderngl
import numpy as np
from numpy.typing import NDArray

from game.render.atlas import LineAtlas, Placed
from game.render.device import PREMULTIPLIED, Device, Owner, layout, set_uniforms
from game.render.text import FontSet

__all__ = ["Colour", "Hud", "rgba"]

Colour = tuple[float, float, float, float]  # display-referred red, green, blue, alpha in 0..1, not premultiplied
DESIGN_HEIGHT = 720.0
_ROOM = 4096  # instances of one flush
_SHAPE_FLOATS = 20  # box, form, fill at the top, fill at the bottom, edge
_SPRITE_FLOATS = 12  # box, piece, tint
_CLEAR: Colour = (0.0, 0.0, 0.0, 0.0)


def rgba(code: str, alpha: float = 1.0) -> Colour:
    """``#rrggbb`` and an alpha in 0..1 -> Colour."""
    return (int(code[1:3], 16) / 255.0, int(code[3:5], 16) / 255.0, int(code[5:7], 16) / 255.0, alpha)


def _pre(colour: Colour) -> tuple[float, float, float, float]:
    r, g, b, a = colour
    return (r * a, g * a, b * a, a)


class Hud(Owner):
    """See the module's text. Without fonts, ``text`` raises RuntimeError; everything else works."""

    def __init__(self, device: Device, fonts: FontSet | None = None) -> None:
        super().__init__()
        self._device, self._context = device, device.context
        context = device.context
        self._fonts = fonts
        self._atlas = self.own(LineAtlas(device, fonts)) if fonts is not None else None
        self.scale = 1.0
        self.width, self.height = DESIGN_HEIGHT * 16.0 / 9.0, DESIGN_HEIGHT
        self._size = (1, 1)
        self._corner = self.own(context.buffer(np.array([-1, -1, 1, -1, -1, 1, 1, 1], dtype=np.float32)))
        self._shapes = self.own(context.buffer(reserve=_ROOM * _SHAPE_FLOATS * 4, dynamic=True))
        self._sprites = self.own(context.buffer(reserve=_ROOM * _SPRITE_FLOATS * 4, dynamic=True))
        vec = "4f/i"
        self._shape_program = self.own(device.program("hud_shape.vert.glsl", "hud_shape.frag.glsl"))
        self._shape_array = self._array(
            self._shape_program, self._shapes, box=vec, form=vec, fill_top=vec, fill_bottom=vec, edge=vec
        )
        self._sprite_programs = [
            self.own(device.program("hud_sprite.vert.glsl", "hud_sprite.frag.glsl", defines={"GLYPHS": glyphs}))
            for glyphs in (0, 1)
        ]
        self._sprite_arrays = [
            self._array(program, self._sprites, box=vec, piece=vec, fill_top=vec) for program in self._sprite_programs
        ]
        self._rows: list[tuple[float, ...]] = []
        self._kind: moderngl.Texture | None = None  # None: shapes, else the texture of the sprites in _rows
        self.draw_calls = 0

    def _array(self, program: moderngl.Program, buffer: moderngl.Buffer, **formats: str) -> moderngl.VertexArray:
        entries = [layout(program, self._corner, corner="2f"), layout(program, buffer, **formats)]
        return self.own(self._device.vertex_array(program, entries))

    # -- the frame ---------------------------------------------------------------------------------------------------

    def begin(self, size: tuple[int, int], ui_scale: float = 1.0) -> None:
        """Start drawing into the bound framebuffer of ``size`` device pixels; ``ui_scale`` enlarges everything."""
        self._size = size
        self.scale = size[1] / DESIGN_HEIGHT * ui_scale
        self.width, self.height = size[0] / self.scale, size[1] / self.scale
        self._rows, self._kind, self.draw_calls = [], None, 0

    def end(self) -> None:
        """Draw what is still waiting."""
        self._flush()

    def _flush(self) -> None:
        if not self._rows:
            return
        context = self._context
        context.enable_only(moderngl.BLEND)
        context.blend_func = PREMULTIPLIED
        data = np.array(self._rows, dtype=np.float32)
        screen = (float(self._size[0]), float(self._size[1]))
        if self._kind is None:
            self._shapes.orphan()
            self._shapes.write(data)
            set_uniforms(self._shape_program, screen=screen)
            self._shape_array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(data))
        else:
            glyphs = int(self._atlas is not None and self._kind is self._atlas.texture)
            self._kind.use(0)
            self._sprites.orphan()
            self._sprites.write(data)
            set_uniforms(self._sprite_programs[glyphs], screen=screen)
            self._sprite_arrays[glyphs].render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(data))
        self._rows = []
        self.draw_calls += 1

    def _add(self, kind: moderngl.Texture | None, row: tuple[float, ...]) -> None:
        if kind is not self._kind or len(self._rows) >= _ROOM:
            self._flush()
            self._kind = kind
        self._rows.append(row)

    # -- shapes ------------------------------------------------------------------------------------------------------

    def rect(
        self,
        x: float,
        y: float,
        width: float,
        height: float,
        *,
        fill: Colour = _CLEAR,
        fill_bottom: Colour | None = None,
        radius: float = 0.0,
        border: float = 0.0,
        edge: Colour = _CLEAR,
        shadow: float = 0.0,
        shadow_colour: Colour = (0.16, 0.07, 0.09, 0.35),
        shadow_offset: tuple[float, float] = (0.0, 4.0),
    ) -> None:
        """A box with rounded corners: from its left top corner, with a vertical gradient, border and soft shadow.

        The border lies inside the box. ``shadow`` is the width of its soft edge, 0 for none.
        """
        if shadow > 0.0:
            self.glow(x + shadow_offset[0], y + shadow_offset[1], width, height, shadow_colour, radius, shadow)
        bottom = fill if fill_bottom is None else fill_bottom
        self._shape(x + width / 2, y + height / 2, width / 2, height / 2, radius, border, 1.0, 0.0, fill, bottom, edge)

    def glow(
        self, x: float, y: float, width: float, height: float, colour: Colour, radius: float = 0.0, soft: float = 12.0
    ) -> None:
        """A box whose edge fades over ``soft`` pixels: shadows, halos, dimmed areas."""
        feather = max(soft * self.scale, 2.0)
        half = (width / 2, height / 2)
        self._shape(x + half[0], y + half[1], *half, radius + soft / 2, 0.0, feather, 0.0, colour, colour, _CLEAR)

    def circle(
        self,
        x: float,
        y: float,
        radius: float,
        *,
        fill: Colour = _CLEAR,
        border: float = 0.0,
        edge: Colour = _CLEAR,
    ) -> None:
        """A disc around (x, y); with ``border`` and no fill, a ring."""
        self._shape(x, y, radius, radius, radius, border, 1.0, 0.0, fill, fill, edge)

    def line(self, x0: float, y0: float, x1: float, y1: float, colour: Colour, width: float = 2.0) -> None:
        """A straight line with round ends."""
        half = hypot(x1 - x0, y1 - y0) / 2 + width / 2
        angle = atan2(y1 - y0, x1 - x0)
        middle = ((x0 + x1) / 2, (y0 + y1) / 2)
        self._shape(*middle, half, width / 2, width / 2, 0.0, 1.0, angle, colour, colour, _CLEAR)

    def polyline(
        self, points: Sequence[tuple[float, float]] | NDArray[np.floating], colour: Colour, width: float = 2.0
    ) -> None:
        """Straight lines from point to point, (n, 2); use an opaque colour, the joints overlap."""
        for (x0, y0), (x1, y1) in pairwise(points):
            self.line(float(x0), float(y0), float(x1), float(y1), colour, width)

    def _shape(
        self,
        x: float,
        y: float,
        half_width: float,
        half_height: float,
        radius: float,
        border: float,
        feather_px: float,
        angle: float,
        fill: Colour,
        fill_bottom: Colour,
        edge: Colour,
    ) -> None:
        s = self.scale
        row = (x * s, y * s, half_width * s, half_height * s, radius * s, border * s, feather_px, angle)
        self._add(None, (*row, *_pre(fill), *_pre(fill_bottom), *_pre(edge)))

    # -- pictures and text -------------------------------------------------------------------------------------------

    def image(
        self,
        texture: moderngl.Texture,
        x: float,
        y: float,
        width: float,
        height: float,
        *,
        piece: tuple[float, float, float, float] = (0.0, 0.0, 1.0, 1.0),
        tint: Colour = (1.0, 1.0, 1.0, 1.0),
    ) -> None:
        """A premultiplied RGBA texture, its first row at the top; ``piece`` = u, v, width, height of the part shown."""
        s = self.scale
        self._add(texture, (x * s, y * s, width * s, height * s, *piece, *_pre(tint)))

    def size_px(self, size: float) -> int:
        """Device pixels of a text size."""
        return max(6, round(size * self.scale))

    def measure(self, text: str, size: float = 24.0, role: str = "body") -> tuple[float, float]:
        """Width and line height of one line in design pixels."""
        fonts, px = self._need_fonts(), self.size_px(size)
        return fonts.width(text, role, px) / self.scale, fonts.height(role, px) / self.scale

    def wrap(self, text: str, width: float, size: float = 24.0, role: str = "body") -> list[str]:
        """The text broken into lines of at most ``width`` design pixels."""
        return self._need_fonts().wrap(text, role, self.size_px(size), width * self.scale)

    def text(
        self,
        text: str,
        x: float,
        y: float,
        *,
        size: float = 24.0,
        colour: Colour = (1.0, 1.0, 1.0, 1.0),
        role: str = "body",
        align: float = 0.0,
        outline: Colour | None = None,
        shown: int | None = None,
    ) -> float:
        """One line of text with its top at y; returns its width.

        ``align`` 0, .5, 1: x is its left end, middle, right end. ``outline`` puts eight copies in that colour behind
        it. ``shown`` draws only that many characters (typing), without moving the others.
        """
        px = self.size_px(size)
        if not text or shown == 0:
            return 0.0
        placed = self._find(text, role, px)
        if placed is None:
            return 0.0
        left, top = round(x * self.scale - align * placed.width), round(y * self.scale)
        width = placed.width
        if shown is not None and shown < len(text):
            width = min(width, self._need_fonts().width(text[:shown], role, px))
        texture, n = self._need_atlas().texture, self._need_atlas().size
        piece = (placed.x / n, placed.y / n, width / n, placed.height / n)
        if outline is not None:
            r = max(1.0, round(1.5 * self.scale))
            for dx, dy in ((-r, 0), (r, 0), (0, -r), (0, r), (-r, -r), (r, -r), (-r, r), (r, r)):
                self._add(texture, (left + dx, top + dy, width, placed.height, *piece, *_pre(outline)))
        self._add(texture, (left, top, width, placed.height, *piece, *_pre(colour)))
        return placed.width / self.scale

    def _find(self, text: str, role: str, px: int) -> Placed | None:
        atlas = self._need_atlas()
        placed = atlas.find(text, role, px)
        if placed is None:  # full: draw what refers to it, then start over
            self._flush()
            atlas.clear()
            placed = atlas.find(text, role, px)
        return placed

    def _need_fonts(self) -> FontSet:
        if self._fonts is None:
            raise RuntimeError("this Hud was made without fonts")
        return self._fonts

    def _need_atlas(self) -> LineAtlas:
        if self._atlas is None:
            raise RuntimeError("this Hud was made without fonts")
        return self._atlas
