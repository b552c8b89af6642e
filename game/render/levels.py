"""Quality levels as data, and picking one by measurement."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter

import numpy as np

__all__ = ["DEFAULT", "LEVELS", "Level", "level_named", "pick_level"]


@dataclass(frozen=True)
class Level:
    """What one quality level spends. Triangles are lowered before resolution: it looks better."""

    name: str
    samples: int  # of the person; the baked scene has always four
    triangles: int
    shadow_size: int
    shadow_taps: int  # on the table; on the person every vertex looks eight times
    shadow_every: int  # frames between two shadow maps
    face_size: int
    people: int  # passers-by
    clouds: bool  # whether they drift
    weaves: bool = True  # whether clothes show their patterns
    line_px: float = 1.7  # outline width in a picture 720 pixels high


LEVELS: tuple[Level, ...] = (
    Level("low", 0, 15_000, 512, 1, 2, 512, 0, False, weaves=False),
    Level("medium", 0, 25_000, 512, 1, 2, 512, 3, False),
    Level("default", 0, 40_000, 512, 2, 2, 512, 4, False),
    Level("high", 4, 25_000, 512, 1, 2, 512, 6, True),
    Level("ultra", 4, 40_000, 768, 2, 2, 1024, 8, True),
)
DEFAULT = LEVELS[2]


def level_named(name: str) -> Level:
    """Raises KeyError with the known names."""
    for level in LEVELS:
        if level.name == name:
            return level
    raise KeyError(f"no quality level {name!r}; there are {', '.join(level.name for level in LEVELS)}")


def pick_level(
    draw: Callable[[Level], None],
    budget_ms: float = 20.0,
    probe_s: float = 0.5,
    clock: Callable[[], float] = perf_counter,
) -> Level:
    """Try levels for about ``probe_s`` seconds in all and return the best one that keeps the budget.

    ``draw`` draws one whole frame at a level and waits until it is finished. Starts at the default; goes down while
    the 95th percentile is over the budget, up while the next level keeps within 60 % of it.
    """
    end = clock() + probe_s

    def cost_ms(level: Level) -> float:
        draw(level)  # the first frame builds what the level needs
        times: list[float] = []
        while len(times) < 5 or (len(times) < 20 and clock() < end):
            start = clock()
            draw(level)
            times.append((clock() - start) * 1e3)
        return float(np.percentile(times, 95))

    index = LEVELS.index(DEFAULT)
    if cost_ms(LEVELS[index]) > budget_ms:
        while index > 0 and cost_ms(LEVELS[index - 1]) > budget_ms:
            index -= 1
        return LEVELS[max(index - 1, 0)]
    while index + 1 < len(LEVELS) and clock() < end and cost_ms(LEVELS[index + 1]) < 0.6 * budget_ms:
        index += 1
    return LEVELS[index]
