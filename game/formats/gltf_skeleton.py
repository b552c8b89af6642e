"""Skeletons and clips out of glTF node trees.

The project's Skeleton has rotations and translations only. Scales of a file's nodes are baked into the
translations, so that every joint stands in model space exactly where the file puts it in its rest pose.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.core import quaternion as quat
from game.core.clip import Clip
from game.core.errors import BadInput, Where
from game.core.skeleton import Skeleton
from game.formats.gltf_animation import sample_local
from game.formats.gltf_model import Floats, GltfAnimation, GltfFile

__all__ = ["GltfSkeleton", "animation_clip", "skeleton_of"]

_MAX_JOINT_POSES = 5_000_000
_BLOCK_MATRICES = 50_000


@dataclass(frozen=True, eq=False)
class GltfSkeleton:
    """skeleton: J joints, parents first; nodes: (J,) node index of each; joint: node index -> joint."""

    skeleton: Skeleton
    nodes: NDArray[np.intp]
    joint: dict[int, int]

    def skin_joints(self, file: GltfFile, skin: int) -> NDArray[np.intp]:
        """(K,) joint of every joint of a skin, in the skin's order (that of JOINTS_n and inverse_bind)."""
        return np.array([self.joint[node] for node in file.skins[skin].joints], dtype=np.intp)


def skeleton_of(file: GltfFile, nodes: Iterable[int] | None = None) -> GltfSkeleton:
    """The skeleton of some nodes and all their ancestors.

    nodes: None takes the joints of all skins; in a file without skins, what its animations move; else all nodes.
    Raises BadInput where the file has no nodes at all.
    """
    wanted = set(nodes) if nodes is not None else _default_nodes(file)
    if not wanted:
        raise BadInput("no nodes, so no skeleton", where=Where(file.path, pointer="/nodes"))
    for node in list(wanted):
        parent = file.nodes[node].parent
        while parent >= 0 and parent not in wanted:
            wanted.add(parent)
            parent = file.nodes[parent].parent
    order = [index for index in file.order.tolist() if index in wanted]
    joint = {node: at for at, node in enumerate(order)}
    parents = np.array([joint.get(file.nodes[node].parent, -1) for node in order], dtype=np.intp)
    translation, rotation = _to_local(file.node_model[order], parents)
    names = _unique([file.nodes[node].name or f"node_{node}" for node in order])
    return GltfSkeleton(Skeleton(names, parents, translation, rotation), np.array(order, dtype=np.intp), joint)


def animation_clip(file: GltfFile, index: int = 0, fps: float = 30.0, skeleton: GltfSkeleton | None = None) -> Clip:
    """An animation sampled at a fixed rate from 0 to its last key, on skeleton_of(file) where none is given."""
    rig = skeleton_of(file) if skeleton is None else skeleton
    animation = file.animations[index]
    frames = int(np.floor(min(animation.length_s, 1e6) * fps + 1e-6)) + 1
    joints = len(rig.skeleton)
    if frames * joints > _MAX_JOINT_POSES:
        most = _MAX_JOINT_POSES // joints
        raise BadInput(
            where=Where(file.path, pointer=f"/animations/{index}"), expected=f"at most {most} frames", seen=frames
        )
    translation, rotation = np.empty((frames, joints, 3)), np.empty((frames, joints, 4))
    # In blocks: the matrices of all nodes are needed only on the way.
    block = max(1, _BLOCK_MATRICES // len(file.nodes))
    for start in range(0, frames, block):
        times_s = np.arange(start, min(start + block, frames)) / fps
        model = _node_matrices(file, animation, times_s)[:, rig.nodes]
        translation[start : start + block], rotation[start : start + block] = _to_local(model, rig.skeleton.parents)
    return Clip(rig.skeleton, 1.0 / fps, rotation, translation, name=animation.name or file.path.stem)


def _node_matrices(file: GltfFile, animation: GltfAnimation, times_s: Floats) -> Floats:
    """(T, N, 4, 4) model-space matrices of all nodes."""
    translation, rotation, scale = sample_local(file, animation, times_s)
    local = np.zeros((len(times_s), len(file.nodes), 4, 4))
    local[..., :3, :3] = quat.to_matrix(rotation) * scale[..., None, :]
    local[..., :3, 3] = translation
    local[..., 3, 3] = 1.0
    return file.to_model(local)


def _to_local(model: Floats, parents: NDArray[np.intp]) -> tuple[Floats, Floats]:
    """Model matrices (..., J, 4, 4), scales and all -> local translations (..., J, 3) and rotations (..., J, 4)."""
    linear = model[..., :3, :3]
    length = np.linalg.norm(linear, axis=-2, keepdims=True)
    mirrored = np.linalg.det(linear / np.maximum(length, 1e-12)) < 0
    unit = linear / np.maximum(length, 1e-12) * np.where(mirrored, -1.0, 1.0)[..., None, None]
    # A joint scaled to nothing keeps no rotation.
    unit = np.where((length > 1e-9).all(axis=-1, keepdims=True), unit, np.eye(3))
    rotation_model = np.asarray(quat.from_matrix(unit), dtype=np.float64)
    position = model[..., :3, 3]
    above = np.maximum(parents, 0)
    inverse = quat.conjugate(rotation_model[..., above, :])
    roots = (parents < 0)[:, None]
    translation = np.where(roots, position, quat.rotate(inverse, position - position[..., above, :]))
    rotation = np.where(roots, rotation_model, quat.multiply(inverse, rotation_model))
    return translation, rotation


def _default_nodes(file: GltfFile) -> set[int]:
    joints = {node for skin in file.skins for node in skin.joints}
    moved = {channel.node for animation in file.animations for channel in animation.channels}
    return joints or moved or set(range(len(file.nodes)))


def _unique(names: list[str]) -> tuple[str, ...]:
    taken = set(names)
    seen: set[str] = set()
    copies: dict[str, int] = {}
    result = []
    for name in names:
        candidate = name
        while candidate in seen or (candidate != name and candidate in taken):
            copies[name] = copies.get(name, 1) + 1
            candidate = f"{name}_{copies[name]}"
        seen.add(candidate)
        result.append(candidate)
    return tuple(result)
