"""Contact sheets of proposed faces: drawn on the real head, labelled, with their Gaussians beside them."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from game.app.ui import INK, PALETTE, Canvas, Rect, fade
from game.face import Face, FaceParams, Parts
from game.render import Device, FontSet, Hud
from game.tools.face.heads import HeadStudio
from game.tools.face.pad import Pad
from game.tools.face.wanted import Found, Wanted

__all__ = ["SheetCell", "SheetRow", "draw_grid", "draw_rows", "draw_sheet", "part_names", "rank_colour"]

Pixels = NDArray[np.uint8]
Colour = tuple[float, float, float, float]

HEAD = 232
LABEL = 74
EDGE = 14
_RANKS = ("D8402F", "E0982F", "6B8F3A", "2A7B78", "34608A", "7A5BA8", "C05C8E", "8A6A5C")


def rank_colour(rank: int) -> Colour:
    """A colour that tells the first few apart; the same for a face's number and its ellipse."""
    code = _RANKS[rank % len(_RANKS)]
    return (int(code[0:2], 16) / 255, int(code[2:4], 16) / 255, int(code[4:6], 16) / 255, 1.0)


def part_names(parts: Parts, face: Face) -> list[str]:
    """Labels of the parts of a face that are not the standard ones."""
    names = []
    for region, name in zip(parts.regions, face.parts, strict=True):
        if name != "standard":
            names.append(str(region.labels[region.index(name)].get("en", name)))
    return names or ["standard face"]


@dataclass(frozen=True)
class SheetRow:
    """One wanted emotion with its proposals."""

    wanted: Wanted
    found: Sequence[Found]


@dataclass(frozen=True)
class SheetCell:
    """One expression (K,) with its name and a smaller line under it."""

    params: FaceParams
    name: str
    note: str = ""
    colour: Colour = PALETTE["line"]


class _Sheet:
    """A picture of any size to draw heads, text and boxes into, on the head studio's GL."""

    def __init__(self, studio: HeadStudio, parts: Parts, width: int, height: int) -> None:
        self.parts, self._studio, self._size = parts, studio, (width, height)
        self._heads: dict[Hashable, moderngl.Texture] = {}
        self._device: Device = studio.device
        self._hud = Hud(self._device, FontSet.for_language("en"))

    def load(self, faces: Sequence[Face]) -> None:
        """Draw the heads of faces."""
        self.load_params({face: self.parts.params(self.parts.numbers(face)) for face in faces})

    def load_params(self, wanted: Mapping[Hashable, FaceParams]) -> None:
        """Draw the heads first: the renderer and the sheet do not take turns."""
        for key, params in wanted.items():
            pixels = self._studio.draw(params)
            opaque = np.dstack([pixels, np.full(pixels.shape[:2], 255, np.uint8)])
            texture = self._device.context.texture(pixels.shape[1::-1], 4, np.ascontiguousarray(opaque).tobytes())
            texture.build_mipmaps()
            texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
            self._heads[key] = texture

    def begin(self) -> Canvas:
        self._target = self._device.context.simple_framebuffer(self._size, components=4)
        self._target.use()
        self._target.clear(0.984, 0.955, 0.89, 1.0)
        # One design pixel is one pixel of the sheet.
        self._hud.begin(self._size, 720.0 / self._size[1])
        return Canvas(self._hud)

    def head(self, canvas: Canvas, rect: Rect, face: Hashable, edge: Colour) -> None:
        k = canvas.hud.width / canvas.width
        canvas.panel(Rect(rect.x - 3, rect.y - 3, rect.w + 6, rect.h + 6), edge, radius=6)
        canvas.hud.image(self._heads[face], rect.x * k, rect.y * k, rect.w * k, rect.h * k)

    def finish(self) -> Pixels:
        self._hud.end()
        data = self._target.read(components=4)
        width, height = self._size
        pixels = np.frombuffer(data, np.uint8).reshape(height, width, 4)[::-1, :, :3]
        self._device.nowhere.use()
        for texture in self._heads.values():
            texture.release()
        self._hud.release()
        self._target.release()
        return np.ascontiguousarray(pixels)


def _fit(canvas: Canvas, text: str, width: float, size: float, font: str = "body") -> str:
    """The text, shortened with an ellipsis to a width."""
    if canvas.measure(text, size, font) <= width:
        return text
    while len(text) > 1 and canvas.measure(text + "…", size, font) > width:
        text = text[:-1]
    return text.rstrip(" ,") + "…"


def draw_sheet(
    studio: HeadStudio, parts: Parts, row: SheetRow, *, columns: int = 4, title: str = "", source: str = ""
) -> Pixels:
    """One wanted emotion: its proposals in order beside the circumplex with their Gaussians."""
    columns = max(2, min(columns, len(row.found)))
    lines = -(-len(row.found) // columns)
    pad_size = 420
    width = EDGE * 3 + pad_size + columns * (HEAD + EDGE)
    height = max(56 + lines * (HEAD + LABEL + 8) + EDGE, 56 + pad_size + 34 * 2 + EDGE)
    sheet = _Sheet(studio, parts, width, height)
    sheet.load([f.face for f in row.found])
    canvas = sheet.begin()
    canvas.text(EDGE, 14, title or f"Faces for {row.wanted}", 24, INK, font="bold")
    pad = Pad(EDGE, 56, pad_size)
    pad.draw(canvas, parts.places)
    for rank, found in reversed(list(enumerate(row.found))):
        pad.outline(canvas, found.proposal.mean, found.proposal.covariance, fade(rank_colour(rank), 0.8))
    pad.cross(canvas, *row.wanted.point)
    note = "Ellipses: one standard deviation of each face."
    canvas.text(EDGE, 56 + pad_size + 10, note, 15, PALETTE["faint"])
    canvas.text(EDGE, 56 + pad_size + 32, _fit(canvas, f"Parts: {source}.", pad_size, 15), 15, PALETTE["faint"])
    for rank, found in enumerate(row.found):
        x = EDGE * 2 + pad_size + (rank % columns) * (HEAD + EDGE)
        y = 56 + (rank // columns) * (HEAD + LABEL + 8)
        _cell(sheet, canvas, Rect(x, y, HEAD, HEAD), rank, found)
    return sheet.finish()


def _cell(sheet: _Sheet, canvas: Canvas, rect: Rect, rank: int, found: Found) -> None:
    sheet.head(canvas, rect, found.face, rank_colour(rank))
    canvas.panel(Rect(rect.x + 4, rect.y + 4, 34, 26), rank_colour(rank), radius=8)
    canvas.text(rect.x + 21, rect.y + 5, f"{rank + 1}", 18, PALETTE["white"], font="bold", align="center")
    mean = found.proposal.mean
    numbers = f"({mean[0]:+.2f}, {mean[1]:+.2f})   log p {found.log_density:+.2f}"
    canvas.text(rect.x, rect.y + HEAD + 5, numbers, 15, INK)
    names = part_names(sheet.parts, found.face)
    rows = [" · ".join(names[:2]), " · ".join(names[2:])]
    for i, text in enumerate(rows):
        canvas.text(rect.x, rect.y + HEAD + 25 + i * 19, _fit(canvas, text, rect.w, 15), 15, PALETTE["faint"])


def draw_rows(studio: HeadStudio, parts: Parts, rows: Sequence[SheetRow], *, title: str, head: int = 152) -> Pixels:
    """Many wanted emotions, one row each, with a small circumplex at the left."""
    most = max(len(row.found) for row in rows)
    width = EDGE * 2 + head + 12 + most * (head + 8)
    height = 52 + len(rows) * (head + 40) + EDGE
    sheet = _Sheet(studio, parts, width, height)
    sheet.load([f.face for row in rows for f in row.found])
    canvas = sheet.begin()
    canvas.text(EDGE, 12, title, 24, INK, font="bold")
    for i, row in enumerate(rows):
        y = 54 + i * (head + 40)
        pad = Pad(EDGE, y, head)
        pad.draw(canvas, text=11)
        for rank, found in enumerate(row.found):
            pad.outline(canvas, found.proposal.mean, found.proposal.covariance, fade(rank_colour(rank), 0.6), 1.1)
        pad.cross(canvas, *row.wanted.point, radius=6)
        canvas.text(EDGE, y + head + 5, str(row.wanted), 13, INK, font="bold")
        for rank, found in enumerate(row.found):
            x = EDGE + head + 16 + rank * (head + 8)
            sheet.head(canvas, Rect(x, y, head, head), found.face, fade(PALETTE["line"], 0.6))
            mean = found.proposal.mean
            text = f"{rank + 1}  ({mean[0]:+.2f}, {mean[1]:+.2f})  {found.log_density:+.1f}"
            canvas.text(x, y + head + 5, text, 13, INK)
    return sheet.finish()


def draw_grid(
    studio: HeadStudio, parts: Parts, rows: Sequence[Sequence[SheetCell]], *, title: str, width: int = 1280
) -> Pixels:
    """Rows of expressions, as wide as ``width`` and as high as they need; wide rows make small heads."""
    columns = max(len(row) for row in rows)
    head = min((width - EDGE) // columns - EDGE, 300)
    step = head + 58
    sheet = _Sheet(studio, parts, width, 54 + len(rows) * step + EDGE)
    sheet.load_params({(i, j): cell.params for i, row in enumerate(rows) for j, cell in enumerate(row)})
    canvas = sheet.begin()
    canvas.text(EDGE, 12, title, 24, INK, font="bold")
    left = (width - columns * (head + EDGE) + EDGE) / 2
    for i, row in enumerate(rows):
        for j, cell in enumerate(row):
            x, y = left + j * (head + EDGE), 56 + i * step
            sheet.head(canvas, Rect(x, y, head, head), (i, j), cell.colour)
            canvas.text(x, y + head + 5, _fit(canvas, cell.name, head, 18, "bold"), 18, INK, font="bold")
            canvas.text(x, y + head + 28, _fit(canvas, cell.note, head, 14), 14, PALETTE["faint"])
    return sheet.finish()
