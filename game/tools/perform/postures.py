"""Postures: how a person stands for a while. Each lays trunk channels and where both hands belong."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from game.tools.perform.body import MIRRORED
from game.tools.perform.data import Cue
from game.tools.perform.stage import HandKey, Stage, other_side

__all__ = ["POSTURES", "Posture", "take_posture"]


@dataclass(frozen=True)
class Posture:
    """Trunk channels, homes of main and other hand, seconds to get there, and whether its arrival is struck."""

    trunk: Mapping[str, float]
    main: str
    other: str
    reach_s: float = 0.75
    ease: str = "ease"
    main_shift: tuple[float, float, float] = (0.0, 0.0, 0.0)
    other_shift: tuple[float, float, float] = (0.0, 0.0, 0.0)


def _of(main: str, other: str, reach_s: float = 0.75, ease: str = "ease", **trunk: float) -> Posture:
    return Posture(MappingProxyType(trunk), main, other, reach_s, ease)


POSTURES: Mapping[str, Posture] = MappingProxyType(
    {
        "upright": _of("side", "side", lean=0, lift=2, head_pitch=0),
        "hand_on_table": _of("rest", "rest_wide", lean=5, sideways=0.012, side=-2, head_pitch=1),
        "lean_forward": _of("planted", "planted", forward=0.03, lean=17, curl=4, neck=5, head_pitch=3, shoulders=3),
        "lean_back": _of("side", "belly", forward=-0.05, lean=-11, lift=4, neck=-4, head_pitch=-4),
        "lean_sideways": _of("rest", "side", lean=3, side=-8, sideways=0.025, head_roll=7, shoulder_tilt=-4, twist=4),
        "arms_crossed": _of("cross_in", "cross_out", lean=1, lift=4, shoulders_forward=6, shoulders=2),
        "hands_on_hips": _of("hip", "hip", lean=-2, lift=6, shoulders=1, shoulders_forward=-4),
        "fists_planted": _of(
            "fist_down", "fist_down", 0.45, "strike", forward=0.055, lean=20, curl=8, shoulders=10, neck=8, head_pitch=6
        ),
        "hands_clasped": _of("clasp_low_a", "clasp_low_b", lean=2, shoulders_forward=4, curl=2),
        "hands_to_chest": _of("clutch_a", "clutch_b", 0.6, curl=4, shoulders=6, shoulders_forward=6, neck=-2),
        "shoulders_dropped": _of(
            "limp_a", "limp_b", 1.0, lean=4, curl=8, shoulders=-5, shoulders_forward=5, up=-0.012, head_pitch=6
        ),
        "self_hug": _of(
            "hug_in", "hug_out", 0.6, curl=11, shoulders=12, shoulders_forward=10, lean=-1, head_pitch=7, head_roll=5
        ),
        "turned_away": _of(
            "aside",
            "side",
            pelvis_yaw=16,
            lean=-8,
            side=-7,
            twist=10,
            head_yaw=22,
            head_roll=-8,
            sideways=0.03,
            head_pitch=-3,
        ),
        "crouched": _of(
            "edge", "edge", 0.55, up=-0.30, forward=0.0, pelvis_yaw=-8, lean=16, curl=8, shoulders=6, head_pitch=-8
        ),
        "startled": _of(
            "startle",
            "startle",
            0.32,
            "strike",
            up=0.026,
            forward=-0.055,
            lean=-13,
            curl=-5,
            lift=10,
            shoulders=18,
            shoulders_forward=-5,
            neck=-5,
            head_pitch=-14,
        ),
        "arms_open": _of(
            "open_wide", "open_wide", 0.6, forward=0.02, lean=3, lift=5, head_pitch=-4, head_roll=-5, side=-2
        ),
    }
)
"""Postures by name. Written with the left hand as the main one; emotions add their carriage."""


def take_posture(stage: Stage, cue: Cue, owner: int) -> float:
    """Lay a posture from the cue on; returns when it is reached, seconds."""
    posture = POSTURES[cue.do]
    tempo = stage.effort.tempo * cue.tempo
    ease = getattr(stage.effort, posture.ease)
    sign = -1.0 if cue.side == "right" else 1.0
    trunk = {name: value * (sign if name in MIRRORED else 1.0) for name, value in posture.trunk.items()}
    stage.posture(cue, trunk, posture.reach_s * tempo, ease)
    main, other = cue.hands or (posture.main, posture.other)
    for i, (side, target) in enumerate(((cue.side, main), (other_side(cue.side), other))):
        stage.hands[side].home.append(
            HandKey(
                max(cue.at_s, 0.0) + 0.05 * i * tempo,
                posture.reach_s * tempo * (1.0 + 0.08 * i),
                stage.target(target),
                ease,
                stage.effort.arc,
                owner,
            )
        )
    return cue.at_s + posture.reach_s * tempo
