"""The market's postcards: every open stall, with whoever stands there, as a small picture drawn by the real thing."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from game.app.gallery import Gallery
from game.app.market import Stall
from game.app.stage import StageAssets, StageShow
from game.app.step import new_world, step
from game.app.world import TICK_S, leave_talk
from game.render import Camera, Device, Level, Renderer

__all__ = ["CARD_SIZE", "Cards"]

CARD_SIZE = (576, 495)
CARD_CAMERA = Camera((0.0, 1.17, 3.02), (0.0, 1.015, 0.0), 21.55, aspect=CARD_SIZE[0] / CARD_SIZE[1])
SETTLE_TICKS = 24
"""Before the picture is taken the person has had this long to stand at ease."""


@dataclass
class Cards:
    """Which pictures there are and of what: a stall's is taken anew when something has been bought there."""

    device: Device
    gallery: Gallery
    taken: dict[str, frozenset[str]] = field(default_factory=dict)

    def paint_next(self, stalls: Iterable[Stall], owned: dict[str, frozenset[str]], level: Level, seed: int) -> bool:
        """Take at most one picture that is missing or out of date; True if one was taken."""
        for stall in stalls:
            gone = owned.get(stall.id, frozenset())
            if stall.stage is not None and self.taken.get(stall.id) != gone:
                self.gallery.put(f"card:{stall.id}", self._picture(stall, stall.stage, gone, level, seed))
                self.taken[stall.id] = gone
                return True
        return False

    def _picture(
        self, stall: Stall, stage: StageAssets, gone: frozenset[str], level: Level, seed: int
    ) -> NDArray[np.uint8]:
        world, show = leave_talk(new_world(stall.assets, seed)), StageShow(stage)
        for _ in range(SETTLE_TICKS):
            world = step(stall.assets, world)
            assert world.body.pose is not None
            show.tick(world.body.pose, TICK_S, world.body)
        assert world.body.face_params is not None
        # A renderer of its own: the one that draws the game keeps its baked picture.
        renderer = Renderer(self.device, stage.model, stage.stall, stage.backdrop, level=level)
        try:
            view = show.frame(world.body.face_params, camera=CARD_CAMERA, hidden_items=stage.gone(gone))
            return renderer.snapshot(replace(view, near=False), CARD_SIZE)
        finally:
            renderer.release()
