"""From poses to the matrices that move a character's mesh: retargeting, forearm twist, springs, skinning.

Files have joints with axes of their own and rest poses that are not the T-pose. Both are worked out once: what moves
are *normalized* joints, whose axes in the T-pose are the model's, so that a rotation of the reference is theirs; the
matrices that lead from a column of the skin to its joint take the rest. Joints that stand still in their parents are
none of them: their columns go with the parents. The loop over characters is compiled (skin/*.c).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import cos, sin
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation.body_shape import BodyShape
from game.animation.body_size import BodySize
from game.animation.fitting import NEEDED, Fitting, fit_to
from game.animation.pose import Pose
from game.animation.rest_pose import t_pose
from game.animation.skin_loop import EYES, FOLD, JOINT, SPRUNG, Columns, SkinLoop, SkinTables
from game.animation.springbones import SpringChain, SpringCollider, SpringSet, SpringState, build_springs
from game.core import quaternion as quat
from game.core.errors import BadInput
from game.core.humanoid import FINGERS, REFERENCE
from game.core.skeleton import Skeleton

__all__ = ["EyeBones", "Rig"]

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.intp]

TWIST_SHARE = 0.5
"""The twist joint in the middle of a forearm takes this share of the hand's twist."""
MAX_TWIST_RAD = 2.6

TIP_SHARE = 0.65
"""The outermost joint of a finger bends this much as far as the one before it."""

_SIDES = ("left", "right")
_TIPS = {f"{s}{f}Distal": f"{s}{f}Intermediate" for s in _SIDES for f in FINGERS} | {
    f"{s}ThumbDistal": f"{s}ThumbProximal" for s in _SIDES
}
_FOLDS = (
    ("chest", "spine", ("spine", "chest")),
    ("neck", "head", ("neck", "head")),
    ("leftShoulder", "leftUpperArm", ("leftShoulder", "leftUpperArm")),
    ("rightShoulder", "rightUpperArm", ("rightShoulder", "rightUpperArm")),
)
"""A bone a body may lack, the one that stands for it, and the rotations that one takes."""


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
    """A character's skeleton and skin, for one thread at a time. Make it with from_arrays.

    skeleton: J joints. driven: (D,) joints that follow a joint of the reference skeleton, source: (D,) which; beyond
    41: the outermost finger joints, which the reference lacks. fitting: None for a body of the reference's own
    proportions. eyes: joints that follow the gaze, or None.
    """

    skeleton: Skeleton
    driven: Ints
    source: Ints
    fitting: Fitting | None
    eyes: EyeBones | None
    springs: SpringSet
    _loop: SkinLoop
    _skin: Columns
    _joints: Columns

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
        shape: BodyShape | None = None,
        eyes: EyeBones | None = None,
    ) -> Rig:
        """names, parents (J,) parents first, rest_translation (J, 3) local metres, rest_rotation (J, 4) local; Y up,
        facing +Z, any rest pose.

        inverse_bind: (K, 4, 4) of the skin's columns; the rest pose's own where None. skin_joint: (K,) their joints,
        all in order where None. bones: VRM humanoid bone -> joint, by name where None. size: how the body's parts
        differ from the reference's; shape: of its outside. eyes: joints
        that follow the gaze. Raises BadInput where the arrays do not fit or there are no hips.
        """
        count = len(names)
        turned = np.tile(quat.IDENTITY, (count, 1)) if rest_rotation is None else np.asarray(rest_rotation)
        skeleton = Skeleton(tuple(names), np.asarray(parents, dtype=np.intp), np.asarray(rest_translation), turned)
        index = dict(bones) if bones is not None else dict(skeleton.index)
        if "hips" not in index:
            raise BadInput("rig", expected="a joint for the bone hips", seen=", ".join(sorted(index))[:60])
        joint = np.arange(count) if skin_joint is None else np.asarray(skin_joint, dtype=np.intp)
        if joint.size and (joint.min() < 0 or joint.max() >= count):
            raise BadInput("rig", expected=f"skin joints below {count}", seen=int(joint.max()))
        bind = np.linalg.inv(skeleton.rest_model)[joint] if inverse_bind is None else np.asarray(inverse_bind)
        if bind.shape != (len(joint), 4, 4) or not np.isfinite(bind).all():
            raise BadInput("rig", expected=f"({len(joint)}, 4, 4) finite inverse bind matrices", seen=bind.shape)

        place, world = t_pose(skeleton, index)
        whole = all(bone in index for bone in NEEDED)
        fitting = fit_to({bone: place[at] for bone, at in index.items()}, size, shape) if whole else None
        springs = build_springs(skeleton, tuple(chains), tuple(colliders), place, world)
        known = [name for name in REFERENCE.names if name in index]
        tips = [tip for tip in _TIPS if tip in index and _TIPS[tip] in index]
        twists = [(f"{s}ForearmTwist", f"{s}Hand") for s in _SIDES if f"{s}ForearmTwist" in skeleton.index]
        driven = np.array([index[name] for name in (*known, *tips)], dtype=np.intp)
        first_tip = len(REFERENCE)
        source = np.array([REFERENCE.index[name] for name in known] + list(range(first_tip, first_tip + len(tips))))

        # Twists come before eyes, and eyes before what else would drive a joint.
        turn = np.full(count, -1, dtype=np.intp)
        turn[driven] = source
        following = [] if eyes is None else [eyes.left, eyes.right]
        following += [skeleton.index[twist] for twist, _ in twists]
        turn[following] = first_tip + len(tips) + np.arange(len(following))

        moved = _Moved.of(skeleton, turn >= 0, [index["hips"], *springs.joint, *springs.collider["joint"]])
        shift = _frames(world, place - place[moved.anchor])
        loop = SkinLoop(
            SkinTables(
                joint=moved.table(skeleton, turn, place),
                hips=int(moved.row[index["hips"]]),
                hips_rest=REFERENCE.rest_translation[0] if fitting is None else fitting.hips,
                fold=_folds(index) if whole else np.zeros(0, dtype=FOLD),
                tip=np.array([REFERENCE.index[_TIPS[tip]] for tip in tips], dtype=np.intp),
                tip_share=TIP_SHARE,
                eyes=np.zeros(0, dtype=EYES) if eyes is None else _eyes(eyes),
                hand=np.array([REFERENCE.index[hand] for _, hand in twists], dtype=np.intp),
                twist_share=TWIST_SHARE,
                most_half_twist=(cos(0.5 * MAX_TWIST_RAD), sin(0.5 * MAX_TWIST_RAD)),
                fit=np.zeros(0, dtype=np.void) if fitting is None else fitting.table(),
                spring=moved.sprung(skeleton, springs),
                piece=springs.piece,
                collider=moved.colliders(springs),
                met=springs.met,
            )
        )
        return cls(
            skeleton=skeleton,
            driven=driven,
            source=source,
            fitting=fitting,
            eyes=eyes,
            springs=springs,
            _loop=loop,
            _skin=loop.columns(moved.row[moved.anchor[joint]], shift[joint] @ bind),
            _joints=loop.columns(moved.row[moved.anchor], shift),
        )

    def start(self, n: int) -> SpringState:
        """Springs of n characters, which hang where the first pose puts them."""
        return SpringState(n)

    def joint_matrices(self, pose: Pose) -> Floats:
        """(n, J, 4, 4) model-space joint matrices of a pose on the reference, springs at rest."""
        return self._loop.matrices(pose, self._joints)

    def advance(self, state: SpringState, pose: Pose, dt_s: float) -> tuple[SpringState, Floats]:
        """One tick of the springs -> state and skin matrices (n, K, 4, 4): what takes a vertex of the mesh from the
        bind pose to where it is now."""
        if not self.springs.pieces:
            return state, self._loop.matrices(pose, self._skin)
        swing, skin = self._loop.swing(pose, self._skin, state.swing, dt_s)
        return SpringState(state.n, swing), skin


@dataclass(frozen=True, eq=False)
class _Moved:
    """The joints that move, and all above them. joint: (M,) of the rig; row: (J,) places among them; anchor: (J,) the
    nearest of them, itself or above."""

    joint: Ints
    row: Ints
    anchor: Ints

    @staticmethod
    def of(skeleton: Skeleton, turning: NDArray[np.bool_], wanted: Sequence[int]) -> _Moved:
        """turning: (J,); wanted: joints that are asked for though they may stand still."""
        parents = skeleton.parents
        kept = turning | (parents < 0)
        kept[list(wanted)] = True
        anchor = np.arange(len(skeleton))
        for joint in range(len(skeleton) - 1, 0, -1):
            if kept[joint] and parents[joint] >= 0:
                kept[parents[joint]] = True
        for joint in np.flatnonzero(~kept).tolist():
            anchor[joint] = anchor[parents[joint]]
        # By depth: a processor works on several joints at once where none waits for the one before.
        order = np.concatenate([level[kept[level]] for level in skeleton.levels])
        row = np.zeros(len(skeleton), dtype=np.intp)
        row[order] = np.arange(len(order))
        return _Moved(order, row, anchor)

    def table(self, skeleton: Skeleton, turn: Ints, place: Floats) -> NDArray[np.void]:
        """(M,) JOINT. turn: (J,) of skin/rig.h's local rotations, −1 for none; place: (J, 3) in the T-pose."""
        above = skeleton.parents[self.joint]
        table = np.zeros(len(self.joint), dtype=JOINT)
        table["parent"] = np.where(above < 0, -1, self.row[above])
        table["source"] = turn[self.joint]
        table["offset"] = place[self.joint] - np.where((above < 0)[:, None], 0.0, place[above])
        return table

    def sprung(self, skeleton: Skeleton, springs: SpringSet) -> NDArray[np.void]:
        """SPRUNG: every joint that springs turn, or that hangs on one."""
        swinging = np.zeros(len(skeleton), dtype=bool)
        swinging[springs.joint] = True
        for joint in self.joint:
            swinging[joint] |= skeleton.parents[joint] >= 0 and swinging[skeleton.parents[joint]]
        joints = self.joint[swinging[self.joint]]
        table = np.zeros(len(joints), dtype=SPRUNG)
        table["joint"], table["first"] = self.row[joints], np.searchsorted(springs.joint, joints)
        table["pieces"] = np.searchsorted(springs.joint, joints, side="right") - table["first"]
        return table

    def colliders(self, springs: SpringSet) -> NDArray[np.void]:
        """The springs' colliders on these joints."""
        table = springs.collider.copy()
        table["joint"] = self.row[springs.collider["joint"]]
        return table


def _frames(turn: Floats, place: Floats) -> Floats:
    """(..., 4), (..., 3) -> (..., 4, 4)."""
    made = np.zeros((*turn.shape[:-1], 4, 4))
    made[..., :3, :3], made[..., :3, 3], made[..., 3, 3] = quat.to_matrix(turn), place, 1.0
    return made


def _eyes(eyes: EyeBones) -> NDArray[np.void]:
    table = np.zeros(1, dtype=EYES)
    table["yaw"] = np.deg2rad([[eyes.inner_deg, eyes.outer_deg], [eyes.outer_deg, eyes.inner_deg]])
    table["pitch"] = np.deg2rad([eyes.down_deg, eyes.up_deg])
    return table


def _folds(index: Mapping[str, int]) -> NDArray[np.void]:
    """FOLD in joints of REFERENCE for each missing bone."""
    where = REFERENCE.index
    rows = [(where[into], where[above], where[below]) for gone, into, (above, below) in _FOLDS if gone not in index]
    return np.array(rows, dtype=FOLD)
