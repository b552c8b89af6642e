"""Eyebrows, the furrows between them, and the nose with its wrinkles."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from game.face.mesh import Sheet, bezier, ink, ribbons
from game.face.params import INDEX, FaceParams
from game.face.style import FaceStyle

__all__ = ["brow_lines", "brows", "furrows", "nose"]

Floats = NDArray[np.float64]
_N = 24
_WIDTH = np.interp(np.linspace(0.0, 1.0, _N), [0.0, 0.06, 0.16, 0.4, 1.0], [3.0, 7.6, 9.6, 10.2, 1.6])
_MIRROR = np.array([[[1.0, 1.0]], [[-1.0, 1.0]]])
_SWELL = np.sin(np.linspace(0.0, np.pi, 12))
_HOOK = bezier(((2.0, -70.0), (6.0, -73.0), (7.0, -77.0), (1.0, -79.0)), 12)[None]
_NOSE = np.array([0.0, -75.0])
_WRINKLES = bezier(
    (
        ((-13.0, -50.0), (-6.0, -54.0), (6.0, -54.0), (13.0, -50.0)),
        ((-11.0, -58.0), (-5.0, -62.0), (5.0, -62.0), (11.0, -58.0)),
    ),
    12,
)
_FOLDS = bezier(((20.0, -76.0), (29.0, -80.0), (34.0, -88.0), (35.0, -97.0)), 12) * _MIRROR


def brow_lines(params: FaceParams, style: FaceStyle) -> Floats:
    """Centre lines of the brows, (2, n, 2) head mm, from the inner end outward; character's left first."""
    lift, angle, curve, inner, uneven, knit = (
        float(params[INDEX["brow_" + name]]) for name in ("raise", "angle", "curve", "inner", "uneven", "knit")
    )
    line = bezier(
        (
            (-31.0 + inner, -2.0 - 3.0 * knit),
            (-14.0 + 0.4 * inner, 4.0 + 5.0 * curve + 3.0 * knit),
            (10.0, 6.0 + 6.0 * curve),
            (34.0, -3.0 + curve),
        ),
        _N,
    )
    turn = math.radians(angle)
    cos, sin = math.cos(turn) * style.brow_scale, math.sin(turn) * style.brow_scale
    line = line @ np.array([[cos, sin], [-sin, cos]]) + (style.brow_x, style.brow_y + lift)
    both = line * _MIRROR
    both[0, :, 1] -= 0.3 * uneven
    both[1, :, 1] += uneven
    return np.asarray(both)


def brows(sheet: Sheet, params: FaceParams, style: FaceStyle) -> None:
    colour = ink(style.brow)
    width = _WIDTH * (float(params[INDEX["brow_thick"]]) * style.brow_weight)
    ribbons(sheet, brow_lines(params, style), width, np.stack([colour, colour]), over=True)


def furrows(sheet: Sheet, params: FaceParams, style: FaceStyle) -> None:
    """Two short strokes between the brows."""
    knit = float(params[INDEX["brow_knit"]])
    if knit <= 1e-3:
        return
    height = style.brow_y - 2.0 + 0.6 * float(params[INDEX["brow_raise"]])
    tilt = 2.0 * min(max(float(params[INDEX["brow_angle"]]) / 20.0, -1.0), 1.0)
    stroke = bezier(((7.0 + tilt, 9.0), (5.0, 4.0), (5.0, -2.0), (8.0 - tilt, -8.0)), 12) + (0.0, height)
    colour = ink(style.crease) * (0.85 * knit)
    ribbons(sheet, stroke * _MIRROR, 0.8 + 2.6 * _SWELL, np.stack([colour, colour]))


def nose(sheet: Sheet, params: FaceParams, style: FaceStyle) -> None:
    """A tiny hook; a sneer wrinkles its bridge and draws the folds beside the mouth."""
    hook = (_HOOK - _NOSE) * style.nose_scale + _NOSE + (0.0, style.nose_y)
    ribbons(sheet, hook, (0.7 + 2.6 * _SWELL) * style.nose_scale**0.5, 0.95 * ink(style.nose)[None])
    sneer = float(params[INDEX["sneer"]])
    if sneer > 1e-3:
        colour = ink(style.crease) * (0.8 * sneer)
        lines = np.concatenate([_WRINKLES, _FOLDS])
        ribbons(sheet, lines, 0.6 + 2.6 * _SWELL, np.tile(colour, (4, 1)))
