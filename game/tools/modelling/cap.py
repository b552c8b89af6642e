"""A small soft cap: eight panels, a band, a button and a peak, rigid to the head."""

from __future__ import annotations

import numpy as np

from game.tools.modelling.fields import Floats, smooth_max, smooth_min, sphere
from game.tools.modelling.parts import Detail, Part
from game.tools.modelling.spec_wear import CapSpec
from game.tools.modelling.surface import Sculpt
from game.tools.modelling.weights import Binder

__all__ = ["Cap"]

_PANELS = 8


class Cap:
    """Fields in the cap's own frame: y up through the button, z toward the peak."""

    def __init__(self, spec: CapSpec, head_centre: Floats) -> None:
        self.spec = spec
        self._at = head_centre + spec.at
        back, left = np.radians(spec.tilt_deg)
        about_x = np.array([[1, 0, 0], [0, np.cos(back), np.sin(back)], [0, -np.sin(back), np.cos(back)]])
        about_z = np.array([[np.cos(left), np.sin(left), 0], [-np.sin(left), np.cos(left), 0], [0, 0, 1]])
        self.turn = about_z @ about_x
        reach = max(spec.radii) + spec.peak[0] + 0.03
        box = (self._at - (reach, 0.12, reach), self._at + (reach, 0.16, reach))
        self.crown = Sculpt(self._crown_field, *box, 0.0042, 2e-3, stepwise=True)
        self._band = Sculpt(self._band_field, *box, 0.0036, stepwise=True)
        self._peak = Sculpt(self._peak_field, *box, 0.0032, stepwise=True)

    def _local(self, p: Floats) -> Floats:
        return np.asarray((p - self._at) @ self.turn)

    def _crown_field(self, p: Floats) -> Floats:
        q, (rx, ry, rz) = self._local(p), self.spec.radii
        # Full above, drawn in to the band below: the square of the height makes the soft overhang.
        swell = np.hypot(q[:, 0] / rx, q[:, 2] / rz)
        k0 = np.sqrt(swell**2 + (q[:, 1] / ry) ** 2)
        d = (k0 - 1.0) * min(rx, ry, rz)
        azimuth = np.arctan2(q[:, 0], q[:, 2])
        d = d - 0.0030 * np.abs(np.cos(azimuth * _PANELS / 2)) ** 0.6 * np.clip(swell * 2, 0, 1)
        d = smooth_max(d, -q[:, 1] - 0.25 * ry, 0.022)
        button = sphere((0.0, ry * 1.02, 0.0), 0.013)(q * (1.0, 1.4, 1.0))
        return smooth_min(d, button, 0.006)

    def _band_field(self, p: Floats) -> Floats:
        q, (rx, _, rz) = self._local(p), self.spec.radii
        ax, az = 0.86 * rx, 0.88 * rz
        d = (np.hypot(q[:, 0] / ax, q[:, 2] / az) - 1.0) * min(ax, az)
        half = self.spec.band / 2
        return smooth_max(d, np.abs(q[:, 1] + 0.25 * self.spec.radii[1] + half * 0.6) - half, 0.008)

    def _peak_field(self, p: Floats) -> Floats:
        q, (_, ry, rz) = self._local(p), self.spec.radii
        length, half_width, thick = self.spec.peak
        root = 0.72 * rz
        z = q[:, 2] - root
        outline = (np.hypot(q[:, 0] / half_width, z / (length + 0.16 * rz)) - 1.0) * length
        droop = 0.14 * np.clip(z, 0.0, 0.2) + 3.2 * q[:, 0] ** 2
        sheet = np.abs(q[:, 1] + 0.25 * ry + 0.8 * self.spec.band * 0.6 + droop) - thick
        return smooth_max(smooth_max(outline, sheet, 0.006), -z - 0.02, 0.01)

    def parts(self, binder: Binder, detail: Detail) -> list[Part]:
        rows = (("cap", self.crown, 2600), ("cap_band", self._band, 900), ("cap_peak", self._peak, 1100))
        parts = []
        for name, sculpt, count in rows:
            mesh = sculpt.mesh(detail.triangles(count))
            material = "cap" if name == "cap" else "cap_band"
            parts.append(Part(name, material, mesh, binder.rigid(mesh.position, "head"), 0.9))
        return parts
