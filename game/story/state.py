"""The beginning of a talk, what is kept of it, and its state as plain data: what a save holds, and what an edited
script can still make sense of."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from game.core.errors import BadInput, Where
from game.story.bits import bits_of
from game.story.model import LineDef, Script
from game.story.standing import StoryState, Talk
from game.story.vocabulary import OUTCOMES, Value

__all__ = ["Memory", "afternoon_of", "begin", "memory_of", "restore", "save"]

SAVE_VERSION = 1
_MAX_ENTRIES = 20_000
_MOST_COUNTED = 1_000_000
_MAX_INT = 1 << 53
_NOTHING: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Memory:
    """What a stall keeps of earlier talks: how many there were, everything seen, and the stall's variables."""

    visits: int = 0
    seen: frozenset[str] = frozenset()
    variables: Mapping[str, Value] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return {"visits": self.visits, "seen": sorted(self.seen), "variables": dict(self.variables)}

    @staticmethod
    def from_dict(data: Any, where: Where) -> Memory:
        """Raises BadInput for anything else than what ``to_dict`` writes."""
        reader = _SaveReader(data, where)
        return Memory(reader.whole("visits"), frozenset(reader.texts("seen")), reader.values("variables"))


def begin(
    script: Script,
    item: str,
    seed: int,
    *,
    memory: Memory | None = None,
    afternoon: Mapping[str, Value] | None = None,
) -> StoryState:
    """A talk about one item, before its first word. Raises BadInput for an item that is not on the table.

    memory: what this stall keeps of earlier talks; afternoon: values of variables that all stalls share.
    """
    if item not in script.items:
        raise BadInput("item", expected=" | ".join(script.items), seen=item)
    visits, seen, kept = (0, _NOTHING, {}) if memory is None else (memory.visits, memory.seen, memory.variables)
    variables = _variables(script, {**kept, **(afternoon or {})}, scopes=("stall", "afternoon"))
    talk = Talk.about(script, item, seed & (_MAX_INT - 1), visits + 1, seen)
    return StoryState(talk, "", False, None, 0, 0, (), 0, talk.names(variables), (), (), (), 0)


def memory_of(script: Script, state: StoryState) -> Memory:
    """What the stall keeps of this talk and those before it."""
    seen = state.earlier | state.said | state.chosen | state.visits.keys()
    kept = {name: state.names[name] for name, v in script.variables.items() if v.scope == "stall"}
    return Memory(state.visit, seen, kept)


def afternoon_of(script: Script, state: StoryState) -> dict[str, Value]:
    """The variables that all stalls share, as this talk leaves them."""
    return {name: state.names[name] for name, v in script.variables.items() if v.scope == "afternoon"}


def save(state: StoryState) -> dict[str, Any]:
    """The state as JSON-ready data."""
    return {
        "version": SAVE_VERSION,
        "stall": state.stall,
        "item": state.item,
        "seed": state.seed,
        "visit": state.visit,
        "counter": state.counter,
        "turn": state.turn,
        "node": state.node,
        "started": state.started,
        "ended": state.ended,
        "returns": list(state.returns),
        "visits": dict(sorted(state.visits.items())),
        "said": sorted(state.said),
        "chosen": sorted(state.chosen),
        "heard": dict(sorted(state.heard.items())),
        "earlier": sorted(state.earlier),
        "variables": state.variables,
        "offered": [list(pair) for pair in state.offered],
        "last_lines": list(state.last_lines),
    }


def restore(script: Script, data: Any, where: Where | None = None) -> StoryState:
    """A saved state for a script that may have been edited since.

    Ids that are gone are dropped, a node that is gone becomes the stall's main hub, variables that are gone or have
    another type now start anew. Raises BadInput (with the JSON pointer) for what no save of this version can hold.
    """
    reader = _SaveReader(data, where or Where("save"))
    if reader.whole("version") != SAVE_VERSION:
        raise reader.error("version", f"version {SAVE_VERSION}")
    if reader.text("stall") != script.stall:
        raise reader.error("stall", f"the stall {script.stall!r}")
    item = reader.text("item")
    if item not in script.items:
        raise reader.error("item", " | ".join(script.items))
    started, ended = data.get("started"), data.get("ended")
    if not isinstance(started, bool):
        raise reader.error("started", "true or false")
    if ended is not None and (not isinstance(ended, str) or ended not in {*script.endings, *OUTCOMES}):
        raise reader.error("ended", "null or the name of an ending")
    node = reader.text("node")
    known = {*script.nodes, *(f"after:{name}" for name in script.nodes)}
    said, chosen, earlier = [frozenset(reader.texts(key)) for key in ("said", "chosen", "earlier")]
    visits = reader.counts("visits")
    bits = script.bits
    unknown = said - bits.lines.keys(), chosen - bits.choices.keys()
    talk = Talk.about(script, item, reader.whole("seed"), reader.whole("visit"), earlier, *unknown)
    heard = reader.counts("heard") if "heard" in data else {}
    last = [script.lines[name] for name in reader.texts("last_lines") if name in script.lines]
    state = StoryState(
        talk,
        node=node,
        started=started,
        ended=ended,
        counter=reader.whole("counter"),
        turn=reader.whole("turn"),
        returns=tuple(name for name in reader.texts("returns") if name in known)[-16:],
        past=bits_of(bits.lines, said) | bits_of(bits.choices, chosen) | bits_of(bits.nodes, visits),
        names=talk.names(_variables(script, reader.values("variables"))),
        laid=(),
        nodes=tuple(Counter(visits).elements()),
        lines=_lines(script, said, heard, last),
        last=len(last),
    )
    return _fitted(script, state, reader.pairs("offered"))


def _lines(
    script: Script, said: Iterable[str], heard: Mapping[str, int], last: Sequence[LineDef]
) -> tuple[LineDef, ...]:
    """What was spoken, as often as a save says; the last lines last. heard: how often, of lines that may come again."""
    known = [script.lines[name] for name in said if name in script.lines]
    often = Counter({line.id: heard.get(line.id, 1) if line.again else 1 for line in known})
    before = often - Counter([line.id for line in last])
    return (*[script.lines[name] for name in before.elements()], *last)


def _fitted(script: Script, state: StoryState, offered: Iterable[tuple[str, str]]) -> StoryState:
    """The state with its place and choices as the script knows them now. offered: choices and their wordings."""
    if not state.started or state.ended is not None:
        return state
    if state.node not in script.nodes or not script.nodes[state.node].waits:
        return state._replace(node=script.home)
    here = {choice.id: choice for choice in script.choices_at(script.nodes[state.node])}
    ready = state.talk.ready
    return state._replace(laid=tuple([ready.laid(here[choice], text) for choice, text in offered if choice in here]))


def _variables(
    script: Script, kept: Mapping[str, Value], scopes: Iterable[str] = ("talk", "stall", "afternoon")
) -> dict[str, Value]:
    """All variables: kept values where name, scope and type still fit, initial values otherwise."""
    if not kept:
        return {name: variable.initial for name, variable in script.variables.items()}
    allowed = set(scopes)
    types = {"number": (int, float), "bool": (bool,), "text": (str,)}
    out: dict[str, Value] = {}
    for name, variable in script.variables.items():
        value = kept.get(name)
        fits = isinstance(value, types[variable.type]) and isinstance(value, bool) == (variable.type == "bool")
        if variable.scope in allowed and fits and value is not None:
            out[name] = float(value) if variable.type == "number" else value
        else:
            out[name] = variable.initial
    return out


class _SaveReader:
    """Typed, bounded access to a save's mapping; every refusal names the JSON pointer."""

    def __init__(self, data: Any, where: Where) -> None:
        self.where = where
        if not isinstance(data, dict):
            raise BadInput(where=where, expected="a saved talk", seen=type(data).__name__)
        self.data: dict[str, Any] = data

    def error(self, key: str, expected: str) -> BadInput:
        place = Where(self.where.path, pointer=f"{self.where.pointer or ''}/{key}")
        return BadInput("save", where=place, expected=expected, seen=self.data.get(key))

    def whole(self, key: str) -> int:
        value = self.data.get(key)
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < _MAX_INT:
            raise self.error(key, "a whole number of at least 0")
        return value

    def text(self, key: str) -> str:
        value = self.data.get(key)
        if not isinstance(value, str):
            raise self.error(key, "text")
        return value

    def texts(self, key: str) -> list[str]:
        value = self.data.get(key)
        if not isinstance(value, list) or len(value) > _MAX_ENTRIES or not all(isinstance(item, str) for item in value):
            raise self.error(key, "a list of texts")
        return value

    def pairs(self, key: str) -> tuple[tuple[str, str], ...]:
        value = self.data.get(key)
        good = isinstance(value, list) and len(value) <= _MAX_ENTRIES
        if not good or not all(
            isinstance(pair, list | tuple) and len(pair) == 2 and all(isinstance(part, str) for part in pair)
            for pair in self.data[key]
        ):
            raise self.error(key, "a list of pairs of texts")
        return tuple((str(first), str(second)) for first, second in self.data[key])

    def mapping(self, key: str) -> dict[str, Any]:
        value = self.data.get(key)
        if not isinstance(value, dict) or len(value) > _MAX_ENTRIES or not all(isinstance(k, str) for k in value):
            raise self.error(key, "a mapping")
        return value

    def counts(self, key: str) -> dict[str, int]:
        value = self.mapping(key)
        if not all(type(item) is int and 0 <= item < _MAX_INT for item in value.values()):
            raise self.error(key, "whole numbers by node")
        if sum(value.values()) > _MOST_COUNTED:
            raise self.error(key, f"at most {_MOST_COUNTED} in all")
        return value

    def values(self, key: str) -> dict[str, Value]:
        value = self.mapping(key)
        for item in value.values():
            if not isinstance(item, bool | int | float | str) or (
                isinstance(item, int | float) and not isinstance(item, bool) and not abs(item) <= 1e9
            ):
                raise self.error(key, "numbers, texts, true or false by name")
        return value
