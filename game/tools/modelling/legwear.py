"""Below the coat: trousers short or long, calves, rolled socks and shoes."""

from __future__ import annotations

import numpy as np

from game.tools.modelling.anatomy import Anatomy, joint_at
from game.tools.modelling.fields import (
    Field,
    Floats,
    cone,
    ellipsoid,
    mirrored,
    offset,
    smooth_max,
    smooth_min,
    union,
)
from game.tools.modelling.mesh import split_at_level
from game.tools.modelling.parts import Detail, Part
from game.tools.modelling.spec_wear import LegSpec
from game.tools.modelling.surface import Sculpt
from game.tools.modelling.weights import Binder

__all__ = ["Legwear"]

_SOLE_M = 0.020
"""Height of the shoe's sole."""


class Legwear:
    """Fields and fine triangulations; legs, socks and shoes are modelled on the left and mirrored."""

    def __init__(self, spec: LegSpec, anatomy: Anatomy) -> None:
        self.spec = spec
        self.anatomy = anatomy
        self._hip, self._knee, self._ankle, self._toes = (
            joint_at(f"left{n}") for n in ("UpperLeg", "LowerLeg", "Foot", "Toes")
        )
        hem, top = spec.trouser_hem, spec.sock_top
        self._trousers = Sculpt(
            self._trouser_field, (-0.19, hem - 0.02, -0.14), (0.19, spec.trouser_top + 0.02, 0.14), 0.0048, 3e-3
        )
        self._bare = top - 0.02 < hem
        self._calf = Sculpt(self._calf_field, (0.0, top - 0.04, -0.08), (0.14, hem + 0.08, 0.08), 0.0045)
        self._sock = Sculpt(self._sock_field, (0.0, 0.02, -0.09), (0.14, top + 0.03, 0.09), 0.004)
        self._shoe = Sculpt(self._shoe_field(), (0.0, -0.01, -0.09), (0.15, 0.12, 0.15), 0.0038)
        self._sole = Sculpt(self._sole_field(), (0.0, -0.01, -0.09), (0.15, 0.04, 0.15), 0.0038)

    def _trouser_field(self, p: Floats) -> Floats:
        hem = self.spec.trouser_hem
        inner_radius, outer_radius = self.spec.radius
        foot = np.array([self._knee[0] + 0.002, hem - 0.02, self._knee[2]])
        leg = mirrored(cone(self._hip + (-0.004, 0.0, 0.0), foot, inner_radius, outer_radius))
        hollow = mirrored(cone(self._hip + (-0.004, 0.0, 0.0), foot, inner_radius - 0.018, outer_radius - 0.010))
        d = smooth_min(offset(self.anatomy.trunk, 0.012)(p), leg(p), 0.035)
        q = np.abs(p[:, 0])
        creases = 0.0020 * np.sin(p[:, 1] * 95 + 5 * q / 0.06) * np.exp(-(((p[:, 1] - 0.31) / 0.05) ** 2))
        d = smooth_max(d + creases, p[:, 1] - self.spec.trouser_top, 0.01)
        d = smooth_max(d, -smooth_max(hollow(p), p[:, 1] - (hem + 0.05), 0.01), 0.006)
        return smooth_max(d, hem - p[:, 1], 0.008)

    def _calf_field(self, p: Floats) -> Floats:
        d = smooth_max(self.anatomy.leg(p), p[:, 1] - (self.spec.trouser_hem + 0.06), 0.006)
        return smooth_max(d, self.spec.sock_top - 0.02 - p[:, 1], 0.006)

    def _sock_field(self, p: Floats) -> Floats:
        leg, top = self.anatomy.leg(p), self.spec.sock_top
        stocking = smooth_max(leg - 0.0045, p[:, 1] - top, 0.006)
        ribs = 0.0008 * np.sin(14 * np.arctan2(p[:, 0] - self._ankle[0], p[:, 2] - self._ankle[2]))
        roll = smooth_max(leg - 0.0105 + ribs, np.abs(p[:, 1] - top + 0.008) - 0.013, 0.012)
        return smooth_max(smooth_min(stocking, roll, 0.004), 0.045 - p[:, 1], 0.006)

    def _shoe_field(self) -> Field:
        x, toes = self._ankle[0], self._toes
        body = union(
            0.035,
            ellipsoid((x + 0.001, 0.040, -0.024), (0.036, 0.040, 0.042)),
            ellipsoid((x + 0.001, 0.038, 0.020), (0.035, 0.036, 0.050)),
            ellipsoid((toes[0] + 0.001, 0.032, toes[2] + 0.004), (0.043, 0.034, 0.052)),
        )
        collar = offset(cone((x, 0.05, self._ankle[2]), (x, 0.09, self._ankle[2]), 0.034, 0.034), 0.004)

        def field(p: Floats) -> Floats:
            d = smooth_min(body(p), smooth_max(collar(p), p[:, 1] - 0.082, 0.008), 0.016)
            return smooth_max(d, 0.012 - p[:, 1], 0.006)

        return field

    def _sole_field(self) -> Field:
        shoe = self._shoe_field()

        def field(p: Floats) -> Floats:
            widest = p.copy()
            widest[:, 1] = 0.034
            return smooth_max(shoe(widest) - 0.0045, np.abs(p[:, 1] - _SOLE_M / 2) - _SOLE_M / 2, 0.008)

        return field

    def parts(self, binder: Binder, detail: Detail, *, with_trousers: bool = True) -> list[Part]:
        spec = self.spec
        parts = []
        if with_trousers:
            trousers = self._trousers.mesh(detail.triangles(3200))
            hem, upper = split_at_level(trousers, spec.trouser_hem + spec.turn_up_m - trousers.position[:, 1])
            parts = [
                Part("trousers", spec.trousers, upper, binder.legs(upper.position), 1.0),
                Part("trouser_hem", spec.turn_up, hem, binder.legs(hem.position), 1.0),
            ]
        columns = binder.rig.mirrored_columns()
        shoe = self._shoe.mesh(detail.triangles(1500))
        # The toe cap is cut off by a slanted plane, like rubber dipped over the canvas.
        slope = shoe.position[:, 2] - self._toes[2] - 0.022 - 0.5 * (shoe.position[:, 1] - 0.04)
        cap, canvas = split_at_level(shoe, slope)
        left = [
            ("left_calf", "skin", self._calf.mesh(detail.triangles(800)), 0.8) if self._bare else None,
            ("left_sock", spec.sock, self._sock.mesh(detail.triangles(900)), 0.8),
            ("left_shoe", spec.shoe, canvas, 0.9),
            ("left_shoe_cap", spec.toe_cap, cap, 0.9),
            ("left_sole", spec.sole, self._sole.mesh(detail.triangles(900)), 0.8),
        ]
        for row in left:
            if row is not None:
                name, material, mesh, outline = row
                part = Part(name, material, mesh, binder.legs(mesh.position), outline)
                parts += [part, part.mirrored(columns)]
        return parts
