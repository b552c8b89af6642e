"""What a viewer can see of a body: where its upper joints are, nothing else.

The points are those a camera with a pose estimator gives (nose, crown, neck, shoulders, elbows, wrists, finger tips,
trunk): no units, no emotions, no rotations, no numbers of the game.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import quaternion as quat
from game.core.clip import Clip
from game.core.humanoid import HEAD_CENTRE_OFFSET, REFERENCE

__all__ = ["POINT", "POINTS", "keypoints", "keypoints_of_clip", "mirrored"]

Floats = NDArray[np.floating[Any]]

_FIXED: dict[str, tuple[str, tuple[float, float, float]]] = {
    "hips": ("hips", (0.0, 0.0, 0.0)),
    "spine": ("spine", (0.0, 0.0, 0.0)),
    "chest": ("chest", (0.0, 0.0, 0.0)),
    "neck": ("neck", (0.0, 0.0, 0.0)),
    "head": ("head", (0.0, float(HEAD_CENTRE_OFFSET[1]), float(HEAD_CENTRE_OFFSET[2]))),
    "crown": ("head", (0.0, 0.36, 0.0)),
    "nose": ("head", (0.0, 0.12, 0.16)),
}
for _side, _sign in (("left", 1.0), ("right", -1.0)):
    _FIXED[f"{_side}_shoulder"] = (f"{_side}UpperArm", (0.0, 0.0, 0.0))
    _FIXED[f"{_side}_elbow"] = (f"{_side}LowerArm", (0.0, 0.0, 0.0))
    _FIXED[f"{_side}_wrist"] = (f"{_side}Hand", (0.0, 0.0, 0.0))
    _FIXED[f"{_side}_tip"] = (f"{_side}MiddleIntermediate", (_sign * 0.034, 0.0, 0.0))

POINTS: tuple[str, ...] = tuple(_FIXED)
"""Names of the K points a viewer sees."""
POINT = {name: i for i, name in enumerate(POINTS)}
_JOINT = np.array([REFERENCE.index[joint] for joint, _ in _FIXED.values()])
_OFFSET = np.array([offset for _, offset in _FIXED.values()])
_OTHER_SIDE = np.array([POINT[n.replace("left", "#").replace("right", "left").replace("#", "right")] for n in POINTS])
for _array in (_JOINT, _OFFSET, _OTHER_SIDE):
    _array.setflags(write=False)


def keypoints(rotation: Floats, root: Floats) -> Floats:
    """Local rotations (..., 41, 4) and hips (..., 3) of REFERENCE -> points (..., K, 3) float32, metres."""
    translation = np.broadcast_to(REFERENCE.rest_translation.astype(rotation.dtype), (*rotation.shape[:-1], 3)).copy()
    translation[..., 0, :] = root
    position, turn = REFERENCE.to_model(rotation, translation)
    shift = np.broadcast_to(_OFFSET.astype(rotation.dtype), (*rotation.shape[:-2], len(POINTS), 3))
    return np.asarray(position[..., _JOINT, :] + quat.rotate(turn[..., _JOINT, :], shift), dtype=np.float32)


def keypoints_of_clip(clip: Clip) -> Floats:
    """A clip with REFERENCE's joints (in any order) -> (F, K, 3) metres."""
    order = [clip.skeleton.index[name] for name in REFERENCE.names]
    return keypoints(clip.rotation[:, order], clip.translation[:, order[0]])


def mirrored(points: Floats) -> Floats:
    """(..., K, 3) seen in a mirror: left and right change places."""
    return np.asarray(points[..., _OTHER_SIDE, :] * np.array([-1.0, 1.0, 1.0], dtype=points.dtype))
