"""Every screen, drawn without a window, driven by the same actions as the window's."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from game.app.input import Action
from game.app.play import Window, open_session
from game.app.screens import (
    EpilogueScreen,
    OutcomeScreen,
    SettingsScreen,
    TableScreen,
    TalkScreen,
    TitleScreen,
    WishListScreen,
)
from game.app.strings import load_strings
from game.core.errors import MissingPart
from game.render import Device, FontSet, level_named

pytestmark = pytest.mark.gl


@pytest.fixture
def window(tmp_path, monkeypatch) -> Iterator[Window]:
    monkeypatch.setenv("MCG_USER_FOLDER", str(tmp_path))
    device = Device.headless(640, 360)
    arguments = argparse.Namespace(language="en", stall="flea", seed=5, mode="full", overlay=False)
    made = Window(open_session(arguments), device, level=level_named("low"))
    yield made
    made.close()
    device.release()


def picture(window: Window) -> np.ndarray:
    window.draw()
    return window.renderer.read_pixels().astype(int)


def go(window: Window, *actions: Action, seconds: float = 0.3) -> None:
    for action in actions:
        window.draw()
        window.handle(action)
        for _ in range(round(seconds * 30)):
            window.advance(1 / 30)


def key(name: str) -> Action:
    return Action("key", key=name)


def hear_out(window: Window) -> None:
    for _ in range(80):
        if window.session.world.waiting or window.session.world.over:
            return
        go(window, Action("confirm"))
    raise AssertionError("the lines do not end")


def lowest_text(window: Window) -> float:
    """How far down the talk's words reach in letters twice as large, in both languages; design pixels of 720."""
    session, hud = window.session, window.renderer.hud
    settings, strings, write = session.settings, session.strings, hud.text
    reach: list[float] = []

    def text(words: str, x: float, y: float, **more: object) -> object:
        reach.append(y + hud.measure(words, more["size"], more.get("role", "body"))[1])
        return write(words, x, y, **more)

    session.settings, hud.text = replace(settings, ui_scale=2.0), text
    for language in ("en", "ja"):
        session.strings = load_strings(language)
        window.draw()
    session.settings, session.strings = settings, strings
    del hud.text
    assert len(reach) > 20
    return max(reach)


def test_a_whole_afternoon(window) -> None:
    assert isinstance(window.screen, TitleScreen)
    title = picture(window)
    go(window, Action("confirm"))
    assert isinstance(window.screen, WishListScreen)
    go(window, Action("confirm"))
    assert isinstance(window.screen, TableScreen)
    assert np.abs(picture(window) - title).mean() > 5
    go(window, key("2"))
    assert isinstance(window.screen, TalkScreen)
    hear_out(window)
    plain = picture(window)
    go(window, key("f1"), key("f2"), seconds=0.0)
    assert np.abs(picture(window) - plain)[:120, :150].mean() > 10
    go(window, key("f3"), seconds=0.0)
    assert np.abs(picture(window) - plain)[:250, :400].mean() > 20
    go(window, key("f1"), key("f2"), key("f3"), seconds=0.0)
    assert lowest_text(window) < 716, "the keys stay inside in the largest letters"
    window.session.settings = replace(window.session.settings, captions=True)
    assert np.abs(picture(window) - plain)[237:252, 100:300].mean() > 10, "the body in words"

    go(window, key("o"), Action("right"), Action("right", fast=True), Action("left"), Action("wheel", amount=1))
    go(window, key("1"))
    assert window.session.world.talk.bargain.offer > 0
    hear_out(window)
    if not window.session.world.over:
        go(window, key("p"), key("b"))
        hear_out(window)
    assert window.session.world.over
    go(window, Action("confirm"))
    assert isinstance(window.screen, OutcomeScreen)
    picture(window)
    talks = window.session.afternoon.talks
    go(window, Action("down"), Action("confirm"))
    assert isinstance(window.screen, EpilogueScreen)
    picture(window)
    go(window, Action("back"))
    assert isinstance(window.screen, TitleScreen)
    assert talks == 1


def test_settings_change_language_and_come_back(window, tmp_path) -> None:
    english = picture(window)
    go(window, Action("down"), Action("down"), Action("down"), Action("confirm"))
    assert isinstance(window.screen, SettingsScreen)
    go(window, Action("confirm"))
    assert window.session.settings.language == "ja"
    assert (tmp_path / "settings.json").exists()
    go(window, Action("back"))
    assert np.abs(picture(window) - english)[120:, :260].mean() > 5


@pytest.mark.parametrize("size", [(320, 180), (500, 500), (1000, 360), (360, 640)])
def test_any_shape_of_window(window, size) -> None:
    window.device.resize(*size)
    go(window, Action("confirm"), Action("confirm"), key("1"))
    hear_out(window)
    assert picture(window).shape == (size[1], size[0], 3)


def test_a_click_meets_what_is_drawn_there(window) -> None:
    window.draw()
    for place in ((224.0, 359.0), (224.0, 359.0)):
        action = Action("click", at=(place[0] / 2, place[1] / 2))
    go(window, action)
    assert isinstance(window.screen, WishListScreen)


def test_an_unreadable_save_is_kept_and_said(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("MCG_USER_FOLDER", str(tmp_path))
    (tmp_path / "autosave.json").write_text("{broken", encoding="utf-8")
    arguments = argparse.Namespace(language="en", stall="flea", seed=5, mode="full", overlay=False)
    session = open_session(arguments)
    assert "could not be read" in session.message
    assert (tmp_path / "autosave.unreadable.json").read_text(encoding="utf-8") == "{broken"


def test_every_character_of_both_languages_has_a_glyph(window) -> None:
    strings, script = load_strings("en"), window.session.assets.talk.script
    texts = [text for entry in strings.texts.values() for text in entry.values()]
    for node in script.nodes.values():
        texts += [t for say in node.says for line in say.lines for t in (line.text.en, line.text.ja)]
        texts += [t for choice in node.choices for line in choice.texts for t in (line.text.en, line.text.ja)]
    texts += [
        t for pool in script.pools.values() for c in pool for line in c.texts for t in (line.text.en, line.text.ja)
    ]
    try:
        fonts = FontSet.for_language("ja")
    except MissingPart as error:
        pytest.skip(str(error))
    assert fonts.missing("".join(texts), "body") == ""
    assert fonts.missing("".join(texts), "bold") == ""
