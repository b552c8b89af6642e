"""Photo mode: time stands still, the camera stays out of things, the picture is saved without the interface."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

import numpy as np
import pytest

from game.app.input import Action
from game.app.photo import EYE_HIGH, EYE_LOW, PhotoMode, fine_factor, photo_path, smaller
from game.app.play import Window, open_session
from game.app.shots import SHOTS, numbers_of
from game.core.errors import BadInput, MissingPart
from game.render import Device, level_named, load_picture


def photographer(**more) -> PhotoMode:
    return PhotoMode(SHOTS["talk"], **more)


def drag(x: float, y: float, **more) -> Action:
    return Action("pointer", at=(0.0, 0.0), move=(x, y), **{"held": "left"} | more)


def settle(mode: PhotoMode) -> PhotoMode:
    for _ in range(120):
        mode.advance(1 / 60)
    return mode


def test_it_begins_where_the_camera_is() -> None:
    np.testing.assert_allclose(numbers_of(photographer().camera()), numbers_of(SHOTS["talk"]), atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_the_camera_never_enters_things_however_wildly_it_is_dragged(seed: int) -> None:
    rng, mode = np.random.default_rng(seed), photographer()
    for _ in range(300):
        move = tuple(rng.normal(scale=300.0, size=2))
        kinds = (
            drag(*move, fast=bool(rng.random() < 0.4)),
            Action("wheel", amount=int(rng.integers(-6, 7))),
            drag(*move, held="middle"),
            Action(str(rng.choice(["left", "right", "up", "down"]))),
        )
        assert mode.handle(kinds[rng.integers(4)], 720.0)
        mode.advance(0.03)
        eye = np.array(mode.camera().eye)
        assert (eye >= EYE_LOW - 1e-6).all()
        assert (eye <= EYE_HIGH + 1e-6).all()
        assert 8.0 < mode.camera().fov_deg < 50.0


def test_the_camera_glides_alike_at_every_frame_rate() -> None:
    modes = [photographer(), photographer()]
    for mode in modes:
        mode.handle(drag(200.0, 40.0), 720.0)
    for _ in range(6):
        modes[0].advance(1 / 30)
    for _ in range(12):
        modes[1].advance(1 / 60)
    a, b = (numbers_of(mode.camera()) for mode in modes)
    np.testing.assert_allclose(a, b, atol=1e-9)
    assert np.abs(a - numbers_of(SHOTS["talk"])).max() > 0.1
    calm = photographer(reduced_motion=True)
    calm.handle(drag(200.0, 40.0), 720.0)
    calm.advance(1e-6)
    np.testing.assert_allclose(numbers_of(calm.camera()), numbers_of(settle(modes[0]).camera()), atol=2e-3)


def test_keys_switch_zoom_return_and_leave() -> None:
    mode = photographer()
    mode.handle(Action("key", key="+"), 720.0)
    assert settle(mode).camera().fov_deg < SHOTS["talk"].fov_deg
    mode.handle(Action("key", key="0"), 720.0)
    np.testing.assert_allclose(numbers_of(settle(mode).camera()), numbers_of(SHOTS["talk"]), atol=1e-6)
    fine, shown = mode.fine, mode.help
    mode.handle(Action("key", key="2"), 720.0)
    mode.handle(Action("key", key="h"), 720.0)
    assert (mode.fine, mode.help) == (not fine, not shown)
    assert not mode.handle(Action("key", key="f9"), 720.0)
    assert not mode.handle(Action("back"), 720.0)


def test_a_finer_picture_is_the_mean_of_its_pixels_and_not_too_large() -> None:
    picture = np.arange(4 * 6 * 3, dtype=np.uint8).reshape(4, 6, 3)
    assert smaller(picture, 1) is picture
    assert smaller(picture, 2)[0, 0, 0] == round((0 + 3 + 18 + 21) / 4 + 1e-9)
    assert fine_factor((1280, 720), True) == 2
    assert fine_factor((3840, 2160), True) == 1
    assert fine_factor((640, 360), False) == 1


def test_pictures_are_numbered_and_a_folder_that_cannot_be_made_is_named(tmp_path) -> None:
    assert photo_path(tmp_path / "a").name == "photo-0001.png"
    (tmp_path / "a" / "photo-0001.png").write_bytes(b"x")
    assert photo_path(tmp_path / "a").name == "photo-0002.png"
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(BadInput, match="file"):
        photo_path(tmp_path / "file" / "b")


@pytest.fixture
def window(tmp_path, monkeypatch) -> Iterator[Window]:
    monkeypatch.setenv("MCG_USER_FOLDER", str(tmp_path))
    try:
        device = Device.headless(320, 180)
    except MissingPart as error:
        pytest.skip(str(error))
    arguments = argparse.Namespace(language="en", stall="flea", seed=5, mode="full", overlay=False)
    made = Window(open_session(arguments), device, level=level_named("low"))
    yield made
    made.close()
    device.release()


@pytest.mark.gl
def test_time_stands_still_and_the_picture_is_saved_without_the_interface(window, tmp_path) -> None:
    window.draw()
    title = window.renderer.read_pixels().astype(int)
    window.handle(Action("key", key="f9"))
    tick = window.session.world.tick
    window.advance(2.0)
    assert window.session.world.tick == tick
    window.handle(Action("key", key="h"))
    window.draw()
    bare = window.renderer.read_pixels().astype(int)
    assert np.abs(bare - title)[60:160, :130].mean() > 5, "the title's buttons are gone"
    window.handle(Action("confirm"))
    saved = load_picture(tmp_path / "pictures" / "photo-0001.png").astype(int)
    assert saved.shape == (180, 320, 3)
    assert np.abs(saved - bare).mean() < 8.0
    assert "photo-0001.png" in window.photo.said
    window.handle(drag(60.0, 0.0))
    window.advance(1.0)
    window.draw()
    assert np.abs(window.renderer.read_pixels().astype(int) - bare).mean() > 5
    window.handle(Action("back"))
    window.advance(0.1)
    assert window.session.world.tick > tick
    assert window.session.running


@pytest.mark.gl
def test_a_picture_that_cannot_be_saved_is_said_and_the_game_goes_on(window, tmp_path) -> None:
    (tmp_path / "pictures").write_text("in the way")
    window.handle(Action("key", key="f9"))
    window.handle(Action("confirm"))
    assert "could not be saved" in window.photo.said
    window.draw()
