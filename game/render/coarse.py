"""A coarser mesh by joining all vertices of a cell of space: for what is small on the screen or far away."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.render.model import Part

__all__ = ["coarser", "loose_pieces"]


def coarser(part: Part, cell_m: float) -> Part:
    """The part with the vertices of every cube of ``cell_m`` metres made one; triangles that collapse are dropped.

    Positions, normals and extras become the mean of the joined vertices; skinning is that of the first of them.
    """
    grid = np.floor(part.position.astype(np.float64) / cell_m).astype(np.int64)
    grid -= grid.min(axis=0)
    span = grid.max(axis=0) + 1
    key = (grid[:, 0] * span[1] + grid[:, 1]) * span[2] + grid[:, 2]
    # Front and back of thin cloth lie in one cell but must not become one.
    key = key * 2 + (part.normal[:, 2] < 0.0)
    _, first, cluster = np.unique(key, return_index=True, return_inverse=True)
    cluster = cluster.ravel()
    count = np.bincount(cluster)

    def mean(values: NDArray[np.float32]) -> NDArray[np.float64]:
        columns = [np.bincount(cluster, values[:, i]) for i in range(values.shape[1])]
        return np.asarray(np.stack(columns, axis=1) / count[:, None])

    position, normal = mean(part.position), mean(part.normal)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-9)
    triangle = cluster[part.triangle]
    a, b, c = triangle.T
    triangle = triangle[(a != b) & (b != c) & (c != a)]
    # The same three corners in the same turn, whichever comes first, are one triangle.
    start = triangle.argmin(axis=1)
    turned = np.take_along_axis(triangle, (start[:, None] + np.arange(3)) % 3, axis=1)
    return replace(
        part,
        position=position.astype(np.float32),
        normal=normal.astype(np.float32),
        outline=part.outline[first],
        triangle=np.unique(turned, axis=0).astype(np.uint32),
        joint=None if part.joint is None else part.joint[first],
        weight=None if part.weight is None else part.weight[first],
        extra=None if part.extra is None else mean(part.extra).astype(np.float32),
    )


def loose_pieces(triangle: NDArray[np.integer[Any]]) -> NDArray[np.intp]:
    """(v,) number of the piece each vertex belongs to, v the largest corner plus one; pieces share no triangle."""
    label = np.arange(int(triangle.max()) + 1)
    while True:
        lowest = label[triangle].min(axis=1)
        new = label.copy()
        np.minimum.at(new, triangle.ravel(), np.repeat(lowest, 3))
        new = new[new]
        if np.array_equal(new, label):
            return np.unique(label, return_inverse=True)[1].ravel()
        label = new
