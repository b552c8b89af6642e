"""Trunk, head and legs: body channels over time -> joint rotations of the reference humanoid."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import quaternion as quat
from game.core.humanoid import REFERENCE

__all__ = ["CHAIN", "CHANNELS", "MIRRORED", "legs", "torso"]

Floats = NDArray[np.floating[Any]]

CHANNELS = (
    "forward",  # pelvis, metres: forward +
    "up",
    "sideways",  # to the character's left +
    "pelvis_yaw",  # degrees from here on; yaw to the left +
    "lean",  # trunk forward +
    "side",  # trunk to the character's right + (rotation about Z), as the head's roll
    "twist",
    "curl",  # rounds the back
    "lift",  # opens the chest
    "shoulders",  # both shoulders up
    "shoulders_forward",
    "shoulder_tilt",  # left up, right down
    "neck",  # poked forward
    "head_pitch",  # of the head in the world: down +
    "head_yaw",  # left +
    "head_roll",
)
"""What a trunk can do; the score, the postures and the carriage speak in these."""

CHAIN: Mapping[str, int] = {
    **dict.fromkeys(("forward", "up", "sideways", "pelvis_yaw"), 0),
    **dict.fromkeys(("lean", "side", "twist"), 1),
    **dict.fromkeys(("curl", "lift", "shoulders", "shoulders_forward", "shoulder_tilt"), 2),
    **dict.fromkeys(("neck", "head_pitch", "head_roll"), 3),
    # The gaze leads: the head turns first and the trunk follows.
    "head_yaw": 4,
}
"""Channel -> its place in the chain: delays and spring frequencies go by it."""

MIRRORED = frozenset({"sideways", "pelvis_yaw", "side", "twist", "shoulder_tilt", "head_yaw", "head_roll"})
"""Channels that change sign when a behaviour is done with the other hand."""

_NECK_SHARE = 0.42


def torso(x: Mapping[str, Floats]) -> tuple[Floats, dict[str, Floats]]:
    """Channels (F,) -> hips translation offset (F, 3) metres and local rotations (F, 4) of trunk, head, shoulders.

    Lean is shared hips .40, spine .35, chest .25, but backwards .22/.53/.25, for otherwise the coat's hem rises over
    the table. Head pitch, yaw and roll are those of the head in the world: neck 42 %, head 58 %.
    """
    rad = {name: np.radians(value) for name, value in x.items() if name not in ("forward", "up", "sideways")}
    lean, curl, lift, side, twist = rad["lean"], rad["curl"], rad["lift"], rad["side"], rad["twist"]
    # The hips' share changes smoothly around upright.
    hips_share = 0.31 + 0.09 * np.tanh(lean / np.radians(3.0))

    def yaw_pitch_roll(yaw: Floats, pitch: Floats, roll: Floats) -> Floats:
        return quat.from_euler("YXZ", np.stack([yaw, pitch, roll], -1))

    hips = yaw_pitch_roll(rad["pelvis_yaw"] + 0.25 * twist, hips_share * lean, 0.15 * side)
    spine = yaw_pitch_roll(0.35 * twist, (0.75 - hips_share) * lean + 0.42 * curl - 0.35 * lift, 0.45 * side)
    chest = yaw_pitch_roll(0.40 * twist, 0.25 * lean + 0.58 * curl - 0.65 * lift, 0.40 * side)
    trunk = quat.multiply(quat.multiply(hips, spine), chest)
    wanted = yaw_pitch_roll(rad["head_yaw"], rad["head_pitch"], rad["head_roll"])
    turn = quat.multiply(quat.conjugate(trunk), wanted)
    zero = np.zeros_like(lean)
    neck = quat.multiply(quat.exp(_NECK_SHARE * quat.log(turn)), yaw_pitch_roll(zero, rad["neck"], zero))
    head = quat.multiply(quat.conjugate(neck), turn)
    forward, raised, tilt = rad["shoulders_forward"], rad["shoulders"], rad["shoulder_tilt"]
    rotations = {
        "hips": hips,
        "spine": spine,
        "chest": chest,
        "neck": neck,
        "head": head,
        "leftShoulder": quat.from_euler("YZ", np.stack([-forward, raised + tilt], -1)),
        "rightShoulder": quat.from_euler("YZ", np.stack([forward, -(raised - tilt)], -1)),
    }
    return np.stack([x["sideways"], x["up"], x["forward"]], -1), rotations


def _flex(root: Floats, end: Floats, upper_m: float, lower_m: float, pole: Floats) -> tuple[Floats, Floats]:
    """Directions of thigh and shin (F, 3) from hip (F, 3) to ankle (F, 3), knee toward the pole."""
    way = end - root
    distance = np.clip(np.linalg.norm(way, axis=-1, keepdims=True), 1e-6, 0.9995 * (upper_m + lower_m))
    along = way / np.maximum(np.linalg.norm(way, axis=-1, keepdims=True), 1e-6)
    out = pole - (pole * along).sum(-1, keepdims=True) * along
    out = out / np.linalg.norm(out, axis=-1, keepdims=True)
    cosine = np.clip((upper_m**2 + distance**2 - lower_m**2) / (2 * upper_m * distance), -1.0, 1.0)
    knee = root + along * (upper_m * cosine) + out * (upper_m * np.sqrt(1.0 - cosine**2))
    thigh = (knee - root) / upper_m
    shin = root + along * distance - knee
    return thigh, shin / np.linalg.norm(shin, axis=-1, keepdims=True)


def _frame(down: Floats, front: Floats) -> Floats:
    """Quaternion whose -Y is ``down`` and whose +Z is nearest to ``front``; both (F, 3)."""
    y = -down
    z = front - (front * y).sum(-1, keepdims=True) * y
    z = z / np.linalg.norm(z, axis=-1, keepdims=True)
    return quat.from_matrix(np.stack([np.cross(y, z), y, z], -1))


def legs(shift: Floats, hips_rotation: Floats) -> tuple[Floats, dict[str, Floats]]:
    """Feet stay where they stand; knees bend, and heels rise when the pelvis goes higher than legs reach.

    shift: wanted hips offset (F, 3) metres; hips_rotation (F, 4). -> the offset that the legs allow and the local
    rotations of both legs. The toes' joints never move.
    """
    at = {name: REFERENCE.rest_model[i, :3, 3] for name, i in REFERENCE.index.items()}
    frames = len(shift)
    rotations: dict[str, Floats] = {}
    shift = shift.copy()
    # How high may the pelvis be with flat feet? A stretched leg (99.5 %) of each side gives an upper bound.
    flat = np.full(frames, np.inf)
    for side in ("left", "right"):
        joint = quat.rotate(hips_rotation, np.broadcast_to(at[f"{side}UpperLeg"] - at["hips"], (frames, 3)))
        thigh_m = float(np.linalg.norm(at[f"{side}LowerLeg"] - at[f"{side}UpperLeg"]))
        shin_m = float(np.linalg.norm(at[f"{side}Foot"] - at[f"{side}LowerLeg"]))
        level = at["hips"] + joint + shift * (1.0, 0.0, 1.0) - at[f"{side}Foot"]
        reach = (0.995 * (thigh_m + shin_m)) ** 2 - level[:, 0] ** 2 - level[:, 2] ** 2
        flat = np.minimum(flat, np.sqrt(np.maximum(reach, 0.01)) - level[:, 1])
    shift[:, 1] = np.minimum(shift[:, 1], flat + np.maximum(shift[:, 1], 0.0))
    front = quat.rotate(hips_rotation, np.broadcast_to((0.0, 0.0, 1.0), (frames, 3)))
    # Knees point between where the pelvis and where the feet point.
    front = front + (0.0, 0.0, 1.0)
    for side in ("left", "right"):
        hip = (
            at["hips"]
            + shift
            + quat.rotate(hips_rotation, np.broadcast_to(at[f"{side}UpperLeg"] - at["hips"], (frames, 3)))
        )
        toes, ankle_rest = at[f"{side}Toes"], at[f"{side}Foot"]
        thigh_m = float(np.linalg.norm(at[f"{side}LowerLeg"] - at[f"{side}UpperLeg"]))
        shin_m = float(np.linalg.norm(ankle_rest - at[f"{side}LowerLeg"]))
        limit = 0.996 * (thigh_m + shin_m)
        # The smallest heel rise that brings the ankle within reach, by bisection over all frames at once.
        low, high = np.zeros(frames), np.full(frames, np.radians(55.0))
        for _ in range(14):
            middle = 0.5 * (low + high)
            ankle = toes + quat.rotate(
                quat.from_axis_angle((1.0, 0.0, 0.0), middle), np.broadcast_to(ankle_rest - toes, (frames, 3))
            )
            far = np.linalg.norm(ankle - hip, axis=-1) > limit
            low, high = np.where(far, middle, low), np.where(far, high, middle)
        rise = np.where(np.linalg.norm(ankle_rest - hip, axis=-1) > limit, high, 0.0)
        foot = quat.from_axis_angle((1.0, 0.0, 0.0), rise)
        ankle = toes + quat.rotate(foot, np.broadcast_to(ankle_rest - toes, (frames, 3)))
        thigh, shin = _flex(hip, ankle, thigh_m, shin_m, front)
        knee_front = front / np.linalg.norm(front, axis=-1, keepdims=True)
        # Rest legs are not quite vertical: turn from the rest directions, not from straight down.
        rest_thigh = (at[f"{side}LowerLeg"] - at[f"{side}UpperLeg"]) / thigh_m
        rest_shin = (ankle_rest - at[f"{side}LowerLeg"]) / shin_m
        upper = quat.multiply(
            _frame(thigh, knee_front), quat.conjugate(_frame(rest_thigh[None], np.array([[0, 0, 1.0]])))
        )
        lower = quat.multiply(
            _frame(shin, knee_front), quat.conjugate(_frame(rest_shin[None], np.array([[0, 0, 1.0]])))
        )
        rotations[f"{side}UpperLeg"] = quat.multiply(quat.conjugate(hips_rotation), upper)
        rotations[f"{side}LowerLeg"] = quat.multiply(quat.conjugate(upper), lower)
        rotations[f"{side}Foot"] = quat.multiply(quat.conjugate(lower), foot)
        rotations[f"{side}Toes"] = quat.conjugate(foot)
    return shift, rotations
