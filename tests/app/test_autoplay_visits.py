"""Episodes of several visits: the game's own afternoon, remembered, the same for any number of workers."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from game.app.autoplay.executors import Crew
from game.app.autoplay.jobs import Job, Result, work
from game.app.autoplay.outings import Outing, Street, play_outing, play_outings_with_bodies
from game.app.autoplay.progress import Progress
from game.app.autoplay.runs import Plan, Run, play
from game.app.bazaar import load_bazaar
from game.app.body import BodyObserver
from game.app.cli import main
from game.app.content import load_talk_assets, stall_path
from game.app.policies import Seat, seat

PLAN = Plan(("toys",), ("random:1,oracle:1",), 8, 5, log="plain", cover=True, per_job=2, visits=3)


def quiet(total: int, done: int = 0) -> Progress:
    return Progress(total, done, show=False)


def rows_of(path: Path) -> list[dict]:
    return [json.loads(row) for row in path.read_text(encoding="utf-8").splitlines()]


@pytest.fixture(scope="module")
def toys() -> Seat:
    return seat(load_talk_assets(stall_path("toys")), "oracle")


@pytest.fixture(scope="module")
def street() -> Street:
    guests = tuple(seat(load_talk_assets(stall_path(name)), "random") for name in ("flea", "antiques"))
    return Street(load_bazaar(), guests)


@pytest.fixture(scope="module")
def straight(tmp_path_factory) -> tuple[Path, Run]:
    path = tmp_path_factory.mktemp("visits") / "log.jsonl"
    run = play(PLAN, Crew(), out=path, progress=quiet)
    assert run.talks == PLAN.talks == 24
    return path, run


def test_first_visits_are_the_talks_that_are_played_without_any_other(straight, tmp_path: Path) -> None:
    path, run = straight
    rows = rows_of(path)
    assert {row["visit"] for row in rows} == {1, 2, 3}
    alone = tmp_path / "alone.jsonl"
    once = play(Plan(PLAN.stalls, PLAN.populations, 8, 5, log="plain", per_job=2), Crew(), out=alone, progress=quiet)
    assert [{k: v for k, v in row.items() if k != "visit"} for row in rows if row["visit"] == 1] == rows_of(alone)
    population = PLAN.populations[0]
    assert run.total("toys", population) == once.total("toys", population)
    assert run.total("toys", population, later=True).talks == 16
    assert once.returns == {}


def test_two_workers_or_a_stop_in_between_give_the_same_bytes(straight, tmp_path: Path) -> None:
    path, run = straight

    class Stopping(Crew):
        def results(self, jobs: Iterator[Job]) -> Iterator[Result]:
            for at, job in enumerate(jobs):
                if at == 2:
                    raise KeyboardInterrupt
                yield work(job)

    many, gone_on = tmp_path / "many.jsonl", tmp_path / "gone_on.jsonl"
    assert play(PLAN, Crew(2), out=many, progress=quiet).to_dict() == run.to_dict()
    stopped = play(PLAN, Stopping(), out=gone_on, progress=quiet)
    assert (stopped.whole, stopped.talks) == (False, 12)
    resumed = play(PLAN, Crew(), out=gone_on, resume=True, progress=quiet)
    assert json.dumps(resumed.to_dict(), sort_keys=True) == json.dumps(run.to_dict(), sort_keys=True)
    assert path.read_bytes() == many.read_bytes() == gone_on.read_bytes()


def test_an_afternoon_goes_by_the_rules_of_the_game(toys: Seat, street: Street) -> None:
    days, news = set(), set()
    for episode in range(20):
        outing = Outing(toys, street, 3, episode)
        for visit in range(1, 6):
            before = outing.afternoon
            assert outing.talk.state.visit == visit
            assert outing.talk.state.item not in before.owned("toys")
            assert outing.talk.state.purse == before.purse
            while not outing.talk.state.ended:
                outing.talk.decide()
            last = outing.talk.state
            outing.come_back()
            after = outing.afternoon
            days.add(after.day)
            news.update(name for name, value in outing.talk.state.story.variables.items() if "_news" in name and value)
            if last.deal_price:
                assert last.item in after.owned("toys") or (after.day > before.day and not after.home)
            if after.day == before.day:
                assert after.purse <= last.purse
                assert after.minutes > before.minutes
    assert min(days) == 1
    assert max(days) > 1, "what is too much for one afternoon goes on with the next"
    assert {"flea_news", "antiques_news", "toys_news"} <= news


def test_who_comes_back_is_met_as_such_and_finds_what_was_put_aside(toys: Seat, street: Street) -> None:
    endings, nodes, kept = set(), set(), set()
    for episode in range(80):
        for visit, decisions in enumerate(play_outing(toys, street, 1, episode, 4), 1):
            first, last = decisions[0].before, decisions[-1].after
            if visit == 1:
                assert not any(node.startswith("again") for node in first.story.visits)
            nodes.update(first.story.visits)
            endings.add(last.beat.ended)
            kept.update(line.id for line in first.beat.lines)
    assert {"again", "again_same", "again_other", "again_price"} <= nodes
    assert {"left_friends", "walked_away"} <= endings
    assert "again_lunch" in kept


def test_bodies_side_by_side_play_what_each_plays_alone(toys: Seat, street: Street) -> None:
    observer = BodyObserver.load(explain=False)
    place = seat(toys.assets, "oracle", library=observer.planner.library)
    together = list(play_outings_with_bodies(observer, [place] * 3, street, 2, 0, 2))
    alone = next(play_outings_with_bodies(observer, [place], street, 2, 2, 2))
    unseen = play_outing(toys, street, 2, 2, 2)
    for a, b, c in zip(together[2], alone, unseen, strict=True):
        assert [d.choice for d in a] == [d.choice for d in b] == [d.choice for d in c]
        assert [d.shown for d in a] == [d.shown for d in b]
    assert [d.seen for d in alone[0]] != [d.seen for d in alone[1]]


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--visits", "0"], "1 to 20"),
        (["--visits", "2", "--search", "fixed"], "first visits alone"),
        (["--visits", "2", "--require", "{}"], "wanted.yaml:1:9: expected 3 visits an episode"),
    ],
)
def test_visits_that_make_no_sense_give_one_line(tmp_path: Path, capsys, words: list[str], says: str) -> None:
    wanted = tmp_path / "wanted.yaml"
    wanted.write_text("visits: 3\ncoverage: {nodes: 1}\n", encoding="utf-8")
    assert main(["autoplay", "--episodes", "3", *(str(wanted) if word == "{}" else word for word in words)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert says in error
