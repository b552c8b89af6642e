"""Time: eases, springs, delays and noise, for whole tracks at once (frames lead, channels follow)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import expm

from game.core import quaternion as quat

__all__ = [
    "DT_S",
    "Ease",
    "band_noise",
    "blend_scalar",
    "delay",
    "ease",
    "minimum_jerk",
    "smooth_window",
    "spring",
    "spring_rotation",
]

Floats = NDArray[np.floating[Any]]
DT_S = 1.0 / 30.0
"""Takes are performed and stored at 30 frames per second."""


@dataclass(frozen=True)
class Ease:
    """How one move gets from where it is to its target.

    skew: below 1 a sudden start and a soft landing, above 1 a wind-up and a strike; sharp: compresses the middle;
    anticipation: how far it first goes the other way, as a share of the way.
    """

    skew: float = 1.0
    sharp: float = 0.0
    anticipation: float = 0.0

    def but(self, skew: float | None = None, anticipation: float | None = None) -> Ease:
        """The same ease with another skew or anticipation."""
        return replace(
            self,
            skew=self.skew if skew is None else skew,
            anticipation=self.anticipation if anticipation is None else anticipation,
        )


def minimum_jerk(u: ArrayLike) -> Floats:
    """10u³ − 15u⁴ + 6u⁵ on [0, 1], clamped outside (Flash & Hogan 1985)."""
    v = np.clip(np.asarray(u, dtype=np.float64), 0.0, 1.0)
    return np.asarray(v**3 * (10.0 - 15.0 * v + 6.0 * v * v))


def ease(u: ArrayLike, how: Ease) -> Floats:
    """Share of the way at time u of the move: 0 at u <= 0, 1 at u >= 1; below 0 while it anticipates."""
    v = np.clip(np.asarray(u, dtype=np.float64), 0.0, 1.0)
    dip: Floats = np.zeros_like(v)
    if how.anticipation > 0.0:
        wind_up = 0.34
        dip = -how.anticipation * np.sin(np.pi * np.clip(v / wind_up, 0.0, 1.0)) ** 2
        v = np.clip((v - 0.5 * wind_up) / (1.0 - 0.5 * wind_up), 0.0, 1.0)
    return minimum_jerk((v**how.skew - 0.5) * (1.0 + how.sharp) + 0.5) + dip


def smooth_window(time_s: Floats, start_s: float, end_s: float, fade_s: float) -> Floats:
    """1 between start and end, smoothly 0 outside, fading over fade_s inside the interval."""
    u = np.clip(np.minimum(time_s - start_s, end_s - time_s) / max(fade_s, 1e-6), 0.0, 1.0)
    return np.asarray(u * u * (3.0 - 2.0 * u))


def blend_scalar(track: Floats, time_s: Floats, start_s: float, duration_s: float, target: float, how: Ease) -> None:
    """Lead a track (F,) in place from wherever it goes to the target: the older move keeps running underneath."""
    on = time_s >= start_s
    w = ease((time_s[on] - start_s) / max(duration_s, DT_S), how)
    track[on] += (target - track[on]) * w


def _free_motion(k1: Floats, k2: Floats) -> Floats:
    """(n, 2, 2): d/dt of (y, y') where y + k1 y' + k2 y'' = 0; k1, k2 (n,)."""
    a = np.zeros((len(k1), 2, 2))
    a[:, 0, 1] = 1.0
    a[:, 1, 0] = -1.0 / k2
    a[:, 1, 1] = -k1 / k2
    return a


def spring(x: Floats, frequency_hz: ArrayLike, damping: ArrayLike, response: ArrayLike = 0.0) -> Floats:
    """y + k1 y' + k2 y'' = x + k3 x' with k1 = z/πf, k2 = 1/(2πf)², k3 = rz/2πf, starting at rest in x[0].

    x: (F, C) at 30 fps. frequency_hz, damping, response: scalar, (C,) or (F, C); they may change over time.
    Exact for inputs that are straight lines between frames (first-order hold), so it never blows up.
    """
    frames, channels = x.shape
    f, z, r = (
        np.broadcast_to(np.asarray(v, dtype=np.float64), (frames, channels)) for v in (frequency_hz, damping, response)
    )
    k1, k2, k3 = z / (np.pi * f), 1.0 / (2.0 * np.pi * f) ** 2, r * z / (2.0 * np.pi * f)
    flat = np.stack([k1.ravel(), k2.ravel()], -1)
    kinds, which = np.unique(flat, axis=0, return_inverse=True)
    a = _free_motion(kinds[:, 0], kinds[:, 1])
    b = np.stack([np.zeros(len(kinds)), 1.0 / kinds[:, 1]], -1)[..., None]
    phi = expm(a * DT_S)
    hold = np.linalg.solve(a, (phi - np.eye(2)) @ b)
    ramp = np.linalg.solve(a, hold - b * DT_S)
    which = which.reshape(frames, channels)
    phi_t, hold_t, ramp_t = phi[which], hold[which][..., 0], ramp[which][..., 0]
    slope = np.diff(x, axis=0) / DT_S
    forced = hold_t[1:] * (x[:-1] + k3[1:] * slope)[..., None] + ramp_t[1:] * slope[..., None]
    p00, p01, p10, p11 = (np.ascontiguousarray(phi_t[:, :, i, j]) for i in (0, 1) for j in (0, 1))
    out = np.empty_like(x)
    y, v = x[0].copy(), np.zeros(channels)
    out[0] = y
    for i in range(1, frames):
        y, v = p00[i] * y + p01[i] * v + forced[i - 1, :, 0], p10[i] * y + p11[i] * v + forced[i - 1, :, 1]
        out[i] = y
    return out


def spring_rotation(q: Floats, frequency_hz: Floats, damping: Floats) -> Floats:
    """A hand's rotation drawn to a moving one by a spring on the sphere, so that large turns keep an even speed.

    q: (F, 4) unit quaternions; frequency_hz, damping: (F,). -> (F, 4). Springing the four numbers instead would cut
    across the sphere and snap round in the middle of a half turn.
    """
    kinds, which = np.unique(np.stack([frequency_hz, damping], -1), axis=0, return_inverse=True)
    k1 = kinds[:, 1] / (np.pi * kinds[:, 0])
    k2 = 1.0 / (2.0 * np.pi * kinds[:, 0]) ** 2
    step = expm(_free_motion(k1, k2) * DT_S)[which.ravel()]
    out = np.empty_like(q)
    out[0] = at = q[0]
    speed = np.zeros(3)
    last = quat.IDENTITY
    for i in range(1, len(q)):
        away = quat.multiply(at, quat.conjugate(q[i]))
        if away @ last < 0.0:
            away = -away
        last = away
        length = float(np.sqrt(away[:3] @ away[:3]))
        vector = away[:3] * (2.0 * np.arctan2(length, away[3]) / length if length > 1e-9 else 2.0)
        vector, speed = (
            step[i, 0, 0] * vector + step[i, 0, 1] * speed,
            step[i, 1, 0] * vector + step[i, 1, 1] * speed,
        )
        at = quat.multiply(quat.exp(vector), q[i])
        out[i] = at
    return out


def delay(x: Floats, seconds: float) -> Floats:
    """x (F, ...) later by any number of seconds; the first value is held."""
    at = np.clip(np.arange(len(x)) - seconds / DT_S, 0, len(x) - 1)
    low = np.floor(at).astype(np.intp)
    high = np.minimum(low + 1, len(x) - 1)
    w = (at - low).reshape((-1,) + (1,) * (x.ndim - 1))
    return np.asarray(x[low] * (1.0 - w) + x[high] * w)


def band_noise(frames: int, channels: int, low_hz: float, high_hz: float, rng: np.random.Generator) -> Floats:
    """(F, C) sums of seven sines at random frequencies in a band, about unit variance."""
    t = np.arange(frames) * DT_S
    f = low_hz * (high_hz / low_hz) ** rng.random((channels, 7))
    phase = rng.random((channels, 7))
    return np.asarray(np.sin(2 * np.pi * (t[:, None, None] * f + phase)).sum(-1) / np.sqrt(3.5))
