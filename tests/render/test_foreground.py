"""The near layer: at the lower corners only, out of the way of face, hands and goods, and moving most."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from game.render import HERO, FrameView, Renderer
from game.render.foreground import flower_corner


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_corner_is_drawn_near_the_corner(side: float) -> None:
    rows = flower_corner(side, 5)
    assert (np.abs(rows[:, 0]) > 0.78).all()
    assert (rows[:, 1] < -0.6).all()
    assert np.array_equal(rows, flower_corner(side, 5))


@pytest.mark.gl
def test_it_stands_before_the_stall_at_the_corners_and_passes_by(device, stall, backdrop, skin_matrices) -> None:
    renderer = Renderer(device, None, replace(stall, moving=()), backdrop)
    view = FrameView(skin_matrices)

    def shot(view: FrameView) -> np.ndarray:
        renderer.draw(view)
        return renderer.read_pixels().astype(int)

    try:
        with_it = shot(view)
        moved = shot(replace(view, camera=replace(HERO, eye=(0.3, 1.16, 3.02), target=(0.3, 0.985, 0.0))))
        renderer._scene._foreground._count = 0
        renderer._canvas.baked = None
        without = shot(view)
    finally:
        renderer.release()
    covered = np.abs(with_it - without).max(axis=2) > 10
    assert covered[300:, :60].sum() > 500
    assert covered[300:, 580:].sum() > 500
    assert not covered[:270].any()
    assert not covered[:, 90:550].any()
    assert np.abs(moved - with_it)[330:, :30].mean() > 4
