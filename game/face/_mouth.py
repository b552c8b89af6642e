"""The mouth: one closed line plus an opening ≥ 0, so that lips meet and part without ever crossing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.face.mesh import FEATHER_MM, Sheet, bezier, rgb, ribbons, tint
from game.face.params import INDEX, FaceParams
from game.face.style import FaceStyle

__all__ = ["Lips", "lips", "mouth"]

Floats = NDArray[np.float64]
_COLUMNS = 49
_S = -np.cos(np.linspace(0.0, np.pi, _COLUMNS))  # −1 right corner … 1 left corner, dense at the corners
_ROUND = np.sqrt(np.maximum(1.0 - _S**2, 0.0))


@dataclass(frozen=True)
class Lips:
    """Lip curves in head mm: x, upper, lower (n,) with upper ≥ lower; ajar 0 closed … 1."""

    x: Floats
    upper: Floats
    lower: Floats
    ajar: float


def lips(params: FaceParams, style: FaceStyle) -> Lips:
    """The lip curves of an expression (K,)."""
    width, corner, opening, top = (params[INDEX[n]] for n in ("mouth_width", "mouth_corner", "mouth_open", "mouth_top"))
    square, peak, cat, wave = (params[INDEX[n]] for n in ("mouth_square", "mouth_peak", "mouth_cat", "mouth_wave"))
    asym, skew, pout = (params[INDEX[n]] for n in ("mouth_asym", "mouth_skew", "mouth_pout"))
    opening = max(float(opening), 0.0)
    ajar = opening / (opening + 5.0)
    inside = 1.0 - _S**6  # keeps waves off the corners
    line = corner * (1.35 * _S**2 - 0.35) + asym * (0.7 * _S + 0.3 * _S**2)
    line = line + 3.6 * wave * np.sin(3.0 * np.pi * _S + 0.6) * inside
    line = line - 8.0 * cat * (np.sqrt(np.sin(np.pi * _S) ** 2 + 0.03) - 0.173)
    line = line + 2.2 * pout * np.exp(-((_S / 0.35) ** 2))
    tent = 15.0 * peak * (1.05 - np.sqrt(_S**2 + 0.02))
    base = line + tent * (1.0 - 0.55 * ajar)
    # Round mouths leave the corner steeply, boxy ones at once.
    profile = _ROUND ** (1.0 - 0.72 * square)
    upper = base + ajar * top * profile
    fall = opening * profile
    lower = base - fall - ajar * (tent * 0.45 + 2.6 * wave * np.sin(4.0 * np.pi * _S + 1.1) * inside)
    x = skew + width * _S
    y = style.mouth_y + params[INDEX["mouth_y"]]
    return Lips(x, y + upper, y + np.minimum(lower, upper), ajar)


def _strip(x: Floats, *levels: Floats) -> Floats:
    """(levels, n, 2) from curves (n,) over one abscissa."""
    return np.stack([np.stack([x, level], axis=-1) for level in levels])


def mouth(sheet: Sheet, params: FaceParams, lip: Lips, style: FaceStyle) -> None:
    """Cavity, tongue, teeth, outline, the lip's shadow and a tongue put out."""
    x, upper, lower = lip.x, lip.upper, lip.lower
    gap = upper - lower
    if lip.ajar > 1e-3:
        deep, light = rgb(style.mouth_deep), rgb(style.mouth_light)
        colour = np.stack([np.broadcast_to(light, (_COLUMNS, 3)), np.broadcast_to(deep, (_COLUMNS, 3))])
        sheet.grid(_strip(x, lower, upper), tint(colour, np.ones((2, _COLUMNS))))
        _inside(sheet, params, lip, style, gap)
    weight = style.line_weight
    closed_width = 2.4 + 3.0 * np.sqrt(_ROUND)
    width = (closed_width + lip.ajar * (3.6 - closed_width)) * weight
    dark = rgb(style.lip)
    ribbons(sheet, _strip(x, lower, upper), width, tint(dark, np.ones(2)))

    centre = float(params[INDEX["mouth_skew"]])
    pout = float(params[INDEX["mouth_pout"]])
    low = float(lower[_COLUMNS // 2])
    reach = min(0.36 * float(params[INDEX["mouth_width"]]), 14.0)
    under = bezier([(-reach, 1.5), (-reach * 0.4, -1.0), (reach * 0.4, -1.0), (reach, 1.5)], 12)
    under = under + np.array([centre, low - 10.0 - 1.5 * pout])
    swell = np.sin(np.linspace(0.0, np.pi, 12))
    ribbons(
        sheet,
        under[None],
        (1.0 + 1.9 * swell) * (1.0 + 0.5 * pout),
        tint(rgb(style.lip_soft) * np.array([1.0, 1.0 - 0.2 * pout, 1.0 - 0.2 * pout]), np.array([0.9])),
    )
    _corners(sheet, params, lip, style)
    _tongue_out(sheet, params, lip, style)


def _inside(sheet: Sheet, params: FaceParams, lip: Lips, style: FaceStyle, gap: Floats) -> None:
    x, upper, lower = lip.x, lip.upper, lip.lower
    opening = float(gap.max())
    here = min(opening / 6.0, 1.0)
    tongue = float(params[INDEX["tongue"]])
    if tongue > 1e-3:
        hump = np.clip(1.0 - (_S / 0.82) ** 2, 0.0, 1.0) ** 0.5 * (1.0 - 0.16 * np.exp(-((_S / 0.2) ** 2)))
        crest = np.minimum(lower + 0.56 * tongue * opening * hump, upper)
        rim = np.minimum(crest + FEATHER_MM, upper)
        alpha = np.stack([np.full(_COLUMNS, tongue), np.full(_COLUMNS, tongue), np.zeros(_COLUMNS)])
        warm, pink = rgb(style.tongue) * np.array([0.9, 0.78, 0.8]), rgb(style.tongue)
        colour = np.stack([np.broadcast_to(c, (_COLUMNS, 3)) for c in (warm, pink, pink)])
        sheet.grid(_strip(x, lower, crest, rim), tint(colour, alpha * here))
    teeth = float(params[INDEX["teeth"]])
    if teeth > 1e-3:
        depth = teeth * min(0.30 * opening + 1.5, 10.0) * np.clip(1.0 - (_S / 0.97) ** 8, 0.0, 1.0)
        edge = np.maximum(upper - depth, lower)
        rim = np.maximum(edge - FEATHER_MM, lower)
        alpha = np.stack([np.zeros(_COLUMNS), np.ones(_COLUMNS), np.ones(_COLUMNS)])
        sheet.grid(_strip(x, rim, edge, upper), tint(rgb(style.tooth), alpha * min(teeth * 3.0, 1.0) * here))
    clench = float(params[INDEX["teeth_clench"]])
    if clench > 1e-3:
        sheet.grid(_strip(x, lower, upper), tint(rgb(style.tooth), np.full((2, _COLUMNS), clench * here)))
        line = rgb(style.tooth_line)
        middle = (upper + lower) / 2.0
        fade = np.clip(gap / 6.0, 0.0, 1.0)
        ribbons(sheet, _strip(x, middle), 2.0 * fade[None], tint(line, np.array([0.9 * clench * here])))
        at = np.linspace(-0.76, 0.76, 7)
        foot, head = np.interp(at, _S, lower), np.interp(at, _S, upper)
        along = np.linspace(0.0, 1.0, 5)
        bars = foot[:, None] + (head - foot)[:, None] * along
        across = np.interp(at, _S, x)[:, None] + np.zeros(5)
        ribbons(sheet, np.stack([across, bars], axis=-1), 1.5, tint(line, np.full(7, 0.6 * clench * here)))


def _corners(sheet: Sheet, params: FaceParams, lip: Lips, style: FaceStyle) -> None:
    """A small hook at a corner that is pulled up, as a pen would leave it."""
    asym = float(params[INDEX["mouth_asym"]])
    smile = max(float(params[INDEX["mouth_corner"]]), 0.0) / 22.0
    pull = np.clip(np.array([asym, -asym]) / 10.0 + smile * 0.9, 0.0, 1.0)
    ends = np.array([[lip.x[-1], lip.upper[-1]], [lip.x[0], lip.upper[0]]])
    hook = bezier([(-2.5, 4.0), (1.5, 3.5), (4.0, 0.0), (4.0, -4.0)], 10)
    mirrored = np.stack([hook, hook * np.array([-1.0, 1.0])])
    size = (0.4 + 0.9 * pull)[:, None, None]
    taper = np.linspace(1.6, 2.6, 10)
    ribbons(sheet, ends[:, None] + mirrored * size, taper * style.line_weight, tint(rgb(style.lip), pull))


def _tongue_out(sheet: Sheet, params: FaceParams, lip: Lips, style: FaceStyle) -> None:
    out = float(params[INDEX["tongue_out"]])
    if out <= 1e-3:
        return
    shown = min(out * 4.0, 1.0)
    half = min(0.52 * float(params[INDEX["mouth_width"]]), 17.0)
    u = np.linspace(-1.0, 1.0, 21)
    # The root sits inside the opening so that the tongue comes out of the mouth, not out of the chin.
    at = lip.x[_COLUMNS // 2] + half * u
    root = np.interp(at, lip.x, 0.35 * lip.upper + 0.65 * lip.lower)
    length = 27.0 * out
    tip = root.min() - length * np.sqrt(np.maximum(1.0 - u**2, 0.0)) ** 0.8
    tip = np.minimum(tip, root)
    pink = rgb(style.tongue)
    shade = np.stack([np.broadcast_to(pink, (21, 3)), np.broadcast_to(pink * np.array([0.97, 0.86, 0.86]), (21, 3))])
    sheet.grid(_strip(at, tip, root), tint(shade, np.full((2, 21), shown)))
    dark = rgb(style.lip)
    ribbons(sheet, _strip(at, tip), 3.0 * style.line_weight, tint(dark, np.array([shown])))
    groove_x = np.full(8, lip.x[_COLUMNS // 2])
    groove_y = np.linspace(float(root[10]) - 0.1 * length, float(tip[10]) + 0.42 * length, 8)
    ribbons(
        sheet, np.stack([groove_x, groove_y], -1)[None], np.linspace(2.0, 0.8, 8), tint(dark, np.array([0.6 * shown]))
    )
