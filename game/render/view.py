"""What the renderer is told about one frame: plain data, read only."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from game.face.mesh import DrawList
from game.render.camera import HERO, Camera
from game.render.daylight import DESIGN_SHARE

if TYPE_CHECKING:
    from game.render.avatar_model import AvatarLook
    from game.render.crowd import CrowdView
    from game.render.hud import Hud
    from game.render.item_drawing import ItemView

__all__ = ["FrameView"]


@dataclass(frozen=True)
class FrameView:
    """One frame.

    skin_matrices (j, 4, 4): joint world matrix times inverse bind matrix, in the order of the model's joints.
    face: the expression's draw list, or None for the one shown last (the same object again costs nothing).
    look: the expression of a foreign avatar, which has no painted face.
    show_face False draws a blank face with two guide lines. show_stall False draws the person alone in a studio.
    hidden_items: groups of the stall (``item:teapot_gold``) that are not there. hud: draws interface on top.
    crowd: passers-by behind the stall, as many as the renderer was given looks for.
    day_share: of the afternoon, 0 at 13:00 to 1 at 18:00.
    near False leaves out what stands nearest to the eye.
    item: an item of the stall to be shown large, in the place of everything else.
    """

    skin_matrices: NDArray[np.float32]
    camera: Camera = HERO
    face: DrawList | None = None
    look: AvatarLook | None = None
    show_face: bool = True
    show_stall: bool = True
    hidden_items: frozenset[str] = frozenset()
    time_s: float = 0.0
    day_share: float = DESIGN_SHARE
    crowd: CrowdView | None = None
    item: ItemView | None = None
    near: bool = True
    hud: Callable[[Hud], None] | None = None
