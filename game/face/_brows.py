"""Eyebrows, the furrows between them, and the nose with its wrinkles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from game.face.mesh import Sheet, bezier, rgb, ribbons, tint
from game.face.params import INDEX, FaceParams
from game.face.style import FaceStyle

__all__ = ["brows", "furrows", "nose"]

Floats = NDArray[np.float64]
_SIDE = np.array([1.0, -1.0])
_N = 28
_T = np.linspace(0.0, 1.0, _N)


def brow_lines(params: FaceParams, style: FaceStyle) -> Floats:
    """Centre lines of the brows, (2, n, 2) head mm, from the inner end outward."""
    lift, angle, curve, inner = (params[INDEX[n]] for n in ("brow_raise", "brow_angle", "brow_curve", "brow_inner"))
    uneven, knit = params[INDEX["brow_uneven"]], params[INDEX["brow_knit"]]
    line = bezier(
        [
            (-31.0 + inner, -2.0 - 3.0 * knit),
            (-14.0 + 0.4 * inner, 4.0 + 5.0 * curve + 3.0 * knit),
            (10.0, 6.0 + 6.0 * curve),
            (34.0, -3.0 + curve),
        ],
        _N,
    )
    turn = np.radians(angle)
    cos, sin = np.cos(turn), np.sin(turn)
    line = line @ np.array([[cos, sin], [-sin, cos]]) * style.brow_scale
    height = style.brow_y + lift + np.where(_SIDE < 0.0, uneven, -0.3 * uneven)
    # Unevenness also turns the higher brow a little: the skeptical look.
    x = _SIDE[:, None] * (style.brow_x + line[:, 0])
    return np.stack([x, height[:, None] + line[:, 1]], axis=-1)


def brows(sheet: Sheet, params: FaceParams, style: FaceStyle) -> None:
    width = np.interp(_T, [0.0, 0.06, 0.16, 0.4, 1.0], [3.0, 7.6, 9.6, 10.2, 1.6])
    width = width * params[INDEX["brow_thick"]] * style.brow_weight
    ribbons(sheet, brow_lines(params, style), width, tint(rgb(style.brow), np.ones(2)))


def furrows(sheet: Sheet, params: FaceParams, style: FaceStyle) -> None:
    """Two short strokes between the brows."""
    knit = float(params[INDEX["brow_knit"]])
    if knit <= 1e-3:
        return
    height = style.brow_y - 2.0 + 0.6 * float(params[INDEX["brow_raise"]])
    tilt = float(np.clip(params[INDEX["brow_angle"]] / 20.0, -1.0, 1.0))
    stroke = bezier([(7.0 + 2.0 * tilt, 9.0), (5.0, 4.0), (5.0, -2.0), (8.0 - 2.0 * tilt, -8.0)], 12)
    both = stroke * np.stack([_SIDE, np.ones(2)], axis=-1)[:, None]
    width = 0.8 + 2.6 * np.sin(np.linspace(0.0, np.pi, 12))
    ribbons(sheet, both + np.array([0.0, height]), width, tint(rgb(style.crease), np.full(2, 0.85 * knit)))


def nose(sheet: Sheet, params: FaceParams, style: FaceStyle) -> None:
    """A tiny hook; a sneer wrinkles its bridge and draws the folds beside the mouth."""
    hook = bezier([(2.0, -70.0), (6.0, -73.0), (7.0, -77.0), (1.0, -79.0)], 12)
    ribbons(sheet, hook[None], 0.7 + 2.6 * np.sin(np.linspace(0.0, np.pi, 12)), tint(rgb(style.nose), np.array([0.95])))
    sneer = float(params[INDEX["sneer"]])
    if sneer <= 1e-3:
        return
    wrinkles = np.array(
        [
            bezier([(-13.0, -50.0), (-6.0, -54.0), (6.0, -54.0), (13.0, -50.0)], 12),
            bezier([(-11.0, -58.0), (-5.0, -62.0), (5.0, -62.0), (11.0, -58.0)], 12),
        ]
    )
    swell = np.sin(np.linspace(0.0, np.pi, 12))
    ribbons(sheet, wrinkles, 0.6 + 2.6 * swell, tint(rgb(style.crease), np.full(2, 0.8 * sneer)))
    fold = bezier([(20.0, -76.0), (29.0, -80.0), (34.0, -88.0), (35.0, -97.0)], 12)
    folds = fold * np.stack([_SIDE, np.ones(2)], axis=-1)[:, None]
    ribbons(sheet, folds, 0.6 + 2.4 * swell, tint(rgb(style.crease), np.full(2, 0.7 * sneer)))
