"""How big the parts of a body are that a hand can lie on, measured on its mesh."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.humanoid import REFERENCE

__all__ = ["REGIONS", "BodySize", "measure_body"]

Floats = NDArray[np.floating[Any]]

REGIONS = ("chest", "spine", "hips", "head")
"""Joints whose part of the body a hand can lie on."""

_MEASURED: Mapping[str, tuple[float, float, float]] = {
    "chest": (0.110, 0.0, 0.110),
    "spine": (0.126, 0.0, 0.104),
    "hips": (0.165, 0.0, 0.136),
    "head": (0.200, 0.417, 0.184),
}
"""Half width, height (of the head, above its joint) and half depth of the body for which the reference's ellipsoids
were made, measured by this same function, metres."""
_AHEAD = {"chest": 0.0015, "spine": -0.0015, "hips": -0.003}
"""How far before the line from hips to head the middle between that body's back and front lies there, metres."""
_HEIGHT = {"chest": 0.815, "spine": 0.680, "hips": 0.560}
"""Where the trunk's regions are cut on the reference, metres."""
_SLAB = 0.045
"""Half of a cut's height there, metres."""
_LEAST = 24
"""Fewer vertices than this say nothing."""
_SMALLEST, _LARGEST = 0.5, 2.5
_FURTHEST_M = 0.12
"""What lies further before or behind the trunk than this is no body."""


@dataclass(frozen=True)
class BodySize:
    """share: how much wider, taller and deeper parts of a body are than the reference's, region (REGIONS) ->
    (x, y, z). ahead: how much further forward their middle lies, region -> metres: a belly is all in front."""

    share: Mapping[str, tuple[float, float, float]]
    ahead: Mapping[str, float] = field(default_factory=dict)


def measure_body(
    position: Floats, on_head: NDArray[np.bool_], on_trunk: NDArray[np.bool_], hips: Floats, head: Floats
) -> BodySize:
    """position: (v, 3) of a mesh in its T-pose, metres; on_head, on_trunk: (v,) which of them belong to the head joint
    and to hips, spine and chest; hips, head: (3,) places of the joints.

    Regions with too few vertices are left out.
    """
    extents, middles = _extents(position, on_head, on_trunk, hips, head)
    trunk = float((head - hips)[1] / _TRUNK)
    share, ahead = {}, {}
    for region, found in extents.items():
        known = np.array(_MEASURED[region])
        ratio = np.divide(found, known, out=np.full(3, trunk), where=known > 0.0)
        x, y, z = np.clip(ratio, _SMALLEST, _LARGEST).tolist()
        share[region] = (x, y, z)
        if region in middles:
            shift = middles[region] - _AHEAD[region] * z
            ahead[region] = float(np.clip(shift, -_FURTHEST_M, _FURTHEST_M))
    return BodySize(share, ahead)


_PLACE = {name: REFERENCE.rest_model[REFERENCE.index[name], :3, 3] for name in ("hips", "head")}
_TRUNK = float((_PLACE["head"] - _PLACE["hips"])[1])


def _extents(
    position: Floats, on_head: NDArray[np.bool_], on_trunk: NDArray[np.bool_], hips: Floats, head: Floats
) -> tuple[dict[str, Floats], dict[str, float]]:
    """Region -> half width, height, half depth, and region of the trunk -> how far before the line from hips to head
    its middle lies; robust against a few vertices that stick out."""
    found, middles = {}, {}
    trunk = (head - hips)[1] / _TRUNK
    for region, height in _HEIGHT.items():
        level = hips[1] + (height - _PLACE["hips"][1]) * trunk
        own = position[on_trunk & (np.abs(position[:, 1] - level) < _SLAB * trunk)]
        if len(own) >= _LEAST:
            back, front = _ends(own[:, 2])
            line = float(hips[2] + (level - hips[1]) / (head - hips)[1] * (head - hips)[2])
            found[region] = np.array([_half(own[:, 0]), 0.0, 0.5 * (front - back)])
            middles[region] = 0.5 * (front + back) - line
    own = position[on_head]
    if len(own) >= _LEAST:
        top = float(np.percentile(own[:, 1], 99)) - head[1]
        # Beards, long hair and collars are not the skull.
        skull = own[own[:, 1] > head[1] + 0.25 * top]
        if len(skull) >= _LEAST:
            found["head"] = np.array([_half(skull[:, 0]), top, _half(skull[:, 2])])
    return found, middles


def _half(values: Floats) -> float:
    low, high = _ends(values)
    return 0.5 * (high - low)


def _ends(values: Floats) -> tuple[float, float]:
    low, high = np.percentile(values, (3, 97))
    return float(low), float(high)
