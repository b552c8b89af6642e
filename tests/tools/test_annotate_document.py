"""The annotation desk's documents: edits, undo, files there and back, what is left after a crash."""

from __future__ import annotations

import dataclasses
import itertools
import string
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from game.app.cli import main
from game.core.emotion_space import EMOTIONS
from game.core.errors import BadInput
from game.core.paths import ASSETS
from game.embos.units import LAYERS
from game.tools.annotate import edits, elan, files, table
from game.tools.annotate.document import Document, Mark, Word, on_grid

TAKES = ASSETS / "motion" / "takes"
EMPTY = Document(take="t", bvh="t.bvh", fps=30.0, frames=900)


def _document() -> Document:
    document, _ = edits.created(EMPTY, "posture", "upright", 0.0, 10.0)
    document, _ = edits.created(document, "posture", "lean_forward", 12.0, 20.0)
    return edits.created(document, "gesture", "point_at", 3.0, 5.0, stroke_s=3.8, words="this one", note="at the pot")[
        0
    ]


def test_marks_of_a_layer_never_overlap_whatever_is_done() -> None:
    document = _document()
    first, second = document.of_layer("posture")
    with pytest.raises(BadInput, match="expected a place that is free but saw 'upright'"):
        edits.created(document, "posture", "arms_crossed", 5.0, 8.0)
    document, new = edits.created(document, "posture", "arms_crossed", 10.5, 15.0)
    assert (new.start_s, new.end_s) == (10.5, 12.0), "a new span ends where the next begins"
    document, moved = edits.moved(document, new, 11.9)
    assert (moved.start_s, moved.end_s) == (10.5, 12.0), "a span stops at its neighbour"
    document, longer = edits.trimmed(document, first, end_s=40.0)
    assert longer.end_s == 10.5
    document, shorter = edits.trimmed(document, second, end_s=2.0)
    assert shorter.length_s == edits.LEAST_POSTURE_S, "no posture is shorter than a second"
    postures = document.of_layer("posture")
    assert all(a.end_s <= b.start_s for a, b in itertools.pairwise(postures))


def test_splitting_and_merging_give_back_what_was_there() -> None:
    document = _document()
    gesture = document.of_layer("gesture")[0]
    halved, (left, right) = edits.split(document, gesture, 4.2)
    assert (left.stroke_s, left.words, right.stroke_s, right.words) == (3.8, "this one", None, "")
    whole, mark = edits.merged(halved, [left, right])
    assert mark == gesture
    assert whole == document
    with pytest.raises(BadInput, match="one behaviour"):
        edits.merged(document, document.of_layer("posture"))
    with pytest.raises(BadInput, match=r"at least 1 s from both ends"):
        edits.split(document, document.of_layer("posture")[0], 0.4)


def test_a_copy_carries_words_and_stroke_along() -> None:
    document, mark = edits.copied(_document(), _document().of_layer("gesture")[0], 7.0)
    assert (mark.start_s, mark.end_s, mark.stroke_s, mark.words) == (7.0, 9.0, 7.8, "this one")
    assert len(document.of_layer("gesture")) == 2


def test_snapping_prefers_an_edge_nearby_and_falls_on_a_frame_otherwise() -> None:
    document = _document()
    assert edits.snapped(document, 9.96, 0.1) == 10.0
    assert edits.snapped(document, 6.51, 0.1) == on_grid(round(6.51 * 30) / 30)


def test_undo_goes_all_the_way_back_and_a_drag_is_one_step() -> None:
    history = edits.History(EMPTY, saved=EMPTY)
    for step in range(200):
        history.do(f"new {step}", edits.created(history.now, "mannerism", "sigh", 0.1 * step, 0.1 * step + 0.08)[0])
    mark = history.now.marks[-1]
    for offset in (0.02, 0.04, 0.06):
        document, mark = edits.moved(history.now, mark, 25.0 + offset)
        history.do("move", document, join=True)
    assert history.dirty
    assert history.undo() == "move"
    assert history.now.marks[-1].start_s == pytest.approx(19.9)
    while history.undo():
        pass
    assert history.now == EMPTY
    while history.redo():
        pass
    assert len(history.now.marks) == 200


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_every_shipped_annotation_survives_yaml_elan_and_csv(emotion: str, tmp_path: Path) -> None:
    document = files.read_document(TAKES / f"{emotion}.yaml")
    assert len(document.marks) > 60
    assert files.document_text(document) == (TAKES / f"{emotion}.yaml").read_text(encoding="utf-8")
    elan.write_eaf(document, tmp_path / "a.eaf")
    assert elan.read_eaf(tmp_path / "a.eaf") == document
    table.write_csv(document, tmp_path / "a.csv")
    assert table.read_csv(tmp_path / "a.csv") == document


_TEXT = st.text(string.ascii_letters + "これ'\"&<>,:#{}- é", max_size=12).map(str.strip)
_NAME = st.sampled_from(["sigh", "nod_2", "on", "x-y"])
_MS = st.integers(0, 29_000)


@st.composite
def documents(draw: st.DrawFn) -> Document:
    """Any valid document of 30 s."""
    marks: list[Mark] = []
    for layer in LAYERS:
        edges = sorted(draw(st.lists(_MS, max_size=8, unique=True)))
        for start, end in zip(edges[::2], edges[1::2], strict=False):
            stroke = draw(st.none() | st.integers(start, end))
            marks.append(
                Mark(
                    on_grid(start / 1000), on_grid(end / 1000), layer, draw(_NAME),
                    None if stroke is None else on_grid(stroke / 1000), draw(_TEXT), draw(_TEXT),
                    draw(st.none() | st.floats(0.0, 1.0)),
                )
            )  # fmt: skip
    words = [
        Word(on_grid(a / 1000), on_grid((a + 300) / 1000), draw(_TEXT) or "w") for a in draw(st.lists(_MS, max_size=3))
    ]
    head = Document(
        take=draw(_TEXT) or "t", bvh="t.bvh", fps=draw(st.sampled_from([24.0, 30.0, 59.94, 120.0])), frames=3600,
        emotion=draw(st.sampled_from(["", *EMOTIONS])), author=draw(_TEXT), version=draw(st.integers(1, 99)),
        note=draw(_TEXT), licence=draw(_TEXT), spoken=tuple(sorted(words)),
    )  # fmt: skip
    return head.with_marks(marks)


@settings(max_examples=60, deadline=None)
@given(documents())
def test_no_file_format_loses_anything(tmp_path_factory: pytest.TempPathFactory, document: Document) -> None:
    folder = tmp_path_factory.mktemp("annotation")
    files.save(document, folder / "t.yaml")
    assert files.read_document(folder / "t.yaml") == document
    elan.write_eaf(document, folder / "t.eaf")
    assert elan.read_eaf(folder / "t.eaf") == document
    table.write_csv(document, folder / "t.csv")
    assert table.read_csv(folder / "t.csv") == document


def test_an_autosave_is_recovered_whole_and_refused_when_cut(tmp_path: Path) -> None:
    notes = tmp_path / "t.yaml"
    assert files.recover(notes) == (None, "")
    files.write_autosave(_document(), notes)
    assert files.recover(notes) == (_document(), "")
    path = files.autosave_path(notes)
    whole = path.read_bytes()
    for length in range(0, len(whole) - 1, 37):
        path.write_bytes(whole[:length])
        document, reason = files.recover(notes)
        assert document is None
        assert "expected a whole file but saw 'one that was cut off'; kept as" in reason
    assert not path.exists(), "what could not be read stands aside"
    assert (tmp_path / ".t.autosave.unreadable.yaml").exists()


def test_a_foreign_elan_file_is_read_as_far_as_its_tiers_are_ours(tmp_path: Path) -> None:
    text = elan.eaf_text(_document()).replace('TIER_ID="posture"', 'TIER_ID="gaze"')
    path = tmp_path / "foreign.eaf"
    path.write_text(text, encoding="utf-8")
    assert [m.layer for m in elan.read_eaf(path).marks] == ["gesture"]


@pytest.mark.parametrize(
    ("name", "change", "message"),
    [
        (
            "bomb.eaf",
            ("<ANNOTATION_DOCUMENT", '<!DOCTYPE a [<!ENTITY b "c">]><ANNOTATION_DOCUMENT'),
            "no document type",
        ),
        ("cut.eaf", ("</ANNOTATION_DOCUMENT>", ""), r"cut\.eaf:\d+:\d+: ELAN file: no element found"),
        ("time.eaf", ('TIME_VALUE="3000"', 'TIME_VALUE="-3"'), "whole milliseconds but saw '-3'"),
        ("slot.eaf", ('TIME_SLOT_REF2="ts3"', 'TIME_SLOT_REF2="ts99"'), "TIME_SLOT_REF2 with a time but saw 'ts99'"),
        ("root.eaf", ("ANNOTATION_DOCUMENT", "HTML"), "<ANNOTATION_DOCUMENT> but saw '<HTML>'"),
    ],
)
def test_broken_elan_files_are_refused_in_one_line(
    tmp_path: Path, name: str, change: tuple[str, str], message: str
) -> None:
    path = tmp_path / name
    text = elan.eaf_text(_document())
    assert change[0] in text
    path.write_text(text.replace(*change), encoding="utf-8")
    with pytest.raises(BadInput, match=message) as error:
        elan.read_eaf(path)
    assert "\n" not in str(error.value)


def test_frames_that_contradict_the_seconds_are_found(tmp_path: Path) -> None:
    path = tmp_path / "t.yaml"
    path.write_text(files.document_text(_document()).replace("frames: [0, 300]", "frames: [0, 299]"), encoding="utf-8")
    assert files.read_document(path) == _document(), "one frame is rounding"
    path.write_text(files.document_text(_document()).replace("frames: [0, 300]", "frames: [0, 250]"), encoding="utf-8")
    with pytest.raises(BadInput, match=r"t\.yaml:\d+:\d+: frames: expected \[0, 300\], as the seconds say"):
        files.read_document(path)


def test_every_fault_of_a_file_is_counted(tmp_path: Path) -> None:
    path = tmp_path / "t.yaml"
    broken = dataclasses.replace(_document(), note="x")
    text = files.document_text(broken).replace("end_s: 10.000", "end_s: -1").replace("layer: gesture", "layer: gestur")
    path.write_text(text, encoding="utf-8")
    with pytest.raises(BadInput, match=r"\(and 1 more\)"):
        files.read_document(path)


def test_all_that_is_wrong_is_told_at_once_with_its_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    clean = _document().with_marks(
        [Mark(0.0, 2.0, "posture", "upright"), Mark(2.0, 4.0, "posture", "lean_back"), Mark(1.0, 2.0, "gesture", "nod")]
    )
    path, rows, tiers = tmp_path / "t.yaml", tmp_path / "t.csv", tmp_path / "t.eaf"
    files.save(clean, path)
    text = path.read_text().replace("start_s: 2.000", "start_s: 1.500").replace("frames: [60,", "frames: [45,")
    path.write_text(text.replace("layer: gesture", "layer: gestur"))
    lines = path.read_text().splitlines()
    late, odd = (next(i for i, line in enumerate(lines, 1) if word in line) for word in ("lean_back", "gestur"))
    with pytest.raises(BadInput) as caught:
        files.read_document(path)
    assert [f"{path}:{odd}:" in str(e) or f"{path}:{late}:" in str(e) for e in caught.value.findings] == [True, True]

    table.write_csv(clean, rows)
    rows.write_text(
        rows.read_text().replace("lean_back,2.000", "lean_back,1.500").replace("gesture,nod,1", "gesture,,1")
    )
    with pytest.raises(BadInput) as caught:
        table.read_csv(rows)
    assert [str(e).split(": ")[0] for e in caught.value.findings] == [f"{rows}:3", f"{rows}:4"]

    elan.write_eaf(clean, tiers)
    found = tiers.read_text().replace("nod", "").replace('TIME_VALUE="4000"', 'TIME_VALUE="1000"')
    tiers.write_text(found)
    with pytest.raises(BadInput) as caught:
        elan.read_eaf(tiers)
    assert len(caught.value.findings) == 2

    (tmp_path / "t.bvh").write_text("")
    before = rows.read_bytes()
    arguments = ["annotate", str(path), "--compare", str(path)]
    assert main(arguments) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 3
    assert said[-1] == "2 findings; nothing was changed"
    assert rows.read_bytes() == before
