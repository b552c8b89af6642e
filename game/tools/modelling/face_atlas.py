"""A picture of every VRM expression for programs that cannot draw the vector face.

The game paints the face anew each frame (game.face); a VRM viewer shows this atlas instead, one cell per preset
expression, chosen by VRM's texture-transform binds. Cells are 340 mm square, as the face projection.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from game.face import FaceStyle, face_params, tessellate
from game.tools.modelling.fields import Floats
from game.tools.modelling.gltf import srgb

__all__ = ["COLUMNS", "EXPRESSIONS", "ROWS", "cell_of", "paint_atlas"]

COLUMNS, ROWS = 5, 4
_CELL_PX = 256
_OVERSAMPLE = 2
_LEFT_MM, _TOP_MM, _EDGE_MM = -170.0, 140.0, 340.0

_SMILE = {"mouth_width": 36.0, "mouth_corner": 9.0}
_TALK = {"mouth_corner": 3.0, "tongue": 1.0}

EXPRESSIONS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "neutral": {},
        "happy": _SMILE
        | {"eye_open": 0.0, "eye_arc": 1.0, "mouth_open": 36.0, "teeth": 1.0, "tongue": 1.0}
        | {"blush": 0.95, "blush_lines": 1.0, "brow_raise": 7.0, "brow_curve": 1.5},
        "angry": {"eye_open": 0.8, "eye_slant": 0.85, "eye_flat": 0.5, "iris_size": 0.86, "pupil_size": 0.8}
        | {"brow_raise": -10.0, "brow_angle": 20.0, "brow_curve": 0.35, "brow_thick": 1.3, "brow_knit": 1.0}
        | {"mouth_width": 30.0, "mouth_corner": -9.0, "mouth_open": 20.0, "teeth_clench": 1.0, "red": 0.8, "vein": 1.0},
        "sad": {"eye_open": 0.72, "eye_slant": -0.75, "look_y": -0.5, "tear_well": 1.0, "tear": 1.0, "highlight": 1.25}
        | {"brow_raise": 3.0, "brow_angle": -19.0, "brow_curve": -0.3, "mouth_width": 18.0, "mouth_corner": -9.0},
        "relaxed": {"eye_open": 0.0, "eye_arc": -0.8, "mouth_corner": 8.0, "blush": 0.5, "brow_raise": 3.0},
        "surprised": {"eye_open": 1.16, "iris_size": 0.8, "pupil_size": 0.75, "brow_raise": 19.0, "brow_curve": 1.5}
        | {"mouth_width": 16.0, "mouth_corner": 0.0, "mouth_open": 36.0, "mouth_top": 11.0},
        "aa": _TALK | {"mouth_width": 27.0, "mouth_open": 34.0, "teeth": 0.6},
        "ih": _TALK | {"mouth_width": 30.0, "mouth_open": 12.0, "teeth": 1.0},
        "ou": _TALK | {"mouth_width": 12.0, "mouth_open": 16.0, "mouth_top": 5.0, "mouth_pout": 0.6},
        "ee": _TALK | {"mouth_width": 32.0, "mouth_open": 19.0, "teeth": 1.0},
        "oh": _TALK | {"mouth_width": 17.0, "mouth_open": 27.0, "mouth_top": 7.0},
        "blink": {"eye_open": 0.0},
        "blinkLeft": {"eye_open": 0.5, "eye_uneven": -1.0},
        "blinkRight": {"eye_open": 0.5, "eye_uneven": 1.0},
        "lookUp": {"look_y": 0.8},
        "lookDown": {"look_y": -0.8},
        "lookLeft": {"look_x": 0.8},
        "lookRight": {"look_x": -0.8},
    }
)
"""VRM 1.0 preset -> changes to the standard face (game.face.params)."""


def cell_of(expression: str) -> tuple[float, float]:
    """Texture offset (u, v) of an expression's cell."""
    index = list(EXPRESSIONS).index(expression)
    return (index % COLUMNS) / COLUMNS, (index // COLUMNS) / ROWS


def _painted(canvas: Floats, position: Floats, colour: Floats, triangle: NDArray[np.uint32]) -> None:
    """Blend triangles with interpolated premultiplied colours, in order, into (h, w, 3) sRGB values 0..1."""
    scale = len(canvas) / _EDGE_MM
    corner = np.stack([(position[:, 0] - _LEFT_MM) * scale, (_TOP_MM - position[:, 1]) * scale], 1)[triangle] - 0.5
    tint = colour[triangle]
    low = np.clip(np.ceil(corner.min(1)), 0, len(canvas)).astype(int)
    high = np.clip(np.floor(corner.max(1)) + 1, 0, len(canvas)).astype(int)
    edge = corner[:, 1:] - corner[:, :1]
    area = edge[:, 0, 0] * edge[:, 1, 1] - edge[:, 0, 1] * edge[:, 1, 0]
    for k in np.flatnonzero((np.abs(area) > 1e-9) & (high > low).all(1) & (tint[:, :, 3].max(1) > 0)):
        (x0, y0), (x1, y1) = low[k], high[k]
        x = np.arange(x0, x1)[None, :] - corner[k, 0, 0]
        y = np.arange(y0, y1)[:, None] - corner[k, 0, 1]
        b = (x * edge[k, 1, 1] - y * edge[k, 1, 0]) / area[k]
        c = (y * edge[k, 0, 0] - x * edge[k, 0, 1]) / area[k]
        # Pixel centres fall on an edge too rarely to need a fill rule.
        inside = (b >= 0) & (c > 0) & (b + c <= 1)
        if not inside.any():
            continue
        share = np.stack([1 - b - c, b, c], -1)[inside]
        rgba = share @ tint[k]
        block = canvas[y0:y1, x0:x1]
        block[inside] = block[inside] * (1 - rgba[:, 3:]) + rgba[:, :3]


def paint_atlas(skin: str, style: FaceStyle) -> bytes:
    """PNG of all expressions in a face's style on the skin's lit colour "#rrggbb"."""
    atlas = Image.new("RGB", (COLUMNS * _CELL_PX, ROWS * _CELL_PX), skin)
    for number, changes in enumerate(EXPRESSIONS.values()):
        size = _CELL_PX * _OVERSAMPLE
        canvas = np.tile(np.array(srgb(skin)), (size, size, 1))
        drawing = tessellate(face_params(**changes), style)
        for layer in (drawing.under, drawing.over):
            _painted(canvas, layer.position.astype(np.float64), layer.colour.astype(np.float64), layer.triangle)
        pixels = Image.fromarray((np.clip(canvas, 0, 1) * 255).round().astype(np.uint8))
        cell = pixels.resize((_CELL_PX, _CELL_PX), Image.Resampling.BOX)
        atlas.paste(cell, (number % COLUMNS * _CELL_PX, number // COLUMNS * _CELL_PX))
    picture = io.BytesIO()
    atlas.save(picture, "PNG", optimize=True)
    return picture.getvalue()
