"""Ways through the market: who walks past when, where they stop to browse, as functions of the time alone.

A passer-by's time is cut into laps. In each lap they come in at one side, walk along their lane, stop at a stall for a
while, and leave at the other side (or the one they came from); speeds ramp, nothing jumps. Draws are keyed by seed,
person and lap, so a moment looks the same however one gets there.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["CADENCE_HZ", "Place", "Strolls"]

Floats = NDArray[np.floating[Any]]

CADENCE_HZ = 0.98
"""Cycles (two steps) a second."""
LAP_S = 37.0
OUT_X_M = 5.2
"""Where people come in and leave: outside the picture of every shot, at the farthest lane."""
LANES_M = (-4.7, -5.6, -6.6, -5.1, -6.1, -7.2, -5.4, -6.9)
RAMP_S, TURN_S = 0.7, 0.8


@dataclass(frozen=True)
class Place:
    """Where a passer-by is. x, z: metres; yaw_rad: 0 faces the player; speed: m/s; walking: 0 stands, 1 walks."""

    x: float
    z: float
    yaw_rad: float
    speed: float
    walking: float


@dataclass(frozen=True)
class _Lap:
    speed: float
    side: float  # comes in at −1 left, 1 right
    through: bool  # leaves at the other side
    stop_x: float
    stop_s: float
    facing_rad: float
    start_s: float


@dataclass
class Strolls:
    """The ways of ``count`` people. Laps are remembered while they last."""

    count: int
    seed: int
    _laps: dict[tuple[int, int], _Lap] = field(default_factory=dict)

    def place(self, who: int, time_s: float) -> Place:
        """Where a person is at a time ≥ 0."""
        # Everybody is somewhere in a lap at zero: the market is not empty when one arrives.
        own_s = time_s + LAP_S * ((0.35 + 0.382 * who) % 1.0)
        number = int(own_s // LAP_S)
        lap = self._lap(who, number)
        now_s = own_s - number * LAP_S - lap.start_s
        z = LANES_M[who % len(LANES_M)]
        enter = lap.side * OUT_X_M
        way_in = abs(lap.stop_x - enter)
        walk_in_s = way_in / lap.speed + 0.5 * RAMP_S
        heading = -lap.side * 0.5 * np.pi
        leaving = heading if lap.through else -heading
        leave_to = -enter if lap.through else enter
        if now_s < walk_in_s:
            left_s = walk_in_s - now_s
            gone, speed = way_in - _ramp_m(left_s, lap.speed), _ramp_speed(left_s, lap.speed)
            yaw = _between(heading, lap.facing_rad, _smooth((TURN_S - left_s) / TURN_S) * 0.5)
            return Place(enter - lap.side * max(gone, 0.0), z, yaw, speed if gone > 0 else 0.0, speed / lap.speed)
        stood_s = now_s - walk_in_s
        if stood_s < lap.stop_s:
            first = _between(heading, lap.facing_rad, 0.5 + 0.5 * _smooth(stood_s / TURN_S))
            yaw = _between(first, leaving, 0.5 * _smooth((stood_s - lap.stop_s + TURN_S) / TURN_S))
            return Place(lap.stop_x, z, yaw, 0.0, 0.0)
        since_s = stood_s - lap.stop_s
        out = 1.0 if leave_to > lap.stop_x else -1.0
        yaw = _between(_between(lap.facing_rad, leaving, 0.5), leaving, _smooth(since_s / TURN_S))
        speed = _ramp_speed(since_s, lap.speed)
        return Place(lap.stop_x + out * _ramp_m(since_s, lap.speed), z, yaw, speed, speed / lap.speed)

    def _lap(self, who: int, number: int) -> _Lap:
        if (who, number) not in self._laps:
            self._laps = {key: lap for key, lap in self._laps.items() if abs(key[1] - number) < 2}
            draw = np.random.default_rng([self.seed, who, number]).random(8)
            speed = 0.66 + 0.26 * float(draw[0])
            # To a stall on the far side of the lane, or to its left or right; now and then to this one.
            facing = np.pi + (float(draw[3]) - 0.5) * 1.6 if draw[4] < 0.8 else (float(draw[3]) - 0.5) * 0.8
            self._laps[who, number] = _Lap(
                speed=speed,
                side=1.0 if draw[1] < 0.5 else -1.0,
                through=bool(draw[2] < 0.75),
                stop_x=(float(draw[5]) - 0.5) * 5.2,
                stop_s=4.0 + 5.0 * float(draw[6]),
                facing_rad=float(facing),
                start_s=2.0 * float(draw[7]),
            )
        return self._laps[who, number]


def _smooth(u: float) -> float:
    u = min(max(u, 0.0), 1.0)
    return u * u * (3.0 - 2.0 * u)


def _ramp_speed(t_s: float, speed: float) -> float:
    return speed * _smooth(t_s / RAMP_S)


def _ramp_m(t_s: float, speed: float) -> float:
    """The integral of _ramp_speed: how far one gets in t_s from a stand."""
    u = min(max(t_s / RAMP_S, 0.0), 1.0)
    return speed * (RAMP_S * (u**3 - 0.5 * u**4) + max(t_s - RAMP_S, 0.0))


def _between(a: float, b: float, share: float) -> float:
    """Of two directions, the shorter way round."""
    return float(a + share * ((b - a + np.pi) % (2.0 * np.pi) - np.pi))
