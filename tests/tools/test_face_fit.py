"""From simulated people back to the model they know; files that keep their shape; refusals that touch nothing."""

from __future__ import annotations

import argparse
import json
import sys

import numpy as np
import pytest

from game.core import ASSETS, BadInput, MissingPart
from game.face import REGIONS, Face, FaceModel, load_expressions, load_face, load_parts, load_weights
from game.tools.face import fit_command
from game.tools.face.fitting import FACES_NEEDED, fit_ratings
from game.tools.face.ratings_file import COLUMNS, Rating, format_rating, format_row
from game.tools.face.simulate import errors_by_raters, simulate_ratings
from game.tools.face.sitting import single_part_faces, whole_faces
from game.tools.face.yaml_edit import add_expression, add_to_dialogue, with_gaussians

FOLDER = ASSETS / "face"


@pytest.fixture(scope="module")
def model() -> FaceModel:
    return load_face().model


@pytest.fixture(scope="module")
def ratings(model):
    faces = single_part_faces(model.parts) + whole_faces(model.parts, 81, 1)
    return simulate_ratings(model, faces, 48, np.random.default_rng(11))


def write(path, ratings):
    path.write_text(format_row(COLUMNS) + "".join(format_rating(r) for r in ratings))
    return path


def arguments(ratings, **given):
    values = {"out_parts": None, "out_weights": None, "plots": None, "held_out": 0.2, "seed": 1, "json": False}
    return argparse.Namespace(ratings=ratings, face_folder=FOLDER, **(values | given))


def test_simulated_raters_give_the_known_model_back(model, ratings, tmp_path):
    fit = fit_ratings(ratings, model, tmp_path)
    assert fit.axes is not None
    for axis, found in enumerate(fit.axes):
        truth = model.weights.value[:, axis]
        assert np.abs(found.weight - truth).max() < 0.25
        assert np.abs(found.weight - truth).mean() < 0.1
        assert found.r_squared > 0.88
        assert found.p_value < 1e-6
        assert (found.interval[:, 0] < found.weight).all()
        assert (found.weight < found.interval[:, 1]).all()
    means = np.array([p.mean for p in fit.parts])
    truth = np.array([r.mean[r.index(p.part)] for p in fit.parts for r in model.parts.regions if r.name == p.region])
    assert np.abs(means - truth).max() < 0.15
    assert np.abs(means - truth).mean() < 0.04
    assert fit.held_out is not None
    assert len(fit.held_out.faces) == 16
    assert fit.held_out.r_squared.min() > 0.8
    assert fit.held_out.deviation_rmse is not None
    assert fit.held_out.deviation_rmse.max() < 0.15
    assert fit.simulated
    assert "simulated" in fit.label


def test_covariances_come_back_as_well(model, ratings, tmp_path):
    fit = fit_ratings(ratings, model, tmp_path)
    found = np.array([np.sqrt(np.diag(p.covariance)) for p in fit.parts if p.part != "standard"])
    truth = np.concatenate([np.sqrt(np.diagonal(r.covariance[1:], axis1=1, axis2=2)) for r in model.parts.regions])
    order = [(r.name, n) for r in model.parts.regions for n in r.names[1:]]
    placed = [order.index((p.region, p.part)) for p in fit.parts if p.part != "standard"]
    # The raters' own habits widen every part a little.
    assert np.abs(found - truth[placed]).mean() < 0.05


def test_29_ratings_predict_4096_faces_better_with_every_rater(model):
    rows = errors_by_raters(model, (2, 8, 32), repeats=30)
    assert [(row.rated_faces, row.predicted_faces) for row in rows] == [(29, 4096)] * 3
    errors = [row.error_known_weights for row in rows]
    # Four times the raters, half the error.
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.5)
    assert errors[1] / errors[2] == pytest.approx(2.0, abs=0.5)
    assert errors[2] < 0.08
    assert rows[2].error_fitted_weights < 0.09
    assert rows[0].weight_error > rows[1].weight_error > rows[2].weight_error


def test_a_part_nobody_rated_keeps_its_estimate(model, ratings, tmp_path):
    kept = [r for r in ratings if r.face.mouth == "standard" or r.face != Face(mouth=r.face.mouth)]
    fit = fit_ratings(kept, model, tmp_path)
    assert "mouth/grit" in fit.unrated
    assert "designers' estimates" in fit.label
    out = tmp_path / "parts.yaml"
    assert fit_command.fit(arguments(write(tmp_path / "r.csv", kept), out_parts=out)) == 0
    before, after = load_parts(FOLDER / "parts.yaml").regions[2], load_parts(out).regions[2]
    number = before.index("grit")
    assert (after.mean[number] == before.mean[number]).all()


def test_written_files_keep_their_shape(model, ratings, tmp_path, capsys):
    csv = write(tmp_path / "r.csv", ratings)
    parts, weights = tmp_path / "parts.yaml", tmp_path / "weights.yaml"
    assert fit_command.fit(arguments(csv, out_parts=parts, out_weights=weights, json=True)) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["weights"]["valence"]["regions"]["skin"]["interval"][0] > 0.5
    assert told["held_out"]["faces"] == 16
    old, new = (FOLDER / "parts.yaml").read_text().splitlines(), parts.read_text().splitlines()
    changed = ("ratings:", "mean:", "deviation:", "correlation:")
    same = [[row for row in text if not row.strip().startswith(changed)] for text in (old, new)]
    assert same[0] == same[1], "comments, labels, shapes and order are as they were"
    read = load_parts(parts)
    assert read.ratings == f"48 simulated raters, {sum(read.counts)} of {sum(read.counts)} parts"
    assert all((region.mean[0] == 0.0).all() for region in read.regions)
    listed = {(p["region"], p["part"]): p for p in told["parts"]}
    for region in read.regions:
        for i, name in enumerate(region.names):
            fitted = listed[region.name, name]
            assert region.mean[i] == pytest.approx(fitted["mean"], abs=1e-4)
            assert region.covariance[i] == pytest.approx(np.array(fitted["covariance"]), abs=2e-4)
    found = load_weights(weights)
    assert {s for row in found.source for s in row} == {"fitted"}
    assert found.affinity_weight == load_weights(FOLDER / "weights.yaml").affinity_weight
    # Fitting over the result again finds its own marks and does not heap them up.
    again = tmp_path / "again.yaml"
    args = arguments(csv, out_parts=again)
    args.face_folder = tmp_path
    for name in ("expressions.yaml", "timing.yaml", "visemes.yaml"):
        (tmp_path / name).write_bytes((FOLDER / name).read_bytes())
    assert fit_command.fit(args) == 0
    assert again.read_text() == parts.read_text()


def test_too_few_ratings_say_how_many_are_needed(model, tmp_path):
    face = Face(eyes="fierce")
    two = [Rating(f"r{i}", face, 0.1 * i, 0.2) for i in range(2)]
    with pytest.raises(BadInput, match=f"3 ratings of a face with one part, or {FACES_NEEDED} rated faces"):
        fit_ratings(two, model, tmp_path / "r.csv")
    three = [Rating(f"r{i}", face, 0.1 * i, 0.1 * i * i) for i in range(3)]
    fit = fit_ratings(three, model, tmp_path / "r.csv")
    assert [p.part for p in fit.parts] == ["fierce"]
    assert fit.lacking == ("weights: 0 of the 6 whole faces needed, 6 more to rate",)
    out = tmp_path / "weights.yaml"
    out.write_text("mine")
    with pytest.raises(BadInput, match="6 more to rate"):
        fit_command.fit(arguments(write(tmp_path / "r.csv", three), out_weights=out, out_parts=tmp_path / "p.yaml"))
    assert out.read_text() == "mine"
    assert not (tmp_path / "p.yaml").exists()


def test_a_part_written_on_one_line_stays_on_one_line(model, ratings, tmp_path):
    text = (FOLDER / "parts.yaml").read_text()
    start, end = text.index("    gentle:\n"), text.index("    closed_happy:\n")
    flow = "    gentle: {shape: {}, mean: [0.26, -0.06], deviation: [0.18, 0.2], affinity: {joy: 0.8}}  # ok\n"
    path = tmp_path / "parts.yaml"
    path.write_text(text[:start] + flow + text[end:])
    fit = fit_ratings(ratings, model, tmp_path)
    written = with_gaussians(path, fit)
    row = next(line for line in written.splitlines() if line.startswith("    gentle:"))
    assert row.endswith("affinity: {joy: 0.8}}  # ok")
    assert "correlation: " in row
    path.write_text(written)
    region, part = load_parts(path).regions[0], next(p for p in fit.parts if p.part == "gentle")
    assert region.covariance[1] == pytest.approx(part.covariance, abs=2e-4)


def test_nothing_is_written_where_one_of_two_cannot_be(model, ratings, tmp_path):
    csv = write(tmp_path / "r.csv", ratings)
    with pytest.raises(BadInput, match="folder that exists"):
        fit_command.fit(arguments(csv, out_parts=tmp_path / "p.yaml", out_weights=tmp_path / "no" / "w.yaml"))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["r.csv"]


def test_singular_ratings_name_the_row(model, tmp_path):
    path = write(tmp_path / "r.csv", [Rating(f"r{i}", Face(mouth="grit"), 0.1 * i, 0.2 * i) for i in range(4)])
    out = tmp_path / "p.yaml"
    with pytest.raises(BadInput, match=r"r\.csv:5: mouth/grit: singular covariance.*on one line"):
        fit_command.fit(arguments(path, out_parts=out))
    assert not out.exists()


def test_faces_that_do_not_tell_regions_apart(model, tmp_path):
    rng = np.random.default_rng(2)
    faces = [Face(eyes="fierce", mouth=m) for m in ("grit", "frown", "shout", "pout", "sob", "gasp", "cat")]
    found = [Rating("r", f, *rng.uniform(-0.5, 0.5, 2)) for f in faces]
    with pytest.raises(BadInput, match="singular design"):
        fit_ratings(found, model, tmp_path / "r.csv")


def test_a_negative_weight_is_written_as_zero(model, tmp_path):
    faces = whole_faces(model.parts, 40, 3)
    twisted = model.weights.value.copy()
    twisted[1] = -0.4
    found = []
    for face in faces:
        means = np.stack([r.mean[r.index(n)] for r, n in zip(model.parts.regions, face.parts, strict=True)])
        v, a = np.clip((means * twisted).sum(axis=0), -1, 1)
        found.append(Rating("r", face, float(v), float(a)))
    fit = fit_ratings(found, model, tmp_path)
    assert fit.axes is not None
    assert fit.weights is not None
    assert fit.axes[0].weight[1] < 0
    assert (fit.weights[1] == 0).all()


def test_without_matplotlib_plots_say_what_to_install(monkeypatch, ratings, tmp_path):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(MissingPart, match="reports"):
        fit_command.fit(arguments(write(tmp_path / "r.csv", ratings), plots=tmp_path, out_parts=tmp_path / "p.yaml"))
    assert not (tmp_path / "p.yaml").exists()


def test_plots_are_drawn(model, ratings, tmp_path):
    pytest.importorskip("matplotlib", reason="plots need the reports extra")
    csv = write(tmp_path / "r.csv", ratings)
    assert fit_command.fit(arguments(csv, plots=tmp_path / "plots")) == 0
    files = {p.name: p.stat().st_size for p in (tmp_path / "plots").iterdir()}
    assert set(files) == {"parts.png", "weights.png", "predicted.png"}
    assert min(files.values()) > 10_000


def test_a_saved_expression_is_appended_and_can_be_spoken(model, tmp_path):
    path = tmp_path / "expressions.yaml"
    path.write_bytes((FOLDER / "expressions.yaml").read_bytes())
    before = path.read_text()
    face = Face("fierce", "knitted", "grit", "vein")
    add_expression(path, "seething", 'a "label": odd # one', face, model.parts)
    assert path.read_text().startswith(before)
    found = load_expressions(path, model.parts)["seething"]
    assert found.face == face
    assert found.label == {"en": "a 'label': odd # one"}
    for name, message in (("seething", "free"), ("Bad Name", "small letters"), ("", "small letters")):
        with pytest.raises(BadInput, match=message):
            add_expression(path, name, "x", face, model.parts)
    text = path.read_text()
    with pytest.raises(BadInput, match="unknown part"):
        add_expression(path, "wrong", "x", Face(eyes="no_such"), model.parts)
    assert path.read_text() == text
    fresh = tmp_path / "fresh.yaml"
    add_expression(fresh, "first", "", face, model.parts)
    assert list(load_expressions(fresh, model.parts)) == ["first"]


def test_entries_go_before_what_follows_the_block(model, tmp_path):
    path = tmp_path / "e.yaml"
    path.write_text("expressions:  # here\n  a:\n    eyes: standard\n    eyebrows: flat\n    mouth: smile\n"
                    "    skin: blush\n\n# about the version\nversion: 1")  # fmt: skip
    add_expression(path, "b", "", Face(), model.parts)
    assert list(load_expressions(path, model.parts)) == ["a", "b"]
    assert path.read_text().endswith("\n\n# about the version\nversion: 1\n")
    faces = tmp_path / "faces.yaml"
    faces.write_text("# all\nfaces:\n  smile: {joy: 0.3}  # soft\n")
    for _ in range(2):
        add_to_dialogue(faces, "b")
    assert faces.read_text() == "# all\nfaces:\n  smile: {joy: 0.3}  # soft\n  b: {}\n"


def test_every_region_is_fitted(model, ratings, tmp_path):
    fit = fit_ratings(ratings, model, tmp_path)
    assert {p.region for p in fit.parts} == set(REGIONS)
    assert not fit.unrated
