"""A motion clip: local joint rotations and translations over time on one skeleton."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import quaternion as quat
from game.core.errors import BadInput
from game.core.skeleton import Skeleton

__all__ = ["Clip"]

Floats = NDArray[np.floating[Any]]


@dataclass(frozen=True, eq=False)
class Clip:
    """F frames of J joints.

    rotation: (F, J, 4) local unit quaternions; translation: (F, J, 3) local, metres (or the file's own units
    as read by game.formats before conversion); frame_time_s: seconds per frame, > 0.
    """

    skeleton: Skeleton
    frame_time_s: float
    rotation: Floats
    translation: Floats
    name: str = ""

    def __post_init__(self) -> None:
        joints = len(self.skeleton)
        frames = len(self.rotation)
        if self.rotation.shape != (frames, joints, 4) or self.translation.shape != (frames, joints, 3):
            raise BadInput(
                "clip",
                expected=f"(F, {joints}, 4) rotations and (F, {joints}, 3) translations",
                seen=f"{self.rotation.shape} and {self.translation.shape}",
            )
        if not (self.frame_time_s > 0 and np.isfinite(self.frame_time_s)):
            raise BadInput("clip", expected="a frame time above 0 s", seen=self.frame_time_s)
        self.rotation.setflags(write=False)
        self.translation.setflags(write=False)

    def __len__(self) -> int:
        return len(self.rotation)

    @property
    def length_s(self) -> float:
        """Frames times frame time."""
        return len(self) * self.frame_time_s

    def to_model(self, frames: slice | NDArray[np.intp] = slice(None)) -> tuple[Floats, Floats]:
        """Model-space positions (f, J, 3) and rotations (f, J, 4) of some frames."""
        return self.skeleton.to_model(self.rotation[frames], self.translation[frames])

    def sample(self, time_s: NDArray[np.float64]) -> tuple[Floats, Floats]:
        """Rotation (..., J, 4) and translation (..., J, 3) at times (...,) in seconds, clamped to the clip."""
        at = np.clip(np.asarray(time_s) / self.frame_time_s, 0, len(self) - 1)
        low = np.minimum(at.astype(np.intp), max(len(self) - 2, 0))
        high = np.minimum(low + 1, len(self) - 1)
        t = (at - low)[..., None]
        rotation = quat.nlerp(self.rotation[low], self.rotation[high], t)
        translation = self.translation[low] * (1 - t[..., None]) + self.translation[high] * t[..., None]
        return rotation, translation
