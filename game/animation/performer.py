"""From the planner's decisions to one pose per character. The stages of a tick are compiled (tick/*.c):

decisions -> playback    rows of the running units, variants mixed (EMBOS eq. 5)
          -> blending    layers into one row, transitions without pops (SPEC 6)
          -> liveliness  breath, sway, gaze
          -> contacts    hands where their contact wants them and out of the body
          -> limbs       arms and legs after them, feet planted
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from game.animation import characters
from game.animation.characters import PerformerState
from game.animation.liveliness import LifeConfig
from game.animation.motion_bank import KnownUnits, MotionBank, bake
from game.animation.pose import Pose
from game.animation.tick_data import LAYERS as LAYER_COUNT
from game.animation.ticking import Ticking
from game.core.emotion_space import EMOTIONS
from game.embos import LAYERS, Decisions, UnitLibrary
from game.embos.mixing import RADIUS

__all__ = ["MODES", "Mode", "PerformSignal", "Performer"]

Floats = NDArray[np.floating[Any]]

Mode = Literal["full", "gestures", "body", "face"]
MODES: tuple[Mode, ...] = ("full", "gestures", "body", "face")
"""What of the behaviour is shown. ``gestures``: posture and mannerism stand at neutral; ``body``: everything the
body does (the face is another stage's); ``face``: the body stands still at neutral."""

_NEUTRAL = np.eye(len(EMOTIONS))[EMOTIONS.index("neutral")]
_NEUTRAL.setflags(write=False)


@dataclass(frozen=True, eq=False)
class PerformSignal:
    """What a tick brings besides the decisions.

    emotion: (n, 7) felt; gaze_target: (n, 3) model space, metres; speaking: (n,) 0 silent .. 1 speaking.
    """

    emotion: Floats
    gaze_target: Floats
    speaking: Floats
    mode: Mode = "full"


class Performer:
    """Plays a library's units. Immutable; all that changes is in the state. For one thread at a time."""

    def __init__(
        self,
        library: UnitLibrary,
        layers: tuple[str, ...] = LAYERS,
        life: LifeConfig | None = None,
        collide: bool = True,
        radius: float = RADIUS,
        known: KnownUnits | None = None,
    ) -> None:
        """layers, radius: the planner's order and r of eq. 5; collide: keep hands out of body and table; known: what
        stayed the same since another performer was made is not made anew."""
        assert len(layers) == LAYER_COUNT
        self.library = library
        self.layers = layers
        self.life = life or LifeConfig()
        self.collide = collide
        posture = layers.index("posture")
        bank = bake(library, layers, radius, known)
        rest_weight = np.zeros((len(layers), len(EMOTIONS)))
        rest_weight[posture] = library.mix_weights(_NEUTRAL, bank.rest[posture])
        order = (posture, *(i for i in range(len(layers)) if i != posture))
        self._ticking = Ticking(bank, self.life, order, rest_weight)
        self.bank: MotionBank = self._ticking.bank
        # Layers that stand at rest, as bits.
        held = {"full": (), "body": (), "gestures": tuple(x for x in layers if x != "gesture"), "face": layers}
        self._held = {mode: sum(1 << layers.index(name) for name in names) for mode, names in held.items()}

    def start(self, n: int, seed: int = 0, first: int = 0) -> PerformerState:
        """n characters before their first tick; character first + i moves the same in any company."""
        return characters.start(n, seed, first)

    def adopt(self, state: PerformerState, before: Performer) -> PerformerState:
        """Characters who moved by the repertoire of another performer, before their next tick: they go on from where
        they are, as fast as they were."""
        return before._ticking.left(state)

    def advance(
        self, state: PerformerState, decisions: Decisions, signal: PerformSignal, dt_s: float
    ) -> tuple[PerformerState, Pose]:
        """One tick of dt_s seconds (0 draws the present moment again)."""
        after = self._ticking.tick(
            state, decisions, signal.emotion, signal.gaze_target, signal.speaking, dt_s,
            self._held[signal.mode], signal.mode == "face", self.collide,
        )  # fmt: skip
        now = after.characters
        return after, Pose(now["rotation"], now["root"], now["gaze"], now["blink"], now["breath"])
