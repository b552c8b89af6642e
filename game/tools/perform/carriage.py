"""Mannerisms of trunk, head and knees: breath, glances and stares, shivers, bounces, sways."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.tools.perform.act import Act, pulse, sine
from game.tools.perform.stage import Move

__all__ = ["CARRIAGE"]

Floats = NDArray[np.floating[Any]]


def _sob(m: Move) -> None:
    m.body(m.start, 0.5, curl=4, head_pitch=5)

    def beat(t: Floats) -> Floats:
        return np.asarray(pulse(1.5, t) * (0.6 + 0.4 * sine(0.37, t)))

    m.wave(
        m.arrive,
        m.leave,
        fade=0.4,
        shoulders=lambda t: 6.0 * beat(t),
        up=lambda t: 0.008 * beat(t),
        curl=lambda t: -2.5 * beat(t - 0.05),
    )


def _sigh(m: Move) -> None:
    # Rises, holds, then sinks deeper than before.
    top = m.arrive
    m.body(m.start, 0.55, curl=-6, head_pitch=-9, shoulders=5, lift=3)
    m.body(top + 0.15, 0.6, curl=5, head_pitch=5, shoulders=-6, up=-0.012, lift=-3)
    m.breathe((m.start, 0.2), (top, 2.0), (top + 0.2, 2.0), (top + 1.1, -0.8), (m.leave, -0.6), (m.end, 0.1))


def _huff(m: Move) -> None:
    m.body(m.start, 0.3, lift=4, head_pitch=-6, shoulders=5)
    m.body(m.arrive, 0.2, lift=-2, head_pitch=4, head_yaw=9, shoulders=-3)
    m.breathe((m.start, 0.3), (m.arrive, 1.7), (m.arrive + 0.35, -0.6), (m.end, 0.2))


def _look_away(m: Move) -> None:
    m.body(m.start, 0.4, head_yaw=26, head_pitch=3, head_roll=-3)
    m.body(m.after(0.12), 0.55, twist=6, side=-2)


def _look_down(m: Move) -> None:
    m.body(m.start, 0.5, head_pitch=12, head_yaw=7)
    m.body(m.after(0.15), 0.6, curl=3)


def _glance_around(m: Move) -> None:
    # Fast turns and still waits between, not a swing.
    step = max((m.leave - m.arrive) / 2.0, 0.4)
    m.body(m.start, 0.16, head_yaw=38, head_pitch=-2)
    m.body(m.after(0.08), 0.3, twist=4)
    m.body(m.arrive + 0.55 * step, 0.15, head_yaw=-34, head_pitch=-3)
    m.body(m.arrive + 0.6 * step, 0.3, twist=-5)
    m.body(m.arrive + 1.45 * step, 0.15, head_yaw=17, head_pitch=2)


def _tremble(m: Move) -> None:
    m.body(m.start, 0.2, shoulders=4, curl=2)
    m.tremble(m.start, m.leave, 1.2)


def _start(m: Move) -> None:
    # Up, back, breath held: the jump of a surprise that stays small.
    strike = m.stage.effort.strike
    m.body(m.start, 0.2, strike, up=0.022, forward=-0.03, lean=-8, lift=8, shoulders=13, head_pitch=-9, neck=-4)
    m.breathe((m.start, 0.4), (m.arrive, 1.7), (m.leave, 1.6), (m.end, 0.8))


def _bounce(m: Move) -> None:
    f = 1.5
    m.body(m.start, 0.3, lift=3, head_pitch=-2)
    m.wave(
        m.start,
        m.leave,
        up=lambda t: 0.022 * np.abs(sine(0.5 * f, t)) - 0.008,
        side=lambda t: 4.5 * sine(0.5 * f, t),
        head_roll=lambda t: 7 * sine(0.5 * f, t, 0.09),
        lift=lambda t: 3 * np.abs(sine(0.5 * f, t)),
    )


def _sway(m: Move) -> None:
    m.wave(
        m.start,
        m.leave,
        fade=0.6,
        sideways=lambda t: 0.022 * sine(0.43, t),
        side=lambda t: -4.5 * sine(0.43, t),
        head_roll=lambda t: -4 * sine(0.43, t, 0.2),
        twist=lambda t: 4 * sine(0.43, t, 0.35),
    )


def _shift_weight(m: Move) -> None:
    m.body(m.start, 0.8, sideways=0.024, side=-3.5, pelvis_yaw=4, head_roll=3)


def _sniff(m: Move) -> None:
    m.body(m.start, 0.4, forward=0.03, lean=9, neck=9, head_pitch=10, head_yaw=-6)
    m.wave(
        m.arrive,
        m.leave,
        fade=0.05,
        lift=lambda t: 3 * np.abs(sine(2.5, t)),
        head_pitch=lambda t: -4 * np.abs(sine(2.5, t)),
    )


def _recoil(m: Move) -> None:
    m.body(
        m.start,
        0.36,
        forward=-0.05,
        sideways=0.03,
        pelvis_yaw=9,
        lean=-9,
        side=-8,
        neck=-7,
        head_yaw=15,
        head_pitch=-7,
        head_roll=-9,
        shoulders=5,
    )


def _shudder(m: Move) -> None:
    m.body(m.start, 0.25, shoulders=8, curl=3, head_pitch=3)
    m.wave(
        m.start,
        m.leave,
        fade=0.12,
        head_yaw=lambda t: 7 * sine(4.5, t),
        shoulders=lambda t: 3 * sine(4.5, t),
        twist=lambda t: 3 * sine(4.5, t, -0.1),
    )


def _stare(m: Move) -> None:
    # The gaze fixes on something and the head stops for it; only the neck goes on, slowly.
    m.body(m.start, 0.25, neck=5, head_pitch=-1, head_yaw=-4)
    m.body(m.after(0.3), 1.4, m.stage.effort.settle, neck=9, lean=2)


def _toss_head(m: Move) -> None:
    # Two jerks of the head, each as short as a jerk can be.
    m.body(m.start, 0.2, head_yaw=-11, head_pitch=-6, head_roll=5)
    m.body(m.after(0.26), 0.2, head_yaw=10, head_pitch=5, head_roll=-4, twist=4)


def _knee_jiggle(m: Move) -> None:
    m.wave(
        m.start,
        m.leave,
        fade=0.25,
        up=lambda t: 0.006 * sine(4.7, t) - 0.004,
        sideways=lambda t: 0.003 * sine(2.35, t),
        shoulders=lambda t: 1.1 * sine(4.7, t, 0.05),
        head_pitch=lambda t: 0.9 * sine(4.7, t, 0.07),
    )


def _peek(m: Move) -> None:
    # Up by a hand's breadth, a look to each side, and the head is gone again.
    m.body(m.start, 0.4, up=0.085, head_pitch=-6, neck=4)
    m.body(m.arrive, 0.15, head_yaw=24)
    m.body(m.arrive + 0.55 * (m.leave - m.arrive), 0.15, head_yaw=-20)


CARRIAGE: Mapping[str, Act] = MappingProxyType(
    {
        "sob": Act(0.5, 0.6, _sob),
        "sigh": Act(0.6, 0.8, _sigh),
        "huff": Act(0.35, 0.4, _huff),
        "look_away": Act(0.45, 0.45, _look_away),
        "look_down": Act(0.55, 0.5, _look_down),
        "glance_around": Act(0.2, 0.25, _glance_around),
        "tremble": Act(0.2, 0.3, _tremble),
        "start": Act(0.25, 0.7, _start),
        "bounce": Act(0.2, 0.4, _bounce),
        "sway": Act(0.5, 0.5, _sway),
        "shift_weight": Act(0.8, 0.8, _shift_weight),
        "sniff": Act(0.42, 0.4, _sniff),
        "recoil": Act(0.45, 0.6, _recoil),
        "shudder": Act(0.2, 0.35, _shudder),
        "stare": Act(0.3, 0.4, _stare),
        "toss_head": Act(0.5, 0.35, _toss_head),
        "knee_jiggle": Act(0.25, 0.3, _knee_jiggle),
        "peek": Act(0.45, 0.35, _peek),
    }
)
"""Mannerisms by name."""
