"""Hair as few, big, uneven clumps: each a lens section swept along a path on the skull, over a hidden cap."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from game.tools.modelling.fields import Field, Floats, ellipsoid, smooth_max, smooth_min, smoothstep, unit
from game.tools.modelling.lofts import bezier, loft
from game.tools.modelling.mesh import Mesh
from game.tools.modelling.parts import Detail, Part
from game.tools.modelling.rig import Chain
from game.tools.modelling.spec import ClumpSpec, HairSpec, SpringSpec, TuftSpec
from game.tools.modelling.surface import Sculpt
from game.tools.modelling.weights import Binder

__all__ = ["Hair"]

_HAIRLINE_DEG = (0, 40, 70, 88, 105, 130, 180)
_HAIRLINE_M = (0.110, 0.075, 0.020, -0.035, -0.092, -0.128, -0.142)
"""Lower edge of the cap under the clumps: height over the hair's centre by azimuth."""


class Hair:
    """All hair of one head. centre: (3,) of the scalp ellipsoid in model space."""

    def __init__(self, spec: HairSpec, springs: Mapping[str, SpringSpec], head_centre: Floats) -> None:
        self.spec = spec
        self.head_centre = head_centre
        self.centre = head_centre + np.asarray(spec.centre)
        self.radii = np.asarray(spec.radii)
        reach = 0.24
        self._cap = Sculpt(
            self._cap_field(), head_centre - (reach, 0.22, reach), head_centre + (reach, 0.24, reach), 0.006
        )
        self.chains = {
            np.radians(azimuth): self._chain(name, azimuth, springs["hair"]) for name, azimuth in spec.chains
        }
        self.tuft_chains = [self._tuft_chain(tuft, springs["tuft"]) for tuft in spec.tufts]

    def on_scalp(self, azimuth_deg: Floats, polar_deg: Floats, lift_m: Floats) -> tuple[Floats, Floats]:
        """Points and outward directions (n, 3); beyond a polar angle of 90 degrees the path hangs down."""
        polar = np.radians(np.minimum(polar_deg, 90.0))
        hanging = np.maximum(polar_deg - 90.0, 0.0) / 90.0
        upper = polar_deg < 90.0
        height = np.where(upper, np.cos(polar), -hanging * 1.45)
        radius = np.where(upper, np.sin(polar), 1.0 - 0.10 * hanging - 0.20 * hanging**2)
        azimuth = np.radians(azimuth_deg)
        level = np.stack([np.sin(azimuth) * radius, np.where(upper, height, 0.0), np.cos(azimuth) * radius], 1)
        outward = unit(level)
        on_skull = np.stack([level[:, 0], height, level[:, 2]], 1) * self.radii
        return on_skull + outward * lift_m[:, None] + self.centre, outward

    def _cap_field(self) -> Field:
        scalp = ellipsoid(self.centre, self.radii + 0.002)

        def field(p: Floats) -> Floats:
            q = p - self.centre
            azimuth = np.abs(np.degrees(np.arctan2(q[:, 0], q[:, 2])))
            hairline = np.interp(azimuth, _HAIRLINE_DEG, _HAIRLINE_M)
            # The nape: a cylinder behind the ears, so that no gap opens between the back clumps.
            nape = smooth_max(np.hypot(q[:, 0], q[:, 2]) - 0.160, np.abs(q[:, 1] + 0.07) - 0.085, 0.03)
            nape = smooth_max(nape, q[:, 2] + 0.02, 0.03)
            # On the crown the cap rises between the clumps, so that their partings are grooves and not gaps.
            crown = 0.018 * smoothstep(0.06, 0.13, q[:, 1])
            return smooth_max(smooth_min(scalp(p) - crown, nape, 0.04), (hairline - q[:, 1]) * 0.8, 0.012)

        return field

    def clump(self, spec: ClumpSpec, detail: Detail) -> Mesh:
        """Widest at ``widest`` of its length, pointed at the tip."""
        t = np.linspace(0.0, 1.0, detail.rings(15, 7))
        azimuth = spec.azimuth_deg[0] + (spec.azimuth_deg[1] - spec.azimuth_deg[0]) * t**spec.ease
        azimuth = azimuth + spec.curl_deg * np.sin(np.pi * t)
        polar = spec.polar_deg[0] + (spec.polar_deg[1] - spec.polar_deg[0]) * t
        path, outward = self.on_scalp(azimuth, polar, spec.lift + spec.bow * np.sin(np.pi * t**0.8) + spec.tip * t**3)
        swell = 0.55 + 0.45 * np.sin(np.minimum(t / spec.widest, 1.0) * np.pi / 2)
        fall = np.maximum(1.0 - (np.maximum(t - spec.widest, 0.0) / (1.0 - spec.widest)) ** 1.7, 0.0) ** 0.713
        profile = np.maximum(np.where(t < spec.widest, swell, fall), 0.004)
        return loft(path, outward, spec.width * profile, spec.thickness * profile**0.8, detail.sides(9, 5))

    def all_clumps(self, detail: Detail) -> list[tuple[ClumpSpec, Mesh]]:
        return [(spec, self.clump(spec, detail)) for spec in self.spec.clumps]

    def _tuft(self, spec: TuftSpec, detail: Detail) -> Mesh:
        count = detail.rings(20, 7)
        t = np.linspace(0.0, 1.0, count)
        path = bezier(spec.points, count) + self.head_centre
        profile = np.maximum(np.sin(np.pi * np.clip(t * 0.62 + 0.36, 0, 1)), 0.01)
        outward = np.tile(np.asarray(spec.outward), (count, 1))
        return loft(path, outward, spec.width * profile, spec.thickness * profile, detail.sides(10, 5))

    def _chain(self, name: str, azimuth_deg: float, spring: SpringSpec) -> Chain:
        root_end, _ = self.on_scalp(np.full(2, azimuth_deg), np.array([92.0, 152.0]), np.array([0.010, 0.045]))
        return Chain(
            f"hair_{name}",
            "head",
            root_end,
            spring.stiffness,
            spring.drag,
            spring.gravity,
            spring.radius,
            ("head", "neck"),
        )

    def _tuft_chain(self, tuft: TuftSpec, spring: SpringSpec) -> Chain:
        path = bezier(tuft.points, 20) + self.head_centre
        return Chain(
            f"tuft_{tuft.name}", "head", path[[3, 19]], spring.stiffness, spring.drag, spring.gravity, spring.radius
        )

    def parts(self, binder: Binder, detail: Detail) -> list[Part]:
        cap = self._cap.mesh(detail.triangles(1500))
        parts = [Part("hair_cap", "hair", cap, binder.rigid(cap.position, "head"), 0.9)]
        for number, (spec, mesh) in enumerate(self.all_clumps(detail)):
            weights = binder.hair(mesh.position, self.chains)
            parts.append(Part(f"hair_{spec.layer}_{number}", "hair", mesh, weights, 0.8))
        for tuft, chain in zip(self.spec.tufts, self.tuft_chains, strict=True):
            mesh = self._tuft(tuft, detail)
            parts.append(Part(f"hair_tuft_{tuft.name}", "hair", mesh, binder.along_chain(mesh.position, chain), 0.8))
        return parts
