"""Holding a thing in the hand: turned by dragging with inertia, by keys, zoomed by the wheel. No drawing here."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp

__all__ = ["Handling"]

RAD_PER_PX = 0.011
"""A drag across half the picture turns it about once round."""
KEY_RAD = 0.35
PITCH_RAD = (-0.55, 1.25)
"""It may be tipped a little back, and forward until one looks down on it."""
ZOOM = (0.7, 2.2)
ZOOM_STEP = 1.12
FRICTION_PER_S = 3.2
"""A thrown turn loses all but a twentieth of its speed within a second."""
STILL_RAD_S = 0.02
_CLICK_PX = 5.0


@dataclass
class Handling:
    """yaw_rad, pitch_rad, zoom as ItemView has them; velocities in rad/s. Places are reference pixels."""

    yaw_rad: float = 0.45
    pitch_rad: float = 0.24
    zoom: float = 1.0
    yaw_speed: float = 0.0
    pitch_speed: float = 0.0
    _held_at: tuple[float, float] | None = None
    _moved_px: float = 0.0
    _since: tuple[float, float] = (0.0, 0.0)  # what was dragged since the last tick, rad

    @property
    def held(self) -> bool:
        """Whether the button is down."""
        return self._held_at is not None

    def grab(self, at: tuple[float, float]) -> None:
        """The button goes down."""
        self._held_at, self._moved_px, self._since = at, 0.0, (0.0, 0.0)
        self.yaw_speed = self.pitch_speed = 0.0

    def drag(self, at: tuple[float, float]) -> None:
        """The pointer moves; turns only while held."""
        if self._held_at is None:
            return
        dx, dy = at[0] - self._held_at[0], at[1] - self._held_at[1]
        self._held_at = at
        self._moved_px += abs(dx) + abs(dy)
        self._since = (self._since[0] + dx * RAD_PER_PX, self._since[1] + dy * RAD_PER_PX)
        self._turn(dx * RAD_PER_PX, dy * RAD_PER_PX)

    def let_go(self) -> bool:
        """The button goes up; True where it was a click in place, not a drag."""
        clicked = self._held_at is not None and self._moved_px < _CLICK_PX
        self._held_at = None
        return clicked

    def nudge(self, yaw: float, pitch: float) -> None:
        """Turn by keys, in steps."""
        self.yaw_speed = self.pitch_speed = 0.0
        self._turn(yaw * KEY_RAD, pitch * KEY_RAD)

    def zoom_by(self, notches: int) -> None:
        """Nearer with positive notches of the wheel."""
        self.zoom = min(max(self.zoom * ZOOM_STEP**notches, ZOOM[0]), ZOOM[1])

    def tick(self, dt_s: float, *, reduced_motion: bool = False) -> None:
        """One step of time: a thrown turn goes on and dies away; with reduced motion it stops with the hand."""
        if self.held:
            # A slow average, so that the last jerk of the hand does not decide.
            self.yaw_speed = 0.5 * self.yaw_speed + 0.5 * self._since[0] / dt_s
            self.pitch_speed = 0.5 * self.pitch_speed + 0.5 * self._since[1] / dt_s
            self._since = (0.0, 0.0)
            return
        if reduced_motion or abs(self.yaw_speed) + abs(self.pitch_speed) < STILL_RAD_S:
            self.yaw_speed = self.pitch_speed = 0.0
            return
        self._turn(self.yaw_speed * dt_s, self.pitch_speed * dt_s)
        left = exp(-FRICTION_PER_S * dt_s)
        self.yaw_speed, self.pitch_speed = self.yaw_speed * left, self.pitch_speed * left

    def ahead(self, seconds: float, *, reduced_motion: bool = False) -> tuple[float, float]:
        """(yaw, pitch) a moment after the last tick, for the frames between."""
        if self.held or reduced_motion:
            return self.yaw_rad, self.pitch_rad
        pitch = self.pitch_rad + self.pitch_speed * seconds
        return self.yaw_rad + self.yaw_speed * seconds, min(max(pitch, PITCH_RAD[0]), PITCH_RAD[1])

    def _turn(self, yaw: float, pitch: float) -> None:
        self.yaw_rad += yaw
        self.pitch_rad = min(max(self.pitch_rad + pitch, PITCH_RAD[0]), PITCH_RAD[1])
