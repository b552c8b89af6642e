"""Cameras and projections: right-handed, Y up, looking along −Z of the view, depth −1..1 (GL)."""

from __future__ import annotations

from dataclasses import dataclass
from math import dist, radians, tan

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["CLOSEUP", "HERO", "Camera", "look_at", "orthographic", "perspective"]

Matrix = NDArray[np.float64]
NEAR_M, FAR_M = 0.3, 30.0
DESIGN_ASPECT = 16.0 / 9.0


def look_at(eye: ArrayLike, target: ArrayLike, up: ArrayLike = (0.0, 1.0, 0.0)) -> Matrix:
    """World to view, (4, 4)."""
    origin = np.asarray(eye, dtype=np.float64)
    back = origin - np.asarray(target, dtype=np.float64)
    back /= np.linalg.norm(back)
    right = np.cross(np.asarray(up, dtype=np.float64), back)
    right /= np.linalg.norm(right)
    view = np.eye(4)
    view[:3, :3] = np.stack([right, np.cross(back, right), back])
    view[:3, 3] = -view[:3, :3] @ origin
    return view


def perspective(tan_half_height: float, aspect: float, near: float = NEAR_M, far: float = FAR_M) -> Matrix:
    """View to clip, (4, 4)."""
    f = 1.0 / tan_half_height
    result = np.zeros((4, 4))
    result[0, 0], result[1, 1] = f / aspect, f
    result[2, 2], result[2, 3] = (far + near) / (near - far), 2.0 * far * near / (near - far)
    result[3, 2] = -1.0
    return result


def orthographic(half_width: float, half_height: float, near: float, far: float) -> Matrix:
    """View to clip of a box around the view axis, (4, 4)."""
    result = np.diag([1.0 / half_width, 1.0 / half_height, -2.0 / (far - near), 1.0])
    result[2, 3] = -(far + near) / (far - near)
    return result


@dataclass(frozen=True)
class Camera:
    """Where the picture is taken from: eye and target in metres, vertical field in degrees of a picture of the width to
    height it is composed for."""

    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    fov_deg: float
    aspect: float = DESIGN_ASPECT

    def tan_half_height(self, aspect: float) -> float:
        """Half the picture's height at distance 1; a narrower picture than the composed one sees more above and below,
        a wider one more at its sides: neither loses anything."""
        half = tan(radians(self.fov_deg) / 2.0)
        return half * max(1.0, self.aspect / aspect)

    def distance_m(self, place: tuple[float, float, float]) -> float:
        """From the eye to a place."""
        return dist(self.eye, place)

    def view(self) -> Matrix:
        return look_at(self.eye, self.target)

    def projection(self, aspect: float) -> Matrix:
        return perspective(self.tan_half_height(aspect), aspect)

    def view_projection(self, aspect: float) -> Matrix:
        """World to clip, (4, 4), for a picture of width/height ``aspect``."""
        return self.projection(aspect) @ self.view()


HERO = Camera((0.0, 1.16, 3.02), (0.0, 0.985, 0.0), 24.5)
CLOSEUP = Camera((0.10, 1.22, 2.05), (0.02, 1.12, 0.0), 27.0)
