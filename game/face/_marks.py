"""The skin as a part of the expression: blush, flush, glow, pallor, gloom, rings under the eyes, and the drawn signs
(tear, sweat drop, vein, z z z, a sigh's puff)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from game.face._eyes import Lids
from game.face._mouth import Lips
from game.face.mesh import Sheet, bezier, ink, polar, ribbons
from game.face.params import INDEX, FaceParams
from game.face.style import FaceStyle

__all__ = ["bags", "complexion", "drops", "puff", "signs"]

Floats = NDArray[np.float64]
Oval = tuple[float, float, float, float]  # x, y, rx, ry in mm
_RINGS = (0.0, 0.17, 0.34, 0.5, 0.67, 0.84, 1.0)
_DISC = polar(_RINGS, 24)
_SOFT = (1.0 - np.array(_RINGS) ** 2)[None, :, None, None] ** 1.5
_VEIL_X = np.array([-168.0, 0.0, 168.0])
_CHEEKS = (1.0, -1.0)
_UNIT8 = np.linspace(0.0, 1.0, 8)
_UNIT12 = np.linspace(0.0, 1.0, 12)

_BLUSH_STROKE = bezier(((5.0, -9.0), (2.0, -3.0), (-1.0, 3.0), (-4.0, 8.0)), 10)
_BLUSH_LINES = np.array([[(90.0 * s + i * 13.0, -80.0)] for s in _CHEEKS for i in (-1, 0, 1)]) + _BLUSH_STROKE
_BLUSH_WIDTH = 1.2 + 2.8 * np.sin(np.linspace(0.0, np.pi, 10))
_DREAD_X = np.linspace(-84.0, 84.0, 11)[:, None]
_DREAD = np.array([[45.0, 69.0, 51.0, 84.0, 60.0, 90.0, 54.0, 81.0, 63.0, 75.0, 42.0]]).T * _UNIT8
_BAGS_X = np.array([[s * (40.0 + 14.0 * i)] for s in _CHEEKS for i in range(4)])
_BAGS = np.array([[15.0, 22.0, 18.0, 12.0] * 2]).T * _UNIT8

_DROP_ANGLE = np.linspace(0.0, np.pi, 15)
_DROP_HALF = 0.86 * np.sin(_DROP_ANGLE) * np.sin(_DROP_ANGLE / 2.0) ** 1.6
_DROP_Y = 1.5 * (1.0 + np.cos(_DROP_ANGLE))
_SPOT = polar((0.0, 0.9, 1.15), 12)
_SPOT_EDGE = np.array([1.0, 1.0, 0.0])[None, :, None, None]

_VEIN_TURN = np.radians(12.0 + 90.0 * np.arange(4))
_VEIN_SPIN = np.array([[(np.cos(a), np.sin(a)), (-np.sin(a), np.cos(a))] for a in _VEIN_TURN])
_VEIN_ARMS = bezier(((4.0, 18.0), (4.2, 8.4), (8.6, 4.2), (18.0, 4.0)), 14) @ _VEIN_SPIN
_VEIN_WIDTH = 0.55 + 0.45 * np.sin(np.linspace(0.0, np.pi, 14))

_RING = bezier(((-19.0, 1.0), (-9.0, -7.0), (12.0, -7.0), (25.0, 2.0)), 12)  # from the lowest point of the lower lid
_RING_WIDTH = 0.8 + 2.6 * np.sin(np.linspace(0.0, np.pi, 12))
_LETTER_Z = np.array([((-1.0, 1.0), (1.0, 1.0)), ((1.0, 1.0), (-1.0, -1.0)), ((-1.0, -1.0), (1.0, -1.0))])
_LETTER_Z = _LETTER_Z * (0.8, 1.0) @ np.array([[0.98, 0.2], [-0.2, 0.98]])
_LETTER_PATHS = _LETTER_Z[:, :1] + (_LETTER_Z[:, 1:] - _LETTER_Z[:, :1]) * np.linspace(0.0, 1.0, 6)[:, None]
_SNOOZE = ((34.0, 56.0, 8.5), (60.0, 74.0, 11.0), (93.0, 95.0, 14.0))  # x, y, half size of each letter
_CLOUD_ANGLE = np.linspace(0.0, 2.0 * np.pi, 41)
_CLOUD_EDGE = 0.80 + 0.20 * np.abs(np.sin(2.5 * _CLOUD_ANGLE + 0.4))
_CLOUD = polar((0.0, 1.0), 40) * _CLOUD_EDGE[None, :, None] * (1.25, 1.0)


def _ovals(sheet: Sheet, shapes: tuple[Oval, ...], code: str, alpha: float) -> None:
    """Soft-edged ellipses."""
    if alpha <= 1e-3:
        return
    array = np.array(shapes)[:, None, None]
    position = array[..., :2] + _DISC * array[..., 2:]
    colour = np.empty((*position.shape[:3], 4))
    colour[...] = ink(code) * (_SOFT * min(alpha, 1.0))
    sheet.grid(position, colour)


def _veil(sheet: Sheet, amount: float, code: str, *steps: tuple[float, float]) -> None:
    """A vertical gradient over the whole width; steps are (height, alpha) from the top."""
    if amount <= 1e-3:
        return
    position = np.empty((1, len(steps), 3, 2))
    colour = np.empty((1, len(steps), 3, 4))
    position[..., 0] = _VEIL_X
    for i, (y, alpha) in enumerate(steps):
        position[0, i, :, 1] = y
        colour[0, i] = ink(code) * (alpha * amount)
    sheet.grid(position, colour)


def _cheeks(x: float, y: float, rx: float, ry: float) -> tuple[Oval, Oval]:
    return (x, y, rx, ry), (-x, y, rx, ry)


def complexion(sheet: Sheet, params: FaceParams, style: FaceStyle) -> None:
    """Everything that tints the skin, below all drawn features."""
    pale, gloom, sick, red, blush = (float(params[INDEX[n]]) for n in ("pale", "gloom", "sick", "red", "blush"))
    _veil(sheet, pale, "#E9ECF6", (138.0, 0.5), (40.0, 0.5), (-60.0, 0.42), (-190.0, 0.3))
    _veil(sheet, pale, "#7C88BE", (138.0, 0.5), (60.0, 0.38), (-30.0, 0.12), (-110.0, 0.0))
    _veil(sheet, sick, "#A9BD8C", (138.0, 0.34), (20.0, 0.28), (-60.0, 0.24), (-190.0, 0.32))
    _ovals(sheet, ((0.0, -112.0, 105.0, 62.0),), "#86A574", 0.30 * sick)
    _ovals(sheet, _cheeks(84.0, -78.0, 50.0, 32.0), "#86A46C", 0.34 * sick)
    _veil(sheet, gloom, "#56639F", (138.0, 0.88), (70.0, 0.80), (10.0, 0.55), (-50.0, 0.22), (-100.0, 0.0))
    _ovals(sheet, ((0.0, -60.0, 165.0, 92.0),), "#F0412E", 0.46 * red)
    _ovals(sheet, _cheeks(84.0, -74.0, 60.0, 42.0), "#E8321F", 0.52 * red)
    _veil(sheet, red, "#E84A38", (138.0, 0.55), (70.0, 0.42), (10.0, 0.18), (-40.0, 0.0))
    _ovals(sheet, _cheeks(86.0, -82.0, 50.0, 34.0), "#F26A4B", 0.60 * style.ruddy)
    _ovals(sheet, ((0.0, -74.0 + style.nose_y, 27.0, 19.0),), "#F0603F", 0.62 * style.ruddy)
    warm = float(params[INDEX["warm"]])
    _ovals(sheet, ((0.0, -92.0, 140.0, 74.0),), "#FFA85C", 0.30 * warm)
    _ovals(sheet, _cheeks(82.0, -84.0, 60.0, 40.0), "#FF8A5A", 0.52 * warm)
    _ovals(sheet, _cheeks(90.0, -80.0, 43.0, 27.0), "#FF6257", 0.66 * min(blush, 1.0))
    _ovals(sheet, ((0.0, -74.0, 120.0, 30.0),), "#FF6257", 0.75 * (blush - 1.0))  # a deep blush crosses the nose

    lines, dread = float(params[INDEX["blush_lines"]]), float(params[INDEX["gloom_lines"]])
    if lines > 1e-3:
        colour = np.tile(ink("#E23F3A") * (0.78 * lines), (6, 1))
        ribbons(sheet, _BLUSH_LINES, _BLUSH_WIDTH, colour)
    if dread > 1e-3:
        grow = 0.35 + 0.65 * dread
        colour = ink("#3F4A8C") * (0.62 * dread)
        high = np.empty((len(_DREAD_X), 8, 2))
        high[..., 0], high[..., 1] = _DREAD_X, 100.0 - grow * _DREAD
        ribbons(sheet, high, 4.6 - 3.6 * _UNIT8, np.tile(colour, (len(high), 1)))
        low = np.empty((len(_BAGS_X), 8, 2))
        low[..., 0], low[..., 1] = _BAGS_X, -86.0 - grow * _BAGS
        ribbons(sheet, low, 3.2 - 2.4 * _UNIT8, np.tile(colour, (len(low), 1)))


def bags(sheet: Sheet, params: FaceParams, lid: Lids, style: FaceStyle) -> None:
    """Dark rings that hang from the lower lids, wherever those are."""
    amount = float(params[INDEX["bags"]])
    if amount <= 1e-3:
        return
    scale = style.eye_scale * np.array([1.0, style.eye_height])
    low = lid.lower.min(axis=1) - 6.0
    for side, y in zip(_CHEEKS, low.tolist(), strict=True):
        middle = np.array([style.eye_x, style.eye_y]) + np.array([2.0, y]) * scale
        _ovals(sheet, ((side * middle[0], middle[1] - 4.0, 34.0, 13.0),), "#7A5A86", 0.46 * amount)
        ring = ((_RING * scale) + middle) * (side, 1.0)
        ribbons(sheet, ring[None], _RING_WIDTH, ink("#8A5A72")[None] * (0.72 * amount))


def puff(sheet: Sheet, params: FaceParams, lip: Lips) -> None:
    """A small cloud of breath that leaves the mouth to the character's left."""
    amount = float(params[INDEX["sigh"]])
    if amount <= 1e-3:
        return
    size = 17.0 * (0.4 + 0.6 * amount)
    corner = np.array([lip.x[-1], lip.lower.min()])
    body = corner + (24.0 + 8.0 * amount, -8.0 * amount) + _CLOUD[None] * size
    colour = np.empty((*body.shape[:3], 4))
    colour[...] = ink("#FFFDF8") * (0.92 * min(2.0 * amount, 1.0))
    sheet.grid(body, colour, late=True)
    edge = ink("#8FA6C4")[None] * (0.9 * min(2.0 * amount, 1.0))
    ribbons(sheet, body[:, -1], 2.2, edge, late=True)


def _water_drop(sheet: Sheet, place: tuple[float, float], size: float, alpha: float, fill: str, over: bool) -> None:
    """A hanging drop three sizes high, its round bottom at ``place``."""
    x, y = place
    half, height = size * _DROP_HALF, y + size * _DROP_Y
    body = np.empty((1, 2, len(half), 2))
    body[0, 0, :, 0], body[0, 1, :, 0] = x - half, x + half
    body[..., 1] = height
    level = (_DROP_Y / 3.0)[:, None]
    colour = np.empty((1, 2, len(half), 4))
    colour[:] = (ink(fill) + (ink("#F4FDFF") - ink(fill)) * level) * (0.97 * alpha)
    sheet.grid(body, colour, late=True, over=over)
    outline = np.concatenate([body[0, 1], body[0, 0, ::-1]])[None]
    ribbons(sheet, outline, 2.6, ink("#4E9CC8")[None] * (0.95 * alpha), late=True, over=over)
    spot = np.array([x - 0.34 * size, y + 0.95 * size]) + _SPOT[None] * (0.16 * size, 0.26 * size)
    shine = np.empty((*spot.shape[:3], 4))
    shine[...] = _SPOT_EDGE * alpha
    sheet.grid(spot, shine, late=True, over=over)


def drops(sheet: Sheet, params: FaceParams, style: FaceStyle) -> None:
    """Tears, drawn under the hair."""
    stream, tear = float(params[INDEX["tear_stream"]]), float(params[INDEX["tear"]])
    if stream > 1e-3:
        y = style.eye_y - 40.0 - 66.0 * (0.3 + 0.7 * stream) * _UNIT12
        fade = np.interp(_UNIT12, (0.0, 0.1, 0.75, 1.0), (0.6, 0.86, 0.8, 0.0)) * stream
        colour = np.empty((4, 2, 12, 4))
        colour[:] = ink("#C4EEFF") * fade[:, None]
        body = np.empty((4, 2, 12, 2))
        body[..., 1] = y
        paths = ((45.0, 58.0, 7.5), (86.0, 97.0, 9.0))
        for i, (start, end, wide) in enumerate(paths):
            x = start + (end - start) * _UNIT12
            half = wide * (0.55 + 0.45 * _UNIT12) * (0.4 + 0.6 * stream)
            for j, side in enumerate(_CHEEKS):
                body[2 * i + j, 0, :, 0], body[2 * i + j, 1, :, 0] = side * x - half, side * x + half
        sheet.grid(body, colour, late=True)
        edge = np.tile(ink("#6BB4D8") * (0.75 * stream), (8, 1))
        ribbons(sheet, body.reshape(8, 12, 2), 2.4 - 2.0 * _UNIT12, edge, late=True)
    if tear > 1e-3:
        place = (92.0, -116.0 + 16.0 * (1.0 - tear))
        _water_drop(sheet, place, 15.0 * (0.35 + 0.65 * tear), min(tear * 3.0, 1.0), "#9FDDF8", False)
        second = 2.0 * (tear - 0.5)
        if second > 1e-3:
            _water_drop(sheet, (-92.0, -104.0), 11.0 * second, second, "#9FDDF8", False)


def signs(sheet: Sheet, params: FaceParams) -> None:
    """Sweat drop, vein and z z z: drawn over the hair too, so a fringe never hides them."""
    vein, sweat = float(params[INDEX["vein"]]), float(params[INDEX["sweat"]])
    if vein > 0.1:
        shown = min((vein - 0.1) * 2.5, 1.0)
        size = (0.45 + 0.75 * vein) * 1.15
        arms = _VEIN_ARMS * size + (-92.0, 60.0)
        for code, width in (("#FFF3E0", 12.0), ("#F0242A", 6.4)):
            colour = np.tile(ink(code) * shown, (4, 1))
            ribbons(sheet, arms, (width * size) * _VEIN_WIDTH, colour, late=True, over=True)
    snooze = float(params[INDEX["snooze"]])
    for i, (x, y, half) in enumerate(_SNOOZE):
        shown = min(max(3.0 * snooze - i, 0.0), 1.0)  # one letter after the other
        if shown > 1e-3:
            size = half * (0.55 + 0.45 * shown)
            letter = _LETTER_PATHS * size + (x, y)
            for code, width in (("#FFF6E6", 0.84), ("#4F6FB4", 0.4)):
                ribbons(sheet, letter, width * size, np.tile(ink(code) * shown, (3, 1)), late=True, over=True)
    if sweat > 1e-3:
        place = (104.0, 26.0 - 14.0 * sweat)
        _water_drop(sheet, place, 13.5 * (0.45 + 0.55 * sweat), min(sweat * 2.0, 1.0), "#A6E2FA", True)
