"""What an automatic annotator looks at: per frame, where the body is and how it moves in windows around that frame.

After Arikan, Forsyth and O'Brien (2003), whose classifiers see a frame's joints with a second of context either side.
Places are taken relative to the chest's own front as well as to the stall, so that a lean is seen and a hand at the
mouth is a hand at the mouth wherever the body leans.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, uniform_filter1d

from game.core import quaternion as quat
from game.core.humanoid import REFERENCE
from game.embos.clips import TakeClip
from game.tools.observer.keypoints import POINT, keypoints

__all__ = ["RATE_HZ", "frame_features"]

Floats = NDArray[np.floating[Any]]

RATE_HZ = 10.0
"""Frames a second that are looked at; edges are found to half of it."""
_WINDOWS_S = (0.4, 1.2, 3.0)
_AHEAD_S = (-0.8, -0.4, 0.4, 0.8)
_HANDS = ("left_wrist", "right_wrist", "left_tip", "right_tip")
_FINGERS = [
    REFERENCE.index[f"{side}{finger}Proximal"] for side in ("left", "right") for finger in ("Index", "Middle", "Little")
]
_BANDS_HZ = (1.0, 2.0, 3.5, 6.0)


def frame_features(clip: TakeClip) -> Floats:
    """(T, D) float32 at RATE_HZ: T frames of the clip's length."""
    step_s = 1.0 / RATE_HZ
    count = max(int(clip.length_s / step_s), 1)
    pick = np.minimum(np.round(np.arange(count) * step_s / clip.frame_time_s).astype(int), len(clip.rotation) - 1)
    points = keypoints(clip.rotation, clip.root)
    fps = 1.0 / clip.frame_time_s
    base = _frame(points, clip.rotation)
    speed = np.linalg.norm(np.gradient(points, axis=0), axis=-1) * fps
    parts = [base[pick]]
    for window_s in _WINDOWS_S:
        size = max(round(window_s * fps), 1)
        mean = uniform_filter1d(base, size, axis=0, mode="nearest")
        square = uniform_filter1d(base * base, size, axis=0, mode="nearest")
        parts += [mean[pick], np.sqrt(np.maximum(square - mean * mean, 0.0))[pick]]
        parts.append(np.log(uniform_filter1d(speed, size, axis=0, mode="nearest") + 1e-3)[pick])
    smooth = gaussian_filter1d(base, 0.08 * fps, axis=0, mode="nearest")
    for ahead_s in _AHEAD_S:
        at = np.clip(pick + round(ahead_s * fps), 0, len(points) - 1)
        parts.append(smooth[at] - smooth[pick])
    parts.append(_rhythm(points, fps)[pick])
    return np.concatenate(parts, axis=1).astype(np.float32)


def _frame(points: Floats, rotation: Floats) -> Floats:
    """(F, C) places: points in the stall's space and in the chest's, fingers' bend, distances of the hands."""
    _, turned = REFERENCE.to_model(rotation[:, :], _shifts(rotation))
    chest = turned[:, REFERENCE.index["chest"]]
    local = quat.rotate(quat.conjugate(chest)[:, None], points - points[:, [POINT["chest"]]])
    head = turned[:, REFERENCE.index["head"]]
    front = quat.rotate(head, np.broadcast_to(np.array([0.0, 0.0, 1.0], dtype=head.dtype), (len(head), 3)))
    up = quat.rotate(chest, np.broadcast_to(np.array([0.0, 1.0, 0.0], dtype=head.dtype), (len(head), 3)))
    hands = points[:, [POINT[name] for name in _HANDS]]
    others = points[:, [POINT[n] for n in ("nose", "crown", "chest", "hips", "left_elbow", "right_elbow")]]
    apart = np.linalg.norm(hands[:, :, None] - others[:, None], axis=-1).reshape(len(points), -1)
    between = np.linalg.norm(hands[:, [0, 2]] - hands[:, [1, 3]], axis=-1)
    bend = 2.0 * np.arccos(np.clip(np.abs(rotation[:, _FINGERS, 3]), 0.0, 1.0))
    stall = points[:, [POINT[n] for n in ("hips", "chest", "head", *_HANDS)]].reshape(len(points), -1)
    return np.concatenate([local.reshape(len(points), -1), stall, front, up, apart, between, bend], axis=1)


def _shifts(rotation: Floats) -> Floats:
    return np.broadcast_to(REFERENCE.rest_translation.astype(rotation.dtype), (*rotation.shape[:-1], 3)).copy()


def _rhythm(points: Floats, fps: float) -> Floats:
    """(F, C) log amplitude of hands, head and hips in bands of frequency: tapping, trembling, bouncing, nodding."""
    own = points[:, [POINT[n] for n in (*_HANDS, "nose", "hips")]].reshape(len(points), -1)
    rows = []
    for low, high in itertools.pairwise(_BANDS_HZ):
        band = gaussian_filter1d(own, fps / (2 * np.pi * high), axis=0) - gaussian_filter1d(
            own, fps / (2 * np.pi * low), axis=0
        )
        rows.append(np.log(np.sqrt(uniform_filter1d(band * band, round(0.8 * fps), axis=0)) + 1e-4))
    return np.concatenate(rows, axis=1)
