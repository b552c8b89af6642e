"""What the modellers hand to the exporter: meshes with material, weights and outline width; and the detail dial."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from game.tools.modelling.fields import Floats
from game.tools.modelling.mesh import Mesh

__all__ = ["Detail", "Part"]


@dataclass(frozen=True, eq=False)
class Part:
    """weights: (n, J) rows that sum to 1, or None for static scenery. outline: 0 (none) to 1.1.

    trim: a thin decoration close above another surface; far levels of detail leave it out.
    """

    name: str
    material: str
    mesh: Mesh
    weights: Floats | None
    outline: float = 1.0
    trim: bool = False

    def mirrored(self, columns: Floats) -> Part:
        """The same part on the other side; ``columns`` swaps left and right joints (Rig.mirrored_columns)."""
        assert self.weights is not None
        name = self.name.replace("left", "right")
        return replace(self, name=name, mesh=self.mesh.mirrored(), weights=self.weights[:, columns])


@dataclass(frozen=True)
class Detail:
    """Scale of the triangle budget; 1 is the sculptor's own (about 70,000 for a person)."""

    scale: float

    @property
    def trims(self) -> bool:
        """Whether stitches and other tiny trims are worth their triangles."""
        return self.scale > 0.10

    def triangles(self, full: int) -> int:
        return max(24, int(full * self.scale))

    def rings(self, full: int, least: int = 5) -> int:
        return max(least, int(np.ceil(full * self.scale**0.5)))

    def sides(self, full: int, least: int = 4) -> int:
        return max(least, int(np.ceil(full * self.scale**0.4)))
