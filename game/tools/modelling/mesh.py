"""Triangle meshes: the value the modelling steps pass on, and the operations that need nothing but the mesh."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from game.tools.modelling.fields import Floats, Ints, unit

__all__ = ["Mesh", "joined", "neighbour_mean", "split_at_level", "vertex_normals"]


@dataclass(frozen=True, eq=False)
class Mesh:
    """position: (n, 3) metres. normal: (n, 3) unit, outward. triangle: (m, 3) counter-clockwise from outside."""

    position: Floats
    normal: Floats
    triangle: Ints

    def mirrored(self) -> Mesh:
        """Reflected in x = 0."""
        flip = np.array([-1.0, 1.0, 1.0])
        return Mesh(self.position * flip, self.normal * flip, np.ascontiguousarray(self.triangle[:, ::-1]))

    def placed(self, at: Floats | Sequence[float], turn_y_rad: float = 0.0, scale: float = 1.0) -> Mesh:
        """Scaled, turned about +Y, then moved to ``at``."""
        c, s = np.cos(turn_y_rad), np.sin(turn_y_rad)
        rotation = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
        return Mesh(self.position * scale @ rotation.T + np.asarray(at), self.normal @ rotation.T, self.triangle)

    def compacted(self, triangle: Ints) -> tuple[Mesh, Ints]:
        """The part of the mesh that ``triangle`` uses, and the old index of each of its vertices."""
        used, renumbered = np.unique(triangle, return_inverse=True)
        return Mesh(self.position[used], self.normal[used], renumbered.reshape(-1, 3)), used


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """All meshes in one, vertices in order."""
    starts = np.cumsum([0] + [len(m.position) for m in meshes[:-1]])
    return Mesh(
        np.vstack([m.position for m in meshes]),
        np.vstack([m.normal for m in meshes]),
        np.vstack([m.triangle + s for m, s in zip(meshes, starts, strict=True)]),
    )


def vertex_normals(position: Floats, triangle: Ints) -> Floats:
    """Area-weighted vertex normals, (n, 3)."""
    corner = position[triangle]
    face = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    total = np.zeros_like(position)
    for k in range(3):
        np.add.at(total, triangle[:, k], face)
    return unit(total)


def neighbour_mean(count: int, triangle: Ints) -> sparse.csr_matrix:
    """(count, count) matrix that replaces every vertex by the mean of its neighbours (umbrella operator)."""
    start = np.concatenate([triangle[:, 0], triangle[:, 1], triangle[:, 2]])
    end = np.concatenate([triangle[:, 1], triangle[:, 2], triangle[:, 0]])
    ones = np.ones(2 * len(start))
    links = sparse.coo_matrix((ones, (np.r_[start, end], np.r_[end, start])), shape=(count, count)).tocsr()
    links.data[:] = 1.0
    degree = np.maximum(np.asarray(links.sum(1)).ravel(), 1.0)
    return sparse.csr_matrix(sparse.diags(1.0 / degree) @ links)


def split_at_level(mesh: Mesh, level: Floats) -> tuple[Mesh, Mesh]:
    """Cut the triangles along ``level`` == 0: -> (the part above, the part below).

    level: (n,) one value per vertex, interpolated linearly along edges. Gives crisp colour borders without textures.
    """
    level = np.where(np.abs(level) < 1e-9, 1e-9, level)
    above = level > 0.0
    count_above = above[mesh.triangle].sum(1)
    whole_above = mesh.triangle[count_above == 3]
    whole_below = mesh.triangle[count_above == 0]
    crossed = mesh.triangle[(count_above == 1) | (count_above == 2)]
    if len(crossed) == 0:
        return mesh.compacted(whole_above)[0], mesh.compacted(whole_below)[0]

    # Turn every crossed triangle so that its lone corner stands first.
    corner_above = above[crossed]
    lone_is_above = corner_above.sum(1) == 1
    lone = np.argmax(corner_above == lone_is_above[:, None], axis=1)
    rows = np.arange(len(crossed))[:, None]
    turned = crossed[rows, (lone[:, None] + np.arange(3)) % 3]
    a, b, c = turned.T

    edges = np.sort(np.vstack([np.stack([a, b], 1), np.stack([a, c], 1)]), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    first, second = unique.T
    t = (level[first] / (level[first] - level[second]))[:, None]
    position = mesh.position[first] * (1 - t) + mesh.position[second] * t
    normal = unit(mesh.normal[first] * (1 - t) + mesh.normal[second] * t)
    inverse = inverse.ravel() + len(mesh.position)
    ab, ac = inverse[: len(a)], inverse[len(a) :]

    tip = np.stack([a, ab, ac], 1)
    rest = np.vstack([np.stack([ab, b, c], 1), np.stack([ab, c, ac], 1)])
    twice = np.r_[lone_is_above, lone_is_above]
    whole = Mesh(np.vstack([mesh.position, position]), np.vstack([mesh.normal, normal]), mesh.triangle)
    upper = np.vstack([whole_above, tip[lone_is_above], rest[~twice]])
    lower = np.vstack([whole_below, tip[~lone_is_above], rest[twice]])
    return whole.compacted(upper)[0], whole.compacted(lower)[0]
