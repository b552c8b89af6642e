"""Policies see what their names allow and nothing else, and win what that is worth."""

from __future__ import annotations

import json
import random
from dataclasses import fields, is_dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from game.app.autoplay import play_episode
from game.app.autoplay.episodes import sit_down
from game.app.autoplay.jobs import Job, work
from game.app.content import load_talk_assets, stall_path
from game.app.loading import load_planner
from game.app.policies import (
    COMPARED,
    NAMES,
    Acquaintance,
    Belief,
    BodyReading,
    BodyView,
    Eyes,
    FaceReading,
    FaceView,
    OracleView,
    ReaderView,
    Table,
    WordsView,
    custom,
    mixture_of,
    seat,
)
from game.app.talk import Choice, choose
from game.core.emotion_space import EMOTIONS
from game.core.errors import BadInput
from game.emotion import shown_values

TABLE = {
    "item", "list_price", "ask", "purse", "offer", "answer", "round", "rounds", "tidying", "lines",
}  # fmt: skip
SEES = {
    "table": (Table, TABLE),
    "words": (WordsView, {"table", "said", "told"}),
    "face": (FaceView, {"table", "parts", "valence", "arousal"}),
    "body": (BodyView, {"table", "signs", "quiet"}),
    "reader": (ReaderView, {"table", "said", "told", "parts", "valence", "arousal", "signs", "quiet"}),
    "oracle": (OracleView, {"table", "felt"}),
}


@pytest.fixture(scope="module")
def assets():
    return load_talk_assets(stall_path("flea"))


@pytest.fixture(scope="module")
def library():
    return load_planner().library


def with_person(assets, name: str, **changes):
    return replace(assets, person=replace(assets.feelings.temperaments[name], **changes))


def leaves(value: object) -> list[object]:
    if is_dataclass(value):
        return [leaf for field in fields(value) for leaf in leaves(getattr(value, field.name))]
    if isinstance(value, dict):
        return [leaf for item in value.values() for leaf in leaves(item)]
    if isinstance(value, tuple):
        return [leaf for item in value for leaf in leaves(item)]
    return [value]


@pytest.mark.parametrize("kind", sorted(SEES))
def test_a_view_has_what_its_name_allows_and_nothing_else(assets, library, kind: str) -> None:
    eyes = Eyes(assets, {unit.name: unit.layer for unit in library.units})
    signs = eyes.signs({unit.name: None for unit in library.units[5:8]})
    for episode in range(8):
        talk = sit_down(seat(assets, "random"), 4, episode)
        talk.decide()
        if talk.state.ended:
            continue
        view = eyes.view(kind, talk.state, signs, signs)
        made, names = SEES[kind]
        assert type(view) is made
        assert {field.name for field in fields(view)} == names
        found = leaves(view)
        hidden = [talk.state.bargain.lowest, talk.state.bargain.patience, talk.state.bargain.trust]
        hidden += [round(talk.state.bargain.lowest * talk.state.list_price)]
        if kind != "oracle":
            hidden += [v for v in talk.state.feeling.six if v > 0.0]
        assert not set(hidden) & {leaf for leaf in found if isinstance(leaf, float | int)}
        if kind in {"table", "words", "body"}:
            assert not [leaf for leaf in found if isinstance(leaf, float)]


def test_what_is_not_in_the_view_changes_no_move(assets) -> None:
    """The same table with another lowest price behind it, and another feeling behind a whole mask."""
    masked = with_person(assets, "trader", mask=1.0)
    for name in ("random", "fixed", "words", "face", "oracle"):
        place = seat(masked, name)
        for episode in range(4):
            one, other = sit_down(place, 6, episode), sit_down(place, 6, episode)
            other.state = replace(other.state, bargain=other.state.bargain._replace(lowest=0.61))
            if name != "oracle":
                six = tuple(np.roll(other.state.feeling.six, 1).tolist())
                other.state = replace(other.state, feeling=other.state.feeling._replace(six=six))
            moves = [talk.player.move(place.eyes.view(place.sees, talk.state)) for talk in (one, other)]
            assert moves[0] == moves[1]


def test_words_are_told_only_where_a_line_tells_them(assets) -> None:
    eyes, told = Eyes(assets), []
    for episode in range(40):
        for decision in play_episode(seat(assets, "random"), 2, episode):
            said = eyes.told(decision.after)
            told.append(said)
            if said:
                assert said == dict(decision.after.record)["quality"]
    assert 0.3 < sum(map(bool, told)) / len(told) < 0.75


def test_a_line_that_is_said_to_land_tells_what_was_felt(assets) -> None:
    known = Acquaintance(assets)
    belief = Belief(known)
    belief.now = np.full(7, 1 / 7)
    belief.pass_line("joke", "right", "none")
    joy, anger = belief.now[EMOTIONS.index("joy")], belief.now[EMOTIONS.index("anger")]
    assert joy > 3 * anger
    assert belief.chance("praise", "right") > 0.5
    assert belief.now.sum() == pytest.approx(1.0)


def test_bodies_are_read_by_what_the_repertoire_shows(library) -> None:
    """The units that are most an emotion's own, together, name it."""
    reading = BodyReading(library)
    for label in range(7):
        share = library.intensity[:, label] / (library.intensity.sum(axis=1) + 0.3)
        best = np.argsort(-share)[:4]
        signs = [(library.units[i].layer, library.units[i].name) for i in best]
        assert int(np.argmax(reading.log_likelihood(signs))) == label
    habit = {library.units[i].name: 1.0 for i in range(len(library.units))}
    silent = BodyReading(library, habit).log_likelihood(signs)
    assert silent == pytest.approx(np.full(7, silent[0]))


def test_a_face_taken_at_its_word_is_fooled_by_a_mask_and_one_that_is_known_is_not(assets) -> None:
    collector = with_person(assets, "collector")
    known, eye = Acquaintance(collector), Eyes(collector).face_eye
    naive, knowing = (FaceReading.of(known, eye, masked=masked) for masked in (False, True))
    right = {"naive": 0, "knowing": 0}
    moods = [(label, shows) for label in range(6) for shows in (2, 6)]
    for label, shows in moods:
        feeling = known.feeling(label, 0.6)._replace(mask_shows=shows)
        drawn = eye.drawn(shown_values(collector.person, feeling))
        for name, reading in (("naive", naive), ("knowing", knowing)):
            right[name] += int(reading.log_likelihood(drawn).max(axis=0).argmax()) == label
    assert right["knowing"] >= right["naive"] + 3


def test_seeing_more_wins_more(assets) -> None:
    mean = {}
    for name in ("random", "fixed", "words", "oracle"):
        place = seat(assets, name)
        ends = [list(play_episode(place, 8, episode))[-1].after for episode in range(120)]
        mean[name] = float(np.mean([end.surplus for end in ends]))
    assert mean["random"] + 0.1 < mean["words"] < mean["oracle"]
    assert mean["fixed"] + 0.15 < mean["oracle"]


def test_policies_meet_the_same_moods_and_prices(assets) -> None:
    talks = [sit_down(seat(assets, name), 3, 5) for name in ("random", "fixed", "oracle")]
    assert len({(t.state.item, t.state.seed, t.state.bargain, t.state.feeling.six) for t in talks}) == 1


# --- asking for policies ---------------------------------------------------------------------------------------------
def test_mixtures_are_drawn_by_their_shares() -> None:
    mixture = mixture_of("random:1,reader:3")
    assert mixture.shares == (("random", 0.25), ("reader", 0.75))
    assert [mixture.draw(x) for x in (0.0, 0.24, 0.26, 0.999)] == ["random", "random", "reader", "reader"]
    assert mixture_of(str(mixture)) == mixture
    assert mixture_of("script:moves.yaml").shares == (("script:moves.yaml", 1.0),)
    assert mixture_of("script:moves.yaml:2,words:2").shares[0] == ("script:moves.yaml", 0.5)


@pytest.mark.parametrize("text", ["random:0", "random:-1", ":2", "random:nan"])
def test_shares_that_are_none_are_refused(text: str) -> None:
    with pytest.raises(BadInput, match="--policy"):
        mixture_of(text)


def test_a_script_plays_its_moves(assets, tmp_path: Path) -> None:
    path = tmp_path / "moves.yaml"
    path.write_text("moves:\n  - {choice: wait}\n  - {act: offer, share: 0.5}\n  - {choice: offer, offer: ask}\n")
    talk = list(play_episode(seat(assets, f"script:{path}"), 1, 2))
    price = talk[0].before.list_price
    assert [d.choice.id for d in talk[:3]] == ["wait", "offer", "offer"][: len(talk)]
    assert talk[1].choice.offer == round(price * 0.5 / 10) * 10
    assert talk[-1].after.deal_price > 0
    path.write_text("moves:\n  - {choice: wait, act: joke}\n")
    with pytest.raises(BadInput, match=r"moves\.yaml:2:5"):
        seat(assets, f"script:{path}")


OWN = """
SEES = "words"
import math

def move(view, memory, rng):
    memory["moves"] = memory.get("moves", 0) + 1
    lines = view["table"]["lines"]
    if memory["moves"] == 3:
        return {"choice": "offer", "offer": view["table"]["ask"]}
    return {"choice": lines[int(rng.random() * len(lines) * math.cos(0))]["id"] if lines[0]["id"] else "wait",
            "offer": view["table"]["ask"] - 10}
"""


def test_an_own_policy_plays_from_its_view_and_forgets_between_talks(assets, tmp_path: Path) -> None:
    path = tmp_path / "own.py"
    path.write_text(OWN)
    place = seat(assets, str(path))
    assert place.sees == "words"
    talks = [[d.choice for d in play_episode(place, 1, episode)] for episode in range(4)]
    again = [[d.choice for d in play_episode(seat(assets, str(path)), 1, episode)] for episode in range(4)]
    assert talks == again
    assert all(isinstance(choice, Choice) for talk in talks for choice in talk)
    assert all(len(talk) <= 3 for talk in talks)


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("import os", "import of os"),
        ("from subprocess import run", "import of subprocess"),
        ("x = ().__class__", "__class__"),
        ("x = open('/etc/passwd')", "the name open"),
        ("x = '{0.x}'.format(1)", "the attribute format"),
        ("x = (lambda: 0)._secret", "_secret"),
        ("from collections import _sys", "begins with an underscore"),
        ("from math import __loader__ as x", "begins with an underscore"),
        ("match ():\n    case tuple(__class__=x): pass", "the attribute __class__"),
        ("match '{0.x}':\n    case str(format=x): pass", "the attribute format"),
        ("async def f():\n    return c.cr_frame", "the attribute cr_frame"),
        ("def f(frame):\n    return frame.f_back", "the attribute f_back"),
        ("SEES = 'everything'", "table | words"),
        ("def move(", "Python"),
    ],
)
def test_an_own_policy_that_reaches_out_is_refused_with_its_line(tmp_path: Path, body: str, says: str) -> None:
    path = tmp_path / "own.py"
    path.write_text(f'SEES = "table"\ndef move(view, memory, rng):\n    return {{}}\n{body}\n')
    with pytest.raises(BadInput) as caught:
        custom.OwnPolicy.load(path)
    assert says in str(caught.value)
    assert "own.py" in str(caught.value)


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("    while True: pass", "within 0.6 s"),
        ("    return {'choice': 'wait', 'offer': 'much'}", "whole number"),
        ("    return 1 / 0", r"own\.py:3: policy: expected a move but saw 'ZeroDivisionError.*episode 0, move 1 of"),
        ("    raise SystemExit(3)", "SystemExit: 3"),
        ("    return None", "move gave None"),
        ("    return {'choice': 'x' * 20000}", "an answer of 20014 characters"),
        ("    return {'choice': 'dance'}", r"saw 'dance' \(episode 0, move 1 of"),
        ("    x = [0] * 10**9", "MemoryError"),
    ],
)
def test_an_own_policy_that_fails_is_told_in_one_line(assets, tmp_path: Path, monkeypatch, body, says) -> None:
    if "while" in body:
        monkeypatch.setattr(custom, "MOVE_S", 0.6)
    path = tmp_path / "own.py"
    path.write_text(f'SEES = "table"\ndef move(view, memory, rng):\n{body}\n')
    with pytest.raises(BadInput, match=says) as caught:
        list(play_episode(seat(assets, str(path)), 1, 0))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "reach",
    [
        "import dataclasses\nx = dataclasses.builtins",
        "import dataclasses\nx = dataclasses.sys.modules",
        "import dataclasses\nx = dataclasses.make_dataclass",
        "import functools\nx = functools.update_wrapper",
        "import statistics\nx = statistics.random",
        "import collections\nx = collections.abc",
        "x = id(1)",
        "x = print",
    ],
)
def test_what_modules_import_themselves_is_not_handed_on(tmp_path: Path, reach: str) -> None:
    path = tmp_path / "own.py"
    path.write_text(f'SEES = "table"\n{reach}\ndef move(view, memory, rng):\n    return {{"choice": "got out"}}\n')
    with pytest.raises(BadInput, match=r"AttributeError|NameError|is not allowed"):
        ask(custom.OwnPolicy.load(path).sit(random.Random(1)))


def ask(player) -> dict[str, object]:
    return player.process.ask(player.talk, {})


HOARDER = """
SEES = "table"
import collections, functools, math, statistics
seen = []

@functools.cache
def first(number):
    return len(seen)

class Kept:
    talks = 0

def move(view, memory, rng):
    counts = [len(seen), Kept.talks, len(memory)]
    for thing in (math, collections, collections.Counter, collections.Counter.update, statistics.mean):
        counts.append(thing.kept if hasattr(thing, "kept") else 0)
        thing.kept = 1
    seen.append(1)
    Kept.talks += 1
    memory["a"] = 1
    return {"choice": ",".join(str(n) for n in counts)}
"""


SIDE_BY_SIDE = """
SEES = "body"
def move(view, memory, rng):
    memory["moves"] = memory.get("moves", 0) + 1
    assert memory["moves"] == view["table"]["round"] + 1, "the memory of another talk"
    lines = [line["id"] for line in view["table"]["lines"] if line["act"] not in ("offer", "leave", "wait")]
    return {"choice": lines[int(rng.random() * len(lines))]}
"""


def test_own_policies_side_by_side_have_each_their_memory_and_chance(tmp_path: Path, monkeypatch) -> None:
    """Those who look at bodies are played so: what a talk comes to must not hang on how many are played with it."""
    monkeypatch.setattr(custom, "TALKS", 3)
    path = tmp_path / "own.py"
    path.write_text(SIDE_BY_SIDE)
    rows = [work(Job(0, "flea", str(path), 3, 0, count, True, log="plain")).rows for count in (2, 5)]
    first = [row for row in rows[1].splitlines() if json.loads(row)["episode"] < 2]
    assert rows[0].splitlines() == first


def test_an_own_policy_leaves_no_folder_behind_when_nobody_ends_it(tmp_path: Path) -> None:
    """As in the worker of a pool, which ends without a word."""
    path = tmp_path / "own.py"
    path.write_text(OWN)
    player = custom.OwnPolicy.load(path).sit(random.Random(1))
    process = player.process
    folder = Path(process.folder.name)
    assert folder.is_dir()
    process.popen.stdin.close()
    assert process.popen.wait(30) == 0
    assert not folder.exists()


def test_nothing_an_own_policy_hoards_outlasts_a_talk(tmp_path: Path) -> None:
    """Which worker plays which talks must not matter, so no talk may know of another."""
    path = tmp_path / "own.py"
    path.write_text(HOARDER)
    policy = custom.OwnPolicy.load(path)
    for _ in range(3):
        player, beside = (policy.sit(random.Random(seed)) for seed in (1, 2))
        assert ask(player) == {"choice": ",".join("0" * 8)}
        # Its own things it may remember within a talk, also while others are played side by side.
        assert ask(player) == {"choice": "1,1,1,1,1,0,0,0"}
        assert ask(beside) == {"choice": ",".join("0" * 8)}


def test_moves_that_are_not_on_the_table_are_refused_whoever_makes_them(assets) -> None:
    talk = sit_down(seat(assets, "random"), 1, 0)
    with pytest.raises(BadInput, match="choice"):
        choose(assets, talk.state, Choice("nothing_like_it"))
    assert set(NAMES) >= {"random", "fixed", "words", "face", "body", "reader", "oracle"}
    assert random.Random("talk 1 0").random() == random.Random("talk 1 0").random()


def test_the_explorer_comes_where_good_players_seldom_come(assets) -> None:
    def odd(name: str) -> tuple[int, int]:
        """Talks in which one kind of line was said three times or more; lines that landed wrong."""
        place, stubborn, wrong = seat(assets, name), 0, 0
        for episode in range(40):
            records = [dict(d.after.record) for d in play_episode(place, 4, episode)]
            acts = [r["act"] for r in records if r["act"] not in {"wait", "offer"}]
            stubborn += any(acts.count(act) >= 3 for act in acts)
            wrong += sum(r["quality"] == "wrong" for r in records)
        return stubborn, wrong

    (stubborn, wrong), (seldom, never) = odd("explorer"), odd("oracle")
    assert stubborn > 3 + seldom
    assert wrong > 12 + never
    assert "explorer" not in COMPARED, "it plays to come everywhere, not to win"
