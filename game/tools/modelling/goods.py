"""All goods by item id. An item's model, its place on the table and its entry in the dialogue share this id."""

from __future__ import annotations

from collections.abc import Mapping

from game.tools.modelling.goods_flea import FLEA_GOODS
from game.tools.modelling.goods_shapes import Good

__all__ = ["GOODS"]

GOODS: Mapping[str, Good] = {**FLEA_GOODS}
"""Item id -> its parts, about the point (0, 0, 0) where it stands, facing +Z."""
