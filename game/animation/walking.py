"""Legs that walk, layered under what the engine's units do with trunk, head and hands; for many characters at once.

How a step goes is told in walk/walk.c. Phase and amount come from outside, so that the same moment looks the same at
any rate of ticks.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation.pose import Pose
from game.core.compiled import Machine
from game.core.humanoid import REFERENCE

__all__ = ["Walk"]

Floats = NDArray[np.floating[Any]]

_MODULE = Path(__file__).with_name("walk.wasm")
_BODY = np.dtype(
    [
        ("joints", "<i4"), ("hips", "<i4"), ("spine", "<i4"), ("leg", "<i4", (2, 3)), ("arm", "<i4", (2, 3)),
        ("rest", "<f4", 3), ("hip_m", "<f4"), ("ankle_m", "<f4"), ("thigh_m", "<f4"), ("shin_m", "<f4"),
    ]
)  # fmt: skip
"""Body in walk/walk.c."""


class Walk:
    """Makes poses walk. For one thread at a time."""

    def __init__(self) -> None:
        self._machine = Machine(_MODULE)
        self._walk = self._machine.function("walk", "IiIII")
        self._body = self._machine.kept(_body(), _BODY)

    def __call__(self, pose: Pose, phase: Floats, length_m: Floats, amount: Floats) -> Pose:
        """The pose with legs, hips and arms walking. phase: (n,) cycles; length_m: (n,) of ground per cycle; amount:
        (n,) 0 leaves the pose as it is, 1 walks. Trunk, head and fingers keep what the units do."""
        n, block = len(pose), self._machine.block
        rotation, root = block(pose.rotation.shape, np.float32), block((n, 3), np.float32)
        stride = block((n, 3), np.float32)
        rotation.data[...], root.data[...] = pose.rotation, pose.root
        # Whole cycles away: a float of hours knows no part of a step.
        stride.data[:, 0], stride.data[:, 1], stride.data[:, 2] = phase % 1.0, length_m, amount
        self._walk(self._body.address, n, rotation.address, root.address, stride.address)
        return replace(pose, rotation=rotation.data, root=root.data)


def _body() -> NDArray[np.void]:
    index, place = REFERENCE.index, REFERENCE.rest_model[:, :3, 3]
    body = np.zeros((), dtype=_BODY)
    body["joints"], body["hips"], body["spine"] = len(REFERENCE), index["hips"], index["spine"]
    for side, name in enumerate(("left", "right")):
        body["leg"][side] = [index[f"{name}{bone}"] for bone in ("UpperLeg", "LowerLeg", "Foot")]
        body["arm"][side] = [index[f"{name}{bone}"] for bone in ("UpperArm", "LowerArm", "Hand")]
    hip, knee, ankle = place[body["leg"][0]]
    body["rest"], body["hip_m"], body["ankle_m"] = place[body["hips"]], hip[1], ankle[1]
    # In the plane that the leg swings in.
    body["thigh_m"], body["shin_m"] = np.linalg.norm((knee - hip)[1:]), np.linalg.norm((ankle - knee)[1:])
    return body
