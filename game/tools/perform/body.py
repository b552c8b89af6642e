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


def _flex(root: Floats, end: Floats, upper_m: float, lower_m: float, pole: Floats) -> tuple[Floats, Floats, Floats]:
    """Directions of thigh and shin (F, 3) from hip (F, 3) to ankle (F, 3), knee toward the pole, its axis."""
    way = end - root
    length = np.maximum(np.linalg.norm(way, axis=-1, keepdims=True), 1e-6)
    distance = np.minimum(length, 0.9995 * (upper_m + lower_m))
    along = way / length
    out = pole - (pole * along).sum(-1, keepdims=True) * along
    out = out / np.linalg.norm(out, axis=-1, keepdims=True)
    cosine = np.clip((upper_m**2 + distance**2 - lower_m**2) / (2 * upper_m * distance), -1.0, 1.0)
    knee = root + along * (upper_m * cosine) + out * (upper_m * np.sqrt(1.0 - cosine**2))
    thigh = (knee - root) / upper_m
    shin = root + along * distance - knee
    return thigh, shin / np.linalg.norm(shin, axis=-1, keepdims=True), np.cross(out, along)


def _bone(down: Floats, axis: Floats) -> Floats:
    """Quaternion whose -Y is ``down`` and whose X is the knee's axis; both (F, 3)."""
    x = axis - (axis * down).sum(-1, keepdims=True) * down
    x = x / np.linalg.norm(x, axis=-1, keepdims=True)
    return quat.from_matrix(np.stack([x, -down, np.cross(x, -down)], -1))


def _soft_reach(distance: Floats, full_m: float) -> Floats:
    """A leg approaches its full length without ever locking: linear to 96.5 %, then flat toward 99.5 %."""
    start, end = 0.965 * full_m, 0.995 * full_m
    beyond = np.maximum(distance - start, 0.0)
    return np.asarray(np.minimum(distance, start) + (end - start) * (1.0 - np.exp(-beyond / (end - start))))


def _ankle(toes: Floats, to_ankle: Floats, rise_rad: Floats) -> tuple[Floats, Floats]:
    """Ankle (F, 3) and rotation (F, 4) of a foot whose heel has risen by an angle (F,) about its toes."""
    foot = quat.from_axis_angle((1.0, 0.0, 0.0), rise_rad)
    return toes + quat.rotate(foot, np.broadcast_to(to_ankle, (len(rise_rad), 3))), foot


def legs(shift: Floats, hips_rotation: Floats) -> tuple[Floats, dict[str, Floats]]:
    """Feet stay where they stand; knees bend, and heels rise when the pelvis goes higher than legs reach.

    shift: wanted hips offset (F, 3) metres; hips_rotation (F, 4). -> the offset that the legs allow and the local
    rotations of both legs. The toes' joints never move.
    """
    at = {name: REFERENCE.rest_model[i, :3, 3] for name, i in REFERENCE.index.items()}
    frames = len(shift)
    # Tiptoe ends at 28 mm, a squat at -310 mm; what is asked beyond is flattened, not cut.
    up = shift[:, 1]
    up = np.where(up > 0.012, 0.012 + 0.016 * np.tanh((up - 0.012) / 0.016), up)
    up = np.where(up < -0.25, -0.25 + 0.06 * np.tanh((up + 0.25) / 0.06), up)
    sizes = {}
    ceiling = np.full(frames, np.inf)
    for side in ("left", "right"):
        thigh_m = float(np.linalg.norm(at[f"{side}LowerLeg"] - at[f"{side}UpperLeg"]))
        shin_m = float(np.linalg.norm(at[f"{side}Foot"] - at[f"{side}LowerLeg"]))
        sizes[side] = (thigh_m, shin_m)
        joint = quat.rotate(hips_rotation, np.broadcast_to(at[f"{side}UpperLeg"] - at["hips"], (frames, 3)))
        level = at["hips"] + joint + shift * (1.0, 0.0, 1.0) - at[f"{side}Foot"]
        reach = (0.99 * (thigh_m + shin_m)) ** 2 - level[:, 0] ** 2 - level[:, 2] ** 2
        ceiling = np.minimum(ceiling, np.sqrt(np.maximum(reach, 0.01)) - level[:, 1])
    # A pelvis that moved away over flat feet is lower; heels add only what a rise was asked for (softly above 0).
    # (A pelvis far back over the heels cannot also be on tiptoe.)
    away = np.exp(-(shift[:, 0] ** 2 + shift[:, 2] ** 2) / 0.075**2)
    ceiling = ceiling + away * 0.006 * np.logaddexp(0.0, up / 0.006)
    width = 0.006
    up = up - width * np.logaddexp(0.0, (up - ceiling) / width)
    shift = np.stack([shift[:, 0], up, shift[:, 2]], -1)
    # Knees point between where the pelvis and where the feet point.
    front = quat.rotate(hips_rotation, np.broadcast_to((0.0, 0.0, 1.0), (frames, 3))) + (0.0, 0.0, 1.0)
    rotations: dict[str, Floats] = {}
    for side in ("left", "right"):
        thigh_m, shin_m = sizes[side]
        to_hip = np.broadcast_to(at[f"{side}UpperLeg"] - at["hips"], (frames, 3))
        hip = at["hips"] + shift + quat.rotate(hips_rotation, to_hip)
        toes, to_ankle = at[f"{side}Toes"], at[f"{side}Foot"] - at[f"{side}Toes"]
        allowed = _soft_reach(np.linalg.norm(at[f"{side}Foot"] - hip, axis=-1), thigh_m + shin_m)
        # The smallest heel rise that brings the ankle that near, by bisection over all frames at once.
        low, high = np.zeros(frames), np.full(frames, np.radians(60.0))
        for _ in range(22):
            middle = 0.5 * (low + high)
            far = np.linalg.norm(_ankle(toes, to_ankle, middle)[0] - hip, axis=-1) > allowed
            low, high = np.where(far, middle, low), np.where(far, high, middle)
        ankle, foot = _ankle(toes, to_ankle, high)
        thigh, shin, axis = _flex(hip, ankle, thigh_m, shin_m, front)
        # Rest legs are not quite vertical: turn from the rest directions, not from straight down.
        sideways = np.array([[1.0, 0.0, 0.0]])
        rest_thigh = _bone((at[f"{side}LowerLeg"] - at[f"{side}UpperLeg"])[None] / thigh_m, sideways)
        rest_shin = _bone((at[f"{side}Foot"] - at[f"{side}LowerLeg"])[None] / shin_m, sideways)
        upper = quat.multiply(_bone(thigh, axis), quat.conjugate(rest_thigh))
        lower = quat.multiply(_bone(shin, axis), quat.conjugate(rest_shin))
        rotations[f"{side}UpperLeg"] = quat.multiply(quat.conjugate(hips_rotation), upper)
        rotations[f"{side}LowerLeg"] = quat.multiply(quat.conjugate(upper), lower)
        rotations[f"{side}Foot"] = quat.multiply(quat.conjugate(lower), foot)
        rotations[f"{side}Toes"] = quat.conjugate(foot)
    return shift, rotations
