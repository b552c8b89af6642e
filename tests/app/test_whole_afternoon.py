"""Whole afternoons over the three stalls as the game has them, saved and taken up again at every screen on the way."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest

from game.app.afternoon import Afternoon
from game.app.bazaar import load_bazaar
from game.app.content import load_talk_assets, stall_path
from game.app.loading import load_step_assets
from game.app.market import Market, Stall
from game.app.opening import resume_game
from game.app.recording.digests import talk_digest
from game.app.saves import game_to_dict, save_game
from game.app.score import load_epilogue, score_of
from game.app.session import Session, saved_game
from game.app.settings import Settings
from game.app.step import new_world
from game.app.strings import load_strings
from game.app.talk import Choice, TalkState, ask_money
from game.app.world import Intent, leave_talk

SEED = 11
STALLS = ("flea", "antiques", "toys")


@pytest.fixture(scope="module")
def start() -> Callable[[], Session]:
    """The game as it starts: a market of three open stalls, nothing taken up."""
    base = load_step_assets(body=False)
    stalls = {name: Stall(name, replace(base, talk=load_talk_assets(stall_path(name)))) for name in STALLS}
    market, strings, first = Market(load_bazaar(), stalls, expected=STALLS), load_strings("en"), stalls["flea"].assets

    def started() -> Session:
        world = leave_talk(new_world(first, SEED, text_speed="instant"))
        return Session(first, world, strings, Settings(), Afternoon(seed=SEED), market)

    return started


@dataclass(frozen=True)
class Visit:
    """A talk at a stall about one of the things that are still there, wished ones first."""

    stall: str
    number: int
    move: Callable[[TalkState], Choice]


@dataclass
class Play:
    """A play and its diary. leaves: what happens at every screen: nothing, or off and on again."""

    session: Session
    leaves: Callable[[Session], Session]
    places: list[str] = field(default_factory=list)
    diary: list[str] = field(default_factory=list)

    def stand(self, place: str) -> None:
        """A screen was reached: note what a save holds, then leave the game, perhaps."""
        before = written(self.session)
        self.session = self.leaves(self.session)
        assert written(self.session) == before, f"not taken up as it was left: {place}"
        self.places.append(place)
        self.diary.append(before)

    def talk(self, item: str, move: Callable[[TalkState], Choice]) -> TalkState:
        """A talk from the greeting to the debrief."""
        self.session.begin_talk(item)
        self.stand("talk")
        last = self.session.world.talk
        while self.session.world.talk is not None and not self.session.world.over:
            world = self.session.world
            if world.waiting:
                assert world.talk is not None
                self.session.tick(Intent(choice=move(world.talk)))
                last = self.session.world.talk
                if last is not None and not last.ended:
                    self.stand("talk")
            else:
                self.session.tick(Intent(proceed=True))
        assert last is not None
        self.diary.append(talk_digest(last))
        booked = written(self.session)
        if self.session.world.talk is not None:
            assert self.session.world.over
            # Whoever leaves while the last words stand has had this talk all the same.
            other = self.leaves(self.session)
            assert written(other) == booked
            self.session.end_talk()
        self.stand("debrief")
        assert self.diary[-1] == booked
        return last


def written(session: Session) -> str:
    return json.dumps(game_to_dict(saved_game(session)), ensure_ascii=False, sort_keys=True)


def afternoon(play: Play, visits: list[Visit]) -> list[TalkState]:
    """Talks at one stall after the other, with a cup of tea after each, until the evening."""
    play.session.open_day()
    play.stand("list")
    talks = []
    for visit in visits:
        if visit.stall != play.session.stall:
            play.session.walk_to(visit.stall)
        play.stand("street")
        here = play.session.afternoon
        items = [i for i in play.session.assets.talk.script.items if i not in here.owned(visit.stall)]
        items.sort(key=lambda item: not here.wished(visit.stall, item))
        play.stand("table")
        talks.append(play.talk(items[visit.number], visit.move))
        play.session.pause()
    play.stand("evening")
    return talks


def buyer(opens: float, step: float, closes: int) -> Callable[[TalkState], Choice]:
    """Says the first line there is, offers more each time, takes the price in the end."""

    def move(talk: TalkState) -> Choice:
        lines = [c for c in talk.beat.choices if c.available and c.act not in {"leave", "wait", "offer"}]
        ask = min(ask_money(talk.list_price, talk.bargain.ask), talk.purse)
        offer = round((opens + step * talk.bargain.round) * talk.list_price / 10) * 10
        line = lines[0].id if lines else "offer"
        return Choice(line, ask if talk.bargain.round >= closes else min(offer, ask))

    return move


def insulting(talk: TalkState) -> Choice:
    """The hardest line with a tenth of the price, every time."""
    ranks = {"press": 0, "flaw": 1, "joke": 2}
    lines = [c for c in talk.beat.choices if c.available and c.act not in {"leave", "wait", "offer"}]
    return Choice(min(lines, key=lambda c: ranks.get(c.act, 9)).id, round(talk.list_price / 100) * 10)


def leaving(talk: TalkState) -> Choice:
    """A look, a silence, and off."""
    return Choice("wait" if talk.bargain.round == 0 else "leave")


@pytest.fixture
def play(start, tmp_path: Path) -> Callable[[list[Visit]], tuple[Play, list[TalkState]]]:
    """Plays an afternoon twice, in one go and leaving the game at every screen; both tell the same, byte for byte."""

    def off_and_on(session: Session) -> Session:
        path = tmp_path / "game.json"
        save_game(path, saved_game(session))
        again = start()
        resume_game(again, path)
        return again

    def both(visits: list[Visit]) -> tuple[Play, list[TalkState]]:
        whole, pieces = Play(start(), lambda session: session), Play(start(), off_and_on)
        talks = afternoon(whole, visits)
        afternoon(pieces, visits)
        assert pieces.places == whole.places
        assert pieces.diary == whole.diary
        return whole, talks

    return both


def evening(session: Session) -> tuple[int, str]:
    """The points, and what is told in both languages."""
    day, market = session.afternoon, session.market
    texts = load_epilogue()
    told = [
        "\n".join(texts.tell(market.bazaar, day, market.order, market.wishes, language, session.money(day.purse)))
        for language in ("en", "ja")
    ]
    assert all(text and "{" not in text for text in told)
    return score_of(day).total, told[0]


def test_a_buyer_comes_home_with_a_list_ticked_off_and_remembers_everybody(play) -> None:
    visits = [
        Visit("flea", 0, buyer(0.6, 0.08, 2)), Visit("antiques", 0, leaving),
        Visit("toys", 0, buyer(0.7, 0.1, 1)), Visit("flea", 0, leaving), Visit("flea", 0, buyer(0.6, 0.1, 1)),
    ]  # fmt: skip
    whole, talks = play(visits)
    session, day = whole.session, whole.session.afternoon
    assert Counter(whole.places)["talk"] > 8
    assert set(whole.places) == {"list", "street", "table", "talk", "debrief", "evening"}
    bought = [talk.deal_price for talk in talks if talk.deal_price]
    assert len(bought) >= 3
    assert day.purse == day.budget - sum(bought) >= 0
    assert [b.price for b in day.bought] == bought
    assert any(day.wished(b.stall, b.item) for b in day.bought)
    bazaar = session.market.bazaar
    walked = (1 + 1 + 2) * bazaar.costs.walk + 5 * bazaar.costs.pause + 5 * bazaar.costs.arrive
    assert day.minutes > walked + 5 * bazaar.costs.wait, "the clock goes on with every walk, pause and exchange"
    assert [talk.visit for talk in talks] == [1, 1, 1, 2, 3], "who comes back is known"
    assert day.at("flea").talks == 3
    points, told = evening(session)
    assert points > 0
    session.open_day(again=True)
    tomorrow = session.afternoon
    assert tomorrow.day == 2
    assert tomorrow.minutes == 0
    assert {f"{b.stall}/{b.item}" for b in day.bought} == set(tomorrow.home)
    assert tomorrow.at("antiques").memory == day.at("antiques").memory
    assert not any(f"{wish.stall}/{wish.item}" in tomorrow.home for wish in tomorrow.wishes)
    assert evening(session)[1] != told


def test_who_is_thrown_out_and_walks_away_goes_home_with_a_full_purse(play) -> None:
    visits = [
        Visit("antiques", 0, insulting), Visit("antiques", 0, insulting), Visit("toys", 0, leaving),
        Visit("toys", 1, insulting), Visit("flea", 0, leaving),
    ]  # fmt: skip
    whole, talks = play(visits)
    session, day = whole.session, whole.session.afternoon
    outcomes = [dict(talk.record)["outcome"] for talk in talks]
    assert outcomes.count("out_of_patience") >= 2
    assert "walked_away" in outcomes
    assert str(talks[0].beat.ended) == "insulted"
    assert talks[1].bargain.patience < talks[0].bargain.patience + 7, "and they have not forgotten it"
    assert not day.bought
    assert day.purse == day.budget
    assert day.at("antiques").annoyance > day.at("flea").annoyance - 1 >= -1
    points, told = evening(session)
    session.open_day(again=True)
    assert session.afternoon.day == 2
    assert session.afternoon.at("antiques").annoyance == 0, "a night passes"
    assert session.afternoon.at("antiques").memory is not None
    assert points < 20
    assert told
