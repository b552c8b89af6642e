"""The step: one seed one world, cause before effect, the body follows the feelings, observers change nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from game.app.afternoon import Afternoon, visit_stall
from game.app.loading import load_step_assets
from game.app.step import StepAssets, new_world, step
from game.app.talk import Choice
from game.app.world import Intent, World, enter_talk, leave_talk


@pytest.fixture(scope="module")
def assets() -> StepAssets:
    return load_step_assets()


def run(assets: StepAssets, world: World, seconds: float, intent: Intent | None = None) -> World:
    for i in range(round(seconds * 30)):
        world = step(assets, world, intent if intent is not None and i == 0 else Intent())
    return world


def talk_to_her(assets: StepAssets, seed: int = 4) -> World:
    item = sorted(assets.talk.script.items)[0]
    world = enter_talk(assets, new_world(assets, seed), visit_stall(assets.talk, Afternoon(seed=seed), item))
    while not world.waiting:
        world = run(assets, world, 0.5, Intent(proceed=True))
    return world


def test_one_seed_one_world(assets) -> None:
    a, b = (run(assets, new_world(assets, 11), 4.0) for _ in range(2))
    assert np.array_equal(a.body.pose.rotation, b.body.pose.rotation)
    assert np.array_equal(a.body.face_params, b.body.face_params)
    other = run(assets, new_world(assets, 12), 4.0)
    assert not np.array_equal(a.body.pose.rotation, other.body.pose.rotation)


def test_feelings_reach_body_and_face_within_a_second(assets) -> None:
    angry = np.array([0.9, 0, 0, 0, 0, 0])
    world = replace(new_world(assets, 2), felt_target=angry, shown_target=np.append(angry, 0.1))
    world = run(assets, world, 1.0)
    assert world.felt[0] > 0.8
    assert world.shown[0] > 0.85
    assert world.body.signal.emotion[0, 0] > 0.75


def test_the_reaction_waits_for_the_answer_to_begin(assets) -> None:
    """Cause before effect: while the player's own line is spoken, nothing shows yet."""
    world = talk_to_her(assets)
    before = world.felt_target.copy()
    option = next(c for c in world.talk.beat.choices if c.available and c.act not in {"wait", "leave", "offer"})
    world = step(assets, world, Intent(choice=Choice(option.id)))
    assert world.speech.line.speaker == "player"
    assert np.array_equal(world.felt_target, before)
    while world.speech is not None and world.speech.line.speaker == "player":
        world = run(assets, world, 0.3, Intent(proceed=True))
    record = dict(world.talk.record)
    assert np.allclose(world.felt_target, record["felt"][:6])
    assert world.marks[-1].act == option.act


def test_the_body_changes_nothing_in_the_talk(assets) -> None:
    """The same moves lead to the same talk, with the whole body and without."""
    bare = StepAssets(assets.talk, assets.planner)
    results = []
    for which in (assets, bare):
        world = talk_to_her(which)
        for _ in range(3):
            if not world.waiting:
                break
            option = next(c for c in world.talk.beat.choices if c.available and c.act not in {"leave", "offer"})
            world = step(which, world, Intent(choice=Choice(option.id)))
            for _ in range(60):
                if world.waiting or world.over:
                    break
                world = run(which, world, 0.4, Intent(proceed=True))
        results.append((world.talk.bargain, [line.id for line in world.backlog], world.talk.feeling.felt.tolist()))
    assert results[0] == results[1]


def test_choices_are_ignored_while_somebody_speaks(assets) -> None:
    item = sorted(assets.talk.script.items)[0]
    world = enter_talk(assets, new_world(assets, 4), visit_stall(assets.talk, Afternoon(seed=4), item))
    world = step(assets, world)
    assert world.speech is not None
    option = world.talk.beat.choices[0]
    after = step(assets, world, Intent(choice=Choice(option.id)))
    assert after.talk is world.talk


def test_leaving_calms_down(assets) -> None:
    world = run(assets, leave_talk(talk_to_her(assets)), 3.0)
    assert world.talk is None
    assert world.felt.max() < 0.35
