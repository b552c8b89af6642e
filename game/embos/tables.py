"""Everything static the planner looks up, laid out layer by layer in blocks of equal width."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.embos.config import PlannerConfig
from game.embos.library import UnitLibrary
from game.embos.scores import continuity, difference, presence, rank_share

__all__ = ["PlannerTables", "build_tables"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class PlannerTables:
    """L layers of M slots each (slot = l·M + place in the layer; P = L·M slots), some of them empty.

    unit: (P,) index into library.units, −1 where empty. real: (P,) bool, a unit that is not rest. rest: (P,) bool.
    follow: (P + 1, M) ω_c from a slot to its layer's slots; row P is "nothing ran yet". blocks: (P + 1, L, M) ω_l
    of every slot below a running slot. intensity, exists, duration_s, waiting_s: (P, 7); cv: (P,).
    constant_state: (P,) φ_state of rest slots, 0 elsewhere, −1 in empty ones. gesture: (P,) column of the word
    factor, −1 elsewhere. count: (L, 1) units that take part in the ranking. least_s: (L,).
    minimum: (P,) φ_time while waiting.
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
    duration_s: Floats
    waiting_s: Floats
    cv: Floats
    constant_state: Floats
    gesture_slots: Ints
    gesture_layer: int
    count: Floats
    least_s: Floats
    minimum: Floats
    initial: Ints
    presence: float

    @property
    def slots(self) -> int:
        """P."""
        return len(self.unit)

    def slot_of(self, unit: int) -> int:
        """The slot of a unit of the library."""
        return int(np.flatnonzero(self.unit == unit)[0])

    def phi_state(self, emotion: Floats) -> Floats:
        """(R, 7) -> (R, P): φ_state without words; rest slots at their threshold, empty slots −1.

        Units never shown in what is felt are held back by their presence (see scores.presence).
        """
        rows = len(emotion)
        d = difference(emotion, self.intensity)
        d[:, ~self.real] = np.inf
        d = d.reshape(rows, len(self.layers), self.width)
        phi = rank_share(d, self.count).reshape(rows, self.slots)
        if self.presence > 0.0:
            phi *= (1.0 - self.presence) + self.presence * presence(emotion, self.exists)
        return np.where(self.real, phi, self.constant_state)


def build_tables(library: UnitLibrary, config: PlannerConfig) -> PlannerTables:
    """Lay a library out for a planner. -> tables whose arrays are read-only."""
    by_layer = [library.of_layer(layer) for layer in config.layers]
    width = max(len(units) for units in by_layer)
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
    tables = PlannerTables(
        layers=config.layers,
        width=width,
        unit=unit,
        real=real,
        rest=rest,
        follow=follow,
        blocks=blocks.reshape(slots + 1, layers, width),
        intensity=np.where(used[:, None], library.intensity[unit], 0.0),
        exists=np.where(used[:, None], library.exists[unit], False).astype(np.float64),
        duration_s=np.where(used[:, None], library.duration_s[unit], 0.0),
        waiting_s=np.where(used[:, None], library.waiting_s[unit], 0.0),
        cv=np.where(used, library.duration_cv[unit], 0.0),
        constant_state=np.where(rest, threshold, np.where(used, 0.0, -1.0)),
        gesture_slots=np.flatnonzero(real & np.isin(unit, library.gestures)),
        gesture_layer=config.layers.index("gesture"),
        count=real.reshape(layers, width).sum(axis=1, keepdims=True).clip(1).astype(np.float64),
        least_s=np.array([config.least_s.get(layer, 0.0) for layer in config.layers]),
        minimum=np.array([config.minimum[layer] for layer in config.layers]).repeat(width),
        initial=initial,
        presence=config.presence,
    )
    for value in vars(tables).values():
        if isinstance(value, np.ndarray):
            value.setflags(write=False)
    return tables
