"""The headband, laid on the real hair, with a knot and a bow whose leaves swing."""

from __future__ import annotations

import numpy as np

from game.tools.modelling.fields import Floats, ellipsoid, unit
from game.tools.modelling.hair import Hair
from game.tools.modelling.lofts import loft
from game.tools.modelling.mesh import Mesh
from game.tools.modelling.parts import Detail, Part
from game.tools.modelling.rig import Chain
from game.tools.modelling.spec import SpringSpec
from game.tools.modelling.spec_wear import BandSpec
from game.tools.modelling.surface import Sculpt
from game.tools.modelling.weights import Binder

__all__ = ["Headband"]

# direction, length, half width, droop, bend of each leaf; the two large ones are the bow, the small ones its ends
_LEAVES = {
    "bow_right": ((-0.78, 0.85, 0.10), 0.150, 0.040, 0.034, 0.030),
    "bow_left": ((0.30, 1.00, 0.05), 0.140, 0.038, 0.022, 0.020),
    "bow_end_a": ((-1.00, -0.25, 0.35), 0.085, 0.020, 0.030, 0.030),
    "bow_end_b": ((-0.75, -0.75, 0.45), 0.075, 0.018, 0.020, 0.030),
}


class Headband:
    """Its radius is that of the hair's own vertices, smoothed along the band."""

    def __init__(self, spec: BandSpec, spring: SpringSpec, hair: Hair) -> None:
        self.spec = spec
        self._centre = hair.centre
        offsets = np.vstack([m.position for _, m in hair.all_clumps(Detail(1.0))]) - hair.centre
        self._distance = np.linalg.norm(offsets, axis=1)
        self._direction = offsets / self._distance[:, None]
        azimuth, polar = np.radians(spec.knot_deg)
        self._outward = np.array([np.sin(azimuth) * np.sin(polar), np.cos(polar), np.cos(azimuth) * np.sin(polar)])
        self.knot = hair.centre + self._outward * (self._reach(self._outward[None], 0.10)[0] + 0.012)
        knot_field = ellipsoid(self.knot + self._outward * 0.004, np.array([0.024, 0.021, 0.021]) * spec.bow_scale)
        self._knot_sculpt = Sculpt(knot_field, self.knot - 0.05, self.knot + 0.05, 0.0032)
        self.chains = {name: self._chain(name, spring) for name in _LEAVES}

    def _reach(self, directions: Floats, cone_rad: float) -> Floats:
        """Largest distance of the hair from its centre within a cone about each direction."""
        near = directions @ self._direction.T > np.cos(cone_rad)
        return np.asarray(np.where(near, self._distance[None], 0.0).max(1))

    def _band(self, detail: Detail) -> Mesh:
        count = detail.rings(110, 36)
        angle = np.linspace(0.0, 2 * np.pi, count, endpoint=False)
        polar = np.radians(self.spec.polar_deg[0] - self.spec.polar_deg[1] * np.cos(angle))
        out = np.stack([np.sin(angle) * np.sin(polar), np.cos(polar), np.cos(angle) * np.sin(polar)], 1)
        fine = np.linspace(0.0, 2 * np.pi, 120, endpoint=False)
        fine_polar = np.radians(self.spec.polar_deg[0] - self.spec.polar_deg[1] * np.cos(fine))
        fine_out = np.stack(
            [np.sin(fine) * np.sin(fine_polar), np.cos(fine_polar), np.cos(fine) * np.sin(fine_polar)], 1
        )
        radius = self._reach(fine_out, 0.09)
        for _ in range(14):  # round off, but never cut into the hair by more than 1.5 %
            radius = np.maximum((np.roll(radius, 1) + radius + np.roll(radius, -1)) / 3, radius * 0.985)
        radius = np.interp(angle, np.r_[fine, 2 * np.pi], np.r_[radius, radius[0]])
        width = self.spec.width * (1 + 0.10 * np.sin(angle * 6))
        path = out * (radius + 0.001)[:, None] + self._centre
        return loft(path, out, width, self.spec.thickness, detail.sides(10, 6), "band", closed=True)

    def _leaf_path(self, name: str, count: int) -> tuple[Floats, Floats, Floats]:
        direction_, length, _, droop, bend = _LEAVES[name]
        direction = unit(direction_)
        face = unit(np.cross(np.cross(direction, self._outward), direction))
        across = np.cross(direction, face)
        t = np.linspace(0.0, 1.0, count)
        scale = self.spec.bow_scale
        path = self.knot + direction * (t * length * scale)[:, None]
        path = path + face * (bend * scale * np.sin(t * 2.4))[:, None] - np.array([0, 1, 0]) * (droop * t * t)[:, None]
        return path, face, across

    def _leaf(self, name: str, detail: Detail) -> Mesh:
        count = detail.rings(20, 8)
        path, face, across = self._leaf_path(name, count)
        t = np.linspace(0.0, 1.0, count)
        outline = np.interp(t, [0, 0.15, 0.55, 0.8, 0.93, 1], [0.28, 0.45, 1, 0.95, 0.62, 0.12])
        outward = np.tile(face, (count, 1)) + across * (0.25 * np.sin(t * 5))[:, None]
        thick = 0.008 * np.interp(t, [0, 0.5, 1], [1.1, 1, 0.6])
        return loft(path, outward, _LEAVES[name][2] * self.spec.bow_scale * outline, thick, detail.sides(12, 6))

    def _chain(self, name: str, spring: SpringSpec) -> Chain:
        path, _, _ = self._leaf_path(name, 21)
        points = path[[1, 10, 20]] if name in ("bow_left", "bow_right") else path[[1, 20]]
        return Chain(name, "head", points, spring.stiffness, spring.drag, spring.gravity, spring.radius)

    def parts(self, binder: Binder, detail: Detail) -> list[Part]:
        band, knot = self._band(detail), self._knot_sculpt.mesh(detail.triangles(500))
        parts = [
            Part("band", "red", band, binder.rigid(band.position, "head"), 0.7),
            Part("band_knot", "red", knot, binder.rigid(knot.position, "head"), 0.8),
        ]
        for name, chain in self.chains.items():
            leaf = self._leaf(name, detail)
            parts.append(Part(name, "red", leaf, binder.along_chain(leaf.position, chain), 0.8))
        return parts
