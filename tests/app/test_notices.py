"""What the game says in passing: long enough to be read, gone by itself, and there to be read again."""

from __future__ import annotations

import pytest

from game.app.input import Action
from game.app.notices import FADE_S, Notices, reading_s
from game.app.screens import HistoryScreen, TitleScreen
from game.app.session import Session
from game.app.strings import load_strings
from game.app.world import TICK_S
from tests.app.market_kit import three_stalls


def at(seconds: float) -> int:
    return round(seconds / TICK_S)


@pytest.mark.parametrize("text", ["Saved.", "セーブしました。", "The game could not be saved: " + "x" * 100, "読" * 70])
def test_a_message_stands_until_it_can_be_read_and_then_goes(text: str) -> None:
    notices = Notices()
    notices.say(text, 300)
    wide = any(letter > "\u3000" for letter in text)
    assert 4.0 <= reading_s(text) <= 14.0
    assert reading_s(text) >= min(1.0 + len(text) / (7.0 if wide else 17.0), 14.0), "slow readers, too"
    last = 300 + at(reading_s(text))
    assert notices.now(last - 2) == text
    assert notices.now(last + 1) == ""
    assert notices.strength(last - 2, still=False) == 1.0, "while it is to be read it does not fade"
    assert 0.0 < notices.strength(last + at(FADE_S / 2), still=False) < 1.0
    assert notices.strength(last + at(FADE_S / 2), still=True) == 0.0, "reduced motion: it goes at once"
    assert notices.strength(last + at(FADE_S) + 1, still=False) == 0.0
    assert [notice.text for notice in notices.told] == [text]


def test_what_is_said_again_stands_anew_and_nothing_is_told_twice() -> None:
    notices = Notices()
    for tick in (0, 90, 180):
        notices.say("Saved.", tick)
    assert notices.now(180 + at(3.9)) == "Saved."
    notices.say("Loaded.", 300)
    notices.say("", 310)
    assert notices.now(311) == "", "an empty one takes away what stands"
    assert [notice.text for notice in notices.told] == ["Saved.", "Loaded."]
    for number in range(100):
        notices.say(f"message {number}", 400)
    assert len(notices.told) <= 40


def test_a_message_that_has_gone_is_read_again_in_the_history(tmp_path) -> None:
    session: Session = three_stalls(tmp_path, look=False)
    title = TitleScreen()
    assert title.handle(session, Action("key", key="h")) is None, "nothing to be read yet"
    session.strings = load_strings("ja")
    session.say(session.strings("loaded"))
    session.ticks += at(30)
    assert session.message == ""
    history = title.handle(session, Action("key", key="h"))
    assert isinstance(history, HistoryScreen)
    assert history.handle(session, Action("back")) is title
