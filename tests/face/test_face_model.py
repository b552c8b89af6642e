"""The whole-face Gaussian against independent vectors, and the regression on simulated raters.

MCG_CONFORMANCE names another file of the same form.
"""

from __future__ import annotations

import json
import os
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from game.core import ASSETS, BadInput
from game.face import (
    REGIONS,
    Face,
    FaceModel,
    fit_gaussian,
    fit_weights,
    load_parts,
    load_weights,
    log_density,
    whole_face,
)

VECTORS = json.loads(
    Path(os.environ.get("MCG_CONFORMANCE") or Path(__file__).parents[1] / "data" / "formulae.json").read_text("utf-8")
)


@pytest.fixture(scope="module")
def model() -> FaceModel:
    return FaceModel(load_parts(ASSETS / "face" / "parts.yaml"), load_weights(ASSETS / "face" / "weights.yaml"))


@pytest.mark.parametrize("case", VECTORS["face"])
def test_whole_face_agrees_with_the_reference(case):
    mean, covariance = whole_face(
        [case["parts"][region][0] for region in REGIONS],
        [case["parts"][region][1] for region in REGIONS],
        [case["weights"][region] for region in REGIONS],
    )
    np.testing.assert_allclose(mean, case["mean"], rtol=1e-9, atol=1e-14)
    np.testing.assert_allclose(covariance, case["covariance"], rtol=1e-9, atol=1e-14)


def test_covariance_stays_positive_semidefinite_for_any_weights():
    rng = np.random.default_rng(3)
    for _ in range(200):
        root = rng.normal(size=(4, 2, 2))
        weights = rng.uniform(0.0, 1.5, (4, 2))
        _, sigma = whole_face(rng.normal(size=(4, 2)), root @ root.transpose(0, 2, 1), weights)
        assert np.linalg.eigvalsh(sigma).min() > -1e-12


def test_log_density_is_that_of_a_normal_distribution():
    sigma = np.array([[0.2, 0.05], [0.05, 0.1]])
    point, mean = np.array([0.3, -0.2]), np.array([0.1, 0.1])
    offset = point - mean
    expected = -0.5 * offset @ np.linalg.inv(sigma) @ offset - 0.5 * np.log(np.linalg.det(2 * np.pi * sigma))
    assert log_density(point, mean, sigma) == pytest.approx(expected)
    with pytest.raises(BadInput, match="positive definite"):
        log_density(point, mean, np.array([[0.1, 0.2], [0.2, 0.1]]))


def test_negative_weights_are_refused():
    with pytest.raises(BadInput, match="0 or more"):
        whole_face(np.zeros((4, 2)), np.tile(np.eye(2), (4, 1, 1)), -np.ones((4, 2)))


def test_the_standard_face_is_the_origin_and_reported_weights_are_shipped(model):
    mean, _ = model.mean_cov(Face())
    np.testing.assert_array_equal(mean, 0.0)
    weight = dict(zip(REGIONS, model.weights.value, strict=True))
    source = dict(zip(REGIONS, model.weights.source, strict=True))
    assert (weight["skin"][0], weight["mouth"][0]) == (0.97, 0.68)
    assert (weight["skin"][1], weight["eyes"][1]) == (0.95, 0.94)
    assert source == {
        "eyes": ("assumed", "reported"),
        "eyebrows": ("assumed", "assumed"),
        "mouth": ("reported", "assumed"),
        "skin": ("reported", "reported"),
    }
    assert "estimate" in model.parts.ratings  # never presented as an experiment


def test_all_faces_agree_with_one_at_a_time(model):
    mean, covariance = model.all_faces()
    assert mean.shape == (*model.parts.counts, 2)
    for numbers in ((0, 0, 0, 0), (3, 2, 5, 1), (1, 4, 2, 7)):
        one, sigma = model.mean_cov(numbers)
        np.testing.assert_allclose(mean[numbers], one, atol=1e-12)
        np.testing.assert_allclose(covariance[numbers], sigma, atol=1e-12)


def _simulated_raters(model, raters, noise, rng):
    """81 faces of three parts per region, rated by people who disagree: the paper's experiment."""
    truth = rng.uniform(0.3, 1.0, (4, 2))
    chosen = [(0, 1, 6), (0, 2, 3), (0, 2, 10), (0, 2, 4)]
    faces = np.array(list(product(*chosen)))
    part_mean = np.stack([region.mean[faces[:, i]] for i, region in enumerate(model.parts.regions)], axis=1)
    exact = (part_mean * truth).sum(axis=1)
    ratings = exact + rng.normal(0.0, noise, (raters, *exact.shape))
    return truth, part_mean, ratings.mean(axis=0)


def test_regression_recovers_the_weights_of_simulated_raters(model):
    rng = np.random.default_rng(8)
    truth, part_mean, rated = _simulated_raters(model, 32, 0.25, rng)
    assert len(rated) == 81
    covered = 0
    for axis, fit in enumerate(fit_weights(part_mean, rated)):
        np.testing.assert_allclose(fit.weight, truth[:, axis], atol=0.12)
        covered += int(((fit.interval[:, 0] <= truth[:, axis]) & (truth[:, axis] <= fit.interval[:, 1])).sum())
        assert fit.r_squared > 0.8
        assert fit.p_value < 0.05
        assert (fit.p_weight < 0.05).all()
    assert covered >= 6  # of 8 intervals of 95 %


def test_more_raters_bring_the_weights_closer(model):
    errors = []
    for raters in (2, 200):
        truth, part_mean, rated = _simulated_raters(model, raters, 0.4, np.random.default_rng(5))
        fits = fit_weights(part_mean, rated)
        errors.append(np.abs(np.stack([fit.weight for fit in fits], axis=-1) - truth).mean())
    assert errors[1] < errors[0] / 3


def test_confidence_intervals_cover_the_truth_about_as_often_as_they_say(model):
    rng = np.random.default_rng(21)
    hits = total = 0
    for _ in range(60):
        truth, part_mean, rated = _simulated_raters(model, 8, 0.3, rng)
        for axis, fit in enumerate(fit_weights(part_mean, rated)):
            hits += int(((fit.interval[:, 0] <= truth[:, axis]) & (truth[:, axis] <= fit.interval[:, 1])).sum())
            total += 4
    assert 0.90 <= hits / total <= 0.99


def test_ratings_of_the_parts_alone_predict_all_faces(model):
    """The paper's O(n): some 50 rated faces stand for 25,200; the error falls with the number of raters."""
    rng = np.random.default_rng(12)
    weights = model.weights.value
    exact, _ = model.all_faces()
    errors = []
    for raters in (4, 32, 256):
        predicted = np.zeros(exact.shape)
        for axis, region in enumerate(model.parts.regions):
            rated = []
            for mean, sigma in zip(region.mean, region.covariance, strict=True):
                answers = rng.multivariate_normal(mean, sigma, raters).clip(-1.0, 1.0)
                rated.append(fit_gaussian(answers)[0])
            shape = [1, 1, 1, 1, 2]
            shape[axis] = -1
            predicted = predicted + (np.array(rated) * weights[axis]).reshape(shape)
        errors.append(float(np.sqrt(((predicted - exact) ** 2).mean())))
    assert errors[0] > errors[1] > errors[2]
    assert errors[1] < 0.1
    assert errors[2] < 0.04


def test_too_few_or_singular_ratings_are_refused():
    with pytest.raises(BadInput, match="at least 6"):
        fit_weights(np.zeros((5, 4, 2)), np.zeros((5, 2)))
    with pytest.raises(BadInput, match="singular"):
        fit_weights(np.ones((20, 4, 2)), np.ones((20, 2)))


def test_part_gaussians_come_back_from_ratings():
    rng = np.random.default_rng(2)
    sigma = np.array([[0.02, 0.005], [0.005, 0.03]])
    mean, covariance = fit_gaussian(rng.multivariate_normal([0.2, -0.1], sigma, 4000).clip(-1, 1))
    np.testing.assert_allclose(mean, [0.2, -0.1], atol=0.02)
    np.testing.assert_allclose(covariance, sigma, atol=0.003)
    with pytest.raises(BadInput, match="at least 3"):
        fit_gaussian([[0.0, 0.0], [0.1, 0.1]])
    with pytest.raises(BadInput, match="-1 to 1"):
        fit_gaussian([[0.0, 0.0], [0.1, 2.0], [0.3, 0.1]])
    with pytest.raises(BadInput, match="on one line"):
        fit_gaussian([[0.0, 0.0], [0.1, 0.1], [0.3, 0.3]])
