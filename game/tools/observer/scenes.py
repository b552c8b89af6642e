"""Performances the observer has never seen: the game's planner and performer with a fixed feeling, in one mode.

Same units, same step length and same speech timing as in play; all emotions and seeds of a mode run side by side.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import Mode, Performer, PerformSignal
from game.core.emotion_space import EMOTIONS, with_neutral
from game.embos import TICK_S, GestureCues, Planner, PlannerSignal, UnitLibrary
from game.story import TimedText
from game.tools.observer.keypoints import keypoints

__all__ = ["LINES", "Scene", "play_scenes"]

Floats = NDArray[np.floating[Any]]

LINES = (
    "Here, take a look at this one. It is really old.",
    "The price is two coins. That one over there costs a little more.",
    "Well, let me see. I think this is the first of the two.",
    "Please, wait a bit. It is small, but the shape is round.",
    "Yes, of course. What do you think, maybe the second?",
    "Hello. All of these are mine, everything on the table.",
)
"""Said by everybody alike: words that bring gestures and tell no feeling."""
_PAUSE_S = 1.2
_SETTLE_S = 4.0
"""Before this the body still comes from rest: not shown to the observer."""
_GAZE = np.array([0.0, 1.16, 3.0])


@dataclass(frozen=True, eq=False)
class Scene:
    """points: (F, K, 3) keypoints at 30 fps of one performance; emotion: index of what was felt; seed."""

    points: Floats
    emotion: int
    seed: int


class _Speech:
    """Lines said one after the other; which one comes first differs by seed."""

    def __init__(self, library: UnitLibrary, seed: int) -> None:
        self.library = library
        self.said = seed
        self.cues = GestureCues.silent(library)
        self.until_s, self.next_s = 0.0, 1.0 + 0.37 * (seed % 5)

    def advance(self, now_s: float) -> bool:
        """Begin the next line where it is time; whether one is being spoken."""
        if now_s >= self.next_s:
            line = TimedText(LINES[self.said % len(LINES)], "en")
            tokens = [(word.text, now_s + word.start_s) for word in line.words]
            self.cues = GestureCues.from_tokens(self.library, tokens, "en")
            self.until_s, self.said = now_s + line.length_s, self.said + 1
            self.next_s = self.until_s + _PAUSE_S
        return now_s < self.until_s

    def factors(self, now_s: float, lead_s: Floats) -> Floats:
        """(n, G) word factors of n characters who all say this; lead_s: (n, G)."""
        return np.stack([self.cues.factors(now_s, own) for own in lead_s])


def play_scenes(
    planner: Planner,
    performer: Performer,
    mode: Mode,
    first_seed: int,
    count: int,
    seconds: float,
    felt: float = 0.9,
) -> list[Scene]:
    """One performance per seed and emotion, felt at that strength from the start; neutral feels nothing.

    The seven of a seed say the same lines at the same times.
    """
    each = len(EMOTIONS)
    n = count * each
    emotion = np.tile(with_neutral(np.concatenate([np.eye(6) * felt, np.zeros((1, 6))])), (count, 1))
    lead_s = planner.library.stroke_lead_s(emotion)
    state = planner.start(n, 1, first_seed * each)
    acting = performer.start(n, 1, first_seed * each)
    speech = [_Speech(planner.library, first_seed + i) for i in range(count)]
    gaze = np.tile(_GAZE, (n, 1))
    words, speaking = np.zeros((n, len(planner.library.gestures))), np.zeros(n)
    settle, ticks = round(_SETTLE_S / TICK_S), round((_SETTLE_S + seconds) / TICK_S)
    rotation, root = [], []
    for tick in range(ticks):
        now_s = tick * TICK_S
        for i, talk in enumerate(speech):
            own = slice(i * each, (i + 1) * each)
            speaking[own] = talk.advance(now_s)
            words[own] = talk.factors(now_s, lead_s[own])
        state, decisions = planner.advance(state, PlannerSignal(emotion, words, now_s), TICK_S)
        acting, pose = performer.advance(acting, decisions, PerformSignal(emotion, gaze, speaking, mode), TICK_S)
        if tick >= settle:
            rotation.append(pose.rotation.astype(np.float32))
            root.append(pose.root.astype(np.float32))
    turns, places = np.stack(rotation, axis=1), np.stack(root, axis=1)
    return [Scene(keypoints(turns[i], places[i]), i % each, first_seed + i // each) for i in range(n)]
