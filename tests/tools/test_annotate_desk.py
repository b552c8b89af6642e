"""The annotation desk without its window: what hands do at it, what is kept, what is told."""

from __future__ import annotations

import itertools
import shutil
from pathlib import Path

import numpy as np
import pytest

from game.core.errors import BadInput
from game.core.humanoid import REFERENCE
from game.core.paths import ASSETS
from game.embos.annotations import read_takes
from game.embos.clip_shelf import ClipShelf
from game.embos.clips import TakeClip
from game.embos.findings import Findings
from game.embos.repertoire import Behaviour, read_repertoire
from game.formats.yaml_source import parse_yaml
from game.tools.annotate import edits
from game.tools.annotate.desk_jobs import learnable
from game.tools.annotate.desk_repertoire import (
    add_behaviour,
    behaviours_of,
    next_state,
    project_behaviours,
    put_parts,
)
from game.tools.annotate.desk_sheet import AUTOSAVE_S, Sheet
from game.tools.annotate.desk_state import Desk
from game.tools.annotate.desk_view import Clock, TimeView
from game.tools.annotate.document import Document, Mark, Word
from game.tools.annotate.edits import History
from game.tools.annotate.files import autosave_path, read_document

MOTION = ASSETS / "motion"


@pytest.fixture(scope="module")
def repertoire() -> dict[str, Behaviour]:
    return read_repertoire(MOTION / "behaviours.yaml", Findings())


def _clip(frames: int = 900) -> TakeClip:
    rotation = np.zeros((frames, len(REFERENCE), 4), dtype=np.float32)
    rotation[..., 3] = 1.0
    return TakeClip(rotation, np.zeros((frames, 3), dtype=np.float32), 1.0 / 30.0)


def _desk(folder: Path, repertoire: dict[str, Behaviour], takes: int = 1) -> Desk:
    sheets = []
    for number in range(takes):
        document = Document(take=f"t{number}", bvh=f"t{number}.bvh", fps=30.0, frames=900)
        sheets.append(Sheet(folder / f"t{number}.bvh", _clip(), History(document, saved=document)))
    desk = Desk(sheets, dict(repertoire))
    desk.view.resize(900.0)
    return desk


def test_a_span_made_with_the_keyboard_alone_holds_the_frame_under_the_play_head(tmp_path, repertoire) -> None:
    desk = _desk(tmp_path, repertoire)
    desk.set_behaviour("arms_crossed")
    desk.clock.go_to(2.0)
    desk.begin_or_end()
    desk.clock.step(59)
    desk.begin_or_end()
    assert desk.document.marks == (Mark(2.0, 4.0, "posture", "arms_crossed"),)
    assert desk.one == desk.document.marks[0], "what was made is in hand"
    desk.change_layer(2)
    desk.clock.go_to(5.0)
    desk.begin_or_end()
    desk.clock.step(-30)
    desk.begin_or_end()
    assert [(m.layer, m.start_s, round(m.end_s, 3)) for m in desk.document.of_layer("gesture")] == [
        ("gesture", 4.0, 5.033)
    ]


def test_a_whole_drag_is_one_step_of_undo_and_does_not_stick_to_what_it_passed(tmp_path, repertoire) -> None:
    desk = _desk(tmp_path, repertoire)
    desk.snap = False
    desk.create("gesture", 1.0, 2.0)
    first = desk.one
    desk.create("gesture", 4.0, 5.0)
    assert first is not None
    desk.select(first)
    drag = desk.begin_drag("move", first, 1.5)
    for time_s in (2.0, 3.0, 9.0, 8.0):
        desk.drag(drag, time_s)
    assert desk.one is not None
    assert desk.one.start_s == 7.5, "past the other span, half a second before the mouse"
    desk.undo()
    assert [m.start_s for m in desk.document.marks] == [1.0, 4.0]
    desk.redo()
    assert [m.start_s for m in desk.document.marks] == [4.0, 7.5]
    again = desk.begin_drag("end", desk.document.marks[1], 8.5)
    desk.drag(again, 9.5)
    desk.undo()
    assert desk.document.marks[1].end_s == 8.5, "a second drag is a step of its own"


def test_several_spans_move_as_one_as_far_as_the_first_that_is_stopped(tmp_path, repertoire) -> None:
    desk = _desk(tmp_path, repertoire)
    desk.snap = False
    for start in (1.0, 3.0, 8.0):
        desk.create("gesture", start, start + 1.0)
    marks = desk.document.marks
    desk.select(marks[0])
    desk.select(marks[1], more=True)
    drag = desk.begin_drag("move", marks[0], 1.0)
    desk.drag(drag, 6.9)
    assert [m.start_s for m in desk.document.marks] == [5.0, 7.0, 8.0], "their distance stays, the third one stops them"


def test_edges_snap_to_edges_words_play_head_and_frames(tmp_path, repertoire) -> None:
    desk = _desk(tmp_path, repertoire)
    desk.sheet.history.now = desk.document.with_marks([Mark(1.0, 3.217, "posture", "upright")])
    desk.describe(note="x")
    object.__setattr__(desk.document, "spoken", (Word(6.111, 6.4, "tea"),))
    reach = 8.0 / desk.view.px_s
    assert desk.snapped(3.217 + 0.9 * reach) == 3.217
    assert desk.snapped(6.111 - 0.9 * reach) == 6.111
    assert desk.snapped(10.01) == pytest.approx(10.0), "far from any edge: the nearest frame"
    desk.clock.go_to(12.5)
    assert desk.snapped(12.5 + 0.4 * reach) == 12.5
    desk.snap = False
    assert desk.snapped(3.23) == 3.23


def test_what_cannot_be_done_is_told_and_changes_nothing(tmp_path, repertoire) -> None:
    desk = _desk(tmp_path, repertoire)
    desk.create("posture", 0.0, 0.5)
    assert desk.failed
    assert "at least 1 s" in desk.message
    assert desk.document.marks == ()
    desk.create("posture", 0.0, 5.0)
    desk.set_behaviour("nod")
    assert desk.failed
    assert desk.message == "nod is a gesture"
    desk.split_here()
    assert desk.failed, "the play head stands at its edge"
    desk.select(None)
    desk.merge()
    assert desk.failed
    desk.paste()
    assert desk.message == "nothing has been copied"
    assert len(desk.document.marks) == 1
    desk.undo()
    desk.undo()
    assert desk.message == "nothing to undo"


def test_a_motion_is_read_once_whatever_its_file_is_called(tmp_path: Path) -> None:
    lines = (MOTION / "takes" / "neutral.bvh").read_text().splitlines()
    motion = lines.index("MOTION")
    lines = [*lines[: motion + 1], "Frames: 4", *lines[motion + 2 : motion + 7]]
    (tmp_path / "a.bvh").write_text("\n".join(lines))
    shutil.copy(tmp_path / "a.bvh", tmp_path / "b.bvh")
    shelf = ClipShelf()
    first = shelf.clip(tmp_path / "a.bvh")
    assert shelf.clip(tmp_path / "b.bvh") is first
    with pytest.raises(BadInput, match=r"x:1.*30"):
        shelf.clip(tmp_path / "b.bvh", parse_yaml("25", "x"))
    (tmp_path / "b.bvh").write_text("\n".join([*lines[:-1], lines[-2]]))
    assert shelf.clip(tmp_path / "b.bvh") is not first, "other contents are another motion"
    with pytest.raises(BadInput, match="nowhere"):
        shelf.clip(tmp_path / "nowhere.bvh")


def test_split_merge_copy_paste_trim_and_stroke_at_the_play_head(tmp_path, repertoire) -> None:
    desk = _desk(tmp_path, repertoire)
    desk.create("gesture", 2.0, 6.0, "nod")
    desk.clock.go_to(3.0)
    desk.stroke_here()
    assert desk.one is not None
    assert desk.one.stroke_s == 3.0
    desk.change(words="of course", note="twice")
    desk.clock.go_to(4.0)
    desk.split_here()
    assert [(m.start_s, m.end_s, m.stroke_s) for m in desk.document.marks] == [(2.0, 4.0, 3.0), (4.0, 6.0, None)]
    desk.select(desk.document.marks[0])
    desk.merge()
    assert desk.one == Mark(2.0, 6.0, "gesture", "nod", 3.0, "of course", "twice")
    desk.copy()
    desk.clock.go_to(10.0)
    desk.paste()
    assert desk.one == Mark(10.0, 14.0, "gesture", "nod", 11.0, "of course", "twice")
    desk.clock.go_to(12.0)
    desk.trim_here("end")
    assert desk.one is not None
    assert desk.one.end_s == 12.0
    desk.stroke_here()
    desk.stroke_here()
    assert desk.one is not None
    assert desk.one.stroke_s is None, "the same moment again: no stroke"
    for _ in range(5):
        desk.undo()
    assert [m.end_s for m in desk.document.marks] == [4.0, 6.0]


def test_tab_walks_the_layer_and_gaps_are_found_from_the_play_head_on(tmp_path, repertoire) -> None:
    desk = _desk(tmp_path, repertoire)
    for start, end in ((0.0, 5.0), (8.0, 12.0), (12.0, 20.0)):
        desk.create("posture", start, end)
    desk.select(None)
    desk.clock.go_to(6.0)
    desk.neighbour(1)
    assert desk.one is not None
    assert (desk.one.start_s, desk.clock.time_s) == (8.0, 8.0)
    desk.neighbour(-1)
    assert desk.clock.time_s == 0.0
    desk.next_gap()
    assert desk.clock.time_s == 5.0
    desk.next_gap()
    assert desk.clock.time_s == 20.0
    desk.next_gap()
    assert desk.clock.time_s == 5.0, "after the last one the first again"


def test_proposals_fill_only_what_nobody_has_marked_meanwhile(tmp_path, repertoire) -> None:
    desk = _desk(tmp_path, repertoire)
    proposed = [
        Mark(0.0, 6.0, "posture", "upright", confidence=0.8), Mark(6.0, 9.0, "posture", "arms_crossed", confidence=0.5)
    ]  # fmt: skip
    desk.create("posture", 4.0, 7.0, "lean_back")
    desk.take_proposals(desk.sheet, proposed)
    found = [(m.behaviour, m.start_s, m.end_s, m.confidence) for m in desk.document.marks]
    assert found == [("upright", 0.0, 4.0, 0.8), ("lean_back", 4.0, 7.0, None), ("arms_crossed", 7.0, 9.0, 0.5)]
    desk.select(desk.document.marks[0])
    desk.accept()
    assert len(desk.proposals()) == 1
    assert desk.one == Mark(0.0, 4.0, "posture", "upright")
    desk.undo()
    assert len(desk.proposals()) == 2
    desk.reject(everything=True)
    assert [m.behaviour for m in desk.document.marks] == ["lean_back"]


def test_the_clock_plays_slowly_loops_and_stops_at_the_last_frame() -> None:
    clock = Clock(10.0, 30.0)
    clock.slower(2)
    assert clock.speed == 0.25
    clock.toggle()
    clock.advance(4.0)
    assert clock.time_s == 1.0
    clock.loop = (2.0, 3.0)
    clock.toggle()
    clock.toggle()
    assert clock.time_s == 2.0, "playing a loop begins at its start"
    clock.advance(5.0)
    assert clock.time_s == pytest.approx(2.25)
    clock.loop = None
    clock.advance(100.0)
    assert not clock.playing
    assert clock.frame == 299
    clock.toggle()
    assert clock.time_s == 0.0


def test_zoom_keeps_the_moment_under_the_mouse_and_goes_from_minutes_to_frames() -> None:
    view = TimeView(600.0)
    view.resize(1000.0)
    assert view.px_s == pytest.approx(1000.0 / 600.0)
    held = view.time(400.0)
    for _ in range(40):
        view.zoom(1.25, 400.0)
    assert view.time(400.0) == pytest.approx(held, abs=1e-6)
    assert view.px_s / 30.0 > 60.0, "a frame is wider than a finger"
    ticks = view.ticks()
    assert all(b - a >= 70.0 / view.px_s - 1e-9 for a, b in itertools.pairwise(ticks))
    view.zoom(1e-9, 0.0)
    assert view.start_s == 0.0
    view.fit(10.0, 20.0)
    view.follow(25.0)
    assert 0.0 <= view.x(25.0) <= view.width


def test_behaviours_are_found_by_any_word_of_name_or_label(repertoire) -> None:
    assert [b.name for b in behaviours_of(repertoire, "posture", "arms cr")] == ["arms_crossed"]
    assert [b.name for b in behaviours_of(repertoire, "posture", "腕組")] == ["arms_crossed"]
    assert behaviours_of(repertoire, "gesture", "arms crossed") == []


def test_a_click_on_the_figure_changes_the_file_and_nothing_else_in_it(tmp_path, repertoire) -> None:
    path = tmp_path / "behaviours.yaml"
    shutil.copy(MOTION / "behaviours.yaml", path)
    before = path.read_text(encoding="utf-8").splitlines()
    uses, locks = next_state(repertoire["nod"], "head")
    assert next_state(repertoire["nod"], "legs")[0] == repertoire["nod"].uses | {"legs"}
    changed = put_parts(path, "nod", uses, locks)
    assert "head" in changed["nod"].locks
    assert "head" not in changed["nod"].uses
    after = path.read_text(encoding="utf-8").splitlines()
    assert [i for i, (a, b) in enumerate(zip(before, after, strict=True)) if a != b] == [
        next(i for i, row in enumerate(before) if row.strip().startswith("nod:"))
    ]
    added = add_behaviour(path, "hand_in_hair", "mannerism")
    assert added["hand_in_hair"].layer == "mannerism"
    with pytest.raises(BadInput, match="a name that is free"):
        add_behaviour(path, "nod", "gesture")
    with pytest.raises(BadInput, match="small letters"):
        add_behaviour(path, "x: y", "gesture")
    assert project_behaviours([tmp_path / "takes" / "a.bvh"], MOTION / "behaviours.yaml") == path.resolve()


# -- files -----------------------------------------------------------------------------------------------------------
@pytest.fixture
def take(tmp_path: Path) -> Path:
    for end in ("bvh", "yaml"):
        shutil.copy(MOTION / "takes" / f"joy.{end}", tmp_path / f"joy.{end}")
    return tmp_path / "joy.bvh"


def test_work_is_kept_recovered_and_cleared_by_saving(take: Path, repertoire) -> None:
    desk = Desk([Sheet.open(take, "mia")], dict(repertoire))
    original, version = take.with_suffix(".yaml").read_bytes(), desk.document.version
    desk.select(desk.document.marks[0])
    desk.delete()
    desk.tick(0.5 * AUTOSAVE_S)
    assert not autosave_path(desk.sheet.notes).exists()
    desk.tick(0.6 * AUTOSAVE_S)
    assert autosave_path(desk.sheet.notes).exists()
    assert take.with_suffix(".yaml").read_bytes() == original, "the file itself waits for the save"
    assert [t.name for t in read_takes(take.parent, repertoire, Findings())] == ["joy"], "an autosave is no take"
    assert [p.name for p in learnable([take.parent], Path())] == ["joy.yaml"]
    others = learnable([take.parent, MOTION / "takes"], take.with_suffix(".yaml"))
    assert "joy.yaml" not in {p.name for p in others}, "a copy of the take itself teaches nothing"
    assert len(others) == 6

    after = Sheet.open(take)  # the window has died
    assert after.offer == desk.document
    after.take_up(wanted=True)
    assert after.now == desk.document
    desk = Desk([after], dict(repertoire))
    assert desk.save()
    assert read_document(take.with_suffix(".yaml")).marks == desk.document.marks
    assert desk.document.version == version + 1
    assert not autosave_path(after.notes).exists()
    assert not after.history.dirty
    desk.undo()
    assert len(desk.document.marks) == len(read_document(take.with_suffix(".yaml")).marks) + 1, "undo goes past a save"
    assert desk.save()
    assert desk.document.version == version + 2, "versions never go back"


def test_a_torn_autosave_is_refused_with_a_reason_and_kept(take: Path) -> None:
    sheet = Sheet.open(take)
    sheet.history.do("x", edits.deleted(sheet.now, sheet.now.marks[:1]))
    sheet.keep()
    path = autosave_path(sheet.notes)
    path.write_bytes(path.read_bytes()[:-40])
    again = Sheet.open(take)
    assert again.offer is None
    assert "cut off" in again.refusal
    assert (take.parent / ".joy.autosave.unreadable.yaml").exists()


def test_letting_unsaved_work_go_leaves_no_autosave(take: Path) -> None:
    sheet = Sheet.open(take)
    sheet.history.do("x", edits.deleted(sheet.now, sheet.now.marks[:1]))
    sheet.keep()
    again = Sheet.open(take)
    again.take_up(wanted=False)
    assert not autosave_path(again.notes).exists()
    assert not again.history.dirty


def test_a_file_somebody_else_changed_meanwhile_is_kept_beside(take: Path, repertoire) -> None:
    desk = Desk([Sheet.open(take)], dict(repertoire))
    theirs = take.with_suffix(".yaml").read_text(encoding="utf-8") + "# theirs\n"
    take.with_suffix(".yaml").write_text(theirs, encoding="utf-8")
    desk.describe(author="mia")
    assert desk.save()
    assert "joy.yaml.before" in desk.message
    assert take.with_suffix(".yaml.before").read_text(encoding="utf-8") == theirs


def test_a_try_that_fails_tells_all_that_is_wrong_and_one_without_emotion_what_to_do(tmp_path, repertoire) -> None:
    pytest.importorskip("imgui_bundle")
    from game.tools.annotate.desk_actions import Actions

    desk = _desk(tmp_path, repertoire)
    desk.create("posture", 0.0, 10.0)
    actions = Actions(desk, MOTION / "behaviours.yaml", tmp_path)
    actions.try_it()
    assert (actions.job, desk.failed) == (None, True)
    assert "which emotion" in desk.message
    assert not desk.sheet.notes.exists(), "nothing is written before that is known"
    desk.describe(emotion="joy")
    actions.try_it()
    while actions.job is not None:
        actions.tick(0.05)
    assert len(actions.findings) == 7, "six feelings without a take, and a motion that is not there"
    assert any("t0.bvh" in line for line in actions.findings)
    assert sum("expected a take of" in line for line in actions.findings) == 6
    assert not (tmp_path.parent / "units.yaml").exists()
    actions.let_go()
    assert actions.findings == ()
