"""The compiled loops that judge characters by eq. 1 (``plan/*.c``), and the static tables in their memory."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.compiled import Block, Machine
from game.embos.config import PlannerConfig
from game.embos.draws import NORMAL, SHARE
from game.embos.planner_state import CharacterKind, Factors, Habit, PlannerSignal, PlannerState
from game.embos.tables import PlannerTables

__all__ = ["Judge"]

Ints = NDArray[np.intp]

FACTORS = ("continuity", "linkage", "time", "state", "score")
"""enum Factor of plan.h."""
_CALL = "dddIIIIIIIIIIII"
"""struct Call of ticks.c."""


class Judge:
    """Eq. 1 for one library and one configuration; for one thread at a time."""

    def __init__(self, tables: PlannerTables, config: PlannerConfig) -> None:
        machine = Machine(Path(__file__).with_name("plan.wasm"))
        self._machine = machine
        self.kind = CharacterKind.of(machine, tables.slots, tables.gestures.stop - tables.gestures.start)
        self._factors = _factors_type(tables)
        self._kept: list[Block] = []
        self._tables = self._keep(np.frombuffer(self._packed(tables, config).tobytes(), dtype=np.uint8))
        self._scratch = machine.block(1, self._factors)
        self._soonest_s, self._started = machine.block(1, np.float64), machine.block(1, np.uint32)
        self._signal = machine.block((0, 7 + self.kind.gestures), np.float64)
        self._slots = machine.block(0, np.int32)
        self._advance, self._judge, self._weigh = (
            machine.function(name, _CALL) for name in ("advance", "judge", "weigh")
        )

    def _keep(self, array: NDArray[Any]) -> int:
        """The address of an array that stays as long as this does."""
        self._kept.append(self._machine.kept(array, array.dtype))
        return self._kept[-1].address

    def _packed(self, t: PlannerTables, config: PlannerConfig) -> NDArray[Any]:
        """struct Tables of plan.h."""
        numbers: dict[str, Any] = {
            "steady": config.steady, "look_s": config.look_s, "eager": config.eager, "presence": config.presence,
            "radius": config.radius, "tolerance": config.tolerance, "reach": t.reach,
        }  # fmt: skip
        counts = {
            "count": t.count, "width": t.width, "slots": t.slots, "gestures": self.kind.gestures,
            "first_gesture": t.gestures.start, "gesture_layer": t.gesture_layer, "settled_count": len(t.settled),
            "quantiles": len(NORMAL), "character_bytes": self.kind.record.itemsize,
        }  # fmt: skip
        arrays = (
            t.intensity, t.exists, t.intensity.T, t.exists.T, t.timing_s, t.sigma, t.constant_state, t.least_s,
            t.minimum, t.follow, t.blocks, NORMAL, SHARE, t.unit.astype(np.int64), t.real, t.settled.astype(np.int32),
        )  # fmt: skip
        kind = np.dtype(
            [(name, "<f8", np.shape(value)) for name, value in numbers.items()]
            + [(name, "<i4", np.shape(value)) for name, value in counts.items()]
            + [("arrays", "<u4", len(arrays))]
        )
        packed = np.zeros((), dtype=kind)
        for name, value in (numbers | counts).items():
            packed[name] = value
        packed["arrays"] = [self._keep(np.ascontiguousarray(array)) for array in arrays]
        return packed

    def advance(self, state: PlannerState, signal: PlannerSignal, dt_s: float) -> PlannerState:
        """One tick of all, whose one time the signal has; the state's own records are written to."""
        self._call(self._advance, state, signal, dt_s)
        return self._after(state)

    def judge(self, state: PlannerState, rows: Ints, signal: PlannerSignal, dt_s: float) -> PlannerState:
        """Eq. 1 for the characters ``rows`` (R,) at times of their own; their records are written to."""
        self._call(self._judge, state, signal, dt_s, rows)
        return self._after(state)

    def weigh(self, state: PlannerState, signal: PlannerSignal, dt_s: float) -> Factors:
        """The factors of all in their ticks. Notes their emotions, which settles whoever begins; begins nothing."""
        block = self._machine.block(len(state), self._factors)
        self._call(self._weigh, state, signal, dt_s, np.arange(len(state)), block)
        return Factors(**{name: block.data[name] for name in (*FACTORS, "chosen", "within")})

    def _after(self, state: PlannerState) -> PlannerState:
        return PlannerState(state.characters, float(self._soonest_s.data[0]), bool(self._started.data[0]))

    def _call(
        self,
        function: Any,
        state: PlannerState,
        signal: PlannerSignal,
        dt_s: float,
        rows: Ints | None = None,
        factors: Block | None = None,
    ) -> None:
        judged, habit = len(signal.emotion), signal.habit
        given = self._given(judged)
        given.data[:, :7], given.data[:, 7:] = signal.emotion, signal.words
        time_s = 0.0 if rows is not None else float(signal.time_s)
        who = times = None
        if rows is not None:
            who = self._machine.kept(rows, np.int64)
            times = self._machine.kept(np.full(judged, signal.time_s), np.float64)
        slots = None if habit is None else self._habit(habit)
        function(
            time_s, dt_s, 0.0 if habit is None else habit.share,
            0 if habit is None else len(habit.slots), slots.address if slots else 0,
            self._tables, state.characters.block.address, len(state), given.address, (factors or self._scratch).address,
            self._soonest_s.address, self._started.address,
            who.address if who else 0, judged, times.address if times else 0,
        )  # fmt: skip

    def _given(self, count: int) -> Block:
        """Room for the signal of so many."""
        if len(self._signal.data) != count:
            self._signal = self._machine.block((count, 7 + self.kind.gestures), np.float64)
        return self._signal

    def _habit(self, habit: Habit) -> Block:
        if not np.array_equal(self._slots.data, habit.slots):
            self._slots = self._machine.kept(habit.slots, np.int32)
        return self._slots


def _factors_type(t: PlannerTables) -> np.dtype[Any]:
    """struct Factors of plan.h and what follows it."""
    layers, shape = len(t.layers), (len(t.layers), t.width)
    return np.dtype(
        [("chosen", "<i8", layers), ("within", "?", layers), ("beaten", "?", layers), ("unused", "u1", 2)]
        + [(name, "<f8", shape) for name in FACTORS]
    )
