"""Anyone's motion onto our humanoid: the directions of the bones are kept, lengths and places are ours.

1. The source is set upright and faces +Z on average (source.py); only this constant turn is taken out.
2. Every mapped joint's rotation in the world is carried over, freed of what its axes meant to its program
   (calibrate.py). Several spine joints fold into ours, a missing neck or spine is shared out.
3. Feet go where the source's feet are, scaled by the length of the legs, soles on the floor when theirs are; the hips'
   height and way are scaled alike.
4. Hands go where the source's hands are as seen from the shoulders, scaled by the length of the arms, near the face
   as seen from the head, scaled by its size; then out of body, head and table.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import quaternion as quat
from game.core.clip import Clip
from game.core.humanoid import FINGERS, HEAD_CENTRE_OFFSET, REFERENCE
from game.formats.joint_map import SIDES, JointMap, detect_map, map_from_names
from game.tools.retarget.calibrate import corrections, stands_in_zero_pose
from game.tools.retarget.limbs import bend_to, clear_hands
from game.tools.retarget.source import Source, read_source, unit

__all__ = ["FPS", "Options", "Report", "Retargeted", "retarget"]

Floats = NDArray[np.floating[Any]]

FPS = 30.0
_NECK_SHARE = 0.42
"""Of a turn of the head (MOTION.md, keys)."""
_RELAXED_CURL_DEG = {"Index": (14, 20), "Middle": (16, 23), "Ring": (18, 26), "Little": (20, 28)}
_HEAD_RADIUS_M, _HUMAN_HEAD = 0.17, 0.125
"""Our skull's radius; a person's as a share of the leg (thigh and shin) is about 0.10 m to 0.80 m."""
_HUMAN_FACE = np.array([0.0, 0.12, 0.10])
"""Middle of a person's head from the head joint as a share of the leg."""
_FACE_NEAR, _FACE_FAR = 0.18, 0.34
"""Wrist to middle of the head, shares of the leg: nearer than the first the hand belongs to the face."""
_TRAVEL_M = 0.35
"""Further from our place than this the person has left the table."""
_ANKLE_LOW = 0.05
"""Quantile of the ankles' height that stands for flat feet."""
_AT = REFERENCE.index
_REST = REFERENCE.rest_model[:, :3, 3]


@dataclass(frozen=True)
class Options:
    """table: hands stay above our table; collide: hands stay outside the body; hand_targets: hands go where the
    source's are (else the arms' directions alone place them)."""

    table: bool = True
    collide: bool = True
    hand_targets: bool = True


@dataclass(frozen=True)
class Report:
    """What was done. scale: our leg by the source's; turned_deg: the constant heading taken out; zero_pose: whether
    the file's zero pose is a standing person; limb_error_deg: 95th percentile of the angle between source and target
    limb bones; notes: what was missing and how it was made up."""

    map_name: str
    joints: dict[str, list[str]]
    scale: float
    turned_deg: float
    zero_pose: bool
    frames: int
    limb_error_deg: dict[str, float]
    notes: list[str] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Retargeted:
    """A clip on REFERENCE at 30 fps, the upright source it came from, and the report."""

    clip: Clip
    source: Source
    report: Report


def retarget(
    clip: Clip, joint_map: JointMap | None = None, options: Options | None = None, path: str = ""
) -> Retargeted:
    """A person's motion on any skeleton -> our humanoid behind its table. Raises BadInput (path: for its message)."""
    options = options or Options()
    path = path or clip.name or "motion"
    joints = detect_map(clip.skeleton, path) if joint_map is None else map_from_names(joint_map, clip.skeleton, path)
    source = read_source(clip, joints, FPS, path)
    rotation, notes = _turns(source)
    root = _hips(source, rotation)
    position, rotation = _pose(rotation, root)
    _legs(source, position, rotation)
    position, rotation = _pose(rotation, root)
    _arms(source, position, rotation, options)
    far = float(np.linalg.norm(root[:, [0, 2]], axis=-1).max())
    if far > _TRAVEL_M:
        notes.append(f"the person walks {far:.2f} m away from our place behind the table: cut out a part that stays")
    local = quat.normalize(REFERENCE.to_local(rotation))
    translation = np.broadcast_to(REFERENCE.rest_translation, (len(local), len(REFERENCE), 3)).copy()
    translation[:, 0] = root
    result = Clip(REFERENCE, 1.0 / FPS, _continuous(local), translation, name=clip.name)
    report = Report(
        map_name=joints.name,
        joints={target: list(own) for target, own in joints.joints.items()},
        scale=_leg_m() / source.leg,
        turned_deg=float(np.degrees(source.turned_rad)),
        zero_pose=stands_in_zero_pose(source) is not None,
        frames=len(result),
        limb_error_deg=_limb_errors(source, result),
        notes=notes,
    )
    return Retargeted(result, source, report)


def _leg_m() -> float:
    return float(sum(np.linalg.norm(REFERENCE.rest_translation[_AT[f"left{b}"]]) for b in ("LowerLeg", "Foot")))


def _arm_m() -> float:
    return float(sum(np.linalg.norm(REFERENCE.rest_translation[_AT[f"left{b}"]]) for b in ("LowerArm", "Hand")))


# --- rotations -----------------------------------------------------------------------------------------------------
def _turns(source: Source) -> tuple[Floats, list[str]]:
    """World rotations (F, 41, 4) of our joints, and notes."""
    fix = corrections(source)
    frames = len(source.rotation)
    notes: list[str] = []

    def of(joint: int) -> Floats:
        return quat.multiply(source.rotation[:, joint], fix[joint])

    known: dict[str, Floats] = {}
    for target, names in source.joints.joints.items():
        if len(names) == 1 or (names and target not in ("spine", "neck")):
            known[target] = of(source.index(target))
        elif names:
            known[target] = _mean([of(joint) for joint in source.indices(target)])
    if "spine" not in known:
        known["spine"] = quat.nlerp(known["hips"], known["chest"], np.full(frames, 0.5))
        notes.append("one trunk joint: our spine takes half of its turn")
    if "neck" not in known:
        known["neck"] = quat.nlerp(known["chest"], known["head"], np.full(frames, _NECK_SHARE))
        notes.append("no neck joint: our neck takes its share of the head's turn")
    for side in SIDES:
        if not source.joints.has_fingers(side):
            notes.append(f"no fingers on the {side} hand: relaxed ones")
            known |= _relaxed(known[f"{side}Hand"], side)
    rotation = np.empty((frames, len(REFERENCE), 4))
    for joint, name in enumerate(REFERENCE.names):
        # What the source does not have follows its parent.
        rotation[:, joint] = known[name] if name in known else rotation[:, REFERENCE.parents[joint]]
    return rotation, notes


def _mean(turns: list[Floats]) -> Floats:
    total = turns[0].copy()
    for turn in turns[1:]:
        total = total + quat.align(turn, turns[0])
    return quat.normalize(total)


def _relaxed(hand: Floats, side: str) -> dict[str, Floats]:
    # Fingers of the left hand along +X curl down: about −Z; the right hand's about +Z.
    axis = np.array([0.0, 0.0, -1.0 if side == "left" else 1.0])
    turns: dict[str, Floats] = {}
    for finger in FINGERS:
        base, tip = np.radians(_RELAXED_CURL_DEG[finger])
        turns[f"{side}{finger}Proximal"] = quat.multiply(hand, quat.exp(axis * base))
        turns[f"{side}{finger}Intermediate"] = quat.multiply(hand, quat.exp(axis * (base + tip)))
    return turns


def _pose(rotation: Floats, root: Floats) -> tuple[Floats, Floats]:
    translation = np.broadcast_to(REFERENCE.rest_translation, (len(rotation), len(REFERENCE), 3)).copy()
    translation[:, 0] = root
    return REFERENCE.to_model(REFERENCE.to_local(rotation), translation)


def _continuous(local: Floats) -> Floats:
    """Each frame in the hemisphere of the one before."""
    flips = np.sign((local[1:] * local[:-1]).sum(-1))
    flips = np.where(flips == 0.0, 1.0, flips)
    result = local.copy()
    result[1:] *= np.cumprod(flips, axis=0)[..., None]
    return result


# --- places --------------------------------------------------------------------------------------------------------
def _floor(source: Source) -> float:
    """Height of an ankle whose foot stands flat, in the source's unit."""
    lowest = np.minimum(source.at("leftFoot")[:, 1], source.at("rightFoot")[:, 1])
    return float(np.quantile(lowest, _ANKLE_LOW))


def _centre(source: Source) -> Floats:
    """(3,) what becomes our place behind the table: the mean of the hips over the floor."""
    centre = source.at("hips").mean(axis=0)
    centre[1] = _floor(source)
    return np.asarray(centre)


def _hips(source: Source, rotation: Floats) -> Floats:
    """(F, 3) our hips: the middle of the thighs' roots keeps its scaled height over flat ankles."""
    scale = _leg_m() / source.leg
    roots = 0.5 * (source.at("leftUpperLeg") + source.at("rightUpperLeg"))
    middle = (roots - _centre(source)) * scale
    middle[:, 1] += _REST[_AT["leftFoot"], 1]
    ours = 0.5 * (REFERENCE.rest_translation[_AT["leftUpperLeg"]] + REFERENCE.rest_translation[_AT["rightUpperLeg"]])
    return np.asarray(middle - quat.rotate(rotation[:, 0], ours))


def _legs(source: Source, position: Floats, rotation: Floats) -> None:
    scale, centre = _leg_m() / source.leg, _centre(source)
    ankle_m, toes_m = _REST[_AT["leftFoot"], 1], _REST[_AT["leftToes"], 1]
    for side in SIDES:
        upper, lower, foot, toes = (_AT[side + part] for part in ("UpperLeg", "LowerLeg", "Foot", "Toes"))
        target = (source.at(f"{side}Foot") - centre) * scale
        target[:, 1] += ankle_m
        # Neither ankle nor ball of the foot under the floor.
        ball = quat.rotate(rotation[:, foot], np.broadcast_to(REFERENCE.rest_translation[toes], target.shape))
        target[:, 1] = np.maximum(np.maximum(target[:, 1], ankle_m - 0.01), toes_m - 0.004 - ball[:, 1])
        knee_axis = quat.rotate(rotation[:, upper], np.broadcast_to([-1.0, 0.0, 0.0], target.shape))
        at_hip, at_knee = bend_to(
            position[:, upper], position[:, lower], position[:, foot], target, -knee_axis, soft=0.99, full=0.9995
        )
        rotation[:, upper] = quat.multiply(at_hip, rotation[:, upper])
        rotation[:, lower] = quat.multiply(at_knee, rotation[:, lower])


def _arms(source: Source, position: Floats, rotation: Floats, options: Options) -> None:
    wrists = {side: position[:, _AT[f"{side}Hand"]] for side in SIDES}
    if options.hand_targets:
        wrists = _hand_targets(source, position, rotation)
    if options.collide:
        wrists = clear_hands(position, rotation, wrists, table=options.table)
    for side in SIDES:
        upper, lower, hand = (_AT[side + part] for part in ("UpperArm", "LowerArm", "Hand"))
        down = np.broadcast_to([0.0, -1.0 if side == "left" else 1.0, 0.0], position[:, 0].shape)
        at_shoulder, at_elbow = bend_to(
            position[:, upper], position[:, lower], position[:, hand], wrists[side],
            quat.rotate(rotation[:, upper], down), soft=0.95, full=0.995,
        )  # fmt: skip
        rotation[:, upper] = quat.multiply(at_shoulder, rotation[:, upper])
        rotation[:, lower] = quat.multiply(at_elbow, rotation[:, lower])


def _hand_targets(source: Source, position: Floats, rotation: Floats) -> dict[str, Floats]:
    """(F, 3) wrists as seen from the middle of the shoulders, near the face as seen from the head."""
    arm = np.mean(
        [
            np.linalg.norm(source.along(f"{s}{a}", f"{s}{b}"), axis=-1).mean()
            for s in SIDES
            for a, b in (("UpperArm", "LowerArm"), ("LowerArm", "Hand"))
        ]
    )
    scale = _arm_m() / (2.0 * float(arm))
    theirs = 0.5 * (source.at("leftUpperArm") + source.at("rightUpperArm"))
    ours = 0.5 * (position[:, _AT["leftUpperArm"]] + position[:, _AT["rightUpperArm"]])
    turn = rotation[:, _AT["head"]]
    their_face = source.at("head") + quat.rotate(turn, np.broadcast_to(_HUMAN_FACE * source.leg, ours.shape))
    our_face = position[:, _AT["head"]] + quat.rotate(turn, np.broadcast_to(HEAD_CENTRE_OFFSET, ours.shape))
    head_scale = _HEAD_RADIUS_M / (_HUMAN_HEAD * source.leg)
    wrists = {}
    for side in SIDES:
        wrist = source.at(f"{side}Hand")
        by_chest = ours + (wrist - theirs) * scale
        by_face = our_face + (wrist - their_face) * head_scale
        distance = np.linalg.norm(wrist - their_face, axis=-1) / source.leg
        t = np.clip((_FACE_FAR - distance) / (_FACE_FAR - _FACE_NEAR), 0.0, 1.0)
        share = (t * t * (3.0 - 2.0 * t))[:, None]
        wrists[side] = by_chest + share * (by_face - by_chest)
    return wrists


# --- what became of it ---------------------------------------------------------------------------------------------
def _limb_errors(source: Source, clip: Clip) -> dict[str, float]:
    position, _ = clip.to_model()
    errors = {}
    for side in SIDES:
        for a, b in (("UpperArm", "LowerArm"), ("LowerArm", "Hand"), ("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot")):
            theirs = unit(source.along(side + a, side + b))
            ours = unit(position[:, _AT[side + b]] - position[:, _AT[side + a]])
            angle = np.degrees(np.arccos(np.clip((theirs * ours).sum(-1), -1.0, 1.0)))
            errors[side + a] = round(float(np.quantile(angle, 0.95)), 2)
    return errors
