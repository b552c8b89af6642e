"""The afternoon around the talks: purse, what was bought, what the shopkeeper remembers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from game.app.talk import TalkAssets, TalkState, start_talk
from game.story import Memory, afternoon_of, memory_of

__all__ = ["PURSE", "Afternoon", "Bought", "finish_talk", "visit_stall"]

PURSE = 9000
"""Yen in the purse when the afternoon begins."""


@dataclass(frozen=True)
class Bought:
    """One purchase; prices in yen, surplus the share of the possible gain in [0, 1]."""

    item: str
    price: int
    list_price: int
    surplus: float


@dataclass(frozen=True)
class Afternoon:
    """What lasts from talk to talk. ``visits`` counts talks, ``failed_visits`` those that ended without a deal."""

    seed: int
    purse: int = PURSE
    visits: int = 0
    failed_visits: int = 0
    bought: tuple[Bought, ...] = ()
    memory: Memory | None = None
    shared: Mapping[str, float | str | bool] = field(default_factory=dict)
    """Script variables of scope ``afternoon``, shared by all stalls."""

    @property
    def owned(self) -> frozenset[str]:
        """The items bought so far."""
        return frozenset(b.item for b in self.bought)


def visit_stall(assets: TalkAssets, afternoon: Afternoon, item: str) -> TalkState:
    """Start a talk about one item: each visit has a seed of its own, so prices and moods are drawn anew."""
    seed = (afternoon.seed * 1_000_003 + afternoon.visits * 7919 + 17) % 2**31
    return start_talk(
        assets,
        item,
        seed,
        purse=afternoon.purse,
        memory=afternoon.memory,
        failed_visits=afternoon.failed_visits,
        shared=afternoon.shared,
    )


def finish_talk(assets: TalkAssets, afternoon: Afternoon, talk: TalkState) -> Afternoon:
    """Book a talk that has ended: the purchase, if there was one, and what the shopkeeper remembers."""
    bought = afternoon.bought
    if talk.deal_price:
        bought = (*bought, Bought(talk.item, talk.deal_price, talk.list_price, talk.surplus))
    return replace(
        afternoon,
        purse=talk.purse,
        visits=afternoon.visits + 1,
        failed_visits=afternoon.failed_visits + (0 if talk.deal_price else 1),
        bought=bought,
        memory=memory_of(assets.script, talk.story),
        shared={**afternoon.shared, **afternoon_of(assets.script, talk.story)},
    )
