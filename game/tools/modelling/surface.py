"""From a field to a mesh: sparse sampling, marching cubes, tangential relaxation, projection, simplification."""

from __future__ import annotations

from dataclasses import dataclass

import fast_simplification
import numpy as np
from numpy.typing import ArrayLike
from skimage.measure import marching_cubes

from game.tools.modelling.fields import Field, Floats, Ints, normals, project
from game.tools.modelling.mesh import Mesh, neighbour_mean

__all__ = ["Sculpt", "sculpted"]

_BLOCK = 8
"""Cells per block edge: the field is sampled once per block first, and finely only near the surface."""


@dataclass(frozen=True, eq=False)
class Sculpt:
    """A field with its fine triangulation, from which meshes of any triangle count are taken.

    normal_step_m: step of the normals' gradient; wide on cloth, so that folds shade softly.
    """

    field: Field
    position: Floats
    triangle: Ints
    normal_step_m: float

    def mesh(self, target: int) -> Mesh:
        """About ``target`` triangles (all, if the triangulation has fewer), every vertex on the field."""
        position, triangle = self.position, self.triangle
        if target < len(triangle):
            reduced, faces = fast_simplification.simplify(
                position.astype(np.float32), triangle.astype(np.int32), target_reduction=1.0 - target / len(triangle)
            )[:2]
            position, triangle = project(self.field, reduced.astype(np.float64)), faces.astype(np.int64)
        return Mesh(position, normals(self.field, position, self.normal_step_m), triangle)


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


def sculpted(
    field: Field,
    low: ArrayLike,
    high: ArrayLike,
    cell_m: float,
    normal_step_m: float = 6e-4,
    relax_rounds: int = 3,
) -> Sculpt:
    """March the field between two corners of a box (metres), then even the triangles out on the surface."""
    corner = np.asarray(low, dtype=np.float64)
    grid = _samples(field, corner, np.asarray(high, dtype=np.float64), cell_m)
    vertices, faces, _, _ = marching_cubes(grid, 0.0)  # type: ignore[no-untyped-call]  # scikit-image has no types
    position = corner + vertices.astype(np.float64) * cell_m
    triangle = faces.astype(np.int64)
    mean = neighbour_mean(len(position), triangle)
    for _ in range(relax_rounds):
        normal = normals(field, position)
        move = mean @ position - position
        position = position + 0.6 * (move - (move * normal).sum(1, keepdims=True) * normal)
        position = project(field, position)
    corner_of = position[triangle]
    facing = np.cross(corner_of[:, 1] - corner_of[:, 0], corner_of[:, 2] - corner_of[:, 0])
    if ((facing * normals(field, corner_of.mean(1))).sum(1) > 0).mean() < 0.5:
        triangle = np.ascontiguousarray(triangle[:, ::-1])
    return Sculpt(field, position, triangle, normal_step_m)
