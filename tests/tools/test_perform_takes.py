"""The seven committed takes: what an annotator, an animator and a physicist would look for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from game.core import ASSETS, EMOTIONS, Clip
from game.core import quaternion as quat
from game.core.humanoid import REFERENCE, TABLE_TOP_M
from game.formats.bvh import read_bvh
from game.formats.yaml_source import load_yaml
from game.tools.perform import perform_take
from game.tools.perform.measure import Figures, measure

TAKES = ASSETS / "motion" / "takes"
LAYERS = ("posture", "mannerism", "gesture")


@dataclass(frozen=True)
class Take:
    clip: Clip
    notes: dict[str, Any]
    figures: Figures

    def of(self, layer: str) -> list[dict[str, Any]]:
        return [span for span in self.notes["spans"] if span["layer"] == layer]


@cache
def take(emotion: str) -> Take:
    clip = read_bvh(TAKES / f"{emotion}.bvh").clip
    order = [clip.skeleton.names.index(name) for name in REFERENCE.names]
    clip = Clip(REFERENCE, clip.frame_time_s, clip.rotation[:, order], clip.translation[:, order], emotion)
    return Take(clip, load_yaml(TAKES / f"{emotion}.yaml").to_python(), measure(clip))


def repertoire() -> dict[str, Any]:
    found: dict[str, Any] = load_yaml(ASSETS / "motion" / "behaviours.yaml").to_python()["behaviours"]
    return found


def pairs(spans: list[dict[str, Any]]) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    yield from pairwise(spans)


def test_the_repertoire_is_large_enough_and_speaks_two_languages() -> None:
    entries = repertoire()
    count = Counter(entry["layer"] for entry in entries.values())
    assert count["posture"] >= 14
    assert count["mannerism"] >= 18
    assert count["gesture"] >= 24
    kinds = {entry["kind"] for entry in entries.values() if entry["layer"] == "gesture"}
    assert {"deictic", "depictive", "beat", "head"} <= kinds
    for name, entry in entries.items():
        assert set(entry["label"]) == {"en", "ja"}, name
        if entry["layer"] == "gesture":
            assert all(entry["words"][language] for language in ("en", "ja")), name
        # Statistics are counted in takes, never typed.
        assert not {"intensity", "duration_s", "waiting_s"} & set(entry), name


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_a_take_is_long_enough_and_fully_annotated(emotion: str) -> None:
    it, known = take(emotion), repertoire()
    assert it.notes["emotion"] == emotion
    assert it.clip.frame_time_s == pytest.approx(1 / 30, abs=1e-6)
    assert it.clip.length_s >= 185.0
    for layer, least in (("posture", 3), ("mannerism", 4), ("gesture", 4)):
        spans = sorted(it.of(layer), key=lambda span: span["start_s"])
        assert len({span["behaviour"] for span in spans}) >= least
        for span in spans:
            assert known[span["behaviour"]]["layer"] == layer
            assert 0.0 <= span["start_s"] < span["end_s"] <= it.clip.length_s + 1e-3
        for one, two in pairs(spans):
            assert one["end_s"] <= two["start_s"] + 1e-3, (one, two)
    postures = it.of("posture")
    assert min(span["end_s"] - span["start_s"] for span in postures) >= 1.0
    assert sum(span["end_s"] - span["start_s"] for span in postures) > 0.9 * it.clip.length_s
    for span in it.of("gesture"):
        assert span["start_s"] <= span["stroke_s"] <= span["end_s"]
        words = known[span["behaviour"]]["words"]["en"]
        assert span["words"] in words, span


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_nothing_uses_a_part_that_something_else_uses_at_that_moment(emotion: str) -> None:
    it, known = take(emotion), repertoire()
    spans = it.notes["spans"]
    for i, one in enumerate(spans):
        for two in spans[i + 1 :]:
            if one["start_s"] < two["end_s"] - 1e-3 and two["start_s"] < one["end_s"] - 1e-3:
                shared = set(known[one["behaviour"]]["uses"]) & set(known[two["behaviour"]]["uses"])
                assert not shared, (one, two)


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_hands_never_enter_body_or_table_feet_stay_and_nothing_pops(emotion: str) -> None:
    figures = take(emotion).figures
    assert figures.hand_depth_m <= 0.008
    assert figures.forearm_depth_m <= 0.020
    assert figures.feet_drift_m <= 0.001
    # A struck fist needs about 35,000 degrees per second squared; a flipped joint shows as 100,000 and more.
    assert figures.peak_joint_deg_per_s2 <= 45_000
    assert figures.peak_wrist_m_per_s2 <= 160


def test_everything_the_papers_name_is_acted() -> None:
    acted = {span["behaviour"] for emotion in EMOTIONS for span in take(emotion).notes["spans"]}
    wanted = {
        *("upright", "lean_forward", "lean_back", "lean_sideways", "arms_crossed", "hands_on_hips", "hand_on_table"),
        *("hands_clasped", "shoulders_dropped", "touch_brow", "touch_nose", "touch_mouth", "cover_mouth"),
        *("hair_stroke", "scratch_head", "yawn", "look_at_watch", "stretch", "knee_jiggle", "look_away", "stare"),
        *("sway", "sigh", "point_at", "open_palm", "come_on", "calm_down", "draw_shape", "show_size", "draw_path"),
        *("beat", "nod"),
    }
    assert wanted <= acted


def test_fear_ducks_for_moments_and_does_not_stay_down() -> None:
    ducks = [span["end_s"] - span["start_s"] for span in take("fear").of("posture") if span["behaviour"] == "crouched"]
    assert len(ducks) >= 3
    assert max(ducks) <= 4.0


def test_emotions_differ_in_activity_as_published() -> None:
    speed = {emotion: take(emotion).figures.speed_deg_per_s for emotion in EMOTIONS}
    still = {emotion: take(emotion).figures.still for emotion in EMOTIONS}
    assert min(speed["anger"], speed["joy"], speed["fear"]) > speed["disgust"] > speed["neutral"] > speed["sadness"]
    assert speed["anger"] > speed["fear"]
    # Fear trembles and anger seethes: neither is ever still, and which of the two less so is chance.
    assert max(still["fear"], still["anger"]) < still["joy"] < still["disgust"]
    assert still["disgust"] < still["neutral"] <= still["sadness"]
    wrists = {emotion: take(emotion).figures.wrists_m for emotion in EMOTIONS}
    assert max(wrists["fear"], wrists["sadness"]) < min(wrists["anger"], wrists["joy"], wrists["surprise"])


def test_the_head_goes_where_the_emotion_drives_it() -> None:
    head = {}
    for emotion in EMOTIONS:
        position, _ = take(emotion).clip.to_model(slice(None, None, 5))
        head[emotion] = np.median(position[:, REFERENCE.index["head"]], axis=0)
    forward = {emotion: at[2] for emotion, at in head.items()}
    assert forward["anger"] > forward["neutral"] > max(forward["fear"], forward["disgust"])
    height = {emotion: at[1] for emotion, at in head.items()}
    assert height["joy"] > height["neutral"] > height["sadness"]


@pytest.mark.parametrize("emotion", ["neutral", "anger", "surprise"])
def test_a_hand_on_the_table_stays_there(emotion: str) -> None:
    it = take(emotion)
    position, _ = it.clip.to_model()
    wrist = position[:, REFERENCE.index["leftHand"]]
    for span in it.of("posture"):
        if span["behaviour"] != "hand_on_table" or span["end_s"] - span["start_s"] < 2.0:
            continue
        held = wrist[round((span["start_s"] + 1.3) * 30) : round(span["end_s"] * 30)]
        assert np.ptp(held, axis=0).max() < 0.02
        assert (held[:, 1] > TABLE_TOP_M + 0.02).all()
        assert (held[:, 1] < TABLE_TOP_M + 0.08).all()


def test_no_two_takes_share_their_timing() -> None:
    seen: dict[tuple[str, float, float], str] = {}
    for emotion in EMOTIONS:
        for span in take(emotion).of("mannerism") + take(emotion).of("gesture"):
            key = (span["behaviour"], round(span["start_s"], 1), round(span["end_s"] - span["start_s"], 1))
            assert key not in seen, f"{emotion} and {seen[key]}: {key}"
            seen[key] = emotion
    shared = Counter(name for emotion in EMOTIONS for name in {s["behaviour"] for s in take(emotion).notes["spans"]})
    assert sum(count >= 2 for count in shared.values()) >= 20


def test_performing_again_gives_the_committed_take() -> None:
    emotion, seconds = "disgust", 7.0
    clip, notes = perform_take(emotion, None, seconds + 1.0)
    frames = round(seconds * 30)
    committed = take(emotion)
    one, two = clip.rotation[:frames], committed.clip.rotation[:frames]
    apart = np.linalg.norm(quat.log(quat.multiply(quat.conjugate(one), two)), axis=-1)
    assert apart.max() < 1e-4
    assert clip.translation[:frames] == pytest.approx(committed.clip.translation[:frames], abs=1e-4)
    again = [(s.layer, s.behaviour, round(s.start_s, 3)) for s in notes.spans if s.end_s < seconds]
    before = [(s["layer"], s["behaviour"], s["start_s"]) for s in committed.notes["spans"] if s["end_s"] < seconds]
    assert again == before
