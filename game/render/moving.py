"""What moves by itself at a stall: bulbs, lanterns, flags and cloth that sway, pinwheels that spin.

Every thing is a rigid body with a pivot. Where it is follows from the time alone: a breeze that runs along the stall,
stronger and weaker by turns.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput, Where
from game.render.coarse import coarser, loose_pieces
from game.render.model import MAX_JOINTS, CharacterMesh, Part, merge_character, turned_outward

__all__ = ["Motion", "MovingMesh", "hanging_bulbs", "moving_meshes", "read_motion"]

Floats = NDArray[np.floating[Any]]

GUST_S = 11.0
_COARSE_FROM, _COARSE_M = 120, 0.012  # triangles a thing may have before it is made coarser, with cells of this size
_LAMPS = ("bulb", "lantern")  # groups whose flat and paper parts glow
_GLOWING = ("glass", "paper", "flame", "lantern")
_DARK = "_rib"  # ends the names of what a lamp holds together with
_HALO_M = 0.06  # a lantern's halo is no larger than that of so large a lamp
_BULB = "glass"  # material of bulbs that hang in a still group


@dataclass(frozen=True)
class Motion:
    """How the things of a group move. axis: unit vector; amplitude_rad: of a sway, None for a spin; period_s > 0."""

    axis: tuple[float, float, float]
    amplitude_rad: float | None
    period_s: float


@dataclass(frozen=True, eq=False)
class MovingMesh:
    """At most MAX_JOINTS things as one skinned mesh, a joint for each.

    pivot, axis: (k, 3); amplitude_rad: (k,), NaN for a spin; period_s: (k,); lamp: (k, 4) centre and radius of the
    glow of those that are lamps, radius 0 for the others.
    """

    mesh: CharacterMesh
    pivot: Floats
    axis: Floats
    amplitude_rad: Floats
    period_s: Floats
    lamp: Floats

    def matrices(self, time_s: float) -> NDArray[np.float32]:
        """(k, 4, 4) skin matrices at a time."""
        phase = time_s / self.period_s + 0.31 * self.pivot[:, 0] + 0.17 * self.pivot[:, 2]
        gust = 0.62 + 0.38 * np.sin(2.0 * np.pi * time_s / GUST_S + 0.8 * self.pivot[:, 0])
        sway = np.nan_to_num(self.amplitude_rad) * gust * np.sin(2.0 * np.pi * phase)
        angle = np.where(np.isnan(self.amplitude_rad), 2.0 * np.pi * (phase % 1.0), sway)
        c, s = np.cos(angle)[:, None, None], np.sin(angle)[:, None, None]
        x, y, z = self.axis.T
        zero = np.zeros_like(x)
        cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
        turn = c * np.eye(3) + s * cross + (1.0 - c) * (self.axis[:, :, None] * self.axis[:, None, :])
        result = np.zeros((len(angle), 4, 4), dtype=np.float32)
        result[:, :3, :3] = turn
        result[:, :3, 3] = self.pivot - (turn @ self.pivot[:, :, None])[..., 0]
        result[:, 3, 3] = 1.0
        return result


def read_motion(extras: Mapping[str, Any], where: Where) -> Motion | None:
    """A node's ``sway`` or ``spin``, None where it has neither. Raises BadInput."""
    for name in ("sway", "spin"):
        if name not in extras:
            continue
        values = extras[name]
        try:
            axis = np.array([float(v) for v in values["axis"]])
            period_s = float(values["period_s"])
            amplitude = np.radians(float(values["amplitude_deg"])) if name == "sway" else None
            length = float(np.linalg.norm(axis))
            if axis.shape != (3,) or not (length > 1e-6 and 0.05 <= period_s <= 3600.0 and abs(amplitude or 0) < 3.2):
                raise ValueError("out of range")
        except (KeyError, TypeError, ValueError) as error:
            raise BadInput(
                f"{name} of a node", where=where, expected="axis, period_s, amplitude_deg", seen=error
            ) from None
        x, y, z = (float(v) for v in axis / length)
        return Motion((x, y, z), amplitude, period_s)
    return None


_BREEZE = Motion((0.0, 0.0, 1.0), float(np.radians(5.0)), 2.7)


def hanging_bulbs(part: Part) -> tuple[Part, Motion, Floats] | None:
    """A still part that is really a string of bulbs: the part, how they sway, and a pivot (v, 3) at the top of each."""
    if part.material.name != _BULB or part.material.kind != "flat":
        return None
    piece = loose_pieces(part.triangle)
    top = np.full(piece.max() + 1, -np.inf)
    np.maximum.at(top, piece, part.position[:, 1])
    count = np.bincount(piece)
    middle = [np.bincount(piece, part.position[:, i]) / count for i in (0, 2)]
    pivot = np.stack([middle[0], top, middle[1]], axis=1)[piece]
    return replace(part, group="sway:bulbs"), _BREEZE, pivot.astype(np.float32)


def moving_meshes(things: Sequence[tuple[Part, Motion, Floats]]) -> tuple[MovingMesh, ...]:
    """Parts with their motions and pivots (v, 3), joined into as few meshes as the joints allow."""
    rows: list[tuple[Part, Motion, Floats]] = []  # one thing, one material each
    keys: list[tuple[str, bytes]] = []
    for part, motion, pivot in things:
        places, number = np.unique(pivot, axis=0, return_inverse=True)
        number = number.ravel()
        for k in range(len(places)):
            rows.append((_only(part, number == k), motion, places[k]))
            keys.append((part.group, places[k].tobytes()))
    bodies = list(dict.fromkeys(keys))
    return tuple(
        _joined([row for row, key in zip(rows, keys, strict=True) if key in chosen], chosen)
        for chosen in (bodies[i : i + MAX_JOINTS] for i in range(0, len(bodies), MAX_JOINTS))
    )


def _only(part: Part, kept: NDArray[np.bool_]) -> Part:
    """The vertices of one thing."""
    place = np.cumsum(kept) - 1
    triangle = part.triangle[kept[part.triangle].all(axis=1)]
    own = replace(
        part,
        position=part.position[kept],
        normal=part.normal[kept],
        outline=part.outline[kept],
        triangle=place[triangle].astype(np.uint32),
        extra=None,
    )
    own = replace(own, triangle=turned_outward(own))
    return coarser(own, _COARSE_M) if len(own.triangle) > _COARSE_FROM else own


def _glows(part: Part) -> bool:
    name = part.material.name
    lamp = any(word in part.group for word in _LAMPS) and any(word in name for word in _GLOWING)
    return lamp and not name.endswith(_DARK)


def _joined(rows: Sequence[tuple[Part, Motion, Floats]], bodies: Sequence[tuple[str, bytes]]) -> MovingMesh:
    motion_of: dict[int, tuple[Motion, Floats]] = {}
    lamp = np.zeros((len(bodies), 4))
    parts = []
    for part, motion, pivot in rows:
        joint = bodies.index((part.group, pivot.tobytes()))
        motion_of[joint] = (motion, pivot)
        count = len(part.position)
        extra = np.zeros((count, 4), np.float32)
        if _glows(part):
            extra[:, 0] = 1.0
            low, high = part.position.min(axis=0), part.position.max(axis=0)
            lamp[joint] = (*((low + high) / 2.0), min(0.5 * float((high - low).max()), _HALO_M))
        joints = np.zeros((count, 4), np.uint8)
        joints[:, 0] = joint
        weight = np.zeros((count, 4), np.uint8)
        weight[:, 0] = 255
        parts.append(replace(part, joint=joints, weight=weight, extra=extra))
    order = range(len(bodies))
    motions = [motion_of[i][0] for i in order]
    return MovingMesh(
        mesh=merge_character(parts, len(bodies)),
        pivot=np.array([motion_of[i][1] for i in order], dtype=np.float64),
        axis=np.array([motion.axis for motion in motions]),
        amplitude_rad=np.array([np.nan if m.amplitude_rad is None else m.amplitude_rad for m in motions]),
        period_s=np.array([motion.period_s for motion in motions]),
        lamp=lamp,
    )
