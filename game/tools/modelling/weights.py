"""Skin weights: softmax of the distances to bone capsules, w_j ~ exp(-d_j / sigma).

They are a pure function of the rest position, so that layers of clothing lying on one another move together. Each
kind of part lists the joints that may move it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from game.core.humanoid import FINGERS
from game.tools.modelling.anatomy import Anatomy, joint_at
from game.tools.modelling.fields import Field, Floats, capsule, cone, smoothstep, sphere, union
from game.tools.modelling.rig import Chain, Rig

__all__ = ["Binder", "SleeveFit"]

_BODY_SIGMA_M = 0.017
_ARM_SIGMA_M = 0.013
_SHOULDER_SIGMA_M = 0.016
_ARMPIT_SIGMA_M = 0.008
_WRIST_SIGMA_M = 0.006
_FINGER_SIGMA_M = 0.0028
_HEAD_SIGMA_M = 0.010
_LEG_SIGMA_M = 0.011


@dataclass(frozen=True)
class SleeveFit:
    """The outermost sleeve's radii at the shoulder and 30 cm down the arm, and how far its cloth stands off the trunk,
    metres: where the cloth changes from trunk to arm."""

    start: float = 0.058
    end: float = 0.060
    cloth: float = 0.019
    reach: float | None = None
    """Cloth farther than this from the sleeve never follows the arm: the long skirt of a garment needs it."""


class Binder:
    """Weights (n, J) for points (n, 3) of the A-pose model."""

    def __init__(self, rig: Rig, anatomy: Anatomy, sleeve: SleeveFit | None = None) -> None:
        self.rig = rig
        self.anatomy = anatomy
        self.sleeve = sleeve or SleeveFit()
        arm = anatomy.arm
        self._trunk: dict[str, Field] = {
            "hips": capsule((0, 0.50, 0), (0, 0.60, 0), 0.11),
            "spine": capsule((0, 0.66, 0), (0, 0.73, 0), 0.10),
            "chest": union(
                0.02, capsule((0, 0.79, 0), (0, 0.88, 0), 0.10), capsule((-0.055, 0.90, 0), (0.055, 0.90, 0), 0.045)
            ),
        }
        self._neck = {"neck": capsule((0, 0.975, -0.008), (0, 1.01, -0.008), 0.042)}
        self._left_arm: dict[str, Field] = {
            "leftUpperArm": capsule(arm.at(0.02), arm.elbow, 0.050),
            "leftLowerArm": capsule(arm.elbow, arm.at(arm.upper_m + arm.fore_m * 0.5), 0.045),
            "leftForearmTwist": capsule(arm.at(arm.upper_m + arm.fore_m * 0.5), arm.wrist, 0.040),
        }

    def rigid(self, points: Floats, joint: str) -> Floats:
        weights = np.zeros((len(points), len(self.rig.names)))
        weights[:, self.rig.index[joint]] = 1.0
        return weights

    def soft(self, points: Floats, bones: Mapping[str, Field], sigma_m: float) -> Floats:
        distance = np.stack([bone(points) for bone in bones.values()], 1)
        share = np.exp(-(distance - distance.min(1, keepdims=True)) / sigma_m)
        share /= share.sum(1, keepdims=True)
        weights = np.zeros((len(points), len(self.rig.names)))
        for column, joint in enumerate(bones):
            weights[:, self.rig.index[joint]] += share[:, column]
        return weights

    def _both_sides(self, bones: Mapping[str, Field]) -> dict[str, Field]:
        """The left side's bones and their mirror images."""

        def reflected(bone: Field) -> Field:
            return lambda p: bone(p * (-1.0, 1.0, 1.0))

        return dict(bones) | {"right" + name[len("left") :]: reflected(bone) for name, bone in bones.items()}

    def shirt(self, points: Floats) -> Floats:
        """What lies on the trunk: shirt, apron, pocket."""
        return self.soft(points, self._trunk | self._neck, _BODY_SIGMA_M)

    def coat(self, points: Floats) -> Floats:
        """The coat with its half sleeves: trunk, shoulders, upper arms; the sleeve never follows the forearm."""
        weights = self.soft(points, self._trunk | self._neck, _BODY_SIGMA_M)
        left = self._shoulder_shares(points)
        right = self._shoulder_shares(points * (-1.0, 1.0, 1.0))
        weights *= (1 - left.sum(1) - right.sum(1))[:, None]
        for side, shares in (("left", left), ("right", right)):
            weights[:, self.rig.index[f"{side}Shoulder"]] += shares[:, 0]
            weights[:, self.rig.index[f"{side}UpperArm"]] += shares[:, 1]
        return weights

    def left_sleeve(self, points: Floats) -> Floats:
        """The shirt's sleeve and cuff: at the shoulder bound as the coat over it, so that neither shows through."""
        weights = self.coat(points)
        upper = self.rig.index["leftUpperArm"]
        share = weights[:, [upper]].copy()
        weights[:, upper] = 0.0
        return np.asarray(weights + share * self.soft(points, self._left_arm, _ARM_SIGMA_M))

    def sleeved(self, points: Floats) -> Floats:
        """A garment with both sleeves in one piece: as the coat, and beyond the elbow with the forearm."""
        weights = self.coat(points)
        for side, flip in (("left", (1.0, 1.0, 1.0)), ("right", (-1.0, 1.0, 1.0))):
            upper = self.rig.index[f"{side}UpperArm"]
            share = weights[:, [upper]].copy()
            arm = self.soft(points * flip, self._left_arm, _ARM_SIGMA_M)
            arm = arm if side == "left" else arm[:, self.rig.mirrored_columns()]
            weights[:, upper] = 0.0
            weights += share * arm
        return weights

    def _shoulder_shares(self, points: Floats) -> Floats:
        """(n, 2): what the left collar bone and the left upper arm hold of the cloth around the shoulder.

        The trunk's surface and the sleeve's compete. Over the shoulder the change is long and round; in the armpit it
        is short, or a raised arm would draw the coat's side up with it like a wing.
        """
        arm = self.anatomy.arm
        fit = self.sleeve
        sleeve = cone(arm.at(0.0), arm.at(0.30), fit.start, fit.end)(points)
        over = smoothstep(-0.030, 0.030, (points - arm.shoulder) @ arm.up)
        sigma = _ARMPIT_SIGMA_M + (_SHOULDER_SIGMA_M - _ARMPIT_SIGMA_M) * over
        towards = self.anatomy.trunk(points) - fit.cloth - sleeve
        upper_arm = np.where(points[:, 0] > 0, 1.0 / (1.0 + np.exp(-np.clip(towards / sigma, -40.0, 40.0))), 0.0)
        upper_arm *= smoothstep(0.055, 0.095, points[:, 0])
        if fit.reach is not None:
            arm_wide = capsule(arm.shoulder, arm.wrist, fit.start)(points)
            upper_arm *= smoothstep(fit.reach, 0.4 * fit.reach, arm_wide)
        collar = smoothstep(0.050, 0.110, points[:, 0]) * smoothstep(0.815, 0.895, points[:, 1])
        return np.stack([0.85 * collar * (1 - upper_arm), upper_arm], 1)

    def left_hand(self, points: Floats) -> Floats:
        """Forearm (half of its twist in the twist joint), palm and fingers."""
        arm = self.anatomy.arm
        wrist_bones = {
            "leftLowerArm": self._left_arm["leftLowerArm"],
            "leftForearmTwist": capsule(arm.at(arm.upper_m + arm.fore_m * 0.55), arm.wrist, 0.03),
            "leftHand": capsule(arm.in_hand(0.004, 0, 0), arm.in_hand(0.07, 0, 0), 0.03),
        }
        palm = union(
            0.001,
            capsule(arm.wrist, arm.in_hand(0.052, 0, 0.02), 0.022),
            capsule(arm.wrist, arm.in_hand(0.050, 0, -0.018), 0.022),
            capsule(arm.in_hand(0.05, 0, 0.03), arm.in_hand(0.05, 0, -0.03), 0.014),
        )
        bones: dict[str, Field] = {"leftHand": palm}
        for name in FINGERS:
            knuckle, middle, tip = arm.finger(name)
            start = knuckle + (0.004, 0, 0)
            bones[f"left{name}Proximal"] = capsule(arm.in_hand(*start), arm.in_hand(*middle), 0.0118)
            bones[f"left{name}Intermediate"] = capsule(arm.in_hand(*middle), arm.in_hand(*tip), 0.0118)
        base, middle, tip = arm.thumb()
        start = base + (0.006, 0, 0.006)
        bones["leftThumbMetacarpal"] = capsule(arm.in_hand(*start), arm.in_hand(*middle), 0.0145)
        bones["leftThumbProximal"] = capsule(arm.in_hand(*middle), arm.in_hand(*tip), 0.012)
        beyond_wrist = arm.distance_along(points) - arm.upper_m - arm.fore_m
        mix = smoothstep(0.012, 0.024, beyond_wrist)[:, None]
        at_wrist = self.soft(points, wrist_bones, _WRIST_SIGMA_M)
        return np.asarray(at_wrist * (1 - mix) + self.soft(points, bones, _FINGER_SIGMA_M) * mix)

    def head(self, points: Floats) -> Floats:
        centre = self.anatomy.head_centre
        skull = union(
            0.01,
            sphere(centre, 0.17),
            self.anatomy.jaw,
            capsule(centre + (0, -0.1, -0.02), centre + (0, 0, -0.02), 0.10),
        )
        return self.soft(points, {"chest": self._trunk["chest"]} | self._neck | {"head": skull}, _HEAD_SIGMA_M)

    def collar(self, points: Floats) -> Floats:
        """What lies around the neck."""
        return self.soft(points, {"chest": self._trunk["chest"]} | self._neck, 0.02)

    def scarf(self, points: Floats, tails: tuple[Chain, Chain]) -> Floats:
        """The loop follows neck and chest, each tail its own chain (the first tail lies toward -X)."""
        loop = self.collar(points)
        knot_y, tip_y = tails[0].points[0, 1], tails[0].points[-1, 1]
        front = smoothstep(0.06, 0.075, points[:, 2])
        hanging = (smoothstep(knot_y + 0.004, knot_y + 0.55 * (tip_y - knot_y), points[:, 1]) * front)[:, None]
        middle = (tails[0].points[:, 0].mean() + tails[1].points[:, 0].mean()) / 2
        right = smoothstep(middle + 0.004, middle - 0.004, points[:, 0])[:, None]
        tail = self.rigid(points, tails[0].joints[0]) * right + self.rigid(points, tails[1].joints[0]) * (1 - right)
        return np.asarray(loop * (1 - hanging) + tail * hanging)

    def along_chain(self, points: Floats, chain: Chain) -> Floats:
        """From the chain's parent through its joints, by the nearest place on its line."""
        weights = self.rigid(points, chain.parent)
        for start, end, joint in zip(chain.points[:-1], chain.points[1:], chain.joints, strict=True):
            axis = end - start
            t = (points - start) @ axis / float(axis @ axis)
            share = smoothstep(-0.12, 0.40, t)[:, None]
            weights = weights * (1 - share) + self.rigid(points, joint) * share
        return weights

    def hair(self, points: Floats, chains: Mapping[float, Chain]) -> Floats:
        """Hair is rigid to the head; below the eyes its sides and back follow the chains, keyed by azimuth in rad."""
        if not chains:
            return self.rigid(points, "head")
        local = points - self.anatomy.head_centre
        azimuth = np.arctan2(local[:, 0], local[:, 2])
        loose = smoothstep(0.015, -0.13, local[:, 1]) * smoothstep(np.radians(32), np.radians(50), np.abs(azimuth))
        apart = np.stack([np.abs((azimuth - a + np.pi) % (2 * np.pi) - np.pi) for a in chains], 1)
        share = np.exp(-(apart - apart.min(1, keepdims=True)) / np.radians(7))
        share *= (loose / share.sum(1))[:, None]
        weights = self.rigid(points, "head") * (1 - loose)[:, None]
        for column, chain in enumerate(chains.values()):
            weights[:, self.rig.index[chain.joints[0]]] += share[:, column]
        return weights

    def legs(self, points: Floats) -> Floats:
        """Trousers, legs, socks and shoes of both sides."""
        hip, knee, ankle, toes = (joint_at(f"left{n}") for n in ("UpperLeg", "LowerLeg", "Foot", "Toes"))
        left: dict[str, Field] = {
            "leftUpperLeg": capsule(hip + (0, -0.03, 0), knee, 0.055),
            "leftLowerLeg": capsule(knee, ankle, 0.040),
            "leftFoot": capsule(ankle + (0, -0.03, -0.02), toes + (0, 0.006, -0.016), 0.034),
            "leftToes": capsule(toes + (0, 0.006, 0.014), toes + (0, 0.006, 0.05), 0.034),
        }
        bones = {"hips": capsule((-0.05, 0.56, 0), (0.05, 0.56, 0), 0.085)} | self._both_sides(left)
        weights = self.soft(points, bones, _LEG_SIGMA_M)
        # Below the crotch a leg must not pull at the other one.
        for side, sign in (("left", -1.0), ("right", 1.0)):
            own = (
                smoothstep(0.022, -0.022, sign * points[:, 0]) if sign > 0 else smoothstep(-0.022, 0.022, points[:, 0])
            )
            columns = [
                i for i, n in enumerate(self.rig.names) if n.startswith(side) and n.endswith(("Leg", "Foot", "Toes"))
            ]
            weights[:, columns] *= own[:, None]
        return np.asarray(weights / weights.sum(1, keepdims=True))
