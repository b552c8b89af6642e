"""How far arms and legs reach: what the compiled two-bone inverse kinematics (limbs.h) knows of a body."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["ARM", "LIMB", "STRAIGHT", "limb_table"]

Floats = NDArray[np.floating[Any]]

ARM = (0.93, 0.985)
"""Shares of an arm's length between which its reach is softly clamped (MOTION.md, contacts)."""
STRAIGHT = (0.999, 0.9998)
"""The same for legs, which stand straight at rest."""

LIMB = np.dtype(
    [("upper_m", "f4"), ("lower_m", "f4"), ("give_m", "f4"), ("full_m", "f4"), ("hinge", "f4", 3)], align=True
)
"""Limb in limbs.h."""

_HINGES = ((0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (-1.0, 0.0, 0.0), (-1.0, 0.0, 0.0))
"""Axis of the upper bone's frame about which a straight limb opens: elbows bend forward, knees back."""


def limb_table(upper_m: Floats, lower_m: Floats, reach: Floats) -> NDArray[np.void]:
    """(4,) LIMB of left and right arm, left and right leg. upper_m, lower_m: (4,) bone lengths; reach: (4, 2) shares of
    both together, where a limb begins to give way and where it is as long as it gets."""
    limbs = np.zeros(4, dtype=LIMB)
    limbs["upper_m"], limbs["lower_m"], limbs["hinge"] = upper_m, lower_m, _HINGES
    limbs["give_m"], limbs["full_m"] = (upper_m + lower_m) * reach.T
    return limbs
