"""A toy mender's clothes: striped jumper with a roll neck and pushed-up sleeves, bib and brace, tools and a rag."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from game.tools.modelling.anatomy import Anatomy, joint_at
from game.tools.modelling.fields import (
    Floats,
    cone,
    intersection,
    mirrored,
    plane,
    ring,
    smooth_max,
    smooth_min,
    smoothstep,
    union,
)
from game.tools.modelling.lofts import lathe, loft
from game.tools.modelling.mesh import Mesh, split_at_level
from game.tools.modelling.parts import Detail, Part
from game.tools.modelling.rig import Chain
from game.tools.modelling.spec import SpringSpec
from game.tools.modelling.spec_wear import DungareesSpec
from game.tools.modelling.surface import Sculpt
from game.tools.modelling.trims import knob, laid_band, on_front, part_of, patch_on
from game.tools.modelling.weights import Binder, SleeveFit

__all__ = ["Dungarees"]

_DENIM_M = 0.012
"""How far the denim stands off the jumper."""
_BACK_TOP = 0.845
_RAG = np.array([(0.128, 0.600, 0.070), (0.146, 0.545, 0.094), (0.150, 0.470, 0.098)])


class Dungarees:
    """Fields of jumper and dungarees; ``parts`` takes meshes from them."""

    def __init__(self, spec: DungareesSpec, anatomy: Anatomy, springs: Mapping[str, SpringSpec]) -> None:
        self.spec = spec
        self.anatomy = anatomy
        s, arm = spec, anatomy.arm
        self.sleeve_fit = SleeveFit(s.sleeve[0], s.sleeve[0] + 0.3 * (s.sleeve[1] - s.sleeve[0]), s.jumper, 0.09)
        self._end = arm.upper_m + s.sleeve_end
        self._hip, self._knee = joint_at("leftUpperLeg"), joint_at("leftLowerLeg")
        self._jumper = Sculpt(self._jumper_field, (-0.50, 0.60, -0.24), (0.50, 1.02, 0.26), 0.0048, 5e-3)
        self._collar = Sculpt(self._collar_field, (-0.12, 0.92, -0.12), (0.12, 1.03, 0.13), 0.0036)
        self._cuff = Sculpt(self._cuff_field, (0.18, 0.45, -0.10), (0.46, 0.85, 0.10), 0.0036)
        self._denim = Sculpt(self._denim_field, (-0.26, 0.05, -0.26), (0.26, 0.92, 0.28), 0.0052, 4e-3)
        self._straps = [self._strap_path(sign) for sign in (1.0, -1.0)]
        self.tails = (
            self._strap_chain("leftStrap", 1.0, springs["strap"]),
            self._strap_chain("rightStrap", -1.0, springs["strap"]),
            _chain("rag", "hips", self._rag_line(), springs["rag"]),
        )

    # --- fields ------------------------------------------------------------------------------------------------
    def _knit(self, p: Floats) -> Floats:
        """The jumper's outer face without its ends."""
        q = p.copy()
        q[:, 0] = np.abs(q[:, 0])
        return smooth_min(self._knit_body(p), self._knit_sleeve(q), 0.030)

    def _knit_body(self, p: Floats) -> Floats:
        folds = 0.0022 * np.sin(p[:, 1] * 80 + 9 * np.abs(p[:, 0])) * np.clip((0.80 - p[:, 1]) * 6, 0, 1)
        return np.asarray(self.anatomy.trunk(p) - self.spec.jumper + folds)

    def _knit_sleeve(self, p: Floats) -> Floats:
        arm, (shoulder, elbow, end) = self.anatomy.arm, self.spec.sleeve
        t = arm.distance_along(p)
        tube = union(
            0.03,
            cone(arm.at(-0.03), arm.at(arm.upper_m), shoulder, elbow),
            cone(arm.at(arm.upper_m), arm.at(self._end), elbow, end),
        )(p)
        # Pushed up, the wool gathers in rolls below the elbow.
        rolls = 0.0034 * np.sin((t - self._end) * 165 + 0.8 * np.sin(2 * arm.angle_around(p)))
        tube = tube + rolls * smoothstep(0.10, 0.02, np.abs(t - self._end + 0.035))
        return smooth_max(tube, t - self._end, 0.008)

    def _jumper_field(self, p: Floats) -> Floats:
        d = smooth_max(self._knit(p), p[:, 1] - 0.972, 0.012)
        return smooth_max(d, 0.62 - p[:, 1], 0.01)

    def _collar_field(self, p: Floats) -> Floats:
        level = np.stack([p[:, 0], (p[:, 1] + 0.12 * p[:, 2] - 0.972) / 1.25 + 0.972, p[:, 2]], 1)
        ribs = 0.0013 * np.sin(34 * np.arctan2(p[:, 0], p[:, 2]))
        return np.asarray(ring((0, 0.972, -0.006), 0.066, 0.0185)(level) + ribs)

    def _cuff_field(self, p: Floats) -> Floats:
        arm, end = self.anatomy.arm, self.spec.sleeve[2]
        ribs = 0.0010 * np.sin(22 * arm.angle_around(p))
        roll = intersection(
            0.012,
            cone(arm.at(self._end - 0.04), arm.at(self._end + 0.05), end + 0.003, end - 0.001),
            plane(arm.at(self._end + 0.020), arm.along),
            plane(arm.at(self._end - 0.012), -arm.along),
        )
        return np.asarray(roll(p) + ribs)

    def _denim_body(self, p: Floats) -> Floats:
        # Below the belly the cloth hangs straight.
        hang = 0.016 * np.clip((0.62 - p[:, 1]) / 0.14, 0.0, 1.0)
        return np.asarray(self.anatomy.trunk(p) - self.spec.jumper - _DENIM_M - hang)

    def _denim_region(self, p: Floats) -> Floats:
        """Negative where there is denim: all around up to the waist, bib in front, a tapered bib behind."""
        s = self.spec
        x, y = np.abs(p[:, 0]), p[:, 1]
        front_half = np.interp(y, [s.waist, s.waist + 0.04, s.bib_top], [s.bib[1] + 0.03, s.bib[1], s.bib[0]])
        back_half = np.interp(y, [s.waist, s.waist + 0.05, _BACK_TOP], [s.bib[1] + 0.02, s.bib[1] - 0.01, 0.030])
        front = smooth_max(smooth_max(x - front_half, y - s.bib_top, 0.016), -p[:, 2], 0.01)
        back = smooth_max(smooth_max(x - back_half, y - _BACK_TOP, 0.016), p[:, 2], 0.01)
        return smooth_min(smooth_min(front, back, 0.01), y - s.waist, 0.03)

    def _denim_field(self, p: Floats) -> Floats:
        hem, leg_y = 0.078, self._knee[1]
        foot = np.array([self._knee[0] + 0.006, hem - 0.02, 0.0])
        leg = mirrored(cone(self._hip + (0.004, 0.0, 0.0), foot, 0.084, 0.066))(p)
        hollow = mirrored(cone(self._hip + (0.004, 0.0, 0.0), foot, 0.060, 0.054))(p)
        d = smooth_min(self._denim_body(p), leg, 0.045)
        q = np.abs(p[:, 0])
        creases = 0.0026 * np.sin(p[:, 1] * 85 + 5 * q / 0.06)
        creases = creases * (np.exp(-(((p[:, 1] - leg_y) / 0.05) ** 2)) + np.exp(-(((p[:, 1] - 0.13) / 0.035) ** 2)))
        d = smooth_max(d + creases, self._denim_region(p), 0.006)
        d = smooth_max(d, -smooth_max(hollow, p[:, 1] - (hem + 0.05), 0.01), 0.006)
        inside = smooth_max(self.anatomy.trunk(p) - self.spec.jumper + 0.004, 0.60 - p[:, 1], 0.01)
        return smooth_max(smooth_max(d, -inside, 0.004), hem - p[:, 1], 0.008)

    # --- lines and chains --------------------------------------------------------------------------------------
    def _strap_path(self, sign: float) -> Floats:
        front, top = self.spec.strap_x
        return np.array(
            [
                (front, self.spec.bib_top - 0.020, 0.16),
                (front + 0.002, self.spec.bib_top + 0.03, 0.13),
                (top, 0.945, 0.075),
                (top + 0.002, 0.985, 0.0),
                (top - 0.012, 0.945, -0.085),
                (0.030, 0.885, -0.13),
                (0.010, _BACK_TOP - 0.02, -0.14),
            ]
        ) * (sign, 1.0, 1.0)

    def _buckle_at(self, sign: float) -> tuple[Floats, Floats]:
        at, out = on_front(self._denim_body, [sign * self.spec.strap_x[0]], [self.spec.bib_top - 0.022], 0.006)
        return at[0], out[0]

    def _strap_chain(self, name: str, sign: float, spring: SpringSpec) -> Chain:
        at, out = self._buckle_at(sign)
        points = np.vstack([at + out * 0.004, at + out * 0.010 + (sign * 0.006, -0.050, 0.0)])
        return _chain(name, "chest", points, spring)

    def _rag_line(self) -> Floats:
        line = _RAG.copy()
        line[0] = on_front(self._denim_body, _RAG[:1, 0], _RAG[:1, 1], 0.008)[0][0]
        line[1:] += line[0] - _RAG[0]
        return line

    # --- parts -------------------------------------------------------------------------------------------------
    def _weigh(self, binder: Binder, points: Floats) -> Floats:
        """Denim: legs below, trunk above, as the jumper under it at the shoulders."""
        above = smoothstep(0.50, 0.61, points[:, 1])[:, None]
        return np.asarray(binder.legs(points) * (1 - above) + binder.sleeved(points) * above)

    def parts(self, binder: Binder, detail: Detail) -> list[Part]:
        parts = self._jumper_parts(binder, detail) + self._denim_parts(binder, detail)
        parts += self._strap_parts(binder, detail)
        if detail.trims:
            parts += self._pocket_parts(binder, detail)
        rag = self._rag_mesh(detail)
        parts.append(Part("rag", "rag", rag, binder.along_chain(rag.position, self.tails[2]), 0.8))
        return parts

    def _jumper_parts(self, binder: Binder, detail: Detail) -> list[Part]:
        """Stripes cut along level sets: by height on the body, by distance from the shoulder on the sleeves."""
        rest = self._jumper.mesh(detail.triangles(8200))
        parts = [part_of("collar", "jumper", self._collar.mesh(detail.triangles(1700)), binder.collar, 0.8)]
        half = self.spec.stripe / 2
        for k in range(round(0.42 / half), -1, -1):
            # From the neck downward; what lies below the lowest border is one more stripe.
            stripe, rest = split_at_level(rest, self._down(rest.position) - (0.55 + k * half)) if k else (rest, rest)
            if len(stripe.triangle):
                material = "jumper2" if k % 2 else "jumper"
                parts.append(part_of(f"jumper_{k}", material, stripe, binder.sleeved, 0.9))
        cuff = part_of("left_cuff", "jumper", self._cuff.mesh(detail.triangles(900)), binder.left_sleeve, 0.8)
        return [*parts, cuff, cuff.mirrored(binder.rig.mirrored_columns())]

    def _down(self, points: Floats) -> Floats:
        """What the stripes follow: height on the body, and on the sleeves as much less as they are down the arm."""
        q = points.copy()
        q[:, 0] = np.abs(q[:, 0])
        on_sleeve = 1.0 / (1.0 + np.exp(np.clip((self._knit_sleeve(q) - self._knit_body(q)) / 0.007, -40, 40)))
        return np.asarray(q[:, 1] * (1 - on_sleeve) + (0.905 - self.anatomy.arm.distance_along(q)) * on_sleeve)

    def _denim_parts(self, binder: Binder, detail: Detail) -> list[Part]:
        denim = self._denim.mesh(detail.triangles(9000))

        def weigh(points: Floats) -> Floats:
            return self._weigh(binder, points)

        turn_up, rest = split_at_level(denim, 0.108 - denim.position[:, 1])
        parts = [part_of("dungarees", "denim", rest, weigh, 1.1), part_of("turn_up", "denim2", turn_up, weigh, 1.0)]
        if detail.trims:
            s = self.spec
            x = np.linspace(-s.bib[0] + 0.008, s.bib[0] - 0.008, 20)
            half = s.bib[1] + 0.012
            for name, xs, y in (
                ("bib_seam", x, s.bib_top - 0.010),
                ("waist_seam", np.linspace(-half, half, 26), s.waist + 0.006),
                ("waist_seam", np.linspace(-half - 0.01, half + 0.01, 26), s.waist - 0.014),
            ):
                path, out = on_front(self._denim_body, xs, np.full(len(xs), y), 0.0006)
                mesh = loft(path, out, 0.0016, 0.0014, 4, "round")
                parts.append(part_of(name, "stitch", mesh, weigh, 0.0, True))
        return parts

    def _strap_parts(self, binder: Binder, detail: Detail) -> list[Part]:
        parts = []
        for k, sign in enumerate((1.0, -1.0)):
            rings = detail.rings(44, 16)
            mesh = laid_band(
                self._over_all, self._straps[k], 0.0045, self.spec.strap_width, 0.0050, rings, detail.sides(10, 5)
            )
            parts.append(part_of("strap", "denim", mesh, binder.sleeved, 0.9))
            at, out = self._buckle_at(sign)
            knob_mesh = knob(at + out * 0.001, out, 0.0125, 0.0085, detail)
            parts.append(part_of("strap_button", "brass", knob_mesh, binder.sleeved, 0.6))
            chain = self.tails[k]
            t = np.linspace(0, 1, detail.rings(9, 4))[:, None]
            path = chain.points[0] * (1 - t) + chain.points[1] * t
            tab = loft(path, np.tile(out, (len(path), 1)), 0.0095, 0.0030, detail.sides(8, 4), "band")
            parts.append(Part("strap_end", "denim2", tab, binder.along_chain(tab.position, chain), 0.7))
        return parts

    def _over_all(self, p: Floats) -> Floats:
        """Jumper and denim together: what the straps lie on."""
        return smooth_min(self._knit(p), smooth_max(self._denim_body(p), self._denim_region(p), 0.01), 0.02)

    def _pocket_parts(self, binder: Binder, detail: Detail) -> list[Part]:
        """The bib pocket with its stitches, a screwdriver in it, and two slanted hip pockets."""

        def weigh(points: Floats) -> Floats:
            return self._weigh(binder, points)

        top, half = self.spec.bib_top - 0.040, 0.048
        corners = np.array([(-half, top), (half, top), (half * 0.84, top - 0.066), (-half * 0.84, top - 0.066)])
        rough, _ = on_front(self._denim_body, corners[:, 0], corners[:, 1], 0.0)
        parts = [
            part_of("bib_pocket", "denim2", patch_on(self._denim_body, rough, 0.0012, 0.0032, detail), weigh, 0.7, True)
        ]
        path, out = on_front(
            self._denim_body, np.linspace(-half + 0.005, half - 0.005, 14), np.full(14, top - 0.011), 0.0050
        )
        parts.append(part_of("pocket_seam", "stitch", loft(path, out, 0.0015, 0.0014, 4, "round"), weigh, 0.0, True))
        for sign in (1.0, -1.0):
            x = np.linspace(0.085, 0.125, 8)
            path, out = on_front(self._denim_body, sign * x, self.spec.waist - 0.035 - 1.1 * (x - 0.085), 0.002)
            welt = loft(path, out, 0.0060, 0.0040, detail.sides(8, 4), "band")
            parts.append(part_of("hip_pocket", "denim2", welt, weigh, 0.5, True))
        foot, out = on_front(self._denim_body, [-0.024], [top - 0.006], 0.005)
        profile = [
            (0.0, 0.0),
            (0.0085, 0.0),
            (0.0085, 0.012),
            (0.0062, 0.017),
            (0.0092, 0.026),
            (0.0088, 0.040),
            (0.0, 0.045),
        ]
        handle = lathe(profile, detail.sides(16, 6)).placed(foot[0])
        parts.append(part_of("screwdriver", "rag", handle, weigh, 0.6, True))
        return parts

    def _rag_mesh(self, detail: Detail) -> Mesh:
        line = self.tails[2].points
        t = np.linspace(0, 1, detail.rings(16, 6))
        path = np.stack([np.interp(t, [0, 0.45, 1], line[:, axis]) for axis in range(3)], 1)
        path = path + np.stack([0.006 * np.sin(7 * t), np.zeros_like(t), 0.004 * np.cos(6 * t)], 1)
        width = np.interp(t, [0, 0.12, 0.5, 0.85, 1], [0.016, 0.026, 0.034, 0.040, 0.006])
        out = np.tile([0.75, 0.0, 0.66], (len(t), 1)) + np.stack([0 * t, 0 * t, 0.4 * np.sin(5 * t)], 1)
        return loft(path, out, width, 0.007, detail.sides(12, 6), "lens")


def _chain(name: str, parent: str, points: Floats, spring: SpringSpec) -> Chain:
    return Chain(name, parent, points, spring.stiffness, spring.drag, spring.gravity, spring.radius, ())
