"""The compiled side of a rig (skin/*.c): its tables in the module's memory, and the call that skins n characters."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation.pose import Pose
from game.core.compiled import Block, Machine
from game.core.humanoid import REFERENCE

__all__ = ["EYES", "FOLD", "JOINT", "RIG", "ROOM_BYTES", "SPRUNG", "Columns", "SkinLoop", "SkinTables"]

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.intp]
Table = NDArray[np.void]

_MODULE = Path(__file__).with_name("skin.wasm")

# As in skin/rig.h.
JOINT = np.dtype([("parent", "<i4"), ("source", "<i4"), ("offset", "<f4", 3)])
FOLD = np.dtype([("bone", "<i4"), ("above", "<i4"), ("below", "<i4")])
EYES = np.dtype([("yaw", "<f4", (2, 2)), ("pitch", "<f4", 2)])
SPRUNG = np.dtype([("joint", "<i4"), ("first", "<i4"), ("pieces", "<i4")])
RIG = np.dtype(
    [
        ("joints", "<i4"), ("joint", "<u4"), ("hips", "<i4"), ("hips_rest", "<f4", 3), ("reference", "<i4"),
        ("folds", "<i4"), ("fold", "<u4"), ("tips", "<i4"), ("tip", "<u4"), ("tip_share", "<f4"), ("eyes", "<u4"),
        ("twists", "<i4"), ("hand", "<u4"), ("twist_share", "<f4"), ("most_half_twist", "<f4", 2), ("fit", "<u4"),
        ("sprung", "<i4"), ("spring", "<u4"), ("pieces", "<i4"), ("piece", "<u4"),
        ("colliders", "<i4"), ("collider", "<u4"), ("met", "<u4"),
        ("turn", "<u4"), ("model", "<u4"), ("pull", "<u4"), ("capsule", "<u4"),
    ]
)  # fmt: skip
_COUNTS = {
    "joints": "joint",
    "folds": "fold",
    "tips": "tip",
    "twists": "hand",
    "sprung": "spring",
    "pieces": "piece",
    "colliders": "collider",
}
ROOM_BYTES = {"turn": 16, "model": 64, "pull": 8, "capsule": 28}
"""Sizes of Quat, Mat4, Pull and Capsule, in which the compiled side works."""


@dataclass(frozen=True, eq=False)
class SkinTables:
    """What skin/rig.h's Rig is made of. eyes, fit: none or one; the counts are the tables' lengths."""

    joint: Table
    hips: int
    hips_rest: Floats
    fold: Table
    tip: Ints
    tip_share: float
    eyes: Table
    hand: Ints
    twist_share: float
    most_half_twist: tuple[float, float]
    fit: Table
    spring: Table
    piece: Table
    collider: Table
    met: Ints


@dataclass(frozen=True, eq=False)
class Columns:
    """What is made of the joints: the joint (K,) of every column and what leads to its frame (K, 4, 4)."""

    joint: Block
    bind: Block


class _Room:
    """Where n characters' poses and springs are handed over."""

    def __init__(self, machine: Machine, n: int, pieces: int) -> None:
        self.rotation = machine.block((n, len(REFERENCE), 4), np.float32)
        self.root = machine.block((n, 3), np.float32)
        self.gaze = machine.block((n, 2), np.float32)
        self.before = machine.block((n, pieces, 2, 3), np.float32)
        self.after = machine.block((n, pieces, 2, 3), np.float32)
        self.addresses = tuple(room.address for room in (self.rotation, self.root, self.gaze))


class SkinLoop:
    """Skins characters of one rig. For one thread at a time."""

    def __init__(self, tables: SkinTables) -> None:
        self._machine = machine = Machine(_MODULE)
        self._skin = machine.function("skin", "IiIIIIIiIIIf")
        self._kept: list[Block] = []
        self._pieces = len(tables.piece)
        turns = len(REFERENCE) + len(tables.tip) + 2 + len(tables.hand)
        rig = np.zeros((), dtype=RIG)
        for name in ("joint", "fold", "tip", "eyes", "hand", "fit", "spring", "piece", "collider", "met"):
            table = getattr(tables, name)
            rig[name] = self._keep(table, table.dtype if table.dtype.names else np.int32) if len(table) else 0
        for number, name in _COUNTS.items():
            rig[number] = len(getattr(tables, name))
        for name in ("hips", "hips_rest", "tip_share", "twist_share", "most_half_twist"):
            rig[name] = getattr(tables, name)
        rig["reference"] = len(REFERENCE)
        rooms = zip(ROOM_BYTES.items(), (turns, *map(len, (tables.joint, tables.piece, tables.collider))), strict=True)
        for (name, size), count in rooms:
            self._kept.append(machine.block(size * count, np.uint8))
            rig[name] = self._kept[-1].address
        self._rig = self._keep(rig, RIG)
        self._room = _Room(machine, 1, self._pieces)

    def columns(self, joint: Ints, bind: Floats) -> Columns:
        """joint: (K,) places in the table of joints; bind: (K, 4, 4)."""
        return Columns(self._machine.kept(joint, np.int32), self._machine.kept(bind, np.float32))

    def matrices(self, pose: Pose, columns: Columns) -> Floats:
        """(n, K, 4, 4), springs at rest."""
        return self._call(pose, columns, 0, 0, 0.0)

    def swing(self, pose: Pose, columns: Columns, before: Floats | None, dt_s: float) -> tuple[Floats, Floats]:
        """One step of the springs -> tails and speeds (n, S, 2, 3), and (n, K, 4, 4). before: the last step's tails and
        speeds, None at first: the pose decides where everything hangs."""
        room = self._room_for(len(pose))
        if before is not None:
            room.before.data[...] = before
        found = self._call(pose, columns, 0 if before is None else room.before.address, room.after.address, dt_s)
        after = room.after.data.copy()
        after.setflags(write=False)
        return after, found

    def _call(self, pose: Pose, columns: Columns, before: int, after: int, dt_s: float) -> Floats:
        n, room = len(pose), self._room_for(len(pose))
        room.rotation.data[...] = pose.rotation
        room.root.data[...] = pose.root
        room.gaze.data[...] = pose.gaze
        count = len(columns.joint.data)
        skin = self._machine.block((n, count, 4, 4), np.float32)
        places = columns.joint.address, columns.bind.address, skin.address
        self._skin(self._rig, n, *room.addresses, before, after, count, *places, dt_s)
        return skin.data

    def _room_for(self, n: int) -> _Room:
        if len(self._room.root.data) != n:
            self._room = _Room(self._machine, n, self._pieces)
        return self._room

    def _keep(self, array: NDArray[Any], dtype: Any) -> int:
        self._kept.append(self._machine.kept(array, dtype))
        return self._kept[-1].address
