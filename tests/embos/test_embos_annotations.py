"""From a folder of takes to units: everything wrong is found at once, and nothing is written then."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from game.app import analyse
from game.core import ASSETS, EMOTIONS, Clip, Skeleton
from game.core.errors import Where
from game.core.humanoid import REFERENCE
from game.embos import LAYERS, UnitLibrary, load_clips
from game.embos.analysis import clean_part
from game.embos.annotations import Span
from game.embos.clips import same_clips
from game.formats import write_bvh

BEHAVIOURS = """\
behaviours:
  upright: {layer: posture, label: {en: upright, ja: 直立}, uses: [legs], locks: [], contacts: {}}
  arms_crossed: {layer: posture, label: {en: arms crossed}, uses: [left_arm, right_arm], contacts: {left_hand: chest}}
  touch_nose: {layer: mannerism, uses: [right_arm, head], contacts: {right_hand: head}}
  point_at: {layer: gesture, kind: deictic, words: {en: [this], ja: [これ]}, uses: [right_arm]}
"""
SPANS = """\
  - {layer: posture, behaviour: upright, start_s: 0.0, end_s: 2.0}
  - {layer: posture, behaviour: arms_crossed, start_s: 2.0, end_s: 3.5}
  - {layer: mannerism, behaviour: touch_nose, start_s: 0.5, end_s: 1.0}
  - {layer: gesture, behaviour: point_at, start_s: 1.2, end_s: 1.8, stroke_s: 1.4, words: 'this'}
"""


def annotation(emotion: str, spans: str = SPANS) -> str:
    return f"take: {emotion}\nemotion: {emotion}\nbvh: {emotion}.bvh\nversion: 1\nfps: 30\nspans:\n{spans}"


def clip(seconds: float = 4.0, skeleton: Skeleton = REFERENCE) -> Clip:
    frames = round(seconds * 30)
    rotation = np.tile([0.0, 0.0, 0.0, 1.0], (frames, len(skeleton), 1))
    return Clip(skeleton, 1 / 30, rotation, np.tile(skeleton.rest_translation, (frames, 1, 1)))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    takes = tmp_path / "takes"
    takes.mkdir()
    (tmp_path / "behaviours.yaml").write_text(BEHAVIOURS, "utf-8")
    write_bvh(clip(), takes / "anger.bvh")
    for emotion in EMOTIONS:
        (takes / f"{emotion}.yaml").write_text(annotation(emotion), "utf-8")
        (takes / f"{emotion}.bvh").write_bytes((takes / "anger.bvh").read_bytes())
    return takes


def run(takes: Path, *more: str) -> int:
    import argparse

    parser = argparse.ArgumentParser()
    analyse.add_arguments(parser)
    return analyse.run(parser.parse_args([str(takes), *more]))


def test_takes_become_units_that_load(folder: Path) -> None:
    assert run(folder, "--check") == 1
    assert not (folder.parent / "units.yaml").exists()
    assert run(folder) == 0
    assert run(folder, "--check") == 0
    library = UnitLibrary.load(folder.parent / "units.yaml")
    upright = library.units[library.index["upright"]]
    # Each emotion: 2.0 s of 3.5 s annotated -> L_d 2, L_w (3.5 - 2)/2 * 2.
    np.testing.assert_allclose(upright.duration_s, 2.0)
    np.testing.assert_allclose(upright.waiting_s, 1.5)
    np.testing.assert_allclose(upright.intensity, 1.0)
    crossed = library.units[library.index["arms_crossed"]]
    np.testing.assert_allclose(crossed.intensity, 0.3 * 0.5 + 0.7)
    assert (upright.variants[0].clean_start_s, upright.variants[0].clean_end_s) == (0.0, 0.5)
    point = library.units[library.index["point_at"]]
    assert (point.kind, point.words["ja"], point.variants[0].stroke_s) == ("deictic", ("これ",), 1.4)
    assert library.transition_counts("posture")[0, 1] == 7.0
    assert library.clips["joy"].rotation.shape == (120, 41, 4)


def test_everything_wrong_is_found_at_once_and_nothing_is_written(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "joy.yaml").unlink()
    wrong = {
        "anger": "  - {layer: posture, behaviour: arms_crossed, start_s: 1.5, end_s: 3.5}\n",
        "fear": "  - {layer: poster, behaviour: upright, start_s: 2.0, end_s: 3.5}\n"
        "  - {layer: posture, behaviour: up_right, start_s: 2.0, end_s: 3.5}\n"
        "  - {layer: gesture, behaviour: touch_nose, start_s: 2.0, end_s: 3.5}\n",
        "sadness": "  - {layer: posture, behaviour: arms_crossed, start_s: 2.0, end_s: 9.0}\n"
        "  - {layer: posture, behaviour: upright, start_s: 2.5, end_s: 2.2}\n"
        "  - {layer: posture, behaviour: upright, start_s: 3.5, end_s: 3.9}\n",
    }
    first = "".join(SPANS.splitlines(keepends=True)[:1])
    for emotion, spans in wrong.items():
        (folder / f"{emotion}.yaml").write_text(annotation(emotion, first + spans), "utf-8")
    (folder / "disgust.yaml").write_text(annotation("disgust", "").replace("spans:\n", "spans: []\n"), "utf-8")
    (folder / "surprise.yaml").write_text(annotation("surprise").replace("take: surprise", "take: glad"), "utf-8")
    text = (folder / "neutral.bvh").read_text().splitlines()
    text[-1] = text[-1].replace(text[-1].split()[0], "nan", 1)
    (folder / "neutral.bvh").write_text("\n".join(text))
    assert run(folder) == 2, "a take that cannot be read"
    assert sorted(p.name for p in folder.parent.iterdir()) == ["behaviours.yaml", "takes"]
    said = capsys.readouterr().err
    for wanted in (
        "anger.yaml:8:5: overlapping posture spans: expected a start at or after 2 s",
        "fear.yaml:8:13: expected posture | gesture | mannerism but saw 'poster'",
        "fear.yaml:9:33: unknown behaviour",
        "did you mean 'upright'",
        "fear.yaml:10:13: behaviour touch_nose: expected layer mannerism",
        "sadness.yaml:8:68: span outside the clip: expected at most 4.000 s",
        "sadness.yaml:9:63: span: expected an end after its start",
        "sadness.yaml:10:63: posture: expected at least 1 s",
        "disgust.yaml:1:1: take: expected annotated spans",
        "surprise.yaml:1:7: take: expected the file's name",
        "neutral.bvh:",
        "takes: expected a take of joy but saw 'none'",
        "findings; nothing was written",
    ):
        assert wanted in said, wanted


def test_findings_alone_are_no_broken_input(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "joy.yaml").unlink()
    assert run(folder, "--json") == 1
    assert json.loads(capsys.readouterr().out)["findings"] == [
        f"{folder}: takes: expected a take of joy but saw 'none'"
    ]


def test_another_skeleton_and_a_file_elsewhere_are_refused(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    names = tuple("pelvis" if n == "hips" else n for n in REFERENCE.names)
    other = Skeleton(names, REFERENCE.parents, REFERENCE.rest_translation, REFERENCE.rest_rotation)
    write_bvh(clip(skeleton=other), folder / "joy.bvh")
    tall = Skeleton(REFERENCE.names, REFERENCE.parents, REFERENCE.rest_translation * 1.3, REFERENCE.rest_rotation)
    write_bvh(clip(skeleton=tall), folder / "fear.bvh")
    text = (folder / "anger.yaml").read_text("utf-8")
    (folder / "anger.yaml").write_text(text.replace("bvh: anger.bvh", "bvh: ../anger.bvh"), "utf-8")
    (folder / "neutral.yaml").write_text(annotation("neutral").replace("fps: 30", "fps: 60"), "utf-8")
    assert run(folder) == 2
    said = capsys.readouterr().err
    assert "joy.bvh:2: skeleton: expected the 41 joints of the reference humanoid" in said
    assert "missing hips; foreign pelvis" in said
    assert re.search(
        r"fear\.bvh:\d+: joint \w+ \(and \d\d more joints\): expected the reference humanoid's offset", said
    )
    assert "anger.yaml:3:6: bvh: expected a file name in this folder" in said
    assert "neutral.yaml:5:6: fps: expected 30.000" in said


def test_empty_takes_and_nonsense_values_are_named_with_their_lines(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "joy.yaml").write_text("", "utf-8")
    (folder / "fear.bvh").write_text("", "utf-8")
    (folder / "disgust.bvh").unlink()
    text = (folder / "neutral.bvh").read_text()
    motion = text[: text.index("Frames:")] + "Frames: 0\nFrame Time: 0.0333333\n"
    (folder / "neutral.bvh").write_text(motion)
    for emotion in ("anger", "sadness"):  # two files with broken numbers: both are found
        lines = (folder / f"{emotion}.bvh").read_text().splitlines()
        lines[-2] = lines[-2].replace(lines[-2].split()[0], "inf", 1)
        (folder / f"{emotion}.bvh").write_text("\n".join(lines))
    (folder / "surprise.yaml").write_text(annotation("surprise").replace("emotion: surprise\n", ""), "utf-8")
    assert run(folder) == 2
    assert sorted(p.name for p in folder.parent.iterdir()) == ["behaviours.yaml", "takes"]
    said = capsys.readouterr().err
    last = len((folder / "anger.bvh").read_text().splitlines()) - 1
    for wanted in (
        "joy.yaml:1:1: expected a mapping",
        "fear.bvh:1:1: expected",
        "disgust.bvh: cannot read this BVH file",
        "neutral.bvh:",
        f"anger.bvh:{last}:1: expected a finite number",
        f"sadness.bvh:{last}:1: expected a finite number",
        "surprise.yaml:1:1: expected the key 'emotion'",
        "takes: expected a take of joy",
        "takes: expected a take of surprise",
        "findings; nothing was written",
    ):
        assert wanted in said, wanted
    assert said.count("\n") >= 9


def test_broken_spans_are_all_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spans = (
        "  - {layer: posture, behaviour: upright, start_s: .nan, end_s: 2.0}\n"
        "  - {layer: gesture, behaviour: point_at, start_s: 1.0, end_s: 2.0, stroke_s: 3.0}\n"
        "  - {layer: posture, start_s: 1.0, end_s: 2.0}\n"
        "  - nonsense\n"
        "  - {layer: mannerism, behaviour: touch_nose, start_s: 2.0, end_s: 3.0}\n"
        "  - {layer: mannerism, behaviour: touch_nose, start_s: 2.5, end_s: 3.5}\n"
    )
    (folder / "surprise.yaml").write_text(annotation("surprise", spans), "utf-8")
    assert run(folder) == 1
    said = capsys.readouterr().err
    for wanted in (
        "surprise.yaml:7:51: expected a finite number",
        "surprise.yaml:8:79: stroke: expected a moment from 1 to 2 s",
        "surprise.yaml:9:5: expected the key 'behaviour'",
        "surprise.yaml:10:5: expected a mapping",
        "surprise.yaml:12:5: overlapping mannerism spans: expected a start at or after 3 s",
        "surprise.yaml:7:3: take: expected at least one posture span",
        "6 findings; nothing was written",
    ):
        assert wanted in said, wanted


def test_an_empty_folder_says_what_belongs_there(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "behaviours.yaml").write_text(BEHAVIOURS, "utf-8")
    assert run(tmp_path / "nothing") == 1
    assert "one NAME.yaml and NAME.bvh per take" in capsys.readouterr().err


def test_the_clean_part_is_the_longest_left_over() -> None:
    def span(start_s: float, end_s: float) -> Span:
        return Span("mannerism", "m", start_s, end_s, None, Where("x"))

    assert clean_part(span(0, 10), []) == (0, 10)
    assert clean_part(span(0, 10), [span(6, 7), span(1, 2)]) == (2, 6)
    assert clean_part(span(0, 10), [span(-1, 3), span(2, 5), span(9, 12)]) == (5, 9)
    assert clean_part(span(0, 10), [span(-1, 12)]) == (0, 10)


def test_the_shipped_units_are_what_the_shipped_takes_give(tmp_path: Path) -> None:
    motion = ASSETS / "motion"
    assert run(motion / "takes", "--out", str(tmp_path / "units.yaml")) == 0
    assert (tmp_path / "units.yaml").read_bytes() == (motion / "units.yaml").read_bytes()
    assert same_clips(motion / "clips.npz", load_clips(tmp_path / "clips.npz"))
    library = UnitLibrary.load(motion / "units.yaml")
    least = {"posture": 7, "mannerism": 10, "gesture": 10}
    for layer in LAYERS:
        assert len(library.of_layer(layer)) >= least[layer]
    for unit in library.units:
        if unit.layer == "gesture" and not unit.is_rest:
            assert unit.words.get("en"), unit.name
            assert unit.words.get("ja"), unit.name
