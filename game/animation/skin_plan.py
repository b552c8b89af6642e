"""What moves in a rig and what only goes along: the order in which skin matrices are made, worked out once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation.chains import Chains, chains_of
from game.core import quaternion as quat
from game.core.skeleton import Skeleton

__all__ = ["SkinPlan", "Sources", "skin_plan", "sources_of"]

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Sources:
    """Where joints get their local rotations: a pool of those that follow the pose, the eyes' and the twists', then
    constant ones. of: (J,) row of the pool; size: rows; rest: (R, 4) the constant ones."""

    of: Ints
    size: int
    rest: Floats


def sources_of(skeleton: Skeleton, driven: Ints, eyes: Ints, twist: Ints) -> Sources:
    """Twists come before eyes, and eyes before what else would drive a joint."""
    of = np.full(len(skeleton), -1, dtype=np.intp)
    at = 0
    for joints in (driven, eyes, twist):
        of[joints] = at + np.arange(len(joints))
        at += len(joints)
    still = np.flatnonzero(of < 0)
    rest, where = np.unique(skeleton.rest_rotation[still], axis=0, return_inverse=True)
    of[still] = at + where.reshape(-1)
    sources = Sources(of, at + len(rest), rest.reshape(-1, 4).astype(np.float32))
    _freeze(sources)
    return sources


@dataclass(frozen=True, eq=False)
class SkinPlan:
    """M joints by depth. source: (M,) rows of Sources; shift: (M, 3) local rest translations; hips: which of them takes
    the root's translation. chains: how they hang together. column: (K,) the joint a skin column goes with, bind:
    (K, 4, 4) its inverse bind matrix seen from there; by_element: (3, 4, K, 1) the same by element. back: (J,) places
    of the skeleton's joints, where all are among the M."""

    source: Ints
    shift: Floats
    hips: int
    chains: Chains
    column: Ints
    bind: Floats
    by_element: Floats
    back: Ints


def skin_plan(
    skeleton: Skeleton, sources: Sources, hips: int, skin_joint: Ints, inverse_bind: Floats, moving: NDArray[np.bool_]
) -> SkinPlan:
    """moving: (J,) joints that may turn in their parents. They and all above them are kept; what hangs still on a kept
    joint becomes part of its skin columns' bind matrices."""
    count, parents = len(skeleton), skeleton.parents
    kept = moving | (parents < 0)
    for joint in range(count - 1, -1, -1):
        if kept[joint] and parents[joint] >= 0:
            kept[parents[joint]] = True
    local = np.tile(np.eye(4), (count, 1, 1))
    local[:, :3, :3] = quat.to_matrix(skeleton.rest_rotation)
    local[:, :3, 3] = skeleton.rest_translation
    anchor, still = np.arange(count), np.tile(np.eye(4), (count, 1, 1))
    for joint in np.flatnonzero(~kept).tolist():
        parent = parents[joint]
        anchor[joint], still[joint] = anchor[parent], still[parent] @ local[joint]
    order = np.concatenate([level[kept[level]] for level in skeleton.levels])
    place = np.zeros(count, dtype=np.intp)
    place[order] = np.arange(len(order))
    above = np.where(parents[order] < 0, -1, place[np.maximum(parents[order], 0)])
    bind = (still[skin_joint] @ inverse_bind).astype(np.float32)
    plan = SkinPlan(
        source=sources.of[order],
        shift=skeleton.rest_translation[order].astype(np.float32),
        hips=int(place[hips]),
        chains=chains_of(above),
        column=place[anchor[skin_joint]],
        bind=bind,
        by_element=np.ascontiguousarray(bind[:, :3].transpose(1, 2, 0))[..., None],
        back=place,
    )
    _freeze(plan)
    return plan


def _freeze(made: object) -> None:
    for value in vars(made).values():
        if isinstance(value, np.ndarray):
            value.setflags(write=False)
