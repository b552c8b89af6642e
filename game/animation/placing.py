"""Hands and feet to where they belong: the local rotations of arms and legs that a solved limb asks for."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import bilinear as bl
from game.animation import figure
from game.animation.limbs import HINGE_WEIGHT_M, Limbs, solve_limbs

__all__ = ["place_limbs"]

Floats = NDArray[np.floating[Any]]

_HINGE = np.array([[0, 1, 0], [0, -1, 0], [-1, 0, 0], [-1, 0, 0]], dtype=np.float32)[..., None] * HINGE_WEIGHT_M
"""Axis, in the upper bone's frame, about which a straight limb opens: elbows bend forward, knees backward."""
_ENDS = figure.ENDS.reshape(-1)
_BACK = np.array([-1, -1, -1, 1], dtype=np.float32)
for _array in (_HINGE, _ENDS, _BACK):
    _array.setflags(write=False)


def place_limbs(limbs: Limbs, rotation: Floats, bones: Floats, goal: Floats) -> None:
    """Arms to their hands, legs to their feet: rewrites the twelve joints of the limbs in rotation (n, 41, 4).

    bones: (n, 16, 4, 4) matrices of figure.BONES as they are; goal: (n, 4, 4, 4) of both hands and both feet as they
    shall be, both in model space.
    """
    n = len(rotation)
    points = np.empty((n, 4, 4, 3), dtype=np.float32)
    points[:, :3] = bones[:, 4:, :3, 3].reshape(n, 3, 4, 3)
    points[:, 3] = goal[..., :3, 3]
    turned = bones[..., :3, :3]
    moved, opened = solve_limbs(limbs, points, (turned[:, 4:8] @ _HINGE)[..., 0])
    # A correction c in model space is RᵀcR in a frame R. The upper bone's is seen from what it hangs on, the joint's
    # from the upper bone, the lower bone's from itself: the end has to take that one back.
    fix = np.empty((n, 12, 4), dtype=np.float32)
    fix[:, :4] = moved[:, 0]
    fix[:, 4:8] = opened
    np.multiply(moved[:, 1], _BACK, out=fix[:, 8:])
    fix[..., :3] = (fix[:, :, None, :3] @ turned[:, :12])[:, :, 0]
    now = rotation.take(_ENDS, axis=1)
    now[:, 8:] = bl.from_matrix(turned[:, 8:12].swapaxes(-1, -2) @ goal[..., :3, :3])
    rotation[:, _ENDS] = bl.multiply(fix, now)
