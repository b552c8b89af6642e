"""From the numbers of an expression to triangles. Pure arrays; the renderer only paints them."""

from __future__ import annotations

import numpy as np

from game.core.errors import BadInput
from game.face._age import age_lines
from game.face._brows import brows, furrows, nose
from game.face._eyes import eyeballs, lashes, lids
from game.face._marks import bags, complexion, drops, puff, signs
from game.face._mouth import lips, mouth
from game.face.mesh import DrawList, Sheet
from game.face.params import FIELDS, INDEX, FaceParams, clamp
from game.face.style import DEFAULT_STYLE, FaceStyle

__all__ = ["tessellate"]


def tessellate(params: FaceParams, style: FaceStyle = DEFAULT_STYLE) -> DrawList:
    """Triangles of one expression (K,), values outside their ranges being clamped.

    Positions are mm in head-rest space, within x −170..170, y −200..140; see ``mesh.Layer`` for the colours.
    Raises BadInput for a wrong length or values that are not finite.
    """
    values = np.asarray(params, dtype=np.float64)
    if values.shape != (len(FIELDS),) or not np.isfinite(values).all():
        raise BadInput("expression", expected=f"{len(FIELDS)} finite numbers", seen=f"shape {values.shape}")
    if style.rest:
        values = values.copy()
        for name, change in style.rest:
            values[INDEX[name]] += change
    values = clamp(values)
    lid = lids(values)
    sheet = Sheet()
    complexion(sheet, values, style)
    age_lines(sheet, values, style)
    nose(sheet, values, style)
    furrows(sheet, values, style)
    bags(sheet, values, lid, style)
    eyeballs(sheet, values, lid, style)
    lip = lips(values, style)
    mouth(sheet, values, lip, style)
    lashes(sheet, values, lid, style)
    brows(sheet, values, style)
    drops(sheet, values, style)
    puff(sheet, values, lip)
    signs(sheet, values)
    return sheet.draw_list()
