"""A talk as a whole: lines, choices, reactions, outcomes, chance; with ``talk`` both straight and through saves."""

from __future__ import annotations

import json
import random
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from game.core.emotion_space import EMOTIONS
from game.core.errors import BadInput, Where
from game.story import (
    ACTS,
    Chose,
    Memory,
    Script,
    Start,
    Warp,
    advance,
    begin,
    load_script,
    memory_of,
    restore,
    resume,
    save,
)  # fmt: skip
from game.story.chance import Lots, pick_weighted, shuffled, uniform, uniforms


def _edited(tmp_path: Path, text: str, *edits: tuple[str, str]) -> Script:
    for old, new in edits:
        assert old in text
        text = text.replace(old, new, 1)
    path = tmp_path / "tiny.yaml"
    path.write_text(text, encoding="utf-8")
    return load_script(path)


def _ids(beat):
    return [line.id for line in beat.lines]


def test_greeting_then_hub_then_choices(talk, tiny):
    beat = talk(tiny).beat
    assert _ids(beat)[0] == "hello_1"
    assert _ids(beat)[1] in {"hub_1", "hub_2"}
    assert beat.node == "hub"
    assert beat.ended is None
    assert {choice.id for choice in beat.choices[-3:]} == {"offer", "wait", "leave"}
    assert len(beat.choices) == 7


def test_both_languages_are_filled_in(talk, tiny):
    player = talk(tiny, item="pot")
    offer = player.beat.choice("offer")
    assert offer.text("en") == "{offer} for the pot?"
    beat = player.choose("offer", "refused_offer", offer=1234.4, offer_result="refused")
    assert beat.lines[0].speaker == "player"
    assert beat.lines[0].en == "¥1,234 for the pot?"
    assert beat.lines[0].ja == "急須、1,234円では?"
    assert beat.lines[1].text("ja") == "1,234円は無理。"


@pytest.mark.parametrize(
    ("quality", "tells", "line"),
    [
        ("right", True, "answer_right"),
        ("neutral", True, "answer_neutral"),
        ("wrong", True, "answer_wrong"),
        ("wrong", False, "answer_veiled"),
        ("none", True, "answer_veiled"),
    ],
)
def test_the_answer_tells_how_a_line_landed_or_hides_it(talk, tiny, quality, tells, line):
    player = talk(tiny)
    drawn = next(choice for choice in player.beat.choices if choice.act in ACTS and choice.act != "story")
    beat = player.choose(drawn.id, quality=quality, tells=tells)
    assert _ids(beat)[:2] == [drawn.id, line]


def test_a_line_that_carries_an_offer_is_answered_twice(talk, tiny):
    player = talk(tiny)
    drawn = next(choice for choice in player.beat.choices if choice.act in ACTS and choice.act != "story")
    beat = player.choose(
        drawn.id, "refused_offer", quality="right", tells=True, offer=40, offer_result="refused", round=2
    )
    assert _ids(beat)[:4] == [drawn.id, "offer", "answer_right", "low_1"]
    assert beat.node == "hub"


@pytest.mark.parametrize(
    ("outcome", "line", "ended"),
    [
        ("deal", "sold_1", "bought"),
        ("out_of_patience", "tired_1", "left"),
        ("sudden_end", "tired_1", "left"),
        ("rounds_out", "tired_1", "left"),
        ("walked_away", "gone_1", "left"),
    ],
)
def test_outcomes_end_the_talk_after_the_answer(talk, tiny, outcome, line, ended):
    player = talk(tiny)
    drawn = next(choice for choice in player.beat.choices if choice.act in ACTS and choice.act != "story")
    beat = player.choose(drawn.id, outcome, quality="wrong", tells=True, deal_price=80)
    assert _ids(beat)[1:] == ["answer_wrong", line]
    assert beat.ended == ended
    assert beat.choices == ()
    with pytest.raises(BadInput, match="goes on"):
        player.choose("leave")


def test_an_outcome_without_a_choice(talk, tiny):
    beat = talk(tiny).happen("sudden_end")
    assert beat.ended == "left"
    assert _ids(beat) == ["tired_1"]


def test_an_unmapped_outcome_changes_nothing(talk, tiny):
    beat = talk(tiny).choose("leave", "called_back")
    assert beat.ended is None
    assert beat.node == "hub"


def test_called_node_comes_back_and_goes_on(talk, tiny):
    player = talk(tiny, item="cup", seed=3)
    while not any(choice.id == "ask_story" for choice in player.beat.choices):
        player.choose("wait")
    beat = player.choose("ask_story")
    assert _ids(beat)[:4] == ["ask_story", "tale_1", "aside_1", "tale_cup"]
    assert player.state.variables["told"] == 1
    assert player.state.variables["warm"] is True
    assert [stimulus.feel for stimulus in beat.stimuli] == [{"sadness": 0.1}]


def test_the_way_on_depends_on_the_item(talk, tiny):
    player = talk(tiny, item="pot", seed=3)
    while not any(choice.id == "ask_story" for choice in player.beat.choices):
        player.choose("wait")
    assert "tale_cup" not in _ids(player.choose("ask_story"))


def test_once_only_choices_do_not_come_again(talk, tiny):
    player = talk(tiny, seed=5)
    taken = []
    for _ in range(5):
        drawn = [choice.id for choice in player.beat.choices if choice.act in ACTS]
        assert not set(drawn) & set(taken)
        taken.append(drawn[0])
        player.choose(drawn[0])
    assert [choice.id for choice in player.beat.choices] == ["offer", "wait", "leave"]


def test_nothing_is_said_twice(talk, tiny):
    player = talk(tiny)
    for _ in range(8):
        player.choose("wait")
    said = [line.id for beat in player.beats for line in beat.lines]
    assert len(said) == len(set(said))


def test_silent_choices_say_nothing(talk, tiny):
    assert _ids(talk(tiny).choose("wait"))[0] == "quiet_1"


def test_greyed_choices_tell_why(talk, tiny_text, tmp_path):
    text = (
        "      - id: beg\n        act: offer\n        en: Please.\n        ja: お願い。\n"
        "        needs: {if: trust > 0.5, en: She does not know you., ja: まだ他人。}\n"
    )
    script = _edited(tmp_path, tiny_text, ("    pool: talk\n  answer", f"    pool: talk\n    choices:\n{text}  answer"))
    player = talk(script)
    beg = player.beat.choice("beg")
    assert not beg.available
    assert beg.reason is not None
    assert beg.reason.ja == "まだ他人。"
    with pytest.raises(BadInput, match="choice"):
        player.choose("beg")
    player.choose("wait", trust=0.6)
    assert player.beat.choice("beg").available


def test_wrong_events_are_refused(tiny):
    state = begin(tiny, "cup", 1)
    with pytest.raises(BadInput, match="Start once"):
        advance(tiny, state, Chose("leave"), {})
    state, beat = advance(tiny, state, Start(), {})
    with pytest.raises(BadInput, match="Start once"):
        advance(tiny, state, Start(), {})
    with pytest.raises(BadInput, match="choice"):
        advance(tiny, state, Chose("nonsense"), {})
    with pytest.raises(BadInput, match="outcome"):
        advance(tiny, state, Chose("leave", "exploded"), {})
    with pytest.raises(BadInput, match="trust"):
        advance(tiny, state, Chose("leave"), {"trust": "much"})
    with pytest.raises(BadInput, match="item"):
        begin(tiny, "boat", 1)
    with pytest.raises(BadInput, match="choice"):
        beat.choice("nonsense")


def test_advance_changes_nothing_it_was_given(tiny):
    state, beat = advance(tiny, begin(tiny, "cup", 1), Start(), {})
    before = json.dumps(save(state))
    env = {"trust": 0.5}
    advance(tiny, state, Chose(beat.choices[0].id), env)
    assert json.dumps(save(state)) == before
    assert env == {"trust": 0.5}


def test_same_seed_same_talk_other_seed_another(tiny):
    def told(seed):
        state, beat = advance(tiny, begin(tiny, "cup", seed), Start(), {})
        log = [_ids(beat), [choice.id for choice in beat.choices]]
        for _ in range(4):
            state, beat = advance(tiny, state, Chose("wait"), {})
            log.append([choice.id for choice in beat.choices])
        return log

    assert told(1) == told(1)
    assert len({json.dumps(told(seed)) for seed in range(12)}) > 6


# --- later visits and other scripts ---------------------------------------------------------------------------


def test_a_second_visit_remembers(tiny):
    state, _ = advance(tiny, begin(tiny, "cup", 1), Start(), {})
    memory = Memory.from_dict(json.loads(json.dumps(memory_of(tiny, state).to_dict())), Where("save"))
    assert memory.visits == 1
    again = begin(tiny, "cup", 2, memory=memory)
    assert again.visit == 2
    _, beat = advance(tiny, again, Start(), {})
    assert _ids(beat)[0] == "hello_2"


def test_came_back_starts_elsewhere_and_stall_choices_stay_used(tiny_text, tmp_path):
    script = _edited(
        tmp_path,
        tiny_text,
        ("  walked_away: gone", "  walked_away: gone\n  came_back: aside"),
        ("id: chat, act: small_talk,", "id: chat, act: small_talk, once: stall,"),
    )
    memory = Memory(1, frozenset({"chat"}), {})
    _, beat = advance(script, begin(script, "cup", 1, memory=memory), Start(), {})
    assert _ids(beat)[0] == "aside_1"
    for seed in range(10):
        _, beat = advance(script, begin(script, "cup", seed, memory=memory), Start(), {})
        assert "chat" not in {choice.id for choice in beat.choices}


def test_saves_survive_edits_of_the_script(tiny, tiny_text, tmp_path):
    state, beat = advance(tiny, begin(tiny, "cup", 4), Start(), {})
    drawn = next(choice.id for choice in beat.choices if choice.act in ACTS)
    data = json.loads(json.dumps(save(state)))
    renamed = _edited(
        tmp_path,
        tiny_text,
        (f"{{id: {drawn},", "{id: renamed,"),
        ("told: 0,", "told: false,"),
        ("told < 2", "not told"),
        ("told + 1", "true"),
        ("told >= 1", "told"),
    )
    back = restore(renamed, data)
    assert drawn not in dict(back.offered)
    assert back.variables["told"] is False
    assert back.node == "hub"
    _, after = advance(renamed, back, Chose("wait"), {})
    assert after.ended is None
    data["node"] = "a_node_that_is_gone"
    assert restore(tiny, data).node == "hub"


@pytest.mark.parametrize(
    ("key", "value", "pointer"),
    [
        ("version", 99, "/version"),
        ("stall", "elsewhere", "/stall"),
        ("item", "boat", "/item"),
        ("seed", -1, "/seed"),
        ("seed", 2**70, "/seed"),
        ("counter", "many", "/counter"),
        ("started", "yes", "/started"),
        ("ended", 3, "/ended"),
        ("visits", {"hub": -2}, "/visits"),
        ("visits", {"hub": 2**40}, "/visits"),
        ("heard", {"hello_1": 2**40}, "/heard"),
        ("said", "hello_1", "/said"),
        ("said", [1], "/said"),
        ("offered", [["a"]], "/offered"),
        ("offered", 7, "/offered"),
        ("variables", {"told": 1e300}, "/variables"),
        ("variables", {"told": [1]}, "/variables"),
        ("returns", None, "/returns"),
    ],
)
def test_broken_saves_name_the_place(tiny, key, value, pointer):
    state, _ = advance(tiny, begin(tiny, "cup", 1), Start(), {})
    data = save(state) | {key: value}
    with pytest.raises(BadInput, match=pointer):
        restore(tiny, data)
    with pytest.raises(BadInput, match="a saved talk"):
        restore(tiny, [data])


def test_resume_before_the_first_word_and_after_the_last(tiny):
    state = restore(tiny, save(begin(tiny, "cup", 1)))
    same, beat = resume(tiny, state, {})
    assert (same, beat.lines, beat.choices) == (state, (), ())
    state, beat = advance(tiny, state, Start(), {})
    state, beat = advance(tiny, state, Chose("leave", "walked_away"), {})
    back, again = resume(tiny, restore(tiny, json.loads(json.dumps(save(state)))), {})
    assert again == beat
    assert back == state


def test_resume_offers_anew_what_an_edit_took_away(tiny):
    state, _ = advance(tiny, begin(tiny, "cup", 1), Start(), {})
    data = save(state) | {"offered": [["gone", "gone"]]}
    back, beat = resume(tiny, restore(tiny, data), {})
    assert len(beat.choices) == 7
    after, _ = advance(tiny, back, Chose(beat.choices[0].id), {})
    assert after.chosen == {beat.choices[0].id}


@pytest.mark.parametrize("data", [None, [], {}, {"visits": 1, "seen": "x", "variables": {}}, {"visits": -1}])
def test_broken_memories_are_refused(data):
    with pytest.raises(BadInput, match=r"memory\.json"):
        Memory.from_dict(data, Where("memory.json"))


def test_values_may_come_from_numpy(tiny):
    env = {"trust": np.float64(0.5), "tidying": np.bool_(True), "round": np.int64(2)}
    _, beat = advance(tiny, begin(tiny, "cup", 1), Start(), env)
    assert beat.choices
    with pytest.raises(BadInput, match="ask"):
        advance(tiny, begin(tiny, "cup", 1), Start(), {"ask": float("nan")})


# --- the draw -------------------------------------------------------------------------------------------------


def test_the_draw_covers_six_feelings_with_four_different_acts(flea):
    for seed in range(40):
        _, beat = advance(flea, begin(flea, "vase", seed), Start(), {"list_price": 3200, "ask": 3200})
        acts = [choice.act for choice in beat.choices if choice.act in ACTS]
        assert len(set(acts)) == 4
        right = [label for label in EMOTIONS if any(flea.acts.judge(act, label) == "right" for act in acts)]
        assert len(right) >= 6


def test_the_draw_knows_nothing_of_how_the_line_landed(flea):
    for seed in range(10):
        state, beat = advance(flea, begin(flea, "cups", seed), Start(), {})
        offers = set()
        for quality in ("right", "neutral", "wrong"):
            for tells in (False, True):
                env = {"quality": quality, "tells": tells}
                _, after = advance(flea, state, Chose(beat.choices[0].id), env)
                offers.add(tuple(choice.id for choice in after.choices))
        assert len(offers) == 1


def test_every_act_gets_its_turn(flea):
    seen = Counter()
    for seed in range(120):
        _, beat = advance(flea, begin(flea, "books", seed), Start(), {})
        seen.update(choice.act for choice in beat.choices if choice.act in ACTS)
    assert set(seen) == set(ACTS)
    assert min(seen.values()) > 15


def test_chance_is_even_and_repeatable():
    values = [uniform(7, counter) for counter in range(4000)]
    assert values == [uniform(7, counter) for counter in range(4000)]
    assert all(0 <= value < 1 for value in values)
    counts = Counter(int(value * 10) for value in values)
    assert all(330 < counts[tenth] < 470 for tenth in range(10))
    # Neighbouring seeds are unrelated.
    other = [uniform(8, counter) for counter in range(4000)]
    assert abs(sum((a - 0.5) * (b - 0.5) for a, b in zip(values, other, strict=True)) / 4000) < 0.01
    picks = Counter(pick_weighted([1, 3], uniform(1, counter)) for counter in range(2000))
    assert 1350 < picks[1] < 1650
    assert sorted(shuffled(6, uniforms(1, 0, 5))) == list(range(6))
    assert Counter(shuffled(3, uniforms(seed, 0, 2))[0] for seed in range(600))[0] > 150


def test_many_numbers_at_once_are_those_of_one_after_the_other():
    rng = random.Random(5)
    for count in range(17):
        seed, counter = rng.getrandbits(53), rng.getrandbits(rng.randrange(1, 40))
        assert uniforms(seed, counter, count) == [uniform(seed, counter + at) for at in range(count)]


def test_lots_are_drawn_as_weights_have_it():
    class Thing:
        def __init__(self, weight):
            self.weight = weight

    rng = random.Random(6)
    for weights in ([1.0] * 7, [1.0, 2.0, 0.5], [3.0]):
        lots = Lots([Thing(weight) for weight in weights])
        for chance in [rng.random() for _ in range(200)] + [0.0, 1.0 - 2.0**-53]:
            assert lots.items.index(lots.draw(chance)) == pick_weighted(weights, chance)


def test_a_thousand_random_moves_stay_on_the_rails(talk, tiny):
    rng = random.Random(11)
    for seed in range(60):
        player = talk(tiny, seed=seed)
        for _ in range(20):
            if player.beat.ended:
                break
            assert player.random_move(rng).choices or player.beat.ended
        assert player.beat.ended in {"bought", "left"}


def test_a_state_is_the_same_with_its_ids_as_with_its_bits(tiny):
    """what a step keeps as bits and in order is told as ids and counts; a state made of those plays on the same way."""
    state, beat = advance(tiny, begin(tiny, "cup", 3), Start(), {})
    for turn in range(3):
        copy = restore(tiny, save(state))
        assert copy == state
        assert set(state.last_lines) <= state.said
        event = Chose([choice.id for choice in beat.choices if choice.act != "leave"][turn])
        assert advance(tiny, copy, event, {}) == advance(tiny, state, event, {})
        later, beat = advance(tiny, state, event, {})
        assert later != state
        assert event.choice in later.chosen
        state = later


def test_nodes_that_follow_one_another_are_still_passed_in_their_order(tmp_path, tiny_text):
    """What is said at a node knows the nodes, lines and effects before it and nothing of those that always follow."""
    rows = """\
  hello:
    lines:
      - {id: one, again: true, en: "One.", ja: "一。"}
      - {id: early, if: "visits.second == 0 and not seen('two') and told == 0", en: "Early.", ja: "早い。"}
    feel: {joy: 0.1}
    to: second
  second:
    set: {told: told + 1}
    lines:
      - {id: two, again: true, en: "Two.", ja: "二。"}
      - {id: late, if: "visits.hello == 1 and seen('one') and told == 1 and not seen('hub')", en: "Late.", ja: "遅い。"}
    feel: {joy: 0.2}
    to: hub
"""
    start, end = tiny_text.index("  hello:\n"), tiny_text.index("  hub:\n")
    path = tmp_path / "tiny.yaml"
    path.write_text(tiny_text[:start] + rows + tiny_text[end:], encoding="utf-8")
    script = load_script(path)
    state, beat = advance(script, begin(script, "cup", 1), Start(), {})
    assert _ids(beat)[:4] == ["one", "early", "two", "late"]
    assert [stimulus.source for stimulus in beat.stimuli] == ["hello", "second"]
    assert state.visits == {"hello": 1, "second": 1, "hub": 1}
    assert list(state.visits) == ["hello", "second", "hub"]
    assert state.heard == {"one": 1, "two": 1}
    state, beat = advance(script, state, Warp("hello"), {})
    assert _ids(beat)[:2] == ["one", "two"]
    assert state.heard == {"one": 2, "two": 2}
    assert state.variables["told"] == 2
