from __future__ import annotations

from itertools import pairwise

import pytest

from game.render import LEVELS, Level, level_named, pick_level


class Machine:
    """A clock that a level's cost moves on."""

    def __init__(self, **cost_ms: float) -> None:
        self.cost_ms = cost_ms
        self.now_s = 0.0
        self.drawn: list[str] = []

    def draw(self, level: Level) -> None:
        self.drawn.append(level.name)
        self.now_s += self.cost_ms[level.name] / 1e3

    def clock(self) -> float:
        return self.now_s


@pytest.mark.parametrize(
    ("cost_ms", "wanted"),
    [
        ({"low": 8, "medium": 12, "default": 17, "high": 24, "ultra": 29}, "default"),
        ({"low": 8, "medium": 19, "default": 40, "high": 60, "ultra": 90}, "medium"),
        ({"low": 50, "medium": 70, "default": 100, "high": 160, "ultra": 190}, "low"),
        ({"low": 0.5, "medium": 0.6, "default": 0.8, "high": 1.0, "ultra": 1.2}, "ultra"),
    ],
)
def test_the_best_level_within_the_budget_is_picked(cost_ms: dict[str, float], wanted: str) -> None:
    machine = Machine(**cost_ms)
    assert pick_level(machine.draw, 20.0, clock=machine.clock).name == wanted


def test_the_probe_keeps_its_time() -> None:
    machine = Machine(low=8, medium=12, default=17, high=24, ultra=29)
    pick_level(machine.draw, 20.0, 0.5, clock=machine.clock)
    assert machine.now_s < 0.6


def test_levels_get_dearer() -> None:
    assert [level.name for level in LEVELS] == ["low", "medium", "default", "high", "ultra"]
    assert all(a.samples <= b.samples for a, b in pairwise(LEVELS))


def test_an_unknown_level_is_refused_with_the_known_ones() -> None:
    with pytest.raises(KeyError, match="default"):
        level_named("best")
