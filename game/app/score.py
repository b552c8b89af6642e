"""What an afternoon came to: points that explain themselves, and the sentences of the evening."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from game.app.afternoon import Afternoon, StallDay
from game.app.bazaar import Bazaar
from game.app.wishes import WishText, text_of
from game.core.paths import ASSETS
from game.formats.yaml_source import load_yaml
from game.story import Text

__all__ = ["Epilogue", "Part", "Score", "load_epilogue", "score_of", "standing"]

WISHES_MAX, PRICE_MAX, PEOPLE_MAX, READING_MAX = 40, 25, 20, 15
FULL_BUYS, FULL_READINGS = 3, 5
"""So many purchases and laid tokens before price and reading count in full: one lucky guess is no skill."""
CHANCE = 1.0 / 7.0
TAKEN_BACK = 2
GOODWILL = {"warm": 1.0, "even": 0.6, "sore": 0.1}
SOUR = frozenset({"anger", "disgust"})


@dataclass(frozen=True)
class Part:
    """One row of the score: a key of the interface's texts, points of most points, and what they stand on."""

    key: str
    points: int
    most: int
    why: Mapping[str, str]


@dataclass(frozen=True)
class Score:
    """parts: the rows; total: 0 to 100."""

    parts: tuple[Part, ...]

    @property
    def total(self) -> int:
        """All points together, never below 0."""
        return max(sum(part.points for part in self.parts), 0)


def standing(known: StallDay) -> str:
    """How somebody was left today: unmet, warm, even or sore."""
    if known.talks == 0:
        return "unmet"
    if known.trust < 0.2 or (known.felt in SOUR and not known.deals):
        return "sore"
    return "warm" if known.trust >= 0.5 and known.felt not in SOUR else "even"


def score_of(afternoon: Afternoon) -> Score:
    """Wishes, prices, people and readings; words taken back cost a little."""
    got = sum(wish.item in afternoon.owned(wish.stall) for wish in afternoon.wishes)
    total = max(len(afternoon.wishes), 1)
    surplus = [b.surplus for b in afternoon.bought]
    mean = sum(surplus) / len(surplus) if surplus else 0.0
    price = PRICE_MAX * mean * min(len(surplus) / FULL_BUYS, 1.0)
    met = [standing(known) for known in afternoon.stalls.values() if known.talks]
    people = PEOPLE_MAX * sum(GOODWILL[name] for name in met) / len(met) if met else 0.0
    laid, right = len(afternoon.readings), sum(r.right for r in afternoon.readings)
    lift = max((right / laid - CHANCE) / (1.0 - CHANCE), 0.0) if laid else 0.0
    reading = READING_MAX * lift * min(laid / FULL_READINGS, 1.0)
    parts = [
        Part("score_wishes", round(WISHES_MAX * got / total), WISHES_MAX, {"count": str(got), "total": str(total)}),
        Part("score_price", round(price), PRICE_MAX, {"share": f"{mean:.0%}", "count": str(len(surplus))}),
        Part("score_people", round(people), PEOPLE_MAX, {"count": str(met.count("warm")), "total": str(len(met))}),
        Part("score_reading", round(reading), READING_MAX, {"count": str(right), "total": str(laid)}),
    ]
    if afternoon.taken_back:
        parts.append(Part("score_back", -TAKEN_BACK * afternoon.taken_back, 0, {"count": str(afternoon.taken_back)}))
    return Score(tuple(parts))


@dataclass(frozen=True)
class Epilogue:
    """The texts of the evening: part -> variant -> text; people: stall -> variant -> text; ranks best first."""

    parts: Mapping[str, Mapping[str, Text]]
    people: Mapping[str, Mapping[str, Text]]
    ranks: tuple[tuple[int, Text], ...]

    def rank(self, score: Score) -> Text:
        """The name of what was reached."""
        return next(text for least, text in self.ranks if score.total >= least)

    def variants(self, bazaar: Bazaar, afternoon: Afternoon) -> dict[str, str]:
        """Which variant of each part this afternoon calls for."""
        got = sum(wish.item in afternoon.owned(wish.stall) for wish in afternoon.wishes)
        total = max(len(afternoon.wishes), 1)
        opening = "all" if got == total else "most" if got * 2 >= total and got else "some" if got else "none"
        surplus = [b.surplus for b in afternoon.bought]
        mean = sum(surplus) / len(surplus) if surplus else 0.0
        price = "nothing" if not surplus else "high" if mean >= 0.7 else "middle" if mean >= 0.35 else "low"
        laid, right = len(afternoon.readings), sum(r.right for r in afternoon.readings)
        through = sum(r.right and r.guess != r.shown and r.shown in ("joy", "neutral") for r in afternoon.readings)
        share = right / laid if laid else 0.0
        reading = "silent"
        if laid:
            reading = "sharp" if share >= 0.6 and laid >= 3 else "fair" if share >= 0.35 else "poor"
        if reading == "sharp" and through >= 2:
            reading = "through"
        late = bazaar.day_share(afternoon.minutes) >= 0.9
        chosen = {"opening": opening, "price": price, "reading": reading, "closing": "late" if late else "early"}
        return chosen | {f"people:{name}": standing(afternoon.at(name)) for name in self.people}

    def tell(
        self,
        bazaar: Bazaar,
        afternoon: Afternoon,
        stalls: Iterable[str],
        wishes: Mapping[tuple[str, str], WishText],
        language: str,
        money: str,
    ) -> list[str]:
        """The evening, a paragraph each: the list, its things, the price, the people, the reading, the hour."""
        chosen = self.variants(bazaar, afternoon)
        got = sum(wish.item in afternoon.owned(wish.stall) for wish in afternoon.wishes)
        slots = {"{count}": str(got), "{total}": str(len(afternoon.wishes)), "{money}": money}

        def said(text: Text) -> str:
            words = text.get(language)
            for slot, value in slots.items():
                words = words.replace(slot, value)
            return words

        gap = " " if language == "en" else ""
        things = []
        for wish in afternoon.wishes:
            text = wishes.get((wish.stall, wish.item))
            if text is not None:
                things.append((text.got if wish.item in afternoon.owned(wish.stall) else text.missed).get(language))
        people = [self.people[name][chosen[f"people:{name}"]].get(language) for name in stalls if name in self.people]
        last = [self.parts[name][chosen[name]] for name in ("reading", "closing")]
        paragraphs = [
            [said(self.parts["opening"][chosen["opening"]])],
            things,
            [said(self.parts["price"][chosen["price"]])],
            people,
            [text.get(language) for text in last],
        ]
        return [gap.join(rows) for rows in paragraphs if rows]


def load_epilogue(path: Path = ASSETS / "market" / "epilogue.yaml") -> Epilogue:
    """Read the evening's texts. Raises BadInput with file:line:col."""
    root = load_yaml(path).only("opening", "price", "people", "reading", "closing", "ranks")
    parts = {
        name: {key.as_str(): text_of(node) for key, node in root[name].items()}
        for name in ("opening", "price", "reading", "closing")
    }
    people = {
        stall.as_str(): {key.as_str(): text_of(node) for key, node in rows.only(*GOODWILL, "unmet").items()}
        for stall, rows in root["people"].items()
    }
    ranks = []
    for node in root["ranks"].as_list():
        node.only("from", "en", "ja")
        ranks.append((node["from"].as_int(0, 100), Text(node["en"].as_str(), node["ja"].as_str())))
    return Epilogue(parts, people, tuple(sorted(ranks, key=lambda row: -row[0])))
