"""Whole talks over the shipped stall: rules hold move by move, saves change nothing, one seed one result."""

from __future__ import annotations

import json

import numpy as np
import pytest

from game.app.afternoon import Afternoon, finish_talk, visit_stall
from game.app.autoplay import play_episode
from game.app.bazaar import load_bazaar
from game.app.cli import main
from game.app.content import load_talk_assets, stall_path
from game.app.policies import seat
from game.app.saves import SavedGame, load_game, save_game
from game.app.talk import Choice, ask_money, choose, start_talk
from game.core.errors import BadInput

BAZAAR = load_bazaar()


@pytest.fixture(scope="module")
def assets():
    return load_talk_assets(stall_path("flea"))


def first_item(assets) -> str:
    return sorted(assets.script.items)[0]


def summary(state) -> tuple:
    lines = tuple((line.id, line.en) for line in state.beat.lines)
    options = tuple((c.id, c.available) for c in state.beat.choices)
    felt = tuple(np.round(state.feeling.felt, 12))
    return (state.bargain, felt, lines, options, state.beat.ended, state.purse, state.deal_price)


@pytest.mark.parametrize("policy", ["random", "fixed", "words", "face", "oracle"])
def test_every_talk_ends_and_every_price_is_payable(assets, policy: str) -> None:
    endings = set()
    player = seat(assets, policy)
    for episode in range(40):
        last = None
        for decision in play_episode(player, 3, episode):
            before, after = decision.before, decision.after
            assert after.purse >= 0
            assert after.purse == before.purse - after.deal_price
            assert 0 < ask_money(after.list_price, after.bargain.ask) <= after.list_price
            last = after
        assert last is not None
        assert last.ended
        endings.add(last.beat.ended)
        if last.deal_price:
            assert last.bargain.outcome == "deal"
            assert last.deal_price <= last.list_price
    assert len(endings) >= (2 if policy == "fixed" else 3)


def test_a_save_in_the_middle_changes_nothing(assets, tmp_path) -> None:
    """Every talk is played straight, and again through a save and a load after every move."""
    path = tmp_path / "save.json"
    for episode in range(6):
        talk = list(play_episode(seat(assets, "oracle"), 11, episode))
        state = talk[0].before
        for decision in talk:
            expected = summary(decision.after)
            save_game(path, SavedGame(Afternoon(seed=4), "flea", state))
            saved = load_game(path, BAZAAR, {"flea": assets})
            assert saved.afternoon == Afternoon(seed=4)
            loaded = saved.talk
            assert loaded is not None
            state = choose(assets, loaded, decision.choice)
            assert summary(state) == expected


def test_a_save_cut_anywhere_is_refused_with_its_place_and_left_alone(assets, tmp_path) -> None:
    path = tmp_path / "save.json"
    save_game(path, SavedGame(Afternoon(seed=4), "flea", start_talk(assets, first_item(assets), 5, purse=9000)))
    whole = path.read_bytes()
    for cut in range(0, len(whole) - 1, 97):
        path.write_bytes(whole[:cut])
        with pytest.raises(BadInput, match=r"save\.json"):
            load_game(path, BAZAAR, {"flea": assets})
        assert path.read_bytes() == whole[:cut]


@pytest.mark.parametrize(
    ("pointer", "value"),
    [
        (("talk", "bargain", "ask"), 7),
        (("talk", "feeling", "felt"), [0, 0, 0]),
        (("talk", "feeling", "felt"), [0, 0, 0, 0, 0, "joy"]),
        (("talk", "item"), "../../etc/passwd"),
        (("afternoon", "purse"), -1),
        (("afternoon", "purse"), True),
        (("version",), 99),
        (("talk", "story"), {"stall": 3}),
        (("talk", "answer"), None),
    ],
)
def test_a_save_with_nonsense_inside_names_the_value(assets, tmp_path, pointer, value) -> None:
    path = tmp_path / "save.json"
    save_game(path, SavedGame(Afternoon(seed=4), "flea", start_talk(assets, first_item(assets), 5, purse=9000)))
    data = json.loads(path.read_text(encoding="utf-8"))
    inner = data
    for key in pointer[:-1]:
        inner = inner[key]
    inner[pointer[-1]] = value
    path.write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(BadInput) as caught:
        load_game(path, BAZAAR, {"flea": assets})
    assert f":/{pointer[0]}" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_moves_that_are_not_on_the_table_are_refused(assets) -> None:
    state = start_talk(assets, first_item(assets), 5, purse=100)
    with pytest.raises(BadInput, match="choice"):
        choose(assets, state, Choice("no_such_choice"))
    with pytest.raises(BadInput, match="purse"):
        choose(assets, state, Choice("offer", 110))
    with pytest.raises(BadInput, match="an offer"):
        choose(assets, state, Choice("offer"))


def test_an_afternoon_books_its_talks(assets) -> None:
    afternoon = Afternoon(seed=9)
    item = first_item(assets)
    state = visit_stall(assets, afternoon, item)
    state = choose(assets, state, Choice("offer", ask_money(state.list_price, state.bargain.ask)))
    assert state.deal_price == state.list_price
    after = finish_talk(BAZAAR, assets, afternoon, state, minutes=12)
    assert after.owned("flea") == {item}
    assert after.purse == afternoon.purse - state.deal_price
    assert after.talks == 1
    assert after.minutes == 12
    again = visit_stall(assets, after, sorted(assets.script.items)[1])
    assert again.visit == 2


def test_autoplay_writes_the_same_bytes_for_the_same_seed(tmp_path, capsys) -> None:
    logs = []
    for name in ("a.jsonl", "b.jsonl"):
        path = tmp_path / name
        code = main(["autoplay", "--episodes", "60", "--policy", "random", "--seed", "1", "--out", str(path), "--json"])
        assert code == 0
        logs.append(path.read_bytes())
    assert logs[0] == logs[1]
    rows = [json.loads(line) for line in logs[0].splitlines()]
    assert {row["episode"] for row in rows} == set(range(60))
    assert all(set(row["felt"]) == set(row["shown"]) for row in rows)
    first, second = (json.loads(line) for line in capsys.readouterr().out.splitlines())
    assert first == second
    assert not list(tmp_path.glob("*.part"))


def test_reading_wins(capsys) -> None:
    surplus = {}
    for policy in ("random", "oracle"):
        assert main(["autoplay", "--episodes", "250", "--policy", policy, "--seed", "1", "--json"]) == 0
        data = json.loads(capsys.readouterr().out)
        surplus[policy] = (data["mean_surplus"], data["mean_surplus_ci95"])
    (low, low_ci), (high, high_ci) = surplus["random"], surplus["oracle"]
    assert high - high_ci > low + low_ci + 0.15


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["autoplay", "--episodes", "0"], "at least 1"),
        (["autoplay", "--stall", "fleaa"], "flea"),
        (["autoplay", "--out", "/no/such/folder/log.jsonl"], "a folder that exists"),
        (["autoplay", "--stall", "/no/such.yaml"], "a dialogue file that exists"),
    ],
)
def test_bad_arguments_give_one_line_and_exit_code_2(capsys, words, says) -> None:
    assert main(words) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert says in error
