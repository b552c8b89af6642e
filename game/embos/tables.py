"""Everything static the planner looks up, laid out layer by layer in blocks of equal width."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput
from game.embos.config import PlannerConfig
from game.embos.library import UnitLibrary
from game.embos.scores import continuity

__all__ = ["PlannerTables", "build_tables"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

MOST_UNITS = 1024
"""In a layer (plan.h)."""
_ROUNDING_S = 1e-6


@dataclass(frozen=True, eq=False)
class PlannerTables:
    """L layers of M slots each (slot = l·M + place in the layer; P = L·M slots), some of them empty.

    unit: (P,) index into library.units, −1 where empty. real: (P,) bool, a unit that is not rest. rest: (P,) bool.
    follow: (P + 1, M) ω_c from a slot to its layer's slots; row P is "nothing ran yet". blocks: (L, P + 1, M) ω_l of a
    layer's slots below a running slot. intensity, exists: (P, 7). timing_s: (P, 3, 7) L_d, L_w and seconds from start
    to stroke. sigma: (P,) of the random factors' logarithm. constant_state: (P,) φ_state of rest slots, 0 elsewhere,
    −1 in empty ones. gestures: consecutive slots of the gestures proper; leads_s: (G, 2) least and most seconds from
    start to stroke of each, whatever is felt, and a little more. count: (L,) units that take part in the
    ranking; places: (P,) where they stand in their layers, those first. minimum: (P,) φ_time while waiting; reach:
    (L,) the share of a score that a unit's own must have while it waits to come up to it afterwards. least_s: (P,).
    settled: slots whose units count as having run before. initial: (L,) slots.
    """

    layers: tuple[str, ...]
    width: int
    unit: Ints
    real: NDArray[np.bool_]
    rest: NDArray[np.bool_]
    follow: Floats
    blocks: Floats
    intensity: Floats
    exists: Floats
    timing_s: Floats
    sigma: Floats
    constant_state: Floats
    leads_s: Floats
    gestures: slice
    gesture_layer: int
    count: Ints
    places: Ints
    least_s: Floats
    minimum: Floats
    reach: Floats
    settled: Ints
    initial: Ints

    @property
    def slots(self) -> int:
        """P."""
        return len(self.unit)

    def slot_of(self, unit: int) -> int:
        """The slot of a unit of the library."""
        return int(np.flatnonzero(self.unit == unit)[0])


def build_tables(library: UnitLibrary, config: PlannerConfig) -> PlannerTables:
    """Lay a library out for a planner. -> tables whose arrays are read-only.

    Raises BadInput for more than 1024 units in a layer.
    """
    by_layer = [library.of_layer(layer) for layer in config.layers]
    width = max(len(units) for units in by_layer)
    if width > MOST_UNITS:
        raise BadInput("units", expected=f"at most {MOST_UNITS} in a layer", seen=width)
    layers, slots = len(by_layer), len(by_layer) * width
    unit = np.full(slots, -1, dtype=np.intp)
    follow = np.ones((slots + 1, width))
    for row, units in enumerate(by_layer):
        begin, n = row * width, len(units)
        unit[begin : begin + n] = units
        follow[begin : begin + n, :n] = continuity(
            library.transition_counts(config.layers[row]),
            library.pose_distance(config.layers[row]),
            floor=config.continuity_floor,
            transition_share=config.transition_share,
            sigma=config.sigma_rad,
        )
    used = unit >= 0
    blocks = np.ones((slots + 1, slots))
    blocks[np.ix_(np.flatnonzero(used), np.flatnonzero(used))] = library.link_matrix()[np.ix_(unit[used], unit[used])]
    rest = used & library.is_rest[unit]
    threshold = np.array([config.rest.get(layer, 0.0) for layer in config.layers]).repeat(width)
    initial = np.array(
        [next((row * width + j for j in range(width) if rest[row * width + j]), slots) for row in range(layers)],
        dtype=np.intp,
    )
    real = used & ~rest
    strokes_s = np.where(
        (np.array([u.layer for u in library.units]) == "gesture")[:, None], library.stroke_offset_s, 0.0
    )
    timing_s = np.stack([library.duration_s, library.waiting_s, strokes_s], axis=1)
    least_s = np.array([config.least_s.get(layer, 0.0) for layer in config.layers]).repeat(width)
    gestures = np.flatnonzero(real & np.isin(unit, library.gestures))
    intensity = np.where(used[:, None], library.intensity[unit], 0.0)
    exists = np.where(used[:, None], library.exists[unit], False).astype(np.float64)
    tables = PlannerTables(
        layers=config.layers,
        width=width,
        unit=unit,
        real=real,
        rest=rest,
        follow=follow,
        blocks=np.ascontiguousarray(blocks.reshape(slots + 1, layers, width).swapaxes(0, 1)),
        intensity=intensity,
        exists=exists,
        timing_s=np.where(used[:, None, None], timing_s[unit], 0.0),
        sigma=np.sqrt(np.log1p((np.where(used, library.duration_cv[unit], 0.0) * config.spread) ** 2)),
        constant_state=np.where(rest, threshold, np.where(used, 0.0, -1.0)),
        leads_s=_leads_s(library),
        gestures=slice(int(gestures[0]), int(gestures[-1]) + 1) if len(gestures) else slice(0, 0),
        gesture_layer=config.layers.index("gesture"),
        places=np.argsort(~real.reshape(layers, width), axis=1, kind="stable").reshape(-1),
        count=real.reshape(layers, width).sum(axis=1),
        least_s=np.where(real, least_s, 0.0),
        minimum=np.array([config.minimum[layer] for layer in config.layers]).repeat(width),
        # A little less, so that rounding never hides a unit.
        reach=np.array([min(config.minimum[layer] / max(config.steady, 1e-300), 1.0) for layer in config.layers])
        * (1 - 1e-9),
        settled=np.flatnonzero(real & np.repeat([layer in config.settled for layer in config.layers], width)),
        initial=initial,
    )
    for value in vars(tables).values():
        if isinstance(value, np.ndarray):
            value.setflags(write=False)
    return tables


def _leads_s(library: UnitLibrary) -> Floats:
    known, offset_s = library.exists[library.gestures], library.stroke_offset_s[library.gestures]
    least = np.where(known, offset_s, np.inf).min(axis=1)
    most = np.where(known, offset_s, -np.inf).max(axis=1)
    some = known.any(axis=1)
    return np.stack([np.where(some, least, 0.0) - _ROUNDING_S, np.where(some, most, 0.0) + _ROUNDING_S], axis=1)
