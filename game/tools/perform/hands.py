"""Hands over time: keys -> paths that never jump -> springs that stiffen on contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import quaternion as quat
from game.core.humanoid import HEAD_CENTRE_OFFSET, REFERENCE, TABLE_TOP_M
from game.tools.perform.arms import hand_frame, mirror_points, mirror_rotations, unit
from game.tools.perform.contact import TABLE_BACK_Z_M
from game.tools.perform.data import Effort, Target
from game.tools.perform.stage import HandKey, HandTrack
from game.tools.perform.timing import DT_S, delay, ease, minimum_jerk, spring, spring_rotation

__all__ = ["HandPath", "perform_hand"]

Floats = NDArray[np.floating[Any]]
_ARC = np.array([0.55, 0.50, 0.65])


@dataclass
class HandPath:
    """One hand over time in a left hand's (mirrored) model space: wrist (F, 3), rotation (F, 4), elbow pole (F, 3),
    finger curls (F, 5, 3) degrees, contact (F,) 0..1."""

    wrist: Floats
    rotation: Floats
    pole: Floats
    curls: Floats
    contact: Floats


def _place(target: Target, side: str, position: Floats, rotation: Floats) -> HandPath:
    """A target carried along by its frame: position (F, J, 3), rotation (F, J, 4) in model space."""
    frames = len(position)
    at, pole = target.at, unit(target.elbow)
    hand = hand_frame(target.fingers, target.back)
    if target.space == "world":
        turn: Floats = np.broadcast_to(quat.IDENTITY, (frames, 4))
        origin: Floats = np.zeros((frames, 3))
    else:
        joint = REFERENCE.index[target.space]
        turn = mirror_rotations(rotation[:, joint], side)
        origin = mirror_points(position[:, joint], side)
        at = at + HEAD_CENTRE_OFFSET if target.space == "head" else at - REFERENCE.rest_model[joint, :3, 3]
    return HandPath(
        origin + quat.rotate(turn, np.broadcast_to(at, (frames, 3))),
        quat.multiply(turn, np.broadcast_to(hand, (frames, 4))),
        quat.rotate(turn, np.broadcast_to(pole, (frames, 3))),
        np.broadcast_to(target.curls, (frames, 5, 3)).copy(),
        np.full(frames, target.contact),
    )


def _continuous(q: Floats) -> Floats:
    """(F, 4) with signs chosen so that neighbours agree."""
    flips = np.where((q[1:] * q[:-1]).sum(-1) < 0.0, -1.0, 1.0)
    return np.asarray(q * np.concatenate([[1.0], np.cumprod(flips)])[:, None])


def _is_below_table(wrist: Floats) -> bool:
    return bool(wrist[1] < TABLE_TOP_M + 0.02 and wrist[2] < TABLE_BACK_Z_M)


def _lead(path: HandPath, goal: HandPath, key: HandKey, time: Floats, like: Floats | None = None) -> Floats:
    """Blend the path in place toward the goal from the key's start on; what it did before goes on underneath.

    like: the first turn (4,) of a twin of this path, whose way round is to be taken; None: the short way round.
    Returns this path's first turn.
    """
    on = np.flatnonzero(time >= key.start_s)
    if not len(on):
        return quat.IDENTITY
    w = ease((time[on] - key.start_s) / max(key.duration_s, DT_S), key.ease)[:, None]
    inside = np.clip(w, 0.0, 1.0)
    way = goal.wrist[on] - path.wrist[on]
    bow = key.arc * np.linalg.norm(way[0]) * _ARC * np.sin(np.pi * inside)
    # Between below and above the table the hand goes round its edge.
    there = on[np.searchsorted(time[on], min(key.start_s + key.duration_s, time[-1]))]
    if _is_below_table(path.wrist[on[0]]) != _is_below_table(goal.wrist[there]):
        bow = bow + np.array([0.0, 0.10, -0.05]) * np.sin(np.pi * inside)
    path.wrist[on] += way * w + bow
    turn = _continuous(quat.multiply(quat.conjugate(path.rotation[on]), goal.rotation[on]))
    if (turn[0] @ (quat.IDENTITY if like is None else like)) < 0.0:
        turn = -turn
    axis = np.linalg.norm(turn[:, :3], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(axis, turn[:, 3:])
    vector = turn[:, :3] / np.maximum(axis, 1e-9) * angle
    # Turning has no wind-up and no strike: a wrist that snaps round looks broken.
    rolled = minimum_jerk((time[on] - key.start_s) / max(1.1 * key.duration_s, DT_S))[:, None]
    path.rotation[on] = quat.multiply(path.rotation[on], quat.exp(vector * rolled))
    path.pole[on] += (goal.pole[on] - path.pole[on]) * inside
    path.curls[on] += (goal.curls[on] - path.curls[on]) * inside[..., None]
    path.contact[on] = path.contact[on] * (1.0 - inside[:, 0]) ** 3 + goal.contact[on] * inside[:, 0] ** 3
    return np.asarray(turn[0])


def _overtaken(key: HandKey, keys: list[HandKey]) -> bool:
    """A return home is dropped when another move takes the hand before or just as it starts."""
    if key.target is not None:
        return False
    mine = min(k.start_s for k in keys if k.owner == key.owner)
    return any(k.owner != key.owner and mine < k.start_s <= key.start_s + 0.12 for k in keys)


def _follow(
    track: HandTrack, side: str, time: Floats, position: Floats, rotation: Floats, turns: dict[HandKey, Floats]
) -> HandPath:
    """The keyed path, before springs, with targets carried by a trunk that moves like this.

    turns: which way round each key turned the hand; filled where a key is not in it yet.
    """

    def place(key: HandKey) -> HandPath:
        assert key.target is not None
        return _place(key.target, side, position, rotation)

    homes = sorted(track.home, key=lambda k: k.start_s)
    home = place(homes[0])
    for key in homes[1:]:
        turns[key] = _lead(home, place(key), key, time, turns.get(key))
    path = HandPath(home.wrist.copy(), home.rotation.copy(), home.pole.copy(), home.curls.copy(), home.contact.copy())
    for key in sorted(track.keys, key=lambda k: k.start_s):
        if not _overtaken(key, track.keys):
            goal = home if key.target is None else place(key)
            turns[key] = _lead(path, goal, key, time, turns.get(key))
    return path


def perform_hand(
    track: HandTrack,
    side: str,
    time: Floats,
    effort: Effort,
    position: Floats,
    rotation: Floats,
    shiver: Floats,
    fidget: Floats,
) -> HandPath:
    """Keys of one hand -> where it is over time.

    position (F, J, 3), rotation (F, J, 4): the trunk in model space; shiver (F, 3) metres, always felt;
    fidget (F, 4): metres and degrees of curl, only for a hand that touches nothing.
    """
    turns: dict[HandKey, Floats] = {}
    path = _follow(track, side, time, position, rotation, turns)
    # A touching hand rides on what it touches; only what the hand itself does goes through its spring. So the path
    # is split: as if the trunk stood still, and what the moving trunk adds.
    still = _follow(
        track,
        side,
        time,
        np.broadcast_to(position[:1], position.shape),
        np.broadcast_to(rotation[:1], rotation.shape),
        turns,
    )
    # One spring whose frequency rises with contact: a free hand swings, a touching hand stays. (Blending a sprung
    # path with a raw one instead would pop.)
    firm = np.round(np.clip(path.contact, 0.0, 1.0) * 32.0)[:, None] / 32.0
    riding = spring(path.contact[:, None], 4.0, 1.0)
    carried = path.wrist - still.wrist
    turned_by = _continuous(quat.multiply(path.rotation, quat.conjugate(still.rotation)))
    turn_vector = quat.log(turned_by)
    frequency, damping = effort.hand
    held = min(11.0, 3.0 + 2.5 * frequency)
    wrist = spring(
        still.wrist + (1.0 - riding) * carried,
        frequency * (1.0 - firm) + held * firm,
        damping * (1.0 - firm) + firm,
        effort.spring[2] * (1.0 - firm),
    )
    wrist = wrist + riding * carried
    loose = quat.multiply(quat.exp((1.0 - riding) * turn_vector), still.rotation)
    turned = spring_rotation(
        _continuous(loose),
        (1.15 * frequency * (1.0 - firm) + min(9.0, held) * firm)[:, 0],
        (0.85 + 0.15 * firm)[:, 0],
    )
    turned = quat.multiply(quat.exp(riding * turn_vector), turned)
    # Waves keep their size on a stiff hand; the fingers trail behind a moving wrist.
    wrist = wrist + track.shift + shiver + fidget[:, :3] * (1.0 - 0.8 * riding)
    speed = spring(np.gradient(wrist, DT_S, axis=0), 4.0, 0.7)
    hand = turned
    wave = np.radians(track.turn_deg)
    hand = quat.multiply(hand, quat.from_euler("YZX", wave))
    fingers = quat.rotate(hand, np.broadcast_to((1.0, 0.0, 0.0), wrist.shape))
    back = quat.rotate(hand, np.broadcast_to((0.0, 1.0, 0.0), wrist.shape))
    lag = effort.wrist_lag_s * (1.0 - 0.85 * firm) * speed
    lag = lag / np.maximum(1.0, np.linalg.norm(lag, axis=-1, keepdims=True) / 0.45)
    curls = spring(delay(path.curls.reshape(len(time), 15), 0.05 * effort.drag), 1.2 * frequency, 0.8)
    curls = curls.reshape(-1, 5, 3)
    curls[:, :4, :2] += (track.curl_deg + fidget[:, 3] * (1.0 - riding[:, 0]))[:, None, None]
    curls[:, :4, :2] = np.clip(curls[:, :4, :2], -12.0, 95.0)
    return HandPath(wrist, hand_frame(fingers - lag, back), spring(unit(path.pole), 3.0, 1.0), curls, firm[:, 0])
