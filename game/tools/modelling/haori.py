"""A gentleman's clothes, from inside out: kimono collar and sleeves, waistcoat, watch chain, haori with cords."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from game.tools.modelling.anatomy import Anatomy
from game.tools.modelling.fields import Field, Floats, cone, smooth_max, smooth_min, smoothstep, union
from game.tools.modelling.lofts import loft
from game.tools.modelling.mesh import Mesh, split_at_level
from game.tools.modelling.parts import Detail, Part
from game.tools.modelling.rig import Chain
from game.tools.modelling.spec import SpringSpec
from game.tools.modelling.spec_wear import HaoriSpec
from game.tools.modelling.surface import Sculpt
from game.tools.modelling.trims import Weigh, disc_on, knob, laid_line, lapel_line, on_front, part_of, patch_on
from game.tools.modelling.weights import Binder, SleeveFit

__all__ = ["Haori"]

_CLOTH_M = 0.024
"""The haori stands off the trunk; its own cloth is 7 mm."""
_VEST_M = 0.0165
_REACH_M = 0.11
_NECK_V = (0.795, 0.950, 0.058)
"""The waistcoat's neckline: height of its point, height and half width at the collar."""
_BUTTONS_Y = (0.772, 0.731, 0.690, 0.649)
_CORD_Y = 0.800


class Haori:
    """Fields of the upper clothes; ``parts`` takes meshes from them."""

    def __init__(self, spec: HaoriSpec, anatomy: Anatomy, springs: Mapping[str, SpringSpec]) -> None:
        self.spec = spec
        self.anatomy = anatomy
        s = spec
        self.sleeve_fit = SleeveFit(s.sleeve[0], s.sleeve[0] + 0.004, _CLOTH_M, _REACH_M)
        self._opening_y = (s.hem, 0.62, 0.78, 0.90, 0.965, 1.05)
        self._opening_x = (*s.opening, 0.041, 0.040)
        self._shirt = Sculpt(self._shirt_field, (-0.2, 0.60, -0.15), (0.2, 1.0, 0.15), 0.006)
        self._vest = Sculpt(self._vest_field, (-0.16, s.vest_hem - 0.05, -0.02), (0.16, 0.97, 0.20), 0.004, 3e-3)
        self._haori = Sculpt(self._haori_field, (-0.50, s.hem - 0.02, -0.24), (0.50, 1.02, 0.24), 0.0046, 7e-3)
        self._under = Sculpt(self._under_field, (0.05, 0.42, -0.10), (0.48, 1.00, 0.10), 0.0045, 4e-3)
        self._cuff = Sculpt(self._cuff_field, (0.18, 0.42, -0.10), (0.48, 0.80, 0.10), 0.0036)
        self._knot, _ = on_front(anatomy.trunk, [0.0], [_CORD_Y - 0.012], 0.034)
        cord, sleeve = springs["cord"], springs["sleeve"]
        tassel = np.vstack([self._knot[0], self._knot[0] + (0.0, -0.070, 0.004)])
        self.tails = (
            _chain("cord", "chest", tassel, cord, ("chest",)),
            self._sleeve_chain("left", 1.0, sleeve),
            self._sleeve_chain("right", -1.0, sleeve),
        )

    # --- fields ------------------------------------------------------------------------------------------------
    def _shirt_field(self, p: Floats) -> Floats:
        d = smooth_max(self.anatomy.trunk(p) - 0.004, p[:, 1] - 0.970, 0.01)
        return smooth_max(d, 0.62 - p[:, 1], 0.01)

    def _vest_body(self, p: Floats) -> Floats:
        hang = 0.020 * np.clip((0.64 - p[:, 1]) / 0.12, 0.0, 1.0) ** 1.5
        return np.asarray(self.anatomy.trunk(p) - _VEST_M - hang)

    def _vest_field(self, p: Floats) -> Floats:
        x, y = np.abs(p[:, 0]), p[:, 1]
        layer = smooth_max(self._vest_body(p), -(self._vest_body(p) + 0.0115), 0.004)
        low, high, half = _NECK_V
        neck = half * (y - low) / (high - low)
        points = 0.024 * np.clip(1.0 - np.abs(x - 0.036) / 0.036, 0.0, 1.0)
        region = smooth_max(x - 0.125, -p[:, 2] - 0.01, 0.01)
        region = smooth_max(region, (neck - x) * 0.93, 0.006)
        region = smooth_max(region, self.spec.vest_hem - points - y, 0.006)
        return smooth_max(layer, smooth_max(region, y - self.spec.vest_top, 0.01), 0.006)

    def _sleeve(self, p: Floats, thickness: float) -> Floats:
        """The wide sleeve, ``thickness`` below its outer face: round above, hanging in a pouch below the forearm."""
        arm, (start, end, pouch) = self.anatomy.arm, self.spec.sleeve
        q = p - arm.shoulder
        t, up, forward = q @ arm.along, q @ arm.up, q @ arm.forward
        share = np.clip(t / self.spec.sleeve_end, -0.2, 1.2)
        radius = start + (end - start) * np.clip(share, 0.0, 1.2) ** 1.5
        hang = pouch * smoothstep(0.42, 1.0, share)
        below = np.clip(-up / np.maximum(hang, 1e-6), 0.0, 1.0) * hang
        # The pouch is flatter than the arm's part.
        narrow = 1.0 - 0.35 * smoothstep(0.0, 1.0, below / max(pouch, 1e-6))
        rounded = np.minimum(t + 0.02, 0.0)
        d = np.sqrt((up + below) ** 2 + (forward / narrow) ** 2 + rounded**2) - (radius - thickness)
        return np.asarray(d * 0.85)

    def _outer_sleeve(self, p: Floats) -> Floats:
        arm = self.anatomy.arm
        t = arm.distance_along(p)
        folds = 0.0028 * np.sin(3 * arm.angle_around(p) + 26 * t) * np.clip((t - 0.06) * 9, 0, 1)
        elbow = 0.0030 * np.sin((t - arm.upper_m) * 130) * np.exp(-(((t - arm.upper_m) / 0.05) ** 2))
        return smooth_max(self._sleeve(p, 0.0) + folds + elbow, t - self.spec.sleeve_end, 0.006)

    def _hollow(self, p: Floats) -> Floats:
        t = self.anatomy.arm.distance_along(p)
        return smooth_max(self._sleeve(p, 0.0125), 0.075 - t, 0.01)

    def _body(self, p: Floats) -> Floats:
        y = p[:, 1]
        fall = np.clip((0.80 - y) / 0.40, 0.0, 1.3)
        folds = 0.0036 * np.sin(p[:, 0] * 48 + 0.6) * np.clip((0.70 - y) * 3, 0, 1)
        return np.asarray(self._hung(p) - _CLOTH_M - self.spec.flare * fall**1.3 + folds)

    def _hung(self, p: Floats) -> Floats:
        """The trunk, going on straight down from the hips: cloth falls, it does not follow the body under."""
        q = p.copy()
        q[:, 1] = np.maximum(q[:, 1], 0.560)
        return self.anatomy.trunk(q)

    def _closed(self, p: Floats) -> Floats:
        q = _right_half_mirrored(p)
        return smooth_min(self._body(p), self._outer_sleeve(q), 0.026)

    def _haori_field(self, p: Floats) -> Floats:
        d = smooth_max(self._closed(p), -self._hollow(_right_half_mirrored(p)), 0.006)
        inside = self._body(p) + np.where(p[:, 1] < 0.66, 0.012, 0.022)
        d = smooth_max(d, -np.maximum(inside, self._hung(p) - 0.06), 0.006)
        opening = smooth_max(np.abs(p[:, 0]) - np.interp(p[:, 1], self._opening_y, self._opening_x), -p[:, 2], 0.02)
        d = smooth_max(d, -opening, 0.006)
        d = smooth_max(d, -cone((0, 0.962, -0.006), (0, 1.06, -0.010), 0.066, 0.09)(p), 0.008)
        return smooth_max(d, self.spec.hem - p[:, 1], 0.01)

    def _under_tube(self, grow_m: float) -> Field:
        arm, (shoulder, elbow, wrist) = self.anatomy.arm, self.spec.under_sleeve
        reach = arm.upper_m + arm.fore_m
        return union(
            0.02,
            cone(arm.at(0.03), arm.at(arm.upper_m), shoulder + grow_m, elbow + grow_m),
            cone(arm.at(arm.upper_m), arm.at(reach + 0.02), elbow + grow_m, wrist + grow_m),
        )

    def _under_field(self, p: Floats) -> Floats:
        arm = self.anatomy.arm
        t = arm.distance_along(p)
        wrist = arm.upper_m + arm.fore_m
        folds = 0.0018 * np.sin((t - arm.upper_m) * 120 + 1.1 * np.sin(arm.angle_around(p)))
        d = self._under_tube(0.0)(p) + folds * np.exp(-(((t - wrist + 0.07) / 0.06) ** 2))
        # It begins well inside the haori: at the shoulder it would show through the cloth of a lowered arm.
        return smooth_max(smooth_max(d, 0.185 - t, 0.01), t - wrist + 0.022, 0.006)

    def _cuff_field(self, p: Floats) -> Floats:
        t = self.anatomy.arm.distance_along(p)
        wrist = self.anatomy.arm.upper_m + self.anatomy.arm.fore_m
        return smooth_max(self._under_tube(0.0035)(p), np.abs(t - wrist + 0.024) - 0.018, 0.008)

    # --- chains ------------------------------------------------------------------------------------------------
    def _pouch_at(self, up: float) -> Floats:
        return np.array([self.spec.sleeve_end - 0.035, up, 0.0])

    def _sleeve_chain(self, side: str, sign: float, spring: SpringSpec) -> Chain:
        """Down the pouch from the forearm; chains stand in the T-pose, where the arm's axes are the world's."""
        ends = np.array([self._pouch_at(-0.030), self._pouch_at(-0.040 - self.spec.sleeve[1] - self.spec.sleeve[2])])
        points = (self.anatomy.arm.shoulder + ends) * (sign, 1.0, 1.0)
        return _chain(f"{side}Sleeve", f"{side}LowerArm", points, spring, ())

    def _weigh(self, binder: Binder, points: Floats) -> Floats:
        """As the arm, and the sleeve's pouch with its chain."""
        weights = binder.sleeved(points)
        arm = self.anatomy.arm
        for side, sign in (("left", 1.0), ("right", -1.0)):
            q = points * (sign, 1.0, 1.0) - arm.shoulder
            low = smoothstep(-0.040, -0.105, q @ arm.up) * smoothstep(0.6, 0.95, q @ arm.along / self.spec.sleeve_end)
            for joint in ("UpperArm", "LowerArm", "ForearmTwist"):
                column = binder.rig.index[side + joint]
                moved = weights[:, column] * low
                weights[:, column] -= moved
                weights[:, binder.rig.index[f"{side}Sleeve_1"]] += moved
        return weights

    # --- parts -------------------------------------------------------------------------------------------------
    def parts(self, binder: Binder, detail: Detail) -> list[Part]:
        parts = [
            part_of("shirt", "ivory", self._shirt.mesh(detail.triangles(1200)), binder.shirt, 0.8),
            part_of("vest", "vest", self._vest.mesh(detail.triangles(2600)), binder.shirt, 0.9),
        ]
        parts += self._haori_parts(binder, detail) + self._collar_parts(binder, detail) + self._cord(binder, detail)
        if detail.trims:
            parts += self._vest_trims(binder, detail) + self._breast(binder, detail)
        columns = binder.rig.mirrored_columns()
        for name, material, sculpt, count in (
            ("left_sleeve", "vest", self._under, 1500),
            ("left_cuff", "ivory", self._cuff, 700),
        ):
            part = part_of(name, material, sculpt.mesh(detail.triangles(count)), binder.left_sleeve, 0.8)
            parts += [part, part.mirrored(columns)]
        return parts

    def _haori_parts(self, binder: Binder, detail: Detail) -> list[Part]:
        """The haori with its lining in the sleeves, darker hems, and the crest on the back."""
        haori = self._haori.mesh(detail.triangles(12500))

        def weigh(points: Floats) -> Floats:
            return self._weigh(binder, points)

        def along(mesh: Mesh) -> Floats:
            q = _right_half_mirrored(mesh.position)
            off = np.maximum(self._outer_sleeve(q) - self._body(q) + 0.003, 0.0)
            return np.asarray(self.anatomy.arm.distance_along(q) - 6.0 * off)

        q = _right_half_mirrored(haori.position)
        in_sleeve = smooth_max(self._hollow(q) - 0.0035, 0.10 - along(haori), 0.004)
        outside, lining = split_at_level(haori, in_sleeve)
        edge, rest = split_at_level(outside, along(outside) - (self.spec.sleeve_end - 0.016))
        upper, hem = split_at_level(rest, rest.position[:, 1] - (self.spec.hem + 0.018))
        parts = [
            part_of("haori_lining", "lining", lining, weigh, 0.6),
            part_of("haori_sleeve_edge", "haori2", edge, weigh, 1.0),
            part_of("haori_hem", "haori2", hem, weigh, 1.1),
            part_of("haori", "haori", upper, weigh, 1.1),
        ]
        if detail.trims:
            # As on a formal haori: the house's crest on the back, and small ones on the breast.
            parts += self._crest(np.array([0.0, 0.832, -0.14]), self.spec.crest_radius, detail, weigh)
            for sign in (1.0, -1.0):
                at, _ = on_front(self._closed, [0.099 * sign], [0.908], 0.0)
                parts += self._crest(at[0], 0.40 * self.spec.crest_radius, detail, weigh)
        return parts

    def _crest(self, centre: Floats, size: float, detail: Detail, weigh: Weigh) -> list[Part]:
        """A ring around three leaves."""

        def ring(angle: Floats) -> tuple[Floats, Floats]:
            return np.full_like(angle, 0.86 * size), np.full_like(angle, size)

        def leaves(angle: Floats) -> tuple[Floats, Floats]:
            return np.zeros_like(angle), size * (0.20 + 0.50 * np.abs(np.cos(1.5 * (angle - np.pi / 2))) ** 0.8)

        parts = []
        for name, figure in (("crest_ring", ring), ("crest_leaves", leaves)):
            mesh = disc_on(self._closed, centre, figure, detail, 0.0016)
            parts.append(part_of(name, "ivory", mesh, weigh, 0.0, True))
        return parts

    def _collar_parts(self, binder: Binder, detail: Detail) -> list[Part]:
        """The haori's long collar, and the two collars of the kimono crossed under it."""
        path, out = lapel_line(self._closed, self._opening_y, self._opening_x, self.spec.hem)
        pick = np.linspace(0, len(path) - 1, detail.rings(70, 24)).round().astype(int)
        path, out = path[pick], out[pick]
        width = self.spec.collar_width
        parts = [
            part_of("collar", "haori2", loft(path, out, width, 0.0085, detail.sides(12, 6), "band"), binder.coat, 0.9)
        ]
        if detail.trims:
            tangent = np.gradient(path, axis=0)
            across = np.cross(tangent / np.linalg.norm(tangent, axis=1, keepdims=True), out)
            for side in (-0.72, 0.72):
                edge = loft(path + across * side * width + out * 0.0078, out, 0.0016, 0.0012, 4, "round")
                parts.append(part_of("collar_line", "brass", edge, binder.coat, 0.0, True))
        rough = np.array(
            [
                (0.000, 0.997, -0.066),
                (0.042, 0.992, -0.046),
                (0.058, 0.982, -0.004),
                (0.050, 0.957, 0.048),
                (0.026, 0.905, 0.082),
                (-0.004, 0.850, 0.098),
                (-0.024, 0.800, 0.102),
            ]
        )
        for name, material, sign, stand_off, narrow in (
            ("kimono_right", "ivory", -1.0, 0.0075, 1.0),
            ("kimono_left", "ivory", 1.0, 0.0110, 1.0),
            ("under_right", "vest2", -1.0, 0.0125, 0.38),
            ("under_left", "vest2", 1.0, 0.0160, 0.38),
        ):
            line, away = laid_line(
                self.anatomy.trunk, rough * (sign, 1, 1), detail.rings(36, 12), stand_off, free_above=0.955
            )
            shift = 0.0 if narrow == 1.0 else 0.62
            tangent = np.gradient(line, axis=0)
            across = np.cross(tangent / np.linalg.norm(tangent, axis=1, keepdims=True), away)
            inside = np.asarray(line + across * (shift * 0.0165 * sign))
            mesh = loft(inside, away, 0.0165 * narrow, 0.0042, detail.sides(10, 5), "band")
            parts.append(part_of(name, material, mesh, binder.shirt, 0.7))
        return parts

    def _cord(self, binder: Binder, detail: Detail) -> list[Part]:
        """Two cords from the collar meet in a knot; its tassels swing."""
        knot = self._knot[0]
        chain = self.tails[0]
        half = np.interp(_CORD_Y, self._opening_y, self._opening_x)
        start, _ = on_front(self._closed, [half + 0.012], [_CORD_Y + 0.010], 0.012)
        parts = []
        for sign in (1.0, -1.0):
            line = np.linspace(0, 1, detail.rings(12, 5))[:, None]
            path = start * (sign, 1, 1) * (1 - line) + knot * line - np.array([0, 0.014, 0]) * np.sin(np.pi * line)
            path = path + np.array([0, 0, 0.006]) * np.sin(np.pi * line)
            mesh = loft(path, np.tile([0.0, 0.0, 1.0], (len(path), 1)), 0.0046, 0.0046, detail.sides(8, 4), "round")
            parts.append(part_of("cord", "cord", mesh, binder.coat, 0.6))
        ball = knob(knot - (0, 0, 0.010), np.array([0.0, 0.0, 1.0]), 0.012, 0.018, detail)
        parts.append(part_of("cord_knot", "cord", ball, binder.coat, 0.7))
        for x in (-0.010, 0.010):
            t = np.linspace(0, 1, detail.rings(12, 5))
            path = knot + np.stack([x * t, -0.006 - 0.068 * t, 0.004 * np.sin(3 * t)], 1)
            radius = np.interp(t, [0, 0.40, 0.48, 0.56, 0.95, 1.0], [0.0042, 0.0042, 0.0078, 0.0058, 0.0098, 0.0070])
            mesh = loft(path, np.tile([0.0, 0.0, 1.0], (len(path), 1)), radius, radius, detail.sides(10, 5), "round")
            parts.append(Part("tassel", "cord", mesh, binder.along_chain(mesh.position, chain), 0.6))
        return parts

    def _vest_trims(self, binder: Binder, detail: Detail) -> list[Part]:
        """Buttons, the front edge, pocket welts and the watch chain between button and pocket."""
        parts = []

        def line(name: str, material: str, x: Floats, y: Floats, half: float, thick: float, stand: float) -> None:
            path, out = on_front(self._vest_body, x, y, stand)
            mesh = loft(path, out, half, thick, detail.sides(6, 4), "band" if half > thick else "round")
            parts.append(part_of(name, material, mesh, binder.shirt, 0.0, True))

        low, high, half = _NECK_V
        edge_y = np.linspace(low + 0.004, high - 0.02, 14)
        for sign in (1.0, -1.0):
            x = sign * (half * (edge_y - low) / (high - low) + 0.007)
            line("vest_edge", "vest2", x, edge_y, 0.0055, 0.0022, 0.0010)
            across = np.linspace(0.045, 0.082, 6)
            line("vest_welt", "vest2", sign * across, 0.690 + 0.10 * (across - 0.045), 0.0065, 0.0028, 0.0010)
        front = np.linspace(self.spec.vest_hem + 0.004, low, 16)
        line("vest_front", "vest2", np.full(16, 0.011), front, 0.0015, 0.0012, 0.0008)
        for y in _BUTTONS_Y:
            at, out = on_front(self._vest_body, [0.0], [y], 0.0)
            mesh = knob(at[0], out[0], 0.0078, 0.0058, detail)
            parts.append(part_of("vest_button", "brass", mesh, binder.shirt, 0.5, True))
        t = np.linspace(0.0, 1.0, 26)
        sag = _BUTTONS_Y[1] * (1 - t) + 0.694 * t - 0.026 * np.sin(np.pi * t)
        path, out = on_front(self._vest_body, 0.004 + 0.056 * t, sag, 0.005)
        links = 0.0019 + 0.0009 * np.cos(np.arange(26) * np.pi)
        mesh = loft(path, out, links, links, detail.sides(6, 4), "round")
        parts.append(part_of("watch_chain", "brass", mesh, binder.shirt, 0.4, True))
        return parts

    def _breast(self, binder: Binder, detail: Detail) -> list[Part]:
        """The ivory square in the haori's breast pocket: three folded corners over a welt."""
        parts: list[Part] = []
        for corners in (
            ((0.086, 0.844), (0.112, 0.843), (0.101, 0.868), (0.091, 0.884)),
            ((0.094, 0.843), (0.123, 0.842), (0.113, 0.872), (0.104, 0.894)),
            ((0.106, 0.842), (0.129, 0.841), (0.128, 0.866), (0.119, 0.883)),
        ):
            x, y = np.array(corners).T
            rough, _ = on_front(self._closed, x, y, 0.0)
            mesh = patch_on(self._closed, rough, 0.0020 + 0.0012 * len(parts), 0.0022, detail)
            parts.append(part_of("pocket_square", "ivory", mesh, binder.coat, 0.5, True))
        path, out = on_front(self._closed, np.linspace(0.083, 0.131, 8), np.linspace(0.846, 0.841, 8), 0.002)
        welt = loft(path, out, 0.0062, 0.0042, detail.sides(8, 4), "band")
        parts.append(part_of("pocket_welt", "haori2", welt, binder.coat, 0.5, True))
        return parts


def _chain(name: str, parent: str, points: Floats, spring: SpringSpec, colliders: tuple[str, ...]) -> Chain:
    return Chain(name, parent, points, spring.stiffness, spring.drag, spring.gravity, spring.radius, colliders)


def _right_half_mirrored(p: Floats) -> Floats:
    q = p.copy()
    q[:, 0] = np.abs(q[:, 0])
    return q
