"""The afternoon around the talks: purse, wish list, clock, what was bought, what the shopkeepers remember.

All of it is plain data and pure functions: the same seed and the same moves give the same afternoon.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from game.app.bazaar import Bazaar, Lesson
from game.app.talk import TalkAssets, TalkState, start_talk
from game.emotion import felt_label
from game.story import Memory, Script, afternoon_of, memory_of
from game.story.vocabulary import Value

__all__ = [
    "PURSE", "Afternoon", "Bought", "Reading", "StallDay", "Wish", "finish_talk", "is_closed", "lesson_of", "next_day",
    "open_day", "pass_time", "talk_minutes", "visit_stall", "walk_to",
]  # fmt: skip

PURSE = 9000
"""Yen in the purse on an ordinary day, what the checks of a script reckon with."""
MIN_PURSE = 3000
"""Yen there are in the purse at least, however short the wish list."""


@dataclass(frozen=True)
class Wish:
    """A thing on the list in the pocket."""

    stall: str
    item: str


@dataclass(frozen=True)
class Bought:
    """One purchase; prices in yen, surplus the share of the possible gain in [0, 1]."""

    stall: str
    item: str
    price: int
    list_price: int
    surplus: float


@dataclass(frozen=True)
class Reading:
    """One laid token: the feeling it named, the one that was felt, and the one the face showed."""

    stall: str
    guess: str
    felt: str
    shown: str

    @property
    def right(self) -> bool:
        """Whether the token named what was felt."""
        return self.guess == self.felt


@dataclass(frozen=True)
class StallDay:
    """What lasts between talks at one stall.

    talks, deals: of this day. annoyance: failed talks not yet forgiven. memory: what the script remembers, over
    days. trust in [0, 1] and felt: as the last talk left them; ending: its name.
    """

    talks: int = 0
    deals: int = 0
    annoyance: float = 0.0
    memory: Memory | None = None
    trust: float = 0.0
    felt: str = ""
    ending: str = ""


@dataclass(frozen=True)
class Afternoon:
    """What lasts from talk to talk. minutes: of the afternoon, since the market opened. place: where you stand.

    home: "stall/item" of things bought on earlier days. taken_back: words taken back today. shared: what the
    scripts keep in the scope ``afternoon``, for all stalls.
    """

    seed: int
    day: int = 1
    purse: int = PURSE
    budget: int = PURSE
    minutes: float = 0.0
    place: str = ""
    talks: int = 0
    stalls: Mapping[str, StallDay] = field(default_factory=dict)
    wishes: tuple[Wish, ...] = ()
    bought: tuple[Bought, ...] = ()
    readings: tuple[Reading, ...] = ()
    home: tuple[str, ...] = ()
    taken_back: int = 0
    shared: Mapping[str, Value] = field(default_factory=dict)

    def owned(self, stall: str) -> frozenset[str]:
        """The items of a stall that are yours, bought today or before."""
        today = {b.item for b in self.bought if b.stall == stall}
        return frozenset(today | {name.partition("/")[2] for name in self.home if name.startswith(f"{stall}/")})

    def at(self, stall: str) -> StallDay:
        """What is known of a stall; nothing yet where nobody has talked."""
        return self.stalls.get(stall, StallDay())

    def wished(self, stall: str, item: str) -> bool:
        """Whether a thing is on the list."""
        return Wish(stall, item) in self.wishes


def _rng(seed: int, day: int, purpose: int) -> np.random.Generator:
    return np.random.default_rng([seed & 0x7FFFFFFF, day, purpose])


def open_day(bazaar: Bazaar, scripts: Iterable[Script], seed: int, before: Afternoon | None = None) -> Afternoon:
    """A new day: a new list, a fresh purse, new moods and prices. The people keep what they remember.

    before: the day that ended; what was bought then stands at home, and is not for sale again until the tables are
    nearly empty.
    """
    scripts = tuple(scripts)
    home: tuple[str, ...] = ()
    stalls: dict[str, StallDay] = {}
    day = 1
    if before is not None:
        day = before.day + 1
        home = (*before.home, *(f"{b.stall}/{b.item}" for b in before.bought))
        stalls = {name: StallDay(memory=known.memory, trust=known.trust) for name, known in before.stalls.items()}
    wares = [(script.stall, item.id, item.list_price) for script in scripts for item in script.items.values()]
    left = [row for row in wares if f"{row[0]}/{row[1]}" not in home]
    if len(left) < 2 * bazaar.wish_count:
        home, left = (), wares
    order = [left[i] for i in _rng(seed, day, 1).permutation(len(left))]
    room = bazaar.wishes_per_stall if len(scripts) > 1 else bazaar.wish_count
    picked: list[tuple[str, str, int]] = []
    for row in order:
        if len(picked) < bazaar.wish_count and sum(p[0] == row[0] for p in picked) < room:
            picked.append(row)
    picked.sort(key=lambda row: (bazaar.stalls.index(row[0]) if row[0] in bazaar.stalls else 99, row[1]))
    step = bazaar.purse_step
    purse = max(round(sum(row[2] for row in picked) * bazaar.purse_share / step) * step, MIN_PURSE)
    return Afternoon(
        seed=seed,
        day=day,
        purse=purse,
        budget=purse,
        stalls=stalls,
        wishes=tuple(Wish(row[0], row[1]) for row in picked),
        home=home,
    )


def next_day(bazaar: Bazaar, scripts: Iterable[Script], afternoon: Afternoon) -> Afternoon:
    """The next market day, with a seed of its own."""
    return open_day(bazaar, scripts, (afternoon.seed * 69_069 + 12_345) % 2**31, afternoon)


def pass_time(bazaar: Bazaar, afternoon: Afternoon, minutes: float) -> Afternoon:
    """Time goes by; annoyance cools with it."""
    forgiven = minutes / bazaar.cooling_min
    stalls = {
        name: replace(known, annoyance=max(known.annoyance - forgiven, 0.0)) for name, known in afternoon.stalls.items()
    }
    return replace(afternoon, minutes=afternoon.minutes + minutes, stalls=stalls)


def walk_to(bazaar: Bazaar, afternoon: Afternoon, stall: str) -> Afternoon:
    """Walk along the street; the way costs time."""
    hops = bazaar.hops(afternoon.place, stall)
    return replace(pass_time(bazaar, afternoon, hops * bazaar.costs.walk), place=stall)


def is_closed(bazaar: Bazaar, afternoon: Afternoon) -> bool:
    """Whether it is too late to begin a talk."""
    return afternoon.minutes > bazaar.length_min - bazaar.last_talk_min


def talk_minutes(bazaar: Bazaar, acts: Iterable[str]) -> float:
    """How long a talk with these acts has taken so far."""
    costs = bazaar.costs
    return costs.arrive + sum(costs.wait if act == "wait" else costs.round for act in acts if act != "leave")


def lesson_of(bazaar: Bazaar, afternoon: Afternoon) -> Lesson:
    """What the next talk teaches: something on the first day, nothing to speak of later."""
    teaches = afternoon.day == 1 and afternoon.talks < len(bazaar.lessons)
    return bazaar.lessons[afternoon.talks] if teaches else Lesson()


def visit_stall(assets: TalkAssets, afternoon: Afternoon, item: str) -> TalkState:
    """Start a talk about one item: each talk has a seed of its own, so prices and moods are drawn anew."""
    known = afternoon.at(assets.script.stall)
    seed = (afternoon.seed * 1_000_003 + afternoon.talks * 7919 + 17) % 2**31
    return start_talk(
        assets,
        item,
        seed,
        purse=afternoon.purse,
        memory=known.memory,
        failed_visits=known.annoyance,
        shared=afternoon.shared,
    )


def finish_talk(
    bazaar: Bazaar,
    assets: TalkAssets,
    afternoon: Afternoon,
    talk: TalkState,
    minutes: float,
    readings: Iterable[Reading] = (),
) -> Afternoon:
    """Book a talk that has ended: time, the purchase if there was one, and what is remembered."""
    stall, won = assets.script.stall, talk.deal_price > 0
    bought = afternoon.bought
    if won:
        bought = (*bought, Bought(stall, talk.item, talk.deal_price, talk.list_price, talk.surplus))
    after = pass_time(bazaar, afternoon, minutes)
    known = after.at(stall)
    known = StallDay(
        talks=known.talks + 1,
        deals=known.deals + won,
        annoyance=known.annoyance + (not won),
        memory=memory_of(assets.script, talk.story),
        trust=talk.bargain.trust,
        felt=felt_label(assets.feelings, talk.feeling),
        ending=str(talk.beat.ended),
    )
    return replace(
        after,
        shared={**after.shared, **afternoon_of(assets.script, talk.story)},
        purse=talk.purse,
        talks=afternoon.talks + 1,
        place=stall,
        stalls={**after.stalls, stall: known},
        bought=bought,
        readings=(*afternoon.readings, *readings),
    )
