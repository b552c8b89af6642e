"""The afternoon's light: what must go one way goes one way, and the picture follows the hour."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from game.render import DESIGN_SHARE, FrameView, Renderer
from game.render.daylight import STEPS, daylight, stepped

HOURS = np.linspace(0.0, 1.0, 41)


def test_the_sun_sinks_and_the_lamps_come_on() -> None:
    days = [daylight(share) for share in HOURS]
    heights = [day.sun[1] for day in days]
    assert heights == sorted(heights, reverse=True)
    lamps = [day.lamps for day in days]
    assert lamps == sorted(lamps)
    assert (lamps[0], lamps[-1]) == (0.0, 1.0)
    np.testing.assert_allclose([np.linalg.norm(day.sun) for day in days], 1.0)


def test_light_turns_warmer_and_shade_darker_all_afternoon() -> None:
    days = [daylight(share) for share in HOURS]
    warmth = [day.lit[0] / day.lit[2] for day in days]
    assert warmth == sorted(warmth)
    for tone in ("shade", "deep"):
        sums = [float(getattr(day, tone).sum()) for day in days]
        assert sums == sorted(sums, reverse=True)


def test_the_palettes_own_hour_changes_nothing() -> None:
    day = daylight(DESIGN_SHARE)
    for tone in ("lit", "shade", "deep", "rim", "sky", "horizon", "ground"):
        np.testing.assert_allclose(getattr(day, tone), 1.0)
    assert stepped(DESIGN_SHARE) == DESIGN_SHARE


def test_hours_outside_the_afternoon_are_its_ends() -> None:
    assert daylight(-3.0).share == 0.0
    assert daylight(7.0).share == 1.0
    assert stepped(0.5 + 0.2 / STEPS) == stepped(0.5)


@pytest.mark.gl
def test_evening_is_darker_and_warmer_and_its_picture_is_kept(device, model, stall, backdrop, skin_matrices) -> None:
    renderer = Renderer(device, model, stall, backdrop)
    try:
        pictures = []
        for share in (0.0, 0.35, 0.7, 1.0):
            renderer.draw(FrameView(skin_matrices, day_share=share))
            pictures.append(renderer.read_pixels().astype(float))
        renderer.draw(replace(FrameView(skin_matrices), day_share=1.0 - 0.2 / STEPS))
        again = renderer.read_pixels()
    finally:
        renderer.release()
    blue = [picture[..., 2].mean() for picture in pictures]
    assert blue == sorted(blue, reverse=True)
    assert pictures[-1].mean() < 0.85 * pictures[1].mean()
    share_red = [picture[..., 0].mean() / picture.mean() for picture in pictures]
    assert share_red == sorted(share_red)
    assert np.array_equal(again, pictures[-1]), "a light that hardly changed draws nothing anew"
