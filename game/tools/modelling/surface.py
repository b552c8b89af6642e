"""From a field to a mesh: sparse sampling, marching cubes, tangential relaxation, projection, simplification."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import fast_simplification
import numpy as np
from numpy.typing import ArrayLike
from skimage.measure import marching_cubes

from game.tools.modelling.fields import Field, Floats, Ints, normals, project
from game.tools.modelling.mesh import Mesh, neighbour_mean

__all__ = ["Sculpt"]

_BLOCK = 8
"""Cells per block edge: the field is sampled once per block first, and finely only near the surface."""
_RELAX_ROUNDS = 3
_UNFOLD_ROUNDS = 4


@dataclass(frozen=True, eq=False)
class Sculpt:
    """A field within a box, from which meshes of any triangle count are taken; triangulated at first use.

    low, high: corners of the box, metres. cell_m: edge of the sampling grid's cells.
    normal_step_m: step of the normals' gradient; wide on cloth, so that folds shade softly.
    """

    field: Field
    low: ArrayLike
    high: ArrayLike
    cell_m: float
    normal_step_m: float = 6e-4
    hidden: Field | None = None
    """Triangles within this field are left out; and thin parts keep their shape in coarse meshes."""
    stepwise: bool = False
    """Simplify by halves: at one go, wide and thin shapes collapse before they are simple enough."""

    @cached_property
    def fine(self) -> tuple[Floats, Ints]:
        """Positions (n, 3) and triangles (m, 3): marched, then evened out on the surface in three rounds."""
        corner = np.asarray(self.low, dtype=np.float64)
        grid = _samples(self.field, corner, np.asarray(self.high, dtype=np.float64), self.cell_m)
        vertices, faces, _, _ = marching_cubes(grid, 0.0)  # type: ignore[no-untyped-call]  # scikit-image has no types
        position = corner + vertices.astype(np.float64) * self.cell_m
        triangle: Ints = faces.astype(np.int64)
        mean = neighbour_mean(len(position), triangle)
        for _ in range(_RELAX_ROUNDS):
            normal = normals(self.field, position)
            move = mean @ position - position
            position = position + 0.6 * (move - (move * normal).sum(1, keepdims=True) * normal)
            position = project(self.field, position)
        corners = position[triangle]
        facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        if ((facing * normals(self.field, corners.mean(1))).sum(1) > 0).mean() < 0.5:
            triangle = np.ascontiguousarray(triangle[:, ::-1])
        if self.hidden is not None:
            seen = (self.hidden(position) >= 0)[triangle].any(axis=1)
            used, renumbered = np.unique(triangle[seen], return_inverse=True)
            position, triangle = position[used], renumbered.reshape(-1, 3).astype(np.int64)
        return position, triangle

    def mesh(self, target: int) -> Mesh:
        """About ``target`` triangles (all, if the fine triangulation has fewer), every vertex on the field."""
        position, triangle = self.fine
        if target < len(triangle):
            position, triangle = _simplified(position, triangle, target, 0.5 if self.stepwise else 0.0)
            projected = project(self.field, position)
            position = projected if self.hidden is None else _unfolded(position, projected, triangle)
        return Mesh(position, normals(self.field, position, self.normal_step_m), triangle)


def _simplified(position: Floats, triangle: Ints, target: int, least_share: float) -> tuple[Floats, Ints]:
    """About ``target`` triangles, in steps that leave at least so many of those before."""
    vertices, faces = position.astype(np.float32), triangle.astype(np.int32)
    before = len(faces) + 1
    while target < len(faces) < before:
        before = len(faces)
        share = max(target / before, least_share)
        vertices, faces = fast_simplification.simplify(vertices, faces, target_reduction=1.0 - share)[:2]
        if least_share == 0.0:
            break
    return vertices.astype(np.float64), faces.astype(np.int64)


def _unfolded(before: Floats, after: Floats, triangle: Ints) -> Floats:
    """``after`` (n, 3), but for vertices whose triangles it turns over or stretches thin: those stay as ``before``."""

    def facing(position: Floats) -> Floats:
        a, b, c = (position[triangle[:, i]] for i in range(3))
        return np.cross(b - a, c - a)

    stays = np.zeros(len(before), bool)
    old = facing(before)
    for _ in range(_UNFOLD_ROUNDS):
        new = facing(np.where(stays[:, None], before, after))
        turned = (old * new).sum(1) < 0.5 * np.linalg.norm(old, axis=1) * np.linalg.norm(new, axis=1)
        if not turned.any():
            break
        stays[triangle[turned]] = True
    return np.where(stays[:, None], before, after)


def _samples(field: Field, low: Floats, high: Floats, cell_m: float) -> Floats:
    """Field values on the grid of ``cell_m`` between the corners; far from the surface only their sign is right."""
    count = np.ceil((high - low) / cell_m / _BLOCK).astype(int)
    axes = [low[i] + (np.arange(count[i]) * _BLOCK + (_BLOCK - 1) / 2) * cell_m for i in range(3)]
    centres = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    coarse = field(centres)
    # Half a block's diagonal, widened by 1.6 for fields that overstate the distance.
    near = np.abs(coarse) < _BLOCK * cell_m * 0.87 * 1.6 + cell_m
    grid = coarse.reshape(count)
    for axis in range(3):
        grid = np.repeat(grid, _BLOCK, axis)
    grid = grid.astype(np.float32)
    inside = np.stack(np.meshgrid(*[np.arange(_BLOCK)] * 3, indexing="ij"), -1).reshape(-1, 3)
    blocks = np.stack(np.unravel_index(np.flatnonzero(near), tuple(count)), 1) * _BLOCK
    for start in range(0, len(blocks), 400):
        index = (blocks[start : start + 400, None, :] + inside[None]).reshape(-1, 3)
        grid[index[:, 0], index[:, 1], index[:, 2]] = field(low + index * cell_m)
    return np.asarray(grid)
