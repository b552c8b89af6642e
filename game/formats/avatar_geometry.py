"""All meshes of a foreign avatar joined into one: skinned, or hung rigidly on a node, with their morph targets.

Every vertex refers to *columns*: pairs of a node and the matrix that takes the mesh to that node's frame. A mesh
without a skin has one column, its own node.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput, Where
from game.formats.gltf_model import GltfFile, GltfNode, GltfPrimitive
from game.formats.toon_material import ToonMaterial

__all__ = ["MAX_COLUMNS", "AvatarGeometry", "Morph", "join_meshes"]

Array = NDArray[Any]
Floats = NDArray[np.float32]

MAX_COLUMNS = 256
MAX_VERTICES = 600_000
_MAX_MORPH_ROWS = 6_000_000
_STILL_M = 1e-7


@dataclass(frozen=True, eq=False)
class Morph:
    """One morph target of one mesh: vertices it moves (m,), and how: (m, 3) of place and normal, mesh space."""

    vertex: NDArray[np.int32]
    position: Floats
    normal: Floats


@dataclass(frozen=True, eq=False)
class AvatarGeometry:
    """V vertices, T triangles, K columns.

    column_node: (K,) node index; inverse_bind: (K, 4, 4) mesh space -> that node's. position, normal: (V, 3) mesh
    space; uv: (V, 2) of the material's own set; colour: (V, 4) bytes; joint: (V, 4) columns, weight: (V, 4) bytes
    whose rows sum to 255. runs: (material or -1, first corner, corners), triangle (T, 3). morphs: (mesh, target) ->
    Morph. notes: what was left out.
    """

    column_node: tuple[int, ...]
    inverse_bind: NDArray[np.float64]
    position: Floats
    normal: Floats
    uv: Floats
    colour: NDArray[np.uint8]
    joint: NDArray[np.uint8]
    weight: NDArray[np.uint8]
    triangle: NDArray[np.int32]
    runs: tuple[tuple[int, int, int], ...]
    morphs: Mapping[tuple[int, int], tuple[Morph, ...]]
    notes: tuple[str, ...]

    def rest_places(self, node_model: NDArray[np.float64]) -> NDArray[np.float64]:
        """(V, 3) where the vertices are in the file's rest pose; node_model: (N, 4, 4)."""
        matrix = node_model[list(self.column_node)] @ self.inverse_bind
        place = np.zeros((len(self.position), 3))
        for corner in range(4):
            rows = matrix[self.joint[:, corner]]
            moved = np.einsum("vij,vj->vi", rows[:, :3, :3], self.position.astype(np.float64)) + rows[:, :3, 3]
            place += (self.weight[:, corner, None] / 255.0) * moved
        return place

    def owners(self) -> NDArray[np.intp]:
        """(V,) node index with the largest weight."""
        strongest = self.joint[np.arange(len(self.joint)), self.weight.argmax(axis=1)]
        return np.asarray(np.array(self.column_node, dtype=np.intp)[strongest])


@dataclass
class _Gather:
    """What is joined so far."""

    columns: dict[tuple[int, bytes], int]
    parts: list[dict[str, Array]]
    triangles: list[Array]
    materials: list[int]
    morphs: dict[tuple[int, int], list[Morph]]
    notes: list[str]
    vertices: int = 0
    morph_rows: int = 0


def join_meshes(file: GltfFile, materials: tuple[ToonMaterial, ...]) -> AvatarGeometry:
    """Raises BadInput where there is nothing to draw, or too much of it."""
    gather = _Gather({}, [], [], [], {}, [])
    for node in file.nodes:
        if node.mesh is not None:
            for primitive in file.meshes[node.mesh].primitives:
                _add(gather, file, node, primitive, materials)
    where = Where(file.path, pointer="/meshes")
    if not gather.parts:
        raise BadInput("nothing to draw", where=where, expected="a mesh of triangles on some node", seen="none")
    order = np.argsort(np.array(gather.materials), kind="stable")
    runs: list[tuple[int, int, int]] = []
    first = 0
    for at in order.tolist():
        count = gather.triangles[at].size
        if runs and runs[-1][0] == gather.materials[at]:
            runs[-1] = (runs[-1][0], runs[-1][1], runs[-1][2] + count)
        else:
            runs.append((gather.materials[at], first, count))
        first += count
    joined = {name: np.concatenate([part[name] for part in gather.parts]) for name in gather.parts[0]}
    used, joint = np.unique(joined["joint"], return_inverse=True)
    joint = joint.reshape(joined["joint"].shape)
    if len(used) > MAX_COLUMNS:
        raise BadInput(
            "avatar", where=where, expected=f"at most {MAX_COLUMNS} joints that move vertices", seen=len(used)
        )
    keys = list(gather.columns)
    return AvatarGeometry(
        column_node=tuple(keys[c][0] for c in used.tolist()),
        inverse_bind=np.array([np.frombuffer(keys[c][1]).reshape(4, 4) for c in used.tolist()]),
        position=joined["position"],
        normal=joined["normal"],
        uv=joined["uv"],
        colour=joined["colour"],
        joint=joint.astype(np.uint8),
        weight=joined["weight"],
        triangle=np.concatenate([gather.triangles[at] for at in order.tolist()]).astype(np.int32),
        runs=tuple(runs),
        morphs={key: tuple(value) for key, value in gather.morphs.items()},
        notes=tuple(dict.fromkeys(gather.notes)),
    )


def _add(
    gather: _Gather, file: GltfFile, node: GltfNode, primitive: GltfPrimitive, materials: tuple[ToonMaterial, ...]
) -> None:
    attributes = primitive.attributes
    if primitive.mode < 4 or "POSITION" not in attributes:
        gather.notes.append("points and lines left out")
        return
    position = np.ascontiguousarray(attributes["POSITION"], dtype=np.float32)
    count = len(position)
    gather.vertices += count
    if gather.vertices > MAX_VERTICES:
        where = Where(file.path, pointer="/meshes")
        raise BadInput("avatar", where=where, expected=f"at most {MAX_VERTICES} vertices", seen=gather.vertices)
    triangle = _triangles(primitive, count)
    if not len(triangle):
        return
    normal = attributes.get("NORMAL")
    material = -1 if primitive.material is None else primitive.material
    texture = materials[material].lit_texture if material >= 0 else None
    uv = attributes.get(f"TEXCOORD_{texture.texcoord if texture else 0}")
    colour = attributes.get("COLOR_0")
    joint, weight = _bones(gather, file, node, attributes, count)
    first = gather.vertices - count
    gather.parts.append(
        {
            "position": position,
            "normal": _smooth_normals(position, triangle) if normal is None else _unit(normal),
            "uv": np.zeros((count, 2), np.float32) if uv is None else np.asarray(uv, dtype=np.float32),
            "colour": _bytes(colour, count),
            "joint": joint,
            "weight": weight,
        }
    )
    gather.triangles.append(triangle + first)
    gather.materials.append(material)
    assert node.mesh is not None
    for target, deltas in enumerate(primitive.targets):
        _add_morph(gather, file, (node.mesh, target), deltas, first, count)


def _add_morph(
    gather: _Gather, file: GltfFile, key: tuple[int, int], deltas: Mapping[str, Array], first: int, count: int
) -> None:
    zero = np.zeros((count, 3), dtype=np.float32)
    place = np.asarray(deltas.get("POSITION", zero), dtype=np.float32)
    turn = np.asarray(deltas.get("NORMAL", zero), dtype=np.float32)
    moved = np.flatnonzero(np.abs(place).max(axis=1) > _STILL_M)
    if not len(moved):
        return
    gather.morph_rows += len(moved)
    if gather.morph_rows > _MAX_MORPH_ROWS:
        where = Where(file.path, pointer="/meshes")
        raise BadInput("avatar", where=where, expected=f"at most {_MAX_MORPH_ROWS} moved vertices in morph targets")
    morph = Morph((moved + first).astype(np.int32), place[moved], turn[moved])
    gather.morphs.setdefault(key, []).append(morph)


def _bones(
    gather: _Gather, file: GltfFile, node: GltfNode, attributes: Mapping[str, Array], count: int
) -> tuple[NDArray[np.int32], NDArray[np.uint8]]:
    if node.skin is None or "JOINTS_0" not in attributes:
        column = _column(gather, node.index, np.eye(4))
        weight = np.zeros((count, 4), dtype=np.uint8)
        weight[:, 0] = 255
        return np.full((count, 4), column, dtype=np.int32), weight
    skin = file.skins[node.skin]
    columns = np.array([_column(gather, n, m) for n, m in zip(skin.joints, skin.inverse_bind, strict=True)])
    sets = sorted(int(name[7:]) for name in attributes if name.startswith("JOINTS_"))
    joint = np.concatenate([attributes[f"JOINTS_{i}"] for i in sets], axis=1).astype(np.intp)
    weight = np.concatenate([attributes[f"WEIGHTS_{i}"] for i in sets], axis=1).astype(np.float64)
    if joint.shape[1] > 4:
        gather.notes.append("only the four strongest joints of a vertex are used")
        strongest = np.argsort(-weight, axis=1, kind="stable")[:, :4]
        joint, weight = np.take_along_axis(joint, strongest, 1), np.take_along_axis(weight, strongest, 1)
    weight = np.maximum(weight, 0.0)
    total = weight.sum(axis=1, keepdims=True)
    weight = np.where(total > 1e-6, weight / np.maximum(total, 1e-6), [1.0, 0.0, 0.0, 0.0])
    whole = np.rint(weight * 255.0).astype(np.int32)
    rows = np.arange(count)
    whole[rows, whole.argmax(axis=1)] += 255 - whole.sum(axis=1)
    # A joint without a say must not keep a column alive.
    joint = np.where(whole > 0, joint, joint[rows, whole.argmax(axis=1)][:, None])
    return columns[joint].astype(np.int32), whole.astype(np.uint8)


def _column(gather: _Gather, node: int, matrix: Array) -> int:
    key = (node, np.ascontiguousarray(matrix, dtype=np.float64).tobytes())
    return gather.columns.setdefault(key, len(gather.columns))


def _triangles(primitive: GltfPrimitive, count: int) -> NDArray[np.int64]:
    """(t, 3) of a triangle list, strip or fan; degenerate ones dropped."""
    index = np.arange(count) if primitive.indices is None else primitive.indices.astype(np.int64)
    if primitive.mode == 4:
        corners = index[: len(index) // 3 * 3].reshape(-1, 3)
    elif len(index) < 3:
        corners = np.zeros((0, 3), dtype=np.int64)
    elif primitive.mode == 5:
        corners = np.stack([index[:-2], index[1:-1], index[2:]], axis=1)
        corners[1::2] = corners[1::2, [1, 0, 2]]
    else:
        corners = np.stack([np.full(len(index) - 2, index[0]), index[1:-1], index[2:]], axis=1)
    a, b, c = corners.T if len(corners) else np.zeros((3, 0), dtype=np.int64)
    return np.asarray(corners[(a != b) & (b != c) & (a != c)])


def _smooth_normals(position: Floats, triangle: NDArray[np.int64]) -> Floats:
    """Area-weighted, shared by vertices at one place: a faceted figure would be nothing but outlines."""
    _, place = np.unique(np.round(position, 5), axis=0, return_inverse=True)
    place = place.ravel()
    a, b, c = (position[triangle[:, i]].astype(np.float64) for i in range(3))
    face = np.cross(b - a, c - a)
    total = np.zeros((int(place.max()) + 1, 3))
    for corner in range(3):
        np.add.at(total, place[triangle[:, corner]], face)
    return _unit(total[place])


def _unit(vectors: Array) -> Floats:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    up = np.array([0.0, 1.0, 0.0])
    return np.where(length > 1e-12, vectors / np.maximum(length, 1e-12), up).astype(np.float32)


def _bytes(colour: Array | None, count: int) -> NDArray[np.uint8]:
    """Vertex colours (linear, v, 3 or 4) as display-referred bytes; white where there are none."""
    result = np.full((count, 4), 255, dtype=np.uint8)
    if colour is not None:
        values = np.clip(np.asarray(colour, dtype=np.float64), 0.0, 1.0)
        result[:, :3] = np.rint(255.0 * values[:, :3] ** (1.0 / 2.2))
        if values.shape[1] == 4:
            result[:, 3] = np.rint(255.0 * values[:, 3])
    return result
