"""Dynamic quality: down soon, up late, never to and fro; the interface stays sharp."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest

from game.face import tessellate
from game.face.params import face_params
from game.render import DEFAULT, LEVELS, FrameView, Relief, Renderer, ladder, level_named, relieve, rgba
from game.render.relief import EASY_FRAMES, SCALES

STEPS = len(ladder(DEFAULT))


def after(state: Relief, frames_ms: Iterable[float], steps: int = STEPS) -> Relief:
    for frame_ms in frames_ms:
        state = relieve(state, frame_ms, steps)
    return state


def test_the_ladder_lowers_quality_first_and_resolution_last() -> None:
    steps = ladder(DEFAULT)
    assert [step.level.name for step in steps] == ["default", "medium", "low", "low", "low", "low"]
    assert [step.scale for step in steps] == [1.0, 1.0, *SCALES]
    kept = ladder(LEVELS[-1], fixed=True)
    assert {step.level.name for step in kept} == {"ultra"}
    assert [step.scale for step in kept] == list(SCALES)


def test_slow_frames_lead_down_to_the_end_and_no_further() -> None:
    assert after(Relief(), [50.0] * 30).at == 1
    assert after(Relief(), [50.0] * 29).at == 0
    assert after(Relief(), [50.0] * 2000).at == STEPS - 1


@pytest.mark.parametrize("frames", [[16.0] * 500, [30.0] * 500, [16.0, 60.0] * 250, [16.0] * 29 + [900.0]])
def test_good_and_middling_frames_and_single_hitches_change_nothing(frames: list[float]) -> None:
    assert after(Relief(), frames).at == 0


def test_the_way_up_is_long_and_one_bad_frame_starts_it_again() -> None:
    low = Relief(at=2)
    assert after(low, [10.0] * (EASY_FRAMES - 1)).at == 2
    assert after(low, [10.0] * EASY_FRAMES).at == 1
    assert after(low, [10.0] * (EASY_FRAMES - 1) + [25.0] + [10.0] * (EASY_FRAMES - 1)).at == 2


def test_a_step_that_did_not_last_is_tried_ever_more_rarely() -> None:
    """A machine for which one rung is too slow and the next is easy: it must not swing between them."""
    state, changes = Relief(), []
    for frame in range(20_000):
        before = state.at
        state = relieve(state, 50.0 if state.at == 0 else 10.0, 2)
        if state.at != before:
            changes.append(frame)
    gaps = np.diff(changes[1::2])
    assert len(changes) < 40
    assert gaps.max() > 3 * gaps.min()


@pytest.mark.gl
def test_a_smaller_scene_keeps_the_interface_sharp(device, model, stall, backdrop, skin_matrices) -> None:
    def draw_hud(hud) -> None:
        for i in range(20):
            hud.rect(20 + 4 * i, 20, 2, 40, fill=rgba("#000000"))
            hud.rect(22 + 4 * i, 20, 2, 40, fill=rgba("#FFFFFF"))

    view = FrameView(skin_matrices, face=tessellate(face_params()), hud=draw_hud)
    renderer = Renderer(device, model, stall, backdrop)
    try:
        for level in ("low", "high"):
            renderer.set_level(level_named(level))
            pictures = []
            for scale in (1.0, 0.6, 1.0):
                renderer.set_scale(scale)
                renderer.draw(view)
                pictures.append(renderer.read_pixels().astype(int))
            whole, small, again = pictures
            stripes = (slice(12, 28), slice(12, 48))
            np.testing.assert_array_equal(small[stripes], whole[stripes])
            assert np.array_equal(whole, again)
            assert 0.2 < np.abs(small - whole).mean() < 6.0
            assert device.context.error == "GL_NO_ERROR"
    finally:
        renderer.release()


@pytest.mark.gl
def test_passes_are_measured_only_when_asked(device, model, stall, backdrop, skin_matrices) -> None:
    renderer = Renderer(device, model, stall, backdrop, level_named("high"))
    view = FrameView(skin_matrices, face=tessellate(face_params()), hud=lambda hud: None)
    try:
        renderer.draw(view)
        assert renderer.times.cpu_ms == {}
        renderer.times.on = True
        for i in range(6):
            renderer.draw(replace(view, time_s=i / 30))
        assert set(renderer.times.cpu_ms) == {"bake", "face", "skin", "life", "person", "output", "interface"}
        assert all(value >= 0.0 for value in renderer.times.cpu_ms.values())
        assert device.software == (renderer.times.gpu_ms == {})
    finally:
        renderer.release()
