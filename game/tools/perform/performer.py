"""From a filled stage to joint rotations: chain springs, what never stops, the trunk, arms, contacts, legs."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import Clip
from game.core import quaternion as quat
from game.core.humanoid import REFERENCE
from game.tools.perform import contact
from game.tools.perform.arms import SIDES, finger_rotations, mirror_points, mirror_rotations, solve_arm, unit
from game.tools.perform.body import CHAIN, CHANNELS, legs, torso
from game.tools.perform.hands import HandPath, perform_hand
from game.tools.perform.stage import Stage
from game.tools.perform.timing import DT_S, band_noise, blend_scalar, delay, spring

__all__ = ["render_stage"]

Floats = NDArray[np.floating[Any]]
_DELAYS_S = (0.0, 0.03, 0.06, 0.10, 0.0)
_STIFFNESS = (1.15, 1.0, 0.85, 0.75, 1.0)
_PASSES = 9


def _lungs(stage: Stage, rng: np.random.Generator) -> Floats:
    """How full the lungs are over time (F,): 0 empty, 1 a usual full breath."""
    breath, time = stage.effort.breath, stage.time
    # No breath is as long as the last: the rate wanders by about 8 %.
    wander = 1.0 + 0.08 * band_noise(len(time), 1, 0.03, 0.2, rng)[:, 0]
    u = (np.cumsum(breath.rate / 60.0 * DT_S * wander) + rng.random()) % 1.0
    inhale = 0.5 - 0.5 * np.cos(np.pi * np.clip(u / breath.inhale, 0.0, 1.0))
    exhale = 0.5 + 0.5 * np.cos(np.pi * np.clip((u - breath.inhale) / ((1.0 - breath.inhale) * 0.8), 0.0, 1.0))
    level = np.where(u < breath.inhale, inhale, exhale)
    for start, end, keys in stage.lungs:
        share = np.clip(np.minimum((time - start) / 0.15, (end - time) / 0.4), 0.0, 1.0)
        moments, levels = zip(*keys, strict=True)
        level = level * (1.0 - share) + share * np.interp(time, moments, levels)
    return spring(level[:, None], 3.0, 1.0)[:, 0]


def _notice(stage: Stage, rng: np.random.Generator) -> None:
    """Nobody holds the head still while waiting: now and then it takes another bearing near the posture's own."""
    attention, tempo = stage.effort.attention, stage.effort.tempo
    yaw, pitch = np.zeros(len(stage.time)), np.zeros(len(stage.time))
    at = rng.uniform(*attention.every_s)
    while at < stage.time[-1]:
        to_yaw, to_pitch = rng.uniform(-1.0, 1.0, 2) * (attention.yaw_deg, attention.pitch_deg)
        duration = attention.move_s * (0.8 + 0.4 * rng.random())
        blend_scalar(yaw, stage.time, at, duration, float(to_yaw), stage.effort.settle)
        blend_scalar(pitch, stage.time, at + 0.02 * tempo, duration, float(to_pitch), stage.effort.settle)
        at += rng.uniform(*attention.every_s)
    stage.added["head_yaw"] += yaw
    stage.added["head_pitch"] += pitch
    # The trunk follows a little, later.
    stage.added["twist"] += 0.2 * delay(yaw, 0.15 * tempo)


def _trunk_channels(stage: Stage, rng: np.random.Generator) -> tuple[dict[str, Floats], Floats]:
    """Body channels as moved, and the shiver of both wrists (F, 2, 3) metres."""
    effort, frames = stage.effort, len(stage.time)
    _notice(stage, rng.spawn(1)[0])
    keyed = np.stack([delay(stage.base[n] + stage.added[n], _DELAYS_S[CHAIN[n]] * effort.drag) for n in CHANNELS], -1)
    frequency, damping, response = effort.spring
    moved = spring(keyed, frequency * np.array([_STIFFNESS[CHAIN[n]] for n in CHANNELS]), damping, response)
    x: dict[str, Floats] = {name: moved[:, i] + stage.waves[name] for i, name in enumerate(CHANNELS)}
    level, breath = _lungs(stage, rng), effort.breath
    x["lift"] += breath.depth * 3.2 * level
    x["shoulders"] += breath.depth * 4.5 * level * breath.shoulders
    x["up"] += 0.004 * breath.depth * level
    x["head_pitch"] += -1.2 * breath.depth * level
    sway = band_noise(frames, 6, *effort.sway_band_hz, rng) * effort.sway
    amounts = {"sideways": 0.006, "forward": 0.004, "twist": 1.2, "side": 1.0, "head_yaw": 2.2, "head_roll": 1.6}
    for i, (name, amount) in enumerate(amounts.items()):
        x[name] += sway[:, i] * amount
    # What goes on under everything swells and ebbs, never quite away.
    swell = 0.62 + 0.38 * np.sin(band_noise(frames, 1, 0.04, 0.12, rng)[:, 0])
    for name, amount, hz in effort.undertone:
        x[name] += amount * swell * np.sin(2.0 * np.pi * (hz * stage.time + rng.random() * 0.1))
    shiver = band_noise(frames, 12, 8.0, 12.0, rng) * stage.tremor[:, None]
    shakes = {"head_yaw": 0.55, "head_roll": 0.6, "shoulders": 0.7, "sideways": 0.0011, "up": 0.0008, "twist": 0.25}
    for i, (name, amount) in enumerate(shakes.items()):
        x[name] += shiver[:, i] * amount
    # The soft knees of someone who stands at ease.
    x["up"] = x["up"] - 0.012
    return x, 0.0024 * shiver[:, 6:].reshape(frames, 2, 3)


def _fidget(stage: Stage, rng: np.random.Generator) -> Floats:
    """A free hand is never quite still: drift of the wrist, metres, and how fingers close, degrees -> (F, 4)."""
    effort = stage.effort
    low, high = effort.sway_band_hz
    drift = band_noise(len(stage.time), 4, 1.3 * low, 1.3 * high, rng)
    return np.asarray(effort.sway * drift * (0.006, 0.006, 0.006, 4.0))


def _assist(path: HandPath, side: str, position: Floats, rotation: Floats) -> Floats:
    """Shoulders go up with a raised hand and forward with one that crosses over -> local rotation to add (F, 4)."""
    chest = REFERENCE.index["chest"]
    turn = mirror_rotations(rotation[:, chest], side)
    local = quat.rotate(quat.conjugate(turn), path.wrist - mirror_points(position[:, chest], side))
    height = np.clip((local[:, 1] - 0.10) / 0.30, 0.0, 1.0)
    across = np.clip((0.06 - local[:, 0]) / 0.20, 0.0, 1.0)
    ahead = np.clip((local[:, 2] - 0.25) / 0.25, 0.0, 1.0)
    raise_rad = np.radians(14.0) * height * height * (3.0 - 2.0 * height)
    forward_rad = np.radians(11.0) * np.maximum(across, ahead)
    return quat.from_euler("YZ", np.stack([-forward_rad, raise_rad], -1))


def render_stage(stage: Stage, rng: np.random.Generator, name: str) -> Clip:
    """Perform everything on the stage -> a clip on the reference humanoid at 30 frames per second."""
    frames = len(stage.time)
    x, shiver = _trunk_channels(stage, rng)
    shift, parts = torso(x)
    shift, leg_parts = legs(shift, parts["hips"])
    local = np.tile(quat.IDENTITY, (frames, len(REFERENCE), 1))
    for part, q in {**parts, **leg_parts}.items():
        local[:, REFERENCE.index[part]] = q
    translation = np.broadcast_to(REFERENCE.rest_translation, (frames, len(REFERENCE), 3)).copy()
    translation[:, REFERENCE.index["hips"]] += shift
    position, rotation = REFERENCE.to_model(local, translation)
    paths = {}
    for i, side in enumerate(SIDES):
        fidget = _fidget(stage, rng)
        track = stage.hands[side]
        path = perform_hand(track, side, stage.time, stage.effort, position, rotation, shiver[:, i], fidget)
        paths[side] = path
        joint = REFERENCE.index[f"{side}Shoulder"]
        local[:, joint] = quat.multiply(
            local[:, joint], mirror_rotations(_assist(path, side, position, rotation), side)
        )
        for finger, turned in finger_rotations(path.curls).items():
            local[:, REFERENCE.index[f"{side}{finger}"]] = mirror_rotations(turned, side)
    _reach(local, translation, paths)
    return Clip(REFERENCE, DT_S, local, translation, name)


def _reach(local: Floats, translation: Floats, paths: dict[str, HandPath]) -> None:
    """Fill in both arms so that they reach their paths without entering trunk, head, table or each other."""
    push = {side: np.zeros_like(path.wrist) for side, path in paths.items()}
    chest = REFERENCE.index["chest"]
    for turn in range(_PASSES + 1):
        position, rotation = REFERENCE.to_model(local, translation)
        for side, path in paths.items():
            index = {part: REFERENCE.index[f"{side}{part}"] for part in ("Shoulder", "UpperArm", "LowerArm", "Hand")}
            solved, _, _ = solve_arm(
                mirror_points(position[:, index["UpperArm"]], side),
                path.wrist + push[side],
                path.pole,
                path.rotation,
                mirror_rotations(rotation[:, index["Shoulder"]], side),
            )
            for part, q in solved.items():
                local[:, index[part]] = mirror_rotations(q, side)
        if turn == _PASSES:
            return
        position, rotation = REFERENCE.to_model(local, translation)
        points, local_wrist = {}, {}
        for side in SIDES:
            points[side], radii = contact.arm_points(position, rotation, side)
            out = mirror_points(points[side][:, 0] - position[:, chest], side)
            local_wrist[side] = quat.rotate(quat.conjugate(mirror_rotations(rotation[:, chest], side)), out)
        # The rule of folded arms and joined hands. Folded: the arm farther from the chest lies on the other and gives
        # way, forward; the inner one belongs to the trunk. Joined: both give way, each to its own side.
        lead = _step((local_wrist["left"][:, 2] - local_wrist["right"][:, 2]) / 0.01)
        folded = _step(-(local_wrist["left"][:, 0] + local_wrist["right"][:, 0]) / 0.015)[:, None]
        for side, other in zip(SIDES, SIDES[::-1], strict=True):
            front = np.array([0.0, 0.12, 1.0]) * folded + np.array([1.0, 0.0, 0.0]) * (1.0 - folded)
            turned = mirror_points(quat.rotate(mirror_rotations(rotation[:, chest], side), unit(front)), side)
            share = folded[:, 0] * (lead if side == "left" else 1.0 - lead) + (1.0 - folded[:, 0]) * 0.5
            apart = share * contact.arms_apart(points[side], points[other], radii, turned)
            body = contact.body_push(points[side], radii, position, rotation)
            wanted = contact.spread_pushes(body + 0.8 * apart[:, None] * turned)
            push[side] = push[side] + mirror_points(wanted, side)


def _step(x: Floats) -> Floats:
    """0 far below, 1 far above zero, smoothly."""
    return np.asarray(0.5 + 0.5 * np.tanh(x))
