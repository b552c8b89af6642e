"""A face over time: no flicker, brows before skin, leaks, talk, blinks."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from game.core import EMOTIONS, emotion_vector
from game.face import (
    FIELDS,
    INDEX,
    VISEMES,
    FaceAsset,
    FaceSignal,
    advance_face,
    explain_face,
    load_face,
    start_face,
    tessellate,
)
from game.face.params import field_bounds, region_mask

DT = 1.0 / 30.0
NEUTRAL = emotion_vector({"neutral": 1.0})


@pytest.fixture(scope="module")
def asset() -> FaceAsset:
    return load_face()


def _run(asset, state, signals):
    shown, chosen = [], []
    for signal in signals:
        state, params = advance_face(asset, state, signal, DT)
        shown.append(params)
        chosen.append(state.numbers)
    return state, np.array(shown), chosen


def _changes(chosen):
    return sum(a != b for a, b in pairwise(chosen))


def test_noise_around_a_border_does_not_flicker(asset):
    """Between the strengths where the face changes, noise would switch it at nearly every look-up."""
    rng = np.random.default_rng(6)
    search = asset.search
    for name in ("anger", "sadness", "joy"):
        levels = np.clip(0.5 + rng.normal(0.0, 0.04, 600), 0.0, 1.0)
        signals = [FaceSignal(emotion_vector({name: float(level)})) for level in levels]
        eager = [search.best(search.score_emotion(signal.shown)) for signal in signals[::10]]
        _, _, chosen = _run(asset, start_face(asset, 1, signals[0].shown), signals)
        assert _changes(chosen) <= 3
        assert _changes(chosen) <= _changes(eager)


def test_a_slow_drift_changes_the_face_a_few_times_and_never_back(asset):
    signals = [FaceSignal(emotion_vector({"anger": float(x)})) for x in np.linspace(0.0, 1.0, 600)]
    _, _, chosen = _run(asset, start_face(asset, 1), signals)
    assert 2 <= _changes(chosen) <= 7
    seen = list(dict.fromkeys(chosen))
    assert len(seen) == _changes(chosen) + 1  # no face comes back


def test_brows_lead_and_skin_follows(asset):
    angry = FaceSignal(emotion_vector({"anger": 0.95}))
    _, shown, _ = _run(asset, start_face(asset, 1), [angry] * 90)
    way = np.abs(shown - shown[0]) / np.maximum(np.abs(shown[-1] - shown[0]), 1e-9)
    moved = np.abs(shown[-1] - shown[0]) > 1e-3

    def half_time(region):
        inside = region_mask(region) & moved
        return DT * float(np.mean((way[:, inside] < 0.5).sum(axis=0)))

    times = [half_time(region) for region in ("eyebrows", "eyes", "mouth", "skin")]
    assert times == sorted(times)
    assert times[0] < 0.2
    assert times[3] > times[0] + 0.25


def test_nothing_jumps_between_two_steps(asset):
    """The largest change of any number in one tick stays a fraction of its range, whatever the emotions do."""
    low, high = field_bounds()
    rng = np.random.default_rng(9)
    signals = []
    for _ in range(12):
        name = EMOTIONS[int(rng.integers(7))]
        signals += [FaceSignal(emotion_vector({name: float(rng.uniform(0.3, 1.0))}))] * 20
    _, shown, _ = _run(asset, start_face(asset, 1), signals)
    assert (shown >= low).all()
    assert (shown <= high).all()
    steps = np.abs(np.diff(shown, axis=0)) / (high - low)
    assert steps.max() < 0.3


def test_the_step_is_independent_of_the_frame_rate(asset):
    joy = FaceSignal(emotion_vector({"joy": 0.9}))
    ends = []
    for rate in (30, 120):
        state = start_face(asset, 1)
        for _ in range(rate * 2):
            state, params = advance_face(asset, state, joy, 1.0 / rate)
        ends.append(params)
    np.testing.assert_allclose(ends[0], ends[1], atol=0.02)


def test_strength_shows(asset):
    for name in EMOTIONS[:6]:
        looks = []
        for strength in (0.4, 0.9):
            _, shown, _ = _run(asset, start_face(asset, 1), [FaceSignal(emotion_vector({name: strength}))] * 120)
            looks.append(shown[-1])
        low, high = field_bounds()
        assert (np.abs(looks[1] - looks[0]) / (high - low)).sum() > 0.4, name


def test_micro_expressions_leak_only_behind_a_mask(asset):
    smile, rage = emotion_vector({"joy": 0.7}), emotion_vector({"anger": 0.9})
    honest = [FaceSignal(smile, felt=smile)] * 1500
    masked = [FaceSignal(smile, felt=rage)] * 1500
    _, still, _ = _run(asset, start_face(asset, 4, smile), honest)
    assert np.abs(still - still[-1]).max() < 1e-9
    state, shown, chosen = _run(asset, start_face(asset, 4, smile), masked)
    slant = shown[:, INDEX["brow_angle"]]
    leaking = slant > still[-1, INDEX["brow_angle"]] + 5.0
    edges = np.flatnonzero(np.diff(leaking.astype(int)))
    lengths = (edges[1::2] - edges[::2][: len(edges[1::2])]) * DT
    assert 4 <= len(lengths) <= 40  # within 50 s
    assert lengths.max() <= 0.2 + 2 * DT
    assert lengths.min() >= 1 / 25 - DT
    assert _changes(chosen) == 0  # the mask itself stays
    assert np.abs(shown[:, region_mask("skin")] - shown[0, region_mask("skin")]).max() < 1e-9
    again, twice, _ = _run(asset, start_face(asset, 4, smile), masked)
    np.testing.assert_array_equal(shown, twice)
    assert again.tick == state.tick
    _, other, _ = _run(asset, start_face(asset, 5, smile), masked)
    assert (other != shown).any()


def test_lips_that_speak_do_not_leak_and_set_off_softly(asset):
    """Brows and eyes flash behind a talking mask; the mouth goes on talking. No opening is half there in one frame."""
    smile, rage = emotion_vector({"joy": 0.7}), emotion_vector({"anger": 0.9})
    sounds = [np.eye(len(VISEMES))[k] for k in (0, 4, 3, 5, 1)]  # 0.2 s each
    mouths, leaks = {}, 0
    for felt in (smile, rage):
        signals = [FaceSignal(smile, felt=felt, visemes=sounds[i // 6 % 5]) for i in range(900)]
        state, shown = start_face(asset, 4, smile), []
        for signal in signals:
            state, params = advance_face(asset, state, signal, DT)
            shown.append(params)
            leaks += state.leak is not None
        mouths[felt is smile] = np.array(shown)
    assert leaks > 10
    still = np.abs(mouths[True] - mouths[False])[30:]  # after the first word
    assert still[:, region_mask("eyebrows")].max() > 5.0
    assert still[:, region_mask("mouth")].max() < 0.1
    opening = mouths[True][:, INDEX["mouth_open"]]
    assert np.ptp(opening) > 12.0
    assert np.abs(np.diff(opening)).max() < 0.4 * np.ptp(opening)


def test_a_saved_face_goes_on_as_if_nothing_had_happened(asset):
    signals = [FaceSignal(emotion_vector({"fear": 0.6}), felt=emotion_vector({"anger": 0.8}))] * 60
    middle, _, _ = _run(asset, start_face(asset, 2), signals)
    _, straight, _ = _run(asset, middle, signals)
    _, resumed, _ = _run(asset, replace(middle), signals)
    np.testing.assert_array_equal(straight, resumed)


def test_blink_closes_and_look_turns(asset):
    state = start_face(asset, 1)
    _, shut = advance_face(asset, state, FaceSignal(NEUTRAL, blink=1.0), DT)
    _, aside = advance_face(asset, state, FaceSignal(NEUTRAL, look=np.array([0.5, -0.3])), DT)
    assert shut[INDEX["eye_open"]] == 0.0
    assert aside[INDEX["look_x"]] == pytest.approx(0.5)
    assert aside[INDEX["look_y"]] == pytest.approx(-0.3)


def test_talk_opens_the_mouth_and_keeps_its_mood(asset):
    opening, corner = INDEX["mouth_open"], INDEX["mouth_corner"]
    for emotion in (NEUTRAL, emotion_vector({"sadness": 0.5}), emotion_vector({"anger": 0.9})):
        start = start_face(asset, 1, emotion)
        openings = {}
        for i, name in enumerate(VISEMES):
            weights = np.eye(len(VISEMES))[i]
            _, shown, _ = _run(asset, start, [FaceSignal(emotion, visemes=weights)] * 20)
            openings[name] = shown[-1, opening]
            assert np.sign(shown[-1, corner]) == np.sign(start.params[corner])
            tessellate(shown[-1])
        assert openings["a"] > openings["e"] > openings["closed"]
        assert openings["a"] > openings["o"] > openings["u"]
        _, after, _ = _run(asset, start, [FaceSignal(emotion)] * 30)
        assert after[-1, opening] == pytest.approx(start.params[opening], abs=0.5)


def test_a_named_expression_takes_over_and_gives_back(asset):
    joy = emotion_vector({"joy": 0.8})
    start = start_face(asset, 1, joy)
    state, shown, _ = _run(asset, start, [FaceSignal(joy, expression="thinking")] * 150)
    np.testing.assert_allclose(shown[-1], asset.expression("thinking").params, atol=1e-2)
    assert "thinking" in explain_face(asset, state, FaceSignal(joy, expression="thinking")).reason
    _, back, _ = _run(asset, state, [FaceSignal(joy)] * 150)
    np.testing.assert_allclose(back[-1], start.params, atol=1e-2)


def test_decisions_explain_themselves(asset):
    anger = emotion_vector({"anger": 0.9})
    state = start_face(asset, 1, anger)
    assert explain_face(asset, state, FaceSignal(anger)).reason == "best of all faces"
    near = FaceSignal(emotion_vector({"joy": 0.9}))
    decision = explain_face(asset, replace(state, held_s=0.0), near)
    assert decision.best_score > decision.score
    assert "kept" in decision.reason


def test_every_number_belongs_to_a_region():
    assert sum(region_mask(region).sum() for region in ("eyes", "eyebrows", "mouth", "skin")) == len(FIELDS)
