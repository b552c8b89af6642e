"""What a tick plays: rows of takes, loops, traces."""

from __future__ import annotations

import numpy as np
import pytest

from game.animation import channels as ch
from game.animation import rows as rw
from game.core import quaternion as quat
from game.core.errors import BadInput
from game.core.humanoid import REFERENCE
from game.embos import MotionUnit, UnitLibrary, Variant


def test_a_looped_span_has_no_seam() -> None:
    rng = np.random.default_rng(0)
    walk = np.cumsum(rng.normal(size=(90, ch.CHANNELS)) * 0.004, axis=0) + rw.REST_ROW
    loop = rw.seamless_loop(walk.astype(np.float32))
    np.testing.assert_array_equal(loop[0], loop[-1])
    steps = np.abs(np.diff(np.concatenate([loop, loop[1:3]]), axis=0))[:, : ch.ROOT.stop]
    assert steps.max() < 3 * np.abs(np.diff(walk, axis=0)).max()


def test_traces_of_a_unit_begin_and_end_with_nothing() -> None:
    count = 40
    u = np.linspace(0, 1, count)
    q = np.tile(quat.IDENTITY, (count, ch.JOINTS, 1))
    q[:, REFERENCE.index["chest"]] = quat.from_axis_angle(np.array([1.0, 0, 0]), 0.4 * np.sin(np.pi * u) + 0.2 * u)
    rows = rw.take_rows(q, np.tile(REFERENCE.rest_translation[0], (count, 1))).span(slice(None), np.array([2, 2]))
    added = rw.additive_rows(rows, np.zeros(len(ch.PARTS), dtype=bool), 1.0)
    chest = added[:, 4 * REFERENCE.index["chest"]]
    np.testing.assert_allclose(chest[[0, -1]], 0.0, atol=1e-6)
    np.testing.assert_allclose(chest[count // 2], np.sin(0.2), atol=0.01)
    assert not added[:, ch.WRIST].any()


def test_units_without_motion_or_with_unknown_contacts_are_refused(library: UnitLibrary) -> None:
    from game.animation.motion_bank import bake

    seven = np.full(7, 0.5)
    bare = MotionUnit("bare", "posture", seven, seven, seven)
    with pytest.raises(BadInput, match="bare"):
        bake(UnitLibrary([bare]), ("posture",))
    span = (Variant(2, "joy", 0.0, 2.0, 0.0, 2.0),)
    odd = MotionUnit("odd", "posture", seven, seven, seven, contacts={"left_hand": "moon"}, variants=span)
    with pytest.raises(BadInput, match=r"moon.*|table"):
        bake(UnitLibrary([odd], library.clips), ("posture",))
