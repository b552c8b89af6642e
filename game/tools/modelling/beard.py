"""A beard's body on the skin: where it begins, what it leaves bare, how thick it is."""

from __future__ import annotations

import numpy as np

from game.tools.modelling.fields import Field, Floats, smooth_max
from game.tools.modelling.spec_hair import BeardSpec

__all__ = ["beard_field"]

_HEAD_M = 0.17
_EDGE_M = 0.016
"""The edges swell over this length: a beard has no wall."""


def beard_field(spec: BeardSpec, head_centre: Floats, skin: Field) -> Field:
    """The field of a beard between its upper line, the lips and its lower edge."""
    line, under = np.array(spec.line).T, np.array(spec.under).T
    half_width, middle, half_height = spec.lips

    def field(p: Floats) -> Floats:
        q = p - head_centre
        reach = np.linalg.norm(q, axis=1)
        azimuth = np.abs(np.degrees(np.arctan2(q[:, 0], q[:, 2])))
        polar = np.degrees(np.arccos(np.clip(q[:, 1] / np.maximum(reach, 1e-9), -1.0, 1.0)))
        above = np.radians(np.interp(azimuth, *line) - polar) * _HEAD_M
        below = np.radians(polar - np.interp(azimuth, *under)) * _HEAD_M
        k = np.hypot(q[:, 0] / half_width, (q[:, 1] - middle) / half_height)
        mouth = np.where(q[:, 2] > 0.0, (1.0 - k) * min(half_width, half_height), -1.0)
        outside = np.maximum(np.maximum(above, below), mouth)
        thickness = spec.thickness * np.clip(-outside / _EDGE_M, -1.0, 1.0)
        return smooth_max(skin(p) - thickness, outside, 0.008)

    return field
