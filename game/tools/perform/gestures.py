"""Gestures: what hands and head do with words. Written for the left hand; ``m.stroke`` is the moment that meets the
word."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from game.tools.perform.act import Act, sine
from game.tools.perform.stage import Move

__all__ = ["GESTURES"]


def _point_at(m: Move) -> None:
    m.body(m.start, 0.35, head_pitch=5, head_yaw=5, lean=3)
    m.hand("main", m.start, 0.3, "point_back", ease=m.stage.effort.settle)
    m.hand("main", m.after(0.30), 0.28, "point_item", ease=m.stage.effort.strike)
    m.stroke = m.after(0.58)
    m.wave(
        m.stroke,
        m.leave,
        fade=0.1,
        hand="main",
        shift=lambda t: (0.0, -0.018 * np.abs(sine(1.6, t)), 0.010 * np.abs(sine(1.6, t))),
    )


def _point_out(m: Move) -> None:
    m.body(m.start, 0.3, lean=4, twist=-6, head_pitch=2, neck=3)
    m.hand("main", m.start, 0.26, "point_back", ease=m.stage.effort.settle)
    m.hand("main", m.after(0.26), 0.22, "point_out", ease=m.stage.effort.strike)
    m.body(m.after(0.26), 0.22, m.stage.effort.strike, lean=8, twist=9, neck=6)
    m.stroke = m.after(0.48)


def _open_palm(m: Move) -> None:
    m.body(m.start, 0.4, lean=4, head_roll=-4, twist=3, head_yaw=3)
    m.hand("main", m.start, 0.5, "palm_up")
    m.hand("main", m.after(0.42), 0.4, "palm_show")
    m.stroke = m.after(0.55)


def _open_palms(m: Move) -> None:
    m.body(m.start, 0.4, forward=0.012, lean=4, lift=4, head_pitch=-3, head_roll=-5)
    m.hand("both", m.start, 0.48, "palm_show")
    m.stroke = m.after(0.5)
    m.wave(m.stroke, m.leave, hand="both", shift=lambda t: (0.014 * sine(1.4, t), 0.016 * sine(1.4, t), 0.0))


def _come_on(m: Move) -> None:
    m.body(m.start, 0.35, lean=5, head_pitch=3, head_roll=4)
    m.hand("main", m.start, 0.4, "beckon")
    m.stroke = m.arrive + 0.1
    m.wave(
        m.arrive - 0.05,
        m.leave,
        fade=0.1,
        hand="main",
        shift=lambda t: (0.0, 0.030 * sine(1.9, t), -0.022 * sine(1.9, t)),
        turn=lambda t: (0.0, 26 * sine(1.9, t, 0.05), 0.0),
        curl=lambda t: 24 * np.maximum(0.0, sine(1.9, t, 0.08)),
    )


def _calm_down(m: Move) -> None:
    m.body(m.start, 0.4, lean=3, head_pitch=4, head_roll=3)
    m.hand("both", m.start, 0.42, "calm", shift=(0.0, 0.05, 0.0))
    m.hand("both", m.after(0.42), 0.35, "calm", shift=(0.0, -0.02, 0.02), arc=0.0)
    m.stroke = m.after(0.7)
    m.wave(
        m.after(0.75),
        m.leave,
        hand="both",
        shift=lambda t: (0.0, 0.030 * sine(1.3, t), 0.0),
        turn=lambda t: (0.0, 8 * sine(1.3, t, 0.06), 0.0),
    )


def _push_away(m: Move) -> None:
    m.body(m.start, 0.4, lean=-4, head_yaw=8, twist=-4)
    m.hand("main", m.start, 0.36, "push_back")
    m.hand("main", m.after(0.34), 0.42, "push")
    m.body(m.after(0.34), 0.42, lean=-5, twist=-9, head_yaw=16, head_roll=-6)
    m.stroke = m.after(0.68)


def _shoo(m: Move) -> None:
    m.body(m.start, 0.4, lean=-4, side=-4, head_yaw=22, head_pitch=-5, head_roll=-6)
    m.hand("main", m.start, 0.34, "shoo_in")
    at, step = m.arrive, 0.50
    m.stroke = at + 0.17
    while at + 0.3 < m.leave or at == m.arrive:
        m.hand("main", at, 0.17 / m.tempo, "shoo_out", ease=m.stage.effort.settle, arc=0.0)
        m.hand("main", at + 0.24, 0.22 / m.tempo, "shoo_in", ease=m.stage.effort.settle, arc=0.0)
        at += step


def _to_self(m: Move) -> None:
    m.body(m.start, 0.4, head_pitch=4, head_roll=-4, lean=-1, lift=2)
    m.hand("main", m.start, 0.45, "self")
    m.stroke = m.after(0.45)
    m.wave(m.stroke, m.leave, hand="main", shift=lambda t: (0.0, 0.006 * sine(1.7, t), 0.008 * np.abs(sine(1.7, t))))


def _show_size(m: Move) -> None:
    m.body(m.start, 0.4, head_pitch=5, lean=3, lift=2)
    m.hand("both", m.start, 0.42, "size_narrow")
    m.hand("both", m.after(0.42), 0.45, "size_wide", arc=0.08)
    m.stroke = m.after(0.8)
    m.wave(m.stroke, m.leave, hand="both", shift=lambda t: (0.010 * sine(1.5, t), 0.010 * np.abs(sine(1.5, t)), 0.0))


def _show_small(m: Move) -> None:
    m.body(m.start, 0.4, head_pitch=7, lean=3, head_roll=4)
    m.hand("both", m.start, 0.45, "size_wide")
    m.hand("both", m.after(0.40), 0.45, "size_narrow", shift=(-0.025, 0.0, 0.0), arc=0.0)
    m.stroke = m.after(0.8)


def _draw_shape(m: Move) -> None:
    m.body(m.start, 0.4, head_pitch=4, head_yaw=4)
    m.hand("main", m.start, 0.45, "draw")
    m.stroke = m.arrive + 0.1
    f = 0.85
    m.wave(
        m.arrive - 0.05,
        m.leave,
        fade=0.15,
        hand="main",
        shift=lambda t: (0.055 * sine(f, t), 0.05 - 0.05 * np.cos(2 * np.pi * f * t), 0.0),
        head_yaw=lambda t: 2.5 * sine(f, t),
    )


def _draw_path(m: Move) -> None:
    # From out here, round a bend, to over there; the head goes along and arrives first.
    m.body(m.start, 0.4, head_pitch=5, head_yaw=14, twist=4)
    m.hand("main", m.start, 0.42, "path_from")
    m.stroke = m.arrive + 0.05
    way = max(m.leave - m.stroke, 0.5) / m.tempo
    m.body(m.stroke, 0.7 * way, m.stage.effort.settle, head_yaw=-12, head_pitch=2, twist=-5)
    m.hand("main", m.stroke, 0.5 * way, "path_bend", ease=m.stage.effort.settle)
    m.hand("main", m.stroke + 0.40 * way * m.tempo, 0.55 * way, "path_to", ease=m.stage.effort.settle)


def _count_price(m: Move) -> None:
    m.body(m.start, 0.35, head_pitch=-1, head_roll=4, lean=2)
    m.hand("main", m.start, 0.45, "count")
    m.stroke = m.after(0.5)
    m.wave(
        m.stroke,
        m.leave,
        hand="main",
        shift=lambda t: (0.004 * sine(1.7, t), -0.020 * np.abs(sine(1.7, t)), 0.012 * np.abs(sine(1.7, t))),
    )


def _beat(m: Move) -> None:
    m.body(m.start, 0.3, lean=3, head_pitch=2)
    m.hand("main", m.start, 0.38, "beat")
    m.stroke = m.arrive + 0.12
    f = 2.15
    m.wave(
        m.arrive - 0.1,
        m.leave,
        fade=0.1,
        hand="main",
        shift=lambda t: (0.0, 0.034 * np.cos(2 * np.pi * f * t), 0.014 * np.cos(2 * np.pi * f * t)),
        turn=lambda t: (0.0, -12 * np.cos(2 * np.pi * f * (t - 0.04)), 0.0),
        head_pitch=lambda t: -2.4 * np.cos(2 * np.pi * f * t),
    )


def _chop(m: Move) -> None:
    m.body(m.start, 0.3, lean=3, head_pitch=3, twist=-3)
    m.hand("main", m.start, 0.34, "chop", shift=(0.02, 0.06, 0.0))
    m.stroke = m.arrive + 0.1
    f = 1.75
    m.wave(
        m.arrive - 0.1,
        m.leave,
        fade=0.1,
        hand="main",
        shift=lambda t: (
            -0.030 * np.sign(sine(f, t)) * np.abs(sine(f, t)) ** 0.5,
            -0.045 * np.abs(sine(f, t)) ** 2,
            0.02,
        ),
        head_yaw=lambda t: 3 * sine(f, t, 0.05),
    )


def _pound(m: Move) -> None:
    # One fist up with the chin down, a strike of .17 s, a recoil: twice where the hold allows.
    strike, calm = m.stage.effort.strike, m.stage.effort.settle
    at, first = m.start, True
    while first or at + 0.75 * m.tempo < m.leave:
        m.body(
            at,
            0.30,
            calm,
            lean=-4,
            lift=6,
            shoulders=3,
            shoulder_tilt=8,
            up=0.012,
            twist=14,
            side=4,
            head_pitch=-2,
            head_roll=-4,
        )
        m.hand("main", at, 0.33, "fist_up", ease=calm)
        hit = at + 0.44 * m.tempo
        m.body(
            hit,
            0.17,
            strike,
            lean=10,
            lift=-2,
            shoulders=0,
            shoulder_tilt=0,
            up=-0.022,
            forward=0.03,
            twist=-8,
            side=-3,
            head_pitch=5,
            neck=4,
            head_roll=2,
        )
        m.hand("main", hit, 0.17, "fist_down", ease=strike, arc=0.0)
        land = hit + 0.15 * m.tempo
        m.wave(
            land,
            land + 0.45,
            fade=0.02,
            up=lambda t: 0.016 * np.exp(-7 * t) * sine(5, t),
            head_pitch=lambda t: 6 * np.exp(-7 * t) * sine(5, t),
        )
        if first:
            m.stroke = hit + 0.17 * m.tempo
        first = False
        at = hit + 0.62 * m.tempo


def _shake_fist(m: Move) -> None:
    m.body(m.start, 0.28, lean=6, twist=-10, shoulder_tilt=4, head_roll=5, forward=0.02, neck=3)
    m.hand("main", m.start, 0.28, "fist_up", shift=(0.05, 0.02, 0.04))
    m.stroke = m.arrive
    f = 4.2
    m.wave(
        m.arrive - 0.05,
        m.leave,
        fade=0.1,
        hand="main",
        shift=lambda t: (0.016 * sine(f, t), 0.042 * sine(f, t), 0.042 * sine(f, t)),
        turn=lambda t: (0.0, 16 * sine(f, t, 0.03), 0.0),
        head_pitch=lambda t: 2.5 * sine(f, t),
        head_yaw=lambda t: 2 * sine(f, t),
    )


def _nod(m: Move) -> None:
    f = 1.55
    m.body(m.start, 0.25, head_pitch=-3, lean=1)
    m.stroke = m.after(0.3)
    m.wave(
        m.after(0.15),
        m.leave + 0.15,
        fade=0.15,
        head_pitch=lambda t: 11 * np.maximum(-0.3, sine(f, t)),
        lean=lambda t: 1.6 * np.maximum(0, sine(f, t, 0.05)),
    )


def _shake_head(m: Move) -> None:
    f = 1.5 / m.tempo
    m.body(m.start, 0.25, head_pitch=2)
    m.stroke = m.after(0.25)
    m.wave(
        m.start,
        m.leave,
        fade=0.2,
        head_yaw=lambda t: 15 * sine(f, t),
        twist=lambda t: 2.5 * sine(f, t, 0.1),
        head_roll=lambda t: 2 * sine(f, t, 0.2),
    )


def _bow(m: Move) -> None:
    m.body(m.start, 0.55, lean=22, curl=6, head_pitch=26, forward=-0.02, neck=-2)
    m.stroke = m.arrive


def _tilt_head(m: Move) -> None:
    m.body(m.start, 0.4, head_roll=14, head_yaw=6, side=-2, head_pitch=-2)
    m.stroke = m.after(0.35)


def _wave_hand(m: Move) -> None:
    m.body(m.start, 0.4, side=4, head_roll=7, twist=-4, lift=2)
    m.hand("main", m.start, 0.45, "wave")
    m.stroke = m.arrive
    f = 1.7
    m.wave(
        m.arrive - 0.1,
        m.leave,
        fade=0.15,
        hand="main",
        shift=lambda t: (0.050 * sine(f, t), 0.006 * sine(2 * f, t), 0.0),
        turn=lambda t: (24 * sine(f, t, 0.05), 0.0, 0.0),
    )


def _shrug(m: Move) -> None:
    m.body(m.start, 0.35, shoulders=15, head_roll=9, lean=-2, side=-2, head_pitch=1)
    m.hand("both", m.start, 0.42, "shrug")
    m.stroke = m.after(0.42)


def _no_no(m: Move) -> None:
    m.body(m.start, 0.35, lean=-3, head_yaw=-4)
    m.hand("main", m.start, 0.4, "refuse")
    m.stroke = m.arrive
    f = 2.35
    m.wave(
        m.arrive - 0.1,
        m.leave,
        fade=0.12,
        hand="main",
        shift=lambda t: (0.045 * sine(f, t), 0.0, 0.0),
        turn=lambda t: (10 * sine(f, t, 0.04), 0.0, 0.0),
        head_yaw=lambda t: 7 * sine(1.45, t),
    )


def _think(m: Move) -> None:
    m.body(m.start, 0.5, head_roll=8, head_yaw=10, head_pitch=-4)
    m.hand("main", m.after(0.05), 0.55, "chin")
    m.stroke = m.arrive


def _arms_up(m: Move) -> None:
    # A crouch, then a burst upward on wide arcs.
    burst = m.stage.effort.strike
    m.body(m.start, 0.26, m.stage.effort.settle, up=-0.04, lean=7, lift=-6, head_pitch=9)
    m.hand("both", m.start, 0.26, "pump", ease=m.stage.effort.settle)
    m.body(m.after(0.28), 0.3, burst, up=0.04, lean=-6, lift=6, shoulders=6, head_pitch=-9)
    m.hand("both", m.after(0.28), 0.34, "victory", ease=burst, arc=0.40)
    m.stroke = m.after(0.55)
    m.wave(
        m.after(0.65),
        m.leave,
        fade=0.2,
        hand="both",
        shift=lambda t: (0.03 * sine(1.6, t), -0.01 + 0.02 * np.cos(2 * np.pi * 3.2 * t), 0.0),
        side=lambda t: 5 * sine(0.8, t),
        head_roll=lambda t: 6 * sine(0.8, t, 0.1),
        up=lambda t: 0.014 * np.cos(2 * np.pi * 1.6 * t) - 0.014,
    )


GESTURES: Mapping[str, Act] = MappingProxyType(
    {
        "point_at": Act(0.6, 0.5, _point_at),
        "point_out": Act(0.5, 0.45, _point_out),
        "open_palm": Act(0.6, 0.55, _open_palm),
        "open_palms": Act(0.55, 0.55, _open_palms),
        "come_on": Act(0.45, 0.5, _come_on),
        "calm_down": Act(0.8, 0.55, _calm_down),
        "push_away": Act(0.78, 0.5, _push_away),
        "shoo": Act(0.38, 0.4, _shoo),
        "to_self": Act(0.5, 0.5, _to_self),
        "show_size": Act(0.9, 0.55, _show_size),
        "show_small": Act(0.9, 0.55, _show_small),
        "draw_shape": Act(0.5, 0.5, _draw_shape),
        "draw_path": Act(0.5, 0.5, _draw_path),
        "count_price": Act(0.5, 0.5, _count_price),
        "beat": Act(0.42, 0.45, _beat),
        "chop": Act(0.4, 0.45, _chop),
        "pound": Act(0.62, 0.4, _pound),
        "shake_fist": Act(0.32, 0.4, _shake_fist),
        "nod": Act(0.3, 0.3, _nod),
        "shake_head": Act(0.25, 0.3, _shake_head),
        "bow": Act(0.6, 0.6, _bow),
        "tilt_head": Act(0.45, 0.45, _tilt_head),
        "wave": Act(0.5, 0.55, _wave_hand),
        "shrug": Act(0.45, 0.5, _shrug),
        "no_no": Act(0.45, 0.45, _no_no),
        "think": Act(0.65, 0.55, _think),
        "arms_up": Act(0.65, 0.55, _arms_up),
    }
)
"""Gestures by name."""
