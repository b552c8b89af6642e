"""Two-bone inverse kinematics over all frames at once, and hands kept out of the body and the table."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import collision
from game.core import quaternion as quat
from game.core.humanoid import FINGERS, REFERENCE, TABLE_FRONT_Z_M, TABLE_TOP_M
from game.formats.joint_map import SIDES
from game.tools.retarget.source import unit

__all__ = ["bend_to", "clear_hands", "soft_reach"]

Floats = NDArray[np.floating[Any]]
_HANN_FRAMES = 13
_PASSES = 5
_HINGE_SHARE = 0.08
"""Sine of the bend below which the rest hinge decides the plane of a limb."""
_TOLERANCE_M = 0.006
"""How deep a hand may press into the (soft) body."""


def soft_reach(reach: Floats, length: float, soft: float, full: float) -> Floats:
    """(F,) distances clamped smoothly from the share ``soft`` of a limb's length on, never beyond ``full``."""
    knee, room = soft * length, max((full - soft) * length, 1e-9)
    over = np.maximum(reach - knee, 0.0)
    return np.asarray(np.minimum(reach, knee) + room * -np.expm1(-over / room))


def bend_to(
    root: Floats, joint: Floats, end: Floats, target: Floats, hinge: Floats, *, soft: float, full: float
) -> tuple[Floats, Floats]:
    """Turns (F, 4) in the world for the upper and the lower bone that bring the end (F, 3) to the target.

    The limb keeps the plane it bends in, which swings with the way from root to end; a limb that is nearly straight
    has no plane of its own and takes the hinge's, (F, 3) unit, along upper × lower of a bent limb.
    """
    upper, lower = joint - root, end - joint
    a = float(np.linalg.norm(upper, axis=-1).mean())
    b = float(np.linalg.norm(lower, axis=-1).mean())
    now, way = upper + lower, target - root
    reach = soft_reach(np.linalg.norm(way, axis=-1), a + b, soft, full)
    reach = np.maximum(reach, abs(a - b) + 1e-3)
    normal = unit(np.cross(unit(upper), unit(lower)) + _HINGE_SHARE * hinge)
    turned = quat.rotate(quat.between(now, way), normal)
    along = unit(way)
    out = unit(np.cross(along, turned))
    # Law of cosines: how far along and how far out of the way the middle joint lies.
    ahead = np.clip((a * a + reach * reach - b * b) / (2.0 * reach), -a, a)
    aside = np.sqrt(np.maximum(a * a - ahead * ahead, 0.0))
    new_upper = along * ahead[:, None] + out * aside[:, None]
    new_lower = along * reach[:, None] - new_upper
    return _carried(upper, normal, new_upper, turned), _carried(lower, normal, new_lower, turned)


def _carried(bone: Floats, normal: Floats, new_bone: Floats, new_normal: Floats) -> Floats:
    """(F, 4) the turn that takes a bone, and the normal beside it, to their new directions."""
    swing = quat.between(bone, new_bone)
    x = unit(new_bone)
    before, after = quat.rotate(swing, normal), new_normal
    before, after = before - x * (before * x).sum(-1, keepdims=True), after - x * (after * x).sum(-1, keepdims=True)
    return quat.multiply(quat.between(before, after), swing)


def clear_hands(position: Floats, rotation: Floats, wrists: dict[str, Floats], *, table: bool) -> dict[str, Floats]:
    """Wrist targets (F, 3) per side moved so that hands and forearms are outside trunk, head and, if wanted, table.

    position (F, 41, 3), rotation (F, 41, 4): the pose with its present arms, in the world.
    """
    window = np.hanning(_HANN_FRAMES + 2)[1:-1]
    window /= window.sum()
    moved = dict(wrists)
    for _ in range(_PASSES):
        points = np.stack([_points(position, rotation, side, moved[side]) for side in SIDES], axis=1)
        push = _out_of_body(position, rotation, points)
        if table:
            push = push + _off_table(points + push[:, :, None])
        for i, side in enumerate(SIDES):
            moved[side] = moved[side] + _smooth(push[:, i], window)
    return moved


def _out_of_body(position: Floats, rotation: Floats, points: Floats) -> Floats:
    """(F, 2, 3) the push of each hand's deepest contact with the body's ellipsoids; points (F, 2, P, 3)."""
    deepest = np.zeros(points.shape[:2])
    push = np.zeros((*points.shape[:2], 3))
    for name, centre, radii in collision.BODY:
        joint = REFERENCE.index[name]
        turn = rotation[:, joint, None, None]
        from_joint = quat.rotate(quat.conjugate(turn), points - position[:, joint, None, None])
        at = from_joint - (np.asarray(centre) - REFERENCE.rest_model[joint, :3, 3])
        scaled = at / np.asarray(radii)
        norm = np.maximum(np.linalg.norm(scaled, axis=-1), 1e-6)
        slope = scaled / np.asarray(radii)
        steep = np.maximum(np.linalg.norm(slope, axis=-1), 1e-6)
        # Quílez' estimate of the distance to an ellipsoid; exact on the surface.
        depth = collision.POINT_RADII - _TOLERANCE_M - norm * (norm - 1.0) / steep
        worst = depth.argmax(axis=-1)[..., None]
        depth = np.take_along_axis(depth, worst, axis=-1)[..., 0]
        away = quat.rotate(turn, slope / steep[..., None])
        away = np.take_along_axis(away, worst[..., None], axis=2)[:, :, 0]
        deeper = depth > deepest
        deepest = np.where(deeper, depth, deepest)
        push = np.where(deeper[..., None], depth[..., None] * away, push)
    return push


def _off_table(points: Floats) -> Floats:
    """(F, 2, 3) up onto the table or back off its edge, whichever is nearer, shared between the two at the corner."""
    y, z = points[..., 1], points[..., 2]
    radius = collision.POINT_RADII + 0.004
    up = np.maximum(TABLE_TOP_M + radius - y, 0.0)
    back = np.maximum(z - (collision.TABLE_BACK_Z_M - radius), 0.0)
    inside = (up > 0.0) & (back > 0.0) & (z < TABLE_FRONT_Z_M + radius)
    share = back**2 / np.maximum(back**2 + up**2, 1e-12)
    push = np.zeros((*points.shape[:2], 3))
    push[..., 1] = np.where(inside, up * share, 0.0).max(axis=-1)
    push[..., 2] = -np.where(inside, back * (1.0 - share), 0.0).max(axis=-1)
    return push


def _points(position: Floats, rotation: Floats, side: str, wrist: Floats) -> Floats:
    """(F, 7, 3) wrist, palm, middle knuckle, tips of middle, index and little finger, middle of the forearm."""
    index = REFERENCE.index
    shift = wrist - position[:, index[f"{side}Hand"]]

    def at(name: str) -> Floats:
        return np.asarray(position[:, index[side + name]] + shift)

    palm = wrist + 0.7 * (at("MiddleProximal") - wrist)
    tips = []
    for finger in (FINGERS[1], FINGERS[0], FINGERS[3]):
        joint = index[f"{side}{finger}Intermediate"]
        bone = np.broadcast_to(REFERENCE.rest_translation[joint], wrist.shape)
        tips.append(at(f"{finger}Intermediate") + quat.rotate(rotation[:, joint], bone))
    elbow = position[:, index[f"{side}LowerArm"]] + 0.5 * shift
    return np.stack([wrist, palm, at("MiddleIntermediate"), *tips, 0.5 * (wrist + elbow)], axis=1)


def _smooth(push: Floats, window: Floats) -> Floats:
    """Pushes begin before they are needed and end after: each frame gets its neighbours' share, by a Hann window."""
    half = len(window) // 2
    padded = np.pad(push, ((half, half), (0, 0)), mode="edge")
    return np.stack([np.convolve(padded[:, k], window, mode="valid") for k in range(3)], axis=-1)
