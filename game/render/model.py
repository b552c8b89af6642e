"""Meshes as the renderer wants them: immutable arrays, parts joined by material class, palettes as vertex colours."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput
from game.render.grading import palette_bytes
from game.render.mood import MARKET_MOOD, Mood
from game.render.silhouette import Edges, find_edges

if TYPE_CHECKING:
    from game.render.moving import MovingMesh

__all__ = [
    "KINDS",
    "MAX_JOINTS",
    "CharacterMesh",
    "CharacterModel",
    "Material",
    "Part",
    "Run",
    "ShadowMesh",
    "Share",
    "StaticMesh",
    "WhenAsked",
    "joint_boxes",
    "merge_character",
    "merge_static",
    "on_legs",
    "turned_outward",
]

Floats = NDArray[np.float32]
KINDS = (
    "hair",
    "face",
    "skin",
    "cloth",
    "woven",
    "gloss",
    "flat",
)  # also the order of drawing: what covers most comes first
MAX_JOINTS = 256  # three rows each of the Joints block in joints.glsl; 16 KB hold 341


@dataclass(frozen=True)
class Material:
    """A palette entry: display-referred sRGB colours in 0..1 and the class that decides the shader."""

    name: str
    kind: str
    lit: tuple[float, float, float]
    shade: tuple[float, float, float]
    deep: tuple[float, float, float]


@dataclass(frozen=True)
class Part:
    """One primitive as it comes from a file. Fields a kind of mesh does not have are None."""

    group: str
    material: Material
    position: Floats  # (v, 3) m
    normal: Floats  # (v, 3) unit
    outline: Floats  # (v,) 0 none, .4-1.1
    triangle: NDArray[np.uint32]  # (t, 3), counter-clockwise in front
    joint: NDArray[np.uint8] | None = None  # (v, 4)
    weight: NDArray[np.uint8] | None = None  # (v, 4), each row sums to 255
    # (v, 4): face: uv, texture share, shadow fade; hair: its strand's tone, height term, 0, 0;
    # woven: tiles along and across, motif, strength
    extra: Floats | None = None


@dataclass(frozen=True)
class Run:
    """Triangles of one group and one material class, side by side in the index buffer."""

    group: str
    kind: str
    first: int  # index of the first corner
    count: int  # number of corners


@dataclass(frozen=True)
class Share:
    """How many of a mesh's vertices, triangles and edges come before those of the legs."""

    vertices: int
    triangles: int
    edges: int


@dataclass(frozen=True)
class CharacterMesh:
    """A skinned mesh of one level of detail. What belongs to the legs alone lies at the end of every array, so that
    a person behind a table is drawn by the first ``above`` of each."""

    position: Floats
    normal: Floats
    outline: Floats
    joint: NDArray[np.uint8]
    weight: NDArray[np.uint8]
    palette: NDArray[np.uint8]  # (v, 12), graded
    extra: Floats  # (v, 4)
    triangle: NDArray[np.int32]  # (t, 3)
    runs: tuple[Run, ...]  # groups "above" and "legs"
    edges: Edges
    joint_box: Floats  # (j, 8, 3) corners of the rest-space box of each joint's vertices
    above: Share


@dataclass(frozen=True)
class ShadowMesh:
    """The coarse, closed mesh that casts the character's shadow."""

    position: Floats
    joint: NDArray[np.uint8]
    weight: NDArray[np.uint8]
    push: Floats  # (v,) 1 on the head
    triangle: NDArray[np.int32]  # (t, 3), those of the legs last
    above: int  # triangles before those of the legs


class WhenAsked(Mapping[int, CharacterMesh]):
    """Meshes by triangles, each put together the first time it is asked for."""

    def __init__(self, makers: Mapping[int, Callable[[], CharacterMesh]]) -> None:
        self._makers = dict(makers)
        self._made: dict[int, CharacterMesh] = {}

    def __getitem__(self, triangles: int) -> CharacterMesh:
        if triangles not in self._made:
            self._made[triangles] = self._makers[triangles]()
        return self._made[triangles]

    def __iter__(self) -> Iterator[int]:
        return iter(self._makers)

    def __len__(self) -> int:
        return len(self._makers)


@dataclass(frozen=True)
class CharacterModel:
    """All levels of detail of one person; triangles wanted -> mesh. head: the joint of the face; planes: where its
    light ends (face_planes), None for the standard face's."""

    name: str
    meshes: Mapping[int, CharacterMesh]
    shadow: ShadowMesh | None  # None casts no shadow
    joint_count: int
    head: int = 0
    planes: NDArray[np.uint8] | None = None

    def mesh(self, triangles: int) -> CharacterMesh:
        """The finest mesh of at most ``triangles``, else the coarsest there is."""
        fitting = [n for n in self.meshes if n <= triangles]
        return self.meshes[max(fitting) if fitting else min(self.meshes)]

    def make_all(self) -> None:
        """Put every level of detail together now."""
        for triangles in self.meshes:
            self.meshes[triangles]


@dataclass(frozen=True)
class StaticMesh:
    """Stall and goods: world coordinates, one buffer, runs by group and class."""

    position: Floats
    normal: Floats
    outline: Floats
    palette: NDArray[np.uint8]  # (v, 12), not graded: the baked picture is graded as a whole
    triangle: NDArray[np.int32]
    runs: tuple[Run, ...]
    anchors: Mapping[str, tuple[float, float, float]]  # group of an item -> centre of its foot on the table, m
    moving: tuple[MovingMesh, ...] = ()  # what sways and spins
    mood: Mood = MARKET_MOOD

    @property
    def groups(self) -> frozenset[str]:
        return frozenset(run.group for run in self.runs)


def _join(parts: Sequence[Part]) -> tuple[NDArray[np.int32], tuple[Run, ...]]:
    first_vertex, first_corner = 0, 0
    triangles: list[NDArray[np.int32]] = []
    runs: list[Run] = []
    for part in parts:
        triangles.append(part.triangle.astype(np.int32) + first_vertex)
        first_vertex += len(part.position)
        last = runs[-1] if runs else None
        if last and (last.group, last.kind) == (part.group, part.material.kind):
            runs[-1] = Run(last.group, last.kind, last.first, last.count + part.triangle.size)
        else:
            runs.append(Run(part.group, part.material.kind, first_corner, part.triangle.size))
        first_corner += part.triangle.size
    return np.concatenate(triangles), tuple(runs)


def _ordered(parts: Sequence[Part]) -> list[Part]:
    if not parts:
        raise BadInput("mesh without parts")
    for part in parts:
        if part.material.kind not in KINDS:
            raise BadInput(
                f"material {part.material.name}", expected="class " + ", ".join(KINDS), seen=part.material.kind
            )
    # Nearer parts first: what they cover is then rejected by depth before it is shaded.
    return sorted(parts, key=lambda p: (p.group, KINDS.index(p.material.kind), -float(p.position[:, 2].mean())))


def _palette(parts: Sequence[Part], graded: bool) -> NDArray[np.uint8]:
    rows = [palette_bytes(p.material.lit, p.material.shade, p.material.deep, graded=graded) for p in parts]
    return np.repeat(np.stack(rows), [len(p.position) for p in parts], axis=0)


def _toned(palette: NDArray[np.uint8], parts: Sequence[Part]) -> NDArray[np.uint8]:
    """The palette (v, 12) with every strand of hair in its own tone."""
    tones = [
        p.extra[:, 0] if p.material.kind == "hair" and p.extra is not None else np.zeros(len(p.position), np.float32)
        for p in parts
    ]
    share = 1.0 + np.concatenate(tones).astype(np.float32)
    return np.asarray(np.clip(np.rint(palette * share[:, None]), 0, 255), dtype=np.uint8)


def merge_character(parts: Sequence[Part], joint_count: int, leg_joints: Sequence[int] = ()) -> CharacterMesh:
    """Join skinned parts. Raises BadInput for unknown classes, missing skinning or too many joints."""
    if not 1 <= joint_count <= MAX_JOINTS:
        raise BadInput("character", expected=f"1 to {MAX_JOINTS} joints", seen=joint_count)
    parts = _ordered(parts)
    joints, weights = [], []
    for part in parts:
        if part.joint is None or part.weight is None:
            raise BadInput(f"character part {part.material.name}", expected="joints and weights", seen="none")
        if int(part.joint.max(initial=0)) >= joint_count:
            raise BadInput(f"part {part.material.name}", expected=f"joints below {joint_count}", seen=part.joint.max())
        joints.append(part.joint)
        weights.append(part.weight)
    joint, weight = np.concatenate(joints), np.concatenate(weights)
    position = np.concatenate([p.position for p in parts])
    triangle, runs = _join(parts)
    kind = np.repeat([KINDS.index(run.kind) for run in runs], [run.count // 3 for run in runs])
    leg = on_legs(triangle, joint, weight, leg_joints)
    # Frontmost triangles first: what they cover is rejected by depth before it is shaded.
    triangle = triangle[np.lexsort((-position[triangle, 2].sum(axis=1), kind, leg))]
    runs = _leg_runs(kind, leg)
    above = np.unique(triangle[: np.count_nonzero(~leg)])
    order = np.concatenate([above, np.setdiff1d(np.arange(len(position)), above)])
    place = np.empty(len(order), np.int32)
    place[order] = np.arange(len(order), dtype=np.int32)
    triangle = place[triangle]
    position, joint, weight = position[order], joint[order], weight[order]
    outline = np.concatenate([p.outline for p in parts])[order]
    extra = np.concatenate([np.zeros((len(p.position), 4), np.float32) if p.extra is None else p.extra for p in parts])
    edges = find_edges(position, triangle, outline)
    edge_above = (edges.face < np.count_nonzero(~leg)).all(axis=1)
    front = np.argsort(~edge_above, kind="stable")
    mesh = CharacterMesh(
        position,
        np.concatenate([p.normal for p in parts])[order],
        outline,
        joint,
        weight,
        _toned(_palette(parts, graded=True), parts)[order],
        extra[order],
        triangle,
        runs,
        Edges(edges.adjacency[front], edges.face[front]),
        joint_boxes(position, joint, weight, joint_count),
        Share(len(above), int(np.count_nonzero(~leg)), int(np.count_nonzero(edge_above))),
    )
    for array in (
        mesh.position,
        mesh.normal,
        outline,
        joint,
        weight,
        mesh.palette,
        mesh.extra,
        triangle,
        mesh.joint_box,
    ):
        array.setflags(write=False)
    return mesh


def _leg_runs(kind: NDArray[np.int_], leg: NDArray[np.bool_]) -> tuple[Run, ...]:
    """Runs of triangles sorted by leg, then kind; ``kind`` and ``leg`` (t,) in any order."""
    runs: list[Run] = []
    first = 0
    for group, mask in (("above", ~leg), ("legs", leg)):
        for index, name in enumerate(KINDS):
            count = 3 * int(np.count_nonzero(mask & (kind == index)))
            if count:
                runs.append(Run(group, name, first, count))
                first += count
    return tuple(runs)


def on_legs(
    triangle: NDArray[np.int32], joint: NDArray[np.uint8], weight: NDArray[np.uint8], leg_joints: Sequence[int]
) -> NDArray[np.bool_]:
    """(t,) bool: triangles that follow the leg joints alone."""
    on_leg = np.where(np.isin(joint, leg_joints), weight, 0).sum(axis=1) > 250
    result: NDArray[np.bool_] = on_leg[triangle].all(axis=1)
    return result


def merge_static(
    parts: Sequence[Part],
    anchors: Mapping[str, tuple[float, float, float]],
    moving: tuple[MovingMesh, ...] = (),
) -> StaticMesh:
    """Join parts that never move; ``moving`` is handed through."""
    parts = [replace(part, triangle=turned_outward(part)) for part in _ordered(parts)]
    triangle, runs = _join(parts)
    mesh = StaticMesh(
        np.concatenate([p.position for p in parts]),
        np.concatenate([p.normal for p in parts]),
        np.concatenate([p.outline for p in parts]),
        _palette(parts, graded=False),
        triangle,
        runs,
        MappingProxyType(dict(anchors)),
        moving,
    )
    for array in (mesh.position, mesh.normal, mesh.outline, mesh.palette, triangle):
        array.setflags(write=False)
    return mesh


def turned_outward(part: Part) -> NDArray[np.uint32]:
    """The part's triangles, those turned about that wind against their normals: back faces are not drawn."""
    a, b, c = (part.position[part.triangle[:, i]].astype(np.float64) for i in range(3))
    wrong = (np.cross(b - a, c - a) * part.normal[part.triangle].sum(axis=1)).sum(axis=1) < 0.0
    return np.where(wrong[:, None], part.triangle[:, ::-1], part.triangle)


def joint_boxes(
    position: Floats, joint: NDArray[np.uint8], weight: NDArray[np.uint8], joint_count: int
) -> NDArray[np.float32]:
    """Corners (j, 8, 3) of the box around the vertices each joint moves.

    A blended vertex lies in the hull of its joints' transforms of it, so the posed boxes together enclose the mesh.
    Joints without vertices get a point of the mesh.
    """
    low = np.broadcast_to(position[0], (joint_count, 3)).astype(np.float32)
    high = low.copy()
    fresh = np.ones(joint_count, bool)
    for column in range(4):
        used = weight[:, column] > 0
        for j in np.unique(joint[used, column]):
            own = position[used & (joint[:, column] == j)]
            a, b = own.min(axis=0), own.max(axis=0)
            low[j] = a if fresh[j] else np.minimum(low[j], a)
            high[j] = b if fresh[j] else np.maximum(high[j], b)
            fresh[j] = False
    pick = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], bool)
    return np.where(pick[None], high[:, None], low[:, None])
