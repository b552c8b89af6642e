"""All goods by item id. An item's model, its place on the table and its entry in the dialogue share this id."""

from __future__ import annotations

from collections.abc import Mapping

from game.tools.modelling.goods_antiques import lacquer_box, pocket_watch, tea_bowl
from game.tools.modelling.goods_flea import FLEA_GOODS
from game.tools.modelling.goods_heirlooms import folding_fan, incense_burner
from game.tools.modelling.goods_scholar import ink_stone, noh_mask
from game.tools.modelling.goods_shapes import Good
from game.tools.modelling.goods_tin import tin_robot, wind_up_bird
from game.tools.modelling.goods_toys import kendama, kokeshi, spinning_top, teddy_bear
from game.tools.modelling.goods_train import toy_train

__all__ = ["GOODS"]

GOODS: Mapping[str, Good] = {
    **FLEA_GOODS,
    "pocket_watch": pocket_watch,
    "lacquer_box": lacquer_box,
    "tea_bowl": tea_bowl,
    "folding_fan": folding_fan,
    "incense_burner": incense_burner,
    "ink_stone": ink_stone,
    "noh_mask": noh_mask,
    "tin_robot": tin_robot,
    "kokeshi": kokeshi,
    "spinning_top": spinning_top,
    "kendama": kendama,
    "wind_up_bird": wind_up_bird,
    "toy_train": toy_train,
    "teddy_bear": teddy_bear,
}
"""Item id -> its parts, about the point (0, 0, 0) where it stands, facing +Z."""
