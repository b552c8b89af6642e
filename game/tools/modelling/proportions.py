"""A person's own proportions: the body is modelled at the reference humanoid's size and stretched afterwards.

Every joint of the reference has a scale along its own axes; the offsets to its children stretch with it. The surface
follows by the skin weights it has anyway, so that clothes, straps and spectacles stay where they belong.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from game.tools.modelling.fields import Floats, unit
from game.tools.modelling.mesh import Mesh
from game.tools.modelling.rig import Rig, a_pose

__all__ = ["Figure", "Proportions"]

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Proportions:
    """Factors of the reference body's sizes. trunk: width, height, depth; limbs: length, thickness."""

    trunk: Vector = (1.0, 1.0, 1.0)
    shoulders: float = 1.0
    neck: tuple[float, float] = (1.0, 1.0)
    head: float = 1.0
    upper_arm: tuple[float, float] = (1.0, 1.0)
    forearm: tuple[float, float] = (1.0, 1.0)
    hand: float = 1.0
    thigh: tuple[float, float] = (1.0, 1.0)
    shin: tuple[float, float] = (1.0, 1.0)
    foot: float = 1.0

    def scale(self, joint: str) -> Vector:
        """Factors along x, y, z of what hangs on a joint of the reference humanoid (or of its forearm twists)."""
        side = joint.removeprefix("left").removeprefix("right")
        if joint in ("hips", "spine", "chest"):
            return self.trunk
        if joint == "neck":
            return (self.neck[1], self.neck[0], self.neck[1])
        if joint == "head":
            return (self.head, self.head, self.head)
        if side == "Shoulder":
            return (self.shoulders, self.trunk[1], self.trunk[2])
        if side == "UpperArm":
            return (self.upper_arm[0], self.upper_arm[1], self.upper_arm[1])
        if side in ("LowerArm", "ForearmTwist"):
            return (self.forearm[0], self.forearm[1], self.forearm[1])
        if side == "UpperLeg":
            return (self.thigh[1], self.thigh[0], self.thigh[1])
        if side == "LowerLeg":
            return (self.shin[1], self.shin[0], self.shin[1])
        if side in ("Foot", "Toes"):
            return (self.foot, self.foot, self.foot)
        return (self.hand, self.hand, self.hand)


@dataclass(frozen=True, eq=False)
class Figure:
    """A rig stretched to a person's proportions. rig: the person's. scale: (J, 3). turn: (J, 4, 4) from the modelled
    A-pose to the person's; None where nothing is stretched."""

    rig: Rig
    scale: Floats
    turn: Floats | None

    @staticmethod
    def of(modelled: Rig, proportions: Proportions) -> Figure:
        """Stretch ``modelled``; the soles stay on the ground."""
        count = len(modelled.names)
        scale = np.ones((count, 3))
        if proportions == Proportions():
            return Figure(modelled, scale, None)
        body = len(modelled.names) - sum(len(chain.joints) for chain in modelled.chains)
        position = modelled.position.copy()
        for joint, (name, parent) in enumerate(zip(modelled.names, modelled.parents, strict=True)):
            # What swings is as large as what it hangs on.
            scale[joint] = proportions.scale(name) if joint < body else scale[parent]
            if parent >= 0:
                offset = modelled.position[joint] - modelled.position[parent]
                position[joint] = position[parent] + scale[parent] * offset
        ankle = modelled.index["leftFoot"]
        position[:, 1] += modelled.position[ankle, 1] * scale[ankle, 1] - position[ankle, 1]
        chains = []
        for chain in modelled.chains:
            joints = [modelled.index[name] for name in chain.joints]
            last = position[joints[-1]] + scale[joints[-1]] * (chain.points[-1] - chain.points[-2])
            chains.append(replace(chain, points=np.vstack([position[joints], last])))
        bind = a_pose(modelled.names, modelled.parents, position)
        rig = replace(modelled, position=position, bind=bind, chains=tuple(chains))
        stretched = bind.copy()
        stretched[:, :3, :3] = bind[:, :3, :3] * scale[:, None, :]
        return Figure(rig, scale, stretched @ np.linalg.inv(modelled.bind))

    def stretched(self, mesh: Mesh, weights: Floats) -> Mesh:
        """The mesh as the person has it; weights (n, J)."""
        if self.turn is None:
            return mesh
        turn = np.einsum("nj,jab->nab", weights, self.turn)
        position = np.einsum("nab,nb->na", turn[:, :3, :3], mesh.position) + turn[:, :3, 3]
        normal = np.linalg.solve(turn[:, :3, :3].transpose(0, 2, 1), mesh.normal[:, :, None])[:, :, 0]
        return Mesh(position, unit(normal), mesh.triangle)

    def size_at(self, joint: str) -> Floats:
        """(3,) factors of a joint."""
        return np.asarray(self.scale[self.rig.index[joint]])
