"""The body under the clothes as fields: head and neck, trunk, forearm with hand and fingers, leg."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from game.core.humanoid import FINGERS, REFERENCE
from game.tools.modelling.fields import (
    Field,
    Floats,
    box,
    capsule,
    cone,
    ellipsoid,
    intersection,
    mirrored,
    sphere,
    subtraction,
    union,
)
from game.tools.modelling.rig import Arm, head_centre, left_arm
from game.tools.modelling.spec import BodySpec, HandSpec, HeadSpec

__all__ = ["Anatomy", "joint_at"]


def joint_at(name: str) -> Floats:
    """Where a joint of the reference humanoid stands in the T-pose, (3,) metres."""
    return np.asarray(REFERENCE.rest_model[REFERENCE.index[name], :3, 3])


@dataclass(frozen=True, eq=False)
class Anatomy:
    """Fields in model space, A-pose, metres. hand and leg are the left ones."""

    arm: Arm
    head_centre: Floats
    head: Field
    jaw: Field
    trunk: Field
    hand: Field
    leg: Field

    @staticmethod
    def of(head: HeadSpec, body: BodySpec, hand: HandSpec) -> Anatomy:
        arm = left_arm()
        centre = head_centre()
        jaw = ellipsoid(centre + head.jaw_at, head.jaw)
        return Anatomy(arm, centre, _head(head, centre, jaw), jaw, _trunk(body), _hand(body, hand, arm), _leg(body))


def _head(spec: HeadSpec, centre: Floats, jaw: Field) -> Field:
    def at(x: float, y: float, z: float) -> Floats:
        return centre + (x, y, z)

    skull = ellipsoid(at(0, 0.030, -0.012), spec.skull)
    cheeks = mirrored(sphere(centre + spec.cheek_at, spec.cheek))
    mass = union(0.075, union(0.07, skull, jaw, cheeks), sphere(centre + spec.chin_at, spec.chin))
    # One large ellipsoid planes off the brow, shallow hollows seat the eyes: the head of a figure, not a ball.
    mass = intersection(0.06, mass, ellipsoid(at(0, 0, -0.16), spec.brow_plane))
    mass = subtraction(0.05, mass, mirrored(ellipsoid(at(0.074, -0.030, 0.205), spec.eye_hollow)))
    nose_top = at(0, -0.060, 0.140)
    mass = union(
        0.022, mass, cone(nose_top, nose_top + (0, -spec.nose_drop, spec.nose_length), 0.009, spec.nose_radius)
    )
    ear = subtraction(
        0.012,
        ellipsoid(at(spec.ear_x, -0.030, -0.014), spec.ear),
        ellipsoid(at(spec.ear_x + 0.016, -0.026, -0.002), np.asarray(spec.ear) * (0.67, 0.6, 0.5)),
    )
    neck = cone((0, 0.915, -0.012), (0, 1.10, -0.010), spec.neck_base_radius, spec.neck_radius)
    return union(0.03, union(0.014, mass, mirrored(ear)), neck)


def _trunk(spec: BodySpec) -> Field:
    mass = union(
        0.06,
        ellipsoid((0, 0.815, 0), spec.chest),
        ellipsoid((0, 0.68, 0), spec.waist),
        ellipsoid((0, 0.55, 0), spec.pelvis),
    )
    if spec.belly[0] > 0.0:
        mass = union(0.05, mass, ellipsoid(spec.belly_at, spec.belly))
    shoulder = joint_at("leftUpperArm") * (0.69, 1, 1)
    yoke = capsule(shoulder * (-1, 1, 1), shoulder, spec.shoulder_radius)
    return union(0.03, union(0.055, mass, yoke), cone((0, 0.92, -0.01), (0, 0.985, -0.01), 0.064, 0.052))


def _hand(body: BodySpec, spec: HandSpec, arm: Arm) -> Field:
    forearm = cone(arm.at(arm.upper_m + body.forearm_from), arm.wrist, body.forearm_elbow, body.forearm_wrist)
    # It begins inside the rolled cuff: a longer one would show through the bent elbow of the sleeve.
    if body.forearm_from < 0.06:
        # The muscle under the elbow keeps the forearm from being a broom stick.
        muscle = ellipsoid(arm.at(arm.upper_m + 0.076, -0.005), (0.042, 0.031, 0.031), arm.axes)
        forearm = union(0.03, forearm, muscle)
    palm = union(
        0.02,
        box(arm.in_hand(0.038, -0.001, 0), spec.palm_half, 0.016, arm.axes),
        ellipsoid(arm.in_hand(0.026, -0.008, 0.024), (0.026, 0.015, 0.018), arm.axes),
        ellipsoid(arm.in_hand(0.022, -0.008, -0.022), (0.026, 0.013, 0.015), arm.axes),
    )
    fingers: Field | None = None
    for name, radius in zip(FINGERS, spec.fingers, strict=True):
        knuckle, middle, tip = arm.finger(name)
        root = knuckle + (-0.018, 0.0, -0.3 * (tip - knuckle)[2])
        bend = middle + (0.0, 0.001, 0.0)
        end = tip + (-radius, -0.002, 0.0)
        finger = union(
            0.006,
            cone(arm.in_hand(*root), arm.in_hand(*bend), radius * 1.02, radius),
            cone(arm.in_hand(*bend), arm.in_hand(*end), radius, radius * 0.86),
        )
        fingers = finger if fingers is None else union(0.0025, fingers, finger)
    assert fingers is not None
    base, middle, tip = (arm.in_hand(*p) for p in arm.thumb())
    thumb = union(
        0.008,
        cone(base, middle, spec.thumb * 1.24, spec.thumb * 1.02),
        cone(middle, tip, spec.thumb, spec.thumb * 0.81),
    )
    return union(0.012, union(0.010, union(0.022, forearm, palm), fingers), thumb)


def _leg(spec: BodySpec) -> Field:
    hip, knee, ankle = (joint_at(f"left{n}") for n in ("UpperLeg", "LowerLeg", "Foot"))
    calf = knee + (ankle - knee) * 0.36 + (0.0, 0.0, -0.008)
    return union(
        0.03,
        cone(hip, knee, 0.070, spec.knee),
        cone(knee, ankle + (0, -0.03, 0), spec.knee, spec.ankle),
        ellipsoid(calf, (spec.calf, 0.075, spec.calf)),
    )
