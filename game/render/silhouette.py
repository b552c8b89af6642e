"""Edges of a mesh with the corners across them, and what of a mesh is seen in a picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from game.core.compiled import Block, Machine

__all__ = ["Edges", "Sight", "SightFinder", "find_edges", "scene_cells"]

_MODULE = Path(__file__).with_name("sight.wasm")
_CELL_PX = 2  # side of a cell of the grid in which hidden faces are found


@dataclass(frozen=True)
class Edges:
    """Every edge that may carry an outline.

    adjacency (e, 4) int32: opposite corner of face one, edge start, edge end, opposite corner of face two (the edge's
    start again where there is no second face); face (e, 2) int32: the two faces, the second -1 on a border.
    """

    adjacency: NDArray[np.int32]
    face: NDArray[np.int32]


def find_edges(
    position: NDArray[np.float32], triangle: NDArray[np.int32], outline: NDArray[np.float32], weld_m: float = 2e-6
) -> Edges:
    """Edges shared by place, not by number: vertices split for normals or texture still count as one."""
    grid = np.rint(position.astype(np.float64) / weld_m).astype(np.int64)
    grid -= grid.min(axis=0)
    span = grid.max(axis=0) + 1
    key = (grid[:, 0] * span[1] + grid[:, 1]) * span[2] + grid[:, 2]
    place = np.unique(key, return_inverse=True)[1].ravel()
    count = len(triangle)
    start = triangle[:, [0, 1, 2]].T.ravel()
    end = triangle[:, [1, 2, 0]].T.ravel()
    opposite = triangle[:, [2, 0, 1]].T.ravel()
    face = np.tile(np.arange(count, dtype=np.int32), 3)
    a, b = place[start], place[end]
    pair = np.minimum(a, b).astype(np.int64) * len(position) + np.maximum(a, b)
    order = np.argsort(pair, kind="stable")
    pair, start, end = pair[order], start[order], end[order]
    opposite, face = opposite[order], face[order]
    first = np.flatnonzero(np.r_[True, pair[1:] != pair[:-1]])
    size = np.diff(np.r_[first, len(pair)])
    second = np.minimum(first + 1, len(pair) - 1)
    shared = size > 1
    far_corner = np.where(shared, opposite[second], start[first])
    far_face = np.where(shared, face[second], -1)
    kept = (outline[start[first]] > 0) & (outline[end[first]] > 0)
    adjacency = np.stack([opposite[first], start[first], end[first], far_corner], axis=1)[kept].astype(np.int32)
    faces = np.stack([face[first], far_face], axis=1)[kept].astype(np.int32)
    adjacency.setflags(write=False)
    faces.setflags(write=False)
    return Edges(adjacency, faces)


@dataclass(frozen=True)
class Sight:
    """What is to be drawn of a pose: views that the next look overwrites.

    triangle (n, 3) int32, run by run; counts: triangles of each run; line (m, 4) int32: adjacency of outlines.
    """

    triangle: NDArray[np.int32]
    counts: tuple[int, ...]
    line: NDArray[np.int32]


def scene_cells(depth: NDArray[np.float32], projection: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
    """What a picture's depth (h, w) in 0..1, first row at the bottom, hides: 1 / w by cell of the grid.

    A cell hides what the farthest of its own and its neighbours' pixels hides: edges have samples, this depth has none.
    """
    height, width = depth.shape
    rows, columns = _grid_shape((width, height))
    near = (2.0 * depth + (projection[2, 2] - 1.0)) / projection[2, 3]
    near = np.pad(near, ((0, rows * _CELL_PX - height), (0, columns * _CELL_PX - width)))
    cells = near.reshape(rows, _CELL_PX, columns, _CELL_PX).min(axis=(1, 3))
    around = sliding_window_view(np.pad(cells, 1, mode="edge"), (3, 3))
    return np.ascontiguousarray(np.clip(around.min(axis=(2, 3)), 0.0, None), dtype=np.float32)


def _grid_shape(size: tuple[int, int]) -> tuple[int, int]:
    """Rows and columns of the grid of a picture (width, height); columns in fours."""
    return -(-size[1] // _CELL_PX), -(-size[0] // (4 * _CELL_PX)) * 4


class SightFinder:
    """Picks the faces and outlines that are seen, on the CPU (sight/sight.c): for a software rasteriser, which shades
    hidden faces like others, a third of the work of drawing them."""

    def __init__(self, vertices: int, triangle: NDArray[np.int32], first: Sequence[int], edges: Edges) -> None:
        """triangle (t, 3); first: the first triangle of each run."""
        machine = Machine(_MODULE)
        self._machine, self._find = machine, machine.function("find", "12I6If")
        kept = (triangle, edges.adjacency, edges.face, np.array(first, dtype=np.int32))
        self._given = [machine.kept(array, np.int32) for array in kept]
        self._clip = machine.block((vertices, 4), np.float32)
        self._places = [machine.block((vertices, 3), np.float32), machine.block(len(triangle), np.uint8)]
        self._grid = machine.block((0, 0), np.float32)
        self._scene: tuple[NDArray[np.float32], Block] | None = None
        self._triangle = machine.block(triangle.shape, np.int32)
        self._line = machine.block(edges.adjacency.shape, np.int32)
        self._count = machine.block(len(first) + 1, np.int32)

    @property
    def clip(self) -> NDArray[np.float32]:
        """(v, 4): where the vertices are, in clip coordinates; to be written before looking."""
        return self._clip.data

    def stand_behind(self, scene: NDArray[np.float32] | None) -> None:
        """What is before the mesh from now on, as ``scene_cells`` tells it; None: nothing."""
        if scene is None:
            self._scene = None
        elif self._scene is None or self._scene[0] is not scene:
            self._scene = (scene, self._machine.kept(scene, np.float32))

    def look(
        self, vertices: int, triangles: int, edges: int, runs: int, size: tuple[int, int] | None, line_px: float = 0.0
    ) -> Sight:
        """Look at the first so many of each. ``size``: of the picture, whose hidden faces are left out, or None:
        they stay. ``line_px``: how far an outline reaches from its edge."""
        rows, columns = (0, 0) if size is None else _grid_shape(size)
        if self._grid.data.shape != (rows, columns):
            self._grid = self._machine.block((rows, columns), np.float32)
        scene = self._scene[1].address if self._scene is not None and self._scene[0].shape == (rows, columns) else 0
        before = [block.address for block in (self._clip, *self._given, *self._places, self._grid)]
        after = [block.address for block in (self._triangle, self._line, self._count)]
        self._find(*before, scene, *after, vertices, triangles, edges, runs, columns, rows, line_px / _CELL_PX)
        *counts, lines = self._count.data[: runs + 1].tolist()
        return Sight(self._triangle.data[: sum(counts)], tuple(counts), self._line.data[:lines])
