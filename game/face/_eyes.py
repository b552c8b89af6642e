"""The eyes: lids as two curves over one abscissa that may meet, the eyeball filling exactly the space between them.

The GPU painter has no clipping, so iris, pupil and lights are polar grids whose points are pressed between the lids
at their own x. Local coordinates are those of the character's left eye (x outward); the right eye is mirrored.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.face.mesh import Sheet, bezier, discs, rgb, ribbons, tint
from game.face.params import INDEX, FaceParams
from game.face.style import FaceStyle

__all__ = ["Lids", "eyeballs", "lashes", "lids"]

Floats = NDArray[np.float64]
_COLUMNS = 41
_U = (1.0 - np.cos(np.linspace(0.0, np.pi, _COLUMNS))) / 2.0  # dense at both corners, where the lids are steep
_SIDE = np.array([1.0, -1.0])  # character's left eye, right eye
_CLOSING = 0.5  # below this opening the lids approach the line on which they meet
_IRIS_RINGS = np.array([0.0, 0.3, 0.55, 0.75, 0.87, 0.93, 1.0, 1.05])
_SPOT_RINGS = np.array([0.0, 0.92, 1.0, 1.12])


def _smooth(x: Floats | float) -> Floats:
    t = np.clip(x, 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


@dataclass(frozen=True)
class Lids:
    """Lid curves of both eyes in local mm: x, upper, lower (2, n) with upper ≥ lower; ajar (2,) 0 closed … 1 free."""

    x: Floats
    upper: Floats
    lower: Floats
    ajar: Floats

    def between(self, point: Floats) -> Floats:
        """Points (2, m, n, 2) pressed into the opening: x between the corners, y between the lids at that x."""
        result = np.empty_like(point)
        for side in range(2):
            x = np.clip(point[side, ..., 0], self.x[side, 0], self.x[side, -1])
            low = np.interp(x, self.x[side], self.lower[side])
            high = np.interp(x, self.x[side], self.upper[side])
            result[side, ..., 0] = x
            result[side, ..., 1] = np.minimum(np.maximum(point[side, ..., 1], low), high)
        return result


def lids(params: FaceParams) -> Lids:
    """The lid curves of an expression (K,)."""
    opening, squint, slant = (params[INDEX[n]] for n in ("eye_open", "eye_squint", "eye_slant"))
    flat, arc, uneven = (params[INDEX[n]] for n in ("eye_flat", "eye_arc", "eye_uneven"))
    opened = opening * (1.0 - np.clip(_SIDE * -uneven, 0.0, 1.0))  # (2,)
    ajar = _smooth(opened / _CLOSING)
    fierce, sad = max(slant, 0.0), max(-slant, 0.0)
    squeeze = params[INDEX["eye_squeeze"]]

    x = np.empty((2, _COLUMNS))
    upper = np.empty((2, _COLUMNS))
    lower = np.empty((2, _COLUMNS))
    for side in range(2):
        o, k = opened[side], ajar[side]
        shut = 1.0 - min(o, 1.0)
        inner_y = 2.0 - 7.0 * fierce + 6.3 * sad - 11.0 * shut
        outer_y = 4.0 + 9.0 * slant - 13.0 * shut
        height = 40.0 * o
        bottom_y = -37.0 + 30.0 * squint - 4.0 * max(o - 1.0, 0.0) / 0.3
        crown = inner_y + (height * 0.98 - inner_y * 0.4) * (1.0 - 0.42 * flat) - 11.7 * fierce
        inner, outer = (-29.0, inner_y), (32.0, outer_y)
        top = bezier([inner, (-23.0 + 2.0 * flat, crown), (12.0, height + 9.0 - 14.0 * flat + 5.0 * slant), outer])
        low = bezier(
            [
                [inner, (-27.0, -20.0 + 14.0 * squint), (-12.0, bottom_y), (5.0, bottom_y)],
                [(5.0, bottom_y), (24.0, bottom_y + 1.0), (34.0, -14.0 + 10.0 * squint), outer],
            ],
            14,
        ).reshape(-1, 2)
        along = -29.0 + 61.0 * _U
        free_top = np.interp(along, top[:, 0], top[:, 1])
        free_low = np.interp(along, np.maximum.accumulate(np.minimum(low[:, 0], 32.0)), low[:, 1])
        # The line on which the lids meet: an arch for a happy eye, a hammock for a sleeping one.
        bow = 4.0 * _U * (1.0 - _U)
        rise = bow * (27.0 * max(arc, 0.0) + 26.0 * min(arc, 0.0)) + 6.0 * _U * min(arc, 0.0)
        meet = (1.0 - squeeze) * (-7.0 - 3.0 * max(arc, 0.0) + rise) - 12.0 * squeeze
        x[side] = along + (1.0 - k) * (4.0 * _U - 2.0)
        upper[side] = meet + k * (free_top - meet)
        lower[side] = meet + k * (free_low - meet)
    return Lids(x, np.maximum(upper, lower), np.minimum(upper, lower), ajar)


def _place(local: Floats, style: FaceStyle) -> Floats:
    """Local points (2, ..., 2) of both eyes -> head mm."""
    side = _SIDE.reshape(2, *([1] * (local.ndim - 2)))
    x = side * (style.eye_x + style.eye_scale * local[..., 0])
    return np.stack([x, style.eye_y + style.eye_scale * local[..., 1]], axis=-1)


def _band(lid: Lids, low: Floats, high: Floats) -> Floats:
    """Strip (2, 2, n, 2) between two curves (2, n) over the lids' abscissa."""
    return np.stack([np.stack([lid.x, low], axis=-1), np.stack([lid.x, high], axis=-1)], axis=1)


def _iris_colour(relative: Floats, style: FaceStyle) -> Floats:
    """Colour (..., 3) at places (..., 2) relative to the iris (±1 at its rim): dark top, bright bottom, glow, rim."""
    stops = np.array([rgb(c) for c in style.iris])
    level = (1.0 - relative[..., 1]) / 2.0  # 0 at the top
    channels = [np.interp(level, [0.0, 0.36, 0.66, 1.0], stops[:, i]) for i in range(3)]
    colour = np.stack(channels, axis=-1)
    glow = np.hypot(relative[..., 0], (relative[..., 1] + 0.62) * 1.25) / 0.95
    amount = 0.85 * np.clip(1.0 - glow, 0.0, 1.0)[..., None]
    colour = colour + (rgb(style.iris_glow) - colour) * amount
    radius = np.hypot(relative[..., 0], relative[..., 1])
    rim = np.clip((radius - 0.86) / 0.07, 0.0, 1.0)[..., None]
    return np.asarray(colour + (rgb(style.iris_rim) - colour) * rim)


def eyeballs(sheet: Sheet, params: FaceParams, lid: Lids, style: FaceStyle) -> None:
    """White, iris, pupil, the lid's shadow, lights and water, all inside the opening."""
    if not (lid.ajar > 0.0).any():
        return
    visible = _smooth(lid.ajar * 4.0)[:, None, None]
    white = _band(lid, lid.lower, lid.upper)
    sheet.grid(_place(white, style), tint(rgb(style.eye_white), np.broadcast_to(visible, white.shape[:-1])))

    look_x, look_y = params[INDEX["look_x"]], params[INDEX["look_y"]]
    centre = np.stack([10.0 * look_x * _SIDE - 1.5, np.full(2, -2.0 + 8.0 * look_y)], axis=-1)  # (2, 2)
    size, alpha = params[INDEX["iris_size"]], params[INDEX["iris_alpha"]]
    radius = np.broadcast_to(np.array([23.5, 30.0]) * size, (2, 2))
    if alpha > 1e-3:
        iris = lid.between(discs(centre, radius, _IRIS_RINGS, 36))
        relative = (iris - centre[:, None, None]) / radius[:, None, None]
        edge = np.clip((1.05 - np.hypot(relative[..., 0], relative[..., 1])) / 0.05, 0.0, 1.0)
        sheet.grid(_place(iris, style), tint(_iris_colour(relative, style), edge * alpha * visible))

        pupil_radius = np.broadcast_to(np.array([9.5, 13.0]) * size * params[INDEX["pupil_size"]], (2, 2))
        pupil_centre = centre + np.array([0.0, 3.0]) * size
        pupil = lid.between(discs(pupil_centre, pupil_radius, np.array([0.0, 0.9, 1.0, 1.12])))
        offset = (pupil - pupil_centre[:, None, None]) / pupil_radius[:, None, None]
        edge = np.clip((1.12 - np.hypot(offset[..., 0], offset[..., 1])) / 0.12, 0.0, 1.0)
        sheet.grid(_place(pupil, style), tint(rgb(style.pupil), edge * alpha * visible))

    depth = np.maximum(lid.upper - np.array([4.0, 9.5])[:, None, None], lid.lower)  # (2 levels, 2 eyes, n)
    shade = np.stack(
        [
            np.stack([lid.x, depth[1]], axis=-1),
            np.stack([lid.x, depth[0]], axis=-1),
            np.stack([lid.x, lid.upper], axis=-1),
        ],
        axis=1,
    )
    strength = np.broadcast_to(np.array([0.0, 0.34, 0.36])[None, :, None], shade.shape[:-1]) * visible
    sheet.grid(_place(shade, style), tint(rgb(style.lid_shadow), strength))
    _lights(sheet, params, lid, style, centre, visible)

    well = params[INDEX["tear_well"]]
    if well > 1e-3:
        water = np.minimum(lid.lower + 9.0 * well * (1.0 + 0.15 * np.sin(9.0 * _U)), lid.upper)
        band = _band(lid, lid.lower, water)
        amount = np.broadcast_to(np.array([0.92, 0.7])[None, :, None] * well, band.shape[:-1]) * visible
        sheet.grid(_place(band, style), tint(rgb("#DDF6FF"), amount))
        line = np.stack([lid.x, np.minimum(water, lid.upper)], axis=-1)
        ribbons(sheet, _place(line, style), 1.3, tint(rgb("#7FC4E0"), 0.9 * well * visible[:, 0, 0]))


def _lights(sheet: Sheet, params: FaceParams, lid: Lids, style: FaceStyle, centre: Floats, visible: Floats) -> None:
    """Light spots stand on the same screen side in both eyes; sparkle turns the spots to stars."""
    size, sparkle = params[INDEX["highlight"]], params[INDEX["sparkle"]]
    well, blank = params[INDEX["tear_well"]], params[INDEX["iris_alpha"]]
    spots = (
        # x on the screen, y, radii, alpha
        (-8.5, 11.0, 8.2 * size, 9.8 * size, 1.0),
        (9.5, -13.0, 4.1 * size + 2.6 * well, 4.1 * size + 2.0 * well, 0.95),
        (3.0, -21.0, 2.1 * size, 2.1 * size, 0.7),
        (-7.0, -15.0, 3.6 * well, 3.0 * well, 0.9),
    )
    for x, y, rx, ry, alpha in spots:
        if rx < 0.05:
            continue
        where = centre + np.stack([x * _SIDE, np.full(2, y)], axis=-1)
        spot = lid.between(discs(where, np.broadcast_to(np.array([rx, ry]), (2, 2)), _SPOT_RINGS, 20))
        offset = (spot - where[:, None, None]) / np.array([rx, ry])
        edge = np.clip((1.12 - np.hypot(offset[..., 0], offset[..., 1])) / 0.12, 0.0, 1.0)
        sheet.grid(_place(spot, style), tint(np.ones(3), edge * alpha * blank * visible))
    if sparkle > 1e-3:
        angle = np.linspace(0.0, 2.0 * np.pi, 33)
        ray = 0.28 + 0.72 * np.abs(np.cos(2.0 * angle)) ** 5  # four points
        for x, y, radius in ((-7.0, 9.0, 17.0), (9.0, -14.0, 9.0)):
            where = centre + np.stack([x * _SIDE, np.full(2, y)], axis=-1)
            star = discs(where, np.full((2, 2), radius * sparkle), np.array([0.0, 0.9, 1.08]), 32)
            star = where[:, None, None] + (star - where[:, None, None]) * ray[None, None, :, None]
            edge = np.broadcast_to(np.array([1.0, 1.0, 0.0])[None, :, None], star.shape[:-1])
            sheet.grid(_place(lid.between(star), style), tint(np.ones(3), edge * blank * visible))


def lashes(sheet: Sheet, params: FaceParams, lid: Lids, style: FaceStyle, *, over: bool) -> None:
    """Upper lash with its wing, lower lash line and the crease above; ``over`` keeps only what is drawn on the hair."""
    squeeze = float(params[INDEX["eye_squeeze"]]) * (1.0 - lid.ajar)  # (2,) only shut eyes are squeezed
    shut = 1.0 - lid.ajar
    dark = rgb(style.lash)
    weight = style.line_weight
    upper = np.stack([lid.x, lid.upper + 2.2 + 25.0 * squeeze[:, None] * _U], axis=-1)
    open_width = np.interp(_U, [0.0, 0.12, 0.5, 0.85, 1.0], [2.5, 6.5, 9.5, 10.5, 7.5])
    shut_width = 3.0 + 7.5 * np.sin(np.pi * np.clip(_U * 0.85 + 0.12, 0.0, 1.0))
    squeezed_width = 4.5 + 4.5 * np.sin(np.pi * np.clip(_U * 0.9 + 0.05, 0.0, 1.0))
    width = open_width + shut[:, None] * (shut_width - open_width)
    width = (width + squeeze[:, None] * (squeezed_width - width)) * weight * style.eye_scale
    lower = np.stack([lid.x, lid.lower - 1.0 - 23.0 * squeeze[:, None] * _U], axis=-1)
    lower_width = np.interp(_U, [0.0, 0.28, 0.75, 1.0], [0.0, 0.6, 3.0, 3.4]) * (1.0 - 0.5 * shut[:, None])
    lower_width = (lower_width + squeeze[:, None] * (squeezed_width - lower_width)) * weight * style.eye_scale
    soft = rgb(style.lower_lash) + squeeze[:, None] * (dark - rgb(style.lower_lash))
    if not over:
        high = lid.upper + 10.5
        crease = np.stack([lid.x, high], axis=-1)[:, 6:30]
        crease_width = 1.0 + 1.8 * np.sin(np.linspace(0.0, np.pi, crease.shape[1]))
        ribbons(sheet, _place(crease, style), crease_width, tint(rgb(style.crease), 0.85 * lid.ajar))
        ribbons(sheet, _place(lower, style), lower_width, tint(soft, 0.95 * np.ones(2)))
    elif (squeeze > 0.0).any():
        ribbons(sheet, _place(lower, style), lower_width, tint(soft, squeeze))
    ribbons(sheet, _place(upper, style), width, tint(dark, np.ones(2)))
    tip = upper[:, -1] - np.array([0.0, 2.2])
    for points, thick, n in (
        (((-7.0, 7.0), (0.0, 3.0), (7.0, 4.0), (13.0, 10.0)), 9.0, 12),
        (((-3.0, 0.0), (2.0, -3.0), (6.0, -3.0), (10.0, 0.0)), 6.0, 12),
    ):
        wing = tip[:, None] + bezier(points, n)
        taper = np.linspace(thick, 0.8, n) * weight * style.eye_scale
        ribbons(sheet, _place(wing, style), taper, tint(dark, 1.0 - _smooth(squeeze * 2.0)))
