"""The compiled loops that judge characters by eq. 1 (``plan/*.c``), and the static tables in their memory."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.compiled import Block, Machine
from game.embos.config import PlannerConfig
from game.embos.draws import NORMAL, SHARE
from game.embos.mixing import RADIUS
from game.embos.planner_state import (
    CharacterKind,
    Course,
    Decisions,
    Factors,
    Habit,
    PlannerSignal,
    PlannerState,
    Told,
)
from game.embos.tables import PlannerTables

__all__ = ["Judge"]

Ints = NDArray[np.intp]

FACTORS = ("continuity", "linkage", "time", "state", "score")
"""enum Factor of plan.h."""
_CALL = "dddIIIIIIIIII"
"""struct Call of ticks.c."""
_AHEAD = "ddddII" + 20 * "I"
"""struct Ahead of ahead.c."""
_HAPPENING = np.dtype(
    [("row", "<i8"), ("unit", "<i8", 3), ("time_s", "<f8"), ("numbers", "<f8", (3, 11)), ("started", "?", 3),
     ("unused", "u1", 5)]
)  # fmt: skip
"""struct Happening of ahead.c."""


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
        self._soonest_s, self._happened = machine.block(1, np.float64), machine.block(1, np.uint32)
        self._window_s = config.word_window_s
        self._signal = machine.block((0, 7 + self.kind.gestures), np.float64)
        self._slots = machine.block(0, np.int32)
        self._advance, self._weigh = (machine.function(name, _CALL) for name in ("advance", "weigh"))
        self._follow = machine.function("follow", _AHEAD)

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
            t.minimum, t.follow, t.blocks, t.leads_s, NORMAL, SHARE, t.unit.astype(np.int64), t.real,
            t.settled.astype(np.int32),
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
        self._call(self._advance, state, signal, float(signal.time_s), dt_s, self._scratch, 0)
        return PlannerState(state.characters, float(self._soonest_s.data[0]), bool(self._happened.data[0]))

    def weigh(self, state: PlannerState, signal: PlannerSignal, dt_s: float) -> Factors:
        """The factors of all in their ticks. Notes their emotions, which settles whoever begins; begins nothing."""
        factors = self._machine.block(len(state), self._factors)
        times_s = self._machine.kept(np.full(len(state), signal.time_s), np.float64)
        self._call(self._weigh, state, signal, 0.0, dt_s, factors, times_s.address)
        return Factors(**{name: factors.data[name] for name in (*FACTORS, "chosen", "within")})

    def _call(
        self,
        function: Callable[..., None],
        state: PlannerState,
        signal: PlannerSignal,
        time_s: float,
        dt_s: float,
        factors: Block,
        times_s: int,
    ) -> None:
        given = self._given(len(state))
        given.data[:, :7], given.data[:, 7:] = signal.emotion, signal.words
        function(
            time_s, dt_s, *self._habit(signal.habit), self._tables, state.characters.block.address, len(state),
            given.address, factors.address, self._soonest_s.address, self._happened.address, times_s,
        )  # fmt: skip

    def follow(self, state: PlannerState, rows: Ints, course: Course, dt_s: float, before: bool) -> Iterator[Told]:
        """The rows (R,) go through their ticks; see Planner.follow. Their records are written to."""
        count, most = len(rows), 2 * len(rows) + 16
        kept, machine, kind = self._machine.kept, self._machine, self.kind
        at, happenings = kept(np.zeros(count), np.int64), machine.block(most, _HAPPENING)
        arrays = [
            kept(array, array_kind)
            for array, array_kind in (
                (rows, np.int64), (course.emotion, np.float64), (course.cue, np.int64), (course.cue_s, np.float64),
                (course.tick, np.int64), (course.length, np.int64), (course.told, np.bool_),
            )
        ]  # fmt: skip
        who, emotion, cue, cue_s, tick, length, told = (array.address for array in arrays)
        while (at.data < course.length).any():
            emotions, words = machine.block((most, 7), np.float64), machine.block((most, kind.gestures), np.float64)
            kept_before = kind.room(most if before else 0)
            self._follow(
                dt_s, 0.5 * self._window_s, RADIUS, *self._habit(course.habit), self._tables,
                state.characters.block.address, who, count, emotion, course.emotion.shape[1], course.cue.shape[1],
                cue, cue_s, tick, length, told, at.address, self._scratch.address, happenings.address, most,
                self._happened.address, kept_before.block.address if before else 0, emotions.address, words.address,
            )  # fmt: skip
            some = slice(0, int(self._happened.data[0]))
            found = happenings.data[some].copy()
            signal = PlannerSignal(emotions.data[some], words.data[some], found["time_s"], course.habit)
            yield Told(found["row"], Decisions(found["unit"], found["started"], found["numbers"]), signal, kept_before)

    def _given(self, count: int) -> Block:
        """Room for the signal of so many."""
        if len(self._signal.data) != count:
            self._signal = self._machine.block((count, 7 + self.kind.gestures), np.float64)
        return self._signal

    def _habit(self, habit: Habit | None) -> tuple[float, int, int]:
        """struct Habit of plan.h."""
        if habit is None:
            return 0.0, 0, 0
        if not np.array_equal(self._slots.data, habit.slots):
            self._slots = self._machine.kept(habit.slots, np.int32)
        return habit.share, len(habit.slots), self._slots.address


def _factors_type(t: PlannerTables) -> np.dtype[Any]:
    """struct Factors of plan.h and what follows it."""
    layers, shape = len(t.layers), (len(t.layers), t.width)
    return np.dtype(
        [("chosen", "<i8", layers), ("within", "?", layers), ("beaten", "?", layers), ("unused", "u1", 2)]
        + [(name, "<f8", shape) for name in FACTORS]
    )
