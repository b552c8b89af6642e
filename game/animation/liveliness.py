"""What never stops: breath, sway, blinking, and a gaze that leads the head, which leads the body.

Everything is a function of seeded draws and of clocks that run at the emotion's own pace, so a character is the
same alone and in a crowd, at 30 or at 60 ticks a second.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import channels as ch
from game.core.springs import critical_spring, damper_fraction
from game.embos.draws import character_keys, uniform

__all__ = [
    "GAZE_AWAY",
    "GAZE_CUSTOMER",
    "GAZE_GOODS",
    "Life",
    "LifeConfig",
    "advance_life",
    "look",
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


# Cues in the order of the columns below -> small rotations of ADDITIVE_JOINTS (degrees per unit) and root metres.
_CUES = ("breath", "right", "forward", "twist", "side", "yaw", "roll", "gaze_yaw", "gaze_pitch", "torso_yaw", "nod")
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
_EFFECT_RAD: dict[str, dict[str, tuple[float, float, float]]] = {
    "gaze_yaw": {"neck": (0, 0.42, 0), "head": (0, 0.58, 0)},
    "gaze_pitch": {"neck": (0.42, 0, 0), "head": (0.58, 0, 0)},
    "torso_yaw": {"spine": (0, 0.45, 0), "chest": (0, 0.55, 0)},
    "nod": {"neck": (0.4, 0, 0), "head": (0.6, 0, 0)},
}
_EFFECT_M = {"right": (0.006, 0, 0), "forward": (0, 0, 0.004)}


def _effect_table() -> Floats:
    """(cues, 7·3 + 3): cue -> half angles of the additive joints, then the root's shift."""
    names = ("hips", "spine", "chest", "neck", "head", "leftShoulder", "rightShoulder")
    table = np.zeros((len(_CUES), 3 * len(names) + 3), dtype=np.float32)
    for effects, scale in ((_EFFECT_DEG, np.pi / 360.0), (_EFFECT_RAD, 0.5)):
        for cue, joints in effects.items():
            for joint, angles in joints.items():
                at = 3 * names.index(joint)
                table[_CUES.index(cue), at : at + 3] = np.multiply(angles, scale)
    for cue, shift in _EFFECT_M.items():
        table[_CUES.index(cue), -3:] = shift
    table.setflags(write=False)
    return table


_EFFECT = _effect_table()
_SWAYS = 6
_SWAY_HZ = np.array([[0.11, 0.27], [0.13, 0.31], [0.17, 0.23], [0.09, 0.29], [0.15, 0.37], [0.12, 0.33]])
_SWAY_WEIGHT = np.array([0.8, 0.6])
_BLINK_AT = np.array([0.0, 0.3, 0.45, 1.0])
_BLINK_SHUT = np.array([0.0, 1.0, 1.0, 0.0])
for _table in (_EFFECT, _SWAY_HZ, _SWAY_WEIGHT, _BLINK_AT, _BLINK_SHUT):
    _table.setflags(write=False)


@dataclass(frozen=True, eq=False)
class Life:
    """n characters. key: seeds of their draws. phase: (n, 6, 2) of the sways. clock: sway time. breath: phase in
    breaths. dart: (n, 2) of the eyes; eye: (n, 2). *_left_s, *_count: time to and number of the next dart and blink.
    head: (n, 3) yaw and pitch added to the head, yaw added to the torso, radians; head_speed: per second.
    attention: 1 looks at the target, 0 where the unit's own gaze leads. voice: (n,) smoothed speaking."""

    key: NDArray[np.uint64]
    phase: Floats
    clock: Floats
    breath: Floats
    dart: Floats
    dart_left_s: Floats
    dart_count: NDArray[np.int64]
    blink_left_s: Floats
    blink_count: NDArray[np.int64]
    blink_age_s: Floats
    eye: Floats
    head: Floats
    head_speed: Floats
    attention: Floats
    voice: Floats


def start_life(n: int, seed: int, first: int = 0) -> Life:
    """Characters first, first + 1, … of a seed."""
    key = character_keys(seed ^ 0x11FE, first, n)
    zero = np.zeros(n, dtype=np.int64)
    draw = np.concatenate([uniform(key, zero + stream, zero, 8) for stream in (2, 3)], axis=1)
    return Life(
        key=key,
        phase=draw[:, : 2 * _SWAYS].reshape(n, _SWAYS, 2),
        clock=np.zeros(n),
        breath=draw[:, -1],
        dart=np.zeros((n, 2)),
        dart_left_s=draw[:, -2],
        dart_count=zero,
        blink_left_s=0.5 + 4.0 * draw[:, -3],
        blink_count=zero,
        blink_age_s=np.full(n, 10.0),
        eye=np.zeros((n, 2)),
        head=np.zeros((n, 3)),
        head_speed=np.zeros((n, 3)),
        attention=np.ones(n),
        voice=np.zeros(n),
    )


def advance_life(
    config: LifeConfig,
    state: Life,
    emotion: Floats,
    aim: Floats,
    looking: Floats,
    speaking: Floats,
    dt_s: float,
) -> tuple[Life, Floats, Floats, Floats]:
    """emotion: (n, 7) shares that sum to 1; aim: (n, 2) yaw and pitch of the target from the head, radians;
    looking: (n,) 1 where no unit leads the gaze; speaking: (n,) 0..1.

    -> state; (n, 24) half angles of ADDITIVE_JOINTS and the root's shift; lungs (n,) 0..1; blink (n,) 0..1.
    """
    rates = emotion @ _rates(config)
    breath_hz, depth, sway, pace, blink_hz, dart_hz, dart_size, tempo = rates.T
    state = _draw(state, dart_hz, dart_size, blink_hz, dt_s)
    clock = state.clock + pace * dt_s
    breath = state.breath + breath_hz * dt_s
    u = breath % 1.0
    # In for 42 % of the cycle, out faster than the rest, then a pause: as the takes breathe.
    lungs = 0.5 - 0.5 * np.cos(np.pi * np.minimum(u / 0.42, 1.0 + np.minimum((u - 0.42) / 0.464, 1.0)))
    attention = state.attention + (looking - state.attention) * damper_fraction(0.15, dt_s)
    voice = state.voice + (speaking - state.voice) * damper_fraction(0.12, dt_s)
    wanted = np.empty_like(state.head)
    wanted[:, :2] = aim * (config.head_share * attention)[:, None]
    wanted[:, 2] = aim[:, 0] * config.torso_share * attention
    half_life = np.array([config.head_half_life_s, config.head_half_life_s, config.torso_half_life_s])
    head, head_speed = critical_spring(state.head, state.head_speed, wanted, half_life * tempo[:, None], dt_s)
    cues = np.empty((len(clock), len(_CUES)), dtype=np.float32)
    cues[:, 0] = lungs * depth * config.breath_share
    waves = np.sin(2.0 * np.pi * (_SWAY_HZ * clock[:, None, None] + state.phase)) @ _SWAY_WEIGHT
    cues[:, 1:7] = waves * (sway * config.sway_share)[:, None]
    cues[:, 7] = head[:, 0]
    cues[:, 8] = -head[:, 1]
    cues[:, 9] = head[:, 2]
    cues[:, 10] = voice * waves[:, 4] * config.nod_rad
    blink = np.interp(state.blink_age_s / config.blink_s, _BLINK_AT, _BLINK_SHUT)
    state = replace(
        state,
        clock=clock,
        breath=breath,
        head=head,
        head_speed=head_speed,
        attention=attention,
        voice=voice,
        blink_age_s=state.blink_age_s + dt_s,
    )
    return state, cues @ _EFFECT, lungs, blink


def look(config: LifeConfig, state: Life, target_head: Floats, head_turn: Floats, dt_s: float) -> tuple[Life, Floats]:
    """Eyes to the target as far as they go. target_head: (n, 3) direction in the head's frame; head_turn: (n,) yaw of
    the head against the chest, radians, which the eyes overtake where a unit's own gaze leads. -> (n, 2) in [-1, 1]."""
    ahead = np.hypot(target_head[:, 0], target_head[:, 2])
    wanted = np.empty_like(state.eye)
    wanted[:, 0] = np.arctan2(target_head[:, 0], target_head[:, 2]) / config.eye_yaw_rad
    wanted[:, 1] = np.arctan2(target_head[:, 1], ahead) / config.eye_pitch_rad
    wanted *= state.attention[:, None]
    wanted[:, 0] += (1.0 - state.attention) * head_turn * (0.5 / config.eye_yaw_rad)
    wanted = np.clip(wanted + state.dart, -1.0, 1.0)
    eye = state.eye + (wanted - state.eye) * damper_fraction(config.eye_half_life_s, dt_s)
    # A large shift of gaze brings a blink with it.
    shift = np.abs(wanted - state.eye).max(axis=1) > 0.55
    left = np.where(shift, np.minimum(state.blink_left_s, 0.02), state.blink_left_s)
    return replace(state, eye=eye, blink_left_s=left), eye


def _rates(config: LifeConfig) -> Floats:
    """(7, 8) the config's columns; rates per second."""
    return np.stack(
        [
            config.breath_per_min / 60.0,
            config.breath_depth,
            config.sway,
            config.sway_pace,
            config.blinks_per_min / 60.0,
            config.darts_per_s,
            config.dart_size,
            config.tempo,
        ],
        axis=1,
    )


def _draw(state: Life, dart_hz: Floats, dart_size: Floats, blink_hz: Floats, dt_s: float) -> Life:
    """New eye darts and blinks for those whose time has come."""
    dart_left, blink_left = state.dart_left_s - dt_s, state.blink_left_s - dt_s
    state = replace(state, dart_left_s=dart_left, blink_left_s=blink_left)
    due = np.flatnonzero(dart_left <= 0.0)
    if due.size:
        key, count = state.key[due], state.dart_count[due]
        draws = uniform(key, np.zeros(due.size, dtype=np.intp), count, 4).T
        dart, left, counts = state.dart.copy(), dart_left.copy(), state.dart_count.copy()
        # Every third dart returns to the target itself, so the gaze does not wander off.
        size = np.where(draws[3] < 0.33, 0.0, dart_size[due] * 2.0)
        dart[due, 0] = (draws[0] - 0.5) * 2.0 * size
        dart[due, 1] = (draws[1] - 0.5) * size
        left[due] = (0.35 + 1.3 * draws[2]) / dart_hz[due]
        counts[due] += 1
        state = replace(state, dart=dart, dart_left_s=left, dart_count=counts)
    due = np.flatnonzero(blink_left <= 0.0)
    if due.size:
        key, count = state.key[due], state.blink_count[due]
        first, second = uniform(key, np.ones(due.size, dtype=np.intp), count, 2).T
        left, age, counts = blink_left.copy(), state.blink_age_s.copy(), state.blink_count.copy()
        # One blink in eight comes double.
        left[due] = np.where(second < 0.125, 0.3, (0.3 + 1.4 * first) / blink_hz[due])
        age[due] = 0.0
        counts[due] += 1
        state = replace(state, blink_left_s=left, blink_age_s=age, blink_count=counts)
    return state


def additive_slice() -> NDArray[np.intp]:
    """Row channels of the vector parts of ADDITIVE_JOINTS, then of the root: where advance_life's output is added."""
    vector = (4 * ch.ADDITIVE_JOINTS[:, None] + np.arange(3)).reshape(-1)
    return np.concatenate([vector, np.arange(ch.ROOT.start, ch.ROOT.stop)])
