"""The step: one seed one world, cause before effect, the body follows the feelings, observers change nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from game.app.afternoon import Afternoon, visit_stall
from game.app.loading import load_step_assets
from game.app.step import StepAssets, new_world, speech_stage, step
from game.app.talk import Choice
from game.app.world import Intent, World, enter_talk, leave_talk
from game.story import Spoken, Timer


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


def _timed(assets: StepAssets, seconds: float, choice: str = "wait") -> World:
    """Her hub with a timer on it."""
    world = talk_to_her(assets)
    assert world.talk is not None
    beat = world.talk.beat._replace(timer=Timer(seconds, choice))
    return replace(world, talk=replace(world.talk, beat=beat), timers=1.0)


def test_a_timed_choice_takes_its_default_after_its_ticks(assets) -> None:
    before = _timed(assets, 2.0)
    assert before.time_left == 1.0
    world = run(assets, before, 1.0)
    assert world.waiting
    assert world.time_left == pytest.approx(0.5)
    world = run(assets, world, 1.1)
    assert not world.waiting, "silence was the choice, and she answers it"
    assert world.marks[-1].act == "wait"
    assert world.time_left is None
    # A choice in time is the player's own, and the next one has all its time.
    option = next(o for o in before.talk.beat.choices if o.act == "joke" or o.available)
    world = step(assets, run(assets, before, 1.0), Intent(choice=Choice(option.id)))
    assert world.waited == 0


def test_timers_are_off_unless_asked_for_and_may_be_slower(assets) -> None:
    off = replace(_timed(assets, 2.0), timers=0.0)
    assert off.time_left is None
    assert run(assets, off, 4.0).waiting
    slow = run(assets, replace(_timed(assets, 2.0), timers=3.0), 4.0)
    assert slow.waiting
    assert slow.time_left == pytest.approx(1.0 / 3.0, abs=0.01)


def test_a_gesture_named_by_the_script_is_called_up_with_the_line(assets) -> None:
    world = replace(talk_to_her(assets), felt=np.array([0, 0, 0.9, 0, 0, 0.0]))
    line = Spoken("x", "shopkeeper", "Mm.", "うん。", gesture="open_palm")
    world = speech_stage(assets, replace(world, queue=(line,)), Intent())
    assert world.speech is not None
    names = [assets.planner.library.units[u].name for u in assets.planner.library.gestures]
    assert [names[g] for g in world.speech.cues.gesture] == ["open_palm"]
    plain = speech_stage(assets, replace(world, speech=None, queue=(replace(line, gesture="no_such"),)), Intent())
    assert plain.speech.cues.gesture.size == 0
