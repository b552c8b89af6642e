"""Searching strategies: the best fixed one, and each reading policy's own numbers, so that policies compare fairly.

Hill climbing from the best known strategy with the same talks for every candidate (common random numbers); what it
finds is checked on fresh talks and written down with how it was found (``assets/autoplay/strategies.yaml``).
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

from game.app.autoplay.episodes import play_episode, play_with_bodies, sit_down
from game.app.body import BodyObserver
from game.app.policies import FixedPlan, Seat, Sign, Strategy, Tuned, load_tuned, seat
from game.app.talk import TalkAssets
from game.emotion import felt_label

__all__ = ["Found", "SignBank", "search", "sign_bank"]

TRAIN_SEED, CHECK_SEED, BANK_SEED = 900_001, 900_002, 900_003
"""Seeds that nobody reports results on."""
_RANGES: Mapping[str, tuple[float, float]] = {
    "open": (0.3, 0.8), "step": (0.0, 0.2), "hold": (0.2, 1.05), "turn": (0.3, 1.05), "neutral": (0.1, 0.9),
    "wait": (-0.2, 0.6), "press": (-0.2, 0.5), "disgust": (0.1, 1.05), "shy": (0.1, 1.05),
    "close_left": (-1.0, 3.0), "close_patience": (-1.0, 4.0), "close_gap": (-0.02, 0.2),
}  # fmt: skip


@dataclass(frozen=True)
class Found:
    """What a search found: the strategy, its mean surplus on fresh talks and that of the one it began with."""

    policy: str
    temperament: str
    strategy: Strategy | FixedPlan
    surplus: float
    before: float
    candidates: int
    episodes: int

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return asdict(self)


SignBank = Mapping[str, tuple[tuple[tuple[Sign, ...], tuple[Sign, ...]], ...]]
"""By felt label, what bodies really did before a choice: (signs, quiet)."""


def sign_bank(assets: TalkAssets, observer: BodyObserver, episodes: int = 300) -> SignBank:
    """What the planner displays for each felt label, to search with; reported numbers come from whole bodies."""
    watcher = seat(assets, "reader", library=observer.planner.library)
    bank: dict[str, list[tuple[tuple[Sign, ...], tuple[Sign, ...]]]] = {}
    for talk in play_with_bodies(observer, [watcher] * episodes, BANK_SEED, 0):
        for decision in talk:
            assert decision.seen is not None
            label = felt_label(assets.feelings, decision.before.feeling)
            shown = (watcher.eyes.signs(decision.seen.units), watcher.eyes.signs(decision.seen.quiet))
            bank.setdefault(label, []).append(shown)
    return {label: tuple(shown) for label, shown in bank.items()}


def _surplus(place: Seat, seed: int, episodes: int, bank: SignBank | None) -> float:
    total = 0.0
    for episode in range(episodes):
        if bank is None:
            decisions = list(play_episode(place, seed, episode))
            total += decisions[-1].after.surplus
            continue
        rng = random.Random(f"bank {seed} {episode}")
        talk = sit_down(place, seed, episode)
        while not talk.state.ended:
            known = bank.get(felt_label(place.assets.feelings, talk.state.feeling)) or bank["neutral"]
            talk.decide(*known[int(rng.random() * len(known))])
        total += talk.state.surplus
    return total / episodes


def search(
    assets: TalkAssets,
    policy: str,
    *,
    candidates: int,
    episodes: int,
    seed: int = 1,
    observer: BodyObserver | None = None,
    bank: SignBank | None = None,
    tuned: Tuned | None = None,
    tell: Callable[[int], None] = lambda talks: None,
) -> Found:
    """Climb from what is known. bank: what bodies show, for policies that look at them."""
    tuned = tuned or load_tuned()
    temperament = assets.person.id
    rng = random.Random(f"search {policy} {temperament} {seed}")
    library = None if observer is None else observer.planner.library
    start: Strategy | FixedPlan = tuned.plan(temperament) if policy == "fixed" else tuned.strategy(policy, temperament)
    place = seat(assets, policy, library=library, tuned=tuned, strategy=start)

    def worth(strategy: Strategy | FixedPlan, of_seed: int, count: int) -> float:
        own = replace(place, sit=seat(assets, policy, library=library, tuned=tuned, strategy=strategy).sit)
        return _surplus(own, of_seed, count, bank)

    best, best_worth = start, worth(start, TRAIN_SEED, episodes)
    for done in range(candidates):
        tried = _neighbour(best, rng, far=done < candidates // 3)
        found = worth(tried, TRAIN_SEED, episodes)
        if found > best_worth:
            best, best_worth = tried, found
        tell(1)
    before, after = worth(start, CHECK_SEED, 2 * episodes), worth(best, CHECK_SEED, 2 * episodes)
    if after < before:
        best, after = start, before
    return Found(policy, temperament, best, round(after, 4), round(before, 4), candidates, episodes)


def _neighbour(strategy: Strategy | FixedPlan, rng: random.Random, *, far: bool) -> Strategy | FixedPlan:
    if isinstance(strategy, FixedPlan):
        return _other_plan(strategy, rng, far)
    names = rng.sample([field.name for field in fields(Strategy)], 3 if far else 2)
    changes = {}
    for name in names:
        low, high = _RANGES[name]
        spread = (high - low) * (0.25 if far else 0.1)
        changes[name] = round(min(max(getattr(strategy, name) + rng.gauss(0.0, spread), low), high), 3)
    return replace(strategy, **changes)


def _other_plan(plan: FixedPlan, rng: random.Random, far: bool) -> FixedPlan:
    order = list(plan.order)
    for _ in range(rng.choice((0, 1, 3) if far else (0, 1))):
        moved = order.pop(rng.randrange(len(order)))
        order.insert(rng.randrange(len(order) + 1), moved)
    raises, spread = list(plan.raises), 0.06 if far else 0.03
    opened, left, gap = plan.open, plan.close_left, plan.close_gap
    what = rng.randrange(4)
    if what == 0:
        opened = round(min(max(opened + rng.gauss(0.0, 0.1), 0.3), 0.9), 3)
    elif what == 1:
        at = rng.randrange(len(raises))
        raises[at] = round(min(max(raises[at] + rng.gauss(0.0, spread), 0.0), 0.3), 3)
    elif what == 2:
        left = float(rng.choice((0, 0, 1, 2, 3)))
    else:
        gap = round(min(max(gap + rng.gauss(0.0, 0.04), -0.02), 0.3), 3)
    return FixedPlan(tuple(order), opened, tuple(raises), left, gap)
