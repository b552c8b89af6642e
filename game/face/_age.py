"""The lines of an older face: gentle strokes that deepen with the expression that draws them."""

from __future__ import annotations

import numpy as np

from game.face.mesh import Sheet, bezier, ink, ribbons
from game.face.params import INDEX, FaceParams
from game.face.style import FaceStyle

__all__ = ["age_lines"]

_MIRROR = np.array([[[1.0, 1.0]], [[-1.0, 1.0]]])
_SWELL = np.sin(np.linspace(0.0, np.pi, 12))
# All from the middle of the feature they belong to, mm, for the character's left side.
_CROWS_FEET = bezier(
    (
        ((39.0, 6.0), (44.0, 8.0), (48.0, 11.0), (51.0, 16.0)),
        ((40.0, -3.0), (46.0, -3.0), (51.0, -3.0), (55.0, -1.0)),
        ((38.0, -11.0), (43.0, -14.0), (48.0, -17.0), (51.0, -21.0)),
    ),
    12,
)
_BAG = bezier(((-20.0, -38.0), (-8.0, -48.0), (14.0, -47.0), (28.0, -34.0)), 12)
_FOLD = bezier(((23.0, 36.0), (33.0, 28.0), (41.0, 14.0), (43.0, -3.0)), 12)
_BROW_LINES = bezier(
    (
        ((-56.0, 44.0), (-24.0, 52.0), (22.0, 46.0), (52.0, 50.0)),
        ((-40.0, 60.0), (-14.0, 66.0), (20.0, 60.0), (44.0, 64.0)),
    ),
    12,
)


def age_lines(sheet: Sheet, params: FaceParams, style: FaceStyle) -> None:
    """Crow's feet (deeper in a smile), bags under the eyes, folds beside the mouth, lines on a raised brow."""
    age = style.age
    if age <= 1e-3:
        return
    smile = min(max(float(params[INDEX["mouth_corner"]]) / 10.0, 0.0), 1.0)
    raised = min(max(float(params[INDEX["brow_raise"]]) / 14.0, 0.0), 1.0)
    crease = ink(style.crease)
    eye = np.array([style.eye_x, style.eye_y])
    size = style.eye_scale * np.array([1.0, style.eye_height])
    feet = _CROWS_FEET * size + eye
    width = 0.5 + 2.0 * _SWELL
    for side in _MIRROR:
        ribbons(sheet, feet * side, width, np.tile(crease * (age * (0.42 + 0.4 * smile)), (3, 1)))
    ribbons(sheet, (_BAG * size + eye) * _MIRROR, 0.5 + 2.2 * _SWELL, np.tile(crease * (0.55 * age), (2, 1)))
    fold = _FOLD * (style.mouth_scale, 1.0) + (4.0 * smile, style.mouth_y)
    ribbons(sheet, fold * _MIRROR, 0.6 + 2.6 * _SWELL, np.tile(crease * (age * (0.55 + 0.35 * smile)), (2, 1)))
    lines = _BROW_LINES + (0.0, style.brow_y - 21.0 + 0.4 * float(params[INDEX["brow_raise"]]))
    ribbons(sheet, lines, 0.5 + 2.0 * _SWELL, np.tile(crease * (age * (0.28 + 0.5 * raised)), (2, 1)))
