"""Clouds drift where the painting shows sky, and nowhere else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from game.render import FrameView, Renderer, level_named
from game.render.sky import cloud_picture, sky_cells, sky_share


def test_the_blue_of_the_painting_is_sky_and_the_rest_is_not(backdrop) -> None:
    share = sky_share(backdrop)
    height = len(share)
    assert share[: height // 20].mean() > 0.2
    assert not share[height // 3 :].any()
    plain = np.zeros((64, 64, 3), np.uint8)
    plain[:] = (150, 205, 230)
    assert sky_share(plain)[0].min() == 1.0
    plain[:] = (250, 240, 225)  # a cloud, a wall
    assert not sky_share(plain).any()


def test_clouds_repeat_sideways_without_a_seam() -> None:
    cover = cloud_picture()
    assert 0.05 < cover.mean() < 0.5
    inside = np.abs(np.diff(cover, axis=1)).max()
    assert np.abs(cover[:, 0] - cover[:, -1]).max() <= inside
    assert not cover[-1].any(), "nothing is cut off at the top"


def test_the_rectangles_that_are_drawn_hold_all_sky_once_and_little_else(backdrop) -> None:
    share = sky_share(backdrop)[::-1]
    height, width = share.shape
    cover = np.zeros((height, 3 * width), int)
    for left, low, right, high in sky_cells(share):
        x = slice(round((left + 1) * width), round((right + 1) * width))
        cover[round(low * height) : round(high * height), x] += 1
    assert cover.max() == 1, "what is laid twice is too bright"
    own = cover[:, width : 2 * width]
    assert own[share > 0].all()
    assert own.sum() < 3 * (share > 0).sum()
    assert np.array_equal(cover[:, :width], own[:, ::-1]), "the painting is mirrored at its sides"
    assert np.array_equal(cover[:, 2 * width :], own[:, ::-1])
    assert len(sky_cells(np.zeros((8, 8)))) == 0


@pytest.mark.gl
def test_clouds_move_with_the_time_and_stay_behind_the_stall(device, stall, backdrop, skin_matrices) -> None:
    renderer = Renderer(device, None, replace(stall, moving=()), backdrop, level_named("high"))

    def shot(time_s: float) -> np.ndarray:
        renderer.draw(FrameView(skin_matrices, time_s=time_s))
        return renderer.read_pixels().astype(int)

    try:
        first, later, again = shot(0.0), shot(60.0), shot(0.0)
    finally:
        renderer.release()
    assert np.array_equal(first, again)
    moved = np.abs(first - later).max(axis=2) > 6
    sky = moved[:60]
    assert sky.sum() > 150
    assert moved[130:].sum() < 400, "only specks move below"
