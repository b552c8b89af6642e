"""What hands stay out of (tick/contacts.c): the body as a handful of ellipsoids on chest, spine, hips and head, and the
table as a slab (MOTION.md, contacts); and the points of a hand that do."""

from __future__ import annotations

import numpy as np

from game.core.humanoid import HEAD_CENTRE_OFFSET, REFERENCE

__all__ = ["BODY", "POINT_RADII", "TABLE_BACK_Z_M", "TOLERANCE_M"]

_REST = {name: REFERENCE.rest_model[i, :3, 3] for i, name in enumerate(REFERENCE.names)}
_HEAD = _REST["head"] + HEAD_CENTRE_OFFSET

BODY: tuple[tuple[str, tuple[float, float, float], tuple[float, float, float]], ...] = (
    ("chest", (0.0, 0.815, 0.0), (0.145, 0.145, 0.112)),
    ("chest", (0.0, 0.902, -0.008), (0.130, 0.060, 0.060)),
    ("spine", (0.0, 0.680, 0.0), (0.135, 0.140, 0.112)),
    ("hips", (0.0, 0.550, 0.0), (0.175, 0.120, 0.145)),
    ("head", (0.0, _HEAD[1] - 0.03, _HEAD[2] + 0.01), (0.150, 0.155, 0.150)),
    ("head", (0.0, _HEAD[1] + 0.02, _HEAD[2] - 0.015), (0.186, 0.178, 0.180)),
)
"""Joint, centre in the rest pose, radii: metres."""

POINT_RADII = np.array([0.027, 0.024, 0.012, 0.011, 0.011, 0.011, 0.036], dtype=np.float32)
"""Wrist, palm, middle knuckle, tips of middle, index and little finger, middle of the forearm: metres."""
TOLERANCE_M = np.array([0.006, 0.006, 0.006, 0.006, 0.006, 0.006, 0.020], dtype=np.float32)
"""How deep each may press into the (soft) body."""
TABLE_BACK_Z_M = 0.155
for _array in (POINT_RADII, TOLERANCE_M):
    _array.setflags(write=False)
