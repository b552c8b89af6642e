"""Nodes, scenes and skins of a glTF document whose shape has been checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from game.core import quaternion as quat
from game.formats.gltf_buffers import Buffers
from game.formats.gltf_model import Floats, GltfMesh, GltfNode, GltfSkin, topological
from game.formats.json_shape import Report

__all__ = ["build_nodes", "build_skins", "check_scenes"]

_MAX_NODES = 20_000
_MAX_DEPTH = 512


def build_nodes(document: Mapping[str, Any], report: Report) -> tuple[GltfNode, ...]:
    """All nodes. Raises BadInput for two parents, cycles, a matrix beside TRS, rotations that are none."""
    sources = document.get("nodes", [])
    if len(sources) > _MAX_NODES:
        report.refuse(("nodes",), expected=f"at most {_MAX_NODES} nodes", seen=len(sources))
    parents = [-1] * len(sources)
    for index, node in enumerate(sources):
        for at, child in enumerate(node.get("children", [])):
            if parents[child] >= 0 or child == index:
                report.refuse(("nodes", index, "children", at), f"node {child} has another parent or is its own")
            parents[child] = index
    order = topological(parents)
    if len(order) < len(sources):
        inside = min(set(range(len(sources))) - set(order))
        report.refuse(("nodes", inside), "the node is its own ancestor")
    depth = [0] * len(sources)
    for index in order:
        depth[index] = depth[parents[index]] + 1 if parents[index] >= 0 else 1
        if depth[index] > _MAX_DEPTH:
            report.refuse(("nodes", index), f"more than {_MAX_DEPTH} levels of nodes")
    return tuple(_node(index, node, parents[index], report) for index, node in enumerate(sources))


def _node(index: int, source: Mapping[str, Any], parent: int, report: Report) -> GltfNode:
    pointer = ("nodes", index)
    translation = np.array(source.get("translation", (0, 0, 0)), dtype=np.float64)
    rotation = np.array(source.get("rotation", (0, 0, 0, 1)), dtype=np.float64)
    scale = np.array(source.get("scale", (1, 1, 1)), dtype=np.float64)
    if "matrix" in source:
        if any(key in source for key in ("translation", "rotation", "scale")):
            report.refuse((*pointer, "matrix"), "a matrix beside translation, rotation or scale")
        matrix = np.array(source["matrix"], dtype=np.float64).reshape(4, 4).T
        if not np.allclose(matrix[3], (0, 0, 0, 1), atol=1e-4):
            report.refuse((*pointer, "matrix"), "not an affine matrix")
        translation, rotation, scale = _decompose(matrix)
        if not np.allclose(_compose(translation, rotation, scale), matrix, atol=1e-3 * max(1.0, np.abs(matrix).max())):
            report.refuse((*pointer, "matrix"), "the matrix has shear and is not translation, rotation and scale")
    else:
        length = float(np.sqrt(rotation @ rotation))
        if abs(length - 1.0) > 0.01:
            report.refuse((*pointer, "rotation"), expected="a unit quaternion", seen=source["rotation"])
        if abs(length - 1.0) > 5e-4:
            report.note((*pointer, "rotation"), f"a quaternion of length {length:.4f}, normalised")
        rotation = rotation / length
        matrix = _compose(translation, rotation, scale)
    if "weights" in source and "mesh" not in source:
        report.note((*pointer, "weights"), "morph weights without a mesh")
    for array in (translation, rotation, scale, matrix):
        array.setflags(write=False)
    return GltfNode(
        index,
        source.get("name", ""),
        parent,
        tuple(source.get("children", ())),
        translation,
        rotation,
        scale,
        matrix,
        source.get("mesh"),
        source.get("skin"),
        source.get("extras"),
        source.get("extensions", {}),
    )


def _compose(translation: Floats, rotation: Floats, scale: Floats) -> Floats:
    matrix = np.eye(4)
    matrix[:3, :3] = quat.to_matrix(rotation) * scale
    matrix[:3, 3] = translation
    return matrix


def _decompose(matrix: Floats) -> tuple[Floats, Floats, Floats]:
    linear = matrix[:3, :3]
    scale = np.linalg.norm(linear, axis=0)
    if np.linalg.det(linear) < 0:
        scale[0] = -scale[0]
    if np.any(np.abs(scale) < 1e-12):
        return matrix[:3, 3].copy(), np.array(quat.IDENTITY, dtype=np.float64), scale
    return matrix[:3, 3].copy(), np.asarray(quat.from_matrix(linear / scale), dtype=np.float64), scale


def check_scenes(document: Mapping[str, Any], nodes: Sequence[GltfNode], report: Report) -> None:
    """Note scene entries that are not root nodes."""
    for index, scene in enumerate(document.get("scenes", [])):
        for at, node in enumerate(scene.get("nodes", [])):
            if nodes[node].parent >= 0:
                report.note(("scenes", index, "nodes", at), f"node {node} is not a root")


def build_skins(
    document: Mapping[str, Any],
    nodes: Sequence[GltfNode],
    meshes: Sequence[GltfMesh],
    buffers: Buffers,
    report: Report,
) -> tuple[GltfSkin, ...]:
    """All skins; also checks the joint indices of every mesh that is bound to one."""
    skins = tuple(_skin(index, skin, buffers, report) for index, skin in enumerate(document.get("skins", [])))
    for node in nodes:
        if node.skin is None:
            continue
        if node.mesh is None:
            report.note(("nodes", node.index, "skin"), "a skin without a mesh")
            continue
        _check_binding(node, meshes[node.mesh], skins[node.skin], report)
    return skins


def _skin(index: int, source: Mapping[str, Any], buffers: Buffers, report: Report) -> GltfSkin:
    joints = tuple(source["joints"])
    if not joints:
        report.refuse(("skins", index, "joints"), expected="at least one joint", seen=0)
    inverse_bind = np.broadcast_to(np.eye(4), (len(joints), 4, 4))
    if "inverseBindMatrices" in source:
        pointer = ("skins", index, "inverseBindMatrices")
        data = buffers.accessor(source["inverseBindMatrices"])
        if data.ndim != 3 or data.shape[1:] != (4, 4) or data.dtype.kind != "f":
            report.refuse(pointer, expected="MAT4 of floats", seen=f"{data.dtype} {data.shape[1:]}")
        if len(data) < len(joints):
            report.refuse(pointer, expected=f"{len(joints)} matrices", seen=len(data))
        inverse_bind = data[: len(joints)].astype(np.float64)
        if not np.allclose(inverse_bind[:, 3], (0, 0, 0, 1), atol=1e-3):
            report.refuse(pointer, "a matrix that is not affine")
        inverse_bind.setflags(write=False)
    return GltfSkin(source.get("name", ""), joints, inverse_bind, source.get("skeleton"))


def _check_binding(node: GltfNode, mesh: GltfMesh, skin: GltfSkin, report: Report) -> None:
    for at, primitive in enumerate(mesh.primitives):
        for name, joints in primitive.attributes.items():
            if not name.startswith("JOINTS_"):
                continue
            used = primitive.attributes[name.replace("JOINTS", "WEIGHTS")] > 0
            largest = int(joints[used].max()) if used.any() else 0
            if largest >= len(skin.joints):
                report.refuse(
                    ("meshes", node.mesh or 0, "primitives", at, "attributes", name),
                    expected=f"joints below {len(skin.joints)}",
                    seen=largest,
                )
