"""The street of three stalls: walking, the clock, the list, what does not open, and the day after."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from game.app.afternoon import Afternoon, finish_talk, is_closed, next_day, open_day, pass_time, visit_stall, walk_to
from game.app.bazaar import load_bazaar
from game.app.content import load_talk_assets
from game.app.loading import load_step_assets
from game.app.market import LeftOut, Market, StallLoader
from game.app.strings import load_strings
from game.app.talk import Choice, ask_money, choose
from game.app.wishes import load_wishes
from game.core.errors import BadInput, Where
from tests.app.market_kit import NAMES, copies, three_stalls

BAZAAR = load_bazaar()


@pytest.fixture(scope="module")
def scripts(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dialogue")
    return [load_talk_assets(path).script for path in copies(folder).values()]


def test_a_day_has_a_list_across_the_stalls_and_a_purse_that_does_not_quite_do(scripts) -> None:
    lists = set()
    for seed in range(40):
        day = open_day(BAZAAR, scripts, seed)
        assert day == open_day(BAZAAR, scripts, seed)
        assert len(set(day.wishes)) == BAZAAR.wish_count
        per_stall = [sum(w.stall == name for w in day.wishes) for name in NAMES]
        assert max(per_stall) <= BAZAAR.wishes_per_stall
        prices = {(s.stall, i.id): i.list_price for s in scripts for i in s.items.values()}
        total = sum(prices[w.stall, w.item] for w in day.wishes)
        assert day.purse < total or day.purse == 3000, "whoever pays the tags cannot buy everything"
        assert day.purse > 0.55 * total, "and whoever reads well can"
        lists.add(day.wishes)
    assert len(lists) > 30


def test_walking_waiting_and_talking_take_time_and_anger_cools(scripts) -> None:
    day = replace(open_day(BAZAAR, scripts, 3), place="flea")
    there = walk_to(BAZAAR, day, "toys")
    assert there.minutes == 2 * BAZAAR.costs.walk
    assert there.place == "toys"
    cross = replace(there, stalls={"toys": replace(there.at("toys"), annoyance=2.0)})
    later = pass_time(BAZAAR, cross, BAZAAR.cooling_min)
    assert later.at("toys").annoyance == pytest.approx(1.0)
    assert not is_closed(BAZAAR, later)
    assert is_closed(BAZAAR, pass_time(BAZAAR, later, BAZAAR.length_min))
    assert BAZAAR.day_share(later.minutes) == pytest.approx(later.minutes / BAZAAR.length_min)


def test_a_shopkeeper_who_was_refused_is_shorter_of_patience_until_time_has_passed(tmp_path, scripts) -> None:
    assets = load_talk_assets(copies(tmp_path)["flea"])
    day = open_day(BAZAAR, scripts, 3)
    item = next(iter(assets.script.items))
    talk = choose(assets, visit_stall(assets, day, item), Choice("leave"))
    assert talk.ended
    after = finish_talk(BAZAAR, assets, day, talk, minutes=4)
    assert after.at("flea").annoyance == 1
    soon = visit_stall(assets, after, item)
    late = visit_stall(assets, pass_time(BAZAAR, after, BAZAAR.cooling_min), item)
    assert soon.seed == late.seed
    assert late.bargain.patience > soon.bargain.patience
    assert soon.visit == 2


def test_the_next_day_keeps_memories_and_draws_everything_else_anew(tmp_path, scripts) -> None:
    assets = load_talk_assets(copies(tmp_path)["flea"])
    day = open_day(BAZAAR, scripts, 3)
    item = next(iter(assets.script.items))
    talk = visit_stall(assets, replace(day, purse=99_000), item)
    talk = choose(assets, talk, Choice("offer", ask_money(talk.list_price, talk.bargain.ask)))
    after = finish_talk(BAZAAR, assets, day, talk, minutes=12)
    second = next_day(BAZAAR, scripts, after)
    assert second.day == 2
    assert second.minutes == 0
    assert second.seed != after.seed
    assert second.owned("flea") == {item}
    assert second.at("flea").memory is not None
    assert second.at("flea").annoyance == 0
    assert visit_stall(assets, second, item).bargain.lowest != talk.bargain.lowest


def test_a_stall_with_errors_is_left_out_with_its_reason_and_the_others_play(tmp_path) -> None:
    paths = copies(tmp_path)
    broken = paths["antiques"]
    broken.write_text(broken.read_text(encoding="utf-8").replace("start: hello", "start: helo"), encoding="utf-8")
    base = load_step_assets(str(paths["flea"]), body=False)
    market = Market.single(base)
    loader = StallLoader(market, [str(paths["antiques"]), str(paths["toys"])], base)
    loader.finish()
    assert "flea" in market.stalls
    assert "antiques" not in market.stalls
    assert "toys" in set(market.stalls) | {name.rpartition("/")[2].partition(".")[0] for name in market.left_out}
    reason = market.left_out[str(broken)]
    assert "\n" not in reason.detail
    for language, says in (("en", "mistake in its script"), ("ja", "台本に誤り")):
        words = load_strings(language)(reason.kind, place=reason.place)
        assert says in words
        assert re.search(r"antiques\.yaml:\d+:\d+", words), "who can mend it is told where"
    unseen = LeftOut.of("toys", BadInput("no mesh", where=Where("/x/assets/stalls/toys.glb", pointer="/meshes/0")))
    assert (unseen.kind, unseen.place) == ("stall_unreadable", "toys.glb")
    gone = LeftOut.of("toys", FileNotFoundError(2, "No such file", "/x/dialogue/toys.yaml"))
    assert (gone.kind, gone.place) == ("stall_unreadable", "toys.yaml")


def test_every_thing_that_can_be_wished_for_has_its_reason() -> None:
    wishes = load_wishes()
    assert {stall for stall, _ in wishes} == set(BAZAAR.stalls)
    assert len(wishes) == 21
    for (stall, item), text in wishes.items():
        for words in (text.who, text.why, text.got, text.missed):
            assert words.en.strip(), (stall, item)
            assert words.ja.strip(), (stall, item)
            assert words.en != words.ja


@pytest.mark.parametrize(
    ("before", "after", "says"),
    [
        ('opens: "13:00"', 'opens: "25:00"', "a time such as"),
        ("walk: 6", "walk: -6", "0 to 600"),
        ("mood: anger", "mood: angre", "anger"),
        ("share: 0.78", "share: lots", "number"),
    ],
)
def test_a_broken_market_file_names_its_place(tmp_path, before, after, says) -> None:
    from game.core.paths import ASSETS

    path = tmp_path / "market.yaml"
    text = (ASSETS / "market" / "market.yaml").read_text(encoding="utf-8")
    assert before in text
    path.write_text(text.replace(before, after), encoding="utf-8")
    with pytest.raises(BadInput, match=says) as caught:
        load_bazaar(path)
    assert "market.yaml:" in str(caught.value)


@pytest.mark.gl
def test_walking_from_stall_to_stall_changes_who_is_seen_and_nothing_is_forgotten(tmp_path, monkeypatch) -> None:
    from game.app.input import Action
    from game.app.screens import MarketScreen, TableScreen, TalkScreen, WalkScreen
    from game.app.window import Window
    from game.render import Device, level_named

    monkeypatch.setenv("MCG_USER_FOLDER", str(tmp_path))
    device = Device.headless(480, 270)
    window = Window(three_stalls(tmp_path), device, level=level_named("low"))
    session = window.session

    def press(*names: str, seconds: float = 0.2) -> None:
        for name in names:
            window.draw()
            window.handle(Action(name) if len(name) > 1 else Action("key", key=name))
            for _ in range(round(seconds * 30)):
                window.advance(1 / 30)

    try:
        press("confirm", "confirm")
        assert isinstance(window.screen, MarketScreen)
        for _ in range(4):
            window.draw()
        assert window.gallery.names() >= {f"card:{name}" for name in NAMES}
        press("right", "right", "confirm")
        assert isinstance(window.screen, WalkScreen)
        assert session.stall == "toys"
        assert session.afternoon.minutes == 2 * BAZAAR.costs.walk
        press("confirm")
        assert isinstance(window.screen, TableScreen)
        press("1")
        assert isinstance(window.screen, TalkScreen)
        assert session.world.talk is not None
        assert session.world.talk.story.stall == "toys"
        pixels = window.renderer.read_pixels()
        assert np.asarray(pixels).std() > 20
        clock = session.minutes
        assert clock > session.afternoon.minutes
        press("back", "confirm")
        assert isinstance(window.screen, TalkScreen), "the talk waits behind the title"
    finally:
        window.close()
        device.release()


def test_a_save_knows_the_whole_afternoon(tmp_path, scripts) -> None:
    from game.app.saves import SavedGame, load_game, save_game

    assets = {s.stall: load_talk_assets(path) for s, path in zip(scripts, copies(tmp_path).values(), strict=True)}
    day = pass_time(BAZAAR, replace(open_day(BAZAAR, scripts, 8), place="toys", shared={"gossip": 2.0}), 30)
    talk = visit_stall(assets["toys"], day, "vase")
    after = finish_talk(BAZAAR, assets["toys"], day, choose(assets["toys"], talk, Choice("leave")), 4)
    save_game(tmp_path / "x.json", SavedGame(after, "toys"))
    saved = load_game(tmp_path / "x.json", BAZAAR, assets)
    assert saved.afternoon == after
    assert saved.stall == "toys"
    gone = load_game(tmp_path / "x.json", BAZAAR, {"flea": assets["flea"]})
    assert gone.afternoon == after


def test_a_save_from_when_there_was_one_stall_is_taken_over(tmp_path) -> None:
    import json

    from game.app.saves import load_game

    old = {
        "version": 1,
        "afternoon": {
            "seed": 4,
            "purse": 7000,
            "visits": 3,
            "failed_visits": 2,
            "bought": [{"item": "vase", "price": 2000, "list_price": 3200, "surplus": 0.5}],
            "memory": {"visits": 3, "seen": ["hello"], "variables": {}},
        },
        "talk": None,
    }
    path = tmp_path / "autosave.json"
    path.write_text(json.dumps(old), encoding="utf-8")
    afternoon = load_game(path, BAZAAR, {}).afternoon
    assert isinstance(afternoon, Afternoon)
    assert (afternoon.purse, afternoon.talks, afternoon.budget) == (7000, 3, 9000)
    assert afternoon.at("flea").annoyance == 2
    assert afternoon.at("flea").memory is not None
    assert afternoon.bought[0].stall == "flea"
