"""Drawing on the desk: text in the interface's fonts, boxes, hatching, a colour for every behaviour."""

from __future__ import annotations

import colorsys
from collections.abc import Mapping

from imgui_bundle import imgui

from game.embos.repertoire import Behaviour
from game.tools.windows.style import Fonts, colour

__all__ = ["LAYER_TITLES", "Box", "Pen"]

Box = tuple[float, float, float, float]
"""x, y, width, height in pixels."""
LAYER_TITLES = {"posture": "Postures", "mannerism": "Mannerisms", "gesture": "Gestures"}
_GOLDEN = 0.61803398875
_FIRST_HUE = {"posture": 0.48, "mannerism": 0.72, "gesture": 0.92}


class Pen:
    """Draws in pixels; sizes of text and lines are given for a window 900 pixels high. k: pixels for each of those."""

    def __init__(self, fonts: Fonts, repertoire: Mapping[str, Behaviour]) -> None:
        self.fonts, self.k = fonts, 1.0
        self._hue: dict[str, float] = {}
        self.learn(repertoire)

    def learn(self, repertoire: Mapping[str, Behaviour]) -> None:
        """Give every behaviour its colour."""
        count: dict[str, int] = {}
        for behaviour in repertoire.values():
            number = count[behaviour.layer] = count.get(behaviour.layer, 0) + 1
            self._hue[behaviour.name] = (_FIRST_HUE[behaviour.layer] + number * _GOLDEN) % 1.0

    def hue(self, behaviour: str, saturation: float = 0.42, value: float = 0.93, alpha: float = 1.0) -> int:
        """A behaviour's colour, packed; names outside the repertoire are grey."""
        hue = self._hue.get(behaviour)
        red, green, blue = colorsys.hsv_to_rgb(hue or 0.0, 0.0 if hue is None else saturation, value)
        return int(imgui.color_convert_float4_to_u32(imgui.ImVec4(red, green, blue, alpha)))

    @property
    def lines(self) -> imgui.ImDrawList:
        """The present window's draw list."""
        return imgui.get_window_draw_list()

    def width(self, text: str, size: float = 17.0, *, bold: bool = False) -> float:
        """Pixels a text takes."""
        imgui.push_font(self.fonts.bold if bold else self.fonts.body, size * self.k)
        width = imgui.calc_text_size(text).x
        imgui.pop_font()
        return float(width)

    def text(
        self, x: float, y: float, text: str, name: str = "ink", size: float = 17.0, *, bold: bool = False,
        room: float | None = None,
    ) -> None:  # fmt: skip
        """Text with its top left corner at x, y. room: pixels it may take; it is shortened to fit."""
        if room is not None and self.width(text, size, bold=bold) > room:
            while text and self.width(text + "…", size, bold=bold) > room:
                text = text[:-1]
            if len(text) < 2:
                return
            text += "…"
        imgui.push_font(self.fonts.bold if bold else self.fonts.body, size * self.k)
        self.lines.add_text(imgui.ImVec2(round(x), round(y)), colour(name), text)
        imgui.pop_font()

    def box(self, x: float, y: float, w: float, h: float, tint: int, rounding: float = 0.0) -> None:
        """A filled box."""
        self.lines.add_rect_filled(imgui.ImVec2(x, y), imgui.ImVec2(x + w, y + h), tint, rounding * self.k)

    def frame(
        self, x: float, y: float, w: float, h: float, tint: int, thick: float = 1.0, rounding: float = 0.0
    ) -> None:
        """A box's outline."""
        a, b = imgui.ImVec2(x, y), imgui.ImVec2(x + w, y + h)
        self.lines.add_rect(a, b, tint, rounding * self.k, thick * self.k)

    def line(self, x0: float, y0: float, x1: float, y1: float, tint: int, thick: float = 1.0) -> None:
        """A line."""
        self.lines.add_line(imgui.ImVec2(x0, y0), imgui.ImVec2(x1, y1), tint, thick * self.k)

    def triangle(self, x: float, y: float, size: float, tint: int, *, down: bool) -> None:
        """A small arrow head about a point, pointing down or to the right."""
        s = size * self.k
        if down:
            points = ((x - s, y - 0.6 * s), (x + s, y - 0.6 * s), (x, y + 0.8 * s))
        else:
            points = ((x - 0.6 * s, y - s), (x + 0.8 * s, y), (x - 0.6 * s, y + s))
        a, b, c = (imgui.ImVec2(*p) for p in points)
        self.lines.add_triangle_filled(a, b, c, tint)

    def hatch(self, x: float, y: float, w: float, h: float, tint: int) -> None:
        """Slanting lines all over a box: what nobody has looked at yet."""
        self.lines.push_clip_rect(imgui.ImVec2(x, y), imgui.ImVec2(x + w, y + h), True)
        step = 7.0 * self.k
        at = x - h - (x % step)
        while at < x + w:
            self.line(at, y + h, at + h, y, tint, 1.6)
            at += step
        self.lines.pop_clip_rect()
