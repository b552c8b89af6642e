"""What could have been seen: the moments of a talk in which the body told most, with a picture and a few seconds each.

An observer: it looks at every tick and changes nothing. A unit that begins is a tell as far as it belongs to the
feeling that is felt and to few others; where the face shows something else it counts more.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from game.app.step import StepAssets
from game.app.world import TICK_S, World
from game.core.emotion_space import EMOTIONS, with_neutral
from game.face import FaceParams, FaceSignal, advance_face

__all__ = ["Clip", "Tell", "TellWatch", "tell_strength"]

LAYER_WEIGHT = {"mannerism": 1.0, "posture": 0.75, "gesture": 0.35}
MASK_BONUS = 0.35
LEAST = 0.25
"""What is felt less than this is no news, as in the rules' label."""
MOST_TELLS = 3
LEAD_S, AFTER_S = 0.9, 1.7
"""The replay begins so long before a tell is at its height, and ends so long after."""


@dataclass(frozen=True, eq=False)
class Tell:
    """One moment. round: after how many moves; feeling, strength: what was felt; face: what was shown most;
    matrices (j, 4, 4) and params: the body and the face as they stood."""

    unit: int
    round: int
    time_s: float
    feeling: str
    felt: float
    face: str
    strength: float
    matrices: NDArray[np.float32]
    params: FaceParams


@dataclass(frozen=True, eq=False)
class Clip:
    """A few seconds around the strongest tell: bodies (n, j, 4, 4), faces as shown and with the mask dropped from
    frame ``drop`` on, (n) each."""

    tell: Tell
    matrices: list[NDArray[np.float32]]
    faces: list[FaceParams]
    bare: list[FaceParams]
    drop: int


def tell_strength(assets: StepAssets, unit: int, felt: NDArray[np.float64], shown: NDArray[np.float64]) -> float:
    """How much a unit tells of what is felt, 0 where it does not belong to it. felt (6,), shown (6,)."""
    library = assets.planner.library
    k = int(np.argmax(felt))
    if felt[k] < LEAST or library.is_rest[unit] or not library.exists[unit, k]:
        return 0.0
    own = 1.0 / float(library.exists[unit].sum())
    masked = MASK_BONUS if int(np.argmax(shown)) != k or shown.max() < LEAST else 0.0
    return float(felt[k]) * (0.3 + own) * LAYER_WEIGHT[library.units[unit].layer] + masked * own


@dataclass
class _Due:
    """A tell that has begun and is not yet at its height."""

    unit: int
    at_s: float
    strength: float


@dataclass
class TellWatch:
    """Watches one talk; ``tells`` are its strongest moments in order of time, ``clip`` the best of them in motion."""

    tells: list[Tell] = field(default_factory=list)
    clip: Clip | None = None
    _units: tuple[int, ...] = ()
    _due: list[_Due] = field(default_factory=list)
    _past: deque[tuple[World, NDArray[np.float32]]] = field(
        default_factory=lambda: deque(maxlen=round((LEAD_S + AFTER_S) / TICK_S))
    )
    _cut_s: float = 0.0
    _cut: Tell | None = None

    def tick(self, assets: StepAssets, world: World, matrices: NDArray[np.float32]) -> None:
        """Look at the world after a step. matrices: (j, 4, 4) of the person as drawn."""
        if world.talk is None or world.body.face_params is None:
            return
        self._past.append((world, matrices))
        units = tuple(int(u) for u in world.body.decisions.unit[0])
        shown = world.shown[:6]
        for row, unit in enumerate(units):
            if unit >= 0 and (not self._units or unit != self._units[row]):
                strength = tell_strength(assets, unit, world.felt, shown)
                if strength > 0.0:
                    wait_s = min(0.5 * float(world.body.decisions.duration_s[0, row]), 0.9)
                    self._due.append(_Due(unit, world.time_s + wait_s, strength))
        self._units = units
        for due in [d for d in self._due if world.time_s >= d.at_s]:
            self._due.remove(due)
            if due.unit in units:
                self._keep(world, matrices, due)
        if self._cut is not None and world.time_s >= self._cut_s:
            self.clip, self._cut = self._clip(assets, self._cut), None

    def _keep(self, world: World, matrices: NDArray[np.float32], due: _Due) -> None:
        assert world.body.face_params is not None
        k = int(np.argmax(world.felt))
        face = int(np.argmax(world.shown[:6]))
        tell = Tell(
            unit=due.unit,
            round=len(world.marks) - 1,
            time_s=world.time_s,
            feeling=EMOTIONS[k],
            felt=float(world.felt[k]),
            face=EMOTIONS[face] if world.shown[face] >= LEAST else "neutral",
            strength=due.strength,
            matrices=matrices.copy(),
            params=world.body.face_params.copy(),
        )
        best = max((t.strength for t in self.tells), default=0.0)
        # One picture for a round and for a unit: three that look alike teach nothing.
        alike = [t for t in self.tells if t.round == tell.round or t.unit == tell.unit]
        if any(t.strength >= tell.strength for t in alike):
            return
        self.tells = sorted([t for t in self.tells if t not in alike] + [tell], key=lambda t: -t.strength)[:MOST_TELLS]
        self.tells.sort(key=lambda t: t.time_s)
        if tell.strength > best:
            self._cut, self._cut_s = tell, tell.time_s + AFTER_S

    def finish(self, assets: StepAssets) -> None:
        """The talk is over: cut what is still running."""
        if self._cut is not None:
            self.clip, self._cut = self._clip(assets, self._cut), None

    def _clip(self, assets: StepAssets, tell: Tell) -> Clip | None:
        past = [(w, m) for w, m in self._past if w.body.face_params is not None and w.body.face is not None]
        if not past or assets.face is None:
            return None
        drop = next((i for i, (w, _) in enumerate(past) if w.time_s >= tell.time_s), len(past) - 1)
        faces = [w.body.face_params for w, _ in past if w.body.face_params is not None]
        bare, state = faces[: drop + 1], past[drop][0].body.face
        for world, _ in past[drop + 1 :]:
            assert state is not None
            felt = with_neutral(world.felt)
            state, params = advance_face(assets.face, state, FaceSignal(shown=felt, felt=felt), TICK_S)
            bare.append(params)
        return Clip(tell, [m for _, m in past], faces, bare, drop)
