"""What players expect: history, auto-forward, skipping, taking back, slots with pictures, pads, high contrast."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pygame
import pytest

from game.app.input import Action
from game.app.opening import open_session
from game.app.pad import Pads
from game.app.reading import ReadLines, load_read, save_read
from game.app.screens import HistoryScreen, SlotsScreen, TalkScreen, TitleScreen
from game.app.slots import SLOTS, look_into, small
from game.app.window import Window
from game.render import Device, level_named

KEYS = frozenset({"tab", "backspace", "f6", "f7"})


@pytest.fixture
def window(tmp_path, monkeypatch) -> Iterator[Window]:
    monkeypatch.setenv("MCG_USER_FOLDER", str(tmp_path))
    device = Device.headless(320, 180)
    arguments = argparse.Namespace(language="en", stall="flea", seed=5, mode="full", overlay=False)
    made = Window(open_session(arguments), device, level=level_named("low"))
    yield made
    made.close()
    device.release()


def go(window: Window, *actions: Action | str, seconds: float = 0.2) -> None:
    for action in actions:
        window.draw()
        if isinstance(action, str):
            action = Action("key", key=action) if len(action) == 1 or action in KEYS else Action(action)
        window.handle(action)
        run(window, seconds)


def run(window: Window, seconds: float) -> None:
    for _ in range(round(seconds * 30)):
        window.advance(1 / 30)


def to_talk(window: Window, item: str = "1") -> None:
    go(window, "confirm", "confirm", item)
    assert isinstance(window.screen, TalkScreen)


def hear_out(window: Window) -> None:
    for _ in range(80):
        if window.session.world.waiting or window.session.world.over:
            return
        go(window, "confirm", seconds=0.1)
    raise AssertionError("the lines do not end")


@pytest.mark.gl
def test_words_can_be_taken_back_as_often_as_there_are_choices(window) -> None:
    to_talk(window)
    hear_out(window)
    session = window.session
    first = session.world.talk
    go(window, "1")
    hear_out(window)
    go(window, "o", "2")
    assert len(session.world.marks) == 3
    go(window, "backspace", "backspace")
    assert session.world.talk is first
    assert session.world.waiting
    assert len(session.world.marks) == 1
    assert session.afternoon.taken_back == 2
    go(window, "backspace")
    assert session.afternoon.taken_back == 2, "before the first word there is nothing to take back"
    assert not session.designed, "it is the player's right, not the designer's hand"
    go(window, "3")
    assert len(session.world.marks) == 2


@pytest.mark.gl
def test_quick_save_and_load_bring_the_talk_back_with_its_picture(window, tmp_path) -> None:
    to_talk(window)
    hear_out(window)
    go(window, "t", "1")
    hear_out(window)
    session = window.session
    before, marks = session.world.talk, session.world.marks
    go(window, "f6")
    info = look_into(tmp_path, "quick")
    assert info.talking
    assert info.day == 1
    assert info.picture is not None
    assert info.picture.std() > 15
    go(window, "2")
    assert session.world.talk is not before
    go(window, "f7")
    assert session.world.talk.bargain == before.bargain
    assert session.world.talk.feeling.six == before.feeling.six
    assert [m.guess for m in session.world.marks] == [m.guess for m in marks] == ["", "anger"]
    assert isinstance(window.screen, TalkScreen)


@pytest.mark.gl
def test_slots_are_written_and_read_by_keys_alone(window, tmp_path) -> None:
    to_talk(window)
    go(window, "back")
    assert isinstance(window.screen, TitleScreen)
    go(window, "down", "down", "confirm")  # continue, play, save
    assert isinstance(window.screen, SlotsScreen)
    go(window, "right", "confirm")  # from the quick slot to the first of the six
    assert isinstance(window.screen, SlotsScreen)
    written = [name for name in SLOTS if (tmp_path / f"{name}.json").exists() and name != "autosave"]
    assert written == ["slot1"]
    (tmp_path / "slot2.json").write_text("{broken", encoding="utf-8")
    assert look_into(tmp_path, "slot2").unreadable
    go(window, "back", "down", "confirm")
    assert isinstance(window.screen, SlotsScreen)
    window.draw()
    names = [b.id for b in window.screen._buttons.buttons if b.enabled]
    assert names == ["autosave", "slot1", "back"], "what is empty or broken cannot be taken up"
    go(window, "right", "confirm")
    assert isinstance(window.screen, TalkScreen)


@pytest.mark.gl
def test_lines_go_on_by_themselves_and_what_was_read_can_be_skipped(window, tmp_path) -> None:
    session = window.session
    session.settings = replace(session.settings, auto_forward="fast")
    session.world = replace(session.world, text_speed="instant")
    to_talk(window)
    for _ in range(80):
        run(window, 0.0 if session.world.waiting else 0.5)
    assert session.world.waiting, "nobody pressed anything"
    said = [line.id for line in session.world.backlog]
    assert said
    assert all(session.read.has("flea", line) for line in said)
    go(window, "g")
    for _ in range(80):
        run(window, 0.0 if session.world.over else 0.5)
    save_read(session.read, tmp_path)
    assert load_read(tmp_path).has("flea", said[0])

    session.settings = replace(session.settings, auto_forward="off")
    new = ReadLines()
    session.read = new
    while not session.world.over:
        run(window, 0.5)
        go(window, "confirm")
    go(window, "confirm", "back", "2")
    go(window, "tab", seconds=3.0)
    assert not session.world.waiting, "new lines are not skipped …"
    session.settings = replace(session.settings, skip_unread=True)
    go(window, "tab", seconds=3.0)
    assert session.world.waiting, "… unless that is wanted"


@pytest.mark.gl
def test_the_history_shows_what_was_said(window) -> None:
    to_talk(window)
    hear_out(window)
    go(window, "1")
    hear_out(window)
    window.draw()
    before = window.renderer.read_pixels().astype(int)
    go(window, "h")
    assert isinstance(window.screen, HistoryScreen)
    window.draw()
    assert np.abs(window.renderer.read_pixels() - before).mean() > 15
    go(window, "up", "up", Action("wheel", amount=-1))
    assert window.screen.back == min(1, len(window.session.world.backlog) - 1)
    go(window, "h")
    assert isinstance(window.screen, TalkScreen)


@pytest.mark.gl
def test_high_contrast_draws_black_on_white(window) -> None:
    go(window, "confirm", "confirm")
    window.draw()
    soft = window.renderer.read_pixels().astype(int)
    window.session.settings = replace(window.session.settings, high_contrast=True)
    window.draw()
    hard = window.renderer.read_pixels().astype(int)
    column = hard[30:160, 236:300].reshape(-1, 3)
    assert (column.min(axis=1) >= 250).mean() > (soft[30:160, 236:300].reshape(-1, 3).min(axis=1) >= 250).mean() + 0.2


def test_a_pad_does_what_keys_do() -> None:
    pads = Pads()

    def event(kind: int, **values) -> pygame.event.Event:
        return pygame.event.Event(kind, values)

    def button(number: int) -> Action | None:
        return pads.action_of(event(pygame.CONTROLLERBUTTONDOWN, button=number, instance_id=0))

    assert button(pygame.CONTROLLER_BUTTON_A) == Action("confirm")
    assert button(pygame.CONTROLLER_BUTTON_B) == Action("back")
    assert button(pygame.CONTROLLER_BUTTON_DPAD_DOWN) == Action("down")
    assert button(pygame.CONTROLLER_BUTTON_RIGHTSHOULDER) == Action("key", key="t")
    assert button(999) is None

    def stick(value: float, axis: int = pygame.CONTROLLER_AXIS_LEFTX) -> Action | None:
        return pads.action_of(event(pygame.CONTROLLERAXISMOTION, axis=axis, value=round(value * 32767), instance_id=0))

    pushes = [stick(v) for v in (0.2, 0.7, 0.9, 0.5, 0.8, 0.1, 0.8, -0.9)]
    kinds = [None if a is None else a.kind for a in pushes]
    assert kinds == [None, "right", None, None, None, None, "right", "left"], "once a push, whatever it trembles"
    assert stick(1.0, pygame.CONTROLLER_AXIS_TRIGGERLEFT) == Action("key", key="backspace")
    assert pads.action_of(event(pygame.KEYDOWN, key=pygame.K_a)) is None


@pytest.mark.gl
def test_a_talk_is_played_with_a_pad_alone(window) -> None:
    pads = Pads()

    def press(*numbers: int) -> None:
        for number in numbers:
            action = pads.action_of(pygame.event.Event(pygame.CONTROLLERBUTTONDOWN, {"button": number}))
            assert action is not None
            go(window, action, seconds=0.1)

    a, down, x = pygame.CONTROLLER_BUTTON_A, pygame.CONTROLLER_BUTTON_DPAD_DOWN, pygame.CONTROLLER_BUTTON_X
    press(a, a, down, a)
    assert isinstance(window.screen, TalkScreen)
    assert window.session.world.talk.item == list(window.session.assets.talk.script.items)[1]
    for _ in range(80):
        if window.session.world.waiting:
            break
        press(a)
    press(pygame.CONTROLLER_BUTTON_RIGHTSHOULDER, x)
    assert window.session.world.marks[1].act == "wait"
    assert window.session.world.marks[1].guess == "anger"


@pytest.mark.parametrize("content", ["", "{", "[]", '{"flea": 3}', '{"flea": [1, 2]}', "[" * 3000])
def test_a_broken_list_of_read_lines_is_no_harm(tmp_path, content: str) -> None:
    (tmp_path / "read.json").write_text(content, encoding="utf-8")
    assert not load_read(tmp_path).has("flea", "hello")


@pytest.mark.parametrize(
    "content", ["", "{", "[]", '{"afternoon": 4}', '{"afternoon": {"purse": "x"}}', json.dumps({"afternoon": {}})]
)
def test_a_slot_that_cannot_be_read_says_so(tmp_path, content: str) -> None:
    (tmp_path / "slot3.json").write_text(content, encoding="utf-8")
    info = look_into(tmp_path, "slot3")
    assert info.unreadable
    assert info.day == 0


@pytest.mark.parametrize("size", [(90, 160), (288, 512), (720, 1280), (1000, 300)])
def test_thumbnails_of_any_picture(size) -> None:
    picture = np.full((*size, 3), 77, np.uint8)
    assert np.all(small(picture) == 77)
    assert small(picture).shape[1] <= 256
