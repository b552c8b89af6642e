"""The authoring tool without its window, the proposals behind it, and the sheets; one test opens the window itself."""

from __future__ import annotations

import argparse
import importlib.util
import json
import time

import numpy as np
import pytest

from game.app import face as face_command
from game.app.cli import main
from game.core import ASSETS, EMOTION_INDEX, ROOT, BadInput, MissingPart, emotion_vector
from game.face import Face, load_expressions, load_face
from game.tools.face.author import Author
from game.tools.face.pad import Pad, ellipse
from game.tools.face.wanted import Proposer, Wanted, parse_spread, points_around


@pytest.fixture(scope="module")
def asset():
    return load_face()


@pytest.fixture(scope="module")
def proposer(asset):
    return Proposer(asset.search)


@pytest.fixture
def author(asset, tmp_path):
    return Author(asset, tmp_path / "expressions.yaml")


# -- proposals -------------------------------------------------------------------------------------------------------


def test_without_taste_the_order_is_the_models_log_density(asset, proposer):
    found = proposer.find(Wanted((-0.7, 0.6)), 12, coherence=0.0)
    densities = [f.log_density for f in found]
    assert densities == sorted(densities, reverse=True)
    assert densities[0] == pytest.approx(float(asset.search.score_point((-0.7, 0.6)).max()))
    assert densities[0] == pytest.approx(asset.model.log_density((-0.7, 0.6), found[0].face))


@pytest.mark.parametrize("number", range(8))
def test_proposals_around_the_circle_lie_there_and_do_not_contradict_themselves(asset, proposer, number):
    wanted = points_around(0.7)[number]
    found = proposer.find(wanted, 12, diverse=True)
    assert len({f.face for f in found}) == 12
    means, point = np.array([f.proposal.mean for f in found]), np.array(wanted.point)
    assert np.linalg.norm(means - point, axis=1).mean() < 0.45
    along = means @ point / (np.linalg.norm(means, axis=1) * 0.7)
    assert along.min() > np.cos(np.pi / 4)  # no proposal is further off than the next of the eight points
    regions = asset.model.parts.regions
    for f in found:
        worn = [r.affinity[r.index(p)] for r, p in zip(regions, f.face.parts, strict=True) if p != "standard"]
        assert not worn or np.stack(worn)[:, :6].min(axis=0).max() > 0.02, f.face


def test_nothing_wanted_is_the_standard_face(proposer):
    for diverse in (False, True):
        assert proposer.find(Wanted((0.0, 0.0)), 12, diverse=diverse)[0].face == Face()


def test_parts_that_contradict_each_other_make_little_sense(asset, proposer):
    """On the two axes alone anger's colour goes with a smile, and a roar of laughter with drowsy lids."""
    search, parts = asset.search, asset.model.parts

    def sense(*names: str) -> float:
        return float(proposer.sense[search.index(parts.numbers(Face(*names)))])

    assert proposer.sense.max() <= 1.0
    assert sense("wide", "raised", "gasp", "standard") > sense("wide", "standard", "smile", "anger_red") + 0.3
    assert (
        sense("closed_content", "relaxed", "contented", "warm") > sense("drowsy", "relaxed", "open_laugh", "warm") + 0.2
    )
    assert sense("weary", "drooping", "sigh", "tired") > sense("weary", "drooping", "shout", "tired") + 0.2


def test_a_wanted_gaussian_orders_by_divergence(asset, proposer):
    narrow = proposer.find(Wanted((0.0, 0.0), parse_spread("0.05")), 1, coherence=0.0)[0]
    wide = proposer.find(Wanted((0.0, 0.0), parse_spread("0.6,0.6,0.2")), 1, coherence=0.0)[0]
    assert np.linalg.det(narrow.proposal.covariance) < np.linalg.det(wide.proposal.covariance)


def test_seven_values_tell_fear_from_anger(asset, proposer):
    parts = asset.model.parts
    for name in ("fear", "anger", "disgust"):
        values = emotion_vector({name: 1.0})
        v, a = values @ parts.places
        found = proposer.find(Wanted((float(v), float(a)), emotion=values), 3)
        for f in found:
            worn = [r.affinity[r.index(p)] for r, p in zip(parts.regions, f.face.parts, strict=True)]
            assert int(np.sum(worn, axis=0).argmax()) == EMOTION_INDEX[name]


def test_a_query_is_fast_enough_to_drag_with(proposer):
    proposer.find(Wanted((0.1, 0.1)), 12)
    times = []
    for i in range(15):
        start = time.process_time()
        proposer.find(Wanted((0.5, i / 20)), 12)
        times.append(time.process_time() - start)
    assert min(times) < 0.01


@pytest.mark.parametrize("text", ["", "x", "0", "0.2,0.2,1", "1,2,3,4", "-0.1", "nan"])
def test_bad_spreads(text):
    with pytest.raises(BadInput, match="spread"):
        parse_spread(text)


# -- the author's steps ----------------------------------------------------------------------------------------------


def test_a_drag_is_one_step(author):
    for i in range(20):
        author.drag(i / 20, -i / 40)
    author.drop()
    assert author.draft.point == (0.95, -0.475)
    author.undo()
    assert author.draft.point == (0.0, 0.0)
    assert not author.can_undo
    author.redo()
    assert author.draft.point == (0.95, -0.475)
    author.drag(4.0, -4.0)
    assert author.draft.point == (1.0, -1.0)
    author.undo()
    assert author.draft.point == (0.95, -0.475), "undo in the middle of a drag takes the drag back"


def test_locked_regions_stay(author):
    author.drag(-0.6, 0.6)
    author.drop()
    author.put("mouth", "cat")
    author.lock("mouth")
    author.lock("skin")
    assert {f.face.mouth for f in author.found} == {"cat"}
    assert {f.face.skin for f in author.found} == {"standard"}
    assert len({f.face.eyes for f in author.found}) > 1
    before = [f.face for f in author.found]
    author.choose(3)
    assert author.draft.face == before[3]
    assert [f.face for f in author.found] == before, "choosing does not shuffle what one chooses from"
    author.lock("eyes")
    author.lock("eyebrows")
    assert author.failed
    assert "eyebrows" not in author.draft.locked


def test_a_name_tells_what_the_point_cannot(author):
    author.go_to(EMOTION_INDEX["fear"])
    fear = [f.face for f in author.found]
    author.nudge(0, 0)
    assert author.draft.emotion is None
    author.go_to(EMOTION_INDEX["anger"])
    angry = [f.face for f in author.found]
    assert not set(fear) & set(angry)
    regions = author.parts.regions
    for name, faces in (("fear", fear), ("anger", angry)):
        worn = [r.affinity[r.index(p)] for r, p in zip(regions, faces[0].parts, strict=True)]
        assert int(np.sum(worn, axis=0).argmax()) == EMOTION_INDEX[name]


def test_compare_keep_and_recall(author):
    author.choose(0)
    first = author.draft.face
    author.keep(0)
    author.put("skin", "vein")
    author.keep(1)
    author.recall(0)
    assert author.draft.face == first
    author.recall(1)
    assert author.draft.face.skin == "vein"
    assert author.density(first) == pytest.approx(author.asset.model.log_density((0.0, 0.0), first))


def test_every_step_can_be_taken_back_and_forth(author):
    rng = np.random.default_rng(4)
    steps = [
        lambda: author.nudge(*rng.integers(-1, 2, 2)),
        lambda: author.choose(int(rng.integers(12))),
        lambda: author.lock("mouth"),
        lambda: author.keep(int(rng.integers(2))),
        lambda: author.recall(int(rng.integers(2))),
        lambda: author.vary(bool(rng.integers(2))),
        lambda: (author.slide(float(rng.random())), author.slide(float(rng.random())), author.drop()),
        lambda: author.go_to(int(rng.integers(7))),
        lambda: author.put("skin", "vein"),
    ]
    for _ in range(40):
        steps[rng.integers(len(steps))]()
    end, count = author.draft, 0
    while author.can_undo:
        author.undo()
        count += 1
    assert author.draft.face == Face()
    assert author.draft.point == (0.0, 0.0)
    for _ in range(count):
        author.redo()
    assert author.draft == end
    assert not author.can_redo


def test_saving_a_face_and_saying_why_not(author, asset, tmp_path):
    dialogue = tmp_path / "faces.yaml"
    dialogue.write_text("faces:\n  plain: {}\n")
    author.dialogue_faces = dialogue
    author.take(Face("gentle", "raised", "smirk", "blush"))
    assert author.save("sly_one", "Sly, isn't she")
    assert load_expressions(author.save_to, asset.model.parts)["sly_one"].face == author.draft.face
    assert "  sly_one: {}" in dialogue.read_text()
    assert "face: sly_one" in author.message
    for name in ("sly_one", "Sly", "1st", ""):
        assert not author.save(name)
        assert author.failed
    assert list(author.faces_named()) == ["sly_one"]
    author.undo()
    assert "sly_one" in load_expressions(author.save_to, asset.model.parts)


def test_the_shipped_expressions_can_all_be_spoken():
    from game.story.surroundings import load_faces

    spoken = load_faces(ROOT / "dialogue" / "faces.yaml")
    assert set(load_face().expressions) <= set(spoken)


def test_pad_and_ellipse():
    pad = Pad(100, 50, 200)
    assert pad.to_screen(-1, 1) == (100, 50)
    assert pad.to_point(pad.to_screen(0.3, -0.7)) == pytest.approx((0.3, -0.7))
    assert pad.to_point((-900, 9000)) == (-1, -1)
    covariance = np.array([[0.04, 0.01], [0.01, 0.09]])
    offset = ellipse(np.array([0.2, 0.1]), covariance) - [0.2, 0.1]
    assert np.einsum("ni,ij,nj->n", offset, np.linalg.inv(covariance), offset) == pytest.approx(np.ones(41))


# -- the commands ----------------------------------------------------------------------------------------------------


def test_suggest_as_json(capsys):
    assert main(["face", "suggest", "--emotion", "joy=0.8,fear=0.2", "--top", "5", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["ratings"] == load_face().model.parts.ratings
    faces = told["proposals"][0]["faces"]
    assert len(faces) == 5
    assert faces[0]["score"] >= faces[1]["score"]
    assert np.linalg.det(faces[0]["covariance"]) > 0


@pytest.mark.parametrize(
    "words",
    [
        "--valence 0.5",
        "--valence 2 --arousal 0",
        "--valence 0 --arousal 0 --emotion joy",
        "",
        "--valence 0 --arousal 0 --top 0",
        "--valence 0 --arousal 0 --spread wide",
        "--emotion joyy=1",
        "--around 0",
        "--emotion joy=1 --spread 0.2",
        "--valence 0 --arousal 0 --coherence -1",
    ],
)
def test_suggest_refuses_in_one_line(words, capsys):
    assert main(["face", "suggest", *words.split()]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert error.count("\n") == 1


def test_without_imgui_the_window_says_what_to_install(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    parser = argparse.ArgumentParser()
    face_command.add_arguments(parser)
    with pytest.raises(MissingPart, match="tools"):
        face_command.run(parser.parse_args([]))


@pytest.mark.gl
def test_a_sheet_is_drawn_on_the_real_head(tmp_path):
    import pygame

    out = tmp_path / "sheet.png"
    assert main(["face", "suggest", "--valence", "0.6", "--arousal", "0.5", "--top", "4", "--sheet", str(out)]) == 0
    picture = pygame.surfarray.array3d(pygame.image.load(out)).transpose(1, 0, 2)
    assert picture.shape[1] > picture.shape[0] > 400
    head = picture[56:288, 448:680].reshape(-1, 3).astype(int)
    brown = (abs(head - (140, 64, 38)) < 30).all(axis=1).mean()
    assert brown > 0.15, "her hair is in the first cell"
    cells = [picture[70:280, 460 + i * 246 : 660 + i * 246] for i in range(4)]
    assert all(abs(cells[0].astype(int) - other).mean() > 0.5 for other in cells[1:])


@pytest.mark.gl
def test_the_seven_are_drawn_at_two_strengths(tmp_path):
    import pygame

    out = tmp_path / "seven.png"
    assert main(["face", "sheet", "seven", "--out", str(out)]) == 0
    picture = pygame.surfarray.array3d(pygame.image.load(out)).transpose(1, 0, 2).astype(int)
    assert picture.shape[1] == 1280
    assert picture.shape[0] <= 720
    weak = [picture[110:210, 30 + i * 180 : 160 + i * 180] for i in range(7)]
    strong = [picture[334:434, 30 + i * 180 : 160 + i * 180] for i in range(7)]
    neutral = weak[6]
    assert abs(neutral - strong[6]).mean() < 0.5
    for faint, full in zip(weak[:6], strong[:6], strict=True):
        assert abs(full - neutral).mean() > 2.0
        assert abs(full - neutral).mean() >= abs(faint - neutral).mean()


@pytest.mark.gl
def test_one_head_after_the_other_leaks_no_face(asset):
    from game.tools.face.heads import HeadStudio

    parts = asset.model.parts
    studio = HeadStudio(96)
    try:
        calm = studio.draw(parts.params((0, 0, 0, 0)))
        angry = studio.draw(parts.params(parts.numbers(Face("fierce", "slanted_angry", "grit", "anger_red"))))
        again = studio.draw(parts.params((0, 0, 0, 0)))
    finally:
        studio.close()
    assert abs(calm.astype(int) - angry).mean() > 1.0
    assert (calm == again).all()


def test_the_assets_were_left_alone():
    assert (ASSETS / "face" / "parts.yaml").read_text().count("# rated by") == 0


def test_a_named_expression_opens_with_everything_it_holds(author, tmp_path):
    """smirk looks aside and lifts one corner: numbers that no part has. They survive opening, keeping and saving."""
    from game.core import ASSETS
    from game.face import load_expressions
    from game.tools.face.author import Author

    path = tmp_path / "expressions.yaml"
    path.write_text((ASSETS / "face" / "expressions.yaml").read_text(encoding="utf-8"), encoding="utf-8")
    mine = Author(author.asset, path)
    mine.open("smirk")
    held = dict(mine.draft.change)
    assert held["mouth_asym"] == 15.0
    assert held["look_x"] == -0.35
    mine.keep(0)
    assert mine.save("smirk_again")
    read = load_expressions(path, mine.parts)
    np.testing.assert_allclose(read["smirk_again"].params, read["smirk"].params, atol=1e-9)
    # Another mouth brings its own numbers; those of the eyes stay.
    mine.put("mouth", "pout")
    assert "mouth_asym" not in dict(mine.draft.change)
    assert dict(mine.draft.change)["look_x"] == -0.35
    mine.recall(0)
    assert dict(mine.draft.change) == held
    mine.undo()
    mine.undo()
    assert dict(mine.draft.change) == held
