"""Where the hands are wanted, and what keeps them out of body and table.

A unit says where its hands are in a frame: the table's, the head's, the chest's or the hips'. One array of matrices
holds the table, both palms as the row gives them, and the figure.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import bilinear as bl
from game.animation import channels as ch
from game.animation import collision, figure
from game.animation.chains import chains_of, to_model
from game.core.humanoid import REFERENCE
from game.core.springs import half_life_to_damping

__all__ = ["FRAMES", "GOALS", "SLOTS", "advance_push", "aim", "body_matrices", "clearance", "slot"]

Floats = NDArray[np.floating[Any]]

PUSH_HALF_LIFE_S = 0.025
"""How softly body and table let go of a hand."""
_GONE_M = np.float32(1e-7)

_FIRST = 3
_GOALS = _FIRST + len(figure.FIGURE)
SLOTS = _GOALS + 4
"""Matrices per character: table, left and right palm, figure, and where both hands and both feet shall be."""
GOALS = slice(_GOALS, SLOTS)


def slot(joint: str) -> int:
    """Place of a figure's joint in body_matrices."""
    return _FIRST + figure.WHERE[joint]


FRAMES: NDArray[np.intp] = np.array([0, *(slot(name) for name in ch.CONTACT_FRAMES[1:])])
"""(4,) places of CONTACT_FRAMES in body_matrices; the table does not move, so it is at model space's origin."""

# The table and the palms stand alone, at depth 0 as the hips.
_CHAINS = chains_of(np.append(np.full(_FIRST, -1), np.where(figure.PARENTS < 0, -1, figure.PARENTS + _FIRST)))
_QUATERNIONS = np.concatenate([ch.JOINTS + np.arange(2), figure.FIGURE])
_OFFSET = REFERENCE.rest_translation[figure.FIGURE[1:]].astype(np.float32)
_BODY = np.array([slot(name) for name in collision.BODY_JOINTS])
_TABLE = np.eye(4, dtype=np.float32)
_FEET = np.tile(_TABLE, (2, 1, 1))
_FEET[:, :3, 3] = figure.FEET_WORLD
# Homogeneous points in the hand's frame: wrist, middle of the palm, then what the row says.
_IN_HAND = np.zeros((2, 2 + ch.POINTS_PER_HAND, 4), dtype=np.float32)
_IN_HAND[..., 3] = 1.0
_IN_HAND[:, 1, 0] = 0.05, -0.05
# The middle of the forearm from its elbow, its wrist in the clip and the wrist that is wanted, in the order in which
# they stand in body_matrices: the elbow follows the wrist about half way.
_FOREARM = np.array([[0.5, 0.0, -0.25, 0.0, 0.75, 0.0], [0.0, 0.5, 0.0, -0.25, 0.0, 0.75]], dtype=np.float32)
_ARMS = slice(_GOALS - 4, _GOALS + 2)
for _array in (FRAMES, _QUATERNIONS, _OFFSET, _BODY, _TABLE, _FEET, _IN_HAND, _FOREARM):
    _array.setflags(write=False)


def body_matrices(turns: Floats, places: Floats) -> Floats:
    """turns: (n, 43, 4) unit quaternions of ch.TURNS, places: (n, 9) of ch.PLACES -> (n, SLOTS, 4, 4): the table, the
    palms in their contact frames, and in model space the figure. The goals are left to aim."""
    n = len(turns)
    matrices = np.empty((n, SLOTS, 4, 4), dtype=np.float32)
    matrices[:, 0] = _TABLE
    bl.affine(turns.take(_QUATERNIONS, axis=1), out=matrices.reshape(n, SLOTS, 16)[:, 1:_GOALS])
    matrices[:, 1:4, :3, 3] = places.reshape(n, 3, 3)
    matrices[:, 4:_GOALS, :3, 3] = _OFFSET
    to_model(matrices, _CHAINS)
    return matrices


def aim(matrices: Floats, frame: NDArray[np.intp]) -> None:
    """Writes the goals: both hands are kept in their contact frames (n, 2), the feet stand."""
    n = len(matrices)
    at = FRAMES.take(frame)
    at += np.arange(0, n * SLOTS, SLOTS)[:, None]
    np.matmul(matrices.reshape(-1, 4, 4).take(at, axis=0), matrices[:, 1:3], out=matrices[:, _GOALS : _GOALS + 2])
    matrices[:, _GOALS + 2 :] = _FEET


def clearance(matrices: Floats, points: Floats) -> Floats | None:
    """The push (n, 2, 3), metres, that keeps both hands and forearms out of body and table, None where they are.

    points: (n, 24) of ch.POINTS.
    """
    n = len(matrices)
    local = np.empty((n, *_IN_HAND.shape), dtype=np.float32)
    local[:] = _IN_HAND
    local[:, :, 2:, :3] = points.reshape(n, 2, ch.POINTS_PER_HAND, 3)
    model = np.empty((n, 2, 7, 4), dtype=np.float32)
    hand = matrices[:, _GOALS : _GOALS + 2]
    np.matmul(local, hand.swapaxes(-1, -2), out=model[:, :, :6])
    np.matmul(_FOREARM, matrices[:, _ARMS, :, 3], out=model[:, :, 6])
    return collision.push_out(collision.body_frames(matrices.take(_BODY, axis=1)), model.reshape(n, 14, 4))


def advance_push(state: Floats, wanted: Floats | None, dt_s: float) -> Floats:
    """How far the hands are held off, and how fast that changes: (n, 2, 2, 3), metres and metres per second.

    Along its way at least what is wanted (n, 2, 3), None for nothing anywhere: a surface stops a hand at once, and
    lets go of it softly.
    """
    if wanted is None:
        if not np.count_nonzero(state):
            return state
        after = (_let_go(dt_s) @ state.reshape(-1, 2, 6)).reshape(state.shape)
        after *= np.abs(after) > _GONE_M
        return np.asarray(after)
    away = state.copy()
    away[:, 0] -= wanted
    after = (_let_go(dt_s) @ away.reshape(-1, 2, 6)).reshape(state.shape)
    push = after[:, 0]
    push += wanted
    square = (wanted * wanted).sum(axis=-1, keepdims=True)
    lacking = 1.0 - (push * wanted).sum(axis=-1, keepdims=True) / np.maximum(square, 1e-12)
    push += wanted * np.maximum(lacking, 0.0)
    return np.asarray(after)


@lru_cache(maxsize=16)
def _let_go(dt_s: float) -> Floats:
    """(2, 2): a critically damped spring over dt (game.core.springs) as a matrix on distance and speed."""
    y = float(half_life_to_damping(PUSH_HALF_LIFE_S)) / 2.0
    decay = np.exp(-y * dt_s)
    step = decay * np.array([[1.0 + y * dt_s, dt_s], [-y * y * dt_s, 1.0 - y * dt_s]])
    return np.asarray(step, dtype=np.float32)
