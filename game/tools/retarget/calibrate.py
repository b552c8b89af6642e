"""How each foreign joint is turned when its owner stands in a T-pose: what has to be undone before our joint turns.

A joint's axes in a file mean whatever its program wanted. Two families are told apart:

- The zero pose is a standing person (Poser, Mixamo, CMU): trunk and head are as in the T-pose, arms and legs are
  brought to it by the smallest turn that aligns their bones.
- The zero pose is no pose (each joint's axes lie along its bone, MotionBuilder and others): the axes are told from
  the bones and from how the body moves: elbows and knees are hinges, the hips carry both legs.

In both, soles lie flat when the foot is low, and palms are told from their knuckles.

The result for a source joint j is C_j with: target rotation in the world = source rotation in the world · C_j.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import quaternion as quat
from game.core.errors import BadInput
from game.core.humanoid import FINGERS, REFERENCE
from game.formats.joint_map import SIDES
from game.tools.retarget.source import UP, Source, unit

__all__ = ["Correction", "corrections", "stands_in_zero_pose", "target_bone"]

Floats = NDArray[np.floating[Any]]
Correction = dict[int, Floats]
"""Source joint -> (4,) C_j."""

_X, _Y, _Z = np.eye(3)
_NEXT = {"Shoulder": "UpperArm", "UpperArm": "LowerArm", "LowerArm": "Hand", "UpperLeg": "LowerLeg", "LowerLeg": "Foot"}
_SNAP_COS = 0.85
"""Axes guessed from movement within about 30° of one of the joint's own axes are that axis."""
_BENT = 0.05
"""Mean sine of the elbow above which its bending plane counts."""


def target_bone(target: str) -> tuple[str, Floats] | None:
    """The joint at the far end of a target bone, and the bone's unit direction in the T-pose."""
    side = "left" if target.startswith("left") else "right"
    end = _NEXT.get(target.removeprefix(side))
    if end is None:
        return None
    return side + end, unit(REFERENCE.rest_translation[REFERENCE.index[side + end]])


def _frame(primary: Floats, secondary: Floats) -> Floats:
    """(4,) rotation whose x axis is primary and whose y axis lies toward secondary."""
    x = unit(primary)
    y = unit(secondary - x * (x @ secondary))
    return quat.from_matrix(np.stack([x, y, np.cross(x, y)], axis=-1))


def _map(primary: Floats, secondary: Floats, to_primary: Floats, to_secondary: Floats) -> Floats:
    """(4,) rotation that takes primary to to_primary, and secondary toward to_secondary."""
    return quat.multiply(_frame(to_primary, to_secondary), quat.conjugate(_frame(primary, secondary)))


def _snapped(v: Floats) -> Floats:
    v = unit(v)
    k = int(np.abs(v).argmax())
    return np.sign(v[k]) * np.eye(3)[k] if abs(v[k]) > _SNAP_COS else v


def stands_in_zero_pose(source: Source) -> Floats | None:
    """(4,) the rotation from the zero pose's axes to ours where that pose is a standing person, else None."""
    place = source.zero_pose()

    def at(target: str) -> Floats:
        return np.asarray(place[source.index(target)])

    ways = [("hips", "head"), ("rightUpperLeg", "leftUpperLeg"), ("rightUpperArm", "leftUpperArm")]
    if min(np.linalg.norm(at(b) - at(a)) for a, b in ways) < 1e-3 * source.leg:
        return None
    up, left, shoulders = (unit(at(b) - at(a)) for a, b in ways)
    legs = [unit(at(f"{s}Foot") - at(f"{s}UpperLeg")) @ up for s in SIDES]
    if max(legs) > -0.7 or shoulders @ left < 0.8 or abs(up @ left) > 0.3 or abs(up @ shoulders) > 0.3:
        return None
    if max(unit(at(f"{s}LowerArm") - at(f"{s}UpperArm")) @ up for s in SIDES) > 0.5:
        # Nobody rests with the arms overhead: axes along the bones.
        return None
    toes = [at(f"{s}Toes") - at(f"{s}Foot") for s in SIDES if source.joints.one(f"{s}Toes")]
    if any(np.cross(left, up) @ toe < 0.4 * np.linalg.norm(toe) for toe in toes):
        return None
    return _map(_snapped(up), _snapped(left), _Y, _X)


def corrections(source: Source) -> Correction:
    """C_j of every mapped source joint."""
    standing = stands_in_zero_pose(source)
    t_pose = _from_zero_pose(source, standing) if standing is not None else _from_movement(source)
    for side in SIDES:
        _foot(source, side, t_pose)
        t_pose[source.index(f"{side}Hand")] = _hand(source, side, t_pose)
        _finger_bones(source, side, t_pose)
    return {joint: quat.conjugate(turn) for joint, turn in t_pose.items()}


# --- a zero pose that stands ---------------------------------------------------------------------------------------
def _from_zero_pose(source: Source, standing: Floats) -> Correction:
    place = source.zero_pose()
    t_pose: Correction = {}
    for target in source.joints.joints:
        for joint in source.indices(target):
            t_pose[joint] = standing
    for side in SIDES:
        for part in _NEXT:
            target = side + part
            bone = target_bone(target)
            if bone is None or source.joints.one(target) is None:
                continue
            joint = source.index(target)
            zero = quat.rotate(standing, place[source.index(bone[0])] - place[joint])
            if np.linalg.norm(zero) > 1e-3 * source.leg:
                t_pose[joint] = quat.multiply(quat.between(zero, bone[1]), standing)
        t_pose[source.index(f"{side}Hand")] = t_pose[source.index(f"{side}LowerArm")]
    return t_pose


# --- axes told from bones and movement -----------------------------------------------------------------------------
def _chain(source: Source, joint: int, end: int) -> Floats:
    """(3,) from a joint to one below it with every rotation between them zero, in the joint's frame."""
    total = np.zeros(3)
    while end != joint:
        if end < 0:
            names = source.skeleton.names
            raise BadInput("joint map", expected=f"joints below {names[joint]!r} on one chain", seen="another order")
        total = total + source.skeleton.rest_translation[end]
        end = int(source.skeleton.parents[end])
    return total


def _from_movement(source: Source) -> Correction:
    t_pose: Correction = {}
    _trunk(source, t_pose)
    lateral = source.lateral()
    hips_left = quat.rotate(source.rotation[:, source.index("hips")], _undone(t_pose, source.index("hips"), _X))
    for side in SIDES:
        for part in ("UpperLeg", "LowerLeg"):
            _bone(source, side + part, hips_left, _X, t_pose)
        _arm(source, side, lateral, t_pose)
    return t_pose


def _undone(t_pose: Correction, joint: int, axis: Floats) -> Floats:
    return quat.rotate(quat.conjugate(t_pose[joint]), axis)


def _trunk(source: Source, t_pose: Correction) -> None:
    """Hips, spine, chest, neck and head: up along the straightened spine, left across the legs and the shoulders."""
    head, chest, hips = source.index("head"), source.index("chest"), source.index("hips")
    lateral = source.lateral()
    legs = [source.skeleton.rest_translation[source.index(f"{s}UpperLeg")] for s in SIDES]
    arms = [_chain(source, chest, source.index(f"{s}{_collar(source, s)}")) for s in SIDES]
    exact = {hips: legs[0] - legs[1], chest: arms[0] - arms[1]}
    chest_left = unit(exact[chest]) if np.linalg.norm(exact[chest]) > 0 else None
    joints = [hips, *source.indices("spine"), chest, *source.indices("neck"), head]
    up: Floats = np.zeros(3)
    for joint in joints:
        chain = _chain(source, joint, head)
        if np.linalg.norm(chain) > 1e-3 * source.leg:
            up = chain
        left = source.local_mean(joint, lateral)
        if joint in exact and np.linalg.norm(exact[joint]) > 1e-3 * source.leg:
            left = exact[joint]
        elif chest_left is not None and unit(left) @ chest_left > _SNAP_COS:
            # Neighbours along a spine share their axes: what the chest knows exactly holds for them.
            left = chest_left
        t_pose[joint] = _map(_snapped(up) if joint == head else unit(up), _snapped(left), _Y, _X)


def _collar(source: Source, side: str) -> str:
    return "Shoulder" if source.joints.one(f"{side}Shoulder") else "UpperArm"


def _bone(source: Source, target: str, world: Floats, to: Floats, t_pose: Correction) -> None:
    """A limb bone: along its own direction, a second axis as the movement shows it on average."""
    bone = target_bone(target)
    assert bone is not None
    joint = source.index(target)
    along = _chain(source, joint, source.index(bone[0]))
    t_pose[joint] = _map(along, _snapped(source.local_mean(joint, world)), bone[1], to)


def _arm(source: Source, side: str, lateral: Floats, t_pose: Correction) -> None:
    """Collar bone, upper arm by the elbow's hinge, forearm and hand with the axes of the upper arm."""
    chest = source.index("chest")
    chest_up = quat.rotate(source.rotation[:, chest], _undone(t_pose, chest, _Y))
    if source.joints.one(f"{side}Shoulder"):
        _bone(source, f"{side}Shoulder", chest_up, _Y, t_pose)
    upper = unit(source.along(f"{side}UpperArm", f"{side}LowerArm"))
    lower = unit(source.along(f"{side}LowerArm", f"{side}Hand"))
    normal = np.cross(upper, lower)
    if np.linalg.norm(normal, axis=-1).mean() < _BENT:
        # Arms that never bend: the hinge an arm would have if it bent forward.
        normal = np.cross(upper, np.cross(lateral, chest_up))
    # A left arm in the T-pose points to +X and bends toward +Z: its hinge is X × Z = −Y; a right arm's +Y.
    _bone(source, f"{side}UpperArm", normal, -_Y if side == "left" else _Y, t_pose)
    above = t_pose[source.index(f"{side}UpperArm")]
    for part, end in (("LowerArm", "Hand"),):
        joint = source.index(side + part)
        bone = target_bone(side + part)
        assert bone is not None
        zero = quat.rotate(above, _chain(source, joint, source.index(side + end)))
        t_pose[joint] = quat.multiply(quat.between(zero, bone[1]), above)
    t_pose[source.index(f"{side}Hand")] = t_pose[source.index(f"{side}LowerArm")]


# --- feet and hands: the same for both families ---------------------------------------------------------------------
def _foot(source: Source, side: str, t_pose: Correction) -> None:
    """Soles lie flat when the foot is low: that is up; ahead is where the toes are, or where the hips look."""
    joint = source.index(f"{side}Foot")
    height = source.position[:, joint, 1]
    low = (height <= np.quantile(height, 0.4)).astype(np.float64)
    up = unit(source.local_mean(joint, UP, low))
    toes = source.indices(f"{side}Toes")
    ahead = _chain(source, joint, toes[0]) if toes else np.zeros(3)
    if np.linalg.norm(ahead) < 1e-3 * source.leg:
        ahead = source.local_mean(joint, np.cross(source.lateral(), UP))
    rest = REFERENCE.rest_translation[REFERENCE.index[f"{side}Toes"]] * (1.0, 0.0, 1.0)
    t_pose[joint] = _map(up, ahead, _Y, rest)
    for toe in toes:
        t_pose[toe] = t_pose[joint]


def _hand(source: Source, side: str, t_pose: Mapping[int, Floats]) -> Floats:
    """The palm from its knuckles, else the forearm's."""
    hand = source.index(f"{side}Hand")
    if not source.joints.has_fingers(side):
        return t_pose[hand]

    def knuckle(finger: str) -> tuple[Floats, Floats]:
        target = f"{side}{finger}Proximal"
        ours = REFERENCE.rest_translation[REFERENCE.index[target]]
        return _chain(source, hand, source.index(target)), ours

    (middle, our_middle), (index, our_index), (little, our_little) = map(knuckle, ("Middle", "Index", "Little"))
    if min(np.linalg.norm(middle), np.linalg.norm(index - little)) < 1e-3 * source.leg:
        return t_pose[hand]
    return _map(middle, index - little, our_middle, our_index - our_little)


def _finger_bones(source: Source, side: str, t_pose: Correction) -> None:
    """Fingers in the hand's axes, each brought to our finger's rest direction by the smallest turn."""
    hand = t_pose[source.index(f"{side}Hand")]
    for finger in ("Thumb", *FINGERS):
        ends = ("Metacarpal", "Proximal") if finger == "Thumb" else ("Proximal", "Intermediate")
        targets = [f"{side}{finger}{end}" for end in ends]
        rest = unit(REFERENCE.rest_translation[REFERENCE.index[targets[1]]])
        for target in targets:
            if source.joints.one(target) is None:
                continue
            joint = source.index(target)
            children = np.flatnonzero(source.skeleton.parents == joint)
            bone = source.skeleton.rest_translation[children[0]] if len(children) else np.zeros(3)
            if np.linalg.norm(bone) < 1e-4 * source.leg:
                bone = source.skeleton.rest_translation[joint]
            t_pose[joint] = quat.multiply(quat.between(quat.rotate(hand, bone), rest), hand)
