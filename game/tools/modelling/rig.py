"""The joints a character is bound to: the reference humanoid, forearm twists, and the chains that swing.

Two poses of the same bones matter. The file's rest pose is the T-pose of ``game.core.humanoid``; the surface is
modelled in the A-pose (arms 45 degrees down), where sleeves and armpits have their natural folds. The inverse bind
matrices undo the A-pose, so that at rest the skin is in the T-pose.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from game.core.humanoid import HEAD_CENTRE_OFFSET, REFERENCE
from game.tools.modelling.fields import Floats

__all__ = ["ARM_DROP_RAD", "Arm", "Chain", "Rig", "a_pose", "head_centre", "left_arm"]

ARM_DROP_RAD = np.pi / 4
"""How far the modelled arms hang below the T-pose."""


def head_centre() -> Floats:
    """Centre of the skull in model space, (3,) metres."""
    return np.asarray(REFERENCE.rest_model[REFERENCE.index["head"], :3, 3] + HEAD_CENTRE_OFFSET)


@dataclass(frozen=True, eq=False)
class Chain:
    """A spring-bone chain: ``points[:-1]`` are joints that carry skin, ``points[-1]`` only ends the last one.

    points: (k + 1, 3) metres, model space. The dynamics are VRM's: stiffness and gravity in the units of
    VRMC_springBone 1.0, drag 0..1.
    """

    name: str
    parent: str
    points: Floats
    stiffness: float
    drag: float
    gravity: float
    hit_radius_m: float
    colliders: tuple[str, ...] = ()

    @property
    def joints(self) -> tuple[str, ...]:
        return tuple(f"{self.name}_{i + 1}" for i in range(len(self.points) - 1))

    @property
    def end(self) -> str:
        return f"{self.name}_end"


@dataclass(frozen=True, eq=False)
class Arm:
    """The left arm in the A-pose. along, up, forward: the T-pose's x, y, z turned with the arm."""

    shoulder: Floats
    along: Floats
    up: Floats
    forward: Floats
    upper_m: float
    fore_m: float

    def at(self, distance: float, up: float = 0.0, forward: float = 0.0) -> Floats:
        """Point ``distance`` metres down the arm from the shoulder."""
        return self.shoulder + self.along * distance + self.up * up + self.forward * forward

    def in_hand(self, x: float, y: float, z: float) -> Floats:
        """Hand coordinates (x along the fingers, y back of the hand, z thumb side) to model space."""
        return self.at(self.upper_m + self.fore_m + x, y, z)

    @property
    def elbow(self) -> Floats:
        return self.at(self.upper_m)

    @property
    def wrist(self) -> Floats:
        return self.at(self.upper_m + self.fore_m)

    @property
    def axes(self) -> Floats:
        """(3, 3), columns along, up, forward."""
        return np.stack([self.along, self.up, self.forward], 1)

    def distance_along(self, points: Floats) -> Floats:
        """(n,) metres from the shoulder along the arm."""
        return np.asarray((points - self.shoulder) @ self.along)

    def angle_around(self, points: Floats) -> Floats:
        """(n,) radians about the arm, 0 forward."""
        q = points - self.shoulder
        return np.arctan2(q @ self.up, q @ self.forward)

    def finger(self, name: str) -> tuple[Floats, Floats, Floats]:
        """Knuckle, middle joint and tip of a finger in hand coordinates (x, y, z)."""
        offset = REFERENCE.rest_translation
        knuckle = offset[REFERENCE.index[f"left{name}Proximal"]]
        middle = knuckle + offset[REFERENCE.index[f"left{name}Intermediate"]]
        # The middle joint stands at 48 % of the length and half of the spread (game.core.humanoid).
        tip = knuckle + (middle - knuckle) * (1 / 0.48, 0.0, 2.0)
        return knuckle, middle, tip

    def thumb(self) -> tuple[Floats, Floats, Floats]:
        """Metacarpal joint, proximal joint and tip of the thumb in hand coordinates."""
        offset = REFERENCE.rest_translation
        base = offset[REFERENCE.index["leftThumbMetacarpal"]]
        middle = base + offset[REFERENCE.index["leftThumbProximal"]]
        return base, middle, middle + (0.032, -0.002, 0.012)


def left_arm() -> Arm:
    position = REFERENCE.rest_model[:, :3, 3]
    shoulder, elbow, wrist = (position[REFERENCE.index[f"left{n}"]] for n in ("UpperArm", "LowerArm", "Hand"))
    c, s = np.cos(ARM_DROP_RAD), np.sin(ARM_DROP_RAD)
    return Arm(
        shoulder=shoulder,
        along=np.array([c, -s, 0.0]),
        up=np.array([s, c, 0.0]),
        forward=np.array([0.0, 0.0, 1.0]),
        upper_m=float(np.linalg.norm(elbow - shoulder)),
        fore_m=float(np.linalg.norm(wrist - elbow)),
    )


@dataclass(frozen=True, eq=False)
class Rig:
    """All joints that carry skin, parents first.

    position: (J, 3) T-pose, metres. bind: (J, 4, 4) model-space joint matrices of the A-pose.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    position: Floats
    bind: Floats
    chains: tuple[Chain, ...]
    index: dict[str, int] = field(repr=False)

    @staticmethod
    def with_chains(chains: Sequence[Chain]) -> Rig:
        """The reference humanoid plus forearm twists plus the chains' joints, in that order."""
        names, parents = list(REFERENCE.names), [int(p) for p in REFERENCE.parents]
        position = [REFERENCE.rest_model[i, :3, 3] for i in range(len(names))]
        for side in ("left", "right"):
            elbow, wrist = names.index(f"{side}LowerArm"), names.index(f"{side}Hand")
            names.append(f"{side}ForearmTwist")
            parents.append(elbow)
            position.append((position[elbow] + position[wrist]) / 2)
        for chain in chains:
            parent = names.index(chain.parent)
            for name, point in zip(chain.joints, chain.points[:-1], strict=True):
                names.append(name)
                parents.append(parent)
                position.append(point)
                parent = len(names) - 1
        where: Floats = np.array(position, dtype=np.float64)
        return Rig(tuple(names), tuple(parents), where, a_pose(names, parents, where), tuple(chains), _indexed(names))

    def mirrored_columns(self) -> Floats:
        """(J,) column order that swaps left and right joints (chains stay)."""
        swapped = []
        for name in self.names:
            for here, there in (("left", "right"), ("right", "left")):
                if name.startswith(here):
                    name = there + name[len(here) :]
                    break
            swapped.append(self.index[name])
        return np.array(swapped)


def _indexed(names: Sequence[str]) -> dict[str, int]:
    return {name: i for i, name in enumerate(names)}


def a_pose(names: Sequence[str], parents: Sequence[int], position: Floats) -> Floats:
    """(J, 4, 4) joint matrices with both arm chains turned down about the UpperArm joints."""
    bind = np.tile(np.eye(4), (len(names), 1, 1))
    bind[:, :3, 3] = position
    for side, sign in (("left", 1.0), ("right", -1.0)):
        root = names.index(f"{side}UpperArm")
        inside = {root}
        for joint, parent in enumerate(parents):
            if parent in inside:
                inside.add(joint)
        chain = sorted(inside)
        c, s = np.cos(-sign * ARM_DROP_RAD), np.sin(-sign * ARM_DROP_RAD)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        bind[chain, :3, :3] = turn
        bind[chain, :3, 3] = (position[chain] - position[root]) @ turn.T + position[root]
    return bind
