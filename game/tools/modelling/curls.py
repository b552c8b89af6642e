"""Curly hair: rows of short spirals laid on the scalp, no two quite alike."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from game.tools.modelling.fields import Floats, unit
from game.tools.modelling.lofts import loft
from game.tools.modelling.mesh import Mesh
from game.tools.modelling.parts import Detail
from game.tools.modelling.spec_hair import CurlSpec

__all__ = ["curl_meshes"]

OnScalp = Callable[[Floats, Floats, Floats], tuple[Floats, Floats]]
_GOLDEN = 2.399963
"""The golden angle: steps of it never repeat, so that neighbours differ without chance."""


def curl_meshes(rows: Sequence[CurlSpec], on_scalp: OnScalp, detail: Detail) -> Iterator[Mesh]:
    """One mesh per curl. on_scalp: (azimuth, polar, lift) of n points -> places and outward directions."""
    number = 0
    for row in rows:
        share = (np.arange(row.count) + 0.5) / max(row.count, 1)
        azimuth = row.azimuth_deg[0] + (row.azimuth_deg[1] - row.azimuth_deg[0]) * share
        polar = row.polar_deg[0] + (row.polar_deg[1] - row.polar_deg[0]) * share
        for k in range(row.count):
            wobble = np.sin(_GOLDEN * (number + 1) * np.array([1.0, 1.7, 2.3, 3.1])) * row.uneven
            place, out = on_scalp(
                azimuth[[k]] + 10.0 * wobble[0], polar[[k]] + 12.0 * wobble[1], np.array([row.lift * (1 + wobble[2])])
            )
            # The lobes of the crown point upward with the skull, not straight sideways as hanging hair does.
            up = np.cos(np.radians(min(max(polar[k], 0.0), 90.0)))
            outward = unit(out[0] * np.sqrt(1.0 - up * up) + np.array([0.0, up, 0.0]))
            # Far away every second curl, a little larger, gives the same outline.
            if detail.trims or number % 2 == 0:
                size = row.size * (1 + wobble[3]) * (1.0 if detail.trims else 1.2)
                yield _curl(place[0], outward, size, row.turns, number, detail)
            number += 1


def _curl(at: Floats, outward: Floats, size: float, turns: float, number: int, detail: Detail) -> Mesh:
    """A spiral that begins at the scalp, winds outward from wide to narrow and ends in a point."""
    hand = 1.0 if number % 2 else -1.0
    right = unit(np.cross((0.0, 1.0, 0.0), outward) + 1e-6)
    up = np.cross(outward, right)
    t = np.linspace(0.0, 1.0, detail.rings(round(14 * turns), 5))
    angle = hand * 2.0 * np.pi * turns * t + _GOLDEN * number
    radius = size * (0.72 - 0.55 * t)
    path = at + (radius * np.cos(angle))[:, None] * right + (radius * np.sin(angle))[:, None] * up
    path = path + outward * (size * (0.9 * t - 0.35))[:, None]
    thick = size * np.interp(t, [0.0, 0.15, 0.7, 1.0], [0.30, 0.46, 0.38, 0.05])
    return loft(path, np.tile(outward, (len(t), 1)), thick, thick, detail.sides(7, 3), "round")
