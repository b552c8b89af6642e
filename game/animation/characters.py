"""Where characters stand between two ticks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation.channels import CONTACT_FRAMES
from game.animation.liveliness import start_life
from game.animation.tick_data import CHARACTER
from game.core.compiled import Block, Machine

__all__ = ["PerformerState", "start"]

Floats = NDArray[np.floating[Any]]


@dataclass(frozen=True, eq=False)
class PerformerState:
    """n characters; every tick makes new ones.

    characters: (n,) CHARACTER, read-only. home: the machine in whose memory they lie and where in it; None where they
    lie in Python's.
    """

    characters: NDArray[np.void]
    home: tuple[Machine, Block] | None = None

    def __len__(self) -> int:
        return len(self.characters)

    def __reduce__(self) -> tuple[type[PerformerState], tuple[NDArray[np.void]]]:
        return PerformerState, (self.characters.copy(),)

    @property
    def unit(self) -> NDArray[np.int32]:
        """(n, L) that were begun last, −1: none yet."""
        return np.asarray(self.characters["layers"]["unit"])

    @property
    def active(self) -> NDArray[np.bool_]:
        """(n, L) False once a unit has played to its end."""
        return np.asarray(self.characters["layers"]["active"] != 0)

    @property
    def weight(self) -> Floats:
        """(n, L, 7) of eq. 5, as mixed."""
        return np.asarray(self.characters["layers"]["weight"])

    @property
    def to_stroke_s(self) -> Floats:
        """(n, L) seconds until the stroke, negative after it."""
        return np.asarray(self.characters["layers"]["before_s"] - self.characters["layers"]["elapsed_s"])

    @property
    def changing(self) -> Floats:
        """(n, PARTS) what is left of the transitions under way, 1 when they begin .. 0."""
        return np.asarray(self.characters["left"][:, 0])

    @property
    def head(self) -> Floats:
        """(n, 3) yaw and pitch that the gaze adds to the head, yaw that it adds to the torso, radians."""
        return np.asarray(self.characters["head"])


def start(n: int, seed: int, first: int = 0) -> PerformerState:
    """Characters first, first + 1, … of a seed, before their first tick: whatever comes is taken as it is."""
    characters = np.zeros(n, dtype=CHARACTER)
    characters["layers"]["unit"] = -1
    characters["pace"] = 1.0
    characters["frames"]["turn"] = np.eye(len(CONTACT_FRAMES))[-1]
    start_life(characters, seed, first)
    characters.setflags(write=False)
    return PerformerState(characters)
