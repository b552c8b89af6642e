"""Whole frames: what is in them, what changes them, and that nothing leaks."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import moderngl
import numpy as np
import pytest
from numpy.typing import NDArray

from game.core import MissingPart
from game.face import tessellate
from game.face.params import face_params
from game.render import CLOSEUP, LEVELS, Camera, Device, FontSet, FrameView, Renderer, level_named
from game.render.bench_floor import BareScene

pytestmark = pytest.mark.gl
Pixels = NDArray[np.uint8]
FRONT = Camera((0.0, 0.95, 3.6), (0.0, 0.72, 0.0), 26.0)


@pytest.fixture(scope="module")
def renderer(device, model, stall, backdrop):
    made = Renderer(device, model, stall, backdrop)
    yield made
    made.release()


@pytest.fixture(scope="module")
def view(skin_matrices):
    return FrameView(skin_matrices, face=tessellate(face_params()))


def shot(renderer: Renderer, view: FrameView) -> Pixels:
    renderer.draw(view)
    pixels = renderer.read_pixels()
    assert renderer.device.context.error == "GL_NO_ERROR"
    return pixels


def change(a: Pixels, b: Pixels) -> NDArray[np.bool_]:
    return np.abs(a.astype(np.int16) - b).max(axis=2) > 12


def test_the_hero_frame_looks_like_its_golden(renderer, view, golden):
    pixels = shot(renderer, view)
    assert pixels.shape == (360, 640, 3)
    assert pixels.std() > 30, "a blank frame"
    golden(pixels, "hero")


def test_the_closeup_looks_like_its_golden(renderer, view, golden):
    face = tessellate(face_params(brow_angle=18.0, vein=1.0, red=0.8, mouth_open=14.0, teeth_clench=1.0))
    golden(shot(renderer, replace(view, camera=CLOSEUP, face=face)), "closeup")


def test_the_person_alone_looks_like_its_golden(renderer, view, golden):
    golden(shot(renderer, replace(view, camera=FRONT, show_stall=False)), "studio")


def test_drawing_twice_gives_the_same_pixels(renderer, view):
    assert np.array_equal(shot(renderer, view), shot(renderer, view))


def test_nothing_of_the_last_pose_stays_behind(renderer, view):
    first = shot(renderer, view)
    moved = view.skin_matrices.copy()
    moved[:, 0, 3] += 0.25
    shifted = shot(renderer, replace(view, skin_matrices=moved))
    assert change(first, shifted).mean() > 0.02
    # With two frames per shadow map a frame more is needed until nothing differs.
    shot(renderer, view)
    assert np.array_equal(first, shot(renderer, view))


def test_an_expression_changes_only_the_face(renderer, view):
    calm = shot(renderer, view)
    angry = shot(renderer, replace(view, face=tessellate(face_params(brow_angle=25.0, mouth_open=20.0))))
    rows, columns = np.nonzero(change(calm, angry))
    assert len(rows) > 60
    assert rows.min() > 80
    assert rows.max() < 190
    assert columns.min() > 240
    assert columns.max() < 400


def test_no_face_means_the_last_one(renderer, view):
    shown = shot(renderer, view)
    assert np.array_equal(shown, shot(renderer, replace(view, face=None)))


def test_a_hidden_face_shows_no_expression(renderer, view):
    angry = replace(view, face=tessellate(face_params(brow_angle=25.0, mouth_open=20.0)), show_face=False)
    blank = shot(renderer, replace(view, show_face=False))
    assert np.array_equal(blank, shot(renderer, angry))
    assert change(blank, shot(renderer, view)).any()


def test_brows_show_through_the_fringe(renderer, view):
    """The second layer is drawn over the hair: without it a raised brow would vanish behind the fringe."""
    close = replace(view, camera=Camera((0.0, 1.25, 1.3), (0.0, 1.22, 0.0), 20.0))
    face = tessellate(face_params(brow_raise=26.0, brow_thick=1.8))
    with_over = shot(renderer, replace(close, face=face))
    without = shot(renderer, replace(close, face=replace(face, over=replace_empty(face.over))))
    through = change(with_over, without)
    # The skin carries the brows in both pictures: what differs lies on the hair.
    assert through.sum() > 50
    assert without[through].astype(int).mean() < 170


def replace_empty(layer):
    return replace(layer, position=layer.position[:0], colour=layer.colour[:0], triangle=layer.triangle[:0])


def test_a_sold_item_is_gone_and_the_rest_stays(renderer, view, stall):
    assert "item:lucky_cat" in stall.groups
    before = shot(renderer, view)
    after = shot(renderer, replace(view, hidden_items=frozenset({"item:lucky_cat"})))
    _, columns = np.nonzero(change(before, after))
    assert len(columns) > 500
    assert columns.max() < 320, "the cat stands on the left"


def test_the_person_casts_a_shadow_on_the_table(renderer, view):
    """Where the sun is kept off the table, the picture of the table in full shadow shows."""
    low = view.skin_matrices.copy()
    low[:, 1, 3] -= 0.12
    low[:, 2, 3] += 0.35  # the person stands in the middle of the table
    pixels = shot(renderer, replace(view, skin_matrices=low)).astype(int)
    bake = renderer._canvas.targets.bake
    dark = np.frombuffer(bake.dark.target.read(components=4), np.uint8).reshape(360, 640, 4)[::-1, :, :3]
    still = np.frombuffer(bake.still.read(components=4), np.uint8).reshape(360, 640, 4)[::-1, :, :3]
    differs = np.abs(still.astype(int) - dark).sum(axis=2) > 30
    shows_dark = differs & (np.abs(pixels - dark).max(axis=2) <= 2)
    assert shows_dark.sum() > 100


@pytest.mark.parametrize("level", [level.name for level in LEVELS])
def test_every_level_shows_the_same_picture(renderer, view, level):
    default = shot(renderer, view)
    renderer.set_level(level_named(level))
    try:
        pixels = shot(renderer, view)
    finally:
        renderer.set_level(level_named("default"))
    assert np.abs(pixels.astype(np.int16) - default).mean() < 4.0


def test_outlines_do_not_depend_on_who_finds_the_silhouette(device, model, view):
    """The CPU picks the silhouette on software rasterisers, the geometry shader elsewhere: the pixels are the same."""
    by_cpu = Renderer(device, model)
    pixels = shot(by_cpu, replace(view, show_stall=False))
    by_cpu.release()
    was = device.software
    device.software = False
    try:
        by_gpu = Renderer(device, model)
        other = shot(by_gpu, replace(view, show_stall=False))
        by_gpu.release()
    finally:
        device.software = was
    assert change(pixels, other).mean() < 0.001


def test_resizing_draws_at_the_new_size(device, renderer, view):
    small = shot(renderer, view)
    device.resize(800, 600)
    try:
        tall = shot(renderer, view)
    finally:
        device.resize(640, 360)
    assert tall.shape == (600, 800, 3)
    assert np.array_equal(small, shot(renderer, view))


def test_frames_without_a_person_show_the_stall(device, stall, backdrop, view):
    empty = Renderer(device, None, stall, backdrop)
    pixels = shot(empty, view)
    empty.release()
    assert pixels.std() > 30


def test_reading_before_drawing_is_refused(device):
    fresh = Renderer(device, None)
    with pytest.raises(RuntimeError, match="nothing has been drawn"):
        fresh.read_pixels()
    fresh.release()


def test_nothing_leaks(device, model, stall, backdrop, view, monkeypatch):
    made: list[object] = []

    def recorded(create):
        def wrapper(*args, **kwargs):
            made.append(create(*args, **kwargs))
            return made[-1]

        return wrapper

    for name in ("texture", "depth_texture", "renderbuffer", "framebuffer", "buffer", "program", "_vertex_array"):
        monkeypatch.setattr(device.context, name, recorded(getattr(device.context, name)))
    for level in ("high", "default"):
        drawing = Renderer(device, model, stall, backdrop, level_named(level), FontSet.for_language("en"))
        drawing.draw(replace(view, hud=lambda hud: hud.text("coins", 0, 0)))
        drawing.set_level(level_named("low"))
        drawing.draw(replace(view, face=tessellate(face_params(mouth_open=30.0))))
        drawing.release()
    floor = BareScene(device)
    floor.draw()
    floor.release()
    assert len(made) > 200
    alive = [item for item in made if not isinstance(item.mglo, moderngl.InvalidObject)]
    assert alive == []


def test_a_moving_camera_gets_drafts_and_a_resting_one_the_full_picture(renderer, view):
    wanted = shot(renderer, view)
    steps = [replace(view, camera=replace(view.camera, eye=(0.02 * i, 1.16, 3.02))) for i in (3, 2, 1)]
    renderer.drafts = True
    try:
        for step in steps:
            shot(renderer, step)
        arriving = shot(renderer, view)
        assert renderer._canvas.is_draft
        resting = shot(renderer, view)
    finally:
        renderer.drafts = False
    assert not renderer._canvas.is_draft
    assert np.array_equal(resting, wanted)
    assert np.abs(arriving.astype(int) - wanted).mean() < 4.0


def test_a_snapshot_of_another_size_disturbs_nothing(renderer, view):
    before = shot(renderer, view)
    picture = renderer.snapshot(replace(view, camera=CLOSEUP), (320, 400))
    assert picture.shape == (400, 320, 3)
    assert picture.std() > 30
    assert np.array_equal(before, renderer.read_pixels())
    assert np.array_equal(before, shot(renderer, view))


def test_a_machine_without_opengl_is_told_what_to_install_in_one_line(monkeypatch):
    def fail(**_):
        raise OSError("libEGL.so\nnot found")

    monkeypatch.setattr("moderngl.create_context", fail)
    with pytest.raises(MissingPart, match="libegl1 libgl1-mesa-dri") as caught:
        Device.headless(64, 64)
    assert "\n" not in str(caught.value)


def test_egl_alone_is_enough_where_libgl_is_not_installed():
    # In a process of its own: a second context would take the first one's place.
    program = """
import game.render.device as device
find = device.find_library
device.find_library = lambda name: None if name == "GL" else find(name)
made = device.Device.headless(8, 8)
picture = made.context.simple_framebuffer((8, 8))
picture.clear(0.0, 1.0, 0.0)
print(picture.read()[:3].hex())
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120, check=False)
    assert done.stdout.split()[-1:] == ["00ff00"], done.stderr


def test_specks_drift_with_the_time_and_only_with_it(renderer, view):
    now = shot(renderer, view)
    later = shot(renderer, replace(view, time_s=40.0))
    moved = np.abs(now.astype(int) - later).max(axis=2) > 3
    assert 20 < moved.sum() < 4000
    assert np.array_equal(now, shot(renderer, view))
    alone = replace(view, show_stall=False)
    assert np.array_equal(shot(renderer, alone), shot(renderer, replace(alone, time_s=40.0)))


@pytest.mark.parametrize("frames_before", [1, 2])
def test_a_picture_much_later_has_a_shadow_of_its_own(renderer, view, frames_before):
    """The map is drawn every other frame: between two pictures of a strip it would be that of another pose."""
    for _ in range(frames_before):
        shot(renderer, view)
    low = view.skin_matrices.copy()
    low[:, 1, 3] -= 0.25
    later = replace(view, skin_matrices=low, time_s=view.time_s + 9.0)
    first, again, once_more = (shot(renderer, later) for _ in range(3))
    assert np.array_equal(first, again)
    assert np.array_equal(again, once_more)
