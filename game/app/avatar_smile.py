"""Avatars whose joy is no smile: some files compose it of the mouths of speech, and an "oh" reads as surprise."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.formats import VrmExpression
from game.render.avatar_model import AvatarModel

__all__ = ["smile_instead"]

Floats = NDArray[np.floating[Any]]

_SPOKEN = ("aa", "ih", "ou", "ee", "oh")
_MOVED = 0.2  # of the farthest way: what moves so far when the avatar speaks is its mouth
_STILL = 0.02  # of the same: so little is none
_CORNER, _MIDDLE = 0.8, 0.35  # of the half width
_NO_SMILE, _SMILE = 0.01, 0.05  # rise of the corners in parts of the mouth's width


def smile_instead(model: AvatarModel, expressions: Mapping[str, VrmExpression]) -> str | None:
    """The spoken mouth that smiles most, for a file whose ``happy`` is made of spoken mouths and does not smile.

    A smile pulls the corners of the lips up (AU 12 of Ekman & Friesen's FACS, 1978): they rise against the middle. None
    where ``happy`` smiles or has shapes of its own, and where no mouth smiles.
    """
    spoken = {name: expressions[name] for name in _SPOKEN if name in expressions}
    happy = expressions.get("happy")
    if happy is None or not spoken:
        return None
    rest = model.geometry.position.astype(np.float64)
    ways = {name: _way(model, expression, len(rest)) for name, expression in spoken.items()}
    far = np.max([np.linalg.norm(way, axis=1) for way in ways.values()], axis=0)
    mouth = np.flatnonzero(far > _MOVED * far.max(initial=0.0))
    known = {bind[:2] for expression in spoken.values() for bind in expression.morphs}
    own = VrmExpression("own", False, tuple(bind for bind in happy.morphs if bind[:2] not in known))
    if len(mouth) < 4 or np.abs(_way(model, own, len(rest))[mouth]).max() > _STILL * far.max():
        return None
    if _rise(rest[mouth], _way(model, happy, len(rest))[mouth]) > _NO_SMILE:
        return None
    rises = {name: _rise(rest[mouth], way[mouth]) for name, way in ways.items()}
    best = max(rises, key=lambda name: rises[name])
    return best if rises[best] > _SMILE else None


def _way(model: AvatarModel, expression: VrmExpression, vertices: int) -> Floats:
    """(V, 3): where the whole expression moves every vertex, m."""
    way = np.zeros((vertices, 3))
    for mesh, target, weight in expression.morphs:
        slot = model.slots.get((mesh, target))
        if slot is not None:
            vertex, moved = model.moved[slot]
            way[vertex] += weight * moved[:, :3]
    return way


def _rise(mouth: Floats, way: Floats) -> float:
    """How far the corners (n, 3) rise against the middle, in parts of the mouth's width at rest."""
    width = float(np.ptp(mouth[:, 0]))
    before, after = _corners_above_middle(mouth), _corners_above_middle(mouth + way)
    return (after - before) / width if width > 0.0 else 0.0


def _corners_above_middle(place: Floats) -> float:
    """m; 0 where there is no middle."""
    aside = np.abs(place[:, 0] - place[:, 0].mean())
    corner, middle = aside >= _CORNER * aside.max(), aside <= _MIDDLE * aside.max()
    return float(place[corner, 1].mean() - place[middle, 1].mean()) if middle.any() else 0.0
