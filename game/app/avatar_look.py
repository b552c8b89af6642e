"""From weights of an avatar's expressions to what the renderer draws: morph slots, colours, texture places."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.formats import VrmExpression
from game.render.avatar_model import AvatarLook, AvatarModel

__all__ = ["AvatarLooks"]

Floats = NDArray[np.floating[Any]]

_LEAST = 1e-3


class AvatarLooks:
    """Constants of one avatar. Immutable."""

    def __init__(self, model: AvatarModel, expressions: Sequence[VrmExpression]) -> None:
        self._model = model
        self._expressions = tuple(expressions)
        self._morph = np.zeros((len(self._expressions), len(model.moved)), dtype=np.float32)
        for row, expression in enumerate(self._expressions):
            for mesh, target, weight in expression.morphs:
                slot = model.slots.get((mesh, target))
                if slot is not None:
                    self._morph[row, slot] += weight

    def at(self, weight: Floats) -> AvatarLook:
        """weight: (E,) of the expressions. Several that change one thing add up, as VRMC_vrm says."""
        colours: dict[tuple[int, str], tuple[float, ...]] = {}
        shifts: dict[int, tuple[float, float, float, float]] = {}
        for value, expression in zip(weight.tolist(), self._expressions, strict=True):
            if value < _LEAST:
                continue
            for material, what, target in expression.colours:
                own = getattr(self._model.materials[material], what)
                now = colours.get((material, what), own)
                mixed = [n + value * (t - o) for n, t, o in zip(now, target, own, strict=False)]
                colours[material, what] = tuple(mixed)
            for material, scale, offset in expression.shifts:
                sx, sy, ox, oy = shifts.get(material, (1.0, 1.0, 0.0, 0.0))
                shifts[material] = (
                    sx + value * (scale[0] - 1.0),
                    sy + value * (scale[1] - 1.0),
                    ox + value * offset[0],
                    oy + value * offset[1],
                )
        morph = weight.astype(np.float32) @ self._morph if len(weight) else np.zeros(len(self._model.moved), np.float32)
        return AvatarLook(np.asarray(morph, dtype=np.float32), colours, shifts)
