"""Arms and fingers: wrist targets over time -> joint rotations, by two-bone inverse kinematics.

Everything is worked out for a left arm. A right arm is mirrored in the plane x = 0, solved, and mirrored back.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import quaternion as quat
from game.core.humanoid import FINGERS, REFERENCE

__all__ = ["SIDES", "finger_rotations", "hand_frame", "mirror_points", "mirror_rotations", "solve_arm", "unit"]

Floats = NDArray[np.floating[Any]]
SIDES = ("left", "right")
_UPPER_M = float(np.linalg.norm(REFERENCE.rest_translation[REFERENCE.index["leftLowerArm"]]))
_LOWER_M = float(np.linalg.norm(REFERENCE.rest_translation[REFERENCE.index["leftHand"]]))
_SOFT_FROM, _SOFT_TO = 0.93, 0.985
_TWIST_SHARE = 0.35
# Twist of the upper arm is counted from an arm that hangs at 45 degrees, half way of what arms usually do.
_HANGING = np.array([np.sqrt(0.5), -np.sqrt(0.5), 0.0])
_TO_HANGING = quat.from_axis_angle((0.0, 0.0, 1.0), np.radians(-45.0))
_MIRROR_POINT = np.array([-1.0, 1.0, 1.0])
_MIRROR_ROTATION = np.array([1.0, -1.0, -1.0, 1.0])


def unit(v: Floats) -> Floats:
    """(..., 3) -> unit length."""
    return np.asarray(v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-9))


def mirror_points(v: Floats, side: str) -> Floats:
    """(..., 3) as seen from a left arm's side; its own inverse."""
    return v if side == "left" else v * _MIRROR_POINT


def mirror_rotations(q: Floats, side: str) -> Floats:
    """(..., 4) as seen from a left arm's side; its own inverse."""
    return q if side == "left" else q * _MIRROR_ROTATION


def hand_frame(fingers: Floats, back: Floats) -> Floats:
    """Rotation (..., 4) of a left hand whose fingers point along ``fingers`` and whose back faces ``back``."""
    x = unit(fingers)
    y = unit(back - (back * x).sum(-1, keepdims=True) * x)
    return quat.from_matrix(np.stack([x, y, np.cross(x, y)], -1))


def solve_arm(
    shoulder: Floats, wrist: Floats, pole: Floats, hand: Floats, shoulder_parent: Floats
) -> tuple[dict[str, Floats], Floats, Floats]:
    """Left arm by two-bone inverse kinematics with a soft end of its reach (93 % to 98.5 %).

    shoulder, wrist: (F, 3) model space; pole: (F, 3) where the elbow points; hand: (F, 4) wanted model rotation;
    shoulder_parent: (F, 4) model rotation of the shoulder joint.
    -> local rotations of UpperArm, LowerArm and Hand, and elbow and wrist as reached (F, 3).
    """
    way = wrist - shoulder
    length = np.linalg.norm(way, axis=-1, keepdims=True)
    full = _UPPER_M + _LOWER_M
    soft, hard = _SOFT_FROM * full, _SOFT_TO * full
    reached = np.where(length < soft, length, soft + (hard - soft) * (1.0 - np.exp(-(length - soft) / (hard - soft))))
    # Not so near that the elbow folds shut.
    reached = np.maximum(reached, 0.25 * full)
    along = way / np.maximum(length, 1e-6)
    out = unit(pole - (pole * along).sum(-1, keepdims=True) * along)
    cosine = np.clip((_UPPER_M**2 + reached**2 - _LOWER_M**2) / (2 * _UPPER_M * reached), -1.0, 1.0)
    elbow = shoulder + along * (_UPPER_M * cosine) + out * (_UPPER_M * np.sqrt(1.0 - cosine**2))
    end = shoulder + along * reached
    u, f = unit(elbow - shoulder), unit(end - elbow)
    bend = unit(f - (f * u).sum(-1, keepdims=True) * u)

    def bone(x: Floats, z: Floats) -> Floats:
        z = unit(z - (z * x).sum(-1, keepdims=True) * x)
        return quat.from_matrix(np.stack([x, np.cross(z, x), z], -1))

    whole = bone(u, bend)
    swing = quat.multiply(quat.between(np.broadcast_to(_HANGING, u.shape), u), _TO_HANGING)
    turn = quat.multiply(quat.conjugate(swing), whole)
    angle = np.unwrap(2.0 * np.arctan2(turn[:, 0], turn[:, 3]))
    angle -= 2.0 * np.pi * np.round(np.median(angle) / (2.0 * np.pi))
    # Skin follows better when the upper arm turns by a part of the twist and the forearm by the rest.
    upper = quat.multiply(swing, quat.from_axis_angle((1.0, 0.0, 0.0), _TWIST_SHARE * angle))
    y = np.cross(bend, u)
    lower = quat.from_matrix(np.stack([f, y, np.cross(f, y)], -1))
    return (
        {
            "UpperArm": quat.multiply(quat.conjugate(shoulder_parent), upper),
            "LowerArm": quat.multiply(quat.conjugate(upper), lower),
            "Hand": quat.multiply(quat.conjugate(lower), hand),
        },
        elbow,
        end,
    )


def finger_rotations(curls_deg: Floats) -> dict[str, Floats]:
    """(F, 5, 3) -> local rotations of a left hand's finger joints.

    Rows 0-3 index to little: curl of the base, curl of the tip, spread toward the thumb. Row 4 the thumb: across the
    palm, into the palm, bend of its tip. Degrees.
    """
    c = np.radians(curls_deg)
    out: dict[str, Floats] = {}
    for i, finger in enumerate(FINGERS):
        base = quat.multiply(
            quat.from_axis_angle((0.0, 1.0, 0.0), -c[:, i, 2]), quat.from_axis_angle((0.0, 0.0, -1.0), c[:, i, 0])
        )
        out[f"{finger}Proximal"] = base
        out[f"{finger}Intermediate"] = quat.from_axis_angle((0.0, 0.0, -1.0), c[:, i, 1])
    out["ThumbMetacarpal"] = quat.multiply(
        quat.from_axis_angle((0.0, 1.0, 0.0), c[:, 4, 0]), quat.from_axis_angle((-1.0, 0.0, 0.0), c[:, 4, 1])
    )
    out["ThumbProximal"] = quat.from_axis_angle((0.0, 0.9, -0.4), c[:, 4, 2])
    return out
