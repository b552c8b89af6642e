"""Geometry: every two parts interpolate to finite, bounded, non-inverted shapes."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from game.core import BadInput
from game.face import DEFAULT_STYLE, FIELDS, DrawList, FaceAsset, FaceStyle, face_params, load_face, tessellate
from game.face._brows import brow_lines
from game.face._eyes import lids
from game.face._mouth import lips


@pytest.fixture(scope="module")
def asset() -> FaceAsset:
    return load_face()


def _sound(drawing: DrawList) -> None:
    for layer in (drawing.under, drawing.over):
        assert layer.position.dtype == layer.colour.dtype == np.float32
        assert layer.triangle.dtype == np.uint32
        assert np.isfinite(layer.position).all()
        assert np.isfinite(layer.colour).all()
        assert layer.position[:, 0].min() >= -170.0
        assert layer.position[:, 0].max() <= 170.0
        assert layer.position[:, 1].min() >= -200.0
        assert layer.position[:, 1].max() <= 140.0
        assert layer.colour.min() >= 0.0
        assert layer.colour[:, 3].max() <= 1.0 + 1e-6
        assert (layer.colour[:, :3] <= layer.colour[:, 3:] + 1e-6).all()  # premultiplied
        assert layer.triangle.max() < len(layer.position)


def test_every_two_parts_of_a_region_interpolate_without_inversion(asset):
    for region in asset.model.parts.regions:
        for one, two in combinations(range(len(region.names)), 2):
            for t in (0.0, 0.2, 0.4, 0.6, 0.8, 1.0):
                params = (1.0 - t) * region.shape[one] + t * region.shape[two]
                where = (region.name, region.names[one], region.names[two], t)
                if region.name == "eyes":
                    lid = lids(params)
                    assert (np.diff(lid.x, axis=1) > 0.0).all(), where
                    assert (lid.upper >= lid.lower).all(), where
                    assert np.abs(lid.upper).max() < 70.0, where
                elif region.name == "mouth":
                    lip = lips(params, DEFAULT_STYLE)
                    assert (np.diff(lip.x) > 0.0).all(), where
                    assert (lip.upper >= lip.lower).all(), where
                    assert lip.lower.min() > -170.0, where
                elif region.name == "eyebrows":
                    assert (np.diff(brow_lines(params, DEFAULT_STYLE)[0, :, 0]) > 0.0).all(), where
                if t in (0.2, 0.6):
                    _sound(tessellate(params))


def test_small_steps_between_parts_make_small_changes(asset):
    """No jump anywhere on the way: lids and lips move at most in proportion to the step."""
    parts = asset.model.parts
    for region in (parts.regions[0], parts.regions[2]):
        for one, two in combinations(range(len(region.names)), 2):
            ways = np.linspace(0.0, 1.0, 41)[:, None] * (region.shape[two] - region.shape[one]) + region.shape[one]
            lid = [lids(p) for p in ways]
            lip = [lips(p, DEFAULT_STYLE) for p in ways]
            for curves in (
                np.array([(e.upper, e.lower) for e in lid]),
                np.array([(m.upper, m.lower) for m in lip]),
            ):
                assert np.abs(np.diff(curves, axis=0)).max() < 7.0, (region.names[one], region.names[two])


def test_random_expressions_and_wild_values_stay_sound():
    rng = np.random.default_rng(4)
    low, high = np.array([f.low for f in FIELDS]), np.array([f.high for f in FIELDS])
    for _ in range(60):
        _sound(tessellate(rng.uniform(low, high)))
    _sound(tessellate(np.full(len(FIELDS), 1e6)))
    _sound(tessellate(np.full(len(FIELDS), -1e6)))


def test_closed_lids_and_lips_meet():
    shut = lids(face_params(eye_open=0.0, eye_arc=1.0))
    np.testing.assert_allclose(shut.upper, shut.lower, atol=1e-9)
    assert shut.upper[0, 16] > shut.upper[0, [0, -1]].max() + 10.0  # a happy arch
    mouth = lips(face_params(), DEFAULT_STYLE)
    np.testing.assert_allclose(mouth.upper, mouth.lower, atol=1e-9)
    opened = lips(face_params(mouth_open=30.0), DEFAULT_STYLE)
    assert (opened.upper - opened.lower).max() > 25.0


def test_one_eye_can_close_alone():
    wink = lids(face_params(eye_uneven=1.0))
    assert wink.ajar.tolist() == [1.0, 0.0]  # the character's left stays open


def test_the_iris_never_leaves_the_eye():
    for look in (-1.0, 1.0):
        params = face_params(look_x=look, look_y=look, eye_open=0.6)
        lid = lids(params)
        rng = np.random.default_rng(1)
        inside = lid.between(rng.uniform(-60.0, 60.0, (2, 400, 2)))
        for side in range(2):
            x, y = inside[side].T
            assert (y <= np.interp(x, lid.x[side], lid.upper[side]) + 1e-9).all()
            assert (y >= np.interp(x, lid.x[side], lid.lower[side]) - 1e-9).all()


def test_the_over_layer_holds_lashes_and_brows_and_the_signs():
    plain = tessellate(face_params()).over
    angry = tessellate(face_params(vein=1.0, sweat=1.0)).over
    assert 0 < len(plain.triangle) < len(angry.triangle)
    assert plain.position[:, 1].min() > -90.0  # no mouth on the hair
    assert len(tessellate(face_params(mouth_open=30.0, blush=1.0)).over.triangle) == len(plain.triangle)


def test_the_same_make_up_keeps_its_index_array():
    one = tessellate(face_params(look_x=0.2)).under.triangle
    assert tessellate(face_params(look_x=-0.4, brow_raise=3.0)).under.triangle is one


def test_wrong_input_is_refused():
    with pytest.raises(BadInput, match="finite numbers"):
        tessellate(np.zeros(3))
    with pytest.raises(BadInput, match="finite numbers"):
        tessellate(np.full(len(FIELDS), np.nan))
    with pytest.raises(BadInput, match="did you mean eye_open"):
        face_params(eye_opne=1.0)
    with pytest.raises(BadInput, match=r"0 to 1\.3"):
        face_params(eye_open=3.0)


def test_a_style_ages_and_rests_a_face_and_leaves_the_standard_one_alone():
    plain = tessellate(face_params())
    assert np.array_equal(tessellate(face_params(), FaceStyle()).under.position, plain.under.position)
    old = tessellate(face_params(), FaceStyle(age=0.8))
    assert len(old.under.triangle) > len(plain.under.triangle)
    _sound(old)
    smiling = tessellate(face_params(mouth_corner=9.0), FaceStyle(age=0.8))
    assert smiling.under.colour.sum() != old.under.colour.sum()
    stern = tessellate(face_params(), FaceStyle(rest=(("brow_angle", 8.0),)))
    assert np.array_equal(stern.over.position, tessellate(face_params(brow_angle=8.0)).over.position)


@pytest.mark.parametrize(
    "changes",
    [
        {
            "eye_scale": 0.98,
            "eye_height": 0.86,
            "lash_weight": 0.78,
            "lash_wing": 0.0,
            "age": 0.85,
            "mouth_scale": 0.86,
        },
        {"eye_y": -30.0, "nose_scale": 1.5, "brow_weight": 1.95, "mouth_scale": 1.22, "ruddy": 0.75},
    ],
)
def test_every_expression_is_sound_in_every_style(asset, changes):
    style = FaceStyle(**changes)
    for name in asset.expressions:
        _sound(tessellate(asset.expression(name).params, style))
