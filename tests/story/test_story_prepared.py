"""What is worked out beforehand for an item must be what asking every condition in the talk would have given."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest

from game.core.paths import ASSETS, DIALOGUE
from game.core.streams import Streams
from game.story import Chose, Start, advance, begin, load_script, restore, save
from game.story.expressions import Scope
from game.story.prepared import prepared

BENCH = ASSETS / "bench" / "ten_choices.yaml"


def test_tables_leave_out_only_what_can_never_hold_for_the_item() -> None:
    script = load_script(DIALOGUE / "flea.yaml")
    rng = random.Random(3)
    narrowed = 0
    for item in script.items:
        tables = prepared(script, item)
        assert prepared(script, item) is tables
        names = {name: known.initial for name, known in script.variables.items()}
        names |= {"item": item, "round": 3.0, "offer_result": "none", "visit": 1.0}
        for node in script.nodes.values():
            for told in ("right", "wrong", "neutral", "veiled"):
                kept = {line.id for _, group in tables.says(tables.node(node.id), told) for line in group.lines}
                for _ in range(2):
                    seen = {i for i in script.lines if rng.random() < 0.4}
                    seen |= {i for i in script.choices if rng.random() < 0.4}
                    scope = Scope(names, {}, seen)
                    for say in node.says:
                        for line in say.lines:
                            conditions = [c for c in (say.condition, line.condition) if c is not None]
                            if any(not c.names <= names.keys() for c in conditions):
                                continue
                            fits = say.when in (None, told) and line.when in (None, told)
                            if fits and all(c.evaluate(scope) for c in conditions):
                                assert line.id in kept
                narrowed += sum(len(say.lines) for say in node.says) - len(kept)
    assert narrowed > 1000


def test_a_talk_about_one_item_after_another_keeps_their_words_apart() -> None:
    """The tables belong to an item: nothing of one item's words turns up in a talk about another."""
    script = load_script(DIALOGUE / "flea.yaml")
    for item, other in (("cups", "vase"), ("vase", "cups")):
        for seed in range(12):
            state, beat = advance(script, begin(script, item, seed), Start(), {"list_price": 1200.0})
            words = " ".join(line.en for line in beat.lines)
            for choice in beat.choices:
                if choice.id not in {"offer", "wait", "leave"}:
                    _, after = advance(script, state, Chose(choice.id), {"list_price": 1200.0})
                    words += " ".join(line.en for line in after.lines)
            assert script.items[other].name.en not in words


def test_streams_give_what_a_generator_of_their_own_would() -> None:
    streams = Streams()
    for seed, purpose, counter in ((1, "mood", 0), (2**31 - 1, "market", 5), (1, "mood", 1), (1, "mood", 0)):
        name = int.from_bytes(purpose.encode()[:4], "big")
        alone = np.random.Generator(np.random.Philox(key=seed << 64 | name << 32 | counter))
        given = streams.at(seed, purpose, counter)
        assert [given.random(), given.standard_normal(), given.random()] == [
            alone.random(),
            alone.standard_normal(),
            alone.random(),
        ]


@pytest.mark.parametrize("path", [BENCH, DIALOGUE / "toys.yaml"], ids=["every table fixed", "a stall"])
def test_what_is_worked_out_once_changes_no_talk(path: Path) -> None:
    """The same talk with tables that filled in earlier talks, and with none left from one step to the next."""
    warm, cold = load_script(path), load_script(path)
    for seed in range(20):
        item = list(warm.items)[seed % len(warm.items)]
        states = [begin(script, item, seed) for script in (warm, cold)]
        draw, event = random.Random(seed), Start()
        for turn in range(12):
            cold.tables.clear()
            states[1] = restore(cold, save(states[1]))
            env = {"list_price": 1200.0, "ask": 1200.0 - turn, "trust": draw.random(), "round": turn + 1.0}
            env |= {"tells": draw.random() < 0.5, "quality": draw.choice(["right", "wrong", "neutral"])}
            results = [advance(script, state, event, env) for script, state in zip((warm, cold), states, strict=True)]
            states = [state for state, _ in results]
            assert save(states[0]) == save(states[1])
            assert results[0][1] == results[1][1]
            beat = results[0][1]
            if beat.ended is not None:
                break
            event = Chose(draw.choice([choice.id for choice in beat.choices if choice.act != "leave"]))
    laid = {node.id for node in warm.tables[next(iter(warm.items))].nodes.values() if node.table is not None}
    assert laid == ({"hub"} if path == BENCH else set())


def test_what_a_choice_says_is_said_once_however_often_it_is_taken():
    """Taken a first time, a second time, and with an offer, which has words of its own."""
    script = load_script(BENCH)
    state, beat = advance(script, begin(script, "cup", 1), Start(), {})
    told = []
    for choice, env in (("praise", {}), ("praise", {}), ("flaw", {"offer_result": "refused", "offer": 300.0})):
        state, beat = advance(script, state, Chose(choice), env)
        told.append([line.id for line in beat.lines])
    praise, _, flaw, _ = [choice.texts[0].id for choice in script.nodes["hub"].choices]
    assert told == [[praise, "kind_1", "ask"], ["kind_1", "ask"], [flaw, "eyes_1", "ask"]]
    assert state.chosen == {"praise", "flaw"}
    assert state.visits == {"hub": 4, "kind": 2, "eyes": 1, "next": 3}
    assert state.heard == {"ask": 4, "kind_1": 2, "eyes_1": 1}
