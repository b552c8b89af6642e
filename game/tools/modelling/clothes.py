"""The upper clothes, from inside out: shirt, bib apron with pocket and stitches, coat with lapels and crest, scarf."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from game.tools.modelling.anatomy import Anatomy
from game.tools.modelling.fields import (
    Field,
    Floats,
    Ints,
    cone,
    ellipsoid,
    gradient,
    intersection,
    normals,
    plane,
    ring,
    smooth_max,
    smooth_min,
    smoothstep,
    union,
    unit,
)
from game.tools.modelling.lofts import loft
from game.tools.modelling.mesh import Mesh, split_at_level
from game.tools.modelling.parts import Detail, Part
from game.tools.modelling.rig import Chain
from game.tools.modelling.spec import SpringSpec
from game.tools.modelling.spec_wear import CoatSpec
from game.tools.modelling.surface import Sculpt
from game.tools.modelling.trims import disc_on, lapel_line, on_front
from game.tools.modelling.weights import Binder, SleeveFit

__all__ = ["Clothes"]

_OPENING_Y = (0.45, 0.60, 0.75, 0.87, 0.93, 0.97, 1.05)
_OPENING_HALF_WIDTH = (0.092, 0.088, 0.078, 0.064, 0.053, 0.042, 0.040)
_APRON_Y = (0.40, 0.655, 0.70, 0.86, 0.90)
_APRON_HALF_WIDTH = (0.15, 0.16, 0.105, 0.080, 0.078)

Weigh = Callable[[Floats], Floats]


class Clothes:
    """Fields of the upper clothes; ``parts`` takes meshes from them."""

    def __init__(self, spec: CoatSpec, anatomy: Anatomy, tail_spring: SpringSpec) -> None:
        self.spec = spec
        self.anatomy = anatomy
        s = spec
        self._shirt = Sculpt(self._shirt_field, (-0.2, 0.50, -0.15), (0.2, 1.0, 0.15), 0.006)
        self._apron = Sculpt(self._apron_field, (-0.19, s.apron_hem - 0.02, -0.02), (0.19, 0.90, 0.17), 0.004, 3e-3)
        self._pocket = Sculpt(self._pocket_field, (-0.07, 0.70, 0.04), (0.07, 0.82, 0.16), 0.003)
        self._badge_at, self._badge_out = self._on_front(np.array([0.0]), np.array([0.752]), 0.0215)
        self._badge = Sculpt(self._badge_field, self._badge_at[0] - 0.03, self._badge_at[0] + 0.03, 0.0014)
        self._coat = Sculpt(self._coat_field, (-0.36, s.coat_hem - 0.02, -0.23), (0.36, 1.02, 0.23), 0.0042, 7e-3)
        self._scarf = Sculpt(self._scarf_field, (-0.12, 0.84, -0.12), (0.12, 1.04, 0.15), 0.0035)
        self._sleeve = Sculpt(self._sleeve_field, (0.05, 0.50, -0.10), (0.46, 1.02, 0.10), 0.0045, 5e-3)
        self._cuff = Sculpt(self._cuff_field, (0.18, 0.55, -0.10), (0.46, 0.85, 0.10), 0.004)
        self._lapel_path, self._lapel_out = lapel_line(self._coat_closed, _OPENING_Y, _OPENING_HALF_WIDTH, s.coat_hem)
        self.sleeve_fit = SleeveFit()
        self.tails = (
            self._tail("scarf_right", (-0.026, 0.872, 0.110), tail_spring),
            self._tail("scarf_left", (0.048, 0.880, 0.106), tail_spring),
        )

    # --- fields ------------------------------------------------------------------------------------------------
    def _shirt_field(self, p: Floats) -> Floats:
        d = smooth_max(self.anatomy.trunk(p) - 0.004, p[:, 1] - 0.968, 0.01)
        return smooth_max(d, 0.52 - p[:, 1], 0.01)

    def _apron_field(self, p: Floats) -> Floats:
        trunk, y = self.anatomy.trunk(p), p[:, 1]
        # Below the belly the cloth hangs instead of following the body under.
        hang = 0.030 * np.clip((0.62 - y) / 0.14, 0.0, 1.0) ** 1.5
        layer = smooth_max(trunk - 0.0165 - hang, -(trunk - 0.004 - hang), 0.004)
        half = np.interp(y, _APRON_Y, _APRON_HALF_WIDTH)
        region = smooth_max(np.abs(p[:, 0]) - half, -p[:, 2], 0.01)
        region = smooth_max(region, y - self.spec.apron_top, 0.014)
        return smooth_max(layer, smooth_max(region, self.spec.apron_hem - y, 0.01), 0.006)

    def _pocket_field(self, p: Floats) -> Floats:
        trunk = self.anatomy.trunk(p)
        layer = smooth_max(trunk - 0.022, -(trunk - 0.010), 0.003)
        region = smooth_max(np.abs(p[:, 0]) - 0.046, np.abs(p[:, 1] - 0.765) - 0.034, 0.018)
        return smooth_max(layer, smooth_max(region, -p[:, 2], 0.01), 0.004)

    def _badge_field(self, p: Floats) -> Floats:
        out = self._badge_out[0]
        right = unit(np.cross(np.array([0.0, 1.0, 0.0]), out))
        q = p - self._badge_at[0]
        x, y, z = q @ right, q @ np.cross(out, right), q @ out
        r = np.hypot(x, y)
        disc = smooth_max(r - 0.0175, np.abs(z) - 0.0045, 0.003)
        rim = smooth_max(np.abs(r - 0.0135) - 0.0022, np.abs(z - 0.004) - 0.0022, 0.001)
        hole = smooth_max(np.maximum(np.abs(x), np.abs(y)) - 0.0042, -(z + 0.001), 0.001)
        return smooth_max(smooth_min(disc, rim, 0.002), -hole, 0.002)

    def _sleeve_cone(self, thickness: float) -> Field:
        """The coat's half sleeve: a cone that opens toward the hand; ``thickness`` below the outer face."""
        arm = self.anatomy.arm
        start, end, _ = self.spec.sleeve_radius
        return cone(arm.at(-0.03), arm.at(0.30), start - thickness, end - thickness)

    def _coat_sleeve(self, p: Floats) -> Floats:
        arm = self.anatomy.arm
        t = arm.distance_along(p)
        folds = 0.0024 * np.sin(3 * arm.angle_around(p) + 0.8) * np.clip((t - 0.05) * 14, 0, 1)
        d = smooth_max(self._sleeve_cone(0.0)(p) + folds, t - self.spec.sleeve_end, 0.006)
        return smooth_max(d, -self._sleeve_hollow(p), 0.006)

    def _sleeve_hollow(self, p: Floats) -> Floats:
        t = self.anatomy.arm.distance_along(p)
        return smooth_max(self._sleeve_cone(0.0098)(p), self.spec.sleeve_radius[2] - t, 0.01)

    def _coat_body(self, p: Floats) -> Floats:
        y = p[:, 1]
        fall = np.clip((0.78 - y) / 0.25, 0.0, 1.4)
        folds = 0.003 * np.sin(p[:, 0] * 60 + y * 8) * np.clip((0.80 - y) * 5, 0, 1)
        # The trunk narrows below the hips; the cloth goes on falling straight.
        straight = 0.5 * np.clip(0.55 - y, 0.0, 0.12)
        return self.anatomy.trunk(p) - 0.019 - self.spec.coat_flare * fall**1.3 - straight + folds

    def _coat_closed(self, p: Floats) -> Floats:
        q = p.copy()
        q[:, 0] = np.abs(q[:, 0])
        return smooth_min(self._coat_body(p), self._coat_sleeve(q), 0.024)

    def _coat_field(self, p: Floats) -> Floats:
        q = p.copy()
        q[:, 0] = np.abs(q[:, 0])
        d = smooth_max(self._coat_closed(p), -self._sleeve_hollow(q), 0.007)
        # Inside, the coat is thinner the further it stands off the body, so that its hem is an edge, not a ledge.
        inside = self._coat_body(p) + np.where(p[:, 1] < 0.66, 0.014, 0.025)
        d = smooth_max(d, -np.maximum(inside, self.anatomy.trunk(p) - 0.05), 0.006)
        opening = smooth_max(np.abs(p[:, 0]) - np.interp(p[:, 1], _OPENING_Y, _OPENING_HALF_WIDTH), -p[:, 2], 0.02)
        d = smooth_max(d, -opening, 0.006)
        d = smooth_max(d, -cone((0, 0.962, -0.006), (0, 1.06, -0.010), 0.066, 0.09)(p), 0.008)
        return smooth_max(d, self.spec.coat_hem - p[:, 1], 0.01)

    def _scarf_field(self, p: Floats) -> Floats:
        level = np.stack([p[:, 0], p[:, 1] + 0.10 * p[:, 2], p[:, 2] * 0.98], 1)
        level[:, 1] = (level[:, 1] - 0.985) / 1.05 + 0.985
        creases = 0.0028 * np.sin(4 * np.arctan2(p[:, 0], p[:, 2]) + 95 * (p[:, 1] - 0.98))
        loop = ring((0, 0.985, -0.004), 0.063, 0.022)(level) + creases
        knot = ellipsoid((0.012, 0.955, 0.078), (0.019, 0.017, 0.016))(p)
        right = cone((0.010, 0.945, 0.085), (-0.028, 0.868, 0.110), 0.009, 0.019)(p)
        left = cone((0.016, 0.945, 0.085), (0.050, 0.877, 0.106), 0.009, 0.017)(p)
        right = smooth_max(right, plane((-0.028, 0.862, 0.1), (-0.35, -1, 0))(p), 0.006)
        left = smooth_max(left, plane((0.050, 0.870, 0.1), (0.5, -1, 0))(p), 0.006)
        return smooth_min(loop, smooth_min(smooth_min(right, left, 0.004), knot, 0.006), 0.006)

    def _sleeve_field(self, p: Floats) -> Floats:
        """The shirt's sleeve, with shallow folds where the elbow bends."""
        arm = self.anatomy.arm
        upper = arm.upper_m
        d = union(
            0.02,
            cone(arm.at(0.03), arm.at(upper), 0.0455, 0.0425),
            cone(arm.at(upper), arm.at(upper + self.spec.cuff_to), 0.0425, 0.043),
        )(p)
        t = arm.distance_along(p)
        folds = 0.0024 * np.sin((t - upper) * 150 + 1.1 * np.sin(np.pi / 2 - arm.angle_around(p) + 0.6))
        d = d + folds * np.exp(-(((t - upper + 0.020) / 0.045) ** 2))
        # It begins inside the coat's sleeve: at the shoulder it would show through the folds of crossed arms.
        d = smooth_max(d, self.spec.sleeve_radius[2] - 0.012 - t, 0.01)
        return smooth_max(d, t - upper - (self.spec.cuff_from + self.spec.cuff_to) / 2, 0.006)

    def _cuff_field(self, p: Floats) -> Floats:
        arm = self.anatomy.arm
        start, end = arm.upper_m + self.spec.cuff_from, arm.upper_m + self.spec.cuff_to
        roll = intersection(
            0.012,
            cone(arm.at(start - 0.025), arm.at(end + 0.05), 0.0485, 0.0495),
            plane(arm.at(end), arm.along),
            plane(arm.at(start), -arm.along),
        )
        return roll(p)

    # --- lines on the cloth ------------------------------------------------------------------------------------
    def _tail(self, name: str, tip: tuple[float, float, float], spring: SpringSpec) -> Chain:
        points = np.array([(0.012, 0.946, 0.084), tip])
        return Chain(name, "chest", points, spring.stiffness, spring.drag, spring.gravity, spring.radius, ("chest",))

    def _on_front(self, x: Floats, y: Floats, stand_off: float) -> tuple[Floats, Floats]:
        """Points (n, 3) on the front of the trunk at ``stand_off`` metres, and the trunk's normals there."""
        p = np.stack([x, y, np.full(len(x), 0.09)], 1)
        for _ in range(8):
            slope = gradient(self.anatomy.trunk, p)
            p[:, 2] -= (self.anatomy.trunk(p) - stand_off) / np.maximum(slope[:, 2], 0.3)
        return p, normals(self.anatomy.trunk, p)

    # --- parts -------------------------------------------------------------------------------------------------
    def parts(self, binder: Binder, detail: Detail) -> list[Part]:
        parts = [
            _part("shirt", "shirt", self._shirt.mesh(detail.triangles(1400)), binder.shirt, 0.8),
            _part("apron", "apron", self._apron.mesh(detail.triangles(2400)), binder.shirt, 0.9),
            _part("pocket", "apron2", self._pocket.mesh(detail.triangles(1300)), binder.shirt, 0.8),
        ]
        parts += self._coat_parts(binder, detail) + self._lapel_parts(binder, detail)
        if detail.trims:
            parts.append(_part("badge", "teal", self._badge.mesh(detail.triangles(1000)), binder.shirt, 0.6, True))
            parts += self._stitches(binder)
        scarf = self._scarf.mesh(detail.triangles(3000))
        parts.append(Part("scarf", "red", scarf, binder.scarf(scarf.position, self.tails), 0.8))
        columns = binder.rig.mirrored_columns()
        for name, sculpt, count in (("left_sleeve", self._sleeve, 2000), ("left_cuff", self._cuff, 1100)):
            part = _part(name, "shirt", sculpt.mesh(detail.triangles(count)), binder.left_sleeve, 0.9)
            parts += [part, part.mirrored(columns)]
        return parts

    def _coat_parts(self, binder: Binder, detail: Detail) -> list[Part]:
        """The coat with its cream sleeve hem and stripe, cut along level sets, and the crest on the back."""
        coat = self._coat.mesh(detail.triangles(10500))

        def down_sleeve(mesh: Mesh) -> Floats:
            p = mesh.position.copy()
            p[:, 0] = np.abs(p[:, 0])
            # Off the sleeve the value falls steeply but steadily, so that the cut there stays a smooth line.
            off_sleeve = np.maximum(self._coat_sleeve(p) - self._coat_body(p) + 0.003, 0.0)
            return np.asarray(self.anatomy.arm.distance_along(p) - 6.0 * off_sleeve)

        hem_at = self.spec.sleeve_end - self.spec.sleeve_stripe
        parts = []
        hem, rest = split_at_level(coat, down_sleeve(coat) - hem_at)
        parts.append(_part("coat_sleeve_hem", "cream", self._hem_lit_as_cloth(hem), binder.coat, 1.0))
        if detail.trims:
            between, rest = split_at_level(rest, down_sleeve(rest) - (hem_at - 0.006))
            stripe, rest = split_at_level(rest, down_sleeve(rest) - (hem_at - 0.010))
            parts.append(_part("coat_sleeve_gap", "indigo", between, binder.coat, 1.0))
            parts.append(_part("coat_sleeve_stripe", "cream", stripe, binder.coat, 1.0))
            base = self.spec.coat_hem
            upper, low = split_at_level(rest, rest.position[:, 1] - (base + 0.030))
            band, lower = split_at_level(low, low.position[:, 1] - (base + 0.022))
            parts.append(_part("coat_hem_stripe", "cream", band, binder.coat, 1.0))
            parts.append(_part("coat_hem", "indigo", lower, binder.coat, 1.1))
            rest = upper
            parts += self._crest(binder, detail)
        parts.append(_part("coat", "indigo", rest, binder.coat, 1.1))
        return parts

    def _hem_lit_as_cloth(self, hem: Mesh) -> Mesh:
        """The outside of the sleeve's hem with normals off the arm: the rolled edge's own would shade it in teeth."""
        arm = self.anatomy.arm
        p = hem.position * np.where(hem.position[:, :1] < 0, (-1.0, 1.0, 1.0), 1.0)
        out = p - arm.shoulder
        out = unit(out - (out @ arm.along)[:, None] * arm.along)
        out *= np.where(hem.position[:, :1] < 0, (-1.0, 1.0, 1.0), 1.0)
        outside = smoothstep(-0.002, 0.001, self._sleeve_cone(0.005)(p))[:, None]
        return replace(hem, normal=unit(hem.normal * (1 - 0.85 * outside) + out * (0.85 * outside)))

    def _crest(self, binder: Binder, detail: Detail) -> list[Part]:
        """A ring and a four-petalled flower on the back, and small on the breast, 1.6 mm over the cloth."""
        size, centre_y = self.spec.crest_radius, 0.800
        turns = detail.sides(56, 24)

        def laid(radius: Callable[[Floats], tuple[Floats, Floats]], name: str, material: str) -> Part:
            angle = np.linspace(0.0, 2 * np.pi, turns, endpoint=False)
            inner, outer = radius(angle)
            rings = [inner + (outer - inner) * k / 3 for k in range(4)]
            x = np.concatenate([r * np.cos(angle) for r in rings])
            y = centre_y + np.concatenate([r * np.sin(angle) for r in rings])
            p = np.stack([x, y, np.full(len(x), -0.15)], 1)
            for _ in range(12):
                slope = gradient(self._coat_closed, p, 6e-3)
                p[:, 2] -= (self._coat_closed(p) - 0.0016) / np.minimum(slope[:, 2], -0.3)
            k, j = (v.ravel() for v in np.meshgrid(np.arange(3), np.arange(turns), indexing="ij"))
            a, b = k * turns + j, k * turns + (j + 1) % turns
            triangle: Ints = np.vstack([np.stack([a, b, b + turns], 1), np.stack([a, b + turns, a + turns], 1)])
            mesh = Mesh(p, normals(self._coat_closed, p, 9e-3), triangle)
            return _part(name, material, mesh, binder.coat, 0.0, True)

        def outline(angle: Floats) -> tuple[Floats, Floats]:
            return np.full_like(angle, 0.86 * size), np.full_like(angle, size)

        def petals(angle: Floats) -> tuple[Floats, Floats]:
            return np.full_like(angle, 0.16 * size), size * (0.40 + 0.27 * np.abs(np.cos(2 * angle)) ** 0.7)

        def heart(angle: Floats) -> tuple[Floats, Floats]:
            return np.zeros_like(angle), np.full_like(angle, 0.13 * size)

        at, _ = on_front(self._coat_closed, [0.092], [0.872], 0.0)
        share = 0.36

        def small(figure: Callable[[Floats], tuple[Floats, Floats]], name: str, material: str) -> Part:
            def shrunk(angle: Floats) -> tuple[Floats, Floats]:
                inner, outer = figure(angle)
                return share * inner, share * outer

            mesh = disc_on(self._coat_closed, at[0], shrunk, detail, 0.0016)
            return _part(name, material, mesh, binder.coat, 0.0, True)

        return [
            laid(outline, "crest_ring", "cream"),
            laid(petals, "crest_flower", "cream"),
            laid(heart, "crest_heart", "apron"),
            small(outline, "breast_ring", "cream"),
            small(petals, "breast_flower", "cream"),
        ]

    def _lapel_parts(self, binder: Binder, detail: Detail) -> list[Part]:
        count = detail.rings(76, 24)
        pick = np.linspace(0, len(self._lapel_path) - 1, count).round().astype(int)
        path, out = self._lapel_path[pick], self._lapel_out[pick]
        parts = [
            _part("lapel", "cream", loft(path, out, 0.0185, 0.0085, detail.sides(12, 6), "band"), binder.coat, 0.9)
        ]
        if detail.trims:
            tangent = unit(np.gradient(path, axis=0))
            across = np.cross(tangent, out)
            for side in (-0.0105, 0.0105):
                line = loft(path + across * side + out * 0.0078, out, 0.0021, 0.0014, 4, "round")
                parts.append(_part("lapel_trim", "indigo", line, binder.coat, 0.0, True))
        return parts

    def _stitches(self, binder: Binder) -> list[Part]:
        parts = []
        for count, half_width, y, stand_off in (
            (14, 0.070, self.spec.apron_top - 0.013, 0.0185),
            (8, 0.038, 0.789, 0.0245),
        ):
            for stitch in range(count):
                t = np.linspace(stitch / count, (stitch + 0.58) / count, 3)
                path, out = self._on_front(half_width * (2 * t - 1), np.full(3, y), stand_off)
                mesh = loft(path, out, 0.0013, 0.0014, 4, "round")
                parts.append(_part("stitch", "cream", mesh, binder.shirt, 0.0, True))
        return parts


def _part(name: str, material: str, mesh: Mesh, weigh: Weigh, outline: float, trim: bool = False) -> Part:
    return Part(name, material, mesh, weigh(mesh.position), outline, trim)
