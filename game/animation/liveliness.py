"""What never stops: breath, sway, blinking, and a gaze that leads the head, which leads the body.

Everything is a function of seeded draws and of clocks that run at the emotion's own pace, so a character is the
same alone and in a crowd, at 30 or at 60 ticks a second.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import channels as ch
from game.animation.arithmetic import Curve, Number, arithmetic, columns, numbers
from game.core.humanoid import REFERENCE
from game.core.springs import half_life_to_damping
from game.embos.draws import character_keys, uniform

__all__ = [
    "GAZE_AWAY",
    "GAZE_CUSTOMER",
    "GAZE_GOODS",
    "Gaze",
    "Life",
    "LifeConfig",
    "advance_life",
    "look",
    "start_gaze",
    "start_life",
]

Floats = NDArray[np.floating[Any]]

GAZE_CUSTOMER = np.array([0.0, 1.16, 3.0])
GAZE_GOODS = np.array([-0.18, 0.62, 0.45])
GAZE_AWAY = np.array([-1.6, 0.95, 1.2])
"""Points to look at, model space, metres: the customer's eyes, the goods on the table, past the customer."""
for _point in (GAZE_CUSTOMER, GAZE_GOODS, GAZE_AWAY):
    _point.setflags(write=False)


def _seven(*values: float) -> Floats:
    array = np.array(values)
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class LifeConfig:
    """Constants per emotion (anger fear joy sadness disgust surprise neutral), mixed by what is felt.

    Breath after MOTION.md; takes breathe and sway themselves, so only breath_share and sway_share of it is added.
    """

    breath_per_min: Floats = field(default_factory=lambda: _seven(26, 38, 22, 10, 15, 17, 15))
    breath_depth: Floats = field(default_factory=lambda: _seven(1.25, 0.75, 1.1, 0.9, 0.7, 1.0, 0.6))
    sway: Floats = field(default_factory=lambda: _seven(0.5, 0.7, 1.0, 0.55, 0.5, 0.5, 1.5))
    sway_pace: Floats = field(default_factory=lambda: _seven(1.4, 2.6, 1.6, 0.5, 1.0, 1.2, 1.0))
    blinks_per_min: Floats = field(default_factory=lambda: _seven(9, 34, 20, 12, 22, 5, 16))
    darts_per_s: Floats = field(default_factory=lambda: _seven(0.9, 2.4, 1.2, 0.4, 0.8, 0.5, 0.8))
    dart_size: Floats = field(default_factory=lambda: _seven(0.04, 0.16, 0.08, 0.04, 0.07, 0.03, 0.06))
    tempo: Floats = field(default_factory=lambda: _seven(0.8, 0.75, 0.85, 1.7, 1.25, 0.8, 1.0))
    arc: Floats = field(default_factory=lambda: _seven(0.06, 0.03, 0.3, -0.05, 0.1, 0.12, 0.12))
    transition_s: float = 0.42
    breath_share: float = 0.3
    sway_share: float = 0.35
    head_share: float = 0.45
    torso_share: float = 0.12
    eye_half_life_s: float = 0.018
    head_half_life_s: float = 0.17
    torso_half_life_s: float = 0.38
    eye_yaw_rad: float = 0.61
    eye_pitch_rad: float = 0.42
    blink_s: float = 0.2
    nod_rad: float = 0.022
    mood_half_life_s: float = 0.14

    @cached_property
    def rates(self) -> Floats:
        """(7, 6) pace of the sway, breaths per second, pace of the other timers, how much of breath and of sway is
        added, and the tempo."""
        breath, sway = self.breath_depth * self.breath_share, self.sway * self.sway_share
        return np.stack([self.sway_pace, self.breath_per_min / 60.0, np.ones(7), breath, sway, self.tempo], axis=1)

    @cached_property
    def stiffness(self) -> tuple[float, float]:
        """Per second, of head and torso: half the damping of critical springs with the half-lives
        (game.core.springs)."""
        head, torso = (half_life_to_damping(h) / 2.0 for h in (self.head_half_life_s, self.torso_half_life_s))
        return float(head), float(torso)


_SWAYS = ("right", "forward", "twist", "side", "yaw", "roll")
_CUES = ("breath", *(f"{name}{k}" for name in _SWAYS for k in (0, 1)), "gaze_yaw", "gaze_pitch", "torso_yaw", "nod")
"""What moves the torso and head: sways are two sines each."""
_SWAY_HZ = np.array([0.11, 0.27, 0.13, 0.31, 0.17, 0.23, 0.09, 0.29, 0.15, 0.37, 0.12, 0.33])
_SWAY_WEIGHT = (0.8, 0.6)
_EFFECT_DEG: dict[str, dict[str, tuple[float, float, float]]] = {
    "breath": {
        "spine": (-1.1, 0, 0),
        "chest": (-2.1, 0, 0),
        "neck": (0.8, 0, 0),
        "head": (1.2, 0, 0),
        "leftShoulder": (0, 0, 4.5),
        "rightShoulder": (0, 0, -4.5),
    },
    "twist": {"hips": (0, 0.3, 0), "spine": (0, 0.42, 0), "chest": (0, 0.48, 0)},
    "side": {"hips": (0, 0, 0.15), "spine": (0, 0, 0.45), "chest": (0, 0, 0.4)},
    "yaw": {"neck": (0, 0.9, 0), "head": (0, 1.3, 0)},
    "roll": {"neck": (0, 0, 0.6), "head": (0, 0, 1.0)},
}
"""Degrees of a full breath and of a sway of 1."""
_EFFECT_RAD: dict[str, dict[str, tuple[float, float, float]]] = {
    "gaze_yaw": {"neck": (0, 0.42, 0), "head": (0, 0.58, 0)},
    "gaze_pitch": {"neck": (0.42, 0, 0), "head": (0.58, 0, 0)},
    "torso_yaw": {"spine": (0, 0.45, 0), "chest": (0, 0.55, 0)},
    "nod": {"neck": (0.4, 0, 0), "head": (0.6, 0, 0)},
}
_EFFECT_M = {"right": (0.006, 0, 0), "forward": (0, 0, 0.004)}


def _effect_table() -> Floats:
    """(cues, CHANNELS): cue -> half angles of the joints (vector parts of their quaternions) and the root's shift."""
    table = np.zeros((len(_CUES), ch.CHANNELS), dtype=np.float32)
    for row, cue in enumerate(_CUES):
        name, weight = (cue[:-1], _SWAY_WEIGHT[int(cue[-1])]) if cue[-1].isdigit() else (cue, 1.0)
        for effects, scale in ((_EFFECT_DEG, np.pi / 360.0), (_EFFECT_RAD, 0.5)):
            for joint, angles in effects.get(name, {}).items():
                at = ch.ROTATION.start + 4 * REFERENCE.index[joint]
                table[row, at : at + 3] = np.multiply(angles, scale * weight)
        table[row, ch.ROOT] = np.multiply(_EFFECT_M.get(name, (0.0, 0.0, 0.0)), weight)
    return table


_EFFECT = _effect_table()
_SWAY_RATE = tuple((2.0 * np.pi * _SWAY_HZ).tolist())
# In for 42 % of the cycle, out a little slower, then a pause: as the takes breathe.
_BREATH_AT = np.linspace(0.0, 1.0, 65)
_BREATH = Curve(
    _BREATH_AT,
    np.where(
        _BREATH_AT < 0.42,
        0.5 - 0.5 * np.cos(np.pi * _BREATH_AT / 0.42),
        0.5 + 0.5 * np.cos(np.pi * np.minimum((_BREATH_AT - 0.42) / 0.464, 1.0)),
    ),
)
_BLINK = Curve(np.array([0.0, 0.3, 0.45, 1.0]), np.array([0.0, 1.0, 1.0, 0.0]))
_NOD_WAVE = 2 * _SWAYS.index("yaw") + 1
_SHIFT = 0.55
"""A jump of the eyes beyond this brings a blink with it."""
for _table in (_EFFECT, _SWAY_HZ, _BREATH_AT):
    _table.setflags(write=False)

# Columns of Life.now.
_CLOCK, _BREATHS, _DART_LEFT, _BLINK_LEFT, _BLINK_AGE, _DART = range(6)
_HEAD, _MOOD, _LUNGS, _LIDS = 7, 13, 15, 16


@dataclass(frozen=True, eq=False)
class Life:
    """n characters. key: seeds of their draws; counts: (n, 2) darts and blinks drawn. phase: (n, 12) of the sways.
    now: (n, 17) sway time, breaths, seconds to the next dart and blink, since the last blink; dart of the eyes (2); yaw
    and pitch added to the head, yaw added to the torso, radians, and their speeds; attention (1 looks at the target, 0
    where the unit's own gaze leads) and voice, both smoothed; lungs and lids as in Pose."""

    key: NDArray[np.uint64]
    counts: NDArray[np.int64]
    phase: Floats
    now: Floats

    @property
    def head(self) -> Floats:
        """(n, 2, 3) yaw and pitch added to the head, yaw added to the torso, radians, and their speeds."""
        return self.now[:, _HEAD:_MOOD].reshape(-1, 2, 3)

    @property
    def lungs(self) -> Floats:
        """(n,) as Pose.breath."""
        return self.now[:, _LUNGS]

    @property
    def lids(self) -> Floats:
        """(n,) as Pose.blink."""
        return self.now[:, _LIDS]


@dataclass(frozen=True, eq=False)
class Gaze:
    """now: (n, 5) the eyes in [-1, 1] (2), yaw and pitch of the target in model space, radians, and 1 where the eyes
    have just been sent far."""

    now: Floats

    @property
    def eye(self) -> Floats:
        """(n, 2) as Pose.gaze."""
        return self.now[:, :2]


def start_life(n: int, seed: int, first: int = 0) -> Life:
    """Characters first, first + 1, … of a seed."""
    key = character_keys(seed ^ 0x11FE, first, n)
    zero = np.zeros(n, dtype=np.int64)
    draw = np.concatenate([uniform(key, zero + stream, zero, 8) for stream in (2, 3)], axis=1)
    now = np.zeros((n, 17))
    now[:, _BREATHS], now[:, _DART_LEFT] = draw[:, -1], draw[:, -2]
    now[:, _BLINK_LEFT], now[:, _BLINK_AGE] = 0.5 + 4.0 * draw[:, -3], 10.0
    now[:, _MOOD] = 1.0
    return Life(key, np.zeros((n, 2), dtype=np.int64), 2.0 * np.pi * draw[:, : len(_SWAY_HZ)], now)


def start_gaze(n: int) -> Gaze:
    """Straight ahead."""
    return Gaze(np.zeros((n, 5)))


def advance_life(
    config: LifeConfig, state: Life, gaze: Gaze, shares: Floats, attention: Floats, speaking: Floats, dt_s: float
) -> tuple[Life, Floats]:
    """shares: (n, 7) emotion, summing to 1; attention, speaking: (n,) whether the target is looked at and whether one
    speaks, 0..1.

    -> state; (n, CHANNELS) what is added to the row.
    """
    n, counts = len(shares), state.counts
    do = arithmetic(n)
    pace, breath_hz, one, depth, sway, tempo = numbers(shares @ config.rates)
    _, _, aim_yaw, aim_pitch, leap = numbers(gaze.now)
    looks, voice_now = numbers(np.array([attention, speaking]).T)
    clock, breaths, dart_left, blink_left, blink_age, *more = numbers(state.now)
    right, up, yaw, pitch, torso, yaw_speed, pitch_speed, torso_speed, mood, voice, _, _ = more
    clock, breaths = clock + pace * dt_s, breaths + breath_hz * dt_s
    passed = one * dt_s
    dart_left, blink_left, blink_age = dart_left - passed, blink_left - passed, blink_age + passed
    if do.any(leap):
        blink_left = do.where(leap, do.least(blink_left, 0.0), blink_left)
    if do.any(do.least(dart_left, blink_left) <= 0.0):
        drawn = columns([dart_left, blink_left, blink_age, right, up], n)
        counts = _draw(config, state, shares, drawn)
        dart_left, blink_left, blink_age, right, up = numbers(drawn)
    gain = 1.0 - 2.0 ** (-dt_s / config.mood_half_life_s)
    mood, voice = mood + (looks - mood) * gain, voice + (voice_now - voice) * gain
    # At the emotion's tempo.
    head_stiffness, torso_stiffness = (s / tempo for s in config.stiffness)
    head_decay, torso_decay = do.exp(head_stiffness * -dt_s), do.exp(torso_stiffness * -dt_s)
    share, twist = config.head_share * mood, config.torso_share * mood
    yaw, yaw_speed = _spring(yaw, yaw_speed, aim_yaw * share, head_stiffness, head_decay, dt_s)
    pitch, pitch_speed = _spring(pitch, pitch_speed, aim_pitch * -share, head_stiffness, head_decay, dt_s)
    torso, torso_speed = _spring(torso, torso_speed, aim_yaw * twist, torso_stiffness, torso_decay, dt_s)
    sin = do.sin
    waves = [sin(clock * rate + phase) for rate, phase in zip(_SWAY_RATE, numbers(state.phase), strict=True)]
    lungs = do.curve(_BREATH, breaths % 1.0)
    lids = do.curve(_BLINK, blink_age / config.blink_s)
    nod = voice * waves[_NOD_WAVE] * config.nod_rad
    cues = [lungs * depth, *(wave * sway for wave in waves), yaw, pitch, torso, nod]
    now = [
        clock, breaths, dart_left, blink_left, blink_age, right, up,
        yaw, pitch, torso, yaw_speed, pitch_speed, torso_speed, mood, voice, lungs, lids,
    ]  # fmt: skip
    return Life(state.key, counts, state.phase, columns(now, n)), columns(cues, n, np.float32) @ _EFFECT


def _spring(
    value: Number, speed: Number, goal: Number, stiffness: Number, decay: Number, dt_s: float
) -> tuple[Number, Number]:
    """A critically damped spring, exact in dt (game.core.springs)."""
    away = value - goal
    push = (speed + away * stiffness) * dt_s
    return goal + decay * (away + push), decay * (speed - push * stiffness)


def look(
    config: LifeConfig, life: Life, gaze: Gaze, target: Floats, head: Floats, chest: Floats, eyes: Floats, dt_s: float
) -> Gaze:
    """Eyes to the target (n, 3) as far as they go. head, chest: (n, 4, 4) matrices; eyes: (3,) in the head's frame."""
    n = len(target)
    do = arithmetic(n)
    xx, yx, zx, tx, xy, yy, zy, ty, xz, yz, zz, tz, *_ = numbers(head.reshape(n, 16))
    x, y, z = numbers(target)
    ex, ey, ez = eyes.tolist()
    x, y, z = (
        x - (xx * ex + yx * ey + zx * ez + tx),
        y - (xy * ex + yy * ey + zy * ez + ty),
        z - (xz * ex + yz * ey + zz * ez + tz),
    )
    aim_yaw, aim_pitch = do.arctan2(x, z), do.arctan2(y, do.hypot(x, z))
    right, up, ahead = x * xx + y * xy + z * xz, x * yx + y * yy + z * yz, x * zx + y * zy + z * zz
    *_, dart_right, dart_up, _, _, _, _, _, _, attention, _, _, _ = numbers(life.now)
    eye_right, eye_up, _, _, _ = numbers(gaze.now)
    want_right = do.arctan2(right, ahead) * (attention / config.eye_yaw_rad) + dart_right
    want_up = do.arctan2(up, do.hypot(right, ahead)) * (attention / config.eye_pitch_rad) + dart_up
    if do.any(attention < 0.999):
        # Where a unit's own gaze leads, the eyes go a little further the way the head has turned.
        cx, _, cz, _, dx, _, dz, _, gx, _, gz, *_ = numbers(chest.reshape(n, 16))
        lead = do.arctan2(cx * zx + dx * zy + gx * zz, cz * zx + dz * zy + gz * zz)
        want_right = want_right + (1.0 - attention) * lead * (0.5 / config.eye_yaw_rad)
    right = do.least(do.most(want_right, -1.0), 1.0) - eye_right
    up = do.least(do.most(want_up, -1.0), 1.0) - eye_up
    gain = 1.0 - 2.0 ** (-dt_s / config.eye_half_life_s)
    leap = do.most(abs(right), abs(up)) > _SHIFT
    return Gaze(columns([eye_right + right * gain, eye_up + up * gain, aim_yaw, aim_pitch, leap], n))


def _draw(config: LifeConfig, state: Life, shares: Floats, drawn: Floats) -> NDArray[np.int64]:
    """New eye darts and blinks for those whose time has come. drawn: (n, 5) seconds to the next dart and blink, since
    the last blink, and the dart, written anew. -> counts."""
    counts = state.counts.copy()
    due = np.flatnonzero(drawn[:, 0] <= 0.0)
    if due.size:
        draws = uniform(state.key[due], np.zeros(due.size, dtype=np.intp), counts[due, 0], 4).T
        # Every third dart returns to the target itself, so the gaze does not wander off.
        size = np.where(draws[3] < 0.33, 0.0, 2.0 * (shares[due] @ config.dart_size))
        drawn[due, 3] = (draws[0] - 0.5) * 2.0 * size
        drawn[due, 4] = (draws[1] - 0.5) * size
        drawn[due, 0] = (0.35 + 1.3 * draws[2]) / (shares[due] @ config.darts_per_s)
        counts[due, 0] += 1
    due = np.flatnonzero(drawn[:, 1] <= 0.0)
    if due.size:
        first, second = uniform(state.key[due], np.ones(due.size, dtype=np.intp), counts[due, 1], 2).T
        wait = (0.3 + 1.4 * first) * 60.0 / (shares[due] @ config.blinks_per_min)
        # One blink in eight comes double.
        drawn[due, 1] = np.where(second < 0.125, 0.3, wait)
        drawn[due, 2] = 0.0
        counts[due, 1] += 1
    return counts
