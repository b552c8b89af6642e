"""The foreign motion made upright: joints in the world with Y up, facing +Z on average, and its bones' own axes.

Programs differ in the axis that points up, the way the person looks, the unit of length and in what a joint's own
axes mean. Nothing here relies on any of these: up is where the head is above the feet, forward is across from the
person's left side.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import quaternion as quat
from game.core.clip import Clip
from game.core.errors import BadInput, Where
from game.core.skeleton import Skeleton
from game.formats.joint_map import SIDES, JointMap

__all__ = ["Source", "read_source", "unit"]

Floats = NDArray[np.floating[Any]]
UP = np.array([0.0, 1.0, 0.0])
UP.setflags(write=False)
_LEAST_FRAMES = 2
_LEAST_BONE = 1e-3
"""Of the leg's length: a shorter arm or leg bone has no direction."""


def unit(v: Floats) -> Floats:
    """(..., 3) -> unit length; zero stays zero."""
    return np.asarray(v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-12))


@dataclass(frozen=True, eq=False)
class Source:
    """F frames of a foreign skeleton of S joints in an upright world, lengths in the file's unit.

    position (F, S, 3), rotation (F, S, 4): in the world; turned_rad: the constant heading taken out; leg_m: thigh
    and shin together; joints: which joint is what.
    """

    skeleton: Skeleton
    joints: JointMap
    position: Floats
    rotation: Floats
    turned_rad: float
    leg: float

    def index(self, target: str) -> int:
        """Joint that drives a target joint (the first, where there are several)."""
        name = self.joints.one(target)
        assert name is not None, target
        return self.skeleton.index[name]

    def indices(self, target: str) -> list[int]:
        """All joints that drive a target joint, from the hips outward; may be empty."""
        return [self.skeleton.index[name] for name in self.joints.joints.get(target, ())]

    def at(self, target: str) -> Floats:
        """(F, 3) where the joint is."""
        return np.asarray(self.position[:, self.index(target)])

    def along(self, a: str, b: str) -> Floats:
        """(F, 3) from joint a to joint b."""
        return self.at(b) - self.at(a)

    def zero_pose(self) -> Floats:
        """(S, 3) joint positions with every rotation zero, in the file's own axes."""
        rest = self.skeleton
        return rest.to_model(np.broadcast_to(quat.IDENTITY, (len(rest), 4)))[0]

    def local_mean(self, joint: int, world: Floats, weight: Floats | None = None) -> Floats:
        """Mean over frames of a world vector (F, 3) or (3,) as the joint's own frame sees it, (3,)."""
        seen = quat.rotate(quat.conjugate(self.rotation[:, joint]), np.broadcast_to(world, (len(self.rotation), 3)))
        return np.asarray(np.average(seen, axis=0, weights=weight))

    def lateral(self) -> Floats:
        """(F, 3) unit, toward the person's left."""
        hips = unit(self.along("rightUpperLeg", "leftUpperLeg"))
        return unit(hips + unit(self.along("rightUpperArm", "leftUpperArm")))


def read_source(clip: Clip, joints: JointMap, fps: float, path: str = "motion") -> Source:
    """Resample a clip to fps and set it upright. Raises BadInput for motion nothing can be made of."""
    where = Where(path)
    if len(clip) < _LEAST_FRAMES:
        raise BadInput("motion", where=where, expected=f"at least {_LEAST_FRAMES} frames", seen=len(clip))
    finite = np.isfinite(clip.rotation).all(axis=(1, 2)) & np.isfinite(clip.translation).all(axis=(1, 2))
    if not finite.all():
        bad = np.flatnonzero(~finite)
        raise BadInput(
            "motion", where=where, expected="finite numbers", seen=f"NaN in {len(bad)} frames, first {bad[0]}"
        )
    last_s = (len(clip) - 1) * clip.frame_time_s
    count = max(int(np.floor(last_s * fps + 1e-2)) + 1, _LEAST_FRAMES)
    rotation, translation = clip.sample(np.arange(count) / fps)
    position, turn = clip.skeleton.to_model(rotation, translation)
    raw = Source(clip.skeleton, joints, position, turn, 0.0, 1.0)
    leg = _leg(raw)
    for side in SIDES:
        for a, b in (("UpperArm", "LowerArm"), ("LowerArm", "Hand"), ("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot")):
            length = float(np.linalg.norm(raw.along(side + a, side + b), axis=-1).mean())
            if not length > _LEAST_BONE * max(leg, 1e-9):
                raise BadInput(
                    f"{side}{a}", where=where, expected="a bone with a length",
                    seen=f"{joints.one(side + a)!r} and {joints.one(side + b)!r} at one place",
                    hint="another joint map: --map",
                )  # fmt: skip
    stand = _upright(raw)
    upright = Source(clip.skeleton, joints, quat.rotate(stand, position), quat.multiply(stand, turn), 0.0, leg)
    ahead = np.cross(upright.lateral(), UP).mean(0)
    heading = float(np.arctan2(ahead[0], ahead[2]))
    back = quat.from_axis_angle(UP, -heading)
    return Source(
        clip.skeleton,
        joints,
        quat.rotate(back, upright.position),
        quat.multiply(back, upright.rotation),
        heading,
        leg,
    )


def _leg(source: Source) -> float:
    both = [
        np.linalg.norm(source.along(f"{s}UpperLeg", f"{s}LowerLeg"), axis=-1)
        + np.linalg.norm(source.along(f"{s}LowerLeg", f"{s}Foot"), axis=-1)
        for s in SIDES
    ]
    return float(np.mean(both))


def _upright(source: Source) -> Floats:
    """(4,) the rotation that takes the axis nearest to feet-to-head to +Y."""
    feet = 0.5 * (source.at("leftFoot") + source.at("rightFoot"))
    up = unit(source.at("head") - feet).mean(0)
    axis = np.zeros(3)
    k = int(np.abs(up).argmax())
    axis[k] = np.sign(up[k]) or 1.0
    return quat.between(axis, UP)
