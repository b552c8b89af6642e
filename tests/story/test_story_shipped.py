"""The shipped stalls: everything can be reached, nothing repeats, both languages are there, hands find their words."""

from __future__ import annotations

import random
from collections import Counter

import pytest

from game.core.paths import ASSETS
from game.formats.yaml_source import load_yaml
from game.story import (
    ACTS,
    Memory,
    Start,
    TimedText,
    advance,
    afternoon_of,
    begin,
    load_script,
    memory_of,
    shipped_stalls,
    wrap,
)
from game.story.text import slots

STALLS = [path.stem for path in shipped_stalls()]


@pytest.fixture(scope="module", params=STALLS)
def stall(request):
    return next(load_script(path) for path in shipped_stalls() if path.stem == request.param)


def shipped(name):
    return next(load_script(path) for path in shipped_stalls() if path.stem == name)


def test_size_of_the_stall(stall):
    assert len(stall.nodes) >= 60
    assert {choice.act for choice in stall.pools["talk"]} == set(ACTS)
    assert len(stall.endings) >= 8


def test_random_walks_reach_every_node_choice_and_ending(stall, talk):
    nodes, offered, taken, ended = set(), set(), set(), Counter()
    rng = random.Random(5)
    memory = None
    for seed in range(900):
        # An afternoon of four visits, then the stall forgets.
        memory = None if seed % 4 == 0 else memory
        player = talk(stall, item=rng.choice(list(stall.items)), seed=seed, memory=memory)
        while not player.beat.ended:
            offered |= {choice.id for choice in player.beat.choices}
            player.random_move(rng, known=taken)
        memory = memory_of(stall, player.state)
        taken |= player.state.chosen
        nodes |= set(player.state.visits)
        ended[player.beat.ended] += 1
        if nodes >= set(stall.nodes) and taken >= set(stall.choices):
            break
    assert set(stall.nodes) - nodes == set()
    assert set(stall.choices) - offered == set()
    assert set(stall.choices) - taken == set()
    assert set(stall.endings) == set(ended)


def test_she_remembers(flea, talk):
    player = talk(flea, item="vase")
    player.choose("leave", "walked_away", trust=0.6)
    assert player.beat.ended == "left_friends"
    memory = memory_of(flea, player.state)
    again = talk(flea, item="vase", memory=memory)
    assert again.beat.lines[0].id in {"again_hidden", "again_front", "again_know", "again_well"}
    assert {talk(flea, item="vase", memory=memory, seed=s).beat.lines[0].id for s in range(30)} >= {"again_hidden"}
    other = talk(flea, item="cups", memory=memory)
    assert [line.id for line in other.beat.lines][1] == "about_cups"


def test_what_he_told_changes_how_it_ends(talk):
    """Who has asked about ten to two sees the watch wound; who has not, buys a watch."""
    antiques = shipped("antiques")
    for hour, ending in ((0, "good_deal"), (2, "wound"), (3, "wound")):
        known = Memory(visits=1, variables={"hour": hour})
        player = talk(antiques, item="pocket_watch", memory=known)
        player.choose("offer", "deal", offer=5400, deal_price=5400)
        assert player.beat.ended == ending
        assert ("wound_owed" in player.state.said) == (hour == 2)
    assert memory_of(antiques, player.state).variables["hour"] == 3


@pytest.mark.parametrize(("item", "ending"), [("teddy_bear", "bear_stays"), ("kokeshi", "left_friends")])
def test_what_nobody_was_meant_to_buy_stays(item, ending, talk):
    player = talk(shipped("toys"), item=item)
    player.choose("leave", "walked_away", trust=0.6)
    assert player.beat.ended == ending


@pytest.mark.parametrize(("stall", "line"), [("antiques", "hub_flea_cross"), ("toys", "hub_flea_cross")])
def test_the_market_hears_how_she_was_treated(stall, line, flea, talk):
    """A quarrel at one stall is known at the others, for the afternoon."""
    rude = talk(flea, item="vase")
    for _ in range(2):
        rude.choose("offer", "insulted", offer=900, offer_result="insult")
    rude.choose("wait", "out_of_patience", trust=0.1)
    news = afternoon_of(flea, rude.state)
    assert news["flea_news"] == "cross"
    other = shipped(stall)
    item = next(iter(other.items))
    for heard in (news, {}):
        said = set()
        for seed in range(60):
            state, _ = advance(other, begin(other, item, seed, afternoon=heard), Start(), {"list_price": 3000})
            said |= state.said
        assert (line in said) == bool(heard)


def test_nothing_repeats_word_for_word_within_a_talk(stall, talk):
    rng = random.Random(6)
    for seed in range(40):
        player = talk(stall, item=rng.choice(list(stall.items)), seed=seed)
        while not player.beat.ended:
            player.random_move(rng)
        for language in ("en", "ja"):
            # Prices may recur: what counts is the wording.
            said = [line.id for beat in player.beats for line in beat.lines]
            words = [line.text(language) for beat in player.beats for line in beat.lines]
            assert len(said) == len(set(said))
            assert len(words) == len(set(words))


def test_there_is_always_something_to_say(stall, talk):
    """In six rounds of any talk, every move of the player is answered by the shopkeeper."""
    rng = random.Random(7)
    for seed in range(40):
        player = talk(stall, item=rng.choice(list(stall.items)), seed=seed)
        while not player.beat.ended:
            player.random_move(rng)
            assert any(line.speaker == "shopkeeper" for line in player.beat.lines)
            assert player.beat.ended or sum(choice.act in ACTS for choice in player.beat.choices) == 4


def test_words_in_both_languages_fit_the_box(stall):
    for line in stall.all_lines():
        for language in ("en", "ja"):
            text = line.text.get(language)
            assert text
            assert len(wrap(text, language)) <= 3
        assert {name for name, _ in slots(line.text.en)} == {name for name, _ in slots(line.text.ja)}
        # Japanese is Japanese.
        assert any("\u3040" <= char <= "\u9fff" for char in line.text.ja) or not any(map(str.isalpha, line.text.en))
        assert line.text.en.isascii() or not any("\u3040" <= char <= "\u9fff" for char in line.text.en)


def test_the_hands_find_their_words(stall):
    behaviours = load_yaml(ASSETS / "motion" / "behaviours.yaml")["behaviours"].to_python()
    words = {name: unit["words"] for name, unit in behaviours.items() if "words" in unit}
    lines = [line for line in stall.all_lines() if line.speaker == "shopkeeper"]
    for language in ("en", "ja"):
        found = Counter()
        moved = 0
        for line in lines:
            timed = TimedText(line.text.get(language), language)
            units = [name for name, lists in words.items() if timed.cues(lists.get(language, ()))]
            found.update(units)
            moved += bool(units)
        assert moved >= 0.5 * len(lines), f"only {moved} of {len(lines)} lines call a gesture in {language}"
        assert len(found) >= 0.7 * len(words), f"never called in {language}: {sorted(set(words) - set(found))}"
