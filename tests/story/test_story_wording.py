"""What a line can do with words: plurals and counters, pronouns, orders of variation, timed choices, gestures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from game.core.paths import DIALOGUE
from game.story import Chose, Script, Start, advance, afternoon_of, begin, load_person, load_script, restore, save
from game.story.forms import capitalised, form_of, number_text, person_word


def _edited(tmp_path: Path, text: str, *edits: tuple[str, str]) -> Script:
    for old, new in edits:
        assert old in text
        text = text.replace(old, new, 1)
    path = tmp_path / "tiny.yaml"
    path.write_text(text, encoding="utf-8")
    return load_script(path)


@pytest.mark.parametrize(
    ("forms", "number", "language", "written"),
    [
        ("# story|# stories", 1, "en", "one story"),
        ("# story|# stories", 2, "en", "two stories"),
        ("# story|# stories", 0, "en", "zero stories"),
        ("no story|one story|# stories", 0, "en", "no story"),
        ("no story|one story|# stories", 1, "en", "one story"),
        ("no story|one story|# stories", 11, "en", "11 stories"),
        ("# yen|# yen", 1250.5, "en", "1,250.5 yen"),
        ("is|are", -1, "en", "are"),
        ("#つ", 1, "ja", "一つ"),
        ("#つ", 9, "ja", "九つ"),
        ("#つ", 10, "ja", "十"),
        ("#つ", 12, "ja", "12個"),
        ("#人", 2, "ja", "二人"),
        ("#人", 14, "ja", "14人"),
        ("#冊", 3, "ja", "3冊"),
        ("まだ|#回目", 0, "ja", "まだ"),
        ("まだ|#回目", 2, "ja", "2回目"),
    ],
)
def test_forms(forms, number, language, written):
    assert form_of(forms, number, language) == written


def test_numbers_and_capitals():
    assert [number_text(n) for n in (0, 3.0, 0.5, 0.25, 1000000, -2.004)] == [
        *("0", "3", "0.5", "0.25", "1,000,000", "-2")
    ]
    assert capitalised("two", "") == "Two"
    assert capitalised("two", "So. ") == "Two"
    assert capitalised("two", "only ") == "two"
    assert person_word("their", "Mira", "she", "en") == "her"
    assert person_word("their", "ミラ", "she", "ja") == "ミラさんの"
    assert person_word("them", "Rikuo", "he", "en") == "him"


def test_plurals_and_pronouns_in_a_talk(tmp_path, tiny_text, talk):
    line = '{id: hub_1, en: "So?", ja: "で?"}'
    words = (
        '{id: hub_1, en: "{they} {they:looks|look} up. {told:# story|# stories} for {name}.", '
        'ja: "{name}が顔を上げる。話は{told:#つ}。"}'
    )
    script = _edited(tmp_path, tiny_text, (line, words), ("hub_2, weight: 2,", "hub_2, if: told > 9,"))
    beat = talk(script).beat
    spoken = next(line for line in beat.lines if line.id == "hub_1")
    assert spoken.en == "She looks up. Zero stories for Mira."
    assert spoken.ja == "ミラが顔を上げる。話は0個。"
    assert load_person(DIALOGUE / "people" / "mira.yaml").pronoun == "she"
    others = replace(script, person=replace(script.person, pronoun="they"))
    assert talk(others).beat.lines[1].en.startswith("They look up.")


def _group(order: str, again: str = "") -> tuple[str, str]:
    lines = "".join(f'          - {{id: g_{i}, {again}en: "Line {i}.", ja: "{i}行目。"}}\n' for i in range(4))
    return "    lines:\n      - any:\n          - {id: hub_1,", (
        f"    lines:\n      - order: {order}\n        any:\n{lines}      - any:\n          - {{id: hub_1,"
    )


def _heard(player, count: int) -> list[str]:
    for _ in range(count):
        player.choose("wait")
    return [line.id for beat in player.beats for line in beat.lines if line.id.startswith("g_")]


def test_listed_goes_down_the_list_and_shuffled_by_chance_each_once(tmp_path, tiny_text, talk):
    listed = _edited(tmp_path, tiny_text, _group("listed"))
    assert _heard(talk(listed, seed=3), 6) == ["g_0", "g_1", "g_2", "g_3"]
    shuffled = _edited(tmp_path, tiny_text, _group("shuffled", "again: true, "))
    orders = set()
    for seed in range(12):
        heard = _heard(talk(shuffled, seed=seed), 7)
        # Each once before any comes again, and again in another order.
        assert sorted(heard[:4]) == sorted(heard[4:]) == ["g_0", "g_1", "g_2", "g_3"]
        orders.add(tuple(heard[:4]))
    assert len(orders) > 4


def test_saves_of_before_there_were_bags_load(tiny):
    state, _ = advance(tiny, begin(tiny, "cup", 1), Start(), {})
    data = save(state)
    del data["heard"]
    assert restore(tiny, data) == state


def test_a_timer_stands_in_the_beat_only_where_its_default_can_be_taken(tmp_path, tiny_text, talk):
    timer = ("    pool: talk\n", "    pool: talk\n    timer: {seconds: 6, default: wait}\n")
    script = _edited(tmp_path, tiny_text, timer)
    player = talk(script)
    assert player.beat.timer is not None
    assert (player.beat.timer.seconds, player.beat.timer.choice) == (6.0, "wait")
    assert player.choose("leave", "walked_away").timer is None
    own = (
        "    pool: talk\n",
        "    timer: {seconds: 6, default: shrug}\n    pool: talk\n    choices:\n"
        '      - {id: shrug, act: joke, en: "(Shrug.)", ja: "(肩をすくめる)", silent: true, to: quiet}\n',
    )
    player = talk(_edited(tmp_path, tiny_text, own))
    assert player.beat.timer.choice == "shrug"
    # Used up: no default, no hurry.
    assert player.choose("shrug").timer is None


def test_a_named_gesture_and_the_tone_come_with_the_line(tmp_path, tiny_text, talk):
    line = ("{id: hello_1, ", "{id: hello_1, gesture: open_palm, tone: brightly, ")
    spoken = talk(_edited(tmp_path, tiny_text, line)).beat.lines[0]
    assert (spoken.gesture, spoken.tone) == ("open_palm", "brightly")


def test_what_all_stalls_share_goes_from_talk_to_talk(tmp_path, tiny_text):
    script = _edited(
        tmp_path,
        tiny_text,
        ("  stall: {met: 0}", '  stall: {met: 0}\n  afternoon: {rumour: "none"}'),
        ("set: {met: met + 1}", "set: {met: met + 1, rumour: \"'heard'\"}"),
        (
            '{id: hello_2, if: met > 1, face: smile, en: "You again!"',
            '{id: hello_2, if: met > 1, en: "Again: {rumour}!"',
        ),
        ('ja: "また来た!"', 'ja: "{rumour}!"'),
    )
    state, _ = advance(script, begin(script, "cup", 1), Start(), {})
    shared = afternoon_of(script, state)
    assert shared == {"rumour": "heard"}
    assert begin(script, "cup", 2, afternoon=shared).variables == {"told": 0.0, "warm": False, "met": 0.0, **shared}
    # Another type by now, or another stall that never heard of it: the initial value.
    assert begin(script, "cup", 2, afternoon={"rumour": 3.0, "other": "x"}).variables["rumour"] == "none"
    state, beat = advance(script, state, Chose("leave", "walked_away"), {})
    assert beat.ended == "left"
