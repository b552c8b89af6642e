"""What one sampled frame of a motion unit holds, and which body part moves each number.

A *row* is everything a unit says about one moment as one flat vector, so that mixing variants (EMBOS eq. 5),
layering and transitions are the same few array operations on all of it:

- ROTATION: 41 local quaternions (of REFERENCE, joint by joint),
- PALM, WRIST: rotation and place of both hands in the unit's contact frame (table, head, chest or hips),
- ROOT: translation of the hips, metres,
- POINTS: knuckle and finger tips of both hands in the hand's own frame, for collisions.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from game.core.humanoid import PART_JOINTS, REFERENCE

__all__ = [
    "ADDITIVE_JOINTS",
    "CHANNELS",
    "CONTACT_FRAMES",
    "HANDS",
    "JOINTS",
    "PALM",
    "PARTS",
    "PART_OF_CHANNEL",
    "PART_OF_JOINT",
    "PLACES",
    "POINTS",
    "POINTS_PER_HAND",
    "ROOT",
    "ROTATION",
    "TURNS",
    "WRIST",
]

JOINTS = len(REFERENCE)
HANDS = ("left_hand", "right_hand")
POINTS_PER_HAND = 4

ROTATION = slice(0, 4 * JOINTS)
PALM = slice(ROTATION.stop, ROTATION.stop + 2 * 4)
WRIST = slice(PALM.stop, PALM.stop + 2 * 3)
ROOT = slice(WRIST.stop, WRIST.stop + 3)
POINTS = slice(ROOT.stop, ROOT.stop + 2 * POINTS_PER_HAND * 3)
CHANNELS = POINTS.stop

TURNS = slice(ROTATION.start, PALM.stop)
"""All quaternions of a row: the joints', then both palms'."""
PLACES = slice(WRIST.start, ROOT.stop)
"""All places but the points': wrists, then hips."""

PARTS: tuple[str, ...] = ("spine", "head", "left_arm", "right_arm", "left_hand", "right_hand", "legs")
"""Body parts that own joints; masks and transitions work on these."""

CONTACT_FRAMES: tuple[str, ...] = ("table", "head", "chest", "hips")
"""Frames a hand can be held in. The table does not move, so its frame is model space."""

ADDITIVE_JOINTS: NDArray[np.intp] = np.array(
    [REFERENCE.index[n] for n in ("hips", "spine", "chest", "neck", "head", "leftShoulder", "rightShoulder")]
)
"""Joints on which a unit that does not own them may still leave a trace (a sigh lifts the chest)."""


def _part_of_joint() -> NDArray[np.intp]:
    part = np.zeros(JOINTS, dtype=np.intp)
    for index, name in enumerate(PARTS):
        part[[REFERENCE.index[joint] for joint in PART_JOINTS[name]]] = index
    part.setflags(write=False)
    return part


def _part_of_channel() -> NDArray[np.intp]:
    left_arm, left_hand = PARTS.index("left_arm"), PARTS.index("left_hand")
    part = np.empty(CHANNELS, dtype=np.intp)
    part[ROTATION] = np.repeat(PART_OF_JOINT, 4)
    part[ROOT] = PARTS.index("spine")
    part[WRIST] = left_arm + np.repeat([0, 1], 3)
    part[PALM] = left_arm + np.repeat([0, 1], 4)
    part[POINTS] = left_hand + np.repeat([0, 1], 3 * POINTS_PER_HAND)
    part.setflags(write=False)
    return part


PART_OF_JOINT: NDArray[np.intp] = _part_of_joint()
"""(41,) index into PARTS."""
PART_OF_CHANNEL: NDArray[np.intp] = _part_of_channel()
"""(CHANNELS,) index into PARTS."""
