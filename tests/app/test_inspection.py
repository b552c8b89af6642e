"""Looking at a thing: the hand that turns it, the pointer that finds it, the screen that shows it."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

import numpy as np
import pytest

from game.app.handling import Handling
from game.app.input import Action
from game.app.opening import open_session
from game.app.picking import Picker
from game.app.screens import InspectScreen, TableScreen, TalkScreen
from game.app.stage import load_stage
from game.app.window import Window
from game.render import HERO, Device, level_named

STALLS = {"flea": "mira", "antiques": "mira", "toys": "mira"}


def test_a_thrown_turn_goes_on_and_dies_away() -> None:
    hand = Handling()
    hand.grab((400.0, 300.0))
    for x in range(410, 500, 10):
        hand.drag((float(x), 300.0))
        hand.tick(1 / 30)
    thrown = hand.yaw_rad
    assert not hand.let_go()
    hand.tick(1 / 30)
    step = hand.yaw_rad - thrown
    assert step > 0.02
    for _ in range(120):
        hand.tick(1 / 30)
    resting = hand.yaw_rad
    hand.tick(1 / 30)
    assert hand.yaw_rad == resting
    assert resting > thrown + 5 * step


def test_with_reduced_motion_it_stops_with_the_hand() -> None:
    hand = Handling()
    hand.grab((0.0, 0.0))
    for x in range(10, 100, 10):
        hand.drag((float(x), 0.0))
        hand.tick(1 / 30, reduced_motion=True)
    hand.let_go()
    before = hand.yaw_rad
    hand.tick(1 / 30, reduced_motion=True)
    assert hand.yaw_rad == before


def test_it_cannot_be_tipped_over_nor_zoomed_away() -> None:
    hand = Handling()
    for _ in range(40):
        hand.nudge(0.0, 1.0)
        hand.zoom_by(3)
    assert hand.pitch_rad < np.pi / 2
    assert hand.zoom < 3.0
    for _ in range(80):
        hand.nudge(0.0, -1.0)
        hand.zoom_by(-3)
    assert hand.pitch_rad > -np.pi / 4
    assert hand.zoom > 0.5


def test_a_click_in_place_is_told_from_a_drag() -> None:
    hand = Handling()
    hand.grab((10.0, 10.0))
    hand.drag((12.0, 10.0))
    assert hand.let_go()
    hand.grab((10.0, 10.0))
    hand.drag((60.0, 10.0))
    assert not hand.let_go()
    assert not hand.let_go(), "letting go of nothing is no click"


@pytest.mark.parametrize("stall", sorted(STALLS))
def test_every_item_is_found_where_it_is_seen(stall) -> None:
    stage = load_stage(STALLS[stall], stall)
    picker = Picker.of(stage.stall, stage.cards, HERO, (1280.0, 720.0))
    world_to_clip = HERO.view_projection(16 / 9)
    for group, anchor in stage.stall.anchors.items():
        item = group.removeprefix("item:")
        left, top, right, bottom = picker.box(item)
        clip = world_to_clip @ np.array([*anchor, 1.0])
        foot = (clip[0] / clip[3] * 0.5 + 0.5) * 1280.0
        assert left < foot < right
        middle = ((left + right) / 2, top + 0.25 * (bottom - top))
        assert picker.at(middle) is not None
        others = frozenset(picker.outlines) - {item}
        assert picker.at(middle, others) == item
        assert picker.at(middle, others | {item}) is None
    assert picker.at((640.0, 200.0)) is None, "the shopkeeper's face is not for sale"


@pytest.fixture(scope="module")
def window(tmp_path_factory) -> Iterator[Window]:
    patch = pytest.MonkeyPatch()
    patch.setenv("MCG_USER_FOLDER", str(tmp_path_factory.mktemp("user")))
    device = Device.headless(640, 360)
    arguments = argparse.Namespace(language="en", stall="flea", seed=5, mode="full", overlay=False)
    made = Window(open_session(arguments), device, level=level_named("low"))
    yield made
    made.close()
    device.release()
    patch.undo()


def picture(window: Window) -> np.ndarray:
    window.draw()
    return window.renderer.read_pixels().astype(int)


def do(window: Window, *actions: Action, ticks: int = 2) -> None:
    for action in actions:
        window.draw()
        window.handle(action)
        for _ in range(ticks):
            window.advance(1 / 30 + 1e-6)


@pytest.mark.gl
def test_open_turn_zoom_close_from_the_table(window) -> None:
    window.screen = TableScreen()
    do(window, Action("pointer", at=(2.0, 2.0)), ticks=70)
    table = picture(window)
    do(window, Action("key", key="i"))
    assert isinstance(window.screen, InspectScreen)
    first = next(iter(window.session.assets.talk.script.items))
    assert window.screen.item == first
    front = picture(window)
    assert np.abs(front - table).mean() > 10
    do(
        window,
        Action("click", at=(320.0, 150.0)),
        Action("pointer", at=(420.0, 150.0)),
        Action("pointer", at=(460.0, 150.0)),
    )
    do(window, Action("release", at=(460.0, 150.0)))
    assert isinstance(window.screen, InspectScreen), "a drag does not put it back"
    turned = picture(window)
    assert np.abs(turned - front)[60:230, 200:440].mean() > 4
    for _ in range(90):
        window.advance(1 / 30 + 1e-6)
    do(window, Action("wheel", amount=3), Action("left"))
    assert np.abs(picture(window) - turned)[40:230, 160:480].mean() > 4
    do(window, Action("back"))
    assert isinstance(window.screen, TableScreen)
    assert np.abs(picture(window) - table)[200:, :160].mean() < 3, "the table as it was"


@pytest.mark.gl
def test_a_click_on_the_goods_selects_them_and_a_second_one_takes_them_up(window) -> None:
    window.screen = TableScreen()
    do(window, Action("pointer", at=(2.0, 2.0)), ticks=70)
    picker = window.picker()
    left, top, right, bottom = picker.box("vase")
    place = ((left + right) / 4, (top + bottom) / 4)  # the window is half as large as the reference
    do(window, Action("pointer", at=place))
    assert window.session.pointed == "vase"
    do(window, Action("click", at=place))
    assert isinstance(window.screen, TableScreen)
    do(window, Action("click", at=place))
    assert isinstance(window.screen, InspectScreen)
    assert window.screen.item == "vase"
    do(window, Action("click", at=(320.0, 100.0)), Action("release", at=(320.0, 100.0)))
    assert isinstance(window.screen, TableScreen), "a click in place puts it back"


@pytest.mark.gl
def test_in_a_talk_the_thing_talked_about_can_be_taken_up(window) -> None:
    window.screen = TableScreen()
    do(window, Action("key", key="2"))
    assert isinstance(window.screen, TalkScreen)
    talk = window.screen
    item = window.session.world.talk.item
    do(window, Action("key", key="i"))
    assert isinstance(window.screen, InspectScreen)
    assert window.screen.item == item
    picture(window)
    do(window, Action("confirm"))
    assert window.screen is talk
