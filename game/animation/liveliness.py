"""How feelings show in what never stops (tick/liveliness.c): breath, sway, blinking and gaze."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import channels as ch
from game.animation.tick_data import EFFECT
from game.core.humanoid import REFERENCE
from game.core.springs import half_life_to_damping
from game.embos.draws import character_keys, uniform

__all__ = [
    "BLINK",
    "BREATH",
    "EFFECTS",
    "GAZE_AWAY",
    "GAZE_CUSTOMER",
    "GAZE_GOODS",
    "SWAY_HZ",
    "LifeConfig",
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

    @property
    def stiffness(self) -> tuple[float, float]:
        """Per second, of head and torso: half the damping of critical springs with the half-lives
        (game.core.springs)."""
        head, torso = (half_life_to_damping(h) / 2.0 for h in (self.head_half_life_s, self.torso_half_life_s))
        return float(head), float(torso)


_SWAYS = ("right", "forward", "twist", "side", "yaw", "roll")
_CUES = ("breath", *(f"{name}{k}" for name in _SWAYS for k in (0, 1)), "gaze_yaw", "gaze_pitch", "torso_yaw", "nod")
"""What moves the torso and head, in the order of tick/liveliness.c: sways are two sines each."""
SWAY_HZ = np.array([0.11, 0.27, 0.13, 0.31, 0.17, 0.23, 0.09, 0.29, 0.15, 0.37, 0.12, 0.33])
"""Of the sways' sines."""
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


def _effects() -> NDArray[np.void]:
    """EFFECT: half angles of joints (vector parts of their quaternions) and the root's shift, by cue."""
    found: list[tuple[int, int, float]] = []
    for cue, of_cue in enumerate(_CUES):
        name, weight = (of_cue[:-1], _SWAY_WEIGHT[int(of_cue[-1])]) if of_cue[-1].isdigit() else (of_cue, 1.0)
        for effects, scale in ((_EFFECT_DEG, np.pi / 360.0), (_EFFECT_RAD, 0.5)):
            for joint, angles in effects.get(name, {}).items():
                at = ch.ROTATION.start + 4 * REFERENCE.index[joint]
                found += [(cue, at + i, angle * scale * weight) for i, angle in enumerate(angles) if angle]
        shift = _EFFECT_M.get(name, (0.0, 0.0, 0.0))
        found += [(cue, ch.ROOT.start + i, metres * weight) for i, metres in enumerate(shift) if metres]
    return np.array(found, dtype=EFFECT)


EFFECTS = _effects()
"""EFFECT: what each cue moves, and how far."""
_BREATH_AT = np.linspace(0.0, 1.0, 65)
BREATH = np.where(
    _BREATH_AT < 0.42,
    0.5 - 0.5 * np.cos(np.pi * _BREATH_AT / 0.42),
    0.5 + 0.5 * np.cos(np.pi * np.minimum((_BREATH_AT - 0.42) / 0.464, 1.0)),
)
"""(65,) lungs over one cycle: in for 42 % of it, out a little slower, then a pause, as the takes breathe."""
BLINK = np.array([[0.0, 0.3, 0.45, 1.0], [0.0, 1.0, 1.0, 0.0]])
"""Shares of a blink, and how far the lids are shut there."""
for _table in (EFFECTS, SWAY_HZ, _BREATH_AT, BREATH, BLINK):
    _table.setflags(write=False)


def start_life(characters: NDArray[np.void], seed: int, first: int = 0) -> None:
    """Characters first, first + 1, … of a seed, (n,) CHARACTER: their draws, and where their clocks stand."""
    n = len(characters)
    key = character_keys(seed ^ 0x11FE, first, n)
    zero = np.zeros(n, dtype=np.int64)
    draw = np.concatenate([uniform(key, zero + stream, zero, 8) for stream in (2, 3)], axis=1)
    characters["key"], characters["phase"] = key, 2.0 * np.pi * draw[:, : len(SWAY_HZ)]
    characters["breaths"], characters["dart_left_s"] = draw[:, -1], draw[:, -2]
    characters["blink_left_s"], characters["blink_age_s"] = 0.5 + 4.0 * draw[:, -3], 10.0
    characters["attention"] = 1.0
