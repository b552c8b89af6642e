"""The framings of a talk: where the camera stands in each shot, and how one glides into the next.

A glide is one quintic per number of the camera: it starts with the place, speed and acceleration the camera has, ends
at rest exactly in the new framing, and is a function of time alone, so 30, 60 and 144 frames a second see one path.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import radians, tan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.render import HERO, Camera

__all__ = ["ESTABLISHING", "LARGE_TEXT_DROP", "SHOTS", "Glide", "camera_of", "framing", "numbers_of", "stand"]

Floats = NDArray[np.floating[Any]]

SHOTS: dict[str, Camera] = {
    "home": HERO,
    "talk": Camera((0.36, 1.15, 3.16), (0.26, 0.93, 0.0), 25.5),
    "side": Camera((0.66, 1.15, 3.16), (0.56, 0.95, 0.0), 25.5),
    "close": Camera((0.26, 1.17, 2.30), (0.165, 1.09, 0.0), 25.0),
    "glance": Camera((0.33, 1.29, 2.98), (0.24, 0.87, 0.02), 27.2),
    "offer": Camera((0.40, 1.40, 2.72), (0.26, 0.885, 0.05), 29.2),
}
"""home: the whole stall. talk: room on the right for what may be said, the hands above the subtitles. side: a sheet
covers the right half. close: the face fills the frame. glance: down to the hands, once. offer: over the table."""

ESTABLISHING = Camera((-0.62, 1.34, 4.05), (-0.02, 1.0, 0.0), 30.0)
"""First sight of a stall, from where one comes walking."""


LARGE_TEXT_DROP = 0.034
"""Of the picture's height, by which the camera stands lower where letters are twice as large …"""
ABOVE_WORDS = frozenset({"talk", "side"})
"""… in shots that show hands above the box of words, which grows with the letters, and have room above the head."""


def framing(shot: str, text_scale: float = 1.0) -> Camera:
    """The camera of a shot. text_scale: how large letters are, 1 as drawn, 2 twice as large."""
    camera, large_text = SHOTS[shot], min(max(text_scale - 1.0, 0.0), 1.0)
    if shot not in ABOVE_WORDS or large_text == 0.0:
        return camera
    drop_m = LARGE_TEXT_DROP * large_text * 2.0 * camera.distance_m(camera.target) * tan(radians(camera.fov_deg / 2.0))
    (ex, ey, ez), (tx, ty, tz) = camera.eye, camera.target
    return replace(camera, eye=(ex, ey - drop_m, ez), target=(tx, ty - drop_m, tz))


def numbers_of(camera: Camera) -> Floats:
    """(7,) eye, target, field of view."""
    return np.array([*camera.eye, *camera.target, camera.fov_deg])


def camera_of(numbers: Floats) -> Camera:
    """The camera of (7,) numbers."""
    a, b, c, d, e, f, fov_deg = (float(v) for v in numbers)
    return Camera((a, b, c), (d, e, f), fov_deg)


@dataclass(frozen=True, eq=False)
class Glide:
    """A way from one framing to the next. begins_s: world time; length_s: 0 stands still; path: (6, 7) coefficients
    of powers 0 to 5 of the share of the way that is done."""

    goal: Camera
    begins_s: float
    length_s: float
    path: Floats = field(default_factory=lambda: np.zeros((6, 7)))

    def at(self, time_s: float) -> Camera:
        """Where the camera is."""
        share = (time_s - self.begins_s) / self.length_s if self.length_s > 0 else 1.0
        if share >= 1.0 - 1e-9:
            return self.goal
        return camera_of(np.power(max(share, 0.0), np.arange(6)) @ self.path)

    def arrived(self, time_s: float) -> bool:
        """Whether the camera rests."""
        return time_s >= self.begins_s + self.length_s

    def toward(self, goal: Camera, time_s: float, length_s: float, *, after_s: float = 0.0) -> Glide:
        """From here to another framing in ``length_s``; ``after_s`` holds a resting camera for that long first."""
        if length_s <= 0.0:
            return stand(goal, time_s)
        place, speed, push = self._motion(time_s)
        speed, push = speed * length_s, push * length_s**2
        way = numbers_of(goal) - place
        path = np.stack(
            [
                place,
                speed,
                push / 2.0,
                10.0 * way - 6.0 * speed - 1.5 * push,
                -15.0 * way + 8.0 * speed + 1.5 * push,
                6.0 * way - 3.0 * speed - 0.5 * push,
            ]
        )
        return Glide(goal, time_s + after_s, length_s, path)

    def _motion(self, time_s: float) -> tuple[Floats, Floats, Floats]:
        """Place, speed and acceleration of the seven numbers, per second."""
        if self.arrived(time_s) or time_s <= self.begins_s:
            return numbers_of(self.at(time_s)), np.zeros(7), np.zeros(7)
        share, power = (time_s - self.begins_s) / self.length_s, np.arange(6)
        values = np.power(share, power)
        first = power[1:] * values[:-1] @ self.path[1:]
        second = (power * (power - 1))[2:] * values[:-2] @ self.path[2:]
        return values @ self.path, first / self.length_s, second / self.length_s**2


def stand(camera: Camera, time_s: float = 0.0) -> Glide:
    """A camera at rest."""
    return Glide(camera, time_s, 0.0)
