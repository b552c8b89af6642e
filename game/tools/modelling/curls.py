"""Curly hair as a draughtsman masses it: locks of many sizes that grow out of one closed body of hair.

A lock leaves the scalp, sweeps one way and hooks back the other, thick in the middle and pointed at its end. All of
them and the body they grow from are one field: where they meet there is a soft furrow, where one stands over another
a line, and the outline is as lively as the tips. Light falls on the body as a whole: its normals are mostly those of
the coarse shape.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from game.tools.modelling.fields import Field, Floats, normals, offset, smooth_min, unit
from game.tools.modelling.mesh import Mesh
from game.tools.modelling.spec_hair import CurlSpec
from game.tools.modelling.surface import Sculpt

__all__ = ["CurlyMass", "Lock", "grown", "overgrown"]

OnScalp = Callable[[Floats, Floats, Floats], tuple[Floats, Floats]]
_GOLDEN = 2.399963
"""The golden angle: steps of it never repeat, so that neighbours differ without chance."""
_DEGREE_M = 0.0029
"""Length of a degree on a head."""
_HOOK_FROM = 0.35
_BEND_RAD = 0.7
"""A lock bends by this one way, and from this share of its length it hooks the other."""
_TIP_M = 0.0022
_CELL_M = 0.0034
_PLANES_M, _FURROW_M = 0.026, 0.007
"""Steps of the gradients that tell the large planes and the furrows."""
_PLANES = 0.58
"""Share of the large planes in the normals."""
_NEAR_M = 0.024
"""How far from a lock its distance is told: half the diagonal of the sculptor's blocks, or it would miss some."""
_HIDDEN_M = 0.007
"""Triangles deeper than this in the head are left out."""


@dataclass(frozen=True, eq=False)
class Lock:
    """A tapering tube. path: (n, 3), radius: (n,) metres; join: how softly it grows out of the rest."""

    path: Floats
    radius: Floats
    join: float

    @property
    def ball(self) -> tuple[Floats, float]:
        """Middle and radius of a ball beyond which the lock is left out."""
        middle = (self.path.min(0) + self.path.max(0)) / 2
        return middle, float((np.linalg.norm(self.path - middle, axis=1) + self.radius).max()) + self.join + _NEAR_M

    def distance(self, points: Floats) -> Floats:
        """To its surface, (n,) metres."""
        nearest = np.full(len(points), np.inf)
        for a, b, ra, rb in zip(self.path[:-1], self.path[1:], self.radius[:-1], self.radius[1:], strict=True):
            along, off = b - a, points - a
            t = np.clip(off @ along / float(along @ along), 0.0, 1.0)
            off -= t[:, None] * along
            nearest = np.minimum(nearest, np.sqrt(np.einsum("ij,ij->i", off, off)) - (ra + (rb - ra) * t))
        return nearest


def grown(rows: Sequence[CurlSpec], on_scalp: OnScalp) -> Iterator[Lock]:
    """The locks of all rows. on_scalp: (azimuth, polar, lift) of n points -> places and outward directions."""
    number = 0
    for row in rows:
        share = (np.arange(row.count) + 0.5) / max(row.count, 1)
        for k in range(row.count):
            number += 1
            wobble = np.sin(_GOLDEN * number * np.array([1.0, 1.7, 2.3, 3.1, 4.3])) * row.uneven
            larger = 1.0 + 1.2 * wobble[0]
            azimuth = row.azimuth_deg[0] + (row.azimuth_deg[1] - row.azimuth_deg[0]) * share[k]
            polar = row.polar_deg[0] + (row.polar_deg[1] - row.polar_deg[0]) * share[k]
            yield _lock(
                replace(row, length=row.length * larger, width=row.width * larger),
                (azimuth + 12.0 * wobble[1], polar + 12.0 * wobble[2]),
                np.radians(row.lean_deg + 50.0 * wobble[3]),
                row.hand or (1.0 if np.sin(_GOLDEN * number * 1.3) > -0.2 else -1.0),
                on_scalp,
            )


def _lock(row: CurlSpec, root_deg: tuple[float, float], lean: float, hand: float, on_scalp: OnScalp) -> Lock:
    """Down the scalp with a slight bend, then a hook of ``turns`` to the other side that tightens to the tip."""
    roll = np.radians(row.roll_deg)
    t = np.linspace(0.0, 1.0, round(10 + 14 * row.turns))
    hook = (0.6 + 0.8 * (t - _HOOK_FROM) / (1.0 - _HOOK_FROM)) / (1.0 - _HOOK_FROM)
    turn = np.gradient(t) * np.where(t < _HOOK_FROM, -_BEND_RAD / _HOOK_FROM, 2.0 * np.pi * row.turns * hook)
    angle = np.cumsum(turn)
    step = np.gradient(t) * row.length * (1.0 - 0.4 * t) / 0.8
    along, aside = np.cumsum(step * np.cos(angle)), hand * np.cos(roll) * np.cumsum(step * np.sin(angle))
    across, down = along * np.sin(lean) + aside * np.cos(lean), along * np.cos(lean) - aside * np.sin(lean)
    polar = root_deg[1] + down / _DEGREE_M
    azimuth = root_deg[0] + across / _DEGREE_M / np.maximum(np.sin(np.radians(np.clip(polar, 1.0, 179.0))), 0.4)
    radius = row.width / 2 * np.interp(t, [0.0, 0.25, 0.6, 1.0], [0.75, 1.0, 0.64, 0.08])
    rise = row.lift + row.width * np.interp(t, [0.0, 0.4, 1.0], [-0.6, 0.1, 0.2])
    rise = rise + np.sin(roll) * np.cumsum(step * np.sin(np.where(t < _HOOK_FROM, 0.0, angle + _BEND_RAD)))
    path, _ = on_scalp(azimuth, polar, rise)
    return Lock(path, np.maximum(radius, _TIP_M), row.join * row.width)


def overgrown(body: Field, locks: Sequence[Lock]) -> Field:
    """The field of a body of hair with its locks."""
    balls = [lock.ball for lock in locks]
    middle = np.array([middle for middle, _ in balls]).reshape(-1, 3)
    reach = np.array([reach for _, reach in balls])

    def field(p: Floats) -> Floats:
        distance = body(p)
        # Squared distances to all locks' middles at once.
        apart = (p * p).sum(1) - 2.0 * middle @ p.T + (middle**2).sum(1)[:, None]
        for lock, near in zip(locks, apart < (reach**2)[:, None], strict=True):
            index = np.flatnonzero(near)
            if len(index):
                distance[index] = smooth_min(distance[index], lock.distance(p[index]), lock.join)
        return distance

    return field


class CurlyMass:
    """The mesh of curly hair. skin: the head, whose inside needs no triangles; low, high: corners of a box around."""

    def __init__(self, field: Field, skin: Field, low: Floats, high: Floats) -> None:
        self.field = field
        self._sculpt = Sculpt(field, low, high, _CELL_M, hidden=offset(skin, -_HIDDEN_M))

    def mesh(self, target: int) -> Mesh:
        """About ``target`` triangles. Its normals tell the large planes, with a share of the furrows."""
        mesh = self._sculpt.mesh(target)
        planes = normals(self.field, mesh.position, _PLANES_M)
        furrows = normals(self.field, mesh.position, _FURROW_M)
        return Mesh(mesh.position, unit(_PLANES * planes + (1.0 - _PLANES) * furrows), mesh.triangle)
