"""A joint hierarchy, parents first, validated once when it is made."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import quaternion as quat
from game.core.errors import BadInput

__all__ = ["Skeleton"]

Floats = NDArray[np.floating[Any]]


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Names, parents and rest pose of J joints.

    names: J unique joint names.
    parents: (J,) int, -1 for a root; every parent stands before its children.
    rest_translation: (J, 3) metres, each in its parent's frame (a root's in model space).
    rest_rotation: (J, 4) unit quaternions x, y, z, w, local.
    Raises BadInput where that does not hold.
    """

    names: tuple[str, ...]
    parents: NDArray[np.intp]
    rest_translation: Floats
    rest_rotation: Floats

    def __post_init__(self) -> None:
        count = len(self.names)
        parents = np.array(self.parents, dtype=np.intp)
        translation = np.array(self.rest_translation, dtype=np.float64)
        rotation = np.array(self.rest_rotation, dtype=np.float64)
        if count == 0:
            raise BadInput("skeleton", expected="at least one joint", seen=0)
        if len(set(self.names)) != count:
            raise BadInput("skeleton", expected="unique joint names", seen=", ".join(self.names))
        if parents.shape != (count,) or translation.shape != (count, 3) or rotation.shape != (count, 4):
            raise BadInput("skeleton", expected=f"arrays for {count} joints", seen=parents.shape)
        if np.any(parents >= np.arange(count)) or np.any(parents < -1):
            raise BadInput("skeleton", expected="every parent before its children", seen=parents.tolist())
        if not (np.isfinite(translation).all() and np.isfinite(rotation).all()):
            raise BadInput("skeleton", expected="finite rest pose", seen="NaN or infinity")
        for array in (parents, translation, rotation):
            array.setflags(write=False)
        object.__setattr__(self, "parents", parents)
        object.__setattr__(self, "rest_translation", translation)
        object.__setattr__(self, "rest_rotation", rotation)

    def __len__(self) -> int:
        return len(self.names)

    @cached_property
    def index(self) -> dict[str, int]:
        """Joint name -> index."""
        return {name: i for i, name in enumerate(self.names)}

    @cached_property
    def levels(self) -> tuple[NDArray[np.intp], ...]:
        """Joint indices by depth, roots first: everything in one level can be computed at once."""
        depth = np.zeros(len(self), dtype=np.intp)
        for joint, parent in enumerate(self.parents):
            depth[joint] = 0 if parent < 0 else depth[parent] + 1
        return tuple(np.flatnonzero(depth == d) for d in range(int(depth.max()) + 1))

    @cached_property
    def rest_model(self) -> Floats:
        """(J, 4, 4) model-space matrices of the rest pose."""
        position, rotation = self.to_model(self.rest_rotation)
        matrices = np.zeros((len(self), 4, 4))
        matrices[:, :3, :3] = quat.to_matrix(rotation)
        matrices[:, :3, 3] = position
        matrices[:, 3, 3] = 1.0
        matrices.setflags(write=False)
        return matrices

    def to_model(self, rotation: Floats, translation: Floats | None = None) -> tuple[Floats, Floats]:
        """Forward kinematics.

        rotation: (..., J, 4) local; translation: (..., J, 3) local, the rest pose's where None.
        -> model-space positions (..., J, 3) in metres and rotations (..., J, 4).
        """
        shift = self.rest_translation.astype(rotation.dtype) if translation is None else translation
        shift = np.broadcast_to(shift, (*rotation.shape[:-1], 3))
        position_model = np.empty(shift.shape, dtype=rotation.dtype)
        rotation_model = np.empty_like(rotation)
        for level in self.levels:
            parent = self.parents[level]
            if parent[0] < 0:
                position_model[..., level, :] = shift[..., level, :]
                rotation_model[..., level, :] = rotation[..., level, :]
                continue
            parent_rotation = rotation_model[..., parent, :]
            position_model[..., level, :] = position_model[..., parent, :] + quat.rotate(
                parent_rotation, shift[..., level, :]
            )
            rotation_model[..., level, :] = quat.multiply(parent_rotation, rotation[..., level, :])
        return position_model, rotation_model

    def to_local(self, rotation_model: Floats) -> Floats:
        """Model-space rotations (..., J, 4) -> local rotations (..., J, 4)."""
        parent = np.maximum(self.parents, 0)
        local = quat.multiply(quat.conjugate(rotation_model[..., parent, :]), rotation_model)
        return np.asarray(np.where((self.parents < 0)[:, None], rotation_model, local))
