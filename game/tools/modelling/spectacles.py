"""Round spectacles: two thin rims, a bridge and sides to the ears, rigid to the head."""

from __future__ import annotations

import numpy as np

from game.tools.modelling.fields import Floats, unit
from game.tools.modelling.lofts import bezier, loft
from game.tools.modelling.mesh import Mesh
from game.tools.modelling.parts import Detail, Part
from game.tools.modelling.spec_wear import SpectaclesSpec
from game.tools.modelling.weights import Binder

__all__ = ["Spectacles"]


class Spectacles:
    """Modelled on the left and mirrored. The lenses are air: the eyes are drawn on the face behind them."""

    def __init__(self, spec: SpectaclesSpec, head_centre: Floats) -> None:
        self.spec = spec
        self.head_centre = head_centre
        turn = np.radians(spec.turn_deg)
        self._out = unit((np.sin(turn), -0.05, np.cos(turn)))
        self._right = unit(np.cross((0.0, 1.0, 0.0), self._out))
        self._up = np.cross(self._out, self._right)
        self._lens = head_centre + spec.at

    def _on_rim(self, angle: Floats) -> Floats:
        r = self.spec.radius
        return self._lens + r * np.cos(angle)[:, None] * self._right + r * np.sin(angle)[:, None] * self._up

    def _rim(self, detail: Detail) -> Mesh:
        path = self._on_rim(np.linspace(0.0, 2 * np.pi, detail.rings(44, 16), endpoint=False))
        out = np.tile(self._out, (len(path), 1))
        return loft(path, out, self.spec.rim, self.spec.rim, detail.sides(8, 5), "round", closed=True)

    def _bridge(self, detail: Detail) -> Mesh:
        end = self._on_rim(np.radians([162.0]))[0]
        rise, ahead = np.array([0.0, 0.010, 0.0]), np.array([0.0, 0.0, 0.010])
        mirror = np.array([-1.0, 1.0, 1.0])
        mid = end * (0.45, 1.0, 1.0) + rise + ahead
        path = bezier([end, mid, mid * mirror, end * mirror], detail.rings(16, 6))
        out = np.tile([0.0, 0.0, 1.0], (len(path), 1))
        return loft(path, out, self.spec.rim * 1.15, self.spec.rim, detail.sides(8, 5), "round")

    def _side(self, detail: Detail) -> Mesh:
        start = self._on_rim(np.radians([14.0]))[0]
        ear = self.head_centre + self.spec.ear
        hinge = np.array([ear[0] + 0.002, start[1] + 0.004, start[2] - 0.030])
        path = np.vstack(
            [
                bezier([start, start + (0.012, 0.002, -0.002), hinge + (0, 0, 0.022), hinge], detail.rings(8, 4)),
                bezier(
                    [hinge, hinge * (1, 1, 0.6) + ear * (0, 0, 0.4), ear + (0.004, 0.012, 0.03), ear],
                    detail.rings(12, 5),
                )[1:],
            ]
        )
        out = np.tile([1.0, 0.0, 0.3], (len(path), 1))
        return loft(path, out, self.spec.rim * 1.1, self.spec.rim * 0.8, detail.sides(8, 4), "round")

    def parts(self, binder: Binder, detail: Detail) -> list[Part]:
        rim, side, bridge = self._rim(detail), self._side(detail), self._bridge(detail)
        meshes = {"rim_left": rim, "rim_right": rim.mirrored(), "bridge": bridge}
        meshes |= {"side_left": side, "side_right": side.mirrored()}
        return [
            Part(f"spectacles_{name}", "rims", mesh, binder.rigid(mesh.position, "head"), 0.5)
            for name, mesh in meshes.items()
        ]
