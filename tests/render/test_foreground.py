"""The near layer: at the lower corners only, out of the way of face, hands and goods, and moving most."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from game.core import ASSETS, BadInput
from game.formats import load_yaml
from game.render import HERO, FrameView, Renderer
from game.render.foreground import CORNERS
from game.render.mood import NEAR, read_mood

_STALLS = ("flea", "antiques", "toys")


@pytest.mark.parametrize("near", CORNERS)
def test_a_corner_is_drawn_near_the_corner(near: str) -> None:
    for side, corner in zip((-1.0, 1.0), CORNERS[near], strict=True):
        rows = np.array(corner(side))
        assert rows.shape[1] == 10
        assert (side * rows[:, 0] > 0.78).all()
        assert (rows[:, 1] < -0.5).all()
        assert np.array_equal(rows, corner(side))


def test_each_stall_has_a_near_layer_and_a_light_of_its_own(tmp_path) -> None:
    moods = {name: read_mood(load_yaml(ASSETS / "stalls" / f"{name}.yaml")["mood"]) for name in _STALLS}
    assert len({mood.near for mood in moods.values()}) == 3
    assert {mood.near for mood in moods.values()} <= set(NEAR)
    assert moods["antiques"].shade[2] > moods["antiques"].shade[0], "shade under the temple's trees is cool"
    wrong = tmp_path / "stall.yaml"
    wrong.write_text("mood: {near: jungle}\n")
    with pytest.raises(BadInput, match="garden"):
        read_mood(load_yaml(wrong)["mood"])
    wrong.write_text("mood: {lit: [1, 1]}\n")
    with pytest.raises(BadInput, match="three factors"):
        read_mood(load_yaml(wrong)["mood"])


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
        without = shot(replace(view, near=False))
    finally:
        renderer.release()
    covered = np.abs(with_it - without).max(axis=2) > 10
    assert covered[300:, :60].sum() > 500
    assert covered[300:, 580:].sum() > 500
    assert not covered[:270].any()
    assert not covered[:, 90:550].any()
    assert np.abs(moved - with_it)[330:, :30].mean() > 4
