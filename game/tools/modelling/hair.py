"""Hair as few, big, uneven clumps: each a lens section swept along a path on the skull, over a hidden cap."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from game.tools.modelling.beard import beard_field
from game.tools.modelling.curls import CurlyMass, grown, overgrown
from game.tools.modelling.fields import Field, Floats, ellipsoid, smooth_max, smooth_min, smoothstep, union, unit
from game.tools.modelling.lofts import bezier, loft
from game.tools.modelling.mesh import Mesh
from game.tools.modelling.parts import Detail, Part
from game.tools.modelling.rig import Chain
from game.tools.modelling.spec import SpringSpec
from game.tools.modelling.spec_hair import ClumpSpec, HairSpec, TuftSpec
from game.tools.modelling.surface import Sculpt
from game.tools.modelling.weights import Binder

__all__ = ["Hair"]

_CURLS_M = np.array([0.30, 0.28, 0.30])
"""No curl stands further from the head's centre, metres."""
_SIDEBURN_M = 0.014
"""How softly hair and beard join, in shape and in how they swing."""


class Hair:
    """All hair of one head. centre: (3,) of the scalp ellipsoid in model space."""

    def __init__(self, spec: HairSpec, springs: Mapping[str, SpringSpec], head_centre: Floats, skin: Field) -> None:
        self.spec = spec
        self.head_centre = head_centre
        self._skin = skin
        self.centre = head_centre + np.asarray(spec.centre)
        self.radii = np.asarray(spec.radii)
        reach = 0.24
        self._cap = Sculpt(
            self._cap_field(), head_centre - (reach, 0.22, reach), head_centre + (reach, 0.24, reach), 0.006
        )
        self._loose = overgrown(self._cap.field, list(grown(spec.curls, self.on_scalp)))
        self._beard = self._beard_field() if spec.beard else None
        self.curls = self._curly() if spec.curls or spec.beard else None
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

    def on_skin(self, azimuth_deg: Floats, polar_deg: Floats, lift_m: Floats) -> tuple[Floats, Floats]:
        """Points (n, 3) on the head's skin in a direction from its centre, and these directions."""
        azimuth, polar = np.radians(azimuth_deg), np.radians(polar_deg)
        out = np.stack([np.sin(azimuth) * np.sin(polar), np.cos(polar), np.cos(azimuth) * np.sin(polar)], 1)
        near, far = np.zeros(len(out)), np.full(len(out), 0.30)
        for _ in range(24):
            middle = (near + far) / 2
            inside = self._skin(self.head_centre + out * middle[:, None]) < 0
            near, far = np.where(inside, middle, near), np.where(inside, far, middle)
        return self.head_centre + out * (near + lift_m)[:, None], out

    def _cap_field(self) -> Field:
        spec = self.spec
        scalp = ellipsoid(self.centre, self.radii + spec.cap_lift)
        hairline_deg, hairline_m = np.array(spec.hairline).T

        def field(p: Floats) -> Floats:
            q = p - self.centre
            azimuth = np.abs(np.degrees(np.arctan2(q[:, 0], q[:, 2])))
            hairline = np.interp(azimuth, hairline_deg, hairline_m)
            # The nape: a cylinder behind the ears, so that no gap opens between the back clumps.
            nape = smooth_max(np.hypot(q[:, 0], q[:, 2]) - spec.nape, np.abs(q[:, 1] + 0.07) - 0.085, 0.03)
            nape = smooth_max(nape, q[:, 2] + 0.02, 0.03)
            # On the crown the cap rises between the clumps, so that their partings are grooves and not gaps.
            crown = spec.crown * smoothstep(0.06, 0.13, q[:, 1])
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
        if spec.taper > 0.0:
            profile = profile * np.interp(t, [0.0, 0.3], [1.0 - spec.taper, 1.0])
        return loft(path, outward, spec.width * profile, spec.thickness * profile**0.8, detail.sides(9, 5))

    def _beard_field(self) -> Field:
        spec = self.spec.beard
        assert spec is not None
        return overgrown(beard_field(spec, self.head_centre, self._skin), list(grown(spec.curls, self.on_skin)))

    def _curly(self) -> CurlyMass:
        """Hair and beard in one: what grows together has no seam at the sideburns."""
        field = self._loose if self._beard is None else union(_SIDEBURN_M, self._loose, self._beard)
        return CurlyMass(field, self._skin, self.head_centre - _CURLS_M, self.head_centre + _CURLS_M)

    def curly_weights(self, points: Floats, binder: Binder) -> Floats:
        """(n, J): hair swings, a beard stays on the skin."""
        weights = binder.hair(points, self.chains)
        if self._beard is None:
            return weights
        swings = smoothstep(-_SIDEBURN_M, _SIDEBURN_M, self._beard(points) - self._loose(points))[:, None]
        return weights * swings + binder.rigid(points, "head") * (1.0 - swings)

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
        if self.curls:
            mesh = self.curls.mesh(detail.triangles(27000))
            parts = [Part("hair_curls", "hair", mesh, self.curly_weights(mesh.position, binder), 0.8)]
        else:
            mesh = self._cap.mesh(detail.triangles(1500))
            parts = [Part("hair_cap", "hair", mesh, binder.rigid(mesh.position, "head"), 0.9)]
        for number, (spec, mesh) in enumerate(self.all_clumps(detail)):
            weights = binder.hair(mesh.position, self.chains)
            parts.append(Part(f"hair_{spec.layer}_{number}", "hair", mesh, weights, 0.8))
        for whisker in self.spec.whiskers:
            mesh = self._tuft(whisker, detail)
            weights = binder.rigid(mesh.position, "head")
            parts.append(Part(f"whisker_{whisker.name}", "hair", mesh, weights, 0.7))
        for tuft, chain in zip(self.spec.tufts, self.tuft_chains, strict=True):
            mesh = self._tuft(tuft, detail)
            parts.append(Part(f"hair_tuft_{tuft.name}", "hair", mesh, binder.along_chain(mesh.position, chain), 0.8))
        return parts
