"""Saved games: versioned JSON, written whole or not at all, checked value by value when read back.

A save holds the afternoon (clock, purse, wish list, what was bought, what is remembered) and, where a talk is under
way, everything that talk owns and the moves that led there. The story's part survives edits of the script as far as
its ids do (``game.story.restore``); the moves give the curve back by playing them again. Saves of version 1, from
when there was one stall, are taken over.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from game.app.afternoon import Afternoon, Bought, Reading, StallDay, Wish, lesson_of, visit_stall
from game.app.bazaar import Bazaar
from game.app.save_reader import SaveReader, read_json
from game.app.talk import Choice, TalkAssets, TalkState, choose, talk_env
from game.app.world import Mark, first_mark, next_mark
from game.core.errors import BadInput, Where
from game.emotion import Feeling
from game.formats.files import write_text
from game.market import Answer, Bargain
from game.story import Beat, Memory, restore, resume
from game.story import save as save_story
from game.story.vocabulary import Value

__all__ = ["SAVE_VERSION", "SavedGame", "game_to_dict", "load_game", "read_game", "retrace", "save_game"]

SAVE_VERSION = 2


@dataclass(frozen=True, eq=False)
class SavedGame:
    """The afternoon; the stall one stands at; the talk under way, if any, with its curve."""

    afternoon: Afternoon
    stall: str
    talk: TalkState | None = None
    marks: tuple[Mark, ...] = ()


def _plain(value: Any) -> dict[str, Any]:
    return {field.name: getattr(value, field.name) for field in fields(value)}


def game_to_dict(game: SavedGame) -> dict[str, Any]:
    """The game as plain JSON, what ``read_game`` takes."""
    return {
        "version": SAVE_VERSION,
        "afternoon": _afternoon_to_dict(game.afternoon),
        "stall": game.stall,
        "talk": None if game.talk is None else _talk_to_dict(game.talk),
        "moves": [
            {"choice": m.choice.id, "offer": m.choice.offer, "guess": m.guess}
            for m in game.marks
            if m.choice is not None
        ],
    }


def save_game(path: Path, game: SavedGame) -> None:
    """Write the game to ``path``, atomically. Raises BadInput where the folder cannot be written."""
    write_text(path, json.dumps(game_to_dict(game), ensure_ascii=False, indent=1), make_folder=True, durable=True)


def load_game(path: Path, bazaar: Bazaar, talks: Mapping[str, TalkAssets]) -> SavedGame:
    """Read a save. Raises BadInput with the file and JSON pointer of the first thing that is wrong.

    talks: what the talks of the open stalls need. A talk at a stall that does not open today is not taken up.
    """
    return read_game(read_json(path), bazaar, talks)


def read_game(root: SaveReader, bazaar: Bazaar, talks: Mapping[str, TalkAssets]) -> SavedGame:
    """A game from a save's JSON; the rest as for ``load_game``."""
    version = root.at("version").whole()
    if version not in (1, SAVE_VERSION):
        raise root.at("version").fail(f"version {SAVE_VERSION}", version)
    if version == 1:
        root = _from_version_1(root)
    afternoon = _afternoon_from(root.at("afternoon"))
    stall = root.at("stall").text()
    saved = root.at("talk")
    if saved.data is None or stall not in talks:
        return SavedGame(afternoon, stall)
    assets = lesson_of(bazaar, afternoon).bend(talks[stall])
    talk = _talk_from(saved, assets)
    moves = [
        (
            Choice(m.at("choice").text(), None if m.at("offer").data is None else m.at("offer").whole(0, 10**9)),
            m.at("guess").text(),
        )
        for m in root.at("moves").items()
    ]
    marks = retrace(assets, afternoon, talk, moves)
    return SavedGame(afternoon, stall, talk, marks or (first_mark(assets, talk),))


def retrace(
    assets: TalkAssets, afternoon: Afternoon, talk: TalkState, moves: list[tuple[Choice, str]]
) -> tuple[Mark, ...]:
    """The curve of a talk by playing its moves again; empty where they no longer lead to it (an edited script)."""
    try:
        state = visit_stall(assets, afternoon, talk.item)
        marks = [first_mark(assets, state)]
        for move, guess in moves:
            after = choose(assets, state, move)
            marks.append(next_mark(assets, state, after, move, guess, len(marks)))
            state = after
    except BadInput:
        return ()
    same = state.bargain == talk.bargain and state.feeling.six == talk.feeling.six
    return tuple(marks) if same else ()


def _from_version_1(root: SaveReader) -> SaveReader:
    """Version 1 knew one stall, no clock and no list: its visits and memory become those of the stall ``flea``."""
    old = root.at("afternoon")
    failed = old.at("failed_visits").whole(0, 10**6)
    visits = old.at("visits").whole(0, 10**6)
    known = _plain(StallDay(talks=visits, deals=max(visits - failed, 0), annoyance=float(failed)))
    purse = old.at("purse").whole(0, 10**9)
    paid = sum(b.at("price").whole(0, 10**9) for b in old.at("bought").items())
    afternoon = _afternoon_to_dict(Afternoon(seed=old.at("seed").whole(), purse=purse, budget=purse + paid))
    shared = old.data.get("shared", {})  # late saves of version 1 had it
    afternoon |= {
        "shared": shared,
        "talks": visits,
        "place": "flea",
        "stalls": {"flea": known | {"memory": old.at("memory").data}},
        "bought": [{**b.data, "stall": "flea"} for b in old.at("bought").items()],
    }
    data = {"version": 2, "afternoon": afternoon, "stall": "flea", "talk": root.at("talk").data, "moves": []}
    return SaveReader(root.path, data)


def _afternoon_to_dict(afternoon: Afternoon) -> dict[str, Any]:
    stalls = {
        name: _plain(known) | {"memory": None if known.memory is None else known.memory.to_dict()}
        for name, known in afternoon.stalls.items()
    }
    lists = {name: [_plain(v) for v in getattr(afternoon, name)] for name in ("wishes", "bought", "readings")}
    other = {"stalls": stalls, "home": list(afternoon.home), "shared": dict(afternoon.shared)}
    return _plain(afternoon) | lists | other


def _afternoon_from(reader: SaveReader) -> Afternoon:
    stalls = reader.at("stalls")
    return Afternoon(
        seed=reader.at("seed").whole(),
        day=reader.at("day").whole(1, 10**6),
        purse=reader.at("purse").whole(0, 10**9),
        budget=reader.at("budget").whole(0, 10**9),
        minutes=reader.at("minutes").number(0, 1e6),
        place=reader.at("place").text(),
        talks=reader.at("talks").whole(0, 10**6),
        stalls={name: _stall_from(stalls.at(name)) for name in stalls.names(100)},
        wishes=tuple(Wish(w.at("stall").text(), w.at("item").text()) for w in reader.at("wishes").items(100)),
        bought=tuple(
            Bought(
                stall=b.at("stall").text(),
                item=b.at("item").text(),
                price=b.at("price").whole(0, 10**9),
                list_price=b.at("list_price").whole(0, 10**9),
                surplus=b.at("surplus").number(0, 1),
            )
            for b in reader.at("bought").items()
        ),
        readings=tuple(
            Reading(r.at("stall").text(), r.at("guess").text(), r.at("felt").text(), r.at("shown").text())
            for r in reader.at("readings").items()
        ),
        home=tuple(name.text() for name in reader.at("home").items()),
        taken_back=reader.at("taken_back").whole(0, 10**6),
        shared=_variables(reader.at("shared")),
    )


def _variables(reader: SaveReader) -> dict[str, Value]:
    out: dict[str, Value] = {}
    for name in reader.names():
        value = reader.at(name)
        if isinstance(value.data, bool):
            out[name] = value.data
        else:
            out[name] = value.text() if isinstance(value.data, str) else value.number()
    return out


def _stall_from(reader: SaveReader) -> StallDay:
    memory = reader.at("memory")
    kept = None
    if memory.data is not None:
        kept = Memory.from_dict(memory.data, Where(memory.path, pointer=memory.pointer))
    return StallDay(
        talks=reader.at("talks").whole(0, 10**6),
        deals=reader.at("deals").whole(0, 10**6),
        annoyance=reader.at("annoyance").number(0, 1e6),
        memory=kept,
        trust=reader.at("trust").number(0, 1),
        felt=reader.at("felt").text(),
        ending=reader.at("ending").text(),
    )


def _talk_to_dict(talk: TalkState) -> dict[str, Any]:
    return {
        "seed": talk.seed,
        "item": talk.item,
        "list_price": talk.list_price,
        "purse": talk.purse,
        "visit": talk.visit,
        "deal_price": talk.deal_price,
        "story": save_story(talk.story),
        "feeling": {
            "felt": list(talk.feeling.six),
            "mask_shows": talk.feeling.mask_shows,
            "last_right": talk.feeling.last_right,
            "used": sorted(talk.feeling.used),
        },
        "bargain": talk.bargain._asdict(),
        "answer": talk.answer._asdict(),
    }


def _talk_from(reader: SaveReader, assets: TalkAssets) -> TalkState:
    feeling, bargain, answer = reader.at("feeling"), reader.at("bargain"), reader.at("answer")
    felt = feeling.at("felt").items(6)
    if len(felt) != 6:
        raise feeling.at("felt").fail("six numbers", len(felt))
    item = reader.at("item").text()
    if item not in assets.script.items:
        raise reader.at("item").fail(" | ".join(assets.script.items), item)
    story = restore(assets.script, reader.at("story").data, Where(reader.path, pointer=f"{reader.pointer}/story"))
    share = {"lowest", "ask", "offer", "trust", "price"}
    state = TalkState(
        seed=reader.at("seed").whole(),
        item=item,
        list_price=reader.at("list_price").whole(1, 10**9),
        purse=reader.at("purse").whole(0, 10**9),
        visit=reader.at("visit").whole(0, 10**6),
        deal_price=reader.at("deal_price").whole(0, 10**9),
        story=story,
        beat=Beat(node="", lines=(), choices=(), stimuli=(), ended=None),
        feeling=Feeling(
            six=tuple(v.number(0, 1) for v in felt),
            mask_shows=feeling.at("mask_shows").whole(0, 6),
            last_right=feeling.at("last_right").text(),
            used=frozenset(u.text() for u in feeling.at("used").items()),
        ),
        bargain=Bargain(
            **{name: bargain.at(name).number(0, 1) for name in share},
            patience=bargain.at("patience").number(-100, 100),
            round=bargain.at("round").whole(0, 1000),
            outcome=bargain.at("outcome").text(),
        ),
        answer=Answer(
            result=answer.at("result").text(),
            excess=answer.at("excess").number(0, 1),
            above_lowest=answer.at("above_lowest").number(-1, 1),
            conceded=answer.at("conceded").number(0, 1),
            tidying=answer.at("tidying").flag(),
            tells=answer.at("tells").flag(),
        ),
    )
    story, beat = resume(assets.script, story, talk_env(state, assets))
    return replace(state, story=story, beat=beat)
