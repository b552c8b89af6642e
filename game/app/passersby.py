"""Passers-by: the market's other people, moved by the same planner and performer as the shopkeeper, in one batch.

Where they walk follows from the time (game.app.strolls), what trunk, head and hands do from their feelings through the
planner, how their legs go from game.animation.walking. A loud reaction at the table turns heads.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import Performer, PerformerState, PerformSignal, Pose, Rig
from game.animation.walking import Walk
from game.app.rig import load_rig
from game.app.strolls import CADENCE_HZ, Place, Strolls
from game.app.world import TICK_S, World
from game.core.emotion_space import EMOTIONS
from game.core.paths import ASSETS
from game.embos import Planner, PlannerSignal, PlannerState
from game.render import CrowdLook, CrowdMesh, CrowdView, dressed, load_crowd_mesh

__all__ = ["PEOPLE", "Cast", "Known", "Passersby", "load_cast"]

Floats = NDArray[np.floating[Any]]

PEOPLE = 8
CHILD, CHILDREN_EVERY = 3, 4
"""The fourth is a child, and so is every fourth after."""
LOUD = 0.6
"""A reaction that shows so strongly on the shopkeeper's face …"""
LOOK_S = 2.6
"""… is looked at for so long by those who stand near."""
NEAR_M = 3.5
_STALL = np.array([0.0, 1.1, 0.0])
_MOODS = ("neutral", "joy", "joy", "neutral", "surprise", "neutral", "sadness", "joy")


@dataclass(frozen=True, eq=False)
class Cast:
    """Who walks by: a look and a rig each, sizes (n,) as a share of the model's, girth (n,): width for that size."""

    looks: Sequence[CrowdLook]
    rigs: Sequence[Rig]
    size: Floats
    girth: Floats
    tall_m: Floats


Known = dict[Path, tuple[CrowdMesh, Rig]]
"""Models that have been read."""


def load_cast(own: str, folder: Path = ASSETS / "characters", count: int = PEOPLE, known: Known | None = None) -> Cast:
    """Passers-by from the models of all shopkeepers; the one who stands at this stall only if there is no other.

    ``known`` remembers the models from stall to stall.
    """
    known = {} if known is None else known
    files = sorted(folder.glob("*.vrm"))
    files = [path for path in files if path.stem != own] or files
    for path in files:
        if path not in known:
            known[path] = (load_crowd_mesh(path), load_rig(path, springs=False))
    meshes, rigs = [known[path][0] for path in files], [known[path][1] for path in files]
    rng = np.random.default_rng(11)
    size, girth = 0.86 + 0.20 * rng.random(count), 0.84 + 0.26 * rng.random(count)
    size[CHILD::CHILDREN_EVERY] *= 0.72
    which = [who % len(files) for who in range(count)]
    tall = np.array([float(mesh.position[:, 1].max()) for mesh in meshes])
    return Cast(
        looks=[dressed(meshes[k], who) for who, k in enumerate(which)],
        rigs=[rigs[k] for k in which],
        size=size,
        girth=girth,
        tall_m=tall[which] * size,
    )


class Passersby:
    """The moving crowd. ``tick`` follows the world; ``view`` is what a frame between two ticks shows."""

    def __init__(self, cast: Cast, planner: Planner, performer: Performer, seed: int) -> None:
        self._cast, self._seed = cast, seed
        self._move_by(planner, performer)
        self._count, self._walk = len(cast.looks), Walk()
        self._strolls = Strolls(self._count, seed)
        self._mood = np.zeros((self._count, len(EMOTIONS)))
        for who in range(self._count):
            self._mood[who, EMOTIONS.index(_MOODS[who % len(_MOODS)])] = 0.7
        self._mood[:, -1] = np.maximum(1.0 - self._mood[:, :-1].sum(axis=1), 0.0)
        self._plan: PlannerState = planner.start(self._count, seed ^ 0x0C40)
        self._state: PerformerState = performer.start(self._count, seed ^ 0x0C40)
        self._words = np.zeros((self._count, len(planner.library.gestures)))
        rigs = list({id(rig): rig for rig in cast.rigs}.values())
        self._rows = [(rig, np.array([i for i, own in enumerate(cast.rigs) if own is rig])) for rig in rigs]
        pose = self._advance(0.0, np.zeros(self._count, bool))
        self._after = self._before = self._placed(pose, 0.0)

    def _move_by(self, planner: Planner, performer: Performer) -> None:
        self._planner, self._performer = planner, copy(performer)
        self._performer.collide = False  # nobody sees a hand touch a body from here

    def take_up(self, planner: Planner, performer: Performer) -> None:
        """Move by other units from now on, from the poses of this moment; the same units change nothing."""
        if planner is self._planner:
            return
        before = self._performer
        self._move_by(planner, performer)
        self._plan = planner.start(self._count, self._seed ^ 0x0C40)
        self._state = self._performer.adopt(self._state, before)
        self._words = np.zeros((self._count, len(planner.library.gestures)))

    def tick(self, world: World) -> None:
        """One tick on, at the world's time."""
        near = self._heads_turn(world)
        self._before = self._after
        self._after = self._placed(self._advance(world.time_s, near), world.time_s)

    def _places(self, time_s: float) -> list[Place]:
        return [self._strolls.place(who, time_s) for who in range(self._count)]

    def _heads_turn(self, world: World) -> NDArray[np.bool_]:
        since_s = world.time_s - world.burst_s
        loud = world.talk is not None and 0.0 <= since_s <= LOOK_S and float(world.shown_target[:6].max()) >= LOUD
        if not loud:
            return np.zeros(self._count, bool)
        return np.array([abs(place.x) < NEAR_M for place in self._places(world.time_s)])

    def _advance(self, time_s: float, looking: NDArray[np.bool_]) -> Pose:
        emotion = self._mood.copy()
        emotion[looking, EMOTIONS.index("surprise")] = 0.8
        signal = PlannerSignal(emotion=emotion, words=self._words, time_s=time_s)
        self._plan, decisions = self._planner.advance(self._plan, signal, TICK_S)
        gaze = np.tile([0.0, 1.1, 4.0], (self._count, 1))
        for who in np.flatnonzero(looking):
            place = self._strolls.place(int(who), time_s)
            c, s = np.cos(place.yaw_rad), np.sin(place.yaw_rad)
            away = _STALL - (place.x, 0.0, place.z)
            gaze[who] = (c * away[0] - s * away[2], away[1], s * away[0] + c * away[2])
        perform = PerformSignal(emotion=emotion, gaze_target=gaze, speaking=np.zeros(self._count))
        self._state, pose = self._performer.advance(self._state, decisions, perform, TICK_S)
        return pose

    def _placed(self, pose: Pose, time_s: float) -> tuple[list[NDArray[np.float32]], Floats]:
        """Skin matrices in the world and where everybody stands (n, 3)."""
        places = self._places(time_s)
        size = self._cast.size
        speed = np.array([place.speed for place in places])
        phase = time_s * CADENCE_HZ / size + 0.37 * np.arange(self._count)
        pose = self._walk(pose, phase, speed / CADENCE_HZ, np.array([place.walking for place in places]))
        builds = zip(places, size.tolist(), self._cast.girth.tolist(), strict=True)
        world = np.stack([_world(*build) for build in builds])
        matrices: dict[int, NDArray[np.float32]] = {}
        for rig, rows in self._rows:
            _, skin = rig.advance(rig.start(len(rows)), _only(pose, rows), TICK_S)
            matrices.update(zip(rows.tolist(), world[rows, None] @ skin, strict=True))
        return [matrices[who] for who in range(self._count)], np.array([(p.x, 0.0, p.z) for p in places])

    def view(self, share: float) -> CrowdView:
        """What is seen at a share in [0, 1] between the last two ticks."""
        mixed = [a + (b - a) * np.float32(share) for a, b in zip(self._before[0], self._after[0], strict=True)]
        place = self._before[1] + (self._after[1] - self._before[1]) * share
        return CrowdView(mixed, place, self._cast.tall_m)


def _only(pose: Pose, rows: NDArray[np.intp]) -> Pose:
    return Pose(pose.rotation[rows], pose.root[rows], pose.gaze[rows], pose.blink[rows], pose.breath[rows])


def _world(place: Place, size: float, girth: float) -> NDArray[np.float32]:
    c, s = size * girth * np.cos(place.yaw_rad), size * girth * np.sin(place.yaw_rad)
    return np.array([[c, 0, s, place.x], [0, size, 0, 0], [-s, 0, c, place.z], [0, 0, 0, 1]], dtype=np.float32)
