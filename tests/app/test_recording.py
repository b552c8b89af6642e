"""A recorded play comes out the same again, or says where it does not."""

from __future__ import annotations

import argparse
import functools
import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from game.app.cli import main
from game.app.content import load_talk_assets, stall_path
from game.app.designer import set_felt
from game.app.loading import load_step_assets
from game.app.market import Market, Stall
from game.app.opening import open_session, resume_game
from game.app.recording import read_recording, record_session
from game.app.recording.talks import play_talk, write_talk
from game.app.replay import open_replay
from game.app.saves import save_game
from game.app.session import Session, saved_game, take_back
from game.app.step import StepAssets
from game.app.talk import Choice, choose, start_talk
from game.app.world import Intent
from game.core.errors import BadInput
from game.core.paths import DIALOGUE


@functools.cache
def _bodies() -> StepAssets:
    return load_step_assets()


@functools.cache
def once(stall: str = "flea", *, body: bool = True) -> StepAssets:
    """As ``load_step_assets``, with one body for all."""
    parts = _bodies() if body else replace(_bodies(), performer=None, face=None)
    return replace(parts, talk=load_talk_assets(stall_path(stall)))


@pytest.fixture(autouse=True)
def user(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MCG_USER_FOLDER", str(tmp_path / "user"))
    monkeypatch.setattr("game.app.opening.load_step_assets", once)
    monkeypatch.setattr("game.app.replay.load_step_assets", once)


def opened(stall: str = "flea", seed: int = 7) -> Session:
    return open_session(argparse.Namespace(language="en", stall=stall, seed=seed, mode="full", overlay=False))


def play(session: Session, ticks: int, *, moves: int = 99) -> int:
    """Say the first thing there is, as soon as it can be said; every fourth tick goes on."""
    said = 0
    for tick in range(ticks):
        world, choice = session.world, None
        if world.waiting and said < moves and world.talk is not None:
            choice = Choice(next(c.id for c in world.talk.beat.choices if c.available and c.act != "offer"))
            said += 1
        session.tick(Intent(choice=choice, proceed=tick % 4 == 0))
    return said


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A play with everything in it: a day, a talk, another language and speed, a save taken up again, an end."""
    folder = tmp_path_factory.mktemp("recorded")
    shutil.copytree(DIALOGUE, folder / "dialogue")
    path = folder / "play.jsonl"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MCG_USER_FOLDER", str(folder / "user"))
        patch.setattr("game.app.recording.recorder.CHECK_TICKS", 40)
        return _record_everything(folder, path)


def _record_everything(folder: Path, path: Path) -> Path:
    session = opened(str(folder / "dialogue" / "flea.yaml"))
    recorder = record_session(session, path, stall=str(folder / "dialogue" / "flea.yaml"))
    play(session, 4)
    session.open_day()
    play(session, 3)
    session.begin_talk("vase")
    assert play(session, 60, moves=2) == 2
    assert take_back(session)
    save_game(folder / "kept.json", saved_game(session))
    session.world = replace(session.world, language="ja", text_speed="instant")
    play(session, 40, moves=1)
    resume_game(session, folder / "kept.json")
    play(session, 60)
    if session.world.over:
        session.end_talk()
    session.pause()
    play(session, 2)
    recorder.close(session)
    return path


def test_a_recording_is_small_and_comes_out_the_same(recorded: Path) -> None:
    recording = read_recording(recorded)
    done = [event.do for event in recording.events]
    assert recording.whole
    assert {"day", "talk", "say", "go", "set", "resume", "back", "pause", "check", "end"} <= set(done)
    assert recorded.stat().st_size < 40_000
    session, player = open_replay(recording)
    while not player.done:
        session.tick(Intent(proceed=True))  # what a viewer does is no matter
    assert player.divergence is None
    assert player.checks >= 2
    assert player.decisions == done.count("say")
    assert session.ticks == recording.ticks


def test_one_byte_of_the_world_is_enough_to_differ(recorded: Path, tmp_path: Path) -> None:
    lines = recorded.read_text(encoding="utf-8").splitlines()
    check = next(i for i, line in enumerate(lines) if '"do":"check"' in line)
    data = json.loads(lines[check])
    lines[check] = json.dumps(data | {"body": "0" * 16})
    changed = tmp_path / "changed.jsonl"
    changed.write_text("\n".join(lines) + "\n", encoding="utf-8")
    session, player = open_replay(read_recording(changed))
    while not player.done:
        session.tick(Intent())
    assert player.divergence is not None
    assert player.divergence.line == check + 1
    assert "pose" in player.divergence.what


def test_other_content_says_where_it_first_goes_another_way(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = read_recording(recorded)
    first = next(event for event in recording.events if event.do == "say")
    shutil.copytree(DIALOGUE, tmp_path / "other")
    script = tmp_path / "other" / "flea.yaml"
    text = script.read_text(encoding="utf-8")
    assert first.values["choice"] in text
    script.write_text(text.replace(first.values["choice"], "quite_another_word"), encoding="utf-8")
    assert main(["replay", str(recorded), "--headless", "--json", "--stall", str(script)]) == 1
    told = json.loads(capsys.readouterr().out)
    assert not told["same"]
    assert told["diverges"]["decision"] == 1, told
    assert first.values["choice"] in told["diverges"]["expected"]
    assert "quite_another_word" in told["diverges"]["seen"]
    assert "other/flea.yaml" in told["content"]


def test_a_recording_cut_off_anywhere_is_played_as_far_as_it_goes(recorded: Path, tmp_path: Path) -> None:
    raw = recorded.read_bytes()
    cut = tmp_path / "cut.jsonl"
    first = raw.index(b"\n") + 1
    for at in [0, 1, first - 1, first, *range(first + 1, len(raw), 97)]:
        cut.write_bytes(raw[:at])
        if at < first:
            with pytest.raises(BadInput, match=r"cut\.jsonl"):
                read_recording(cut)
        else:
            assert not read_recording(cut).whole


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"recording":1', '"recording":2', "expected version 1"),
        ('"kind":"session"', '"kind":"film"', "session | talk"),
        ('"do":"talk","item":"vase"', '"do":"talk","item":7', "expected a text"),
        ('"do":"day"', '"do":"rm"', "say | go"),
        ('"t":4,"do":"day"', '"t":-4,"do":"day"', "a whole number from 0"),
        ('"language":"ja"', '"language":"../.."', "en | ja"),
    ],
)
def test_wrong_values_are_refused_in_one_line_with_their_place(
    recorded: Path, tmp_path: Path, old: str, new: str, said: str
) -> None:
    text = recorded.read_text(encoding="utf-8")
    assert old in text
    wrong = tmp_path / "wrong.jsonl"
    wrong.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(BadInput) as caught:
        read_recording(wrong)
    message = str(caught.value)
    assert said in message
    assert "wrong.jsonl:" in message
    assert "\n" not in message


def test_a_designers_hand_ends_the_recording(tmp_path: Path) -> None:
    session = opened()
    recorder = record_session(session, tmp_path / "play.jsonl", stall="flea")
    session.open_day()
    session.begin_talk("vase")
    play(session, 6)
    set_felt(session, "anger", 0.9)
    play(session, 6)
    recorder.close(session)
    recording = read_recording(tmp_path / "play.jsonl")
    assert recording.events[-1].values["why"] == "designed"
    assert recording.ticks == 6
    assert "designer" in session.message
    with pytest.raises(BadInput, match="designer"):
        record_session(session, tmp_path / "more.jsonl")
    again, player = open_replay(recording)
    while not player.done:
        again.tick(Intent())
    assert player.divergence is None


def test_a_full_disk_ends_the_recording_and_not_the_game(tmp_path: Path) -> None:
    session = opened()
    recorder = record_session(session, tmp_path / "play.jsonl", stall="flea")

    class Full:
        def write(self, text: str) -> int:
            raise OSError(28, "No space left on device")

        def close(self) -> None:
            raise OSError(28, "No space left on device")

    assert recorder._file is not None
    recorder._file.close()
    recorder._file = Full()  # type: ignore[assignment]
    session.open_day()
    session.begin_talk("vase")
    play(session, 5)
    recorder.close(session)
    assert "No space left" in recorder.trouble
    assert session.ticks == 5
    # What had been written before is kept apart: nothing is lost that had a place.
    assert [path.name for path in tmp_path.iterdir()] == ["play-crashed.jsonl"]


def test_what_a_crash_left_is_kept_and_can_be_read(tmp_path: Path) -> None:
    session = opened()
    recorder = record_session(session, tmp_path / "play.jsonl", stall="flea")
    session.open_day()
    assert recorder._file is not None
    recorder._file.close()  # what had been written lies there; nobody put it in its place
    session.journal = None
    other = opened()
    record_session(other, tmp_path / "play.jsonl", stall="flea").close(other)
    kept = read_recording(tmp_path / "play-crashed.jsonl")
    assert not kept.whole
    assert [event.do for event in kept.events] == ["day"]
    assert read_recording(tmp_path / "play.jsonl").whole


def test_the_whole_market_is_recorded_walk_by_walk(tmp_path: Path) -> None:
    session = opened()
    market = Market(session.market.bazaar, session.market.stalls, expected=("flea",))
    session.market = market
    talk = load_talk_assets(stall_path("flea"))
    market.stalls["flea"] = Stall("flea", replace(session.assets, talk=talk))
    recorder = record_session(session, tmp_path / "play.jsonl", stall="flea")
    session.open_day()
    session.walk_to("flea")
    session.pause()
    session.open_day(again=True)
    play(session, 3)
    recorder.close(session)
    recording = read_recording(tmp_path / "play.jsonl")
    assert [event.do for event in recording.events] == ["day", "walk", "pause", "day", "end"]
    again, player = open_replay(recording)
    while not player.done:
        again.tick(Intent())
    assert player.divergence is None
    assert again.afternoon == session.afternoon


def test_a_policys_talk_is_recorded_and_shown_with_a_body(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assets = load_talk_assets(stall_path("flea"))
    state, moves = start_talk(assets, "vase", 11, purse=9000), []
    while not state.ended:
        option = next(c for c in state.beat.choices if c.available and c.act != "offer")
        moves.append((state, Choice(option.id)))
        state = choose(assets, state, moves[-1][1])
    path = tmp_path / "talk.jsonl"
    write_talk(path, "flea", "first", moves, state, {})
    recording = read_recording(path)
    last, divergence, count = play_talk(assets, recording)
    assert divergence is None
    assert count == len(moves)
    assert last is not None
    assert last.beat.ended == state.beat.ended
    session, player = open_replay(recording, body=False)
    for _ in range(1500):
        session.tick(Intent())
        if player.decisions:
            break
    assert player.divergence is None
    assert 0 < player.decisions <= len(moves)
    assert main(["replay", str(path), "--headless", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["same"]
    assert told["decisions"] == len(moves)


def test_replay_refuses_what_it_cannot_play(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for words in (["nothing.jsonl"], [str(tmp_path)], ["x.jsonl", "--at", "3"], ["x.jsonl", "--fps", "0"]):
        assert main(["replay", *words]) == 2
        message = capsys.readouterr().err
        assert message.startswith("error:")
        assert message.count("\n") == 1


def test_autoplay_records_what_replay_plays(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "talks"
    assert main(["autoplay", "--episodes", "2", "--policy", "oracle", "--record", str(folder), "--json"]) == 0
    capsys.readouterr()
    paths = sorted(folder.iterdir())
    assert [path.name for path in paths] == ["flea-oracle-1-000000.jsonl", "flea-oracle-1-000001.jsonl"]
    assert main(["replay", str(paths[1]), "--headless", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["same"]
    assert told["content"] == ""
    assert main(["autoplay", "--visits", "2", "--record", str(folder)]) == 2
    assert "--visits" in capsys.readouterr().err
