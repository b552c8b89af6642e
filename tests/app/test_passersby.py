"""The crowd: ways that follow from the time alone, one batch through the engine, people behind the stall only."""

from __future__ import annotations

from copy import copy
from dataclasses import replace

import numpy as np
import pytest

from game.animation import Performer
from game.app.loading import load_step_assets
from game.app.passersby import Passersby, load_cast
from game.app.stage import load_stage
from game.app.step import new_world
from game.app.strolls import LAP_S, Strolls
from game.core import MissingPart
from game.embos import Planner, UnitLibrary
from game.render import Device, FrameView, Renderer, level_named
from game.render.crowd import DRESS


@pytest.fixture(scope="module")
def assets():
    return load_step_assets()


@pytest.fixture(scope="module")
def cast():
    return load_cast("mira")


def crowd(assets, cast, seed: int = 1, seconds: float = 0.0, world=None) -> Passersby:
    made = Passersby(cast, assets.planner, assets.performer, seed)
    for tick in range(round(seconds * 30)):
        made.tick(replace(world or new_world(assets, 1), tick=tick))
    return made


def test_where_people_are_does_not_depend_on_how_one_got_there() -> None:
    times = np.linspace(0.0, 4 * LAP_S, 97)
    once = Strolls(8, 5)
    forward = [once.place(3, t) for t in times]
    assert forward == [Strolls(8, 5).place(3, t) for t in reversed(times)][::-1]
    assert forward != [Strolls(8, 6).place(3, t) for t in times]


def test_nobody_jumps_where_they_can_be_seen() -> None:
    strolls, step_s = Strolls(8, 2), 1 / 30
    for who in range(8):
        places = [strolls.place(who, i * step_s) for i in range(round(5 * LAP_S / step_s))]
        x, speed = np.array([p.x for p in places]), np.array([p.speed for p in places])
        seen = (np.abs(x[:-1]) < 4.6) | (np.abs(x[1:]) < 4.6)
        assert seen.mean() > 0.3, "mostly on stage"
        assert np.abs(np.diff(x))[seen].max() < 0.95 * step_s
        # The legs' speed is the body's: otherwise feet would slide.
        moved = np.abs(np.diff(x)) / step_s
        np.testing.assert_allclose(moved[seen], 0.5 * (speed[:-1] + speed[1:])[seen], atol=0.03)
        turned = np.abs((np.diff([p.yaw_rad for p in places]) + np.pi) % (2 * np.pi) - np.pi)
        assert turned[seen].max() < 0.15, "radians a tick"
        assert (speed == 0.0).any(), "they stop to browse"


def test_other_units_are_taken_up_from_where_everybody_stands(assets, cast) -> None:
    one = crowd(assets, cast, seconds=1.0)
    other = copy(one)
    world = replace(new_world(assets, 1), tick=30)
    units = [u for u in assets.planner.library.units if u.layer != "posture" or u.name == "upright"]
    library = UnitLibrary(units, assets.planner.library.clips)
    other.take_up(Planner(library, assets.planner.config), Performer(library))
    apart = []
    for tick in range(20):
        now = replace(world, tick=30 + tick)
        one.tick(now)
        other.tick(now)
        apart.append(max(float(np.abs(a - b).max()) for a, b in zip(one._after[0], other._after[0], strict=True)))
    assert apart[0] < 0.05, "nobody jumps"
    assert apart[-1] > 0.2, "but they move by other units"


def test_the_same_seed_moves_the_same_crowd(assets, cast) -> None:
    one, two = (crowd(assets, cast, seconds=2.0).view(0.5) for _ in range(2))
    assert all(np.array_equal(a, b) for a, b in zip(one.matrices, two.matrices, strict=True))
    assert all(np.isfinite(m).all() for m in one.matrices)
    other = crowd(assets, cast, seed=2, seconds=2.0).view(0.5)
    assert not np.array_equal(one.place, other.place)


def test_frames_between_two_ticks_lie_between_them(assets, cast) -> None:
    made = crowd(assets, cast, seconds=1.0)
    before, half, after = (made.view(share).place for share in (0.0, 0.5, 1.0))
    np.testing.assert_allclose(half, 0.5 * (before + after), atol=1e-9)
    assert np.abs(after - before).max() > 0.01


def test_a_loud_reaction_turns_the_heads_of_those_near(assets, cast) -> None:
    world = replace(new_world(assets, 1), talk=object(), burst_s=0.0)
    loud = replace(world, shown_target=np.eye(7)[0])
    calm = replace(world, shown_target=np.eye(7)[6])
    a, b = (crowd(assets, cast, seconds=1.5, world=w).view(1.0) for w in (calm, loud))
    turned = [float(np.abs(m - n).max()) for m, n in zip(a.matrices, b.matrices, strict=True)]
    near = np.abs(a.place[:, 0]) < 3.0
    assert max(np.array(turned)[near]) > 0.1
    # A hundredth of a millimetre: in other company the same sums round in other ways.
    assert max(np.array(turned)[np.abs(a.place[:, 0]) > 4.5], default=0.0) < 1e-5


def test_passers_by_wear_different_colours(cast) -> None:
    looks = [look.lit.mean(axis=0) for look in cast.looks]
    apart = [np.abs(a - b).max() for i, a in enumerate(looks) for b in looks[:i]]
    assert min(apart) > 0.01
    assert all(len(look.mesh.triangle) < 9000 for look in cast.looks)


@pytest.mark.gl
def test_the_crowd_is_seen_behind_the_stall_only_and_not_at_the_lowest_level(assets, cast) -> None:
    try:
        device = Device.headless(640, 360)
    except MissingPart as error:
        pytest.skip(str(error))
    stage = load_stage()
    renderer = Renderer(device, None, stage.stall, stage.backdrop)
    renderer.meet(cast.looks)
    people = crowd(assets, cast, seconds=3.0).view(1.0)
    view = FrameView(np.zeros((60, 4, 4), np.float32))

    def shot(**more) -> np.ndarray:
        renderer.draw(replace(view, **more))
        assert device.context.error == "GL_NO_ERROR"
        return renderer.read_pixels().astype(int)

    try:
        empty, full = shot(), shot(crowd=people)
        assert np.array_equal(full, shot(crowd=people))
        nobody = replace(people, place=people.place + (40.0, 0.0, 0.0))
        assert np.array_equal(empty, shot(crowd=nobody))
        renderer.set_level(level_named("low"))
        assert np.array_equal(shot(), shot(crowd=people))
    finally:
        renderer.release()
        device.release()
    changed = np.abs(full - empty).max(axis=2) > 8
    assert changed.sum() > 1500
    rows = np.nonzero(changed)[0]
    assert rows.max() < 300, "the table hides their feet"
    assert rows.min() > 40, "nobody is a giant"
    assert not changed[305:].any()


def test_no_two_neighbours_look_alike_and_white_cloth_stays_white(cast) -> None:
    looks = cast.looks
    for one, other in zip(looks, looks[2:], strict=False):  # every second wears the same model
        assert one.mesh is other.mesh
        assert np.abs(one.lit - other.lit).max() > 0.15
    mesh = looks[0].mesh
    white = (mesh.lit.min(axis=1) > 0.8) & (mesh.dress == DRESS.index("top"))
    assert white.any()
    assert np.ptp(looks[0].lit[white], axis=1).max() < 0.3
    assert cast.tall_m[3] < 0.8 * np.median(cast.tall_m), "a child"
    assert np.ptp(cast.girth) > 0.1
