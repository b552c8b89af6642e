"""Disks that are really full and folders that really cannot be written: told in one line, and nothing is lost."""

from __future__ import annotations

import argparse
import contextlib
import functools
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from game.app.autoplay.logfile import LogFile
from game.app.cli import main
from game.app.loading import load_step_assets
from game.app.opening import open_session
from game.app.pictures import write_png
from game.app.recording import read_recording, record_session
from game.app.recording.recorder import CHECK_TICKS
from game.app.replay import open_replay
from game.app.saves import load_game, save_game
from game.app.session import Session, saved_game
from game.app.settings import Settings, load_settings, save_settings
from game.app.talk import Choice
from game.app.world import Intent
from game.core.errors import BadInput
from game.tools.compare import Limits, compare_frames, write_comparison

resource = pytest.importorskip("resource", reason="limits on file size are POSIX")
NOWHERE = Path("/proc/self/nowhere")  # a place in which nobody makes files, not even root
once = functools.cache(load_step_assets)


@contextlib.contextmanager
def full_disk(room_bytes: int) -> Iterator[None]:
    """Every file ends at so many bytes: the system itself refuses what goes beyond."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room_bytes, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.fixture(autouse=True)
def user(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MCG_USER_FOLDER", str(tmp_path / "user"))
    monkeypatch.setattr("game.app.opening.load_step_assets", once)
    monkeypatch.setattr("game.app.replay.load_step_assets", once)


@pytest.fixture
def session() -> Session:
    opened = open_session(argparse.Namespace(language="en", stall="flea", seed=5, mode="full", overlay=False))
    opened.open_day()
    return opened


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_full_disk_costs_no_save_and_no_settings(session: Session, tmp_path: Path) -> None:
    folder = tmp_path / "kept"
    folder.mkdir()
    save_game(folder / "save.json", saved_game(session))
    save_settings(Settings(language="ja"), folder)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    session.begin_talk("vase")
    for room in (0, 1, 40):
        with full_disk(room):
            with pytest.raises(BadInput, match=r"save\.json") as caught:
                save_game(folder / "save.json", saved_game(session))
            said = save_settings(Settings(language="en", ui_scale=2.0), folder)
        assert "\n" not in str(caught.value)
        assert said is not None
        assert "\n" not in said
        assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    assert load_settings(folder)[0].language == "ja"
    assert load_game(folder / "save.json", session.market.bazaar, session.market.talks()).talk is None


def test_a_recording_ends_where_the_disk_is_full_and_the_game_goes_on(session: Session, tmp_path: Path) -> None:
    path = tmp_path / "play.jsonl"
    recorder = record_session(session, path, stall="flea")
    session.begin_talk("vase")
    with full_disk(1500):
        for tick in range(2 * CHECK_TICKS + 20):
            talk = session.world.talk
            move = Intent(proceed=True)
            if tick % 60 == 59 and talk is not None and session.world.waiting:
                move = Intent(choice=Choice(next(c.id for c in talk.beat.choices if c.available and c.act != "offer")))
            session.tick(move)
        recorder.close(session)
    assert session.ticks == 2 * CHECK_TICKS + 20, "the game goes on"
    assert "play-crashed.jsonl" in recorder.trouble
    assert "\n" not in recorder.trouble
    assert names(tmp_path) == ["play-crashed.jsonl"]
    left = read_recording(tmp_path / "play-crashed.jsonl")
    assert not left.whole
    assert len(left.events) >= 3, "what was played before is there"
    again, player = open_replay(left)
    while not player.done:
        again.tick(Intent())
    assert player.divergence is None


def test_a_log_goes_on_to_the_same_bytes_once_there_is_room(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["autoplay", "--episodes", "150", "--policy", "random", "--seed", "3", "--out"]
    whole = tmp_path / "whole.jsonl"
    assert main([*words, str(whole)]) == 0
    size, log = whole.stat().st_size, tmp_path / "log.jsonl"
    capsys.readouterr()
    with full_disk(int(size * 0.7)):
        assert main([*words, str(log)]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "room to write" in told
    assert not log.exists()
    assert main([*words, str(log), "--resume"]) == 0
    assert log.read_bytes() == whole.read_bytes()
    assert names(tmp_path) == ["log.jsonl", "whole.jsonl"]


def test_a_state_that_does_not_fit_leaves_the_last_one(tmp_path: Path) -> None:
    log = LogFile(tmp_path / "log.jsonl", {"seed": 1})
    log.begin(resume=False)
    log.write(b"{}\n")
    log.keep({"jobs": 1})
    with full_disk(16):
        log.write(b"{}\n")
        with pytest.raises(BadInput, match="room to write"):
            log.keep({"jobs": 2, "more": "x" * 64})
    log.stop()
    again = LogFile(tmp_path / "log.jsonl", {"seed": 1})
    assert again.begin(resume=True) == {"jobs": 1}
    again.stop()


def test_pictures_and_pages_come_whole_or_not_at_all(tmp_path: Path) -> None:
    noise = np.random.default_rng(1).integers(0, 256, (64, 64, 3), dtype=np.uint8)
    compared = compare_frames([("a", noise, noise)])
    for write, name in (
        (lambda path: write_png(path, noise), "x.png"),
        (lambda path: write_comparison(path, "x", compared, Limits()), "x.html"),
    ):
        with full_disk(500), pytest.raises(BadInput) as caught:
            write(tmp_path / name)
        assert "\n" not in str(caught.value)
        assert names(tmp_path) == []


def test_a_folder_in_which_nothing_can_be_made_is_told_before_anything_is_played(
    session: Session, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(BadInput):
        save_game(NOWHERE / "save.json", saved_game(session))
    assert save_settings(Settings(), NOWHERE) is not None
    with pytest.raises(BadInput, match="recording"):
        record_session(session, NOWHERE / "play.jsonl", stall="flea")
    for words in (
        ["autoplay", "--episodes", "2", "--policy", "random", "--out", str(NOWHERE.parent / "log.jsonl")],
        ["crawl", "flea", "--out", str(NOWHERE)],
        ["film", "--seconds", "1", "--strip", "--out", str(NOWHERE / "strip.png")],
    ):
        assert main(words) == 2
        assert capsys.readouterr().err.count("\n") == 1
