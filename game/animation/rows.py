"""Frames of takes as rows (game.animation.channels): forward kinematics of whole spans, seamless loops, warps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import channels as ch
from game.core import quaternion as quat
from game.core.humanoid import PART_JOINTS, REFERENCE
from game.core.skeleton import Skeleton

__all__ = [
    "CROSSFADE_FRAMES",
    "REST_ROW",
    "TakeRows",
    "additive_rows",
    "align_to",
    "period_of",
    "resample",
    "seamless_loop",
    "take_rows",
]

Floats = NDArray[np.floating[Any]]
Rows = NDArray[np.floating[Any]]

CROSSFADE_FRAMES = 30
"""Frames over which a looped span's end melts into its start, at most a third of the span."""

REPEATS = 0.12
"""A movement is periodic when it differs from itself a period later by less than this share of its energy."""

_SIDES = ("left", "right")
_FINGERS = ("Middle", "Index", "Little")
_LEGS = [REFERENCE.index[name] for name in PART_JOINTS["legs"]]


def _upper_body() -> tuple[NDArray[np.intp], Skeleton]:
    """The joints whose places rows speak of, and those above them: in REFERENCE, and as a skeleton of their own."""
    index, parents = REFERENCE.index, REFERENCE.parents
    ends = [*(f"{s}{f}Intermediate" for s in _SIDES for f in _FINGERS), *ch.CONTACT_FRAMES[1:]]
    needed: set[int] = set()
    for joint in (index[name] for name in ends):
        while joint >= 0:
            needed.add(joint)
            joint = int(parents[joint])
    kept = np.array(sorted(needed), dtype=np.intp)
    above = np.where(parents[kept] < 0, -1, np.searchsorted(kept, parents[kept]))
    names = tuple(REFERENCE.names[joint] for joint in kept)
    return kept, Skeleton(names, above, REFERENCE.rest_translation[kept], REFERENCE.rest_rotation[kept])


_UPPER, _UPPER_BODY = _upper_body()
_INDEX = _UPPER_BODY.index
_WRISTS = [_INDEX[f"{s}Hand"] for s in _SIDES]


@dataclass(frozen=True, eq=False)
class TakeRows:
    """A whole take. base: (F, CHANNELS) without the hands' places; wrist: (F, 4, 2, 3) and palm: (F, 4, 2, 4) of both
    hands in each of CONTACT_FRAMES."""

    base: Rows
    wrist: Rows
    palm: Rows

    def span(self, frames: slice, hands: NDArray[np.intp]) -> Rows:
        """Rows of some frames; hands: (2,) contact frame of the left and of the right hand."""
        rows = self.base[frames].copy()
        both = np.arange(2)
        rows[:, ch.WRIST] = self.wrist[frames][:, hands, both].reshape(len(rows), -1)
        rows[:, ch.PALM] = self.palm[frames][:, hands, both].reshape(len(rows), -1)
        return rows


def take_rows(rotation: Floats, root: Floats) -> TakeRows:
    """rotation (F, 41, 4) local, root (F, 3): a take's frames in every space a unit may need them in.

    The legs are left straight: they follow from hips and planted feet, and a take's own may turn over when it ducks.
    """
    count = len(rotation)
    rotation = rotation.copy()
    rotation[:, _LEGS] = quat.IDENTITY
    position, turned = _to_model(rotation[:, _UPPER], root)
    base = np.zeros((count, ch.CHANNELS), dtype=np.float32)
    base[:, ch.ROTATION] = _continuous(rotation).reshape(count, -1)
    base[:, ch.ROOT] = root
    points = np.stack([_points_in_hand(side, position, turned) for side in _SIDES], axis=1)
    base[:, ch.POINTS] = points.reshape(count, -1)
    wrist = np.empty((count, len(ch.CONTACT_FRAMES), 2, 3), dtype=np.float32)
    palm = np.empty((count, len(ch.CONTACT_FRAMES), 2, 4), dtype=np.float32)
    place, turn = position[:, _WRISTS], turned[:, _WRISTS]
    wrist[:, 0], palm[:, 0] = place, turn
    for index, name in enumerate(ch.CONTACT_FRAMES[1:], 1):
        joint = _INDEX[name]
        back = quat.conjugate(turned[:, joint, None])
        wrist[:, index] = quat.rotate(back, place - position[:, joint, None])
        palm[:, index] = quat.multiply(back, turn)
    return TakeRows(base, wrist, _continuous(palm.reshape(count, -1, 4)).reshape(palm.shape))


def _to_model(rotation: Floats, root: Floats) -> tuple[Floats, Floats]:
    """Forward kinematics of the upper body: (F, J, 4) local and root (F, 3) -> (F, J, 3) and (F, J, 4) model space."""
    # As Skeleton.to_model, joint by joint and each component's frames side by side: a third of the time for long takes.
    local = np.ascontiguousarray(rotation.transpose(1, 2, 0))
    turned = np.empty_like(local)
    position = np.empty((len(local), 3, len(rotation)), dtype=local.dtype)
    rest = _UPPER_BODY.rest_translation.astype(local.dtype)
    turned[0], position[0] = local[0], root.T
    for joint in range(1, len(local)):
        above = int(_UPPER_BODY.parents[joint])
        parent = turned[above].T
        position[joint] = position[above] + quat.rotate(parent, rest[joint]).T
        turned[joint] = quat.multiply(parent, local[joint].T).T
    return position.transpose(2, 0, 1), turned.transpose(2, 0, 1)


def _points_in_hand(side: str, position: Floats, turned: Floats) -> Floats:
    """(F, 4, 3) middle knuckle and the tips of middle, index and little finger, in the hand's frame."""
    hand = _INDEX[f"{side}Hand"]
    joints = [_INDEX[f"{side}{finger}Intermediate"] for finger in _FINGERS]
    along = _UPPER_BODY.rest_translation[joints].astype(turned.dtype)
    tips = position[:, joints] + quat.rotate(turned[:, joints], np.broadcast_to(along, (len(position), 3, 3)))
    points = np.concatenate([position[:, joints[:1]], tips], axis=1) - position[:, hand, None]
    return quat.rotate(quat.conjugate(turned[:, hand, None]), points)


def _continuous(q: Floats) -> Floats:
    """Signs of (F, J, 4) chosen so that neighbouring frames share a hemisphere."""
    q = q.copy()
    turns = np.einsum("fji,fji->fj", q[1:], q[:-1]) < 0.0
    for joint in np.flatnonzero(turns.any(axis=0)):
        flipped = np.logical_xor.accumulate(turns[:, joint])
        q[1:, joint][flipped] *= -1.0
    return q


def _moving_mean(rows: Rows, span: int) -> Rows:
    """Mean over ``span`` frames around each; the first and the last frame go on beyond the ends."""
    # As scipy.ndimage.uniform_filter1d, whose import takes a third of the game's start.
    before, after = rows[:1].repeat(span // 2, axis=0), rows[-1:].repeat(span - span // 2, axis=0)
    total = np.cumsum(np.concatenate([before, rows, after]), axis=0, dtype=np.float64)
    total = np.concatenate([np.zeros_like(total[:1]), total])
    return np.asarray((total[span:] - total[:-span])[: len(rows)] / span, dtype=rows.dtype)


def _renormalise(rows: Rows) -> Rows:
    """Blended rows (..., CHANNELS) with their quaternions brought back to unit length, in place."""
    for part in (ch.ROTATION, ch.PALM):
        q = rows[..., part].reshape(*rows.shape[:-1], -1, 4)
        rows[..., part] = (q / np.maximum(np.sqrt(np.einsum("...i,...i->...", q, q)), 1e-6)[..., None]).reshape(
            rows[..., part].shape
        )
    return rows


def align_to(rows: Rows, reference: Rows) -> Rows:
    """Rows (F, CHANNELS) with whole quaternion channels flipped to the side of reference (CHANNELS,)."""
    along = rows.mean(axis=0) * reference
    signs = np.ones(ch.CHANNELS, dtype=rows.dtype)
    for part in (ch.ROTATION, ch.PALM):
        signs[part] = np.repeat(np.where(along[part].reshape(-1, 4).sum(-1) < 0.0, -1.0, 1.0), 4)
    return rows * signs if signs.min() < 0.0 else rows


def seamless_loop(rows: Rows) -> Rows:
    """(F, CHANNELS) -> (F − B + 1, CHANNELS) that can be played round and round; the last row repeats the first.

    The last B frames are cross-faded with the first B, so the end flows into the start without a seam.
    """
    count = len(rows)
    if count < 4:
        return np.concatenate([rows, rows[:1]])
    blend = max(min(CROSSFADE_FRAMES, count // 3), 1)
    u = ((np.arange(blend) + 1.0) / (blend + 1.0))[:, None]
    weight = (u * u * (3.0 - 2.0 * u)).astype(rows.dtype)
    loop = np.empty((count - blend + 1, ch.CHANNELS), dtype=rows.dtype)
    loop[:-1] = rows[blend:]
    loop[-1 - blend : -1] += (rows[:blend] - rows[count - blend :]) * weight
    loop[-1] = loop[0]
    return _renormalise(loop)


def resample(spans: Sequence[Rows], count: int, strokes: Sequence[tuple[float, float]] | None = None) -> Rows:
    """Each of V spans (F, CHANNELS) at ``count`` moments from first to last -> (V, count, CHANNELS).

    strokes: for each span (where its stroke is, where it shall be), as shares of the span; the strokes of variants
    that are mixed align.
    """
    low = np.empty((len(spans), count), dtype=np.intp)
    high, part = np.empty_like(low), np.empty((len(spans), count, 1), dtype=np.float32)
    first, u = 0, np.linspace(0.0, 1.0, count)
    for i, rows in enumerate(spans):
        at = u * (len(rows) - 1)
        if strokes is not None:
            source, goal = (min(max(share, 0.05), 0.95) for share in strokes[i])
            at = np.interp(u, [0.0, goal, 1.0], [0.0, source, 1.0]) * (len(rows) - 1)
        below = np.minimum(at.astype(np.intp), max(len(rows) - 2, 0))
        low[i], high[i] = first + below, first + np.minimum(below + 1, len(rows) - 1)
        part[i, :, 0] = at - below
        first += len(rows)
    together = np.concatenate(spans)
    result = together.take(low, axis=0)
    step = together.take(high, axis=0)
    step -= result
    step *= part
    result += step
    return _renormalise(result)


def additive_rows(rows: Rows, owned: NDArray[np.bool_], share: float) -> Rows:
    """What units (..., F, CHANNELS) add where they own nothing: their departure from the straight way between their
    ends.

    owned: (PARTS,) bool. Owned channels stay as they are, torso and head keep ``share`` of their departure as a
    small rotation (vector part of a quaternion), everything else becomes 0.
    """
    count = rows.shape[-2]
    result = rows * owned[ch.PART_OF_CHANNEL].astype(rows.dtype)
    line = np.linspace(0.0, 1.0, count, dtype=rows.dtype)[:, None]
    joints = ch.ADDITIVE_JOINTS[~owned[ch.PART_OF_JOINT[ch.ADDITIVE_JOINTS]]]
    if len(joints):
        channels = 4 * joints[:, None] + np.arange(4)
        here = rows[..., channels]
        delta = quat.multiply(quat.conjugate(quat.nlerp(here[..., :1, :, :], here[..., -1:, :, :], line)), here)
        delta *= np.where(delta[..., 3:] < 0.0, np.float32(-share), np.float32(share))
        result[..., channels[:, :3]] = delta[..., :3]
    if not owned[ch.PARTS.index("spine")]:
        root = rows[..., ch.ROOT]
        result[..., ch.ROOT] = share * (root - (root[..., :1, :] * (1.0 - line) + root[..., -1:, :] * line))
    return result


def period_of(rows: Rows, owned: NDArray[np.bool_]) -> tuple[int, int] | None:
    """(first frame, frames) of a stretch of whole periods in the middle of a unit, None where nothing repeats.

    Periodic are hammering fingers, a jiggling knee, fanning: the owned rotations return to where they were, while
    they travelled far in between.
    """
    count = len(rows)
    start, stop = count // 4, count - count // 5
    moving = rows[start:stop, ch.ROTATION][:, owned[ch.PART_OF_CHANNEL[ch.ROTATION]]]
    room = stop - start
    if room < 16 or moving.shape[1] == 0:
        return None
    # Slow drifts are no rhythm: what remains after a moving mean is.
    moving = moving - _moving_mean(moving, min(30, room))
    energy = float((moving * moving).mean())
    if energy < 1e-6:
        return None
    lags = np.arange(4, room // 2 + 1)
    mismatch = np.array([float(np.square(moving[lag:] - moving[:-lag]).mean()) for lag in lags]) / (2.0 * energy)
    near = np.flatnonzero(mismatch < min(1.5 * float(mismatch.min()) + 0.02, REPEATS))
    if near.size == 0:
        return None
    # The first stretch of good lags is the period itself, later ones its multiples.
    first = near[: np.argmax(np.diff(near, append=near[-1] + 2) > 1) + 1]
    period = int(lags[first[np.argmin(mismatch[first])]])
    whole = max((room - 1) // period, 1) * period
    ends = [float(np.square(moving[first + whole] - moving[first]).sum()) for first in range(max(room - whole, 1))]
    return start + int(np.argmin(ends)), whole


REST_ROW: Rows = take_rows(
    np.tile(np.array([0.0, 0.0, 0.0, 1.0]), (1, ch.JOINTS, 1)), REFERENCE.rest_translation[:1]
).span(slice(None), np.array([0, 0]))[0]
"""The T-pose as a row."""
REST_ROW.setflags(write=False)
