"""An item shown large: what is cut out of the stall, and how it looks."""

from __future__ import annotations

import numpy as np
import pytest

from game.app.stage import load_stage
from game.core import ASSETS
from game.render import Device, FrameView, ItemView, Renderer, cut_item, level_named, load_picture, load_stall

FOLDER = ASSETS / "stalls"


@pytest.mark.parametrize("name", ["flea", "antiques", "toys"])
def test_an_item_is_cut_out_without_its_card_and_shadow(name) -> None:
    stage = load_stage("mira", name)
    for group in stage.stall.anchors:
        card = stage.cards.get(group.removeprefix("item:"))
        cut = cut_item(stage.stall, group, card)
        whole = sum(run.count for run in stage.stall.runs if run.group == group)
        assert 0 < cut.triangle.size < whole or card is None
        assert np.linalg.norm(cut.position, axis=1).max() == pytest.approx(1.0, abs=1e-3)
        assert sum(run.count for run in cut.runs) == cut.triangle.size
        if card is not None:
            # Cards stand apart: with one left in, the item would look much smaller in its frame.
            loose = cut_item(stage.stall, group, None)
            assert loose.triangle.size > cut.triangle.size


@pytest.mark.gl
def test_golden_of_an_item_in_the_hand(device: Device, golden) -> None:
    stall = load_stall(FOLDER / "antiques.glb")
    stage = load_stage("mira", "antiques")
    renderer = Renderer(device, None, stall, load_picture(FOLDER / "antiques_backdrop.png"), level_named("high"))
    try:
        item = ItemView("item:pocket_watch", 0.45, 0.24, 1.0, stage.cards["pocket_watch"])
        renderer.draw(FrameView(skin_matrices=np.zeros((1, 4, 4), np.float32), item=item))
        golden(renderer.read_pixels(), "item")
    finally:
        renderer.release()
