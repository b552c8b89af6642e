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
        """(7, 8) how fast Life.timers run in each emotion; breath and sway that are added, and the tempo."""
        still = np.ones(7)
        per_second = (self.sway_pace, self.breath_per_min / 60.0, -still, -still, still)
        amounts = (self.breath_depth * self.breath_share, self.sway * self.sway_share, self.tempo)
        return np.stack([*per_second, *amounts], axis=1)

    @cached_property
    def eye_scale(self) -> Floats:
        """(2,) look per radian."""
        return np.array([1.0 / self.eye_yaw_rad, 1.0 / self.eye_pitch_rad])

    @cached_property
    def head_shares(self) -> Floats:
        """(3,) how much of the target's yaw and pitch the head takes, and of its yaw the torso."""
        return np.array([self.head_share, -self.head_share, self.torso_share])

    @cached_property
    def head_stiffness(self) -> Floats:
        """(3,) per second: half the damping of critical springs with the half-lives (game.core.springs)."""
        half_lives = np.array([self.head_half_life_s, self.head_half_life_s, self.torso_half_life_s])
        return np.asarray(half_life_to_damping(half_lives) / 2.0)


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
_SWAY_RATE = 2.0 * np.pi * _SWAY_HZ
# In for 42 % of the cycle, out a little slower, then a pause: as the takes breathe.
_BREATH_AT = np.linspace(0.0, 1.0, 65)
_BREATH = np.where(
    _BREATH_AT < 0.42,
    0.5 - 0.5 * np.cos(np.pi * _BREATH_AT / 0.42),
    0.5 + 0.5 * np.cos(np.pi * np.minimum((_BREATH_AT - 0.42) / 0.464, 1.0)),
)
_BLINK_AT = np.array([0.0, 0.3, 0.45, 1.0])
_BLINK_SHUT = np.array([0.0, 1.0, 1.0, 0.0])
_HEAD_CUES = np.array([0, 1, 0])
_CLOCK, _BREATHS, _DART_LEFT, _BLINK_LEFT, _BLINK_AGE = range(5)
_NOD_WAVE = 2 * _SWAYS.index("yaw") + 1
_SHIFT = 0.55
"""A jump of the eyes beyond this brings a blink with it."""
for _table in (_EFFECT, _SWAY_HZ, _SWAY_RATE, _BREATH_AT, _BREATH, _BLINK_AT, _BLINK_SHUT, _HEAD_CUES):
    _table.setflags(write=False)


@dataclass(frozen=True, eq=False)
class Life:
    """n characters. key: seeds of their draws; counts: (n, 2) darts and blinks drawn. phase: (n, 12) of the sways.
    timers: (n, 5) sway time, breaths, seconds to the next dart and blink, since the last blink. dart: (n, 2) of the
    eyes. head: (n, 2, 3) yaw and pitch added to the head, yaw added to the torso, radians, and their speeds. mood:
    (n, 2) attention (1 looks at the target, 0 where the unit's own gaze leads) and voice, both smoothed."""

    key: NDArray[np.uint64]
    counts: NDArray[np.int64]
    phase: Floats
    timers: Floats
    dart: Floats
    head: Floats
    mood: Floats


@dataclass(frozen=True, eq=False)
class Gaze:
    """eye: (n, 2) in [-1, 1]; aim: (n, 2) yaw and pitch of the target in model space, radians; leap: (n,) True where
    the eyes have just been sent far."""

    eye: Floats
    aim: Floats
    leap: NDArray[np.bool_]


def start_life(n: int, seed: int, first: int = 0) -> Life:
    """Characters first, first + 1, … of a seed."""
    key = character_keys(seed ^ 0x11FE, first, n)
    zero = np.zeros(n, dtype=np.int64)
    draw = np.concatenate([uniform(key, zero + stream, zero, 8) for stream in (2, 3)], axis=1)
    timers = np.zeros((n, 5))
    timers[:, _BREATHS], timers[:, _DART_LEFT] = draw[:, -1], draw[:, -2]
    timers[:, _BLINK_LEFT], timers[:, _BLINK_AGE] = 0.5 + 4.0 * draw[:, -3], 10.0
    return Life(
        key=key,
        counts=np.zeros((n, 2), dtype=np.int64),
        phase=2.0 * np.pi * draw[:, : len(_SWAY_HZ)],
        timers=timers,
        dart=np.zeros((n, 2)),
        head=np.zeros((n, 2, 3)),
        mood=np.tile([1.0, 0.0], (n, 1)),
    )


def start_gaze(n: int) -> Gaze:
    """Straight ahead."""
    return Gaze(np.zeros((n, 2)), np.zeros((n, 2)), np.zeros(n, dtype=bool))


def advance_life(
    config: LifeConfig, state: Life, gaze: Gaze, shares: Floats, mood: Floats, dt_s: float
) -> tuple[Life, Floats, Floats, Floats]:
    """shares: (n, 7) emotion, summing to 1; mood: (n, 2) whether the target is looked at and whether one speaks, 0..1.

    -> state; (n, CHANNELS) what is added to the row; lungs (n,) 0..1; blink (n,) 0..1.
    """
    rates = shares @ config.rates
    timers = state.timers + rates[:, :5] * dt_s
    dart, counts = state.dart, state.counts
    if np.count_nonzero(gaze.leap):
        timers[:, _BLINK_LEFT] = np.where(gaze.leap, np.minimum(timers[:, _BLINK_LEFT], 0.0), timers[:, _BLINK_LEFT])
    if np.minimum.reduce(timers[:, _DART_LEFT : _BLINK_LEFT + 1], axis=None) <= 0.0:
        dart, counts = _draw(config, state, shares, timers)
    depth, sway, tempo = rates[:, 5], rates[:, 6:7], rates[:, 7:]
    mood = state.mood + (mood - state.mood) * (1.0 - 2.0 ** (-dt_s / config.mood_half_life_s))
    wanted = gaze.aim.take(_HEAD_CUES, axis=1) * (config.head_shares * mood[:, :1])
    # A critically damped spring, exact in dt (game.core.springs), at the emotion's tempo.
    stiffness = config.head_stiffness / tempo
    speed = state.head[:, 1]
    away = state.head[:, 0] - wanted
    push = (speed + away * stiffness) * dt_s
    decay = np.exp(stiffness * -dt_s)
    head = np.empty_like(state.head)
    np.add(wanted, decay * (away + push), out=head[:, 0])
    np.multiply(decay, speed - push * stiffness, out=head[:, 1])
    waves = np.sin(timers[:, :1] * _SWAY_RATE + state.phase)
    lungs = np.interp(timers[:, _BREATHS] % 1.0, _BREATH_AT, _BREATH)
    cues = np.empty((len(timers), len(_CUES)), dtype=np.float32)
    cues[:, 0] = lungs * depth
    cues[:, 1:13] = waves * sway
    cues[:, 13:16] = head[:, 0]
    cues[:, 16] = mood[:, 1] * waves[:, _NOD_WAVE] * config.nod_rad
    blink = np.interp(timers[:, _BLINK_AGE] / config.blink_s, _BLINK_AT, _BLINK_SHUT)
    return Life(state.key, counts, state.phase, timers, dart, head, mood), cues @ _EFFECT, lungs, blink


def look(
    config: LifeConfig, life: Life, gaze: Gaze, target: Floats, head: Floats, chest: Floats, eyes: Floats, dt_s: float
) -> Gaze:
    """Eyes to the target (n, 3) as far as they go. head, chest: (n, 4, 4) matrices; eyes: (4,) in the head's frame,
    homogeneous."""
    way = np.empty((len(target), 2, 3))
    np.subtract(target, (head @ eyes)[:, :3], out=way[:, 0])
    np.matmul(way[:, :1], head[:, :3, :3], out=way[:, 1:])
    right, ahead = way[..., 0], way[..., 2]
    angle = np.empty((len(target), 2, 2))
    np.arctan2(right, ahead, out=angle[..., 0])
    np.arctan2(way[..., 1], np.hypot(right, ahead), out=angle[..., 1])
    attention = life.mood[:, :1]
    wanted = angle[:, 1] * (config.eye_scale * attention)
    wanted += life.dart
    if np.minimum.reduce(attention, axis=None) < 0.999:
        # Where a unit's own gaze leads, the eyes go a little further the way the head has turned.
        lead = (chest[:, :3, :3].swapaxes(-1, -2) @ head[:, :3, 2, None])[..., 0]
        wanted[:, 0] += (1.0 - attention[:, 0]) * np.arctan2(lead[:, 0], lead[:, 2]) * (0.5 * config.eye_scale[0])
    step = np.minimum(np.maximum(wanted, -1.0), 1.0) - gaze.eye
    eye = gaze.eye + step * (1.0 - 2.0 ** (-dt_s / config.eye_half_life_s))
    return Gaze(eye, angle[:, 0], np.maximum.reduce(np.abs(step), axis=1) > _SHIFT)


def _draw(config: LifeConfig, state: Life, shares: Floats, timers: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """New eye darts and blinks for those whose time has come; sets their timers, returns darts and counts."""
    dart, counts = state.dart.copy(), state.counts.copy()
    due = np.flatnonzero(timers[:, _DART_LEFT] <= 0.0)
    if due.size:
        draws = uniform(state.key[due], np.zeros(due.size, dtype=np.intp), counts[due, 0], 4).T
        # Every third dart returns to the target itself, so the gaze does not wander off.
        size = np.where(draws[3] < 0.33, 0.0, 2.0 * (shares[due] @ config.dart_size))
        dart[due, 0] = (draws[0] - 0.5) * 2.0 * size
        dart[due, 1] = (draws[1] - 0.5) * size
        timers[due, _DART_LEFT] = (0.35 + 1.3 * draws[2]) / (shares[due] @ config.darts_per_s)
        counts[due, 0] += 1
    due = np.flatnonzero(timers[:, _BLINK_LEFT] <= 0.0)
    if due.size:
        first, second = uniform(state.key[due], np.ones(due.size, dtype=np.intp), counts[due, 1], 2).T
        wait = (0.3 + 1.4 * first) * 60.0 / (shares[due] @ config.blinks_per_min)
        # One blink in eight comes double.
        timers[due, _BLINK_LEFT] = np.where(second < 0.125, 0.3, wait)
        timers[due, _BLINK_AGE] = 0.0
        counts[due, 1] += 1
    return dart, counts
