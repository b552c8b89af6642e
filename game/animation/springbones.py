"""Hair, scarf and bow: spring bones with the meaning VRM gives them (VRMC_springBone 1.0), for many characters.

VRM defines a Verlet step per frame without saying how long a frame is; three-vrm and UniVRM run at 60 per second.
Here a step of any length has the damping and the terminal velocity of that many 60ths, so 30 and 60 ticks a second
hang and swing alike. The step itself is skin/springs.c; here chains are checked and made into its tables.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import quaternion as quat
from game.core.errors import BadInput
from game.core.skeleton import Skeleton

__all__ = ["COLLIDER", "PIECE", "SpringChain", "SpringCollider", "SpringSet", "SpringState", "build_springs"]

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.intp]

# As in skin/rig.h.
PIECE = np.dtype(
    [
        ("axis", "<f4", 3), ("length_m", "<f4"), ("stiffness", "<f4"), ("gravity", "<f4", 3), ("keep", "<f4"),
        ("radius_m", "<f4"), ("first_collider", "<i4"), ("colliders", "<i4"),
    ]
)  # fmt: skip
COLLIDER = np.dtype([("joint", "<i4"), ("start", "<f4", 3), ("way", "<f4", 3), ("radius_m", "<f4")])


@dataclass(frozen=True)
class SpringChain:
    """joints: rig joints from root to tip, each the parent of the next; the other tuples have one value per piece
    (one fewer than joints). colliders: indices of what the chain may not enter. Units as in VRM, metres."""

    joints: tuple[int, ...]
    stiffness: tuple[float, ...]
    gravity_power: tuple[float, ...]
    gravity_dir: tuple[tuple[float, float, float], ...]
    drag: tuple[float, ...]
    hit_radius_m: tuple[float, ...]
    colliders: tuple[int, ...] = ()


@dataclass(frozen=True)
class SpringCollider:
    """A sphere on a rig joint, or with a tail a capsule; metres in the joint's frame."""

    joint: int
    offset: tuple[float, float, float]
    radius_m: float
    tail: tuple[float, float, float] | None = None


@dataclass(frozen=True, eq=False)
class SpringSet:
    """All pieces of a rig's chains, a joint's together, parents first. joint: (S,) of the rig that each turns; piece:
    (S,) PIECE; collider: COLLIDER on joints of the rig; met: the colliders of all pieces, one after the other."""

    joint: Ints
    piece: NDArray[np.void]
    collider: NDArray[np.void]
    met: Ints

    @property
    def pieces(self) -> int:
        """How many there are."""
        return len(self.piece)


@dataclass(frozen=True, eq=False)
class SpringState:
    """Springs of n characters between two steps. swing: (n, S, 2, 3) tails in model space (metres) and their speeds
    (metres per second), None before the first step."""

    n: int
    swing: Floats | None = None

    @property
    def tail(self) -> Floats:
        """(n, S, 3), after the first step."""
        assert self.swing is not None
        return self.swing[:, :, 0]


def build_springs(
    skeleton: Skeleton,
    chains: tuple[SpringChain, ...],
    colliders: tuple[SpringCollider, ...],
    place: Floats,
    turn: Floats,
) -> SpringSet:
    """place, turn: (J, 3), (J, 4) of the joints in the T-pose, model space.

    Raises BadInput for a chain that is no line of joints or names an unknown collider.
    """
    for number, chain in enumerate(chains):
        _check(skeleton, chain, number, len(colliders))
    every = [(chain, at) for chain in chains for at in range(len(chain.joints) - 1)]
    every.sort(key=lambda one: one[0].joints[one[1]])
    piece = np.zeros(len(every), dtype=PIECE)
    met: list[int] = []
    for row, (chain, at) in zip(piece, every, strict=True):
        way = place[chain.joints[at + 1]] - place[chain.joints[at]]
        row["length_m"] = length = max(float(np.linalg.norm(way)), 1e-6)
        row["axis"] = way / length
        row["stiffness"], row["keep"] = chain.stiffness[at], np.clip(1.0 - chain.drag[at], 0.0, 1.0)
        row["gravity"] = np.multiply(chain.gravity_dir[at], chain.gravity_power[at])
        row["radius_m"] = chain.hit_radius_m[at]
        row["first_collider"], row["colliders"] = len(met), len(set(chain.colliders))
        met += sorted(set(chain.colliders))
    balls = np.zeros(len(colliders), dtype=COLLIDER)
    for row, ball in zip(balls, colliders, strict=True):
        row["joint"], row["radius_m"] = ball.joint, ball.radius_m
        row["start"] = quat.rotate(turn[ball.joint], np.array(ball.offset))
        row["way"] = quat.rotate(turn[ball.joint], np.subtract(ball.tail or ball.offset, ball.offset))
    joint = np.array([chain.joints[at] for chain, at in every], dtype=np.intp)
    return SpringSet(joint, piece, balls, np.array(met, dtype=np.intp))


def _check(skeleton: Skeleton, chain: SpringChain, number: int, colliders: int) -> None:
    pieces = len(chain.joints) - 1
    values = (chain.stiffness, chain.gravity_power, chain.gravity_dir, chain.drag, chain.hit_radius_m)
    if pieces < 1 or any(len(v) < pieces for v in values):
        raise BadInput(f"spring chain {number}", expected="two joints or more, values per piece", seen=chain.joints)
    for above, below in zip(chain.joints, chain.joints[1:], strict=False):
        if not 0 <= below < len(skeleton) or skeleton.parents[below] != above:
            raise BadInput(f"spring chain {number}", expected=f"a child of joint {above}", seen=below)
    if skeleton.parents[chain.joints[0]] < 0:
        raise BadInput(f"spring chain {number}", expected="a joint that hangs on another", seen=chain.joints[0])
    if any(not 0 <= c < colliders for c in chain.colliders):
        raise BadInput(f"spring chain {number}", expected=f"colliders below {colliders}", seen=chain.colliders)
