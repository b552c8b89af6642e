"""From poses to the matrices that move a character's mesh: retargeting, forearm twist, springs, skinning."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import bilinear as bl
from game.animation.crowd import crowd_matrices
from game.animation.pose import Pose
from game.animation.springbones import (
    SpringChain,
    SpringCollider,
    SpringSet,
    SpringState,
    advance_springs,
    build_springs,
    start_springs,
)
from game.core import quaternion as quat
from game.core.errors import BadInput
from game.core.humanoid import REFERENCE
from game.core.skeleton import Skeleton

__all__ = ["Rig"]

Floats = NDArray[np.floating[Any]]

CROWD = 16
"""From this many characters on, whole-crowd arithmetic per component beats matrices joint by joint."""
TWIST_SHARE = 0.5
"""The twist joint in the middle of a forearm takes this share of the hand's twist."""
MAX_TWIST_RAD = 2.6

_SIDES = ("left", "right")


@dataclass(frozen=True, eq=False)
class Rig:
    """A character's skeleton and skin. Make it with from_arrays.

    skeleton: J joints. skin_joint: (K,) joint of every skin column; inverse_bind: (K, 4, 4). driven: (D,) joints
    that follow a joint of the reference skeleton, source: (D,) which. twist, twist_hand: forearm twist joints and the
    hands (in REFERENCE) whose twist they share. before, after: (D, 4) constant rotations for a rest pose that is not
    the identity, None where it is. hips: joint that takes the root's translation.
    """

    skeleton: Skeleton
    skin_joint: NDArray[np.intp]
    inverse_bind: Floats
    driven: NDArray[np.intp]
    source: NDArray[np.intp]
    twist: NDArray[np.intp]
    twist_hand: NDArray[np.intp]
    before: Floats | None
    after: Floats | None
    hips: int
    hips_scale: float
    springs: SpringSet

    @classmethod
    def from_arrays(
        cls,
        names: Sequence[str],
        parents: NDArray[np.integer[Any]],
        rest_translation: NDArray[np.floating[Any]],
        inverse_bind: NDArray[np.floating[Any]] | None = None,
        *,
        rest_rotation: NDArray[np.floating[Any]] | None = None,
        skin_joint: NDArray[np.integer[Any]] | None = None,
        bones: Mapping[str, int] | None = None,
        chains: Sequence[SpringChain] = (),
        colliders: Sequence[SpringCollider] = (),
    ) -> Rig:
        """names, parents (J,) parents first, rest_translation (J, 3) local metres, rest_rotation (J, 4) local.

        inverse_bind: (K, 4, 4) of the skin's columns; the rest pose's own where None. skin_joint: (K,) their joints,
        all in order where None. bones: VRM humanoid bone -> joint, by name where None. Raises BadInput where the
        arrays do not fit or there are no hips.
        """
        count = len(names)
        turned = np.tile(quat.IDENTITY, (count, 1)) if rest_rotation is None else np.asarray(rest_rotation)
        skeleton = Skeleton(tuple(names), np.asarray(parents, dtype=np.intp), np.asarray(rest_translation), turned)
        index = dict(bones) if bones is not None else dict(skeleton.index)
        if "hips" not in index:
            raise BadInput("rig", expected="a joint for the bone hips", seen=", ".join(sorted(index))[:60])
        known = [name for name in REFERENCE.names if name in index]
        driven = np.array([index[name] for name in known], dtype=np.intp)
        twists = [(f"{s}ForearmTwist", f"{s}Hand") for s in _SIDES if f"{s}ForearmTwist" in skeleton.index]
        joint = np.arange(count) if skin_joint is None else np.asarray(skin_joint, dtype=np.intp)
        if joint.size and (joint.min() < 0 or joint.max() >= count):
            raise BadInput("rig", expected=f"skin joints below {count}", seen=int(joint.max()))
        bind = np.linalg.inv(skeleton.rest_model)[joint] if inverse_bind is None else np.asarray(inverse_bind)
        if bind.shape != (len(joint), 4, 4) or not np.isfinite(bind).all():
            raise BadInput("rig", expected=f"({len(joint)}, 4, 4) finite inverse bind matrices", seen=bind.shape)
        before, after = _rest_turns(skeleton, driven)
        hips = index["hips"]
        height = float(skeleton.rest_model[hips, 1, 3])
        return cls(
            skeleton=skeleton,
            skin_joint=joint,
            inverse_bind=bind.astype(np.float32),
            driven=driven,
            source=np.array([REFERENCE.index[name] for name in known], dtype=np.intp),
            twist=np.array([skeleton.index[t] for t, _ in twists], dtype=np.intp),
            twist_hand=np.array([REFERENCE.index[h] for _, h in twists], dtype=np.intp),
            before=before,
            after=after,
            hips=hips,
            hips_scale=height / float(REFERENCE.rest_model[0, 1, 3]) if height > 0 else 1.0,
            springs=build_springs(skeleton, tuple(chains), tuple(colliders)),
        )

    def start(self, n: int) -> SpringState:
        """Springs of n characters, which hang where the first pose puts them."""
        return start_springs(self.springs, n)

    def local_rotations(self, pose: Pose) -> Floats:
        """(n, J, 4) of every joint; springs at rest."""
        n = len(pose)
        rotation = np.empty((n, len(self.skeleton), 4), dtype=np.float32)
        rotation[:] = self.skeleton.rest_rotation
        taken = pose.rotation.take(self.source, axis=1)
        if self.before is not None and self.after is not None:
            taken = bl.multiply(bl.multiply(np.broadcast_to(self.before, taken.shape), taken), self.after)
        rotation[:, self.driven] = taken
        if self.twist.size:
            rotation[:, self.twist] = _half_twist(pose.rotation.take(self.twist_hand, axis=1))
        return rotation

    def root_translation(self, pose: Pose) -> Floats:
        """(n, 3) local translation of the hips joint: the pose's shift from its rest, at this character's size."""
        shift = (pose.root - REFERENCE.rest_translation[0].astype(np.float32)) * np.float32(self.hips_scale)
        parent = int(self.skeleton.parents[self.hips])
        if parent >= 0:
            shift = shift @ self.skeleton.rest_model[parent, :3, :3].astype(np.float32)
        return np.asarray(self.skeleton.rest_translation[self.hips].astype(np.float32) + shift)

    def joint_matrices(self, pose: Pose) -> Floats:
        """(n, J, 4, 4) model-space joint matrices, springs at rest."""
        local = bl.affine(self.local_rotations(pose))
        local[:, :, :3, 3] = self.skeleton.rest_translation
        local[:, self.hips, :3, 3] = self.root_translation(pose)
        for level in self.skeleton.levels[1:]:
            local[:, level] = local.take(self.skeleton.parents[level], axis=1) @ local[:, level]
        return local

    def skin_matrices(self, joint_matrices: Floats) -> Floats:
        """(n, J, 4, 4) -> (n, K, 4, 4): what takes a vertex of the mesh from the bind pose to where it is now."""
        return np.asarray(joint_matrices.take(self.skin_joint, axis=1) @ self.inverse_bind)

    def advance(self, state: SpringState, pose: Pose, dt_s: float) -> tuple[SpringState, Floats]:
        """One tick of the springs -> state and skin matrices (n, K, 4, 4)."""
        if len(pose) >= CROWD and not self.springs.pieces:
            return state, crowd_matrices(self, pose)
        model = self.joint_matrices(pose)
        state = advance_springs(self.springs, state, model, dt_s)
        return state, self.skin_matrices(model)


def _rest_turns(skeleton: Skeleton, driven: NDArray[np.intp]) -> tuple[Floats | None, Floats | None]:
    """A normalised VRM rotation n becomes conj(W_parent)·n·W_joint, W = the rest pose's rotations in model space."""
    _, world = skeleton.to_model(skeleton.rest_rotation)
    parent = skeleton.parents[driven]
    above = np.where((parent < 0)[:, None], quat.IDENTITY, world[np.maximum(parent, 0)])
    if np.allclose(np.abs(above[:, 3]), 1.0, atol=1e-6) and np.allclose(np.abs(world[driven, 3]), 1.0, atol=1e-6):
        return None, None
    return quat.conjugate(above).astype(np.float32), world[driven].astype(np.float32)


def _half_twist(hand: Floats) -> Floats:
    """Local hand rotations (n, T, 4) -> half of their twist about the forearm (the x axis)."""
    angle = 2.0 * np.arctan2(hand[..., 0] * np.sign(hand[..., 3] + 1e-12), np.abs(hand[..., 3]))
    half = np.float32(0.5 * TWIST_SHARE) * np.clip(angle, -MAX_TWIST_RAD, MAX_TWIST_RAD)
    twist = np.zeros(hand.shape, dtype=np.float32)
    twist[..., 0] = np.sin(half)
    twist[..., 3] = np.cos(half)
    return twist
