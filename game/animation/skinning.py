"""From poses to the matrices that move a character's mesh: retargeting, forearm twist, springs, skinning."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import bilinear as bl
from game.animation.arithmetic import Number, arithmetic, columns, numbers
from game.animation.body_size import BodySize
from game.animation.chains import CROWD, to_model
from game.animation.crowd import crowd_matrices
from game.animation.fitting import NEEDED, Fitting, fit_to
from game.animation.pose import Pose
from game.animation.rest_pose import t_pose
from game.animation.skin_plan import SkinPlan, Sources, skin_plan, sources_of
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
from game.core.humanoid import FINGERS, REFERENCE
from game.core.skeleton import Skeleton

__all__ = ["EyeBones", "Rig"]

Floats = NDArray[np.floating[Any]]

TWIST_SHARE = 0.5
"""The twist joint in the middle of a forearm takes this share of the hand's twist."""
MAX_TWIST_RAD = 2.6

TIP_SHARE = 0.65
"""The outermost joint of a finger bends this much as far as the one before it."""

_HIPS = REFERENCE.rest_translation[0].astype(np.float32)
_HIPS.setflags(write=False)
_SIDES = ("left", "right")
_TIPS = {f"{s}{f}Distal": f"{s}{f}Intermediate" for s in _SIDES for f in FINGERS} | {
    f"{s}ThumbDistal": f"{s}ThumbProximal" for s in _SIDES
}


@dataclass(frozen=True)
class EyeBones:
    """Joints of the left and the right eye, and how far they turn when the gaze is at its end (degrees): toward the
    nose, away from it, down, up."""

    left: int
    right: int
    inner_deg: float
    outer_deg: float
    down_deg: float
    up_deg: float


@dataclass(frozen=True, eq=False)
class Rig:
    """A character's skeleton and skin. Make it with from_arrays.

    skeleton: J joints. skin_joint: (K,) joint of every skin column; inverse_bind: (K, 4, 4). driven: (D,) joints
    that follow a joint of the reference skeleton, source: (D,) which; beyond 41: the outermost finger joints, which
    the reference lacks and curl: (C,) joints of the reference share. folds: (bone, missing bone below or above it)
    pairs: the bone takes both rotations. twist, twist_hand: forearm twist joints and the hands (in REFERENCE) whose
    twist they share. before, after: (D, 4) constant rotations for a rest pose that is not the identity, None where it
    is. hips: joint that takes the root's translation. eyes: joints
    that follow the gaze, or None. fitting: None for a body of the reference's own proportions. sources: where local
    rotations come from. whole, moving: how all joints are worked out, and only what moves when springs are at rest.
    """

    skeleton: Skeleton
    skin_joint: NDArray[np.intp]
    inverse_bind: Floats
    driven: NDArray[np.intp]
    source: NDArray[np.intp]
    curl: NDArray[np.intp]
    folds: tuple[tuple[int, int, int], ...]
    twist: NDArray[np.intp]
    twist_hand: NDArray[np.intp]
    before: Floats | None
    after: Floats | None
    hips: int
    fitting: Fitting | None
    eyes: _Eyes | None
    springs: SpringSet
    sources: Sources
    whole: SkinPlan
    moving: SkinPlan

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
        size: BodySize | None = None,
        eyes: EyeBones | None = None,
    ) -> Rig:
        """names, parents (J,) parents first, rest_translation (J, 3) local metres, rest_rotation (J, 4) local; Y up,
        facing +Z, any rest pose.

        inverse_bind: (K, 4, 4) of the skin's columns; the rest pose's own where None. skin_joint: (K,) their joints,
        all in order where None. bones: VRM humanoid bone -> joint, by name where None. size: how the body's parts
        differ from the reference's. eyes: joints that follow
        the gaze. Raises BadInput where the arrays do not fit or there are no hips.
        """
        count = len(names)
        turned = np.tile(quat.IDENTITY, (count, 1)) if rest_rotation is None else np.asarray(rest_rotation)
        skeleton = Skeleton(tuple(names), np.asarray(parents, dtype=np.intp), np.asarray(rest_translation), turned)
        index = dict(bones) if bones is not None else dict(skeleton.index)
        if "hips" not in index:
            raise BadInput("rig", expected="a joint for the bone hips", seen=", ".join(sorted(index))[:60])
        known = [name for name in REFERENCE.names if name in index]
        tips = [tip for tip in _TIPS if tip in index and _TIPS[tip] in index]
        driven = np.array([index[name] for name in (*known, *tips)], dtype=np.intp)
        source = [REFERENCE.index[name] for name in known] + [len(REFERENCE) + i for i in range(len(tips))]
        twists = [(f"{s}ForearmTwist", f"{s}Hand") for s in _SIDES if f"{s}ForearmTwist" in skeleton.index]
        joint = np.arange(count) if skin_joint is None else np.asarray(skin_joint, dtype=np.intp)
        if joint.size and (joint.min() < 0 or joint.max() >= count):
            raise BadInput("rig", expected=f"skin joints below {count}", seen=int(joint.max()))
        bind = np.linalg.inv(skeleton.rest_model)[joint] if inverse_bind is None else np.asarray(inverse_bind)
        if bind.shape != (len(joint), 4, 4) or not np.isfinite(bind).all():
            raise BadInput("rig", expected=f"({len(joint)}, 4, 4) finite inverse bind matrices", seen=bind.shape)
        place, world = t_pose(skeleton, index)
        before, after = _rest_turns(skeleton, driven, world)
        whole = all(bone in index for bone in NEEDED)
        fitting = fit_to({bone: place[at] for bone, at in index.items()}, size) if whole else None
        looking = None if eyes is None else _eyes(skeleton, eyes, world)
        twist = np.array([skeleton.index[t] for t, _ in twists], dtype=np.intp)
        sources = sources_of(skeleton, driven, np.zeros(0, np.intp) if looking is None else looking.joints, twist)
        turning, hips = sources.of < sources.size - len(sources.rest), index["hips"]
        return cls(
            skeleton=skeleton,
            skin_joint=joint,
            inverse_bind=bind.astype(np.float32),
            driven=driven,
            source=np.array(source, dtype=np.intp),
            curl=np.array([REFERENCE.index[_TIPS[tip]] for tip in tips], dtype=np.intp),
            folds=_folds(index) if whole else (),
            twist=twist,
            twist_hand=np.array([REFERENCE.index[h] for _, h in twists], dtype=np.intp),
            before=before,
            after=after,
            hips=hips,
            fitting=fitting,
            eyes=looking,
            springs=build_springs(skeleton, tuple(chains), tuple(colliders)),
            sources=sources,
            whole=skin_plan(skeleton, sources, hips, joint, bind, np.ones(count, dtype=bool)),
            moving=skin_plan(skeleton, sources, hips, joint, bind, turning),
        )

    def start(self, n: int) -> SpringState:
        """Springs of n characters, which hang where the first pose puts them."""
        return start_springs(self.springs, n)

    def fit(self, pose: Pose) -> Pose:
        """The pose on this body's proportions; the pose itself where they are the reference's."""
        return pose if self.fitting is None else self.fitting.fit(pose)

    def local_rotations(self, pose: Pose, plan: SkinPlan | None = None) -> Floats:
        """(n, J, 4) of every joint in a fitted pose, or (n, M, 4) of a plan's joints; springs at rest."""
        n = len(pose)
        normal = pose.rotation
        if self.folds:
            normal = normal.copy()
            for bone, first, then in self.folds:
                normal[:, bone] = bl.multiply(normal[:, first], normal[:, then])
        if self.curl.size:
            normal = np.concatenate([normal, _part(normal.take(self.curl, axis=1))], axis=1)
        taken = normal.take(self.source, axis=1)
        if self.before is not None and self.after is not None:
            taken = bl.multiply(bl.multiply(np.broadcast_to(self.before, taken.shape), taken), self.after)
        pool = np.empty((n, self.sources.size, 4), dtype=np.float32)
        at = len(self.driven)
        pool[:, :at] = taken
        if self.eyes is not None:
            pool[:, at : at + 2] = self.eyes.rotations(pose.gaze)
            at += 2
        if self.twist.size:
            pool[:, at : at + len(self.twist)] = _half_twist(pose.rotation.take(self.twist_hand, axis=1))
        if len(self.sources.rest):
            pool[:, self.sources.size - len(self.sources.rest) :] = self.sources.rest
        return pool.take(self.sources.of if plan is None else plan.source, axis=1)

    def root_translation(self, pose: Pose) -> Floats:
        """(n, 3) local translation of the hips joint in a fitted pose."""
        rest = _HIPS if self.fitting is None else self.fitting.hips
        shift = pose.root - rest
        parent = int(self.skeleton.parents[self.hips])
        if parent >= 0:
            shift = shift @ self.skeleton.rest_model[parent, :3, :3].astype(np.float32)
        return np.asarray(self.whole.shift[self.whole.hips] + shift)

    def joint_matrices(self, pose: Pose) -> Floats:
        """(n, J, 4, 4) model-space joint matrices of a pose on the reference, springs at rest."""
        return self._model(self.fit(pose), self.whole).take(self.whole.back, axis=1)

    def _model(self, fitted: Pose, plan: SkinPlan) -> Floats:
        """(n, M, 4, 4) model-space matrices of a plan's joints."""
        local = bl.affine(self.local_rotations(fitted, plan))
        local[:, :, :3, 3] = plan.shift
        local[:, plan.hips, :3, 3] = self.root_translation(fitted)
        to_model(local, plan.chains)
        return local

    def skin_matrices(self, joint_matrices: Floats) -> Floats:
        """(n, J, 4, 4) -> (n, K, 4, 4): what takes a vertex of the mesh from the bind pose to where it is now."""
        return np.asarray(joint_matrices.take(self.skin_joint, axis=1) @ self.inverse_bind)

    def advance(self, state: SpringState, pose: Pose, dt_s: float) -> tuple[SpringState, Floats]:
        """One tick of the springs -> state and skin matrices (n, K, 4, 4)."""
        if self.springs.pieces:
            model = self.joint_matrices(pose)
            return advance_springs(self.springs, state, model, dt_s), self.skin_matrices(model)
        fitted, plan = self.fit(pose), self.moving
        if len(pose) >= CROWD:
            rotation, root = self.local_rotations(fitted, plan), self.root_translation(fitted)
            return state, crowd_matrices(plan, rotation, root)
        return state, np.asarray(self._model(fitted, plan).take(plan.column, axis=1) @ plan.bind)


@dataclass(frozen=True, eq=False)
class _Eyes:
    """joints: left, right; yaw_rad: (2, 2) per eye at gaze −1 (to the right) and +1; pitch_rad: (2,) at −1 (down) and
    +1; before, after: (2, 4) as in Rig."""

    joints: NDArray[np.intp]
    yaw_rad: Floats
    pitch_rad: Floats
    before: Floats
    after: Floats

    def rotations(self, gaze: Floats) -> Floats:
        """gaze: (n, 2) -> (n, 2, 4) local rotations of both eyes."""
        x, y = np.clip(gaze[:, :1], -1.0, 1.0), np.clip(gaze[:, 1:], -1.0, 1.0)
        half = np.stack(
            [
                0.5 * x * np.where(x < 0.0, self.yaw_rad[:, 0], self.yaw_rad[:, 1]),
                np.broadcast_to(-0.5 * y * np.where(y < 0.0, *self.pitch_rad), (len(gaze), 2)),
            ]
        ).astype(np.float32)
        turn, nod = np.zeros((2, len(gaze), 2, 4), dtype=np.float32)
        turn[..., 1], nod[..., 0] = np.sin(half)
        turn[..., 3], nod[..., 3] = np.cos(half)
        return bl.multiply(bl.multiply(self.before, bl.multiply(turn, nod)), self.after)


def _eyes(skeleton: Skeleton, eyes: EyeBones, world: Floats) -> _Eyes:
    joints = np.array([eyes.left, eyes.right], dtype=np.intp)
    parents = skeleton.parents[joints]
    above = np.where((parents < 0)[:, None], quat.IDENTITY, world[np.maximum(parents, 0)])
    return _Eyes(
        joints=joints,
        yaw_rad=np.deg2rad([[eyes.inner_deg, eyes.outer_deg], [eyes.outer_deg, eyes.inner_deg]]),
        pitch_rad=np.deg2rad([eyes.down_deg, eyes.up_deg]),
        before=quat.conjugate(above).astype(np.float32),
        after=world[joints].astype(np.float32),
    )


def _folds(index: Mapping[str, int]) -> tuple[tuple[int, int, int], ...]:
    """(bone, upper, lower) of REFERENCE for each missing bone: the bone takes the rotations of both."""
    pairs = (
        ("chest", "spine", ("spine", "chest")),
        ("neck", "head", ("neck", "head")),
        ("leftShoulder", "leftUpperArm", ("leftShoulder", "leftUpperArm")),
        ("rightShoulder", "rightUpperArm", ("rightShoulder", "rightUpperArm")),
    )
    where = REFERENCE.index
    return tuple((where[into], where[a], where[b]) for gone, into, (a, b) in pairs if gone not in index)


def _rest_turns(skeleton: Skeleton, driven: NDArray[np.intp], world: Floats) -> tuple[Floats | None, Floats | None]:
    """A rotation n of the reference becomes conj(W_parent)·n·W_joint, W = the T-pose's rotations in model space."""
    parent = skeleton.parents[driven]
    above = np.where((parent < 0)[:, None], quat.IDENTITY, world[np.maximum(parent, 0)])
    if np.allclose(np.abs(above[:, 3]), 1.0, atol=1e-6) and np.allclose(np.abs(world[driven, 3]), 1.0, atol=1e-6):
        return None, None
    return quat.conjugate(above).astype(np.float32), world[driven].astype(np.float32)


def _part(turn: Floats) -> Floats:
    """A share of unit rotations (..., 4), for the joints that bend with the ones before them."""
    share = np.float32(TIP_SHARE) * np.where(turn[..., 3:] < 0.0, -turn, turn)
    share[..., 3] += np.float32(1.0 - TIP_SHARE)
    return bl.normalize(share)


def _half_twist(hand: Floats) -> Floats:
    """Local hand rotations (n, T, 4) -> half of their twist about the forearm (the x axis)."""
    n = len(hand)
    do, parts = arithmetic(n), numbers(hand.reshape(n, -1))
    twist: list[Number] = []
    for x, w in zip(parts[::4], parts[3::4], strict=True):
        half = do.arctan2(do.where(w < 0.0, -x, x), abs(w))
        half = do.least(do.most(half, -0.5 * MAX_TWIST_RAD), 0.5 * MAX_TWIST_RAD) * TWIST_SHARE
        twist += [do.sin(half), 0.0, 0.0, do.cos(half)]
    return columns(twist, n, np.float32).reshape(hand.shape)
