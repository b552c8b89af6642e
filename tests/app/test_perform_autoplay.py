"""Bodies beside autoplay: many at once do what each does alone in the step, and every start says why."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from game.app.autoplay import play_episode, play_with_bodies
from game.app.body import MAX_TICKS, PATIENCE_S, THINKING_TICKS, BodyObserver
from game.app.cli import main
from game.app.content import load_talk_assets, stall_path
from game.app.policies import seat
from game.app.step import StepAssets, new_world, step
from game.app.talk import TalkAssets, TalkState
from game.app.world import Intent, enter_talk

SEED = 5


@pytest.fixture(scope="module")
def assets() -> TalkAssets:
    return load_talk_assets(stall_path("flea"))


@pytest.fixture(scope="module")
def observer() -> BodyObserver:
    return BodyObserver.load()


def talks(assets: TalkAssets, count: int, moves: int) -> list[list[TalkState]]:
    return [
        [decision.after for decision in play_episode(seat(assets, "oracle"), SEED, episode)][:moves]
        for episode in range(count)
    ]


def alone(assets: TalkAssets, observer: BodyObserver, talk: list[TalkState], episode: int) -> list[list[str]]:
    """The same through ``step``, tick by tick, one talk by itself."""
    step_assets = StepAssets(assets, observer.planner)
    library = observer.planner.library
    world = new_world(step_assets, (SEED * 1_000_003 + episode) & 0x7FFFFFFF, text_speed="fast")
    result = []
    for at, state in enumerate(talk):
        if at == 0:
            world = enter_talk(step_assets, world, state)
        else:
            world = replace(world, talk=state, queue=state.beat.lines)
        seen: dict[str, None] = {}
        quiet = 0
        for _ in range(MAX_TICKS):
            speech = world.speech
            heard = speech is not None and world.time_s > speech.started_s + speech.timed.length_s + PATIENCE_S
            world = step(step_assets, world, Intent(proceed=heard))
            for unit in world.body.decisions.unit[0]:
                if not library.is_rest[unit]:
                    seen[library.units[unit].name] = None
            quiet = quiet + 1 if world.waiting or world.over else 0
            if quiet >= THINKING_TICKS:
                break
        result.append(list(seen))
    return result


def test_many_bodies_at_once_do_what_each_does_in_the_step(assets: TalkAssets, observer: BodyObserver) -> None:
    played = talks(assets, 4, 2)
    together = observer.watch(assets, played, SEED)
    for episode in (0, 3):
        units = [list(beat.units) for beat in together[episode]]
        assert units == alone(assets, observer, played[episode], episode)
    # … and in other company: the second half by itself.
    later = observer.watch(assets, played[2:], SEED, first=2)
    assert later == together[2:]


def test_every_start_has_a_reason_and_a_span(assets: TalkAssets, observer: BodyObserver) -> None:
    for beats in observer.watch(assets, talks(assets, 3, 3), SEED):
        for beat in beats:
            assert beat.starts
            assert {row["unit"] for row in beat.starts} <= set(beat.units)
            assert [row["time_s"] for row in beat.starts] == sorted(row["time_s"] for row in beat.starts)
            for row in beat.starts:
                assert row["reason"]
                assert row["source"]
                f = row["factors"]
                product = f["continuity"] * f["linkage"] * f["time"] * f["state"]
                assert f["score"] == pytest.approx(product, abs=1e-4)


def test_a_mode_hides_what_stands_still(assets: TalkAssets, observer: BodyObserver) -> None:
    played = talks(assets, 2, 2)
    library = observer.planner.library
    for mode, layers in (("gestures", {"gesture"}), ("face", set()), ("body", {"posture", "gesture", "mannerism"})):
        seen = replace(observer, mode=mode).watch(assets, played, SEED)
        names = [name for beats in seen for beat in beats for name in beat.units]
        assert {library.units[library.index[name]].layer for name in names} <= layers
    assert seen == observer.watch(assets, played, SEED)


def test_the_log_tells_why_and_is_the_same_for_the_same_seed(tmp_path: Path, capsys) -> None:
    logs = []
    for name in ("a", "b"):
        path = tmp_path / f"{name}.jsonl"
        words = ["autoplay", "--episodes", "3", "--policy", "oracle", "--seed", "2", "--body", "--mode", "gestures"]
        assert main([*words, "--out", str(path), "--json"]) == 0
        logs.append(path.read_bytes())
    assert logs[0] == logs[1]
    rows = [json.loads(line) for line in logs[0].splitlines()]
    assert {row["mode"] for row in rows} == {"gestures"}
    starts = [start for row in rows for start in row["starts"]]
    assert starts
    assert {start["layer"] for start in starts} == {"gesture"}
    bodiless = tmp_path / "c.jsonl"
    assert main(["autoplay", "--episodes", "3", "--policy", "oracle", "--seed", "2", "--out", str(bodiless)]) == 0
    plain = [json.loads(line) for line in bodiless.read_text("utf-8").splitlines()]
    for row, without in zip(rows, plain, strict=True):
        assert {k: v for k, v in row.items() if k not in {"mode", "units", "starts"}} == without
    assert np.isfinite([start["time_s"] for start in starts]).all()
    capsys.readouterr()


@pytest.mark.parametrize("policy", ["random", "body", "reader"])
def test_players_see_the_body_of_their_own_talk_from_the_greeting_on(
    assets: TalkAssets, observer: BodyObserver, policy: str
) -> None:
    """… whoever sits beside them."""
    place = seat(assets, policy, library=observer.planner.library)
    together = play_with_bodies(observer, [place] * 3, SEED, 0)
    for talk in together:
        for at, decision in enumerate(talk):
            assert decision.seen is not None
            assert decision.shown is not None
            assert set(decision.seen.quiet) <= set(decision.seen.units)
            assert at == 0 or decision.seen is talk[at - 1].shown
        assert talk[-1].after.ended
    alone = play_with_bodies(observer, [place], SEED, 2)
    assert [(d.choice, d.seen, d.shown) for d in alone[0]] == [(d.choice, d.seen, d.shown) for d in together[2]]
