"""What can go wrong around the game does go wrong here; what was played is still there afterwards."""

from __future__ import annotations

import argparse
import builtins
import ctypes
import errno
import functools
import math
import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import moderngl
import pygame
import pytest

from game.app.input import Action
from game.app.loading import load_step_assets
from game.app.opening import AUTOSAVE, open_session
from game.app.play import play_until_closed
from game.app.recording import read_recording, record_session
from game.app.replay import open_replay
from game.app.saves import SavedGame, load_game, save_game
from game.app.session import Session, saved_game
from game.app.settings import CHOICES, Settings, load_settings, save_settings
from game.app.stage import load_stage
from game.app.talk import Choice
from game.app.window import Window
from game.app.world import TICK_S, Intent
from game.core.errors import BadInput, MissingPart
from game.render import Device, LostContext, level_named

SIZE = (320, 180)


once = functools.cache(load_step_assets)
stage_once = functools.cache(load_stage)


@pytest.fixture(autouse=True)
def user(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("MCG_USER_FOLDER", str(tmp_path / "user"))
    monkeypatch.setattr("game.app.opening.load_step_assets", once)
    monkeypatch.setattr("game.app.replay.load_step_assets", once)
    monkeypatch.setattr("game.app.market.load_stage", stage_once)
    return tmp_path / "user"


@pytest.fixture(scope="module")
def device() -> Iterator[Device]:
    made = Device.headless(*SIZE)
    yield made
    made.release()


def opened() -> Session:
    return open_session(argparse.Namespace(language="en", stall="flea", seed=5, mode="full", overlay=False))


@pytest.fixture
def window(device: Device) -> Iterator[Window]:
    made = Window(opened(), device, level=level_named("low"))
    made.session.taken_up = True
    yield made
    made.close()


def begin(window: Window) -> None:
    """A day, a talk, one move, as the screens would."""
    session = window.session
    session.open_day()
    session.begin_talk("vase")
    for _ in range(12):
        session.tick(Intent(proceed=True))
    talk = session.world.talk
    assert talk is not None
    move = next(choice.id for choice in talk.beat.choices if choice.available and choice.act != "offer")
    session.tick(Intent(choice=Choice(move)))


def kept(session: Session, user: Path) -> SavedGame:
    return load_game(user / AUTOSAVE, session.market.bazaar, session.market.talks())


# --- disks ---------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("broken", ["mkstemp", "fdopen", "fsync", "replace"])
def test_a_save_that_cannot_be_written_says_so_and_the_old_one_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, broken: str
) -> None:
    path = tmp_path / "save.json"
    session = opened()
    session.open_day()
    save_game(path, saved_game(session))
    before = path.read_bytes()
    session.pause()

    def fail(*args: object, **more: object) -> None:
        raise OSError(errno.ENOSPC if broken != "mkstemp" else errno.EROFS, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(tempfile if broken == "mkstemp" else os, broken, fail)
        with pytest.raises(BadInput, match=r"save\.json.*No space left") as caught:
            save_game(path, saved_game(session))
        said = save_settings(Settings(), tmp_path / "user")
    assert "\n" not in str(caught.value)
    assert said is not None
    assert "settings" in said
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir() if file.name.startswith(".save")] == []
    assert load_game(path, session.market.bazaar, session.market.talks()).afternoon.minutes == 0


def test_a_folder_that_is_no_folder_costs_the_save_and_not_the_game(window: Window, user: Path) -> None:
    user.parent.mkdir(exist_ok=True)
    user.write_text("in the way", encoding="utf-8")
    begin(window)
    window.handle(Action("quit"))
    assert "save" in window.session.message
    assert user.read_text(encoding="utf-8") == "in the way"
    assert not window.session.running


def test_settings_cut_at_every_byte_are_read_as_far_as_they_make_sense(tmp_path: Path) -> None:
    save_settings(Settings(language="ja", ui_scale=1.5), tmp_path)
    path = tmp_path / "settings.json"
    whole = path.read_bytes()
    for cut in range(len(whole)):
        path.write_bytes(whole[:cut])
        found, said = load_settings(tmp_path)
        assert found.language in CHOICES["language"]
        assert (said is None) == (cut == len(whole))
        assert path.read_bytes() == whole[:cut]


def test_a_save_cut_at_every_byte_is_refused_in_one_line_and_left_alone(tmp_path: Path) -> None:
    session = opened()
    session.open_day()
    session.begin_talk("vase")
    path = tmp_path / "save.json"
    save_game(path, saved_game(session))
    whole = path.read_bytes()
    bazaar, talks = session.market.bazaar, session.market.talks()
    for cut in range(len(whole)):
        path.write_bytes(whole[:cut])
        with pytest.raises(BadInput) as caught:
            load_game(path, bazaar, talks)
        assert "\n" not in str(caught.value)
    assert path.read_bytes() == whole[: len(whole) - 1]


# --- the window ----------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("ticks", [0, 1, 7, 40])
def test_closed_at_any_moment_nothing_is_lost(window: Window, user: Path, tmp_path: Path, ticks: int) -> None:
    session = window.session
    recorder = record_session(session, tmp_path / "play.jsonl", stall="flea")
    begin(window)
    for tick in range(ticks):
        session.tick(Intent(proceed=tick % 2 == 0))
    session.pause()
    window.handle(Action("quit"))
    recorder.close(session)
    assert not session.running
    saved = kept(session, user)
    assert saved.afternoon == session.afternoon
    assert saved.talk is not None
    assert session.world.talk is not None
    assert saved.talk.bargain == session.world.talk.bargain
    assert saved.talk.feeling.six == session.world.talk.feeling.six
    assert len(saved.marks) == len(session.world.marks)
    again, player = open_replay(read_recording(tmp_path / "play.jsonl"))
    while not player.done:
        again.tick(Intent())
    assert player.divergence is None


def test_a_lost_picture_ends_in_one_line_with_everything_kept(window: Window, user: Path, tmp_path: Path) -> None:
    session = window.session
    recorder = record_session(session, tmp_path / "play.jsonl", stall="flea")
    begin(window)

    def lost() -> None:
        raise moderngl.Error("context lost")

    with pytest.raises(MissingPart, match=r"context lost.*saved") as caught:
        play_until_closed(window, recorder, lost)
    assert "\n" not in str(caught.value)
    assert kept(session, user).talk is not None
    assert read_recording(tmp_path / "play.jsonl").whole


def destroy_context() -> None:
    """Take the present EGL context away, as the end of a driver or of a display does."""
    egl = ctypes.CDLL("libEGL.so.1")
    for name in ("eglGetCurrentDisplay", "eglGetCurrentContext"):
        getattr(egl, name).restype = ctypes.c_void_p
    egl.eglMakeCurrent.argtypes, egl.eglDestroyContext.argtypes = [ctypes.c_void_p] * 4, [ctypes.c_void_p] * 2
    display, context = egl.eglGetCurrentDisplay(), egl.eglGetCurrentContext()
    assert context
    assert egl.eglMakeCurrent(display, None, None, None)
    assert egl.eglDestroyContext(display, context)


@pytest.mark.gl
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="takes the context away through EGL")
def test_a_context_that_is_really_destroyed_ends_in_one_line_with_everything_kept(
    device: Device, user: Path, tmp_path: Path
) -> None:
    window = Window(opened(), Device.headless(*SIZE), level=level_named("low"))
    session = window.session
    session.taken_up = True
    recorder = record_session(session, tmp_path / "play.jsonl", stall="flea")
    begin(window)
    frames: list[int] = []

    def loop() -> None:
        while len(frames) < 9:
            window.advance(TICK_S)
            window.draw()
            frames.append(session.ticks)
            if len(frames) == 3:
                destroy_context()

    try:
        with pytest.raises(MissingPart, match=r"context was lost.*saved") as caught:
            play_until_closed(window, recorder, loop)
        with pytest.raises(LostContext):  # nor is a picture read that was never drawn
            window.renderer.read_pixels()
    finally:
        device.context.__enter__()  # the other tests' context is the present one again
    assert "\n" not in str(caught.value)
    assert len(frames) == 3
    assert kept(session, user).talk is not None
    assert read_recording(tmp_path / "play.jsonl").whole


def test_any_other_fault_still_keeps_game_and_recording(window: Window, user: Path, tmp_path: Path) -> None:
    recorder = record_session(window.session, tmp_path / "play.jsonl", stall="flea")
    begin(window)

    def broken() -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        play_until_closed(window, recorder, broken)
    assert kept(window.session, user).talk is not None
    assert read_recording(tmp_path / "play.jsonl").whole


@pytest.mark.parametrize("elapsed_s", [-3600.0, -1e-9, 1e12, math.inf, -math.inf, math.nan])
def test_a_clock_that_jumps_neither_stops_nor_floods_the_game(window: Window, elapsed_s: float) -> None:
    session = window.session
    before = session.ticks
    window.advance(elapsed_s)
    jumped = session.ticks - before
    assert 0 <= jumped <= 5
    for _ in range(10):
        window.advance(TICK_S)
    assert 10 <= session.ticks - before - jumped <= 11


def test_no_sound_device_is_needed(window: Window, monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def no_sound(name: str, *rest: object, **more: object) -> object:
        assert "mixer" not in name
        return real(name, *rest, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(builtins, "__import__", no_sound)
    begin(window)
    window.advance(TICK_S)
    window.draw()
    assert pygame.mixer.get_init() is None
