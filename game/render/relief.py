"""When frames stay too slow: lower the quality step by step, at the very end the scene's resolution; never the HUD's.

A ladder of steps with hysteresis: down soon, up late, and later still where the last way up led down again at once.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from game.render.levels import LEVELS, Level

__all__ = ["SCALES", "Relief", "Step", "ladder", "relieve"]

SCALES = (1.0, 0.85, 0.7, 0.6)
"""Shares of the picture's sides the scene is drawn at; triangles are lowered before: it looks better."""
SLOW_MS, EASY_MS = 34.0, 19.0
"""Beyond the first a frame is felt; below the second there is room for more."""
PATIENCE_FRAMES = 30
SLOW_SHARE = 0.6
"""Down when so many of the last frames were slow …"""
EASY_FRAMES = 240
"""… up after so many easy ones in a row; twice as many after each way up that did not last."""
LASTED_FRAMES = 600
MOST_EASY_FRAMES = 8 * EASY_FRAMES


@dataclass(frozen=True)
class Step:
    """A rung: quality level and share of the resolution."""

    level: Level
    scale: float


def ladder(start: Level, *, fixed: bool = False) -> tuple[Step, ...]:
    """From the level that was picked down to the least there is; a ``fixed`` level (the player's) is kept."""
    levels = [start] if fixed else list(reversed(LEVELS[: LEVELS.index(start) + 1]))
    return (*(Step(level, 1.0) for level in levels), *(Step(levels[-1], scale) for scale in SCALES[1:]))


@dataclass(frozen=True)
class Relief:
    """Where on the ladder the picture is. slow, seen: of the present window of frames; easy: easy frames in a row;
    since: frames since the last step; wait: easy frames wanted for the next step up; rose: the last step was up."""

    at: int = 0
    slow: int = 0
    seen: int = 0
    easy: int = 0
    since: int = 0
    wait: int = EASY_FRAMES
    rose: bool = False


def relieve(state: Relief, frame_ms: float, steps: int) -> Relief:
    """One frame on. ``steps``: rungs of the ladder."""
    slow, seen = state.slow + (frame_ms > SLOW_MS), state.seen + 1
    easy = state.easy + 1 if frame_ms < EASY_MS else 0
    state = replace(state, slow=slow, seen=seen, easy=easy, since=state.since + 1)
    if seen >= PATIENCE_FRAMES:
        if slow >= SLOW_SHARE * PATIENCE_FRAMES and state.at + 1 < steps:
            fell_back = state.rose and state.since < LASTED_FRAMES
            wait = min(2 * state.wait, MOST_EASY_FRAMES) if fell_back else state.wait
            return Relief(at=state.at + 1, wait=wait)
        state = replace(state, slow=0, seen=0)
    if state.easy >= state.wait and state.at > 0:
        return Relief(at=state.at - 1, wait=state.wait, rose=True)
    return state
