"""The mouth: one closed line plus an opening ≥ 0, so that lips meet and part without ever crossing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.face.mesh import FEATHER_MM, Sheet, bezier, ink, ribbons
from game.face.params import INDEX, FaceParams
from game.face.style import FaceStyle

__all__ = ["Lips", "lips", "mouth"]

Floats = NDArray[np.float64]
_COLUMNS = 41
_MIDDLE = _COLUMNS // 2
_S = -np.cos(np.linspace(0.0, np.pi, _COLUMNS))  # −1 right corner … 1 left corner, dense at the corners
_ROUND = np.sqrt(np.maximum(1.0 - _S**2, 0.0))
_INSIDE = 1.0 - _S**6  # keeps waves off the corners
_SMILE = 1.35 * _S**2 - 0.35
_LEAN = 0.7 * _S + 0.3 * _S**2
_WAVE = 3.6 * np.sin(3.0 * np.pi * _S + 0.6) * _INSIDE
_WAVE_LOW = 2.6 * np.sin(4.0 * np.pi * _S + 1.1) * _INSIDE
_CAT = 9.0 * (np.sqrt(np.sin(np.pi * _S) ** 2 + 0.03) - 0.173)
_PUCKER = 2.2 * np.exp(-((_S / 0.35) ** 2))
_TENT = 15.0 * (1.05 - np.sqrt(_S**2 + 0.02))
_CLOSED_WIDTH = 2.4 + 3.0 * np.sqrt(_ROUND)
_HUMP = np.sqrt(np.clip(1.0 - (_S / 0.82) ** 2, 0.0, 1.0)) * (1.0 - 0.16 * np.exp(-((_S / 0.2) ** 2)))
_TOOTH_ROW = np.clip(1.0 - (_S / 0.97) ** 8, 0.0, 1.0)
_GAPS = np.linspace(-0.76, 0.76, 7)  # between the teeth
_UNIT5 = np.linspace(0.0, 1.0, 5)
_SWELL = np.sin(np.linspace(0.0, np.pi, 12))
_HOOK = bezier(((-2.5, 4.0), (1.5, 3.5), (4.0, 0.0), (4.0, -4.0)), 10)
_HOOKS = np.stack([_HOOK, _HOOK * np.array([-1.0, 1.0])])
_HOOK_WIDTH = np.linspace(1.6, 2.6, 10)
_TONGUE_U = np.linspace(-1.0, 1.0, 21)
_TONGUE_ROUND = np.maximum(1.0 - _TONGUE_U**2, 0.0) ** 0.4


@dataclass(frozen=True)
class Lips:
    """Lip curves in head mm: x, upper, lower (n,) with upper ≥ lower; ajar 0 closed … 1."""

    x: Floats
    upper: Floats
    lower: Floats
    ajar: float


def lips(params: FaceParams, style: FaceStyle) -> Lips:
    """The lip curves of an expression (K,)."""
    width, corner, opening, top, square, peak, cat, wave, asym, skew, pout, lift = (
        float(params[INDEX["mouth_" + name]])
        for name in (
            "width", "corner", "open", "top", "square", "peak", "cat", "wave", "asym", "skew", "pout", "y",
        )
    )  # fmt: skip
    width, opening = width * style.mouth_scale, opening * style.mouth_scale
    ajar = opening / (opening + 5.0)
    line = corner * _SMILE + asym * _LEAN + wave * _WAVE - cat * _CAT + pout * _PUCKER
    tent = peak * _TENT
    # Round mouths leave the corner steeply, boxy ones at once.
    profile = _ROUND ** (1.0 - 0.72 * square)
    upper = line + tent * (1.0 - 0.55 * ajar) + (ajar * top) * profile
    lower = line + tent * (1.0 - ajar) - opening * profile - (ajar * wave) * _WAVE_LOW
    y = style.mouth_y + lift
    return Lips(skew + width * _S, y + upper, y + np.minimum(lower, upper), ajar)


def _strip(x: Floats, *levels: Floats) -> Floats:
    """(levels, n, 2) from curves (n,) over one abscissa."""
    result = np.empty((len(levels), len(x), 2))
    result[:, :, 0] = x
    for i, level in enumerate(levels):
        result[i, :, 1] = level
    return result


def _shade(*rows: Floats) -> Floats:
    """One colour (4,) per level -> (1, levels, n, 4)."""
    result = np.empty((1, len(rows), _COLUMNS, 4))
    for i, row in enumerate(rows):
        result[0, i] = row
    return result


def mouth(sheet: Sheet, params: FaceParams, lip: Lips, style: FaceStyle) -> None:
    """Cavity, tongue, teeth, outline, the lip's shadow and a tongue put out."""
    pair = _strip(lip.x, lip.lower, lip.upper)
    if lip.ajar > 1e-3:
        sheet.grid(pair[None], _shade(ink(style.mouth_light), ink(style.mouth_deep)))
        _inside(sheet, params, lip, style)
    dark = ink(style.lip)
    width = (_CLOSED_WIDTH + lip.ajar * (3.6 - _CLOSED_WIDTH)) * style.line_weight
    ribbons(sheet, pair, width, np.stack([dark, dark]))

    pout, width_mm = float(params[INDEX["mouth_pout"]]), float(params[INDEX["mouth_width"]])
    reach = min(0.36 * width_mm, 14.0)
    bend = -1.0 - 1.5 * pout
    under = bezier(((-reach, 1.5), (-reach * 0.4, bend), (reach * 0.4, bend), (reach, 1.5)), 12)
    under += (lip.x[_MIDDLE], lip.lower[_MIDDLE] - 10.0 - 1.5 * pout)
    tone = ink(style.lip_soft) * (0.9, 0.9 - 0.2 * pout, 0.9 - 0.2 * pout, 0.9) * (1.0 - 0.7 * lip.ajar)
    ribbons(sheet, under[None], (1.0 + 1.9 * _SWELL) * (1.0 + 0.5 * pout), tone[None])

    # A small hook at a corner that is pulled up, as a pen would leave it.
    asym = float(params[INDEX["mouth_asym"]]) / 10.0
    smile = max(float(params[INDEX["mouth_corner"]]), 0.0) / 24.0
    pull = np.array([min(max(smile + asym, 0.0), 1.0), min(max(smile - asym, 0.0), 1.0)])
    ends = pair[1, [-1, 0]]
    hooks = ends[:, None] + _HOOKS * (0.4 + 0.9 * pull)[:, None, None]
    ribbons(sheet, hooks, _HOOK_WIDTH * style.line_weight, dark * pull[:, None])
    _tongue_out(sheet, params, lip, style)


def _inside(sheet: Sheet, params: FaceParams, lip: Lips, style: FaceStyle) -> None:
    x, upper, lower = lip.x, lip.upper, lip.lower
    gap = upper - lower
    opening = float(gap.max())
    here = min(opening / 6.0, 1.0)
    tongue, teeth, clench = (float(params[INDEX[name]]) for name in ("tongue", "teeth", "teeth_clench"))
    if tongue > 1e-3:
        crest = np.minimum(lower + (0.56 * tongue * opening) * _HUMP, upper)
        rim = np.minimum(crest + FEATHER_MM, upper)
        pink = ink(style.tongue) * (tongue * here)
        warm = pink * (0.9, 0.78, 0.8, 1.0)
        sheet.grid(_strip(x, lower, crest, rim)[None], _shade(warm, pink, 0.0 * pink))
    if teeth > 1e-3:
        edge = np.maximum(upper - (teeth * min(0.30 * opening + 1.5, 10.0)) * _TOOTH_ROW, lower)
        rim = np.maximum(edge - FEATHER_MM, lower)
        white = ink(style.tooth) * (min(teeth * 3.0, 1.0) * here)
        sheet.grid(_strip(x, rim, edge, upper)[None], _shade(0.0 * white, white, white))
    if clench > 1e-3:
        white, line = ink(style.tooth) * (clench * here), ink(style.tooth_line) * (clench * here)
        sheet.grid(_strip(x, lower, upper)[None], _shade(white, white))
        middle = _strip(x, (upper + lower) / 2.0)
        ribbons(sheet, middle, 2.0 * np.minimum(gap / 6.0, 1.0), (0.9 * line)[None])
        foot, head = np.interp(_GAPS, _S, lower), np.interp(_GAPS, _S, upper)
        bars = np.empty((len(_GAPS), 5, 2))
        bars[..., 0] = np.interp(_GAPS, _S, x)[:, None]
        bars[..., 1] = foot[:, None] + (head - foot)[:, None] * _UNIT5
        ribbons(sheet, bars, 1.5, np.tile(0.6 * line, (len(_GAPS), 1)))


def _tongue_out(sheet: Sheet, params: FaceParams, lip: Lips, style: FaceStyle) -> None:
    """A tongue hanging over the lower lip; its root sits inside the opening."""
    out = float(params[INDEX["tongue_out"]])
    if out <= 1e-3:
        return
    shown = min(out * 4.0, 1.0)
    at = lip.x[_MIDDLE] + min(0.54 * float(params[INDEX["mouth_width"]]), 20.0) * _TONGUE_U
    root = np.interp(at, lip.x, 0.35 * lip.upper + 0.65 * lip.lower)
    length = 31.0 * out
    tip = np.minimum(root.min() - length * _TONGUE_ROUND, root)
    pink = ink(style.tongue) * shown
    colour = np.empty((1, 2, len(at), 4))
    colour[0, 0], colour[0, 1] = pink, pink * (0.97, 0.84, 0.84, 1.0)
    sheet.grid(_strip(at, tip, root)[None], colour, late=True)
    dark = ink(style.lip) * shown
    ribbons(sheet, _strip(at, tip), 3.0 * style.line_weight, dark[None], late=True)
    groove = np.empty((1, 8, 2))
    groove[0, :, 0] = lip.x[_MIDDLE]
    groove[0, :, 1] = np.linspace(float(root[10]) - 0.1 * length, float(tip[10]) + 0.42 * length, 8)
    ribbons(sheet, groove, np.linspace(2.0, 0.8, 8), 0.6 * dark[None], late=True)
