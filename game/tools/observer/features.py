"""Numbers that describe a stretch of movement: positions, distances, speeds, accelerations and their rhythm.

After what observers of bodies are known to use: lean, openness and the height of the hands (Mehrabian 1968, Coulson
2004), speed, force and jerkiness (Wallbott 1998; Pollick et al. 2001).
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.tools.observer.keypoints import POINT

__all__ = ["BANDS_HZ", "FPS", "describe"]

Floats = NDArray[np.floating[Any]]

FPS = 30.0
BANDS_HZ = (0.2, 0.6, 1.2, 2.2, 4.0, 7.0, 12.0)
"""Edges of the bands in which the rhythm of points is looked at."""
_QUANTILES = (0.1, 0.5, 0.9)
_RHYTHM_POINTS = ("head", "nose", "chest", "hips", "left_wrist", "right_wrist", "left_tip", "right_tip")
_SPEED_POINTS = ("nose", "chest", "hips", "left_elbow", "right_elbow", "left_wrist", "right_wrist")
_FLOOR = 1e-4
"""m, m/s: below this nothing is seen to move."""


def describe(points: Floats) -> Floats:
    """Windows (N, T, K, 3) of points at 30 fps, T >= 8 -> features (N, D)."""
    places = _places(points)
    moves = _moves(points)
    parts = [
        places.mean(axis=-1), places.std(axis=-1), *np.quantile(places, _QUANTILES, axis=-1),
        moves.mean(axis=-1), moves.std(axis=-1), *np.quantile(moves, _QUANTILES, axis=-1), _rhythm(points),
    ]  # fmt: skip
    return np.concatenate([np.asarray(part, dtype=np.float64) for part in parts], axis=-1)


def _pairs(left: Floats, right: Floats) -> list[Floats]:
    """What holds for either hand: the larger, the smaller, and how uneven."""
    return [np.maximum(left, right), np.minimum(left, right), np.abs(left - right)]


def _places(points: Floats) -> Floats:
    """(N, C, T) lengths over time, metres."""

    def at(name: str) -> Floats:
        return np.asarray(points[:, :, POINT[name]])

    def apart(a: str, b: str) -> Floats:
        return np.asarray(np.linalg.norm(at(a) - at(b), axis=-1))

    hips, neck, head, nose, crown, chest = (at(n) for n in ("hips", "neck", "head", "nose", "crown", "chest"))
    middle = 0.5 * (at("left_shoulder") + at("right_shoulder"))
    shoulders = at("left_shoulder") - at("right_shoulder")
    rows = [
        hips[..., 1], hips[..., 2], np.abs(hips[..., 0]), nose[..., 1], nose[..., 2],
        neck[..., 2] - hips[..., 2], np.abs(neck[..., 0] - hips[..., 0]), neck[..., 1] - hips[..., 1],
        (chest - hips)[..., 2], (head - neck)[..., 2], np.abs((head - neck)[..., 0]), (head - neck)[..., 1],
        (nose - head)[..., 1], np.abs((nose - head)[..., 0]), np.abs((crown - head)[..., 0]), (crown - head)[..., 2],
        middle[..., 1] - chest[..., 1], middle[..., 2] - chest[..., 2], neck[..., 1] - middle[..., 1],
        np.linalg.norm(shoulders, axis=-1), np.abs(shoulders[..., 1]), np.abs(shoulders[..., 2]),
        apart("left_wrist", "right_wrist"), apart("left_tip", "right_tip"), apart("left_elbow", "right_elbow"),
    ]  # fmt: skip
    sides: list[list[Floats]] = []
    for side, sign, other in (("left", 1.0, "right"), ("right", -1.0, "left")):
        wrist, elbow, tip = at(f"{side}_wrist"), at(f"{side}_elbow"), at(f"{side}_tip")
        shoulder = at(f"{side}_shoulder")
        sides.append([
            wrist[..., 1], wrist[..., 2], wrist[..., 1] - shoulder[..., 1], wrist[..., 2] - shoulder[..., 2],
            sign * (wrist - middle)[..., 0], sign * (elbow - shoulder)[..., 0], (elbow - shoulder)[..., 1],
            (elbow - shoulder)[..., 2], tip[..., 1] - wrist[..., 1], tip[..., 2] - wrist[..., 2],
            sign * (tip - wrist)[..., 0], np.linalg.norm(wrist - nose, axis=-1), np.linalg.norm(tip - nose, axis=-1),
            np.linalg.norm(tip - chest, axis=-1), np.linalg.norm(wrist - hips, axis=-1),
            apart(f"{side}_tip", f"{other}_elbow"), apart(f"{side}_wrist", f"{side}_shoulder"),
        ])  # fmt: skip
    for left, right in zip(*sides, strict=True):
        rows += _pairs(left, right)
    return np.stack(rows, axis=1)


def _log(values: Floats) -> Floats:
    return np.asarray(np.log(values + _FLOOR))


def _moves(points: Floats) -> Floats:
    """(N, C, T − 2) logarithms of speeds and accelerations, m/s and m/s²; turning of the head."""
    own = points[:, :, [POINT[n] for n in _SPEED_POINTS]].astype(np.float64)
    velocity = np.diff(own, axis=1) * FPS
    acceleration = np.diff(velocity, axis=1) * FPS
    speed = np.linalg.norm(velocity, axis=-1)[:, 1:].transpose(0, 2, 1)
    force = np.linalg.norm(acceleration, axis=-1).transpose(0, 2, 1)
    rise = velocity[:, 1:, :, 1].transpose(0, 2, 1)
    facing = points[:, :, POINT["nose"]] - points[:, :, POINT["head"]]
    turning = np.linalg.norm(np.diff(facing, axis=1), axis=-1)[:, 1:, None].transpose(0, 2, 1) * FPS
    rows = [*speed[:, :3].swapaxes(0, 1), turning[:, 0]]
    for values in (speed, force):
        for left in (3, 5):
            rows += _pairs(values[:, left], values[:, left + 1])[:2]
    rows += [*force[:, :3].swapaxes(0, 1)]
    logs = _log(np.stack(rows, axis=1))
    # Whether a rise or a fall is the faster one tells jumping for joy from collapsing.
    return np.concatenate([logs, rise[:, [0, 1, 2]]], axis=1)


def _rhythm(points: Floats) -> Floats:
    """(N, C) log power of points in bands of frequency: bounce, tremor, fidgeting, sway."""
    own = points[:, :, [POINT[n] for n in _RHYTHM_POINTS]].astype(np.float64)
    length = own.shape[1]
    own = own - own.mean(axis=1, keepdims=True)
    window = np.hanning(length + 2)[1:-1]
    power = np.abs(np.fft.rfft(own * window[:, None, None], axis=1)) ** 2 / (window**2).sum() / FPS
    level, upright = power.sum(axis=-1), power[..., 1]
    hz = np.fft.rfftfreq(length, 1.0 / FPS)
    bands = []
    for low, high in itertools.pairwise(BANDS_HZ):
        inside = (hz >= low) & (hz < high)
        for kind in (level, upright):
            band = kind[:, inside].sum(axis=1) if inside.any() else np.zeros(kind[:, 0].shape)
            # Left and right hand: the livelier and the calmer.
            hands = np.stack([band[:, 4:6].max(1), band[:, 4:6].min(1), band[:, 6:8].max(1), band[:, 6:8].min(1)], 1)
            bands.append(np.concatenate([band[:, :4], hands], axis=1))
    return np.asarray(0.5 * np.log(np.concatenate(bands, axis=1) + _FLOOR**2))
