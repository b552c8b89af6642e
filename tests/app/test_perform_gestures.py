"""Gestures and their words through the game's own step: the stroke on its word, preparation, beats, rivals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from game.app.loading import load_step_assets
from game.app.performance import Event, Script, explain_starts, fixed_world, perform
from game.app.step import StepAssets, step
from game.app.world import TICK_S, Intent, World
from game.core import EMOTIONS
from game.embos import GestureCues, PlannerSignal
from game.story import Spoken

LINES = {
    "en": (
        "This one here? Please, take a look!",
        "No, no. I never said that, and the price is really not so little.",
        "Thank you! Yes, of course. What would you like to see, the big one over there?",
    ),
    "ja": (
        "これですか？どうぞ、ご覧ください！",
        "いいえ、値段は本当に少しですよ。",
        "ありがとうございます！はい、もちろん。何を見ますか、あの大きい壺ですか？",
    ),
}


@pytest.fixture(scope="module")
def assets() -> StepAssets:
    return load_step_assets(body=False)


@pytest.fixture(scope="module")
def acting() -> StepAssets:
    return replace(load_step_assets(), face=None)


def pure(name: str) -> np.ndarray:
    return np.eye(7)[EMOTIONS.index(name)]


def say(world: World, text: str) -> World:
    return replace(world, queue=(Spoken(id="line", speaker="shopkeeper", en=text, ja=text),))


def spoken(world: World) -> bool:
    speech = world.speech
    return speech is not None and world.time_s - speech.started_s > speech.timed.length_s + 0.5


def gestures_of(assets: StepAssets, world: World, text: str) -> tuple[World, list[Event], GestureCues]:
    """Say a line to its end -> world after it, the gestures that began, the line's cues."""
    world, events, cues = say(world, text), [], None
    while True:
        before, world = world, step(assets, world, Intent(proceed=spoken(world)))
        if world.speech is None and before.speech is not None:
            assert cues is not None
            return world, events, cues
        if world.speech is not None:
            cues = world.speech.cues
        assert world.body.signal is not None
        new = explain_starts(assets.planner, before.body.planner, world.body.signal, world.body.decisions)
        events += [event for event in new if event.chosen.layer == "gesture"]


@pytest.mark.parametrize("language", ["en", "ja"])
def test_strokes_land_on_their_words(assets: StepAssets, language: str) -> None:
    columns = assets.planner.library.gestures.tolist()
    seen = 0
    for emotion in ("joy", "neutral", "anger", "sadness"):
        world = fixed_world(assets, pure(emotion), 7, language=language)
        for text in LINES[language]:
            world, events, cues = gestures_of(assets, world, text)
            for event in events:
                assert event.stroke_s is not None
                due_s = cues.time_s[cues.gesture == columns.index(event.chosen.unit)]
                assert np.abs(due_s - event.stroke_s).min() <= 0.1
                assert event.time_s < event.stroke_s < event.time_s + event.duration_s, "preparation and retraction"
                seen += 1
    assert seen >= 8


def test_the_first_word_has_its_gesture_too_because_the_hand_sets_out_first(assets: StepAssets) -> None:
    world = fixed_world(assets, pure("neutral"), 1)
    begun_s = world.time_s
    world = step(assets, say(world, "Yes, of course."))
    assert world.speech is not None
    assert 0.0 < world.speech.started_s - begun_s <= assets.planner.config.lead_in_s
    world, events, cues = gestures_of(assets, fixed_world(assets, pure("neutral"), 1), "Yes, of course.")
    assert [e.chosen.name for e in events][:1] == ["nod"]
    assert events[0].stroke_s == pytest.approx(cues.time_s[0], abs=0.1)


def test_the_arm_really_strikes_then(acting: StepAssets) -> None:
    """The performer's own stroke, not the planner's plan: hands move before it and have come back after it."""
    layer = acting.planner.tables.gesture_layer
    library, columns = acting.planner.library, acting.planner.library.gestures.tolist()
    seen = 0
    for emotion in ("neutral", "joy"):
        world = say(fixed_world(acting, pure(emotion), 3), LINES["en"][seen > 0])
        due: dict[int, float] = {}
        for _ in range(150):
            world = step(acting, world, Intent(proceed=spoken(world)))
            decisions, performer = world.body.decisions, world.body.performer
            assert performer is not None
            unit = int(decisions.unit[0, layer])
            if decisions.started[0, layer] and not library.is_rest[unit]:
                assert world.speech is not None
                assert world.speech.cues is not None
                stroke_s = float(decisions.start_time_s[0, layer] + decisions.stroke_s[0, layer])
                moments = world.speech.cues.time_s[world.speech.cues.gesture == columns.index(unit)]
                due[unit] = float(moments[np.abs(moments - stroke_s).argmin()])
            to_stroke_s = float(performer.to_stroke_s[0, layer])
            if unit in due and abs(to_stroke_s) <= TICK_S / 2:
                assert world.time_s - TICK_S == pytest.approx(due.pop(unit), abs=0.1)
                seen += 1
    assert seen >= 2


def test_a_long_line_gets_beats_on_stressed_words(assets: StepAssets) -> None:
    text = "My grandmother carried the lantern across seven frozen mountains, singing, with a donkey and a bucket."
    world = fixed_world(assets, pure("anger"), 2)
    world, events, cues = gestures_of(assets, world, text)
    beats = [e for e in events if e.chosen.name in assets.planner.config.stress.units]
    assert len(beats) >= 2
    assert len({e.chosen.name for e in beats}) == len(beats), "none again inside its waiting time"
    for event in beats:
        assert event.stroke_s is not None
        at = np.abs(cues.time_s - event.stroke_s).argmin()
        assert abs(cues.time_s[at] - event.stroke_s) <= 0.1


def test_of_two_gestures_for_one_word_eq_1_chooses_and_says_why(assets: StepAssets) -> None:
    planner = assets.planner
    columns = planner.library.gestures
    emotion = pure("anger")[None]
    knows = planner.library.exists[columns, 0]
    words = np.where(knows, 1.0, 0.0)[None]
    state, _ = planner.advance(planner.start(1, 5), PlannerSignal(emotion, 0.0 * words, 0.0))
    signal = PlannerSignal(emotion, words, TICK_S)
    after, decisions = planner.advance(state, signal)
    table = planner.explain(state, signal, 0)[planner.tables.gesture_layer]
    rivals = [c for c in table if c.score > 0.0 and c.source]
    assert len(rivals) >= 2
    assert rivals[0].chosen
    assert rivals[0].unit == decisions.unit[0, planner.tables.gesture_layer]
    assert rivals[0].score == max(c.score for c in rivals)
    second = max(rivals[1:], key=lambda c: c.score)
    assert f"more than {second.name}" in rivals[0].reason
    assert second.reason == "scores less"
    assert after.starts[0, planner.tables.gesture_layer] == 1


def test_lines_without_gesture_words_leave_the_hands_alone(assets: StepAssets) -> None:
    done = perform(assets, pure("joy"), 20.0, 1, script=Script("Mm."))
    assert not [e for e in done.events if e.chosen.layer == "gesture"]
