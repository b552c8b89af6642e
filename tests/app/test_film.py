"""Pictures without a display: the four modes, strips, and the paper's figure 6."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pygame
import pytest

from game.app.cli import build_parser, main
from game.app.content import load_talk_assets, stall_path
from game.app.figure6 import COLUMNS, ROWS, film_talk, insulting_policy, listening_policy, moments_of, moves_of
from game.app.loading import load_step_assets
from game.app.step import new_world
from game.app.studio import Studio
from game.app.talk import TalkState, choose, start_talk
from game.app.world import enter_talk

ITEM, SEED = "teapot_gold", 6


def pixels(path: Path) -> np.ndarray:
    return pygame.surfarray.array3d(pygame.image.load(str(path))).swapaxes(0, 1).astype(int)


def play(policy_name: str) -> TalkState:
    assets = load_talk_assets(stall_path("flea"))
    policy = {"good": listening_policy, "bad": insulting_policy}[policy_name]
    state = start_talk(assets, ITEM, SEED, purse=int(assets.script.items[ITEM].list_price * 1.5))
    for move in moves_of(assets, ITEM, SEED, policy):
        state = choose(assets, state, move)
    return state


def test_one_player_wins_the_deal_and_the_other_is_sent_away() -> None:
    assert play("good").bargain.outcome == "deal"
    bad = play("bad")
    assert bad.ended
    assert bad.bargain.outcome != "deal"


def test_the_bad_player_never_gets_a_deal() -> None:
    assets = load_talk_assets(stall_path("flea"))
    for seed in range(30):
        state = start_talk(assets, ITEM, seed, purse=9000)
        rng = np.random.default_rng(seed)
        while not state.ended:
            state = choose(assets, state, insulting_policy(assets, state, rng))
        assert state.bargain.outcome != "deal"


@pytest.fixture(scope="module")
def studio() -> Iterator[Studio]:
    args = build_parser("film").parse_args(["film", "--figure6", "--out", "x.png", "--level", "low"])
    made = Studio(args, (96, 96), "body")
    yield made
    made.close()


def test_the_rows_show_the_same_moments_and_differ_in_what_is_acted(studio: Studio) -> None:
    assets = studio.session.assets
    moves = {
        "success": moves_of(assets.talk, ITEM, SEED, listening_policy),
        "failure": moves_of(assets.talk, ITEM, SEED, insulting_policy),
    }
    begun = new_world(assets, SEED)
    begun = enter_talk(assets, begun, start_talk(assets.talk, ITEM, SEED, purse=7200))
    moments_s = moments_of(assets, begun, moves["success"])
    assert len(moments_s) == len(COLUMNS)
    seen = {
        name: list(film_talk(studio, replace(begun, mode=mode), moves[story], moments_s[:3]))
        for name, mode, story in ROWS
    }
    assert all(len(row) == 3 for row in seen.values())
    # The upper row is the success again: the same talk, the same choices of units at the same ticks …
    for above, below in zip(seen["gestures"], seen["success"], strict=True):
        assert above.tick == below.tick
        assert above.body.decisions.unit.tolist() == below.body.decisions.unit.tolist()
        assert above.marks == below.marks
    # … but another body: posture and mannerism stand still, and the face says nothing.
    ends = [seen[name][-1] for name in ("gestures", "success", "failure")]
    rotation = [end.body.pose.rotation[0] for end in ends]
    assert np.abs(rotation[0] - rotation[1]).max() > 0.1
    anger = [float(end.felt[0]) for end in ends]
    assert anger[0] == anger[1] < anger[2]
    assert not np.allclose(ends[0].body.face_params, ends[1].body.face_params)


def test_snapshots_show_what_their_mode_shows(tmp_path: Path) -> None:
    """Anger in four modes: the hidden face, the fixed body, and the gestures' neutral face."""
    drawn = {}
    for mode in ("full", "gestures", "body", "face"):
        path = tmp_path / f"{mode}.png"
        words = ["snapshot", "--emotion", "anger=1", "--mode", mode, "--seconds", "1.5", "--seed", "2"]
        assert main([*words, "--camera", "body", "--size", "200x220", "--level", "low", "--out", str(path)]) == 0
        drawn[mode] = pixels(path)
    head, body = (slice(20, 110), slice(60, 140)), (slice(120, 190), slice(40, 160))

    def differ(a: str, b: str, part: tuple[slice, slice]) -> float:
        return float(np.abs(drawn[a][part] - drawn[b][part]).mean())

    assert differ("full", "body", body) < 1.0, "the same body"
    assert differ("full", "body", head) > 3.0, "without its face"
    assert differ("full", "face", body) > 5.0, "the body stands at neutral"
    assert differ("gestures", "face", body) < 0.5 * differ("full", "face", body), "posture and mannerism are held"
    assert differ("gestures", "face", head) > 1.0, "but only one face is angry"


def test_a_strip_of_the_body_mode(tmp_path: Path) -> None:
    path = tmp_path / "strip.png"
    words = ["film", "--emotion", "joy=1", "--mode", "body", "--seconds", "1", "--every", "0.25", "--strip"]
    assert main([*words, "--columns", "2", "--size", "80x88", "--level", "low", "--out", str(path)]) == 0
    assert pixels(path).shape == (176, 160, 3)


def test_an_unknown_quality_level_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SystemExit):
        main(["snapshot", "--level", "best", "--out", str(tmp_path / "a.png")])


def test_figure_6_refuses_an_unknown_item(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["film", "--figure6", "--item", "spoon", "--out", str(tmp_path / "f.png"), "--size", "64x64"]) == 2
    assert "teapot_gold" in capsys.readouterr().err


def test_modes_are_known_to_every_command_that_acts() -> None:
    for command, needed in (("play", []), ("film", ["--out", "x"]), ("snapshot", ["--out", "x"]), ("perform", [])):
        for mode in ("full", "gestures", "body", "face"):
            args = build_parser(command).parse_args([command, *needed, "--mode", mode])
            assert args.mode == mode
    assert load_step_assets(body=False).performer is None
