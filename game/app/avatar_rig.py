"""A foreign avatar's skeleton in the stall: set upright and facing the customer, scaled, its springs and eyes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import EyeBones, Rig, measure_body
from game.animation import SpringChain as RigChain
from game.animation import SpringCollider as RigCollider
from game.core import quaternion as quat
from game.core.errors import BadInput, Where
from game.core.humanoid import HEAD_CENTRE_OFFSET, REFERENCE
from game.formats import AvatarGeometry, GltfFile, SpringChain, SpringCollider, VrmLookAt, skeleton_of

__all__ = ["EYE_HEIGHT_M", "Placing", "avatar_rig", "place_avatar"]

Floats = NDArray[np.floating[Any]]

EYE_HEIGHT_M = float(REFERENCE.rest_model[REFERENCE.index["head"], 1, 3] + HEAD_CENTRE_OFFSET[1] - 0.036)
"""Where the eyes of the reference are: the cameras look there."""
HIPS_HEIGHT_M, HIPS_SAY = float(REFERENCE.rest_model[0, 1, 3]), 0.4
GAZE_DEG = (35.0, 24.0)
"""What a gaze of 1 means, sideways and up (liveliness.py)."""
_EYE_SHARE = 0.42
"""Eyes over the head joint as a share of what is above it, where a file says nothing of eyes."""
_TAIL_M = 0.07
"""VRM 0.x lets the last bone of a chain swing as if another joint followed 7 cm further on."""
_SMALLEST, _LARGEST = 1e-3, 1e3


@dataclass(frozen=True, eq=False)
class Placing:
    """matrix: (4, 4) from the file's model space to the stall's; scale: its size factor; eyes_m: their height."""

    matrix: Floats
    scale: float
    eyes_m: float


def place_avatar(
    file: GltfFile, bones: Mapping[str, int], geometry: AvatarGeometry, look_at: VrmLookAt | None = None
) -> Placing:
    """Feet on the ground below the head, facing +Z, eyes where the reference has hers.

    Raises BadInput where the figure has no size, or left and right cannot be told.
    """
    model = file.node_model
    at = {name: model[node, :3, 3] for name, node in bones.items()}
    vertices = geometry.rest_places(model)
    left = at["leftUpperArm"] - at["rightUpperArm"] + at["leftUpperLeg"] - at["rightUpperLeg"]
    where = Where(file.path)
    if np.hypot(left[0], left[2]) < 1e-4:
        raise BadInput("avatar", where=where, expected="left and right apart", seen="arms and legs at one place")
    # To the nearest quarter turn: rest poses are slightly twisted, files are not.
    quarter = round(np.arctan2(-left[2], left[0]) / (0.5 * np.pi))
    yaw = quat.from_axis_angle([0.0, 1.0, 0.0], -0.5 * np.pi * quarter)
    turn = quat.to_matrix(yaw)
    floor = float(np.percentile(vertices[:, 1], 0.05))
    floor = min(floor, min(float(at[f"{s}Foot"][1]) for s in ("left", "right")))
    eyes = _eye_height(at, vertices, geometry, bones, look_at)
    if not eyes - floor > 1e-3:
        raise BadInput("avatar", where=where, expected="a head above the feet", seen=f"{eyes - floor:.3g} m")
    # Long legs would lift the hips over the table: then the figure is a little smaller and the eyes a little lower.
    hips_m = max(float(at["hips"][1]) - floor, 1e-3)
    scale = EYE_HEIGHT_M / (eyes - floor)
    scale *= min(1.0, HIPS_HEIGHT_M / (hips_m * scale)) ** HIPS_SAY
    if not _SMALLEST < scale < _LARGEST:
        raise BadInput("avatar", where=where, expected="a figure of 1 mm to 1 km", seen=f"eyes {eyes - floor:.3g} m up")
    matrix = np.eye(4)
    matrix[:3, :3] = scale * turn
    hips = at["hips"]
    matrix[:3, 3] = -scale * (turn @ np.array([hips[0], floor, hips[2]]))
    return Placing(matrix, scale, scale * (eyes - floor))


def _eye_height(
    at: Mapping[str, Floats],
    vertices: Floats,
    geometry: AvatarGeometry,
    bones: Mapping[str, int],
    look_at: VrmLookAt | None,
) -> float:
    if "leftEye" in at and "rightEye" in at:
        height = float(0.5 * (at["leftEye"][1] + at["rightEye"][1]))
        if height > at["head"][1]:
            return height
    if look_at is not None and look_at.offset[1] > 0.0:
        return float(at["head"][1] + look_at.offset[1])
    mine = vertices[geometry.owners() == bones["head"]]
    above = mine[mine[:, 1] > at["head"][1]]
    neck = at["head"] - at.get("neck", at["spine"])
    top = float(np.percentile(above[:, 1], 98)) if len(above) else float(at["head"][1] + neck[1])
    return float(at["head"][1] + _EYE_SHARE * (top - at["head"][1]))


def avatar_rig(
    file: GltfFile,
    bones: Mapping[str, int],
    geometry: AvatarGeometry,
    placing: Placing,
    springs: Sequence[SpringChain] = (),
    colliders: Sequence[SpringCollider] = (),
    look_at: VrmLookAt | None = None,
    *,
    open_ends: bool = False,
) -> Rig:
    """The rig in the stall's space; skin columns in the geometry's order. open_ends: chains end as VRM 0.x means it.

    Raises BadInput where needed bones are missing.
    """
    wanted = set(geometry.column_node) | set(bones.values())
    wanted |= {joint.node for chain in springs for joint in chain.joints} | {c.node for c in colliders}
    found = skeleton_of(file, wanted)
    place, turn = found.skeleton.to_model(found.skeleton.rest_rotation)
    world = placing.matrix @ file.node_model
    yaw = quat.from_matrix(placing.matrix[:3, :3] / placing.scale)
    place = place @ placing.matrix[:3, :3].T + placing.matrix[:3, 3]
    turn = quat.multiply(np.broadcast_to(yaw, turn.shape), turn)
    names, parents = list(found.skeleton.names), found.skeleton.parents.tolist()
    chains = []
    for chain in springs:
        line = [found.joint[joint.node] for joint in chain.joints]
        if open_ends and line:
            place, turn = _lengthen(place, turn, names, parents, line, placing.scale)
        chains += _pieces(chain, line, parents, placing)
    rest, local = _local(place, turn, parents)
    columns = np.array([found.joint[node] for node in geometry.column_node], dtype=np.intp)
    rest_model = np.zeros((len(columns), 4, 4))
    rest_model[:, :3, :3], rest_model[:, :3, 3], rest_model[:, 3, 3] = (
        quat.to_matrix(turn[columns]),
        place[columns],
        1.0,
    )
    bind = np.linalg.inv(rest_model) @ world[list(geometry.column_node)] @ geometry.inverse_bind
    vertices = geometry.rest_places(world)
    owners = geometry.owners()
    trunk = [bones[b] for b in ("hips", "spine", "chest", "upperChest") if b in bones]
    joint = {name: found.joint[node] for name, node in bones.items()}
    size = measure_body(
        vertices, owners == bones["head"], np.isin(owners, trunk), place[joint["hips"]], place[joint["head"]]
    )
    return Rig.from_arrays(
        names,
        np.array(parents),
        rest,
        bind,
        rest_rotation=local,
        skin_joint=columns,
        bones=joint,
        chains=chains,
        colliders=[_collider(c, found.joint[c.node], world[c.node], turn, placing.scale) for c in colliders],
        size=size,
        eyes=_eye_bones(joint, look_at),
    )


def _local(place: Floats, turn: Floats, parents: list[int]) -> tuple[Floats, Floats]:
    above = np.maximum(parents, 0)
    roots = (np.array(parents) < 0)[:, None]
    back = quat.conjugate(turn[above])
    rest = np.where(roots, place, quat.rotate(back, place - place[above]))
    return np.asarray(rest), np.asarray(np.where(roots, turn, quat.multiply(back, turn)))


def _lengthen(
    place: Floats, turn: Floats, names: list[str], parents: list[int], line: list[int], scale: float
) -> tuple[Floats, Floats]:
    """A joint behind the last one of a chain, along the way that led there."""
    last = line[-1]
    above = parents[last]
    way = place[last] - place[above] if above >= 0 else np.array([0.0, -1.0, 0.0])
    length = float(np.linalg.norm(way))
    way = way / length if length > 1e-6 else np.array([0.0, -1.0, 0.0])
    line.append(len(names))
    names.append(f"spring_end_{len(names)}")
    parents.append(last)
    return np.vstack([place, place[last] + way * _TAIL_M * scale]), np.vstack([turn, turn[last]])


def _pieces(chain: SpringChain, line: list[int], parents: list[int], placing: Placing) -> list[RigChain]:
    """The chain's stretches of joints that hang directly on each other, in the stall's size."""
    stretches: list[list[int]] = []
    for at, joint in enumerate(line):
        if at and parents[joint] == line[at - 1]:
            stretches[-1].append(at)
        else:
            stretches.append([at])
    scale, turn = placing.scale, placing.matrix[:3, :3] / placing.scale
    made = []
    for stretch in stretches:
        if len(stretch) < 2 or parents[line[stretch[0]]] < 0:
            continue
        joints = [chain.joints[min(at, len(chain.joints) - 1)] for at in stretch[:-1]]
        down = [turn @ np.array(j.gravity_dir) for j in joints]
        made.append(
            RigChain(
                joints=tuple(line[at] for at in stretch),
                stiffness=tuple(j.stiffness * scale for j in joints),
                gravity_power=tuple(j.gravity_power * scale for j in joints),
                gravity_dir=tuple((float(d[0]), float(d[1]), float(d[2])) for d in down),
                drag=tuple(j.drag_force for j in joints),
                hit_radius_m=tuple(j.hit_radius_m * scale for j in joints),
                colliders=tuple(chain.colliders),
            )
        )
    return made


def _collider(collider: SpringCollider, joint: int, world: Floats, turn: Floats, scale: float) -> RigCollider:
    """Offsets are in the node's frame, whose scale the rig's joints no longer have."""
    back = quat.to_matrix(turn[joint]).T @ world[:3, :3]
    start, tail = back @ np.array(collider.offset), None
    if collider.tail is not None:
        end = back @ np.array(collider.tail)
        tail = (float(end[0]), float(end[1]), float(end[2]))
    size = float(np.cbrt(abs(np.linalg.det(world[:3, :3])))) or scale
    return RigCollider(joint, (float(start[0]), float(start[1]), float(start[2])), collider.radius_m * size, tail)


def _eye_bones(joint: Mapping[str, int], look_at: VrmLookAt | None) -> EyeBones | None:
    if "leftEye" not in joint or "rightEye" not in joint or (look_at is not None and look_at.kind != "bone"):
        return None
    ranges = {} if look_at is None else look_at.ranges

    def turned(name: str, gaze_deg: float) -> float:
        # VRMC_vrm lookAt: the angle is cut at the input's end and mapped onto the output's.
        end, scale = ranges.get(name, (gaze_deg, 0.5 * gaze_deg))
        return scale * min(gaze_deg, end) / end if end > 0.0 else 0.0

    across, up = GAZE_DEG
    return EyeBones(
        joint["leftEye"],
        joint["rightEye"],
        turned("HorizontalInner", across),
        turned("HorizontalOuter", across),
        turned("VerticalDown", up),
        turned("VerticalUp", up),
    )
