"""The structs that Python and the compiled tick share: tick/tick.h, field by field."""

from __future__ import annotations

import numpy as np

from game.animation import channels as ch
from game.animation.reach import LIMB
from game.core.emotion_space import EMOTIONS

__all__ = [
    "BANK",
    "CALL",
    "CHARACTER",
    "EFFECT",
    "ELLIPSOID",
    "LAYER",
    "LAYERS",
    "RIGID",
    "ROW",
    "RUN",
    "SETUP",
    "SIGNAL",
    "STRUCTS",
    "UNIT",
    "VARIANT",
]

LAYERS = 3
"""Layers of behaviour: posture, gesture, mannerism, in any order."""
ROW = -(-ch.CHANNELS // 8) * 8
"""Numbers a row takes: whole vectors."""

_E, _PARTS, _HANDS = len(EMOTIONS), len(ch.PARTS), len(ch.HANDS)
_FRAMES = len(ch.CONTACT_FRAMES)
_POINTER = "u4"


def _struct(*fields: tuple[str, object] | tuple[str, object, object]) -> np.dtype[np.void]:
    return np.dtype(list(fields), align=True)


VARIANT = _struct(("first", "i4"), ("frames", "f4"), ("before_s", "f4"), ("after_s", "f4"))
UNIT = _struct(
    ("count", "i4", _E),
    ("stroke", "f4"),
    ("loop_first", "f4"),
    ("loop_frames", "f4"),
    ("owned", "i4"),
    ("frame", "i4", _HANDS),
    ("looks", "i4"),
    ("mix_slope", "f4", _E),
    ("mix_level", "f4", _E),
)
BANK = _struct(
    ("rows", _POINTER),
    ("units", _POINTER),
    ("variants", _POINTER),
    ("most_variants", "i4"),
    ("order", "i4", LAYERS),
    ("rows_per_s", "f4"),
    ("rest", "i4", LAYERS),
    ("rest_weight", "f4", (LAYERS, _E)),
)
RUN = _struct(("first", "i4"), ("count", "i4"), ("part", "i4"))
EFFECT = _struct(("cue", "i4"), ("channel", "i4"), ("amount", "f4"))
ELLIPSOID = _struct(("joint", "i4"), ("inverse", "f4", 3), ("middle", "f4", 3), ("near_square", "f4"))
SETUP = _struct(
    *((name, "f8", _E) for name in ("sway_pace", "breath_hz", "breath_depth", "sway", "tempo")),
    *((name, "f8", _E) for name in ("darts_per_s", "dart_size", "blinks_per_min", "arc")),
    ("sway_rate", "f8", 12),
    *((name, "f8") for name in ("transition_s", "eye_half_life_s", "mood_half_life_s", "blink_s")),
    *((name, "f8") for name in ("head_stiffness", "torso_stiffness")),
    *((name, "f4") for name in ("head_share", "torso_share", "eye_yaw_rad", "eye_pitch_rad", "nod_rad")),
    ("breath", "f4", 65),
    ("blink_at", "f4", 4),
    ("blink", "f4", 4),
    ("effect_count", "i4"),
    ("effects", EFFECT, 48),
    ("run_count", "i4"),
    ("runs", RUN, 20),
    ("joint", "i4", 19),
    ("parent", "i4", 19),
    ("offset", "f4", (19, 3)),
    ("frame_joint", "i4", _FRAMES),
    ("bones", "i4", (4, 4)),
    ("limbs", LIMB, 4),
    ("feet", "f4", (2, 3)),
    ("eyes", "f4", 3),
    ("body", ELLIPSOID, 6),
    ("point_radius", "f4", 7),
    ("reach_m", "f4", 8),
    ("table_top_m", "f4"),
    ("table_back_z_m", "f4"),
    ("table_front_z_m", "f4"),
)

LAYER = _struct(
    ("unit", "i4"),
    ("active", "i4"),
    ("first", "i4", _E),
    ("frames", "f4", _E),
    ("weight", "f4", _E),
    *((name, "f4") for name in ("before_s", "lead_rate", "after_rate", "hold_first", "hold_length", "held")),
    *((name, "f4") for name in ("loop_first", "loop_frames", "loop_times", "last", "elapsed_s", "lap", "rate")),
    ("row", "i4", _E),
    ("part", "f4", _E),
)
RIGID = _struct(("turn", "f4", 4), ("place", "f4", 3))
CHARACTER = _struct(
    ("key", "u8"),
    ("darts", "i8"),
    ("blinks", "i8"),
    ("phase", "f8", 12),
    *((name, "f8") for name in ("clock", "breaths", "dart_left_s", "blink_left_s", "blink_age_s")),
    ("head", "f4", 3),
    ("head_speed", "f4", 3),
    ("attention", "f4"),
    ("voice", "f4"),
    ("dart", "f4", 2),
    ("aim", "f4", 2),
    ("leap", "i4"),
    ("held", "f4", _E),
    ("layers", LAYER, LAYERS),
    ("known", "i4"),
    ("adopted", "i4"),
    ("owned", "i4", LAYERS),
    ("gate", "i4", LAYERS),
    ("frame", "i4", _HANDS),
    ("looks", "i4"),
    ("left", "f4", (2, _PARTS)),
    ("pace", "f4", (2, _PARTS)),
    ("offset", "f4", ROW),
    ("excess", "f4", ROW),
    ("bow", "f4", 6),
    ("row", "f4", ROW),
    ("frames", RIGID, _FRAMES),
    ("off", "f4", (2, _HANDS, 3)),
    ("rotation", "f4", (ch.JOINTS, 4)),
    ("root", "f4", 3),
    ("gaze", "f4", 2),
    ("blink", "f4"),
    ("breath", "f4"),
)
SIGNAL = _struct(
    ("emotion", "f8", _E),
    ("gaze_target", "f8", 3),
    ("speaking", "f8"),
    ("numbers", "f8", (LAYERS, 4 + _E)),
    ("unit", "i4", LAYERS),
    ("started", "i4", LAYERS),
)
CALL = "IIiIIIdiii"
"""Call: setup, bank, count, before, signals, after, dt_s, held, neutral, collide."""

STRUCTS = (VARIANT, UNIT, BANK, RUN, EFFECT, ELLIPSOID, SETUP, LAYER, CHARACTER, SIGNAL)
"""In the order in which the compiled side tells of them (tick/layout.c)."""
