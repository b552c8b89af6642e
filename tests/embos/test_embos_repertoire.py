"""The shipped repertoire in play: what the planner makes of the seven takes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from game.core import ASSETS, EMOTIONS, with_neutral
from game.embos import LAYERS, Planner, PlannerConfig, PlannerSignal, UnitLibrary, load_config
from game.embos.analysis import shares

MOTION = ASSETS / "motion"


@pytest.fixture(scope="module")
def library() -> UnitLibrary:
    return UnitLibrary.load(MOTION / "units.yaml")


@pytest.fixture(scope="module")
def config() -> PlannerConfig:
    return load_config(MOTION / "planner.yaml")


def test_ten_minutes_of_each_pure_emotion_hold_the_takes_shares(
    library: UnitLibrary, config: PlannerConfig, on_stage: Callable[..., np.ndarray]
) -> None:
    take = shares(library.units).T
    on = on_stage(library, config, 10.0, 1)
    for layer in LAYERS:
        own = [i for i in library.of_layer(layer) if not library.is_rest[i]]
        r = {emotion: np.corrcoef(take[k, own], on[k, own])[0, 1] for k, emotion in enumerate(EMOTIONS)}
        assert min(r.values()) >= 0.9, (layer, r)
        assert np.mean(list(r.values())) >= 0.95, (layer, r)
        assert on[:, own][take[:, own] == 0.0].sum() == 0.0


def test_between_joy_and_anger_the_shares_move_from_one_to_the_other(
    library: UnitLibrary, config: PlannerConfig
) -> None:
    take = shares(library.units)
    joy, anger = EMOTIONS.index("joy"), EMOTIONS.index("anger")
    each, steps = 3, np.linspace(0.0, 1.0, 6)
    six = np.zeros((len(steps), each, 6))
    six[..., joy], six[..., anger] = 1.0 - steps[:, None], steps[:, None]
    emotion = with_neutral(six.reshape(-1, 6))
    planner, n = Planner(library, config), len(emotion)
    state, words = planner.start(n, 4), np.ones((n, len(library.gestures)))
    on = np.zeros((n, len(library)))
    for tick in range(3000):
        state, d = planner.advance(state, PlannerSignal(emotion, words, tick * 0.1), 0.1)
        on[np.arange(n)[:, None], d.unit] += 1.0 / 3000
    on = on.reshape(len(steps), each, -1).mean(axis=1)
    only_joy = (take[:, joy] > 0) & (take[:, anger] == 0)
    only_anger = (take[:, anger] > 0) & (take[:, joy] == 0)
    neither = (take[:, anger] == 0) & (take[:, joy] == 0) & ~library.is_rest
    assert np.all(np.diff(on[:, only_joy].sum(axis=1)) <= 0.1)
    assert np.all(np.diff(on[:, only_anger].sum(axis=1)) >= -0.1)
    assert on[:, neither].sum() == 0.0


def test_a_jump_of_emotion_shows_within_two_seconds(library: UnitLibrary, config: PlannerConfig) -> None:
    pairs = [(a, b) for a in range(7) for b in range(7) if a != b]
    before, after = np.eye(7)[[a for a, _ in pairs]], np.eye(7)[[b for _, b in pairs]]
    to = after.argmax(axis=1)
    planner, n = Planner(library, config), len(pairs)
    state, words = planner.start(n, 2), np.zeros((n, len(library.gestures)))
    shown_s = np.full(n, np.inf)
    for tick in range(900):
        since_s = (tick - 600) / 30.0
        state, d = planner.advance(state, PlannerSignal(after if since_s >= 0 else before, words, tick / 30.0))
        if since_s >= 0:
            shown_s = np.where(library.exists[d.unit[:, 0], to] & np.isinf(shown_s), since_s, shown_s)
    assert shown_s.max() <= 2.0


def test_a_drifting_emotion_does_not_make_postures_flicker(library: UnitLibrary, config: PlannerConfig) -> None:
    rng = np.random.default_rng(3)
    n, seconds = 12, 60
    start, goal = with_neutral(rng.random((n, 6)) ** 3), with_neutral(rng.random((n, 6)) ** 3)
    planner = Planner(library, config)
    state, words = planner.start(n, 2), np.zeros((n, len(library.gestures)))
    changes = 0
    for tick in range(seconds * 30):
        share = tick / (seconds * 30)
        before = state
        state, _ = planner.advance(state, PlannerSignal((1 - share) * start + share * goal, words, tick / 30.0))
        changes += int((before.running[:, 0] != state.running[:, 0]).sum())
    assert changes / (n * seconds) < 0.35, "posture changes per second"


def test_every_unit_traces_to_a_span_of_a_take(library: UnitLibrary, config: PlannerConfig) -> None:
    planner = Planner(library, config)
    signal = PlannerSignal(np.eye(7)[:1], np.ones((1, len(library.gestures))), 0.0)
    state, _ = planner.advance(planner.start(1, 1), signal)
    for candidates in planner.explain(state, PlannerSignal(signal.emotion, signal.words, 1 / 30), 0):
        for candidate in candidates:
            unit = library.units[candidate.unit]
            assert candidate.source.split(" ")[0] in ({v.take for v in unit.variants} or {""})
