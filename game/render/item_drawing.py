"""An item shown large: cut out of the stall, stood on a plate, turned in the hand; the stall's backdrop behind, dimmed.

It is drawn by the same shaders as the stall. The item is scaled up to the size at which light, shadow map and ink
lines are at their best, and turned instead of the camera, so that the light stays where it is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from game.render.camera import HERO
from game.render.device import Device, Owner
from game.render.grading import palette_bytes
from game.render.lighting import Lights
from game.render.model import Run, StaticMesh
from game.render.scene_drawing import BakeKey, SceneDrawing
from game.render.targets import BakeTargets

__all__ = ["Card", "ItemDrawing", "ItemView", "cut_item", "own_triangles"]

Floats = NDArray[np.float64]
Card = tuple[float, float, float]
"""x, z and turn about +Y (rad) of an item's price card on the table."""

_MIDDLE = np.array([0.0, 1.075, 0.1])  # where the item's middle is shown, m
_RADIUS_M = 0.45  # of the sphere round it, at zoom 1
_DIMMED = 0.62  # share of the backdrop's light
_CARD_HALF = (0.043, 0.006, 0.062)  # of a price card: along, across, height, m
_SHADOW_Y = (0.0012, 0.0020)  # contact shadows lie this far above the table, m


@dataclass(frozen=True)
class ItemView:
    """Which item, and how it is held.

    group: ``item:<id>`` of the stall. yaw_rad, pitch_rad: turned about its own upright axis, then toward the eye.
    zoom: 1 fills half the picture's height. card: its price card, which stays on the table.
    """

    group: str
    yaw_rad: float = 0.0
    pitch_rad: float = 0.0
    zoom: float = 1.0
    card: Card | None = None


def own_triangles(stall: StaticMesh, group: str, card: Card | None) -> list[tuple[str, NDArray[np.int32]]]:
    """(kind, triangles (t, 3)) of an item, run by run, without its contact shadow and price card."""
    base = stall.anchors[group][1]
    result = []
    for run in stall.runs:
        if run.group == group:
            triangle = stall.triangle.reshape(-1)[run.first : run.first + run.count].reshape(-1, 3)
            triangle = triangle[~_on_table(stall.position[triangle].astype(np.float64), base, card)]
            if len(triangle):
                result.append((run.kind, triangle))
    return result


def cut_item(stall: StaticMesh, group: str, card: Card | None) -> StaticMesh:
    """The item's own triangles without its contact shadow and price card, its middle at the origin, radius 1."""
    runs, first = [], 0
    own = own_triangles(stall, group, card)
    for kind, triangle in own:
        runs.append(Run(group, kind, first, triangle.size))
        first += triangle.size
    used, corner = np.unique(np.concatenate([triangle for _, triangle in own]), return_inverse=True)
    position = stall.position[used].astype(np.float64)
    low, high = position.min(axis=0), position.max(axis=0)
    middle = (low + high) / 2.0
    radius = float(np.linalg.norm(position - middle, axis=1).max())
    return StaticMesh(
        position=((position - middle) / radius).astype(np.float32),
        normal=stall.normal[used],
        outline=stall.outline[used],
        palette=stall.palette[used],
        triangle=corner.reshape(-1, 3).astype(np.int32),
        runs=tuple(runs),
        anchors={group: (0.0, float((low[1] - middle[1]) / radius), 0.0)},
    )


def _on_table(corner: Floats, base: float, card: Card | None) -> NDArray[np.bool_]:
    """(t,) bool: triangles (t, 3, 3) of the contact shadows and of the price card."""
    above = corner[..., 1] - base
    flat = ((above > _SHADOW_Y[0]) & (above < _SHADOW_Y[1])).all(axis=1)
    if card is None:
        return np.asarray(flat)
    x, z, turn = card
    along = (corner[..., 0] - x) * np.cos(turn) - (corner[..., 2] - z) * np.sin(turn)
    across = (corner[..., 0] - x) * np.sin(turn) + (corner[..., 2] - z) * np.cos(turn)
    inside = (np.abs(along) < _CARD_HALF[0]) & (np.abs(across) < _CARD_HALF[1]) & (above < _CARD_HALF[2])
    return np.asarray(flat | inside.all(axis=1))


def _with_plate(item: StaticMesh, group: str) -> StaticMesh:
    """The item on a round wooden plate a little wider than itself."""
    base = item.anchors[group][1]
    reach = float(np.hypot(item.position[:, 0], item.position[:, 2]).max())
    count = 64
    angle = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    around = np.stack([np.sin(angle), np.zeros(count), np.cos(angle)], axis=1)
    top_edge, low_edge = around * reach * 1.14, around * reach * 1.10
    top = np.vstack([top_edge + (0, base - 0.004, 0), [[0.0, base - 0.004, 0.0]]])
    side = np.vstack([top_edge + (0, base - 0.004, 0), low_edge + (0, base - 0.075, 0)])
    line = np.vstack([around * reach * s + (0, base - 0.003, 0) for s in (1.05, 1.02)])
    k, after = np.arange(count), (np.arange(count) + 1) % count
    fan = np.stack([k, after, np.full(count, count)], axis=1)
    band = np.vstack([np.stack([k, k + count, after + count], 1), np.stack([k, after + count, after], 1)])
    ring = np.vstack([np.stack([k, after, after + count], 1), np.stack([k, after + count, k + count], 1)])
    up = np.array([0.0, 1.0, 0.0])
    parts = (
        (top, np.tile(up, (count + 1, 1)), fan, _wood("#B97C48", "#8A5538", "#673E35"), 0.0),
        (side, np.vstack([around, around]), band, _wood("#8F5A3C", "#673F36", "#4B2E2D"), 0.9),
        (line, np.tile(up, (2 * count, 1)), ring, _wood("#D9A35E", "#A97449", "#7D513C"), 0.0),
    )
    start, first = len(item.position), item.triangle.size
    position, normal, outline, palette, triangle = (
        [item.position],
        [item.normal],
        [item.outline],
        [item.palette],
        [item.triangle],
    )
    for place, direction, corners, colour, width in parts:
        position.append(place.astype(np.float32))
        normal.append(direction.astype(np.float32))
        outline.append(np.full(len(place), width, np.float32))
        palette.append(np.tile(colour, (len(place), 1)))
        triangle.append((corners + start).astype(np.int32))
        start += len(place)
    plate = Run("plate", "cloth", first, sum(part[2].size for part in parts))
    return replace(
        item,
        position=np.concatenate(position),
        normal=np.concatenate(normal),
        outline=np.concatenate(outline),
        palette=np.concatenate(palette),
        triangle=np.concatenate(triangle),
        runs=(*item.runs, plate),
    )


def _wood(*tones: str) -> NDArray[np.uint8]:
    lit, shade, deep = (tuple(int(tone[i : i + 2], 16) / 255.0 for i in (1, 3, 5)) for tone in tones)
    return palette_bytes(lit, shade, deep, graded=False)


class ItemDrawing(Owner):
    """One item on the GPU, made when it is first looked at."""

    def __init__(self, device: Device, stall: StaticMesh, view: ItemView, backdrop: NDArray[np.uint8] | None) -> None:
        super().__init__()
        self.group = view.group
        self._mesh = _with_plate(cut_item(stall, view.group, view.card), view.group)
        dimmed = None if backdrop is None else (backdrop * _DIMMED).astype(np.uint8)
        self._scene = self.own(SceneDrawing(device, self._mesh, dimmed))

    def draw(
        self,
        view: ItemView,
        size: tuple[int, int],
        targets: BakeTargets,
        line_px: float,
        lights: Lights,
        *,
        draft: bool = False,
    ) -> None:
        """Bake the item as it is held into ``targets``."""
        turn = _held(view.yaw_rad, view.pitch_rad)
        position = self._mesh.position @ (turn.T * (_RADIUS_M * view.zoom)) + _MIDDLE
        self._scene.move(position.astype(np.float32), (self._mesh.normal @ turn.T).astype(np.float32))
        key = BakeKey(HERO, size, True, frozenset(), lights.day.share)
        self._scene.bake(key, targets, line_px, lights, draft=draft)


def _held(yaw: float, pitch: float) -> Floats:
    """Rotation (3, 3): about the item's upright axis, then about the picture's horizontal one."""
    cy, sy, cp, sp = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch)
    about_y = np.array([[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]])
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cp, -sp], [0.0, sp, cp]])
    return np.asarray(about_x @ about_y)
