"""Everything static the planner looks up, laid out layer by layer in blocks of equal width."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput
from game.embos.config import PlannerConfig
from game.embos.library import UnitLibrary
from game.embos.scores import continuity

__all__ = ["CHUNK", "PlannerTables", "build_tables"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

CHUNK = 256
"""Characters computed together: enough to hide the calls, few enough for the cache."""

_PLACE_BITS = 10
_STEP = 2.0**-40
"""Differences d closer than this are equal in rank (as in scores.ranks, 1e-12)."""


@dataclass(frozen=True, eq=False)
class PlannerTables:
    """L layers of M slots each (slot = l·M + place in the layer; P = L·M slots), some of them empty.

    unit: (P,) index into library.units, −1 where empty. real: (P,) bool, a unit that is not rest. rest: (P,) bool.
    follow: (P + 1, M) ω_c from a slot to its layer's slots; row P is "nothing ran yet". blocks: by layer (P + 1, M) ω_l
    of its slots below a running slot. intensity, exists: (P, 7); *_t: transposed. timing_s:
    (P, 3, 7) L_d, L_w and seconds from start to stroke. sigma: (P, 1) of the random factors' logarithm.
    constant_state: (P,) φ_state of rest slots, 0 elsewhere, −1 in empty ones. gesture_slots: (G,) consecutive
    slots of the gestures proper, gestures: the same as a slice. count: (L, 1) units that take part in the ranking;
    not_real, place: (P,) for it. minimum: (P,) φ_time while waiting; reach: (L,) the share of a score that a unit's own
    must have while it waits to come up to it afterwards. least_s: (P,). settled: slots whose
    units count as having run before. initial: (L,) slots.
    """

    layers: tuple[str, ...]
    width: int
    unit: Ints
    real: NDArray[np.bool_]
    rest: NDArray[np.bool_]
    follow: Floats
    blocks: tuple[Floats, ...]
    intensity: Floats
    exists: Floats
    intensity_t: Floats
    exists_t: Floats
    not_real: NDArray[np.int64]
    place: NDArray[np.int64]
    timing_s: Floats
    sigma: Floats
    constant_state: Floats
    gesture_slots: Ints
    gestures: slice
    gesture_layer: int
    count: Floats
    least_s: Floats
    minimum: Floats
    reach: Floats
    settled: Ints
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

        scores.phi_state layer by layer, times the presence (scores.presence) of units in mixed emotions.
        """
        pieces = [self._phi_state(emotion[i : i + CHUNK]) for i in range(0, len(emotion), CHUNK)]
        return pieces[0] if len(pieces) == 1 else np.concatenate(pieces)

    def _phi_state(self, emotion: Floats) -> Floats:
        felt = emotion[:, :, None]
        total = np.maximum(emotion.sum(axis=1), 1e-12)[:, None]
        # (R, 7, P) keeps the long axis innermost. einsum adds the seven in order for any R, so that a character
        # gets the same bits alone and in a crowd; a matrix product would not promise that.
        apart = felt - self.intensity_t
        np.abs(apart, out=apart)
        d = np.einsum("rk,rkp->rp", emotion, apart)
        d /= total
        share = _rank_share(d, self)
        if self.presence > 0.0:
            shown = np.einsum("rk,kp->rp", emotion, self.exists_t)
            shown *= self.presence / total
            shown += 1.0 - self.presence
            share *= shown
        return np.where(self.real, share, self.constant_state)


def _rank_share(d: Floats, tables: PlannerTables) -> Floats:
    """scores.rank_share per layer for (R, P), empty and rest slots last: one integer sort instead of an argsort."""
    rows, width = len(d), tables.width
    # Rounded, not cut: values such as ½ are whole steps, and noise must not push them below.
    level = (np.minimum(d, 1.0) * (1.0 / _STEP) + 0.5).astype(np.int64)
    level += tables.not_real  # beyond every real unit
    packed = ((level << _PLACE_BITS) | tables.place).reshape(rows, -1, width)
    packed.sort(axis=-1)
    level = packed >> _PLACE_BITS
    rank = np.zeros(packed.shape, dtype=np.intp)
    np.multiply(level[..., 1:] > level[..., :-1], np.arange(1, width), out=rank[..., 1:])
    np.maximum.accumulate(rank, axis=-1, out=rank)
    share = np.empty(d.size)
    place = (packed & ((1 << _PLACE_BITS) - 1)) + np.arange(0, d.size, width).reshape(rows, -1, 1)
    share[place.ravel()] = (1.0 - rank / tables.count).ravel()
    near = 1.0 - d
    near *= share.reshape(rows, -1)
    return near


def build_tables(library: UnitLibrary, config: PlannerConfig) -> PlannerTables:
    """Lay a library out for a planner. -> tables whose arrays are read-only.

    Raises BadInput for more than 1024 units in a layer.
    """
    by_layer = [library.of_layer(layer) for layer in config.layers]
    width = max(len(units) for units in by_layer)
    if width > 1 << _PLACE_BITS:
        raise BadInput("units", expected=f"at most {1 << _PLACE_BITS} in a layer", seen=width)
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
        blocks=tuple(blocks[:, at * width : (at + 1) * width].copy() for at in range(layers)),
        intensity=intensity,
        exists=exists,
        intensity_t=np.ascontiguousarray(intensity.T),
        exists_t=np.ascontiguousarray(exists.T),
        not_real=np.where(real, 0, int(4.0 / _STEP)).astype(np.int64),
        place=np.tile(np.arange(width, dtype=np.int64), layers),
        timing_s=np.where(used[:, None, None], timing_s[unit], 0.0),
        sigma=np.sqrt(np.log1p((np.where(used, library.duration_cv[unit], 0.0) * config.spread) ** 2))[:, None],
        constant_state=np.where(rest, threshold, np.where(used, 0.0, -1.0)),
        gesture_slots=gestures,
        gestures=slice(int(gestures[0]), int(gestures[-1]) + 1) if len(gestures) else slice(0, 0),
        gesture_layer=config.layers.index("gesture"),
        count=real.reshape(layers, width).sum(axis=1, keepdims=True).clip(1).astype(np.float64),
        least_s=np.where(real, least_s, 0.0),
        minimum=np.array([config.minimum[layer] for layer in config.layers]).repeat(width),
        # A little less, so that rounding never hides a unit.
        reach=np.array([min(config.minimum[layer] / max(config.steady, 1e-300), 1.0) for layer in config.layers])
        * (1 - 1e-9),
        settled=np.flatnonzero(real & np.repeat([layer in config.settled for layer in config.layers], width)),
        initial=initial,
        presence=config.presence,
    )
    for value in (*vars(tables).values(), *tables.blocks):
        if isinstance(value, np.ndarray):
            value.setflags(write=False)
    return tables
