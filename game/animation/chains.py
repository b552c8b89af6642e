"""Local joint matrices to model space.

For few characters by pointer doubling: every pass doubles the way behind a joint's matrix (parent, then grandparent,
...). Level by level multiplies fewer matrices, which is what counts for many; for one a call costs more than what it
multiplies, and a figure of seven levels needs three passes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["CROWD", "Chains", "chains_of", "to_model"]

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.intp]

CROWD = 16
"""From this many characters on the number of matrices counts more than the number of calls."""


@dataclass(frozen=True, eq=False)
class Chains:
    """Steps over joints sorted by depth: the joints a step moves on, and what each of them is relative to. passes: of
    pointer doubling; levels: by depth."""

    passes: tuple[tuple[slice, Ints], ...]
    levels: tuple[tuple[slice, Ints], ...]


def chains_of(parents: Ints) -> Chains:
    """parents: (J,) of joints sorted by depth, −1 for roots."""
    passes, relative = [], parents
    depth = np.zeros(len(parents), dtype=np.intp)
    while relative.max() >= 0:
        first = int(np.argmax(relative >= 0))
        passes.append((slice(first, len(parents)), _frozen(relative[first:])))
        relative = np.where(relative >= 0, relative[np.maximum(relative, 0)], -1)
    for joint, parent in enumerate(parents):
        depth[joint] = 0 if parent < 0 else depth[parent] + 1
    levels = []
    for level in range(1, int(depth.max()) + 1):
        start, stop = np.searchsorted(depth, (level, level + 1)).tolist()
        levels.append((slice(start, stop), _frozen(parents[start:stop])))
    return Chains(tuple(passes), tuple(levels))


def _frozen(array: Ints) -> Ints:
    array = array.copy()
    array.setflags(write=False)
    return array


def to_model(local: Floats, chains: Chains) -> None:
    """(n, J, 4, 4) local matrices -> in place to model space."""
    for joints, behind in chains.passes if len(local) < CROWD else chains.levels:
        moved = local[:, joints]
        moved[:] = local.take(behind, axis=1) @ moved
