"""Which thing on the table lies under the pointer: the outlines of the goods on the picture, the nearest first."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.render import Camera, Card, StaticMesh, own_triangles

__all__ = ["Picker"]

Floats = NDArray[np.float64]
_ITEM = "item:"
_ANGLE = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
_DIRECTIONS = np.stack([np.cos(_ANGLE), np.sin(_ANGLE)], axis=1)


@dataclass(frozen=True, eq=False)
class Picker:
    """Convex outlines (k, 2) of the items in one picture, in pixels, y downward, and their distance from the eye."""

    outlines: Mapping[str, Floats]
    distance_m: Mapping[str, float]

    @staticmethod
    def of(stall: StaticMesh, cards: Mapping[str, Card], camera: Camera, size: tuple[float, float]) -> Picker:
        """Project every item of the stall; cards: item -> its price card; size: the picture's width and height."""
        world_to_clip = camera.view_projection(size[0] / size[1])
        outlines, distance = {}, {}
        for group in stall.anchors:
            item = group.removeprefix(_ITEM)
            corner = np.concatenate([triangle.ravel() for _, triangle in own_triangles(stall, group, cards.get(item))])
            place = stall.position[np.unique(corner)].astype(np.float64)
            clip = np.column_stack([place, np.ones(len(place))]) @ world_to_clip.T
            if (clip[:, 3] <= 0.0).any():
                continue
            flat = clip[:, :2] / clip[:, 3:]
            pixel = (flat * (0.5, -0.5) + 0.5) * size
            outlines[item] = _outline(pixel)
            distance[item] = camera.distance_m(stall.anchors[group])
        return Picker(outlines, distance)

    def at(self, place: tuple[float, float], gone: frozenset[str] = frozenset()) -> str | None:
        """The item under a pixel; None where there is none. ``gone``: items no longer there."""
        under = [name for name, hull in self.outlines.items() if name not in gone and _inside(hull, place)]
        return min(under, key=self.distance_m.__getitem__, default=None)

    def box(self, item: str) -> tuple[float, float, float, float] | None:
        """Left, top, right, bottom of an item in pixels; None where it is not in the picture."""
        hull = self.outlines.get(item)
        if hull is None:
            return None
        (left, top), (right, bottom) = hull.min(axis=0).tolist(), hull.max(axis=0).tolist()
        return left, top, right, bottom


def _outline(points: Floats) -> Floats:
    """The outermost points (k, 2) in 64 directions, in order round: the convex hull for all that a pointer sees."""
    extreme = (points @ _DIRECTIONS.T).argmax(axis=0)
    fresh = extreme != np.roll(extreme, 1)
    return np.asarray(points[extreme[fresh] if fresh.any() else extreme[:1]])


def _inside(hull: Floats, place: tuple[float, float]) -> bool:
    # Seen with y downward the outline runs clockwise, in numbers counter-clockwise: inside is to the left of it.
    edge = np.roll(hull, -1, axis=0) - hull
    to_place = np.asarray(place) - hull
    return bool((edge[:, 0] * to_place[:, 1] - edge[:, 1] * to_place[:, 0] >= 0.0).all())
