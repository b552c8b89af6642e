"""The evening: every variant is reachable and written in both languages; the score is the sum of what it says."""

from __future__ import annotations

from dataclasses import replace

import pytest

from game.app.afternoon import Afternoon, Bought, Reading, StallDay, Wish
from game.app.bazaar import load_bazaar
from game.app.score import load_epilogue, score_of, standing
from game.app.wishes import load_wishes

BAZAAR, TEXTS, WISHES = load_bazaar(), load_epilogue(), load_wishes()
LIST = (Wish("flea", "vase"), Wish("flea", "cups"), Wish("antiques", "ink_stone"), Wish("toys", "kokeshi"))


def buy(*wishes: Wish, surplus: float) -> tuple[Bought, ...]:
    return tuple(Bought(w.stall, w.item, 1000, 1200, surplus) for w in wishes)


def readings(right: int, wrong: int, shown: str = "anger") -> tuple[Reading, ...]:
    return (Reading("flea", "anger", "anger", shown),) * right + (Reading("flea", "anger", "fear", shown),) * wrong


def test_every_variant_of_every_part_is_reached_by_some_afternoon() -> None:
    plain = Afternoon(seed=1, wishes=LIST)
    known = {
        "warm": StallDay(talks=1, deals=1, trust=0.6, felt="joy"),
        "even": StallDay(talks=1, trust=0.4, felt="neutral"),
        "sore": StallDay(talks=1, trust=0.4, felt="anger"),
        "unmet": StallDay(),
    }
    days = [
        plain,
        replace(plain, bought=buy(*LIST, surplus=0.9), minutes=300),
        replace(plain, bought=buy(*LIST[:2], surplus=0.5), readings=readings(4, 1)),
        replace(plain, bought=buy(LIST[0], surplus=0.1), readings=readings(2, 3)),
        replace(plain, readings=readings(0, 3)),
        replace(plain, readings=readings(4, 1, shown="joy")),
        *(replace(plain, stalls=dict.fromkeys(BAZAAR.stalls, day)) for day in known.values()),
    ]
    seen: dict[str, set[str]] = {}
    for day in days:
        for part, variant in TEXTS.variants(BAZAAR, day).items():
            seen.setdefault(part, set()).add(variant)
    for part, variants in TEXTS.parts.items():
        assert seen[part] == set(variants), part
    for stall, variants in TEXTS.people.items():
        assert seen[f"people:{stall}"] == set(variants) == set(known), stall


def test_the_evening_is_told_in_both_languages_without_gaps() -> None:
    day = Afternoon(seed=1, wishes=LIST, bought=buy(LIST[0], LIST[2], surplus=0.8), stalls={"flea": StallDay(talks=1)})
    for language in ("en", "ja"):
        told = TEXTS.tell(BAZAAR, day, BAZAAR.stalls, WISHES, language, "¥4,200")
        whole = "\n".join(told)
        assert "{" not in whole
        assert "¥4,200" in whole
        assert WISHES["flea", "vase"].got.get(language) in whole
        assert WISHES["flea", "cups"].missed.get(language) in whole
        assert all(TEXTS.people[stall] for stall in BAZAAR.stalls)
    alone = TEXTS.tell(BAZAAR, day, ("flea",), WISHES, "en", "¥1")
    assert not any("Aoyagi" in text for text in alone), "who is not at the market is not spoken of"


def test_the_score_rises_with_each_thing_it_names_and_explains_itself() -> None:
    plain = Afternoon(seed=1, wishes=LIST)
    assert score_of(plain).total == 0
    got = replace(plain, bought=buy(*LIST, surplus=0.8))
    liked = replace(got, stalls={"flea": StallDay(talks=2, deals=2, trust=0.7, felt="joy")})
    read = replace(liked, readings=readings(5, 0))
    totals = [score_of(day).total for day in (plain, got, liked, read)]
    assert totals == sorted(set(totals))
    assert totals[-1] == 40 + 20 + 20 + 15
    assert score_of(replace(read, taken_back=3)).total == totals[-1] - 6
    assert score_of(replace(plain, readings=readings(1, 6))).total == 0, "one in seven is chance"
    for part in score_of(read).parts:
        assert 0 <= part.points <= part.most
        assert part.why


@pytest.mark.parametrize("total", [0, 29, 30, 67, 85, 100])
def test_every_score_has_a_rank(total: int) -> None:
    ranks = [text.en for least, text in TEXTS.ranks if total >= least]
    assert ranks
    assert TEXTS.ranks[-1][0] == 0


def test_a_guest_who_bought_in_peace_is_not_left_sore() -> None:
    assert standing(StallDay(talks=1, deals=1, trust=0.3, felt="anger")) == "even"
    assert standing(StallDay(talks=1, deals=1, trust=0.1)) == "sore"
