"""The circumplex of the authoring window: the wanted point to drag, and what the proposed faces say as ellipses."""

from __future__ import annotations

import numpy as np
from imgui_bundle import imgui
from numpy.typing import NDArray

from game.app.ui import FEELING_COLOURS
from game.core import EMOTIONS
from game.face import Face
from game.tools.face.author import Author
from game.tools.face.pad import Pad, ellipse
from game.tools.face.sheet import rank_colour
from game.tools.windows.style import Fonts, colour

__all__ = ["PadWidget"]

Floats = NDArray[np.float64]


class PadWidget:
    """Draws the pad and turns dragging on it into the author's steps."""

    def __init__(self, author: Author) -> None:
        self._author = author

    def draw(self, x: float, y: float, size: float, k: float, fonts: Fonts, hovered: Face | None) -> None:
        """At (x, y) reference pixels, ``k`` device pixels each; ``hovered``: a face whose Gaussian stands out."""
        author = self._author
        pad = Pad(x * k, y * k, size * k)
        imgui.set_cursor_screen_pos(imgui.ImVec2(pad.x, pad.y))
        imgui.invisible_button("pad", imgui.ImVec2(pad.size, pad.size))
        if imgui.is_item_active():
            mouse = imgui.get_mouse_pos()
            author.drag(*pad.to_point((mouse.x, mouse.y)))
        elif imgui.is_item_deactivated():
            author.drop()
        lines = imgui.get_window_draw_list()
        low, high = imgui.ImVec2(pad.x, pad.y), imgui.ImVec2(pad.x + pad.size, pad.y + pad.size)
        lines.push_clip_rect(low, high, True)
        lines.add_rect_filled(low, high, colour("paper"), 6 * k)
        self._axes(lines, pad, k, fonts)
        for rank, found in reversed(list(enumerate(author.found))):
            tint = imgui.get_color_u32(imgui.ImVec4(*rank_colour(rank)[:3], 0.25 if hovered else 0.75))
            self._outline(lines, pad, found.proposal.mean, found.proposal.covariance, tint, 1.5 * k)
        for slot, kept in enumerate(author.draft.kept):
            if kept is not None:
                self._gaussian(lines, pad, kept, colour("red" if slot == 0 else "blue"), 2.5 * k, "AB"[slot], fonts, k)
        self._gaussian(lines, pad, author.draft.face, colour("ink"), 2.5 * k, "", fonts, k)
        if hovered is not None:
            self._gaussian(lines, pad, hovered, colour("green"), 3.5 * k, "", fonts, k)
        if author.draft.spread > 0.0:
            circle = np.eye(2) * author.draft.spread**2
            self._outline(lines, pad, np.array(author.draft.point), circle, colour("red"), 2.0 * k)
        at = imgui.ImVec2(*pad.to_screen(*author.draft.point))
        for radius, name in ((9.0, "red"), (5.6, "paper"), (3.0, "ink")):
            lines.add_circle_filled(at, radius * k, colour(name))
        lines.pop_clip_rect()
        lines.add_rect(low, high, colour("line"), rounding=6 * k, thickness=2 * k)

    def _axes(self, lines: imgui.ImDrawList, pad: Pad, k: float, fonts: Fonts) -> None:
        middle = imgui.ImVec2(*pad.to_screen(0.0, 0.0))
        soft = colour("faint", 0.5)
        lines.add_circle(middle, pad.size * 0.49, soft, 96, k)
        lines.add_line(imgui.ImVec2(pad.x, middle.y), imgui.ImVec2(pad.x + pad.size, middle.y), soft, k)
        lines.add_line(imgui.ImVec2(middle.x, pad.y), imgui.ImVec2(middle.x, pad.y + pad.size), soft, k)
        imgui.push_font(fonts.body, 17 * k)
        right = imgui.calc_text_size("pleasant").x
        for x, y, text in (
            (pad.x + 6 * k, middle.y + 2 * k, "unpleasant"),
            (pad.x + pad.size - right - 6 * k, middle.y + 2 * k, "pleasant"),
            (middle.x + 5 * k, pad.y + 3 * k, "awake"),
            (middle.x + 5 * k, pad.y + pad.size - 22 * k, "sleepy"),
        ):
            lines.add_text(imgui.ImVec2(x, y), colour("faint"), text)
        for name, place in zip(EMOTIONS, self._author.parts.places, strict=True):
            x, y = pad.to_screen(float(place[0]), float(place[1]))
            tint = imgui.get_color_u32(imgui.ImVec4(*FEELING_COLOURS[name]))
            lines.add_circle_filled(imgui.ImVec2(x, y), 3.5 * k, tint)
            # Fear and anger stand almost on one spot: fear's name goes to the other side.
            shift = -imgui.calc_text_size(name).x - 6 * k if name == "fear" else 6 * k
            lines.add_text(imgui.ImVec2(x + shift, y - 11 * k), tint, name)
        imgui.pop_font()

    def _gaussian(
        self, lines: imgui.ImDrawList, pad: Pad, face: Face, tint: int, width: float, mark: str, fonts: Fonts, k: float
    ) -> None:
        mean, covariance = self._author.gaussian(face)
        self._outline(lines, pad, mean, covariance, tint, width)
        at = imgui.ImVec2(*pad.to_screen(float(mean[0]), float(mean[1])))
        lines.add_circle_filled(at, 3.5 * k, tint)
        if mark:
            imgui.push_font(fonts.bold, 19 * k)
            lines.add_text(imgui.ImVec2(at.x + 5 * k, at.y - 8 * k), tint, mark)
            imgui.pop_font()

    def _outline(
        self, lines: imgui.ImDrawList, pad: Pad, mean: Floats, covariance: Floats, tint: int, width: float
    ) -> None:
        points: list[imgui.ImVec2Like] = [
            imgui.ImVec2(*pad.to_screen(float(v), float(a))) for v, a in ellipse(mean, covariance)
        ]
        lines.add_polyline(points, tint, thickness=width, flags=0)
