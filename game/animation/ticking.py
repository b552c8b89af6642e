"""The compiled tick (tick/*.c) as Python calls it: the units' rows in its memory, one call for all characters."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import channels as ch
from game.animation.characters import PerformerState
from game.animation.liveliness import LifeConfig
from game.animation.motion_bank import FPS, MotionBank
from game.animation.tick_data import BANK, CALL, CHARACTER, ROW, SETUP, SIGNAL, UNIT, VARIANT
from game.animation.tick_setup import setup_of
from game.core.compiled import Block, Machine
from game.embos import Decisions

__all__ = ["MODULE", "Ticking"]

Floats = NDArray[np.floating[Any]]

MODULE = Path(__file__).with_name("tick.wasm")


class Ticking:
    """Ticks of one bank's units. Holds nothing of the characters but room for what a call is told."""

    def __init__(self, bank: MotionBank, life: LifeConfig, order: tuple[int, ...], rest_weight: Floats) -> None:
        """order: the layers, the posture's first; rest_weight: (L, 7) of the unit that says nothing, by layer."""
        self._life, self._order, self._rest_weight = life, order, rest_weight
        self._machine = Machine(MODULE)
        self._tick = self._machine.function("tick", CALL)
        self._leave = self._machine.function("leave", CALL)
        self._rows = self._machine.block((len(bank.rows), ROW), np.float32)
        self._rows.data[:, : ch.CHANNELS] = bank.rows
        self._rows.data[:, ch.CHANNELS :] = 0.0
        self._rows.data.setflags(write=False)
        # Here once for both sides.
        self.bank = replace(bank, rows=self._rows.data[:, : ch.CHANNELS])
        self._units = self._machine.kept(_units(bank), UNIT)
        self._variants = self._machine.kept(_variants(bank), VARIANT)
        self._setup = self._machine.kept(setup_of(life), SETUP)
        table = np.zeros(1, dtype=BANK)
        table["rows"], table["units"] = self._rows.address, self._units.address
        table["variants"], table["most_variants"] = self._variants.address, bank.first.shape[2]
        table["order"], table["rows_per_s"], table["rest"], table["rest_weight"] = order, FPS, bank.rest, rest_weight
        self._bank = self._machine.kept(table, BANK)
        self._told: tuple[int, Block, list[NDArray[Any]]] = self._room(1)

    def __reduce__(self) -> tuple[type[Ticking], tuple[Any, ...]]:
        return Ticking, (self.bank, self._life, self._order, self._rest_weight)

    def tick(
        self,
        state: PerformerState,
        decisions: Decisions,
        emotion: Floats,
        gaze_target: Floats,
        speaking: Floats,
        dt_s: float,
        held: int,
        neutral: bool,
        collide: bool,
    ) -> PerformerState:
        """One tick; the arguments are those of Performer.advance. held: bits of the layers that stand at rest; neutral:
        what is felt does not show."""
        n = len(state)
        if self._told[0] != n:
            self._told = self._room(n)
        _, signals, fields = self._told
        # In the order of SIGNAL's fields.
        told = (emotion, gaze_target, speaking, decisions.numbers, decisions.unit, decisions.started)
        for field, value in zip(fields, told, strict=True):
            field[...] = value
        before, after = self._here(state), self._machine.block(n, CHARACTER)
        self._tick(
            self._setup.address, self._bank.address, n, before.address, signals.address, after.address,
            dt_s, held, neutral, collide,
        )  # fmt: skip
        return self._state(after)

    def left(self, state: PerformerState) -> PerformerState:
        """Characters who will move by other units from the next tick on."""
        before, after = self._here(state), self._machine.block(len(state), CHARACTER)
        setup, bank = self._setup.address, self._bank.address
        self._leave(setup, bank, len(state), before.address, 0, after.address, 0.0, 0, 0, 0)
        return self._state(after)

    def _here(self, state: PerformerState) -> Block:
        if state.home is not None and state.home[0] is self._machine:
            return state.home[1]
        return self._machine.kept(state.characters, CHARACTER)

    def _state(self, block: Block) -> PerformerState:
        block.data.setflags(write=False)
        return PerformerState(block.data, (self._machine, block))

    def _room(self, n: int) -> tuple[int, Block, list[NDArray[Any]]]:
        """What the compiled side is told of n characters in a tick: how many, where, and its fields."""
        block = self._machine.block(n, SIGNAL)
        assert SIGNAL.names is not None
        return n, block, [block.data[name] for name in SIGNAL.names]


def _units(bank: MotionBank) -> NDArray[np.void]:
    """(U,) UNIT."""
    units = np.zeros(len(bank.count), dtype=UNIT)
    for name in ("count", "stroke", "loop_first", "loop_frames", "frame", "looks", "mix_slope", "mix_level"):
        units[name] = getattr(bank, name)
    units["owned"] = bank.owned @ (1 << np.arange(len(ch.PARTS)))
    return units


def _variants(bank: MotionBank) -> NDArray[np.void]:
    """(U, 7, V) VARIANT."""
    variants = np.zeros(bank.first.shape, dtype=VARIANT)
    for name in ("first", "frames", "before_s", "after_s"):
        variants[name] = getattr(bank, name)
    return variants
