"""What the compiled tick knows of any character: figure, body, table, and how feelings show in what never stops."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import channels as ch
from game.animation import collision, figure
from game.animation.liveliness import BLINK, BREATH, EFFECTS, SWAY_HZ, LifeConfig
from game.animation.reach import ARM, STRAIGHT, limb_table
from game.animation.tick_data import ELLIPSOID, RUN, SETUP
from game.core.humanoid import HEAD_CENTRE_OFFSET, REFERENCE, TABLE_FRONT_Z_M, TABLE_TOP_M

__all__ = ["setup_of"]

Table = NDArray[np.void]

_SAME = (
    *("sway_pace", "tempo", "darts_per_s", "dart_size", "blinks_per_min", "arc", "transition_s", "eye_half_life_s"),
    *("mood_half_life_s", "blink_s", "head_share", "torso_share", "eye_yaw_rad", "eye_pitch_rad", "nod_rad"),
)
"""What is handed on as it is configured."""
_TOUCH_M = 0.03
"""More than any point's radius and the distance at which a push begins."""


def setup_of(life: LifeConfig) -> Table:
    """(1,) SETUP."""
    setup = np.zeros(1, dtype=SETUP)
    for name in _SAME:
        setup[name] = getattr(life, name)
    setup["breath_hz"] = life.breath_per_min / 60.0
    setup["breath_depth"] = life.breath_depth * life.breath_share
    setup["sway"] = life.sway * life.sway_share
    setup["sway_rate"] = 2.0 * np.pi * SWAY_HZ
    setup["head_stiffness"], setup["torso_stiffness"] = life.stiffness
    setup["breath"], (setup["blink_at"], setup["blink"]) = BREATH, BLINK
    setup["effect_count"] = len(EFFECTS)
    setup["effects"][0, : len(EFFECTS)] = EFFECTS
    runs = _runs()
    setup["run_count"] = len(runs)
    setup["runs"][0, : len(runs)] = runs
    setup["joint"], setup["parent"] = figure.FIGURE, figure.PARENTS
    setup["offset"] = REFERENCE.rest_translation[figure.FIGURE]
    setup["frame_joint"] = [-1, *(figure.WHERE[name] for name in ch.CONTACT_FRAMES[1:])]
    setup["bones"] = figure.BONES.reshape(4, 4).T
    reach = np.array([ARM, ARM, STRAIGHT, STRAIGHT])
    setup["limbs"] = limb_table(figure.BONE_LENGTHS[0], figure.BONE_LENGTHS[1], reach)
    setup["feet"], setup["eyes"] = figure.FEET_WORLD, HEAD_CENTRE_OFFSET
    setup["body"] = _body()
    setup["point_radius"] = collision.POINT_RADII
    setup["reach_m"][0, : len(collision.POINT_RADII)] = collision.POINT_RADII - collision.TOLERANCE_M
    setup["table_top_m"], setup["table_front_z_m"] = TABLE_TOP_M, TABLE_FRONT_Z_M
    setup["table_back_z_m"] = collision.TABLE_BACK_Z_M
    return setup


def _runs() -> Table:
    """RUN of neighbouring channels of one part and one kind."""
    edges = {0, ch.ROTATION.stop, ch.PALM.stop, ch.WRIST.stop, ch.ROOT.stop, ch.CHANNELS}
    edges |= set((np.flatnonzero(np.diff(ch.PART_OF_CHANNEL)) + 1).tolist())
    bounds = sorted(edges)
    rows: list[Any] = [(a, b - a, ch.PART_OF_CHANNEL[a]) for a, b in pairwise(bounds)]
    return np.array(rows, dtype=RUN)


def _body() -> Table:
    """ELLIPSOID of the parts of the body that hands stay out of."""
    body = np.zeros(len(collision.BODY), dtype=ELLIPSOID)
    for row, (joint, centre, radii) in zip(body, collision.BODY, strict=True):
        row["joint"], row["inverse"] = figure.WHERE[joint], np.divide(1.0, radii)
        # What contacts.c takes for the distance is at least (norm − 1) · the least radius.
        row["near_square"] = (1.0 + _TOUCH_M / min(radii)) ** 2
        row["middle"] = (REFERENCE.rest_model[REFERENCE.index[joint], :3, 3] - centre) / radii
    return body
