"""A VRM file's skeleton, skin and springs as the animation wants them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.animation import REGIONS, BodyShape, BodySize, Rig, fit_to, measure_body, measure_shape
from game.animation import SpringChain as RigChain
from game.animation import SpringCollider as RigCollider
from game.core.errors import BadInput, Where
from game.formats import SpringChain, Vrm, read_vrm, skeleton_of

__all__ = ["load_rig", "rig_of"]


def load_rig(path: Path, *, springs: bool = True) -> Rig:
    """Read a VRM and make its rig. springs: hair and cloth swing. Raises BadInput where it has no skin to move."""
    return rig_of(read_vrm(path), springs=springs)


def rig_of(vrm: Vrm, *, springs: bool = True) -> Rig:
    """The rig of a VRM's first skin: humanoid bones, twist joints, spring chains with their colliders."""
    file = vrm.gltf
    if not file.skins:
        raise BadInput("nothing to move", where=Where(file.path, pointer="/skins"), expected="a skin", seen="none")
    skin = file.skins[0]
    wanted = set(skin.joints) | set(vrm.bones.values())
    wanted |= {joint.node for chain in vrm.springs for joint in chain.joints}
    wanted |= {collider.node for collider in vrm.colliders}
    found = skeleton_of(file, wanted)
    places = {name: file.node_model[node][:3, 3] for name, node in vrm.bones.items()}
    bare = fit_to(places)
    size, shape = (None, None) if bare is None else _measured(vrm, places, bare.big_handed)
    return Rig.from_arrays(
        found.skeleton.names,
        found.skeleton.parents,
        found.skeleton.rest_translation,
        np.asarray(skin.inverse_bind),
        rest_rotation=found.skeleton.rest_rotation,
        skin_joint=found.skin_joints(file, 0),
        bones={name: found.joint[node] for name, node in vrm.bones.items()},
        chains=[_chain(chain, found.joint) for chain in vrm.springs if springs and len(chain.joints) > 1],
        colliders=[RigCollider(found.joint[c.node], c.offset, c.radius_m, c.tail) for c in vrm.colliders if springs],
        size=size,
        shape=shape,
    )


def _measured(
    vrm: Vrm, places: Mapping[str, NDArray[np.float64]], big_handed: bool
) -> tuple[BodySize, BodyShape | None]:
    """How big head and trunk are, and the shape that big hands need, from the finest mesh of the first skin."""
    file = vrm.gltf
    joints = np.array(file.skins[0].joints)
    head = joints == vrm.bones["head"]
    trunk = np.isin(joints, [vrm.bones[b] for b in ("hips", "spine", "chest", "upperChest") if b in vrm.bones])
    meshes = [node.mesh for node in file.nodes if node.mesh is not None and node.skin == 0]
    parts = max(
        ([p for p in file.meshes[mesh].primitives if "JOINTS_0" in p.attributes] for mesh in meshes),
        key=lambda primitives: sum(len(p.attributes["POSITION"]) for p in primitives),
        default=[],
    )
    if not parts:
        return BodySize({}), None
    position, joint, weight = (
        np.concatenate([part.attributes[name] for part in parts]) for name in ("POSITION", "JOINTS_0", "WEIGHTS_0")
    )
    owner = joint[np.arange(len(joint)), weight.argmax(axis=1)]
    size = measure_body(position.astype(np.float64), head[owner], trunk[owner], places["hips"], places["head"])
    if not big_handed:
        return size, None
    starts = np.cumsum([0, *(len(part.attributes["POSITION"]) for part in parts[:-1])])
    corners = [np.arange(len(p.attributes["POSITION"])) if p.indices is None else p.indices for p in parts]
    triangle = np.concatenate(
        [c.reshape(-1, 3).astype(np.intp) + start for c, start in zip(corners, starts, strict=True)]
    )
    region = np.where(head[owner], REGIONS.index("head"), np.where(trunk[owner], 0, -1))
    return size, measure_shape(position.astype(np.float64), triangle, region, places)


def _chain(chain: SpringChain, joint: dict[int, int]) -> RigChain:
    # The last joint of a VRM chain only gives the length of the piece before it.
    pieces = chain.joints[:-1]
    return RigChain(
        joints=tuple(joint[j.node] for j in chain.joints),
        stiffness=tuple(j.stiffness for j in pieces),
        gravity_power=tuple(j.gravity_power for j in pieces),
        gravity_dir=tuple(j.gravity_dir for j in pieces),
        drag=tuple(j.drag_force for j in pieces),
        hit_radius_m=tuple(j.hit_radius_m for j in pieces),
        colliders=tuple(chain.colliders),
    )
