"""The reference's pose on another body: other proportions, and hands and feet that still touch what they touch.

The result is a pose on the *fitted* figure: the reference's 41 joints, still with an identity rest pose, at the places
where the other body has them. What turns that into the local rotations of a file's own joints (their axes, an A-pose,
missing bones) is the rig's (skinning.py).

1. Trunk, head and fingers keep their rotations. The hips' way is scaled by the length of the legs, ankles stay where
   they stand (planted on the ground) or move by the scaled way.
2. Each palm goes where its contact wants it: over the table in the world, near the own head, chest, belly or hips at
   the same place of *this* body's head, chest, belly or hips, in the open as seen from the shoulder at the length of
   this arm. All of them are weighed by how near they are, so nothing switches. Hands that are close together stay so.
3. Arms and legs follow by the same inverse kinematics as everywhere (limbs.py).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import bilinear as bl
from game.animation import figure, limbs
from game.animation.body_size import REGIONS, BodySize
from game.animation.collision import BODY, TABLE_BACK_Z_M
from game.animation.placing import place_limbs
from game.animation.pose import Pose
from game.core.errors import BadInput
from game.core.humanoid import REFERENCE, TABLE_FRONT_Z_M, TABLE_TOP_M

__all__ = ["NEEDED", "Fitting", "fit_to", "reference_places"]

Floats = NDArray[np.floating[Any]]

NEEDED: tuple[str, ...] = ("hips", "spine", "head") + tuple(
    f"{side}{bone}"
    for side in ("left", "right")
    for bone in ("UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot")
)
"""Bones without which a body cannot be driven (VRM requires the same)."""

_INSTEAD: Mapping[str, str] = {
    "chest": "spine",
    "neck": "head",
    "leftShoulder": "leftUpperArm",
    "rightShoulder": "rightUpperArm",
}
"""Where a missing bone lies on the fitted figure: on the one that takes its rotation as well."""
_REST = {name: REFERENCE.rest_model[i, :3, 3] for i, name in enumerate(REFERENCE.names)}
_PALM_M = 0.085
"""From the wrist to what touches: the heel of the fingers, on the reference."""
_NEAR, _FAR = 1.45, 2.30
"""A hand nearer to a region than the first multiple of its radii belongs to it, beyond the second it does not."""
_OVER_TABLE_M, _ABOVE_TABLE_M = 0.06, 0.36
"""A palm lower over the table than the first belongs to it, higher than the second it does not."""
_BESIDE_TABLE_M = 0.07
_LOW_M, _HIGH_M = 0.035, 0.08
"""A palm lower over the table than the first cannot go where the table is, one higher than the second can."""
_LOW_BACK_M, _HIGH_BACK_M = (-0.08, -0.01), (-0.03, 0.09)
"""Before the table's back edge: where the table begins to count for a low palm and where nothing else does, and the
same for a high one, which a belly that leans over the edge takes along."""
_TOGETHER_M, _APART_M = 0.14, 0.34
"""Palms nearer than the first keep their distance, further apart than the second each goes its own way."""
_REACH = (0.985, 0.999)
"""Shares of an arm's length between which a reach is clamped that only this body lacks."""
_CLEAR = 1.35
"""Radii of a body's part beyond which a palm is out of it."""
_SAME_M = 1e-6


def _regions() -> tuple[Floats, Floats]:
    """(4, 3) centres in the rest pose and (4, 3) radii of REGIONS; of two ellipsoids on a joint the larger counts."""
    rows = {joint: (centre, radii) for joint, centre, radii in sorted(BODY, key=lambda row: sum(row[2]))}
    return np.array([rows[r][0] for r in REGIONS]), np.array([rows[r][1] for r in REGIONS])


_CENTRES, _RADII = _regions()
_PALM = np.array([[_PALM_M, 0.0, 0.0], [-_PALM_M, 0.0, 0.0]], dtype=np.float32)[..., None]
_ARMS = tuple(figure.WHERE[f"{s}UpperArm"] for s in ("left", "right"))
_AT = np.array([(figure.WHERE[r],) * 2 for r in REGIONS] + [_ARMS, _ARMS])
_FLAT = np.eye(3, dtype=np.float32)
_TABLE = np.array([0.0, TABLE_TOP_M, 0.0], dtype=np.float32)
_SUM, _ONES = np.ones(3, dtype=np.float32), np.ones((6, 1), dtype=np.float32)
# How a nearness becomes a weight: 0 at the first, 1 at the second.
_LIMITS = np.array(
    [(_FAR, _NEAR)] * 4
    + [
        (TABLE_BACK_Z_M + _LOW_BACK_M[0], TABLE_BACK_Z_M + _LOW_BACK_M[1]),
        (TABLE_FRONT_Z_M + 2.0 * _BESIDE_TABLE_M, TABLE_FRONT_Z_M + _BESIDE_TABLE_M),
        (TABLE_TOP_M + _ABOVE_TABLE_M, TABLE_TOP_M + _OVER_TABLE_M),
        (_APART_M, _TOGETHER_M),
        (TABLE_BACK_Z_M + _HIGH_BACK_M[0], TABLE_BACK_Z_M + _HIGH_BACK_M[1]),
        (TABLE_TOP_M + _HIGH_M, TABLE_TOP_M + _LOW_M),
    ]
)
_OUTSIDE = _LIMITS[:, :1].astype(np.float32)
_STEEP = (1.0 / (_LIMITS[:, 1:] - _LIMITS[:, :1])).astype(np.float32)
for _array in (_CENTRES, _RADII, _PALM, _AT, _FLAT, _TABLE, _SUM, _ONES, _LIMITS, _OUTSIDE, _STEEP):
    _array.setflags(write=False)


def reference_places() -> dict[str, Floats]:
    """Bone -> place (3,) in the reference's rest pose, metres."""
    return dict(_REST)


@dataclass(frozen=True, eq=False)
class Fitting:
    """A body as the fit wants it. Make it with fit_to.

    rest: (41, 3) local translations of the fitted figure; hips: (3,) where its hips rest; leg, hand: this body's length
    over the reference's. The other arrays are constants of the two figures side by side.
    """

    rest: Floats
    hips: Floats
    leg: float
    hand: float
    offset: Floats  # (2, 19, 3) of the reference and of this body
    limbs: limbs.Limbs
    feet: Floats  # (2, 2, 3) ankles at rest: the reference's, this body's
    centre: Floats  # (2, 6, 2, 3) of the places a hand can be in, in their frames
    radius: Floats  # (2, 6, 2, 3)

    def fit(self, pose: Pose) -> Pose:
        """n characters' poses on the reference -> on the fitted figure."""
        n = len(pose)
        rotation = pose.rotation.astype(np.float32)
        root = pose.root.astype(np.float32)
        shift = root - _REST["hips"].astype(np.float32)
        roots = np.concatenate([root, self.hips + shift * np.float32(self.leg)])
        offset = self.offset if n == 1 else np.repeat(self.offset, n, axis=0)
        local = bl.affine(rotation.take(figure.FIGURE, axis=1))
        joints = np.concatenate([local, local])
        joints[:, :, :3, 3] = offset
        joints[:, 0, :3, 3] = roots
        figure.figure_matrices(joints)
        self._place(rotation, joints[:n], joints[n:])
        return Pose(rotation, roots[n:], pose.gaze, pose.blink, pose.breath)

    def _place(self, rotation: Floats, reference: Floats, mine: Floats) -> None:
        """Arms and legs of this body to where they belong: rewrites the twelve joints of the limbs in rotation."""
        goal = reference.take(figure.BONES[12:], axis=1)
        place = goal[..., :3, 3]
        reach = (goal[:, :2, :3, :3] @ _PALM)[..., 0]
        palm = place[:, :2] + reach
        place[:, :2] = self._palms(reference, mine, palm) - np.float32(self.hand) * reach
        place[:, 2:] = self.feet[1] + np.float32(self.leg) * (place[:, 2:] - self.feet[0])
        place_limbs(self.limbs, rotation, np.concatenate([mine.take(figure.BONES, axis=1), goal], axis=1))

    def _palms(self, reference: Floats, mine: Floats, palm: Floats) -> Floats:
        """Where the palms (n, 2, 3) of the reference are on this body.

        Six places are asked at once, each a frame on both bodies: the regions, the shoulder (in the open) and the
        table. The last two keep model space's axes.
        """
        n = len(palm)
        turn = np.empty((n, 6, 3, 3), dtype=np.float32)
        turn[:, :4] = reference.take(_AT[:4, 0], axis=1)[..., :3, :3]
        turn[:, 4:] = _FLAT
        here, there = reference[..., :3, 3].take(_AT, axis=1), mine[..., :3, 3].take(_AT, axis=1)
        here[:, 5] = there[:, 5] = _TABLE
        local = ((palm[:, None] - here) @ turn - self.centre[0]) / self.radius[0]
        origin = there[:, :3].copy()
        there += (local * self.radius[1] + self.centre[1]) @ turn.swapaxes(-1, -2)
        way = palm[:, 1] - palm[:, 0]
        nearness = np.empty((n, 10, 2), dtype=np.float32)
        nearness[:, :4] = np.sqrt((local[:, :4] * local[:, :4]) @ _SUM)
        nearness[:, 4] = nearness[:, 5] = nearness[:, 8] = palm[..., 2]
        nearness[:, 6] = nearness[:, 9] = palm[..., 1]
        nearness[:, 7] = np.sqrt((way * way) @ _SUM)[:, None]
        # 0 far away, 1 near, smooth between.
        nearness = np.minimum(np.maximum((nearness - _OUTSIDE) * _STEEP, np.float32(0.0)), np.float32(1.0))
        nearness *= nearness * (np.float32(3.0) - np.float32(2.0) * nearness)
        weight = np.zeros((n, 6, 2), dtype=np.float32)
        high, low = nearness[:, 8], nearness[:, 9]
        weight[:, 5] = (high + low * (nearness[:, 4] - high)) * nearness[:, 5] * nearness[:, 6]
        # The table does not give way, so it comes before the body behind it.
        np.multiply(nearness[:, :4], np.float32(1.0) - weight[:, 5:], out=weight[:, :4])
        # What no contact claims is in the open.
        away = np.float32(1.0) - weight
        weight[:, 4] = away[:, 0] * away[:, 1] * away[:, 2] * away[:, 3] * away[:, 5]
        share = weight.swapaxes(1, 2)[:, :, None]
        found = np.asarray((share @ there.swapaxes(1, 2))[:, :, 0] / (share @ _ONES)[:, :, 0])
        # Between two places, and on the way to one, a palm is no deeper in this body than in the reference's.
        inside = ((found[:, None] - origin) @ turn[:, :3] - self.centre[1, :3]) / self.radius[1, :3]
        deep = np.sqrt((inside * inside) @ _SUM)
        wanted = np.minimum(np.sqrt((local[:, :3] * local[:, :3]) @ _SUM), np.float32(_CLEAR))
        lack = np.maximum(wanted / np.maximum(deep, np.float32(1e-3)) - np.float32(1.0), np.float32(0.0))
        lack *= wanted > np.float32(0.4)
        most = lack.argmax(axis=1)[:, None]
        out = (inside * lack[..., None] * self.radius[1, :3]) @ turn[:, :3].swapaxes(-1, -2)
        found += np.take_along_axis(out, most[..., None], axis=1)[:, 0]
        # Hands that hold each other.
        fix = np.float32(0.5) * nearness[:, 7, :1] * (np.float32(self.hand) * way - (found[:, 1] - found[:, 0]))
        found[:, 0] -= fix
        found[:, 1] += fix
        return found


def fit_to(places: Mapping[str, Floats], size: BodySize | None = None) -> Fitting | None:
    """The fitting of a body.

    places: VRM humanoid bone -> (3,) where its joint is in the T-pose, model space, metres, feet on y = 0, facing +Z.
    size: how its parts differ in size; guessed from the skeleton where None.
    -> None where it is the reference's own body. Raises BadInput where needed bones are missing.
    """
    missing = [bone for bone in NEEDED if bone not in places]
    if missing:
        raise BadInput("body", expected="a person's bones", seen=f"no {', '.join(missing)}")
    where = _complete(places)
    if size is None and all(np.abs(where[name] - _REST[name]).max() <= _SAME_M for name in REFERENCE.names):
        return None
    parents = REFERENCE.parents
    rest = np.array(
        [
            where[n] - (where[REFERENCE.names[p]] if p >= 0 else 0.0)
            for n, p in zip(REFERENCE.names, parents, strict=True)
        ]
    )
    ends, both = figure.ENDS, np.stack([REFERENCE.rest_translation, rest])
    lengths = np.maximum(np.linalg.norm(both[:, ends[1:]], axis=-1), 1e-4)  # (2, 2, 4)
    arm, leg = lengths[1].sum(0)[:2] / lengths[0].sum(0)[:2], lengths[1].sum(0)[2:] / lengths[0].sum(0)[2:]
    offset = both[:, figure.FIGURE]
    offset[:, 0] = 0.0
    hand = _hand_share(places, float(arm.mean()))
    centre, radius = _places(where, size, arm, hand)
    arrays = (
        rest,
        where["hips"],
        offset,
        np.array([[w[f"{s}Foot"] for s in ("left", "right")] for w in (_REST, where)]),
        centre,
        radius,
    )
    ready = [np.ascontiguousarray(a, dtype=np.float32) for a in arrays]
    for array in ready:
        array.setflags(write=False)
    rest_, hips, offset_, feet, centre_, radius_ = ready
    return Fitting(
        rest=rest_,
        hips=hips,
        leg=float(leg.mean()),
        hand=hand,
        offset=offset_,
        limbs=_limbs(lengths[1]),
        feet=feet,
        centre=centre_,
        radius=radius_,
    )


def _complete(places: Mapping[str, Floats]) -> dict[str, Floats]:
    """A place for each of the 41 joints. What is missing lies on the bone that takes its rotation, or (toes,
    fingers) where the reference has it as seen from its parent."""
    where: dict[str, Floats] = {}
    for name, parent in zip(REFERENCE.names, REFERENCE.parents.tolist(), strict=True):
        if name in places:
            where[name] = np.asarray(places[name], dtype=np.float64)
        elif name in _INSTEAD:
            where[name] = np.asarray(places[_INSTEAD[name]], dtype=np.float64)
        else:
            above = REFERENCE.names[parent]
            where[name] = where[above] + _REST[name] - _REST[above]
    return where


def _hand_share(places: Mapping[str, Floats], arm: float) -> float:
    """This body's hand over the reference's, from the knuckles; the arm's share where it has none."""
    shares = []
    for side in ("left", "right"):
        for finger in ("Index", "Middle", "Ring"):
            knuckle = f"{side}{finger}Proximal"
            if knuckle in places:
                mine = np.linalg.norm(places[knuckle] - places[f"{side}Hand"])
                shares.append(float(mine / np.linalg.norm(_REST[knuckle] - _REST[f"{side}Hand"])))
    return float(np.clip(np.median(shares) if shares else arm, 0.3, 3.0))


def _limbs(lengths: Floats) -> limbs.Limbs:
    """lengths: (2, 4) of upper and lower bones. A pose's reach was clamped when it was made; it is not once more."""
    return limbs.limbs_of(lengths[0], lengths[1], np.array([_REACH, _REACH, limbs.STRAIGHT, limbs.STRAIGHT]))


def _places(where: Mapping[str, Floats], size: BodySize | None, arm: Floats, hand: float) -> tuple[Floats, Floats]:
    """(2, 6, 2, 3) centres in their frames and sizes of the places a hand can be in: the reference's, this body's."""
    trunk = (where["head"] - where["hips"])[1] / (_REST["head"] - _REST["hips"])[1]
    wide = float(np.clip(_shoulders(where) / _shoulders(_REST), 0.5, 2.0))
    centres, radii = [], []
    for region, centre, radius in zip(REGIONS, _CENTRES, _RADII, strict=True):
        head = region == "head"
        guess = (trunk,) * 3 if head else (wide, trunk, wide)
        share = np.array(size.share.get(region, guess) if size else guess)
        if head:
            centres.append((centre - _REST["head"]) * share)
        else:
            # At the same share of the way from the hips to the head, whatever joint carries it.
            up = (centre[1] - _REST["hips"][1]) / (_REST["head"] - _REST["hips"])[1]
            place = where["hips"] + up * (where["head"] - where["hips"])
            if size:
                place = place + (0.0, 0.0, size.ahead.get(region, 0.0))
            centres.append(place - where[region])
        radii.append(radius * share)
    centre, radius = np.zeros((2, 6, 2, 3)), np.ones((2, 6, 2, 3))
    own = np.array([c - _REST[r] for c, r in zip(_CENTRES, REGIONS, strict=True)])
    centre[:, :4] = np.stack([own, np.array(centres)])[:, :, None]
    radius[:, :4] = np.stack([_RADII, np.array(radii)])[:, :, None]
    radius[1, 4] = arm[:, None]
    radius[1, 5] = (1.0, hand, 1.0)
    return centre, radius


def _shoulders(where: Mapping[str, Floats]) -> float:
    return float(np.linalg.norm(where["leftUpperArm"] - where["rightUpperArm"]))
