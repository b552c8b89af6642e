"""The face of a foreign avatar: presets, overrides, ARKit names and rated expressions from one and the same signal."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from game.core.emotion_space import EMOTION_INDEX, EMOTIONS, emotion_vector
from game.core.errors import BadInput
from game.face import (
    ARKIT,
    FIELDS,
    INDEX,
    AvatarFace,
    FaceLeak,
    FaceSignal,
    RatedExpression,
    advance_face,
    emotion_recipes,
    load_face,
    load_rated,
    rated_scores,
    rated_text,
    start_face,
)
from game.formats import VrmExpression, VrmLookAt, build_vrm, read_gltf

PRESETS = (
    *("happy", "angry", "sad", "relaxed", "surprised", "neutral", "blink", "aa", "ih", "ou", "ee", "oh"),
    *("lookUp", "lookDown", "lookLeft", "lookRight"),
)
SILENT = np.zeros(6)
STANDARD = np.array([field.standard for field in FIELDS])


def plain(names: tuple[str, ...], **changes: VrmExpression) -> dict[str, VrmExpression]:
    return {name: changes.get(name, VrmExpression(name, True, ())) for name in names}


def shown(**values: float) -> np.ndarray:
    return np.asarray(emotion_vector(values))


def weights(face: AvatarFace, signal: FaceSignal, visemes: np.ndarray = SILENT) -> dict[str, float]:
    return dict(zip(face.names, face.weights(signal, STANDARD, visemes).weight.tolist(), strict=True))


@pytest.mark.parametrize(
    ("emotion", "name"), [("joy", "happy"), ("anger", "angry"), ("sadness", "sad"), ("surprise", "surprised")]
)
def test_a_strong_emotion_is_its_preset(emotion: str, name: str):
    found = weights(AvatarFace(plain(PRESETS)), FaceSignal(shown(**{emotion: 0.9})))
    assert found[name] > 0.8
    assert max(found, key=lambda n: found[n]) == name


def test_a_little_joy_is_relaxed_and_fear_and_disgust_are_composed_and_differ():
    face = AvatarFace(plain(PRESETS))
    mild = weights(face, FaceSignal(shown(joy=0.2)))
    assert mild["relaxed"] > 3 * mild["happy"]
    fear, disgust = (weights(face, FaceSignal(shown(**{e: 0.9}))) for e in ("fear", "disgust"))
    assert fear["surprised"] > 0.3 < fear["sad"]
    assert disgust["angry"] > 0.3 < disgust["sad"]
    assert abs(fear["angry"] - disgust["angry"]) > 0.3


def test_custom_names_are_understood():
    recipes = emotion_recipes(["Angry", "Fcl_ALL_Fear", "iyagaru", "悲しい", "odoroki_1", "Smile"])
    assert recipes["fear"] == (("Fcl_ALL_Fear", 1.0),)
    assert recipes["disgust"] == (("iyagaru", 1.0),)
    assert recipes["sadness"] == (("悲しい", 1.0),)
    assert recipes["surprise"] == (("odoroki_1", 1.0),)
    assert recipes["joy"] == (("Smile", 1.0),)


def test_weights_change_smoothly_with_the_emotion():
    face = AvatarFace(plain(PRESETS))
    steps = [
        face.weights(FaceSignal(shown(joy=t, sadness=1.0 - t)), STANDARD, SILENT).weight for t in np.linspace(0, 1, 101)
    ]
    assert np.abs(np.diff(steps, axis=0)).max() < 0.06


def test_speech_blinks_and_looks_reach_the_face():
    look_at = VrmLookAt("expression", (0.0, 0.0, 0.0), {"HorizontalOuter": (90.0, 2.0), "VerticalUp": (90.0, 2.0)})
    face = AvatarFace(plain(PRESETS), look_at)
    visemes = np.array([0.9, 0, 0, 0, 0, 0])
    found = weights(face, FaceSignal(shown(), blink=1.0, look=np.array([1.0, 0.0])), visemes)
    assert found["aa"] == pytest.approx(0.9)
    assert found["blink"] == 1.0
    assert found["lookLeft"] == pytest.approx(35.0 / 90.0 * 2.0)
    assert found["lookRight"] == found["lookUp"] == 0.0


def test_overrides_block_and_blend():
    happy = VrmExpression("happy", True, (), override_blink="block", override_mouth="blend", override_look_at="blend")
    face = AvatarFace(plain(PRESETS, happy=happy))
    visemes = np.array([1.0, 0, 0, 0, 0, 0])
    strong = FaceSignal(shown(joy=0.8), blink=1.0, look=np.array([0.5, 0.0]))
    found = weights(face, strong, visemes)
    assert found["happy"] == pytest.approx(0.8)
    assert found["blink"] == 0.0
    assert found["aa"] == pytest.approx(0.2)
    assert face.weights(strong, STANDARD, visemes).look == pytest.approx(0.2)


def test_what_is_felt_breaks_through_the_presets_and_their_overrides_hold_for_that_moment():
    angry = VrmExpression("angry", True, (), override_blink="block", override_mouth="blend")
    face = AvatarFace(plain(PRESETS, angry=angry))
    mask = FaceSignal(shown(joy=0.9), felt=shown(anger=0.8), blink=1.0)
    speaking = np.array([1.0, 0, 0, 0, 0, 0])
    calm = dict(zip(face.names, face.weights(mask, STANDARD, speaking).weight, strict=True))
    leak = FaceLeak(shown(anger=0.8), 0.85)
    found = dict(zip(face.names, face.weights(mask, STANDARD, speaking, leak).weight, strict=True))
    assert calm["happy"] == pytest.approx(0.9)
    assert calm["angry"] == 0.0
    assert (calm["blink"], calm["aa"]) == (1.0, 1.0)
    assert found["angry"] == pytest.approx(0.85 * 0.8)
    assert found["happy"] == pytest.approx(0.15 * 0.9)
    assert found["blink"] == 0.0
    assert found["aa"] == pytest.approx(1.0 - 0.85 * 0.8)
    named = FaceSignal(shown(joy=0.9), expression="relaxed")
    assert dict(zip(face.names, face.weights(named, STANDARD, SILENT, leak).weight, strict=True))["angry"] > 0.5


@pytest.mark.parametrize(("name", "felt"), [("Godette_vrm_v4.vrm", "angry"), ("Example.vrm", "angry")])
def test_leaks_of_real_presets_are_short_and_only_behind_a_mask(shared_data: Path, name: str, felt: str):
    """A file of VRM 0.x and one of 1.0, neither with ARKit's names: half a minute of a smile over rage."""
    expressions = build_vrm(read_gltf(shared_data / "vrm" / name)).expressions
    asset, face = load_face(), AvatarFace(expressions)
    assert not face.has_arkit
    smile, rage = shown(joy=0.7), shown(anger=0.9)
    found = {}
    for honest in (True, False):
        signal = FaceSignal(smile, felt=smile if honest else rage)
        state = start_face(asset, 4, smile)
        found[honest] = []
        for _ in range(900):
            state, params = advance_face(asset, state, signal, 1 / 30)
            found[honest].append(face.weights(signal, params, SILENT, state.leak).weight[face.names.index(felt)])
    assert max(found[True]) == 0.0
    seen = np.array(found[False]) > 0.0
    edges = np.flatnonzero(np.diff(np.concatenate([[0], seen.astype(int), [0]])))
    lengths_s = (edges[1::2] - edges[::2]) / 30.0
    assert 3 <= len(lengths_s) <= 30
    assert lengths_s.min() >= 1 / 25
    assert lengths_s.max() <= 1 / 5 + 1e-9
    assert max(found[False]) > 0.6


def test_binary_expressions_are_all_or_nothing():
    face = AvatarFace(plain(PRESETS, angry=VrmExpression("angry", True, (), is_binary=True)))
    assert weights(face, FaceSignal(shown(anger=0.45)))["angry"] == 0.0
    assert weights(face, FaceSignal(shown(anger=0.7)))["angry"] == 1.0


def arkit_face() -> AvatarFace:
    return AvatarFace({name[0].upper() + name[1:]: VrmExpression(name, False, ()) for name in ARKIT})


def test_arkit_shapes_follow_the_painted_face():
    """Over whole emotions: anger lowers the brows, joy lifts the corners, sadness the inner brows, fear opens."""
    asset, face = load_face(), arkit_face()
    assert face.has_arkit
    found: dict[str, dict[str, float]] = {}
    for emotion in EMOTIONS:
        signal = FaceSignal(shown(**({} if emotion == "neutral" else {emotion: 0.9})))
        state = start_face(asset, 3)
        for _ in range(45):
            state, params = advance_face(asset, state, signal, 1 / 30)
        found[emotion] = dict(zip(face.names, face.weights(signal, params, SILENT).weight.tolist(), strict=True))
    assert found["anger"]["BrowDownLeft"] > 0.4
    assert found["joy"]["MouthSmileLeft"] > 0.2
    assert found["joy"]["MouthSmileLeft"] > found["sadness"]["MouthSmileLeft"]
    assert found["sadness"]["BrowInnerUp"] > found["anger"]["BrowInnerUp"]
    assert found["sadness"]["MouthFrownRight"] > 0.2
    assert found["surprise"]["JawOpen"] > found["neutral"]["JawOpen"]
    for values in found.values():
        assert all(0.0 <= v <= 1.0 for v in values.values())


def test_arkit_sides_and_looks():
    face = arkit_face()
    params = STANDARD.copy()
    params[INDEX["look_x"]], params[INDEX["look_y"]] = 0.7, -0.5
    params[INDEX["eye_uneven"]] = 1.0
    found = dict(zip(face.names, face.weights(FaceSignal(shown()), params, SILENT).weight.tolist(), strict=True))
    assert found["EyeLookOutLeft"] == found["EyeLookInRight"] == pytest.approx(0.7)
    assert found["EyeLookDownLeft"] == pytest.approx(0.5)
    assert found["EyeBlinkRight"] > 0.9 > 0.1 > found["EyeBlinkLeft"]


def rated(name: str, mean: tuple[float, float], emotion: str | None = None) -> RatedExpression:
    affinity = np.zeros(7)
    if emotion:
        affinity[EMOTION_INDEX[emotion]] = 0.8
    return RatedExpression(name, np.array(mean), np.eye(2) * 0.06, 12, affinity)


def test_rated_expressions_are_chosen_by_what_people_saw(tmp_path: Path):
    """An avatar whose expressions have meaningless names: only the ratings tell."""
    places = load_face().model.parts.places
    rows = {r.name: r for r in (rated("e1", (0.7, 0.5)), rated("e2", (-0.6, -0.4)), rated("e3", (-0.7, 0.6), "fear"))}
    text = rated_text("somebody.vrm", rows, places, "rated by 12 people")
    path = tmp_path / "faces.yaml"
    path.write_text(text, encoding="utf-8")
    known, read = load_rated(path)
    np.testing.assert_allclose(read, places, atol=1e-3)
    np.testing.assert_allclose(known["e2"].covariance, rows["e2"].covariance, rtol=1e-4)
    face = AvatarFace(plain(("e1", "e2", "e3")), rated=(known, read))
    for emotion, name in (("joy", "e1"), ("sadness", "e2"), ("fear", "e3")):
        found = weights(face, FaceSignal(shown(**{emotion: 0.8})))
        assert max(found, key=lambda n: found[n]) == name
        assert found[name] > 0.5
    assert sum(weights(face, FaceSignal(shown())).values()) == pytest.approx(0.0)
    scores = rated_scores(known, read, shown(fear=0.8))
    assert max(scores, key=lambda n: scores[n]) == "e3"


def test_a_broken_file_of_ratings_is_refused(tmp_path: Path):
    places = load_face().model.parts.places
    text = rated_text("a", {"e1": rated("e1", (0.1, 0.1))}, places, "x").replace("0.06, 0]", "0.06, 9]")
    path = tmp_path / "faces.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(BadInput, match=r"faces\.yaml:\d+:\d+"):
        load_rated(path)
