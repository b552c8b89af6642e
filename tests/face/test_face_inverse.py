"""From emotion to face: order, ties, locks, diversity, and what tells the seven apart."""

from __future__ import annotations

import numpy as np
import pytest

from game.core import EMOTIONS, BadInput, emotion_vector
from game.face import Face, FaceAsset, load_face, log_density


@pytest.fixture(scope="module")
def asset() -> FaceAsset:
    return load_face()


def _best(asset, **emotion):
    search = asset.search
    return asset.model.parts.face(search.numbers(search.best(search.score_emotion(emotion_vector(emotion)))))


def test_the_best_face_for_a_point_has_the_highest_density_of_all(asset):
    search = asset.search
    for point in ((0.6, 0.4), (-0.7, 0.6), (-0.5, -0.3), (0.1, 0.7)):
        proposals = search.propose(search.score_point(point), 12)
        assert len(proposals) == 12
        assert [p.score for p in proposals] == sorted((p.score for p in proposals), reverse=True)
        best = log_density(point, search.mean, search.covariance).max()
        assert proposals[0].score == pytest.approx(best)
        assert asset.model.log_density(point, proposals[0].face) == pytest.approx(best)
        assert np.linalg.norm(proposals[0].mean - point) < 0.35


def test_a_wanted_gaussian_finds_the_face_that_has_it(asset):
    search = asset.search
    wanted = 4321
    score = search.score_gaussian(search.mean[wanted], search.covariance[wanted])
    assert score[wanted] == pytest.approx(0.0, abs=1e-9)  # −KL of a distribution from itself
    assert score.max() <= 1e-9
    with pytest.raises(BadInput, match="positive definite"):
        search.score_gaussian([0.0, 0.0], [[1.0, 2.0], [2.0, 1.0]])


@pytest.mark.parametrize("strength", [0.4, 0.65, 0.9])
def test_the_seven_choose_seven_faces(asset, strength):
    faces = [_best(asset, **{name: strength}) for name in EMOTIONS[:6]] + [_best(asset, neutral=1.0)]
    assert len(set(faces)) == 7
    for i, one in enumerate(faces):
        for other in faces[:i]:
            differing = sum(a != b for a, b in zip(one.parts, other.parts, strict=True))
            assert differing >= 2, (one, other)


def test_a_chosen_face_fits_its_emotion(asset):
    """Each region's part has its best affinity among the likely ones, and the Gaussian lies on the right side."""
    parts = asset.model.parts
    for index, name in enumerate(EMOTIONS[:6]):
        face = _best(asset, **{name: 0.9})
        mean, _ = asset.model.mean_cov(face)
        place = parts.places[index]
        assert np.sign(mean[0]) == np.sign(place[0])
        assert float(mean @ place) > 0.5 * float(place @ place)
        for region, part in zip(parts.regions, parts.numbers(face), strict=True):
            assert region.affinity[part, index] >= region.affinity[:, index].max() - 0.12


def test_neutral_is_the_standard_face_and_faint_feelings_stay_close(asset):
    assert _best(asset, neutral=1.0) == Face()
    for name in EMOTIONS[:6]:
        assert sum(part != "standard" for part in _best(asset, **{name: 0.2}).parts) <= 1
        assert sum(part != "standard" for part in _best(asset, **{name: 0.9}).parts) >= 3


def test_of_two_feelings_the_mouth_shows_the_stronger(asset):
    """Laughing eyes over chattering teeth say nothing; a laugh under anxious brows is a nervous one."""
    regions = asset.model.parts.regions
    for strong, weak in (("joy", "fear"), ("joy", "sadness"), ("joy", "disgust"), ("sadness", "joy"), ("fear", "joy")):
        face = _best(asset, **{strong: 0.55, weak: 0.35})
        told = {
            r.name: dict(zip(EMOTIONS, r.affinity[r.index(p)], strict=True))
            for r, p in zip(regions, face.parts, strict=True)
        }
        for region in ("mouth", "skin"):
            assert told[region][strong] > told[region][weak], (strong, weak, face)
        if strong == "joy":
            assert max(told["eyes"][weak], told["eyebrows"][weak]) > 0.3, (strong, weak, face)


def test_half_a_feeling_beside_another_is_not_shown_at_full_voice(asset):
    """A wistful smile: neither a roar of laughter nor a sob, though all in all much is felt."""
    face = _best(asset, joy=0.47, sadness=0.39)
    mouth = asset.model.parts.regions[2]
    assert face.mouth in ("smile", "contented")
    assert np.linalg.norm(mouth.mean[mouth.index(face.mouth)]) < 0.4
    assert "worried" in face.eyebrows or face.eyes == "teary"
    assert np.isfinite(asset.search.score_emotion([1e-80, 1e-80, 0, 0, 0, 0, 0])).all()
    assert _best(asset, joy=0.9).mouth == "open_laugh"
    assert _best(asset, sadness=0.9).mouth == "sob"


def test_ties_go_to_the_lower_number(asset):
    score = np.zeros(len(asset.search))
    score[[700, 40, 9000]] = 1.0
    score[41] = 1.0 + 1e-12  # equal to nine digits
    assert asset.search.order(score, 3).tolist() == [40, 41, 700]
    assert asset.search.best(score) == 40


def test_locked_regions_stay(asset):
    search = asset.search
    locked = Face("teary", "worried", "standard", "standard")
    proposals = search.propose(search.score_point((0.8, 0.5)), 8, locked=locked, free=("mouth", "skin"))
    assert {(p.face.eyes, p.face.eyebrows) for p in proposals} == {("teary", "worried")}
    assert len({p.face for p in proposals}) == 8


def test_diversity_shares_fewer_parts_and_keeps_the_best_first(asset):
    search = asset.search
    score = search.score_emotion(emotion_vector({"joy": 0.8}))

    def shared(proposals):
        return np.mean(
            [
                sum(a == b for a, b in zip(p.face.parts, q.face.parts, strict=True))
                for i, p in enumerate(proposals)
                for q in proposals[:i]
            ]
        )

    plain, diverse = search.propose(score, 12), search.propose(score, 12, diversity=8.0)
    assert diverse[0].face == plain[0].face
    assert shared(diverse) < shared(plain) - 0.4
    assert len({p.face for p in diverse}) == 12


def test_wrong_emotions_are_refused(asset):
    for wrong in (np.zeros(6), np.full(7, np.nan), -np.ones(7)):
        with pytest.raises(BadInput, match="seven numbers"):
            asset.search.score_emotion(wrong)
