"""The reference's pose on another body: other proportions, and hands and feet that still touch what they touch.

The result is a pose on the *fitted* figure: the reference's 41 joints, still with an identity rest pose, at the places
where the other body has them. What turns that into the local rotations of a file's own joints (their axes, an A-pose,
missing bones) is the rig's (skinning.py).

1. Trunk, head and fingers keep their rotations. The hips' way is scaled by the length of the legs, ankles stay where
   they stand (planted on the ground) or move by the scaled way.
2. Each palm goes where its contact wants it: over the table in the world, near the own head, chest, belly or hips at
   the same place of *this* body's head, chest, belly or hips, in the open as seen from the shoulder at the length of
   this arm. All of them are weighed by how near they are, so nothing switches. Hands that are close together stay so.
3. Hands bigger than the reference's are held off the body's own outside (skin/clear.c).
4. Arms and legs follow by the same inverse kinematics as everywhere (limbs.h).

Here is what that needs to know of the two bodies; the fit itself is skin/fit.c.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import figure
from game.animation.body_shape import BodyShape
from game.animation.body_size import REGIONS, BodySize
from game.animation.clearance import BIGGER_HAND, HAND, SHAPE, hand_reach, hands_table, shapes_table
from game.animation.collision import BODY, TABLE_BACK_Z_M
from game.animation.reach import LIMB, STRAIGHT, limb_table
from game.core.errors import BadInput
from game.core.humanoid import REFERENCE, TABLE_FRONT_Z_M, TABLE_TOP_M

__all__ = ["BODY_PART", "FIGURE_JOINT", "FIGURE_LIMB", "FIT", "NEEDED", "Fitting", "fit_to"]

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
_CLEAR, _MIDDLE = 1.35, 0.4
"""Radii of a body's part beyond which a palm is out of it, and within which it may be anywhere."""
_SAME_M = 1e-6


def _regions() -> tuple[Floats, Floats]:
    """(4, 3) centres in the rest pose and (4, 3) radii of REGIONS; of two ellipsoids on a joint the larger counts."""
    rows = {joint: (centre, radii) for joint, centre, radii in sorted(BODY, key=lambda row: sum(row[2]))}
    return np.array([rows[r][0] for r in REGIONS]), np.array([rows[r][1] for r in REGIONS])


_CENTRES, _RADII = _regions()
_SIDES = ("left", "right")
for _array in (_CENTRES, _RADII):
    _array.setflags(write=False)

# As in skin/fit.h.
_REGION = np.dtype([("centre", "<f4", 3), ("radius", "<f4", 3)])
BODY_PART = np.dtype([("joint", "<i4"), ("reference", _REGION), ("mine", _REGION)])
FIGURE_JOINT = np.dtype([("turn", "<i4"), ("parent", "<i4"), ("reference", "<f4", 3), ("mine", "<f4", 3)])
FIGURE_LIMB = np.dtype([("joints", "<i4", 4), ("bones", LIMB), ("foot_reference", "<f4", 3), ("foot", "<f4", 3)])
_LIMITS = {
    "beside_body": (_FAR, _NEAR),
    "low_back": (TABLE_BACK_Z_M + _LOW_BACK_M[0], TABLE_BACK_Z_M + _LOW_BACK_M[1]),
    "high_back": (TABLE_BACK_Z_M + _HIGH_BACK_M[0], TABLE_BACK_Z_M + _HIGH_BACK_M[1]),
    "beside_table": (TABLE_FRONT_Z_M + 2.0 * _BESIDE_TABLE_M, TABLE_FRONT_Z_M + _BESIDE_TABLE_M),
    "above_table": (TABLE_TOP_M + _ABOVE_TABLE_M, TABLE_TOP_M + _OVER_TABLE_M),
    "low": (TABLE_TOP_M + _HIGH_M, TABLE_TOP_M + _LOW_M),
    "together": (_APART_M, _TOGETHER_M),
}
"""Measures at which something counts not at all, and at which it counts fully."""
FIT = np.dtype(
    [
        ("joint", FIGURE_JOINT, len(figure.FIGURE)), ("limb", FIGURE_LIMB, figure.ENDS.shape[1]),
        ("part", BODY_PART, len(REGIONS)),
        ("hips_reference", "<f4", 3), ("hips", "<f4", 3), ("palm", "<f4", (2, 3)),
        ("leg", "<f4"), ("hand", "<f4"), ("arm", "<f4", 2), ("table_m", "<f4"), ("clear", "<f4"), ("middle", "<f4"),
        *((name, "<f4", 2) for name in _LIMITS),
        ("shapes", "<i4"), ("reach", "<f4"), ("own_hand", HAND, 2), ("shape", SHAPE, len(REGIONS)),
    ]
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Fitting:
    """A body as the fit wants it. Make it with fit_to.

    rest: (41, 3) local translations of the fitted figure; hips: (3,) where its hips rest; leg, hand, arm (2,): this
    body's length over the reference's. limbs: (4,) LIMB of arms and legs; feet: (2, 2, 3) ankles at rest, the
    reference's and this body's; centre, radius: (2, 4, 3) of REGIONS in their joints' frames on both bodies. hands:
    (2,) HAND; shapes: (n,) SHAPE of what they stay out of, none for hands like the reference's.
    """

    rest: Floats
    hips: Floats
    leg: float
    hand: float
    arm: Floats
    limbs: NDArray[np.void]
    feet: Floats
    centre: Floats
    radius: Floats
    hands: NDArray[np.void]
    shapes: NDArray[np.void]

    @property
    def big_handed(self) -> bool:
        """Whether its hands are so much bigger than the reference's that they need to know the body's shape."""
        return self.hand > BIGGER_HAND

    def table(self) -> NDArray[np.void]:
        """(1,) Fit of skin/fit.h."""
        fit = np.zeros(1, dtype=FIT)
        joint = fit[0]["joint"]
        joint["turn"], joint["parent"] = figure.FIGURE, figure.PARENTS
        joint["reference"], joint["mine"] = REFERENCE.rest_translation[figure.FIGURE], self.rest[figure.FIGURE]
        limb = fit[0]["limb"]
        limb["joints"] = figure.BONES.reshape(4, 4).T
        limb["bones"] = self.limbs
        limb["foot_reference"][2:], limb["foot"][2:] = self.feet
        part = fit[0]["part"]
        part["joint"] = [figure.WHERE[region] for region in REGIONS]
        for body, name in enumerate(("reference", "mine")):
            part[name]["centre"], part[name]["radius"] = self.centre[body], self.radius[body]
        fit["hips_reference"], fit["hips"] = _REST["hips"], self.hips
        fit["palm"] = [(_PALM_M, 0.0, 0.0), (-_PALM_M, 0.0, 0.0)]
        fit["leg"], fit["hand"], fit["arm"] = self.leg, self.hand, self.arm
        fit["table_m"], fit["clear"], fit["middle"] = TABLE_TOP_M, _CLEAR, _MIDDLE
        for name, limit in _LIMITS.items():
            fit[name] = limit
        fit["shapes"], fit["reach"], fit["own_hand"] = len(self.shapes), hand_reach(self.hand), self.hands
        fit[0]["shape"][: len(self.shapes)] = self.shapes
        return fit


def fit_to(
    places: Mapping[str, Floats], size: BodySize | None = None, shape: BodyShape | None = None
) -> Fitting | None:
    """The fitting of a body.

    places: VRM humanoid bone -> (3,) where its joint is in the T-pose, model space, metres, feet on y = 0, facing +Z.
    size: how its parts differ in size; guessed from the skeleton where None. shape: of its outside, which hands bigger
    than the reference's stay out of.
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
    both = np.stack([REFERENCE.rest_translation, rest])
    # Bodies side by side, upper and lower bones, arms and legs: (2, 2, 4).
    lengths = np.maximum(np.linalg.norm(both[:, figure.ENDS[1:]], axis=-1), 1e-4)
    arm, leg = lengths[1].sum(0)[:2] / lengths[0].sum(0)[:2], lengths[1].sum(0)[2:] / lengths[0].sum(0)[2:]
    hand = _hand_share(places, float(arm.mean()))
    centre, radius = _places(where, size)
    reach = np.array([_REACH, _REACH, STRAIGHT, STRAIGHT])
    return Fitting(
        rest=rest,
        hips=where["hips"],
        leg=float(leg.mean()),
        hand=hand,
        arm=arm,
        # A pose's reach was clamped when it was made; it is not once more.
        limbs=limb_table(lengths[1, 0], lengths[1, 1], reach),
        feet=np.array([[w[f"{side}Foot"] for side in _SIDES] for w in (_REST, where)]),
        centre=centre,
        radius=radius,
        hands=hands_table(where, hand),
        shapes=shapes_table(shape) if shape and hand > BIGGER_HAND else np.zeros(0, dtype=SHAPE),
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


def _places(where: Mapping[str, Floats], size: BodySize | None) -> tuple[Floats, Floats]:
    """(2, 4, 3) centres in their joints' frames and radii of REGIONS: the reference's, this body's."""
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
    own = [centre - _REST[region] for region, centre in zip(REGIONS, _CENTRES, strict=True)]
    return np.array([own, centres]), np.array([_RADII, radii])


def _shoulders(where: Mapping[str, Floats]) -> float:
    return float(np.linalg.norm(where["leftUpperArm"] - where["rightUpperArm"]))
