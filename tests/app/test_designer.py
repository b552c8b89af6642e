"""While playing: scripts read anew, a jump to a node, the inspector's sliders, back to a choice, timed choices."""

from __future__ import annotations

import argparse
import os
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from game.app.afternoon import Afternoon
from game.app.content import load_talk_assets
from game.app.designer import go_back, set_felt, set_goodwill, set_variable, warp_session
from game.app.input import Action
from game.app.opening import open_session
from game.app.overlays.inspector import Inspector
from game.app.play import _warped
from game.app.reload import Watch
from game.app.screens import TalkScreen
from game.app.settings import Settings
from game.app.step import new_world
from game.app.window import Window
from game.app.world import leave_talk
from game.core.emotion_space import SIX
from game.core.errors import BadInput
from game.core.paths import DIALOGUE
from game.render import Device, level_named

pytestmark = pytest.mark.gl

F4 = Action("key", key="f4")


@pytest.fixture(scope="module")
def opened(tmp_path_factory) -> Iterator[Window]:
    """One window for all: opening it takes longer than any of the tests."""
    device = Device.headless(640, 360)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MCG_USER_FOLDER", str(tmp_path_factory.mktemp("user")))
        arguments = argparse.Namespace(language="en", stall="flea", seed=5, mode="full", overlay=False)
        made = Window(open_session(arguments), device, level=level_named("low"))
    yield made
    made.close()
    device.release()


@pytest.fixture
def script(tmp_path, monkeypatch) -> Path:
    """The shipped stall's files, to be edited."""
    monkeypatch.setenv("MCG_USER_FOLDER", str(tmp_path / "user"))
    shutil.copytree(DIALOGUE, tmp_path / "dialogue")
    return tmp_path / "dialogue" / "flea.yaml"


@pytest.fixture
def window(script, opened) -> Window:
    """A talk about the vase, its first lines heard, at a stall whose script may be edited."""
    session = opened.session
    stall = session.market.stalls["flea"]
    stall.assets = session.assets = replace(stall.assets, talk=load_talk_assets(script))
    session.designed, session.settings = False, Settings(text_speed="instant")
    session.afternoon = Afternoon(seed=5)
    session.world = leave_talk(new_world(session.assets, 5, text_speed="instant"))
    opened.inspector = Inspector()
    session.open_day()
    session.begin_talk("vase")
    opened.screen = TalkScreen()
    hear_out(opened)
    return opened


def picture(window: Window) -> np.ndarray:
    window.draw()
    return window.renderer.read_pixels().astype(int)


def hear_out(window: Window) -> None:
    for _ in range(80):
        world = window.session.world
        if world.waiting or world.over:
            return
        window.handle(Action("confirm"))
        for _ in range(4):
            window.advance(1 / 30)
    raise AssertionError("the lines do not end")


def say_first(window: Window) -> str:
    choice = next(c.id for c in window.session.world.talk.beat.choices if c.available)
    window.draw()
    window.handle(Action("key", key="1"))
    window.advance(1 / 30)
    hear_out(window)
    return choice


def edit(path: Path, *edits: tuple[str, str]) -> None:
    text = path.read_text(encoding="utf-8")
    for old, new in edits:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")


def look(window: Window) -> None:
    """Half a second of real time: the files are looked at."""
    window.inspector.reloader.advance(window.session, 0.6)


def test_an_edited_script_goes_on_where_it_stood(window, script):
    said = say_first(window)
    look(window)
    before = window.session.world.talk
    offered = next(c for c in before.beat.choices if c.act not in {"offer", "wait", "leave"})
    edit(script, (f'en: "{offered.en}"', 'en: "Quite other words."'), ("rough: 0 ", "rough: 3 "))
    look(window)
    after = window.session.world.talk
    assert window.inspector.reloader.findings == ()
    assert "flea.yaml" in window.inspector.reloader.said
    assert after.beat.choice(offered.id).en == "Quite other words."
    assert [c.id for c in after.beat.choices] == [c.id for c in before.beat.choices]
    assert after.beat.node == before.beat.node
    assert said in after.story.chosen
    assert after.story.variables == before.story.variables, "the talk's own values are kept"
    assert np.array_equal(after.feeling.felt, before.feeling.felt)
    assert window.session.world.waiting
    say_first(window)
    assert window.session.designed
    look(window)
    window.inspector.reloader.advance(window.session, 5.0)
    assert window.inspector.reloader.said == ""


def test_a_broken_script_leaves_the_old_one_running_and_says_what_is_wrong(window, script):
    look(window)
    plain = picture(window)
    whole = script.read_text(encoding="utf-8")
    edit(script, ("to: re_praise_vase", "to: re_prase_vase"), ("act: joke\n", "act: jok\n"))
    look(window)
    found = window.inspector.reloader.findings
    assert len(found) > 2
    assert {finding.code for finding in found} == {"E_MISSING_TARGET", "E_UNKNOWN_ACT"}
    assert all(f"{script}:{finding.where.line}:" in str(finding) for finding in found)
    assert np.abs(picture(window) - plain)[10:60, 20:300].mean() > 8, "the message stands on the picture"
    assert not window.session.designed
    say_first(window)
    assert window.session.world.talk.bargain.round == 1, "the talk goes on"
    # Looked at again, nothing new: the message stands. Mended: it goes, and the talk is where it was.
    look(window)
    assert window.inspector.reloader.findings == found
    node = window.session.world.talk.beat.node
    script.write_text(whole, encoding="utf-8")
    look(window)
    assert window.inspector.reloader.findings == ()
    assert window.session.world.talk.beat.node == node


@pytest.mark.parametrize("damage", ["stall: [", "", "\x00", "stall: other\n"])
def test_no_damage_ends_the_talk(window, script, damage):
    look(window)
    script.write_text(damage, encoding="utf-8")
    look(window)
    assert window.inspector.reloader.findings
    say_first(window)
    script.unlink()
    look(window)
    say_first(window)


def test_a_thing_taken_off_the_table_while_it_is_talked_about(window, script):
    look(window)
    edit(script, ("  vase:\n", "  vases:\n"))
    look(window)
    assert window.inspector.reloader.findings
    assert window.session.assets.talk.script.items["vase"]
    say_first(window)


def test_parts_are_watched_and_only_contents_count(window, script, tmp_path):
    look(window)
    os.utime(script, ns=(1, 1))
    look(window)
    assert window.inspector.reloader.said == ""
    part = next(Path(file) for file in window.session.assets.talk.script.files if "shared" in file)
    part.write_text(part.read_text(encoding="utf-8") + "# a comment\n", encoding="utf-8")
    look(window)
    assert window.inspector.reloader.said
    watch = Watch()
    assert not watch.look([tmp_path / "nothing"])
    (tmp_path / "nothing").write_text("x")
    assert watch.look([tmp_path / "nothing"])


def test_a_jump_to_a_node(window):
    session = window.session
    warp_session(session, "deal_fair")
    assert session.world.talk.ended
    assert not session.world.waiting, "its lines are spoken first"
    hear_out(window)
    assert session.world.over
    with pytest.raises(BadInput, match="goes on"):
        warp_session(session, "talk")
    assert not go_back(session)
    warp_session(session, "silence", "cups")
    assert session.world.talk.item == "cups"
    assert session.world.talk.beat.node == "talk"
    assert session.world.talk.story.visits["silence"] == 1
    with pytest.raises(BadInput, match="did you mean 'silence'"):
        warp_session(session, "silense")
    with pytest.raises(BadInput, match="item"):
        warp_session(session, "silence", "spoon")


def test_the_command_lines_jump(window):
    session = window.session
    assert _warped(session, argparse.Namespace(at=None, item=None)) is None
    assert isinstance(_warped(session, argparse.Namespace(at="silence", item="books")), TalkScreen)
    with pytest.raises(BadInput, match="--at"):
        _warped(session, argparse.Namespace(at=None, item="books"))


def _drag(window: Window, kind: str, name: str, share: float) -> None:
    """Take hold of a slider and let go at a share of its rail; places are device pixels, half the reference."""
    window.draw()
    slider = next(s for s in window.inspector.sliders if (s.kind, s.name) == (kind, name))
    y = slider.rail.y + 4
    start, end = slider.rail.x + 2, slider.rail.x + share * slider.rail.w
    window.handle(Action("click", at=(start / 2, y / 2)))
    window.handle(Action("pointer", at=(end / 2, (y + 300) / 2)))
    window.handle(Action("release", at=(end / 2, y / 2)))
    window.handle(Action("pointer", at=(start / 2, y / 2)))


def test_the_inspectors_sliders_turn_feelings_and_goodwill(window):
    session = window.session
    plain = picture(window)
    window.handle(F4)
    assert np.abs(picture(window) - plain)[10:250, 10:170].mean() > 20
    assert not session.designed
    _drag(window, "felt", "anger", 0.9)
    assert session.designed
    anger = SIX.index("anger")
    assert session.world.talk.feeling.felt[anger] == pytest.approx(0.9, abs=0.02)
    for _ in range(45):
        window.advance(1 / 30)
    assert session.world.felt[anger] > 0.8, "the body follows"
    _drag(window, "shown", "joy", 0.7)
    for _ in range(30):
        window.advance(1 / 30)
    assert session.world.shown[SIX.index("joy")] > 0.6, "the face follows"
    _drag(window, "goodwill", "trust", 0.25)
    assert session.world.talk.bargain.trust == pytest.approx(0.25, abs=0.02)
    lowest = session.world.talk.bargain.lowest
    _drag(window, "goodwill", "ask", 0.0)
    assert session.world.talk.bargain.ask == pytest.approx(lowest, abs=0.01)
    # A click beside everything, but on the panel, says nothing to the talk below.
    before = session.world.talk
    window.handle(Action("click", at=(60.0, 20.0)))
    assert session.world.talk is before
    window.handle(F4)
    window.draw()
    assert window.inspector.sliders == []


def test_variables_are_turned_and_keep_their_type(window):
    session = window.session
    window.handle(F4)
    window.draw()
    rect, name, value = next(tap for tap in window.inspector.taps if isinstance(tap[2], bool))
    window.handle(Action("click", at=(rect.middle[0] / 2, rect.middle[1] / 2)))
    assert session.world.talk.story.variables[name] is value
    window.draw()
    rect, name, value = next(tap for tap in window.inspector.taps if tap[1] == "told" and tap[2] == 1.0)
    window.handle(Action("click", at=(rect.middle[0] / 2, rect.middle[1] / 2)))
    assert session.world.talk.story.variables["told"] == 1.0
    with pytest.raises(BadInput, match="a number"):
        set_variable(session, "told", True)
    with pytest.raises(BadInput, match="variable"):
        set_variable(session, "tolled", 1.0)
    with pytest.raises(BadInput, match="trust"):
        set_goodwill(session, "love", 1.0)


def test_back_to_the_last_choice_as_if_it_had_not_been_made(window):
    session = window.session
    assert not go_back(session)
    first = session.world.talk
    say_first(window)
    second = session.world.talk
    say_first(window)
    window.handle(F4)
    window.handle(Action("key", key="backspace"))
    assert session.world.talk is second
    assert session.world.waiting
    assert len(session.world.marks) == 2
    window.handle(Action("key", key="backspace"))
    assert session.world.talk is first
    # The same choice again has the same consequences.
    window.handle(F4)
    say_first(window)
    assert session.world.talk.feeling.felt.tolist() == second.feeling.felt.tolist()
    assert [line.id for line in session.world.talk.beat.lines] == [line.id for line in second.beat.lines]


def test_what_a_designer_touched_is_neither_saved_nor_booked(window, tmp_path):
    session = window.session
    save = tmp_path / "user" / "autosave.json"
    say_first(window)
    assert save.exists()
    kept = save.read_bytes()
    set_felt(session, "joy", 0.8)
    say_first(window)
    assert save.read_bytes() == kept
    afternoon = session.afternoon
    warp_session(session, "deal_fair")
    hear_out(window)
    session.end_talk()
    assert session.afternoon is afternoon
    assert session.world.talk is None


def test_timed_choices_run_empty_on_the_screen_only_where_they_are_wanted(window, script):
    session = window.session
    look(window)
    edit(script, ("    pool: talk\n", "    pool: talk\n    timer: {seconds: 4, default: wait}\n"))
    look(window)
    assert session.world.talk.beat.timer is not None
    plain = picture(window)
    for _ in range(150):
        window.advance(1 / 30)
    assert session.world.waiting, "off unless the player wants them"
    session.settings = replace(session.settings, timers="normal")
    for _ in range(60):
        window.advance(1 / 30)
    assert session.world.time_left == pytest.approx(0.5, abs=0.03)
    assert np.abs(picture(window) - plain)[47:52, 450:625].mean() > 15
    for _ in range(70):
        window.advance(1 / 30)
    assert session.world.marks[-1].act == "wait"
