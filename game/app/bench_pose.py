"""Speed of the pose: for 1, 100 and 1000 characters, beside a NumPy floor for the same work.

The floor (bench_pose_floor.py) is BENCH.md's work: three samples, a masked blend of three layers, local to model space,
skinning matrices of 60 joints. It keeps no state, knows its frames and shares beforehand and mixes no
variants. "everything" is the whole of ours on the shipped units, from the planner's decisions to the same matrices: up
to seven variants mixed, transitions, contacts by IK, collisions, breath, gaze and blinking; "the tick alone" is all of
that but the matrices. Times are this thread's own: what others on the machine take does not count.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import GAZE_CUSTOMER, Performer, PerformerState, PerformSignal, Pose, Rig, SpringChain
from game.animation import channels as ch
from game.app.bench_pose_floor import numpy_floor
from game.app.bench_rows import Row, row
from game.core.emotion_space import emotion_vector
from game.core.humanoid import REFERENCE
from game.core.paths import ASSETS
from game.embos import Planner, PlannerSignal, UnitLibrary

__all__ = ["rows"]

Floats = NDArray[np.floating[Any]]

JOINTS = 60
_TICK_S = 1.0 / 30.0
_COUNTS = (1, 100, 1000)
_WANTED = {1: "≤ 1.3× floor, ≤ 150 µs", 100: "≤ 8.4 µs", 1000: "≤ 5.2 µs"}
_SEED = 2
_LONGEST_TICKS = 400


def rows() -> list[Row]:
    """Microseconds per character: median, least and ratio to the floor run in turns with it."""
    library = UnitLibrary.load(ASSETS / "motion" / "units.yaml")
    performer = Performer(library)
    planner = Planner(library)
    plain, sprung = _rig(springs=False), _rig(springs=True)
    clip = performer.bank.rows[2:402, ch.ROTATION].reshape(-1, ch.JOINTS, 4)
    table: list[Row] = []
    for n in _COUNTS:
        state, decisions, signal, pose = _stand(performer, planner, n)
        tick = partial(performer.advance, state, decisions, signal, _TICK_S)
        works: list[Callable[[], object]] = [
            numpy_floor(plain.skeleton, clip, n),
            partial(_everything, tick, plain),
            tick,
        ]
        floor, everything, alone = _alternate(works, n)
        least = min(floor)
        who = "1 character" if n == 1 else f"{n} characters"
        table.append(row(f"floor, {who}", floor, unit="µs"))
        table.append(row(f"everything, {who}", everything, unit="µs", floor=least, wanted=_WANTED[n]))
        table.append(row(f"the tick alone, {who}", alone, unit="µs", floor=least))
        if n == 1:
            springs = sprung.start(1)
            springs, _ = sprung.advance(springs, pose, _TICK_S)
            skin, hair = _alternate(
                [
                    partial(plain.advance, plain.start(1), pose, _TICK_S),
                    partial(sprung.advance, springs, pose, _TICK_S),
                ],
                1,
            )
            table.append(row("skinning matrices alone, 1 character", skin, unit="µs", floor=least))
            table.append(row("the same with 12 spring pieces, 1 character", hair, unit="µs", floor=least))
    return table


def _alternate(works: Sequence[Callable[[], object]], n: int) -> list[list[float]]:
    """Times in µs per character, the works taking turns so that a busy machine slows all alike."""
    inner, turns = (4, 150) if n == 1 else (1, 24) if n == 100 else (1, 7)
    clock = time.thread_time if time.get_clock_info("thread_time").resolution < 1e-6 else time.perf_counter
    times: list[list[float]] = [[] for _ in works]
    for work in works:
        work()
    for _ in range(turns):
        for taken, work in zip(times, works, strict=True):
            begin = clock()
            for _ in range(inner):
                work()
            taken.append((clock() - begin) * 1e6 / (inner * n))
    return times


def _stand(performer: Performer, planner: Planner, n: int) -> tuple[PerformerState, Any, PerformSignal, Pose]:
    """In the middle of a talk: the first has a gesture and a transition on the way, a crowd whatever each has."""
    felt = np.tile(emotion_vector({"joy": 0.5, "surprise": 0.2}), (n, 1))
    words = np.zeros((n, len(performer.library.gestures)))
    signal = PerformSignal(felt, np.tile(GAZE_CUSTOMER, (n, 1)), np.ones(n))
    plan, state = planner.start(n, _SEED), performer.start(n, _SEED)
    for tick in range(_LONGEST_TICKS):
        said = words.copy()
        said[:, 2] = float(tick % 80 in range(40, 60))
        plan, decisions = planner.advance(plan, PlannerSignal(felt, said, tick * _TICK_S), _TICK_S)
        state, pose = performer.advance(state, decisions, signal, _TICK_S)
        left = state.changing[0]
        changing = (left > 0.0) & (left < 0.8)
        if state.active[0, performer.layers.index("gesture")] and changing.any():
            break
    # Most ticks start nothing: the decision stands.
    decisions = replace(decisions, started=np.zeros_like(decisions.started))
    return state, decisions, signal, pose


def _everything(tick: Callable[[], tuple[PerformerState, Pose]], rig: Rig) -> object:
    _, pose = tick()
    return rig.advance(rig.start(len(pose)), pose, _TICK_S)


def _rig(*, springs: bool) -> Rig:
    """REFERENCE with forearm twists and strands of hair: 60 joints."""
    names, parents, rest = list(REFERENCE.names), list(REFERENCE.parents), list(REFERENCE.rest_translation)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        names.append(f"{side}ForearmTwist")
        parents.append(REFERENCE.index[f"{side}LowerArm"])
        rest.append(np.array([0.1 * sign, 0.0, 0.0]))
    chains = []
    for strand in range(6):
        joints: list[int] = []
        for piece in range(3 if strand else 2):
            parents.append(joints[-1] if joints else REFERENCE.index["head"])
            joints.append(len(names))
            names.append(f"hair{strand}_{piece}")
            rest.append(np.array([0.03 * strand, -0.06, -0.02]))
        pieces = len(joints) - 1
        down = ((0.0, -1.0, 0.0),) * pieces
        chains.append(
            SpringChain(tuple(joints), (1.0,) * pieces, (0.2,) * pieces, down, (0.4,) * pieces, (0.01,) * pieces)
        )
    assert len(names) == JOINTS
    return Rig.from_arrays(names, np.array(parents), np.array(rest), chains=chains if springs else ())
