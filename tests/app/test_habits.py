"""A person's habits are seen whatever they feel, soon after one meets them, and told as habits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from game.app.bazaar import Lesson
from game.app.content import load_talk_assets, stall_path
from game.app.loading import load_planner
from game.app.step import StepAssets, new_world, step
from game.app.talk import start_talk
from game.app.world import Intent, enter_talk
from game.core.emotion_space import with_neutral
from game.core.errors import BadInput
from game.embos import PlannerSignal, check_habit, greet, habit_of
from game.emotion import Temperament

N, SECONDS = 14, 50
TICK_S = 1 / 30


@pytest.fixture(scope="module")
def planner():
    return load_planner()


def person_at(stall: str) -> Temperament:
    return load_talk_assets(stall_path(stall)).person


def mannerisms(planner, person: Temperament, *, met: bool = True) -> list[tuple[int, float, str]]:
    """(body, seconds, mannerism) of each start, two bodies for each of the seven feelings."""
    habit = habit_of(planner, person.habit_units, person.habit_rate) if met else None
    felt = with_neutral(np.repeat(np.eye(7)[:, :6] * 0.6, N // 7, axis=0))
    silent = np.zeros((N, len(planner.library.gestures)))
    state = greet(planner.start(N, 4), habit, 0.0)
    layer, seen = planner.tables.layers.index("mannerism"), []
    for tick in range(round(SECONDS / TICK_S)):
        state, d = planner.advance(state, PlannerSignal(felt, silent, tick * TICK_S, habit))
        for body in np.flatnonzero(d.started[:, layer]):
            unit = d.unit[body, layer]
            if not planner.library.is_rest[unit]:
                seen.append((int(body), tick * TICK_S, planner.library.units[unit].name))
    return seen


@pytest.mark.parametrize("stall", ["flea", "antiques", "toys"])
def test_habits_come_about_as_often_as_the_rules_say_in_every_feeling(planner, stall: str) -> None:
    person = person_at(stall)
    assert person.habit_units
    seen = mannerisms(planner, person)
    own = [(body, at) for body, at, name in seen if name in person.habit_units]
    assert 0.6 * person.habit_rate < len(own) / len(seen) < 1.6 * person.habit_rate
    assert {body // 2 for body, _ in own} == set(range(7)), "whatever is felt"
    early = {body for body, at in own if at < 6.0}
    assert len(early) > 0.7 * N, "learnt at the greeting, before there is anything to read"


def test_without_the_habit_the_same_units_belong_to_the_feeling_they_look_like(planner) -> None:
    person = person_at("toys")
    seen = [body // 2 for body, _, name in mannerisms(planner, person, met=False) if name in person.habit_units]
    assert seen
    assert set(seen) == {2}, "joy alone"


def test_the_reason_says_that_it_is_a_habit(planner) -> None:
    talk = load_talk_assets(stall_path("toys"))
    assets = StepAssets(talk, planner)
    world = enter_talk(assets, new_world(assets, 3), start_talk(talk, "kendama", 3, purse=9000))
    world = replace(world, queue=())
    reasons = []
    for _ in range(200):
        before = world.body.planner
        world = step(assets, world, Intent())
        row = world.body.decisions.started[0]
        if world.body.signal is not None and row[planner.tables.layers.index("mannerism")]:
            chosen = planner.explain(before, world.body.signal, 0)[planner.tables.layers.index("mannerism")][0]
            reasons.append((chosen.name, chosen.state, chosen.reason))
    habits = [row for row in reasons if row[0] in talk.person.habit_units]
    assert habits
    assert any("is a habit" in reason for _, _, reason in habits)
    assert all(state >= talk.person.habit_rate for _, state, _ in habits)


def test_a_lesson_without_habits_shows_none_and_wrong_names_are_refused(planner) -> None:
    bent = Lesson(habit=0.0).bend(load_talk_assets(stall_path("toys"))).person
    assert habit_of(planner, bent.habit_units, bent.habit_rate) is None
    with pytest.raises(BadInput, match=r"habit of daimon.*\(rub_hands\)"):
        check_habit(planner.library, ("rub_hand",), "daimon")
    with pytest.raises(BadInput, match="mannerism"):
        check_habit(planner.library, ("arms_crossed",), "daimon")
