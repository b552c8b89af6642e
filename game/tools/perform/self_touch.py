"""Mannerisms of the hands: what they do to face, hair, clothes, table and each other without one's knowing.

Written for the left hand. Head and trunk set out first, the hand a little later; what repeats does so at its own
frequency, never a tempo's multiple, so that nothing falls into step.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.tools.perform.act import Act, pulse, sine
from game.tools.perform.stage import Move

__all__ = ["SELF_TOUCH"]

Floats = NDArray[np.floating[Any]]


def _touch_nose(m: Move) -> None:
    m.body(m.start, 0.4, head_pitch=4, head_roll=-5, head_yaw=-5)
    m.hand("main", m.after(0.06), 0.5, "nose_tip")
    m.wave(m.arrive, m.leave, hand="main", shift=lambda t: (0.008 * sine(2.3, t), 0.005 * sine(1.1, t), 0.004))


def _cover_mouth(m: Move) -> None:
    m.body(m.start, 0.35, head_pitch=4, head_roll=-4, shoulders=4, lean=-2)
    m.hand("main", m.after(0.05), 0.42, "mouth")


def _cover_both(m: Move) -> None:
    m.body(m.start, 0.4, shoulders=6, head_roll=5, head_pitch=-2, lift=2)
    m.hand("main", m.after(0.04), 0.5, "gasp_a")
    m.hand("other", m.after(0.10), 0.52, "gasp_b")


def _hold_nose(m: Move) -> None:
    m.body(m.start, 0.38, lean=-6, side=-5, head_yaw=12, head_pitch=-4, head_roll=-7, shoulders=4, neck=-4)
    m.hand("main", m.after(0.06), 0.42, "nose")


def _fan_nose(m: Move) -> None:
    m.body(m.start, 0.38, lean=-4, side=-5, head_yaw=8, head_pitch=-3, head_roll=-8)
    m.hand("main", m.after(0.03), 0.4, "fan")
    m.wave(
        m.arrive,
        m.leave,
        fade=0.12,
        hand="main",
        shift=lambda t: (0.055 * sine(1.9, t), 0.0, 0.01 * sine(1.9, t)),
        turn=lambda t: (22 * sine(1.9, t, 0.07), 12 * sine(1.9, t, 0.07), 0.0),
        head_yaw=lambda t: 5 * sine(1.3, t),
    )


def _hair_stroke(m: Move) -> None:
    m.body(m.start, 0.5, head_roll=-7, head_yaw=-8, head_pitch=4)
    m.hand("main", m.after(0.08), 0.6, "hair")
    span = max(m.leave - m.arrive, 0.4)
    stroke: Callable[[Floats], tuple[float, Floats, Floats]] = lambda t: (  # noqa: E731
        0.0,
        0.015 - 0.06 * np.clip(t / span, 0, 1),
        -0.035 * np.clip(t / span, 0, 1),
    )
    m.wave(m.arrive, m.leave + 0.2, fade=0.2, hand="main", shift=stroke, curl=lambda t: 12 * np.clip(t / span, 0, 1))


def _twirl_hair(m: Move) -> None:
    m.body(m.start, 0.5, head_roll=-6, head_pitch=6)
    m.hand("main", m.after(0.06), 0.6, "hair_end")
    m.wave(
        m.arrive,
        m.leave,
        hand="main",
        shift=lambda t: (0.010 * sine(1.25, t), 0.014 * sine(1.25, t, 0.2), 0.006 * sine(1.25, t)),
        turn=lambda t: (0.0, 14 * sine(1.25, t), 0.0),
        curl=lambda t: 8 * sine(1.25, t, 0.1),
    )


def _scratch_head(m: Move) -> None:
    m.body(m.start, 0.45, head_roll=7, head_pitch=5, head_yaw=-4, shoulder_tilt=5)
    m.hand("main", m.after(0.05), 0.55, "scratch")
    m.wave(
        m.arrive,
        m.leave,
        hand="main",
        shift=lambda t: (0.004 * sine(3.7, t), 0.016 * sine(3.7, t), 0.0),
        curl=lambda t: 9 * sine(3.7, t, 0.05),
    )


def _rub_nape(m: Move) -> None:
    m.body(m.start, 0.5, head_pitch=8, head_roll=6, head_yaw=-8, shoulder_tilt=4)
    m.hand("main", m.after(0.06), 0.6, "nape")
    m.wave(m.arrive, m.leave, hand="main", shift=lambda t: (0.0, 0.014 * sine(1.45, t), 0.006 * sine(1.45, t)))


def _touch_brow(m: Move) -> None:
    m.body(m.start, 0.5, head_pitch=9, head_roll=-4, curl=3)
    m.hand("main", m.after(0.06), 0.55, "brow")
    m.wave(m.arrive, m.leave, hand="main", shift=lambda t: (0.016 * sine(0.9, t), 0.003 * sine(1.8, t), 0.0))


def _wipe_eye(m: Move) -> None:
    m.body(m.start, 0.5, head_roll=8, head_yaw=4, head_pitch=-4, side=2)
    m.hand("main", m.after(0.06), 0.55, "eye")
    m.wave(
        m.arrive,
        m.leave,
        fade=0.25,
        hand="main",
        shift=lambda t: (0.026 * sine(0.85, t), 0.008 * sine(1.7, t), 0.004),
        turn=lambda t: (8 * sine(0.85, t), 0.0, 0.0),
    )


def _face_in_hands(m: Move) -> None:
    m.body(m.start, 0.65, curl=9, lean=5, head_pitch=8, head_roll=5, up=-0.015)
    m.hand("main", m.after(0.05), 0.55, "cover")
    m.hand("other", m.after(0.14), 0.60, "cover")


def _exhale(m: Move) -> None:
    m.body(m.start, 0.4, lift=4, shoulders=6, head_pitch=-3)
    m.hand("main", m.after(0.05), 0.5, "heart")
    m.body(m.arrive + 0.25, 0.7, m.stage.effort.settle, lift=-2, shoulders=-5, curl=5, head_pitch=8, up=-0.01)
    m.breathe((m.start, 0.8), (m.arrive, 1.8), (m.arrive + 0.2, 1.8), (m.arrive + 1.1, -0.6), (m.end, 0.2))


def _finger_tap(m: Move) -> None:
    m.body(m.start, 0.4, head_roll=3, head_yaw=-4)
    m.hand("main", m.start, 0.4, "drum")
    m.wave(m.arrive, m.leave, fade=0.08, hand="main", curl=lambda t: -26 * pulse(3.3, t))


def _finger_drum(m: Move) -> None:
    # On the other arm, where the hand already lies when arms are crossed.
    m.wave(m.start, m.leave, fade=0.08, hand="main", curl=lambda t: -32 * pulse(4.3, t))
    m.body(m.after(0.5), 0.2, head_yaw=9, head_roll=4)
    m.body(m.after(1.1), 0.2, head_yaw=-8, head_roll=-5)


def _fist_drum(m: Move) -> None:
    m.body(m.start, 0.3, head_yaw=-7, twist=-5)
    m.hand("main", m.start, 0.35, "fist_down")
    m.wave(m.arrive, m.leave, fade=0.08, hand="main", shift=lambda t: (0.0, 0.045 * np.abs(sine(1.8, t)) ** 0.7, 0.0))


def _rub_hands(m: Move) -> None:
    m.body(m.start, 0.4, lean=2, head_roll=3)
    m.hand("main", m.start, 0.45, "rub_a")
    m.hand("other", m.after(0.03), 0.48, "rub_b")
    m.wave(m.arrive, m.leave, hand="main", shift=lambda t: (0.0, 0.022 * sine(2.1, t), 0.022 * sine(2.1, t)))
    m.wave(m.arrive, m.leave, hand="other", shift=lambda t: (0.0, -0.022 * sine(2.1, t), -0.022 * sine(2.1, t)))


def _wring_hands(m: Move) -> None:
    m.body(m.start, 0.4, curl=3, shoulders=3)
    m.hand("main", m.start, 0.4, "clutch_a")
    m.hand("other", m.after(0.03), 0.42, "clutch_b")
    m.wave(
        m.arrive,
        m.leave,
        hand="main",
        curl=lambda t: 9 * sine(2.3, t),
        shift=lambda t: (0.006 * sine(1.9, t), 0.014 * sine(1.9, t, -0.13), 0.0),
        turn=lambda t: (0.0, 0.0, 10 * sine(1.9, t)),
    )
    m.wave(
        m.arrive,
        m.leave,
        hand="other",
        curl=lambda t: 9 * sine(2.3, t, 0.2),
        shift=lambda t: (0.006 * sine(1.9, t, -0.2), -0.016 * sine(1.9, t, -0.05), 0.0),
    )


def _bite_nails(m: Move) -> None:
    m.body(m.start, 0.35, shoulders=5, curl=4, head_roll=-5, side=-3)
    m.hand("main", m.after(0.03), 0.4, "bite")
    m.wave(
        m.arrive,
        m.leave,
        hand="main",
        shift=lambda t: (0.0, 0.009 * sine(4.2, t), 0.0),
        curl=lambda t: 9 * sine(4.2, t, 0.04),
    )


def _rub_arms(m: Move) -> None:
    m.body(m.start, 0.4, curl=4, shoulders=5)
    m.hand("main", m.start, 0.45, "hug_in")
    m.hand("other", m.after(0.04), 0.48, "hug_out")
    m.wave(m.arrive, m.leave, hand="other", shift=lambda t: (0.0, -0.020 * sine(1.7, t, 0.1), 0.0))
    m.wave(m.arrive, m.leave, hand="main", shift=lambda t: (0.0, 0.012 * sine(1.7, t), 0.0))


def _flinch(m: Move) -> None:
    m.body(
        m.start,
        0.17,
        forward=-0.03,
        up=-0.035,
        lean=-4,
        curl=5,
        side=-9,
        shoulders=4,
        head_pitch=8,
        head_yaw=16,
        head_roll=-12,
    )
    m.hand("main", m.start, 0.26, "shield_a")
    m.hand("other", m.after(0.04), 0.29, "shield_b")
    m.tremble(m.arrive, m.leave, 0.8)


def _clap(m: Move) -> None:
    m.body(m.start, 0.35, lift=3, head_pitch=-3, head_roll=4)
    m.hand("both", m.start, 0.4, "clap")
    m.wave(
        m.arrive,
        m.leave,
        fade=0.1,
        hand="both",
        shift=lambda t: (0.060 * (0.5 - 0.5 * np.cos(2 * np.pi * 2.6 * t)), 0.010 * np.cos(2 * np.pi * 1.3 * t), 0.0),
        up=lambda t: 0.012 * np.abs(sine(0.75, t)),
        head_roll=lambda t: 5 * sine(0.7, t),
    )


def _hands_to_cheeks(m: Move) -> None:
    m.body(m.start, 0.4, shoulders=7, head_roll=6, side=5, head_pitch=-1)
    m.hand("both", m.start, 0.45, "cheek")
    m.wave(
        m.arrive,
        m.leave,
        fade=0.25,
        side=lambda t: -8 * sine(0.95, t),
        head_roll=lambda t: -11 * sine(0.95, t, 0.07),
        up=lambda t: 0.010 * np.abs(sine(0.95, t)),
        twist=lambda t: 4 * sine(0.95, t),
    )


def _smooth_cloth(m: Move) -> None:
    m.body(m.start, 0.5, lean=5, head_pitch=13, head_yaw=4)
    m.hand("main", m.start, 0.5, "cloth_in")
    # Out along the cloth and back, with long strokes.
    m.wave(
        m.arrive,
        m.leave,
        fade=0.3,
        hand="main",
        shift=lambda t: (0.075 - 0.075 * np.cos(2 * np.pi * 0.52 * t), 0.0, 0.02 * sine(0.52, t)),
    )


def _stroke_item(m: Move) -> None:
    m.body(m.start, 0.7, head_pitch=5, head_yaw=5, lean=2)
    m.hand("main", m.start, 0.7, "limp_a", shift=(0.02, 0.0, 0.04))
    m.wave(
        m.arrive,
        m.leave,
        fade=0.6,
        hand="main",
        curl=lambda t: 6 * sine(0.38, t),
        shift=lambda t: (0.030 * sine(0.38, t), 0.0, 0.012 * sine(0.38, t, -0.3)),
    )


def _retch(m: Move) -> None:
    m.body(m.start, 0.3, lean=14, curl=13, head_pitch=18, shoulders=9, shoulders_forward=6, neck=8, head_yaw=-5)
    m.hand("main", m.start, 0.34, "mouth")
    m.hand("other", m.after(0.05), 0.42, "belly")
    m.wave(
        m.arrive,
        m.leave,
        fade=0.06,
        curl=lambda t: 6 * pulse(2.0, t),
        shoulders=lambda t: 5 * pulse(2.0, t),
        head_pitch=lambda t: 7 * pulse(2.0, t - 0.05),
        up=lambda t: -0.012 * pulse(2.0, t),
    )


def _wipe_hand(m: Move) -> None:
    m.body(m.start, 0.4, head_pitch=12, head_yaw=7, twist=3)
    m.hand("main", m.start, 0.42, "apron")
    m.wave(m.arrive, m.leave, hand="main", shift=lambda t: (0.010 * sine(1.5, t), 0.050 * sine(1.5, t), 0.0))


def _flick_hand(m: Move) -> None:
    m.body(m.start, 0.35, head_pitch=6, head_yaw=12, head_roll=6, side=3, twist=6)
    m.hand("main", m.start, 0.35, "flick")
    m.wave(
        m.arrive,
        m.leave,
        fade=0.08,
        hand="main",
        shift=lambda t: (0.012 * sine(4.2, t), 0.018 * sine(4.2, t, -0.1), 0.0),
        turn=lambda t: (0.0, 28 * sine(4.2, t), 0.0),
    )


def _touch_collar(m: Move) -> None:
    m.body(m.start, 0.4, head_pitch=5, head_roll=4, head_yaw=-4)
    m.hand("main", m.after(0.04), 0.5, "collar")
    m.wave(
        m.arrive,
        m.leave,
        hand="main",
        shift=lambda t: (0.008 * sine(1.9, t), 0.008 * sine(1.9, t, 0.1), 0.0),
        turn=lambda t: (0.0, 8 * sine(1.9, t), 0.0),
    )


def _hand_on_chest(m: Move) -> None:
    m.body(m.start, 0.45, curl=2, head_pitch=4, head_roll=-4)
    m.hand("main", m.start, 0.5, "heart")


def _stretch(m: Move) -> None:
    m.body(m.start, 0.7, lift=10, lean=-6, head_pitch=-10, side=-4, up=0.012, shoulders=8)
    m.hand("both", m.start, 0.5, "ready")
    m.hand("both", m.after(0.3), 0.65, "stretch")
    m.breathe((m.start, 0.3), (m.arrive, 1.7), (m.leave, 1.5), (m.end, 0.0))


def _touch_mouth(m: Move) -> None:
    m.body(m.start, 0.45, head_pitch=3, head_roll=4, head_yaw=-3)
    m.hand("main", m.after(0.06), 0.5, "lips")
    m.wave(m.arrive, m.leave, hand="main", shift=lambda t: (0.010 * sine(1.3, t), 0.003 * sine(2.6, t), 0.002))


def _yawn(m: Move) -> None:
    # The chest fills first, the head goes back with it, the hand comes late, and everything sinks afterwards.
    m.body(m.start, 0.8, lift=7, lean=-4, shoulders=7, head_pitch=-9, head_roll=5)
    m.hand("main", m.after(0.25), 0.55, "mouth")
    m.body(m.leave - 0.2, 0.5, m.stage.effort.settle, lift=-1, lean=1, shoulders=-4, head_pitch=4)
    m.breathe((m.start, 0.2), (m.arrive + 0.3, 2.0), (m.leave, 1.7), (m.end, -0.3))


def _look_at_watch(m: Move) -> None:
    m.hand("main", m.start, 0.5, "watch")
    m.body(m.after(0.1), 0.45, head_pitch=13, head_yaw=8, head_roll=3, shoulder_tilt=3)
    m.body(m.leave - 0.15, 0.3, head_pitch=-2, head_yaw=-3)


SELF_TOUCH: Mapping[str, Act] = MappingProxyType(
    {
        "touch_nose": Act(0.6, 0.55, _touch_nose),
        "cover_mouth": Act(0.5, 0.55, _cover_mouth),
        "gasp": Act(0.65, 0.6, _cover_both),
        "cover_nose": Act(0.5, 0.5, _hold_nose),
        "fan_nose": Act(0.45, 0.45, _fan_nose),
        "hair_stroke": Act(0.7, 0.6, _hair_stroke),
        "twirl_hair": Act(0.7, 0.6, _twirl_hair),
        "scratch_head": Act(0.65, 0.6, _scratch_head),
        "rub_nape": Act(0.7, 0.6, _rub_nape),
        "touch_brow": Act(0.65, 0.6, _touch_brow),
        "wipe_eye": Act(0.65, 0.6, _wipe_eye),
        "face_in_hands": Act(0.75, 0.8, _face_in_hands),
        "exhale": Act(0.55, 0.6, _exhale),
        "finger_tap": Act(0.45, 0.4, _finger_tap),
        "finger_drum": Act(0.1, 0.2, _finger_drum),
        "fist_drum": Act(0.4, 0.35, _fist_drum),
        "rub_hands": Act(0.5, 0.5, _rub_hands),
        "wring_hands": Act(0.45, 0.45, _wring_hands),
        "bite_nails": Act(0.45, 0.45, _bite_nails),
        "rub_arms": Act(0.5, 0.5, _rub_arms),
        "flinch": Act(0.34, 0.5, _flinch),
        "clap": Act(0.45, 0.45, _clap),
        "hands_to_cheeks": Act(0.5, 0.5, _hands_to_cheeks),
        "smooth_cloth": Act(0.55, 0.5, _smooth_cloth),
        "stroke_item": Act(0.75, 0.6, _stroke_item),
        "retch": Act(0.35, 0.5, _retch),
        "wipe_hand": Act(0.45, 0.45, _wipe_hand),
        "flick_hand": Act(0.4, 0.4, _flick_hand),
        "touch_collar": Act(0.55, 0.5, _touch_collar),
        "hand_on_chest": Act(0.55, 0.55, _hand_on_chest),
        "touch_mouth": Act(0.6, 0.55, _touch_mouth),
        "yawn": Act(0.9, 0.7, _yawn),
        "look_at_watch": Act(0.6, 0.5, _look_at_watch),
        "stretch": Act(0.9, 0.8, _stretch),
    }
)
"""Mannerisms by name."""
