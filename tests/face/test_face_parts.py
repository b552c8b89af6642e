"""The designers' files: what must be in them, and how broken ones are refused."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

from game.core import ASSETS, EMOTIONS, BadInput
from game.face import FIELDS, REGIONS, Face, load_expressions, load_face, load_parts, load_weights
from game.face.asset import load_timing
from game.face.params import field_bounds, region_mask
from game.face.speech import load_visemes

FOLDER = ASSETS / "face"


def test_every_region_has_the_standard_and_at_least_seven_more():
    parts = load_parts(FOLDER / "parts.yaml")
    assert tuple(region.name for region in parts.regions) == REGIONS
    low, high = field_bounds()
    for region in parts.regions:
        assert region.names[0] == "standard"
        assert len(region.names) >= 8
        assert len({row.tobytes() for row in region.shape}) == len(region.names)  # no two alike
        assert (region.shape >= low).all()
        assert (region.shape <= high).all()
        assert (np.linalg.eigvalsh(region.covariance) > 0.0).all()
        # Every emotion is said by some part of every region except where a colour would say nothing of its own.
        assert (region.affinity.max(axis=0) >= 0.25).all()
        assert all(set(label) == {"en", "ja"} for label in region.labels)


def test_a_part_touches_only_its_own_region():
    parts = load_parts(FOLDER / "parts.yaml")
    standard = np.array([f.standard for f in FIELDS])
    for region in parts.regions:
        assert (region.shape[:, ~region_mask(region.name)] == standard[~region_mask(region.name)]).all()


def test_strength_scales_the_shape_and_symbols_are_shown_whole():
    parts = load_parts(FOLDER / "parts.yaml")
    face = Face("fierce", "slanted_angry", "grit", "anger_red")
    weak, strong = (parts.params(parts.numbers(face), s) for s in (0.4, 0.9))
    standard = parts.params((0, 0, 0, 0))
    assert np.abs(strong - standard).sum() > 1.15 * np.abs(weak - standard).sum()
    happy = parts.numbers(Face("closed_happy"))
    np.testing.assert_array_equal(parts.params(happy, 0.0), parts.params(happy, 1.0))


def test_unknown_part_names_the_nearest():
    parts = load_parts(FOLDER / "parts.yaml")
    with pytest.raises(BadInput, match="did you mean 'smirk'"):
        parts.numbers(Face(mouth="smirc"))


def test_named_expressions_cover_what_the_dialogue_asks_for():
    asset = load_face()
    for name in ("smirk", "thinking", "greedy", "embarrassed"):
        expression = asset.expression(name)
        assert np.isfinite(expression.params).all()
    shapes = [e.params for e in asset.expressions.values()]
    assert min(np.abs(a - b).sum() for i, a in enumerate(shapes) for b in shapes[:i]) > 1.0
    with pytest.raises(BadInput, match="did you mean 'greedy'"):
        asset.expression("greddy")


def _edited(tmp_path, name, old, new):
    text = (FOLDER / name).read_text("utf-8")
    assert text.count(old) >= 1
    path = tmp_path / name
    path.write_text(text.replace(old, new, 1), "utf-8")
    line = text[: text.index(old)].count("\n") + 1
    return path, line


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("eye_squint: 0.36", "eye_squnt: 0.36", "did you mean 'eye_squint'"),
        ("eye_squint: 0.36", "mouth_open: 3", "unknown key"),
        ("eye_squint: 0.36", "eye_squint: 4.5", "from 0 to 1"),
        ("eye_squint: 0.36", "eye_squint: yes", "a number"),
        ("mean: [0.26, -0.06]", "mean: [0.26]", "two numbers"),
        ("mean: [0.26, -0.06]", "mean: [0.26, -3]", "-1 to 1"),
        ("affinity: {joy: 0.8, neutral: 0.2}", "affinity: {joyy: 0.8}", "did you mean 'joy'"),
        ("label: {en: gentle, ja: 優しい目}", "label: {fr: doux}", "unknown key"),
        ("  eyebrows:", "  eybrows:", "did you mean 'eyebrows'"),
    ],
)
def test_broken_parts_are_refused_with_their_place(tmp_path, old, new, message):
    path, line = _edited(tmp_path, "parts.yaml", old, new)
    with pytest.raises(BadInput, match=message) as caught:
        load_parts(path)
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(f"{path}:{line}:")


def test_a_standard_part_must_change_nothing(tmp_path):
    path, _ = _edited(tmp_path, "parts.yaml", "shape: {}", "shape: {eye_open: 0.9}")
    with pytest.raises(BadInput, match="changes nothing"):
        load_parts(path)


@pytest.mark.parametrize(
    ("name", "old", "new", "message"),
    [
        ("weights.yaml", "source: assumed", "source: guessed", r"reported \| assumed \| fitted"),
        ("weights.yaml", "value: 0.45", "value: -1", "from 0 to 2"),
        ("timing.yaml", "hold_s: 0.4", "hold: 0.4", "did you mean 'hold_s'"),
        ("visemes.yaml", "open: 25.0", "open: wide", "a number"),
        ("expressions.yaml", "mouth: pout", "mouth: poot", "did you mean 'pout'"),
        ("expressions.yaml", "look_y: 0.65", "look_z: 0.65", "did you mean 'look_"),
    ],
)
def test_the_other_files_are_as_strict(tmp_path, name, old, new, message):
    path, line = _edited(tmp_path, name, old, new)
    parts = load_parts(FOLDER / "parts.yaml")
    readers = {
        "weights.yaml": load_weights,
        "timing.yaml": load_timing,
        "visemes.yaml": load_visemes,
        "expressions.yaml": lambda p: load_expressions(p, parts),
    }
    with pytest.raises(BadInput, match=message) as caught:
        readers[name](path)
    assert str(caught.value).startswith(f"{path}:{line}:")


def test_a_whole_folder_can_be_replaced(tmp_path):
    shutil.copytree(FOLDER, tmp_path / "face")
    asset = load_face(tmp_path / "face")
    assert len(asset.search) == np.prod(asset.model.parts.counts)
    assert len(EMOTIONS) == asset.model.parts.places.shape[0]
