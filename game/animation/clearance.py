"""What keeps big hands out of the body they belong to, as skin/clear.c wants it: the hand's balls, the body's shape."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import figure
from game.animation.body_shape import COLUMNS, ROWS, BodyShape
from game.animation.collision import POINT_RADII
from game.core.humanoid import REFERENCE

__all__ = ["BIGGER_HAND", "FINGER", "HAND", "SHAPE", "hand_reach", "hands_table", "shapes_table"]

Floats = NDArray[np.floating[Any]]

BIGGER_HAND = 1.1
"""Hands up to so many times the reference's lie where the reference's contacts put them."""
_FINGERS = (
    ("Thumb", "Metacarpal", "Proximal"),
    *((f, "Proximal", "Intermediate") for f in ("Index", "Middle", "Little")),
)
_PALM = ((0.0, 0.0, 0.0), (0.050, -0.002, 0.0), (0.030, -0.006, 0.026))
"""Wrist, middle of the palm, ball of the thumb: from the wrist of the reference's left hand, metres."""
_PALM_RADII = (float(POINT_RADII[0]), 0.027, 0.027)
_FINGER_RADIUS, _THUMB_RADIUS = 0.0132, 0.0155
_TIP_M = 0.030
"""From the outer joint that the reference has to where a finger's end is round, metres."""
_REACH_M = 0.10

# As in skin/fit.h.
SHAPE = np.dtype(
    [
        ("joint", "<i4"),
        ("centre", "<f4", 3),
        ("height", "<f4"),
        ("widest", "<f4"),
        ("around", "<f4", ROWS),
        ("radius", "<f4", (ROWS, COLUMNS)),
    ]
)
_BALL = np.dtype([("place", "<f4", 3), ("radius", "<f4")])
FINGER = np.dtype(
    [("first", "<i4"), ("second", "<i4"), *((name, "<f4", 3) for name in ("base", "joint", "tip")), ("radius", "<f4")]
)
HAND = np.dtype([("palm", _BALL, len(_PALM)), ("finger", FINGER, len(_FINGERS))])


def hand_reach(hand: float) -> float:
    """From the palm's end to beyond the furthest ball of a hand so many times the reference's, metres."""
    return _REACH_M * hand


def hands_table(places: Mapping[str, Floats], hand: float) -> NDArray[np.void]:
    """(2,) HAND of both hands. places: joint -> (3,) in the T-pose; hand: its size over the reference's."""
    hands = np.zeros(2, dtype=HAND)
    for table, side, sign in zip(hands, ("left", "right"), (1.0, -1.0), strict=True):
        mirror = np.array([sign, 1.0, 1.0])
        table["palm"]["place"] = np.array(_PALM) * mirror * hand
        table["palm"]["radius"] = np.array(_PALM_RADII) * hand
        for finger, (name, first, second) in zip(table["finger"], _FINGERS, strict=True):
            joints = [f"{side}{name}{first}", f"{side}{name}{second}"]
            finger["first"], finger["second"] = (REFERENCE.index[joint] for joint in joints)
            base, joint = places[joints[0]] - places[f"{side}Hand"], places[joints[1]] - places[joints[0]]
            finger["base"], finger["joint"] = base, joint
            finger["tip"] = joint / max(float(np.linalg.norm(joint)), 1e-6) * (_TIP_M * hand)
            finger["radius"] = (_THUMB_RADIUS if name == "Thumb" else _FINGER_RADIUS) * hand
    return hands


def shapes_table(shape: BodyShape) -> NDArray[np.void]:
    """(n,) SHAPE of the regions that were measured."""
    table = np.zeros(len(shape.radius), dtype=SHAPE)
    for row, region in zip(table, shape.radius, strict=True):
        row["joint"] = figure.WHERE[region]
        row["centre"], row["height"], row["radius"] = shape.centre[region], shape.height[region], shape.radius[region]
        widest = shape.radius[region].max(axis=1)
        row["widest"], row["around"] = widest.max(), np.maximum(widest, np.append(widest[1:], 0.0))
    return table
