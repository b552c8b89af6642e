"""Saved games: versioned JSON, written whole or not at all, checked value by value when read back.

A save holds the afternoon (purse, what was bought) and, where a talk is under way, everything that talk owns. The
story's part survives edits of the script as far as its ids do (``game.story.restore``).
"""

from __future__ import annotations

import json
import math
import os
import tempfile
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from game.app.afternoon import Afternoon, Bought
from game.app.talk import TalkAssets, TalkState, talk_env
from game.core.errors import BadInput, Where
from game.emotion import Feeling
from game.market import Answer, Bargain
from game.story import Beat, Memory, restore, resume
from game.story import save as save_story

__all__ = ["SAVE_VERSION", "load_game", "save_game"]

SAVE_VERSION = 1
MAX_BYTES = 1_000_000


@dataclass(frozen=True)
class _Reader:
    """Typed access to untrusted JSON with the pointer of every value."""

    path: Path
    data: Any
    pointer: str = ""

    def fail(self, expected: str, seen: object) -> BadInput:
        return BadInput(
            where=Where(self.path, pointer=self.pointer),
            expected=expected,
            seen=seen,
            hint="the save was left as it is; start a new afternoon or restore the file",
        )

    def at(self, key: str) -> _Reader:
        if not isinstance(self.data, dict) or key not in self.data:
            raise self.fail(f"the key {key}", "none")
        return _Reader(self.path, self.data[key], f"{self.pointer}/{key}")

    def number(self, low: float = -1e9, high: float = 1e9) -> float:
        value = self.data
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise self.fail("a number", value)
        if not low <= value <= high:
            raise self.fail(f"a number from {low:g} to {high:g}", value)
        return float(value)

    def whole(self, low: int = 0, high: int = 2**63) -> int:
        value = self.data
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise self.fail(f"a whole number from {low} to {high}", value)
        return value

    def text(self, limit: int = 200) -> str:
        if not isinstance(self.data, str) or len(self.data) > limit:
            raise self.fail(f"a text of at most {limit} characters", self.data)
        return self.data

    def items(self, limit: int = 1000) -> list[_Reader]:
        if not isinstance(self.data, list) or len(self.data) > limit:
            raise self.fail(f"a list of at most {limit}", type(self.data).__name__)
        return [_Reader(self.path, item, f"{self.pointer}/{i}") for i, item in enumerate(self.data)]

    def flag(self) -> bool:
        if not isinstance(self.data, bool):
            raise self.fail("true or false", self.data)
        return self.data


def _plain(value: Any) -> dict[str, Any]:
    return {field.name: getattr(value, field.name) for field in fields(value)}


def save_game(path: Path, afternoon: Afternoon, talk: TalkState | None) -> None:
    """Write the game to ``path``, atomically. Raises BadInput where the folder cannot be written."""
    data: dict[str, Any] = {"version": SAVE_VERSION, "afternoon": _afternoon_to_dict(afternoon), "talk": None}
    if talk is not None:
        data["talk"] = {
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
            "bargain": _plain(talk.bargain),
            "answer": _plain(talk.answer),
        }
    text = json.dumps(data, ensure_ascii=False, indent=1)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
        try:
            with os.fdopen(handle, "w", encoding="utf-8") as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())
            os.replace(name, path)
        except BaseException:
            os.unlink(name)
            raise
    except OSError as error:
        raise BadInput(
            "save", where=Where(path), expected="a folder that can be written", seen=error.strerror or str(error)
        ) from None


def load_game(path: Path, assets: TalkAssets) -> tuple[Afternoon, TalkState | None]:
    """Read a save. Raises BadInput with the file and JSON pointer of the first thing that is wrong."""
    try:
        if path.stat().st_size > MAX_BYTES:
            raise BadInput(where=Where(path), expected=f"a save of at most {MAX_BYTES} bytes", seen=path.stat().st_size)
        raw = path.read_bytes()
    except OSError as error:
        raise BadInput("save", where=Where(path), expected="a readable file", seen=error.strerror or "?") from None
    try:
        data = json.loads(raw.decode("utf-8"))
    except (ValueError, RecursionError) as error:
        at = getattr(error, "pos", getattr(error, "start", 0))
        raise BadInput(where=Where(path, byte=at), expected="JSON", seen=str(error).split(":")[0]) from None
    root = _Reader(path, data)
    version = root.at("version").whole()
    if version != SAVE_VERSION:
        raise root.at("version").fail(f"version {SAVE_VERSION}", version)
    afternoon = _afternoon_from(root.at("afternoon"))
    return afternoon, None if root.at("talk").data is None else _talk_from(root.at("talk"), assets)


def _afternoon_to_dict(afternoon: Afternoon) -> dict[str, Any]:
    return {
        "seed": afternoon.seed,
        "purse": afternoon.purse,
        "visits": afternoon.visits,
        "failed_visits": afternoon.failed_visits,
        "bought": [_plain(b) for b in afternoon.bought],
        "memory": None if afternoon.memory is None else afternoon.memory.to_dict(),
        "shared": dict(afternoon.shared),
    }


def _afternoon_from(reader: _Reader) -> Afternoon:
    memory = reader.at("memory")
    return Afternoon(
        seed=reader.at("seed").whole(),
        purse=reader.at("purse").whole(0, 10**9),
        visits=reader.at("visits").whole(0, 10**6),
        failed_visits=reader.at("failed_visits").whole(0, 10**6),
        bought=tuple(
            Bought(
                item=b.at("item").text(),
                price=b.at("price").whole(0, 10**9),
                list_price=b.at("list_price").whole(0, 10**9),
                surplus=b.at("surplus").number(0, 1),
            )
            for b in reader.at("bought").items()
        ),
        memory=None
        if memory.data is None
        else Memory.from_dict(memory.data, Where(memory.path, pointer=memory.pointer)),
        shared=_shared_from(reader),
    )


def _shared_from(reader: _Reader) -> dict[str, float | str | bool]:
    """Variables by name: a number, a short text, true or false. Saves of before there were any have none."""
    if not isinstance(reader.data, dict) or "shared" not in reader.data:
        return {}
    found = reader.at("shared")
    if not isinstance(found.data, dict) or len(found.data) > 1000:
        raise found.fail("a mapping of at most 1000", type(found.data).__name__)
    out: dict[str, float | str | bool] = {}
    for name in found.data:
        value = found.at(name)
        if isinstance(value.data, bool):
            out[name] = value.data
        else:
            out[name] = value.text() if isinstance(value.data, str) else value.number()
    return out


def _talk_from(reader: _Reader, assets: TalkAssets) -> TalkState:
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
