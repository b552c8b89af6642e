"""Legs that walk, layered under what the engine's units do with trunk, head and hands; for many characters at once.

The step is drawn in the plane each leg swings in: during stance the foot goes back under the body exactly as fast as
the body goes forward, so feet do not slide; two bones reach it by the law of cosines. Phase and amount come from
outside, so that the same moment looks the same at any rate of ticks.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import bilinear as bl
from game.animation.pose import Pose
from game.core.humanoid import REFERENCE

__all__ = ["STANCE", "foot_path", "walk"]

Floats = NDArray[np.floating[Any]]

STANCE = 0.6
"""Share of a cycle a foot is on the ground."""
LIFT_M, HEEL_M = 0.075, 0.045
DROP_M, BOB_M, SHIFT_M = 0.034, 0.012, 0.012
"""How much lower walking hips are, how they bob twice and shift once a cycle."""
ARM_DOWN_RAD, ARM_SWING_RAD, ELBOW_RAD = 1.28, 0.42, 0.38
TURN_RAD, LEAN_RAD = 0.10, 0.05

_SIDES = ("left", "right")
_INDEX = REFERENCE.index
_LEGS = np.array([[_INDEX[f"{side}{bone}"] for side in _SIDES] for bone in ("UpperLeg", "LowerLeg", "Foot")])
_ARMS = np.array([[_INDEX[f"{side}{bone}"] for side in _SIDES] for bone in ("UpperArm", "LowerArm", "Hand")])
_HIPS, _SPINE = _INDEX["hips"], _INDEX["spine"]
_REST = REFERENCE.rest_model[:, :3, 3]
_HIP_Y = float(_REST[_LEGS[0, 0], 1])
_ANKLE_Y = float(_REST[_LEGS[2, 0], 1])
_THIGH = float(np.linalg.norm(_REST[_LEGS[1, 0], 1:] - _REST[_LEGS[0, 0], 1:]))
_SHIN = float(np.linalg.norm(_REST[_LEGS[2, 0], 1:] - _REST[_LEGS[1, 0], 1:]))
_OUT = np.array([1.0, -1.0])  # left is +x
for _array in (_LEGS, _ARMS, _REST, _OUT):
    _array.setflags(write=False)


def foot_path(phase: Floats, length_m: Floats) -> tuple[Floats, Floats, Floats]:
    """Where an ankle is in its cycle: ahead of the hip and above its rest (metres), and the pitch of the foot (rad,
    toes down positive).

    phase: cycles, stance from 0 to STANCE; length_m: the ground one cycle covers. All of one shape.
    """
    phase = phase % 1.0
    half = 0.5 * STANCE * length_m
    stance = np.minimum(phase / STANCE, 1.0)
    swing = np.maximum((phase - STANCE) / (1.0 - STANCE), 0.0)
    eased = swing * swing * (3.0 - 2.0 * swing)
    ahead = np.where(phase < STANCE, half * (1.0 - 2.0 * stance), half * (2.0 * eased - 1.0))
    push_off = np.clip((stance - 0.7) / 0.3, 0.0, 1.0)
    heel = np.where(phase < STANCE, push_off * push_off, (1.0 - np.minimum(swing / 0.55, 1.0)) ** 2)
    share = np.minimum(length_m / 0.5, 1.0)
    up = share * (HEEL_M * heel + LIFT_M * np.sin(np.pi * swing) ** 2)
    pitch = share * (0.75 * heel - 0.30 * np.clip((swing - 0.55) / 0.45, 0.0, 1.0) ** 2)
    return ahead, up, pitch


def walk(pose: Pose, phase: Floats, length_m: Floats, amount: Floats) -> Pose:
    """The pose with legs, hips and arms walking. phase: (n,) cycles; length_m: (n,) of ground per cycle; amount: (n,)
    0 leaves the pose as it is, 1 walks. Trunk, head and fingers keep what the units do."""
    n = len(pose)
    part = np.asarray(amount, dtype=np.float64)
    wave, twice = np.sin(2.0 * np.pi * phase), np.cos(4.0 * np.pi * phase)
    root = pose.root.astype(np.float64)
    root[:, 1] = _mix(root[:, 1], _REST[_HIPS, 1] - DROP_M + BOB_M * twice, part)
    root[:, 0] = _mix(root[:, 0], SHIFT_M * wave, part)
    root[:, 2] = _mix(root[:, 2], np.zeros(n), part)
    rotation = pose.rotation.astype(np.float32, copy=True)
    hips = _turn(1, TURN_RAD * np.cos(2.0 * np.pi * phase))
    rotation[:, _HIPS] = _blend(rotation[:, _HIPS], hips, part)
    counter = _product(_turn(0, np.full(n, LEAN_RAD)), _turn(1, -1.6 * TURN_RAD * np.cos(2.0 * np.pi * phase)))
    rotation[:, _SPINE] = _blend(rotation[:, _SPINE], counter, part)

    both = phase[:, None] + np.array([0.0, 0.5])
    ahead, up, pitch = foot_path(both, np.repeat(length_m[:, None], 2, axis=1))
    down = (root[:, 1] - _REST[_HIPS, 1] + _HIP_Y)[:, None] - (_ANKLE_Y + up)
    far = np.clip(np.hypot(ahead, down), abs(_THIGH - _SHIN) + 0.02, _THIGH + _SHIN - 0.002)
    thigh = np.arctan2(ahead, down) + _corner(_THIGH, far, _SHIN)
    knee = np.pi - _corner_between(_THIGH, _SHIN, far)
    upper = _product(bl.conjugate(rotation[:, None, _HIPS]), _turn(0, -thigh))
    for joint, wanted in ((0, upper), (1, _turn(0, knee)), (2, _turn(0, thigh - knee + pitch))):
        rotation[:, _LEGS[joint]] = _blend(rotation[:, _LEGS[joint]], wanted, part[:, None])

    # An arm swings with the other leg.
    swing = ARM_SWING_RAD * np.cos(2.0 * np.pi * (both + 0.5)) * np.minimum(length_m / 0.5, 1.0)[:, None]
    arm = _product(_turn(0, -swing), _turn(2, np.broadcast_to(-ARM_DOWN_RAD * _OUT, (n, 2))))
    elbow = _turn(1, -_OUT * (ELBOW_RAD + 0.5 * np.maximum(swing, 0.0)))
    for joint, wanted in ((0, arm), (1, elbow), (2, _turn(0, np.zeros((n, 2))))):
        rotation[:, _ARMS[joint]] = _blend(rotation[:, _ARMS[joint]], wanted, part[:, None])
    return replace(pose, rotation=rotation, root=root.astype(pose.root.dtype))


def _corner(side: float, far: Floats, opposite: float) -> Floats:
    """Angle between ``side`` and ``far`` in a triangle whose third side is ``opposite``."""
    return np.asarray(np.arccos(np.clip((side**2 + far**2 - opposite**2) / (2.0 * side * far), -1.0, 1.0)))


def _corner_between(a: float, b: float, far: Floats) -> Floats:
    return np.asarray(np.arccos(np.clip((a**2 + b**2 - far**2) / (2.0 * a * b), -1.0, 1.0)))


def _turn(axis: int, angle: Floats) -> Floats:
    """Quaternions (..., 4) about x, y or z."""
    result = np.zeros((*np.shape(angle), 4), dtype=np.float32)
    result[..., axis], result[..., 3] = np.sin(0.5 * angle), np.cos(0.5 * angle)
    return result


def _product(a: Floats, b: Floats) -> Floats:
    a, b = np.broadcast_arrays(a, b)
    return np.asarray(bl.multiply(np.ascontiguousarray(a), np.ascontiguousarray(b)))


def _mix(a: Floats, b: Floats, share: Floats) -> Floats:
    return np.asarray(a + (b - a) * share)


def _blend(a: Floats, b: Floats, share: Floats) -> Floats:
    """Rotations between a and b, (..., 4); share: (...)."""
    near = np.where((a * b).sum(axis=-1, keepdims=True) < 0.0, -b, b)
    return np.asarray(bl.normalize((a + (near - a) * share[..., None]).astype(np.float32)))
