"""The humanoid the takes are performed on and every shopkeeper is driven by.

Joints carry the VRM 1.0 humanoid names. Conventions, everywhere in the project: metres, Y up, the character
faces +Z, its left is +X; the rest pose is a T-pose whose local rotations are all the identity (arms along ±X,
palms down, thumbs toward +Z). A character with other proportions has the same joints with other offsets.

The proportions are ART.md's: 1.40 m to the crown, chin at 1.04 m, 3.9 heads.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from game.core.skeleton import Skeleton

__all__ = [
    "BODY_PARTS",
    "FINGERS",
    "HEAD_CENTRE_OFFSET",
    "PART_JOINTS",
    "REFERENCE",
    "TABLE_FRONT_Z_M",
    "TABLE_TOP_M",
    "mirrored_name",
]

TABLE_TOP_M = 0.585
"""Height of the stall's table top, metres; it spans z from TABLE_BACK to TABLE_FRONT before the character."""
TABLE_FRONT_Z_M = 0.74

HEAD_CENTRE_OFFSET = np.array([0.0, 0.178, 0.008])
"""Centre of the skull in the head joint's frame, metres."""
HEAD_CENTRE_OFFSET.setflags(write=False)

FINGERS = ("Index", "Middle", "Ring", "Little")

# Hand geometry in the hand joint's frame of the left hand (x along the fingers, y back of hand, z thumb side):
# knuckle x, knuckle z, finger length, spread of the tip in z. Metres.
_FINGER_GEOMETRY = {
    "Index": (0.070, 0.0305, 0.058, 0.0065),
    "Middle": (0.075, 0.0100, 0.065, 0.0018),
    "Ring": (0.071, -0.0108, 0.060, -0.0022),
    "Little": (0.062, -0.0300, 0.047, -0.0070),
}


def _build() -> Skeleton:
    rest: list[tuple[str, str | None, tuple[float, float, float]]] = [
        ("hips", None, (0.0, 0.56, 0.0)),
        ("spine", "hips", (0.0, 0.66, 0.0)),
        ("chest", "spine", (0.0, 0.77, 0.0)),
        ("neck", "chest", (0.0, 0.955, -0.008)),
        ("head", "neck", (0.0, 1.03, -0.004)),
    ]
    upper_arm_m, forearm_m = 0.216, 0.206
    for side, sign in (("left", 1.0), ("right", -1.0)):
        shoulder = np.array([0.128, 0.905, -0.008])
        elbow = shoulder + (upper_arm_m, 0, 0)
        wrist = elbow + (forearm_m, 0, 0)

        def at(point: np.ndarray | tuple[float, float, float], sign: float = sign) -> tuple[float, float, float]:
            return (sign * float(point[0]), float(point[1]), float(point[2]))

        rest += [
            (f"{side}Shoulder", "chest", at((0.030, 0.915, 0.0))),
            (f"{side}UpperArm", f"{side}Shoulder", at(shoulder)),
            (f"{side}LowerArm", f"{side}UpperArm", at(elbow)),
            (f"{side}Hand", f"{side}LowerArm", at(wrist)),
            (f"{side}ThumbMetacarpal", f"{side}Hand", at(wrist + (0.018, -0.006, 0.026))),
            (f"{side}ThumbProximal", f"{side}ThumbMetacarpal", at(wrist + (0.046, -0.012, 0.054))),
        ]
        for finger in FINGERS:
            knuckle_x, knuckle_z, length, spread = _FINGER_GEOMETRY[finger]
            rest += [
                (f"{side}{finger}Proximal", f"{side}Hand", at(wrist + (knuckle_x, 0.0, knuckle_z))),
                (
                    f"{side}{finger}Intermediate",
                    f"{side}{finger}Proximal",
                    at(wrist + (knuckle_x + 0.48 * length, 0.0, knuckle_z + 0.5 * spread)),
                ),
            ]
        rest += [
            (f"{side}UpperLeg", "hips", at((0.066, 0.520, 0.0))),
            (f"{side}LowerLeg", f"{side}UpperLeg", at((0.068, 0.290, 0.006))),
            (f"{side}Foot", f"{side}LowerLeg", at((0.070, 0.070, -0.012))),
            (f"{side}Toes", f"{side}Foot", at((0.072, 0.022, 0.062))),
        ]
    names = tuple(name for name, _, _ in rest)
    where = {name: np.array(position) for name, _, position in rest}
    parents = np.array([-1 if parent is None else names.index(parent) for _, parent, _ in rest])
    offsets = np.array([where[n] - (0.0 if p is None else where[p]) for n, p, _ in rest])
    return Skeleton(names, parents, offsets, np.tile([0.0, 0.0, 0.0, 1.0], (len(names), 1)))


REFERENCE: Skeleton = _build()
"""The project's skeleton, 41 joints: the takes' BVH files and the motion units use it."""

BODY_PARTS: tuple[str, ...] = (
    "head",
    "face",
    "gaze",
    "spine",
    "left_arm",
    "right_arm",
    "left_hand",
    "right_hand",
    "legs",
)
"""The parts a unit may use or lock (SPEC 2, constraint state)."""


def _hand_joints(side: str) -> tuple[str, ...]:
    return tuple(n for n in REFERENCE.names if n.startswith(side) and any(k in n for k in ("Thumb", *FINGERS)))


PART_JOINTS: Mapping[str, tuple[str, ...]] = {
    "head": ("neck", "head"),
    "face": (),
    "gaze": (),
    "spine": ("hips", "spine", "chest"),
    "left_arm": ("leftShoulder", "leftUpperArm", "leftLowerArm", "leftHand"),
    "right_arm": ("rightShoulder", "rightUpperArm", "rightLowerArm", "rightHand"),
    "left_hand": _hand_joints("left"),
    "right_hand": _hand_joints("right"),
    "legs": tuple(f"{s}{b}" for s in ("left", "right") for b in ("UpperLeg", "LowerLeg", "Foot", "Toes")),
}
"""Body part -> the joints it moves. ``face`` and ``gaze`` own no joints of the skeleton."""


def mirrored_name(name: str) -> str:
    """leftHand <-> rightHand; other names are returned as they are."""
    if name.startswith("left"):
        return "right" + name[4:]
    if name.startswith("right"):
        return "left" + name[5:]
    return name
