"""The skin as a part of the expression: blush, flush, pallor, gloom, and the drawn signs (tear, sweat drop, vein)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from game.face.mesh import Sheet, bezier, discs, rgb, ribbons, tint
from game.face.params import INDEX, FaceParams
from game.face.style import FaceStyle

__all__ = ["complexion", "drops", "signs"]

Floats = NDArray[np.float64]
_RINGS = np.linspace(0.0, 1.0, 7)
_SOFT = (1.0 - _RINGS**2) ** 1.5
_SIDE = (1.0, -1.0)


def _ovals(sheet: Sheet, shapes: list[tuple[float, float, float, float]], colour: str, alpha: float) -> None:
    """Soft-edged ellipses (x, y, rx, ry)."""
    if alpha <= 1e-3:
        return
    array = np.array(shapes)
    position = discs(array[:, :2], array[:, 2:], _RINGS, 28)
    amount = np.broadcast_to(_SOFT[None, :, None] * min(alpha, 1.0), position.shape[:-1])
    sheet.grid(position, tint(rgb(colour), amount))


def _veil(sheet: Sheet, heights: ArrayLike, alphas: ArrayLike, colour: str) -> None:
    """Horizontal gradient bands over the whole width."""
    y = np.asarray(heights, dtype=np.float64)
    x = np.linspace(-168.0, 168.0, 3)
    position = np.stack(np.broadcast_arrays(x[None, :], y[:, None]), axis=-1)
    amount = np.broadcast_to(np.asarray(alphas, dtype=np.float64)[:, None], position.shape[:-1])
    sheet.grid(position, tint(rgb(colour), amount))


def complexion(sheet: Sheet, params: FaceParams) -> None:
    """Everything that tints the skin, below all drawn features."""
    pale, gloom, sick, red = (float(params[INDEX[n]]) for n in ("pale", "gloom", "sick", "red"))
    if pale > 1e-3:
        _veil(sheet, [138.0, 40.0, -60.0, -190.0], np.array([0.5, 0.5, 0.42, 0.3]) * pale, "#E9ECF6")
        _veil(sheet, [138.0, 60.0, -30.0, -110.0], np.array([0.5, 0.38, 0.12, 0.0]) * pale, "#7C88BE")
    if sick > 1e-3:
        _veil(sheet, [138.0, 20.0, -60.0, -190.0], np.array([0.34, 0.30, 0.26, 0.34]) * sick, "#9DB78A")
        _ovals(sheet, [(0.0, -112.0, 105.0, 62.0)], "#7FA070", 0.42 * sick)
        _ovals(sheet, [(84.0, -78.0, 44.0, 26.0), (-84.0, -78.0, 44.0, 26.0)], "#86A06A", 0.40 * sick)
    if gloom > 1e-3:
        _veil(sheet, [138.0, 70.0, 10.0, -50.0, -100.0], np.array([0.88, 0.80, 0.55, 0.22, 0.0]) * gloom, "#56639F")
    if red > 1e-3:
        _ovals(sheet, [(0.0, -60.0, 165.0, 92.0)], "#F0412E", 0.46 * red)
        _ovals(sheet, [(84.0 * s, -74.0, 60.0, 42.0) for s in _SIDE], "#E8321F", 0.52 * red)
        _veil(sheet, [138.0, 70.0, 10.0, -40.0], np.array([0.55, 0.42, 0.18, 0.0]) * red, "#E84A38")
    blush = float(params[INDEX["blush"]])
    _ovals(sheet, [(90.0 * s, -80.0, 43.0, 27.0) for s in _SIDE], "#FF6257", 0.66 * min(blush, 1.0))
    if blush > 1.0:  # a deep blush crosses the nose
        _ovals(sheet, [(0.0, -74.0, 120.0, 30.0)], "#FF6257", 0.75 * (blush - 1.0))
    _strokes(sheet, params)


def _strokes(sheet: Sheet, params: FaceParams) -> None:
    lines = float(params[INDEX["blush_lines"]])
    if lines > 1e-3:
        stroke = bezier([(-5.0, -9.0), (-2.0, -3.0), (1.0, 3.0), (4.0, 8.0)], 10) * np.array([-1.0, 1.0])
        at = np.array([(90.0 * s + i * 13.0, -80.0) for s in _SIDE for i in (-1, 0, 1)])
        width = 1.2 + 2.8 * np.sin(np.linspace(0.0, np.pi, 10))
        ribbons(sheet, at[:, None] + stroke, width, tint(rgb("#E23F3A"), np.full(6, 0.78 * min(lines, 1.0))))
    gloom = float(params[INDEX["gloom_lines"]])
    if gloom > 1e-3:
        x = np.linspace(-84.0, 84.0, 11)
        length = np.array([30.0, 46.0, 34.0, 58.0, 40.0, 62.0, 36.0, 54.0, 42.0, 50.0, 28.0]) * (0.35 + 0.65 * gloom)
        y = np.linspace(0.0, 1.0, 8)
        high = np.stack(np.broadcast_arrays(x[:, None], 100.0 - length[:, None] * 1.5 * y), axis=-1)
        ribbons(sheet, high, np.linspace(4.6, 1.0, 8), tint(rgb("#3F4A8C"), np.full(11, 0.62 * gloom)))
        x = np.array([s * (40.0 + 14.0 * i) for s in _SIDE for i in range(4)])
        drop = np.array([15.0, 22.0, 18.0, 12.0] * 2) * (0.35 + 0.65 * gloom)
        low = np.stack(np.broadcast_arrays(x[:, None], -86.0 - drop[:, None] * y), axis=-1)
        ribbons(sheet, low, np.linspace(3.2, 0.8, 8), tint(rgb("#4E59A0"), np.full(8, 0.62 * gloom)))


def _drop(x: float, y: float, size: float) -> tuple[Floats, Floats]:
    """A hanging drop, 2:1: fill grid (2, n, 2) and closed outline (n, 2); its round bottom at y."""
    angle = np.linspace(0.0, np.pi, 17)
    # Teardrop curve: half width sin(a)·sin(a/2)^1.6 over height.
    half = size * 0.86 * np.sin(angle) * np.sin(angle / 2.0) ** 1.6
    height = y + size * 1.5 * (1.0 + np.cos(angle))
    right = np.stack([x + half, height], axis=-1)
    left = np.stack([x - half, height], axis=-1)
    return np.stack([left, right]), np.concatenate([right, left[::-1]])


def _water_drop(sheet: Sheet, x: float, y: float, size: float, alpha: float, fill: str, line: str) -> None:
    body, outline = _drop(x, y, size)
    top, bottom = rgb("#F4FDFF"), rgb(fill)
    level = np.clip((body[..., 1] - y) / (3.0 * size), 0.0, 1.0)[..., None]
    sheet.grid(body, tint(bottom + (top - bottom) * level, np.full(body.shape[:-1], 0.97 * alpha)))
    ribbons(sheet, outline[None], 2.6, tint(rgb(line), np.array([0.95 * alpha])))
    spot = discs([(x - 0.34 * size, y + 0.95 * size)], [(0.2 * size, 0.3 * size)], [0.0, 0.9, 1.1], 14)
    amount = np.broadcast_to(np.array([1.0, 1.0, 0.0])[None, :, None] * alpha, spot.shape[:-1])
    sheet.grid(spot, tint(np.ones(3), amount))


def drops(sheet: Sheet, params: FaceParams, style: FaceStyle) -> None:
    """Tears, drawn under the hair."""
    stream = float(params[INDEX["tear_stream"]])
    if stream > 1e-3:
        along = np.linspace(0.0, 1.0, 12)
        for side in _SIDE:
            for x0, x1, wide in ((34.0, 40.0, 7.5), (84.0, 92.0, 9.0)):
                reach = 66.0 * (0.3 + 0.7 * stream)
                y = style.eye_y - 40.0 - reach * along
                x = side * (x0 + (x1 - x0) * along**0.7)
                half = wide * (0.55 + 0.45 * along) * (0.4 + 0.6 * stream)
                body = np.stack([np.stack([x - half, y], axis=-1), np.stack([x + half, y], axis=-1)])
                fade = np.interp(along, [0.0, 0.1, 0.75, 1.0], [0.6, 0.86, 0.8, 0.0]) * stream
                sheet.grid(body, tint(rgb("#C4EEFF"), np.broadcast_to(fade, (2, 12))))
                edge = tint(rgb("#6BB4D8"), np.full(2, 0.75 * stream))
                taper = np.linspace(2.4, 0.4, 12)
                ribbons(sheet, body, taper, edge)
    tear = float(params[INDEX["tear"]])
    if tear > 1e-3:
        grow = 0.35 + 0.65 * tear
        shown = min(tear * 3.0, 1.0)
        _water_drop(sheet, 90.0, -106.0 + 6.0 * (1.0 - tear), 11.5 * grow, shown, "#9FDDF8", "#4E9FC9")
        if tear > 0.5:
            _water_drop(sheet, -90.0, -98.0, 8.5 * (tear - 0.5) * 2.0, (tear - 0.5) * 2.0, "#9FDDF8", "#4E9FC9")


def signs(sheet: Sheet, params: FaceParams) -> None:
    """Sweat drop and vein: drawn over the hair too, so a fringe never hides them."""
    vein = float(params[INDEX["vein"]])
    if vein > 1e-3:
        size = (0.45 + 0.75 * vein) * 1.15
        hook = np.array([(4.0, 18.0), (4.2, 8.4), (8.6, 4.2), (18.0, 4.0)])
        curve = bezier(hook, 14) * size
        turns = np.radians(12.0 + 90.0 * np.arange(4))
        spin = np.stack(
            [np.stack([np.cos(turns), np.sin(turns)], -1), np.stack([-np.sin(turns), np.cos(turns)], -1)], axis=1
        )
        arms = np.einsum("nk,rkj->rnj", curve, spin) + np.array([-92.0, 60.0])
        swell = 0.55 + 0.45 * np.sin(np.linspace(0.0, np.pi, 14))
        ribbons(sheet, arms, 12.0 * size * swell, tint(rgb("#FFF3E0"), np.full(4, min(vein * 2.0, 1.0))))
        ribbons(sheet, arms, 6.4 * size * swell, tint(rgb("#F0242A"), np.full(4, min(vein * 2.0, 1.0))))
    sweat = float(params[INDEX["sweat"]])
    if sweat > 1e-3:
        size = 13.5 * (0.45 + 0.55 * sweat)
        _water_drop(sheet, 104.0, 26.0 - 14.0 * sweat, size, min(sweat * 2.0, 1.0), "#A6E2FA", "#4F9CC8")
