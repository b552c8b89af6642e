"""Earlier visits: what a reader has learnt of a person's habits before any talk that counts."""

from __future__ import annotations

from collections import Counter

from game.app.autoplay.episodes import play_with_bodies
from game.app.body import BodyObserver
from game.app.policies import Acquaintance, BodyReading, seat
from game.app.talk import TalkAssets

__all__ = ["VISITS", "habits_of"]

VISITS = 32
VISITS_SEED = 900_004
USUAL = 2.0
"""A unit seen so many times as often as feelings account for is a habit, as far as it is more than that. One that
regular customers know, because it comes in every greeting, is so as far as it is more than feelings account for."""


def habits_of(assets: TalkAssets, observer: BodyObserver) -> dict[str, float]:
    """By unit, the share of its appearances that feelings do not account for.

    Moods are not known on these visits, only how likely each is: what a person does more often than their moods
    explain says little about the mood of the day.
    """
    library = observer.planner.library
    guest = seat(assets, "random", library=library)
    seen: Counter[str] = Counter()
    for talk in play_with_bodies(observer, [guest] * VISITS, VISITS_SEED, 0):
        for decision in talk:
            if decision.seen is not None:
                seen.update(decision.seen.units.keys())
    layers = {unit.name: unit.layer for unit in library.units}
    total: Counter[str] = Counter()
    for name, count in seen.items():
        total[layers[name]] += count
    expected = BodyReading(library).expected(Acquaintance(assets).prior)
    usual = {name: 1.0 if name in assets.person.habit_units else USUAL for name in seen}
    return {
        name: max(0.0, 1.0 - usual[name] * expected[name] * total[layers[name]] / count) for name, count in seen.items()
    }
