"""Where the light ends on a face: not where a ball's would, but along planes, as it is drawn by hand.

A map over the face says how much earlier (below 0) or later (above 0) a place falls into shade. It is painted for light
from the person's right and mirrored for light from the left: beside the nose a small triangle, under the lip a sliver,
from temple to chin the side of the face turn dark together; under the far eye a triangle of cheek stays light longest.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.face.style import FaceStyle

__all__ = ["PLANES_PX", "face_planes"]

Floats = NDArray[np.floating[Any]]

PLANES_PX = 192
_SQUARE_MM = 340.0
_NOSE_Y = -75.0  # where face styles have their nose, before nose_y


def _inside(x: Floats, y: Floats, corners: tuple[tuple[float, float], ...]) -> Floats:
    """How far inside a convex polygon (corners counter-clockwise, y up), mm; negative outside."""
    found = np.full(x.shape, np.inf)
    for (ax, ay), (bx, by) in zip(corners, (*corners[1:], corners[0]), strict=True):
        length = np.hypot(bx - ax, by - ay)
        found = np.minimum(found, ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / length)
    return found


def face_planes(style: FaceStyle) -> NDArray[np.uint8]:
    """(PLANES_PX, PLANES_PX) over the face's square, first row at the brow: 128 changes nothing, 0 takes half the
    range of half-Lambert away, 255 adds half. x runs to the side that lies in shade."""
    at = (np.arange(PLANES_PX) + 0.5) / PLANES_PX * _SQUARE_MM
    x, y = np.meshgrid(at - 170.0, 140.0 - at)
    nose, mouth = _NOSE_Y + style.nose_y, style.mouth_y
    eye_x, eye_y = style.eye_x, style.eye_y
    wide = 7.0 + 6.0 * style.nose_scale

    # Each ramp is steep: its edge, a few millimetres inside, is where full light turns to shade.
    triangle = _inside(x, y, ((-4.0, nose - 7.0), (wide + 5.0, nose - 6.0), (2.0, nose + 25.0)))
    offset = -np.clip(0.085 * triangle, 0.0, 0.45)
    lip = 1.0 - np.hypot(x / (13.0 * style.mouth_scale), (y - mouth + 19.0) / 5.0)
    offset -= np.clip(0.52 * lip, 0.0, 0.36)
    front = ((0.0, -200.0), (30.0, -166.0), (64.0, -138.0), (95.0, -92.0), (104.0, -40.0), (112.0, 200.0))
    side = -_inside(x, y, (*front, (-300.0, 200.0), (-300.0, -200.0)))
    offset -= np.clip(0.045 * side, 0.0, 0.20)
    cheek = _inside(x, y, ((eye_x - 10.0, mouth + 14.0), (eye_x + 26.0, eye_y - 36.0), (eye_x - 28.0, eye_y - 40.0)))
    offset += np.clip(0.020 * cheek, 0.0, 0.16)
    return np.asarray(np.rint(np.clip(128.0 + 255.0 * offset, 0.0, 255.0)), dtype=np.uint8)
