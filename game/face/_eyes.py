"""The eyes: lids as two curves over one abscissa that may meet, the eyeball filling exactly the space between them.

The GPU painter has no clipping, so iris, pupil and lights are polar grids whose points are pressed between the lids
at their own x. Local coordinates are those of the character's left eye (x outward); the right eye is mirrored.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from game.face.mesh import Sheet, bezier, ink, polar, ribbons
from game.face.params import INDEX, FaceParams
from game.face.style import FaceStyle

__all__ = ["Lids", "eyeballs", "lashes", "lids"]

Floats = NDArray[np.float64]
_COLUMNS = 33
_U = (1.0 - np.cos(np.linspace(0.0, np.pi, _COLUMNS))) / 2.0  # dense at both corners, where the lids are steep
_ALONG = -29.0 + 61.0 * _U
_BOW = 4.0 * _U * (1.0 - _U)
_SIDE = np.array([1.0, -1.0])  # character's left eye, right eye
_MIRROR = np.array([[[1.0, 1.0]], [[-1.0, 1.0]]])
_CLOSING = 0.5  # below this opening the lids approach the line on which they meet

_SOFT = 0.12  # feather of small discs, as a share of their radius
_IRIS = polar((0.0, 0.35, 0.62, 0.85, 0.93, 1.0, 1.05), 28)
_PUPIL = polar((0.0, 1.0, 1.0 + _SOFT), 20)
_SPOT = polar((0.0, 1.0, 1.0 + _SOFT), 16)
_RAYS = 0.26 + 0.74 * np.abs(np.cos(2.0 * np.linspace(0.0, 2.0 * np.pi, 33))) ** 5  # a star of four points
_STAR = polar((0.0, 0.9, 1.1), 32) * _RAYS[None, :, None]
_STAR_EDGE = np.array([1.0, 1.0, 0.0])[None, :, None, None]

_OPEN_WIDTH = np.interp(_U, [0.0, 0.12, 0.5, 0.85, 1.0], [2.5, 6.5, 9.5, 10.5, 7.5])
_SHUT_WIDTH = 3.0 + 7.5 * np.sin(np.pi * np.clip(_U * 0.85 + 0.12, 0.0, 1.0))
_SQUEEZED_WIDTH = 4.5 + 4.5 * np.sin(np.pi * np.clip(_U * 0.9 + 0.05, 0.0, 1.0))
_LOWER_WIDTH = np.interp(_U, [0.0, 0.28, 0.75, 1.0], [0.7, 1.1, 3.0, 3.4])
_CREASE = slice(5, 25)
_CREASE_WIDTH = 1.0 + 1.8 * np.sin(np.linspace(0.0, np.pi, 20))
_WING = bezier(((-7.0, 4.8), (0.0, 0.8), (7.0, 1.8), (13.0, 7.8)), 12)
_LASH = bezier(((-3.0, -2.2), (2.0, -5.2), (6.0, -5.2), (10.0, -2.2)), 12)
_WINGS = np.stack([_WING, _LASH])
_WINGS_WIDTH = np.stack([np.linspace(9.0, 0.8, 12), np.linspace(6.0, 0.8, 12)])


def _smooth(x: float) -> float:
    t = min(max(x, 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


@dataclass(frozen=True)
class Lids:
    """Lid curves of both eyes in local mm: x, upper, lower (2, n) with upper ≥ lower; ajar (2,) 0 closed … 1 free."""

    x: Floats
    upper: Floats
    lower: Floats
    ajar: Floats

    def between(self, point: Floats) -> Floats:
        """Points (2, P, 2) pressed into the opening: x between the corners, y between the lids at that x."""
        result = np.empty_like(point)
        for side in range(2):
            at = self.x[side]
            x = np.minimum(np.maximum(point[side, :, 0], at[0]), at[-1])
            y = np.maximum(point[side, :, 1], np.interp(x, at, self.lower[side]))
            result[side, :, 0] = x
            np.minimum(y, np.interp(x, at, self.upper[side]), out=result[side, :, 1])
        return result


def lids(params: FaceParams) -> Lids:
    """The lid curves of an expression (K,)."""
    opening, squint, slant, flat, arc, squeeze, uneven = (
        float(params[INDEX[name]])
        for name in ("eye_open", "eye_squint", "eye_slant", "eye_flat", "eye_arc", "eye_squeeze", "eye_uneven")
    )
    # The line on which the lids meet: an arch for a happy eye, a hammock for a sleeping one.
    happy, sleepy = max(arc, 0.0), min(arc, 0.0)
    meet = _BOW * ((1.0 - squeeze) * (27.0 * happy + 26.0 * sleepy)) + _U * ((1.0 - squeeze) * 6.0 * sleepy)
    meet = meet - (1.0 - squeeze) * (7.0 + 3.0 * happy) - 12.0 * squeeze
    x = np.empty((2, _COLUMNS))
    upper = np.empty((2, _COLUMNS))
    lower = np.empty((2, _COLUMNS))
    ajar = np.empty(2)
    for side, share in enumerate((1.0 - max(-uneven, 0.0), 1.0 - max(uneven, 0.0))):
        if side == 1 and uneven == 0.0:
            x[1], upper[1], lower[1], ajar[1] = x[0], upper[0], lower[0], ajar[0]
            break
        o = opening * share
        k = _smooth(o / _CLOSING)
        fierce, sad = max(slant, 0.0), max(-slant, 0.0)
        shut = 1.0 - min(o, 1.0)
        inner = (-29.0, 2.0 - 7.0 * fierce + 6.3 * sad - 11.0 * shut)
        outer = (32.0, 4.0 + 9.0 * slant - 13.0 * shut)
        height = 40.0 * o
        bottom = -37.0 + 30.0 * squint - 13.0 * max(o - 1.0, 0.0)
        crown = inner[1] + (height * 0.98 - inner[1] * 0.4) * (1.0 - 0.42 * flat) - 11.7 * fierce + 3.0 * sad
        top, low, rise = bezier(
            (
                (
                    inner,
                    (-23.0 + 2.0 * flat, crown),
                    (12.0, height + 9.0 - 14.0 * flat + 5.0 * fierce - 15.0 * sad),
                    outer,
                ),
                (inner, (-27.0, -20.0 + 14.0 * squint), (-12.0, bottom), (5.0, bottom)),
                ((5.0, bottom), (20.0, bottom), (32.0, -16.0 + 10.0 * squint), outer),
            ),
            18,
        )
        ground = np.concatenate([low, rise[1:]])
        free_top = np.interp(_ALONG, top[:, 0], top[:, 1])
        free_low = np.interp(_ALONG, ground[:, 0], ground[:, 1])
        x[side] = _ALONG + (1.0 - k) * (4.0 * _U - 2.0)
        upper[side] = meet + k * (free_top - meet)
        lower[side] = np.minimum(meet + k * (free_low - meet), upper[side])
        ajar[side] = k
    return Lids(x, upper, lower, ajar)


@lru_cache(maxsize=16)
def _frame(style: FaceStyle) -> tuple[Floats, Floats]:
    """Scale and offset (2, 1, 2) from local to head mm."""
    tall = _MIRROR * style.eye_scale * (1.0, style.eye_height)
    return tall, np.array([[[style.eye_x, style.eye_y]], [[-style.eye_x, style.eye_y]]])


def _place(local: Floats, style: FaceStyle) -> Floats:
    """Local points (2, P, 2) of both eyes -> head mm."""
    scale, offset = _frame(style)
    return np.asarray(local * scale + offset)


def _rows(x: Floats, *levels: Floats) -> Floats:
    """Curves (2, n) over one abscissa -> points (2, rows·n, 2)."""
    result = np.empty((2, len(levels), x.shape[1], 2))
    result[..., 0] = x[:, None]
    for i, level in enumerate(levels):
        result[:, i, :, 1] = level
    return result.reshape(2, -1, 2)


@lru_cache(maxsize=16)
def _iris_ramp(style: FaceStyle) -> Floats:
    """Colours (64, 3) from the iris' bottom to its top."""
    stops = np.array([ink(code)[:3] for code in style.iris])[::-1]
    level = np.linspace(0.0, 1.0, 64)
    return np.stack([np.interp(level, [0.0, 0.34, 0.64, 1.0], stops[:, i]) for i in range(3)], axis=-1)


def _iris_colour(relative: Floats, style: FaceStyle) -> Floats:
    """Colour (..., 4) at places (..., 2) relative to the iris (±1 at its rim): dark top, glow below, rim, soft edge."""
    x, y = relative[..., 0], relative[..., 1]
    ramp = _iris_ramp(style)
    colour = np.ones((*x.shape, 4))
    colour[..., :3] = ramp[np.minimum(np.maximum((y + 1.0) * 31.5, 0.0), 63.0).astype(np.intp)]
    across = x * x
    low = (y + 0.62) * 1.25
    glow = np.maximum(0.85 - np.sqrt(across + low * low) * (0.85 / 0.95), 0.0)
    colour += (ink(style.iris_glow) - colour) * glow[..., None]
    radius = np.sqrt(across + y * y)
    rim = np.minimum(np.maximum((radius - 0.86) / 0.07, 0.0), 1.0)
    colour += (ink(style.iris_rim) - colour) * rim[..., None]
    colour *= np.minimum(np.maximum((1.05 - radius) * 20.0, 0.0), 1.0)[..., None]
    return colour


def eyeballs(sheet: Sheet, params: FaceParams, lid: Lids, style: FaceStyle) -> None:
    """White, iris, pupil, the lid's shadow, lights and water, all inside the opening."""
    if lid.ajar.max() <= 0.0:
        return
    # While > < opens, the eyeball comes only when the strokes have nearly become lids.
    opened = 1.0 - _smooth((float(params[INDEX["eye_squeeze"]]) - 0.6) / 0.4)
    visible = np.array([opened * _smooth(4.0 * a) for a in lid.ajar.tolist()]).reshape(2, 1, 1, 1)
    white = _place(_rows(lid.x, lid.lower, lid.upper), style).reshape(2, 2, _COLUMNS, 2)
    sheet.grid(white, np.broadcast_to(ink(style.eye_white), (2, 2, _COLUMNS, 4)) * visible)

    look_x, look_y, size, blank, pupil_size, light, sparkle, well = (
        float(params[INDEX[name]])
        for name in (
            "look_x", "look_y", "iris_size", "iris_alpha", "pupil_size", "highlight", "sparkle", "tear_well",
        )
    )  # fmt: skip
    blank = _smooth((blank - 0.3) / 0.4)  # a half-faded iris looks blind: pass through it quickly
    centre = np.array([[[10.0 * look_x - 1.5, 11.0 * look_y - 2.0]], [[-10.0 * look_x - 1.5, 11.0 * look_y - 2.0]]])
    # Lights stand on the same screen side in both eyes: x is mirrored with the eye and back.
    spots = np.array(
        [
            (-8.5, 11.0, 8.2 * light, 9.8 * light, 1.0),
            (9.5, -13.0, 4.1 * light + 2.6 * well, 4.1 * light + 2.0 * well, 0.95),
            (3.0, -21.0, 2.1 * light, 2.1 * light, 0.7),
            (-7.0, -15.0, 3.6 * well + 0.01, 3.0 * well + 0.01, 0.9),
        ]
    )
    shown = visible * blank
    if blank > 1e-3:
        radius = np.array([23.5, 30.0]) * size
        iris = centre + _IRIS.reshape(1, -1, 2) * radius
        pupil_centre = centre + np.array([0.0, 3.0 * size])
        pupil_radius = np.array([9.5, 13.0]) * (size * pupil_size)
        pupil = pupil_centre + _PUPIL.reshape(1, -1, 2) * pupil_radius
        spot_centre = centre[:, :, None] + spots[None, :, None, :2] * _MIRROR[:, :, None]  # (2, 4, 1, 2)
        spot = spot_centre + _SPOT.reshape(1, 1, -1, 2) * spots[None, :, None, 2:4]
        n, m = iris.shape[1], iris.shape[1] + pupil.shape[1]
        inside = lid.between(np.concatenate([iris, pupil, spot.reshape(2, -1, 2)], axis=1))
        placed = _place(inside, style)

        # Colours and soft edges follow from where a point came to lie, not from where it started.
        relative = ((inside[:, :n] - centre) / radius).reshape(2, *_IRIS.shape)
        sheet.grid(placed[:, :n].reshape(relative.shape), _iris_colour(relative, style) * shown)
        relative = ((inside[:, n:m] - pupil_centre) / pupil_radius).reshape(2, *_PUPIL.shape)
        sheet.grid(placed[:, n:m].reshape(relative.shape), ink(style.pupil) * (_edge(relative) * shown))
        shade = np.minimum(np.maximum(lid.upper - 9.5, lid.lower), lid.upper)
        middle = np.maximum(lid.upper - 4.0, lid.lower)
        band = _place(_rows(lid.x, shade, middle, lid.upper), style).reshape(2, 3, _COLUMNS, 2)
        strength = np.array([0.0, 0.34, 0.36])[None, :, None, None] * visible
        sheet.grid(band, np.broadcast_to(ink(style.lid_shadow), (2, 3, _COLUMNS, 4)) * strength)
        relative = ((inside[:, m:].reshape(spot.shape) - spot_centre) / spots[None, :, None, 2:4]).reshape(
            8, *_SPOT.shape
        )
        alpha = (spots[None, :, 4] * shown.reshape(2, 1)).reshape(8, 1, 1, 1)
        sheet.grid(placed[:, m:].reshape(relative.shape), ink("#FFFFFF") * (_edge(relative) * alpha))
        if sparkle > 1e-3:
            at = centre[:, :, None] + np.array([[[(-7.0, 9.0)], [(9.0, -14.0)]]]) * _MIRROR[:, :, None]
            reach = np.array([18.0, 9.5]).reshape(1, 2, 1, 1) * sparkle
            star = lid.between((at + _STAR.reshape(1, 1, -1, 2) * reach).reshape(2, -1, 2))
            place = _place(star, style).reshape(4, *_STAR.shape)
            colour = np.broadcast_to(ink("#FFFFFF") * _STAR_EDGE, (4, *_STAR.shape[:2], 4))
            sheet.grid(place, colour * np.repeat(shown, 2, axis=0))
    if well > 1e-3:
        level = np.minimum(lid.lower + 9.0 * well * (1.0 + 0.15 * np.sin(9.0 * _U)), lid.upper)
        band = _place(_rows(lid.x, lid.lower, level), style)
        amount = np.array([0.92, 0.7])[None, :, None, None] * (visible * well)
        sheet.grid(band.reshape(2, 2, _COLUMNS, 2), np.broadcast_to(ink("#DDF6FF"), (2, 2, _COLUMNS, 4)) * amount)
        ribbons(sheet, band[:, _COLUMNS:], 1.3, ink("#7FC4E0") * (0.9 * well * visible[:, 0, 0]))


def _edge(relative: Floats) -> Floats:
    """Alpha (..., 1) of a soft-edged disc at places (..., 2) in units of its radius."""
    x, y = relative[..., 0], relative[..., 1]
    outer = (1.0 + _SOFT) ** 2  # a ramp over the square of the radius looks the same and needs no root
    return np.asarray(np.minimum(np.maximum((outer - x * x - y * y) / (outer - 1.0), 0.0), 1.0)[..., None])


def lashes(sheet: Sheet, params: FaceParams, lid: Lids, style: FaceStyle) -> None:
    """Upper lash with its wing, lower lash line and the crease above."""
    shut = (1.0 - lid.ajar)[:, None]
    squeeze = float(params[INDEX["eye_squeeze"]]) * shut  # only shut eyes are squeezed
    thick = style.line_weight * style.eye_scale
    dark, soft = ink(style.lash), ink(style.lower_lash)
    upper = _rows(lid.x, lid.upper + 2.2 + 25.0 * squeeze * _U)
    lower = _rows(lid.x, lid.lower - 1.0 - 23.0 * squeeze * _U)
    width = _OPEN_WIDTH + shut * (_SHUT_WIDTH - _OPEN_WIDTH)
    width = (width + squeeze * (_SQUEEZED_WIDTH - width)) * (thick * style.lash_weight)
    lower_width = _LOWER_WIDTH * (1.0 - 0.5 * shut)
    lower_width = (lower_width + squeeze * (_SQUEEZED_WIDTH - lower_width)) * thick
    squeezed = bool(squeeze.max() > 1e-3)
    crease = _rows(lid.x[:, _CREASE], lid.upper[:, _CREASE] + 10.5)
    ribbons(sheet, _place(crease, style), _CREASE_WIDTH, ink(style.crease) * (0.85 * lid.ajar)[:, None])
    ribbons(sheet, _place(lower, style), lower_width, soft + (dark - soft) * squeeze, over=squeezed)
    ribbons(sheet, _place(upper, style), width, np.stack([dark, dark]), over=True)
    if style.lash_wing == 0.0:
        return
    gone = np.minimum(squeeze * 2.0, 1.0)
    wings = (upper[:, None, -1:] + _WINGS * style.lash_wing).reshape(2, -1, 2)
    colour = np.repeat(dark * (1.0 - gone), 2, axis=0)
    ribbons(sheet, _place(wings, style).reshape(4, 12, 2), np.tile(_WINGS_WIDTH, (2, 1)) * thick, colour, over=True)
