"""Where a talk stands between two steps, as the next step works on it: whole numbers, tuples, and a log.

What was said, chosen and passed is one number (``Script.bits``). Ids and counts are made of them when somebody
looks, which most steps of most talks never do.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from game.story.beat import Spoken
from game.story.bits import bits_of
from game.story.model import LineDef, Script
from game.story.prepared import Prepared, prepared
from game.story.ready import Laid
from game.story.vocabulary import Value

__all__ = ["Log", "StoryState", "Talk"]


class Talk(NamedTuple):
    """What stays the same from the first step of a talk to its last.

    earlier: everything seen on earlier visits, and ``earlier_bits`` what the script knows of it; names: those that mean
    the same throughout; unknown_said, unknown_chosen: what was said and chosen, and the script does not know any more.
    """

    ready: Prepared
    seed: int
    visit: int
    earlier: frozenset[str]
    earlier_bits: int
    names: Mapping[str, Value]
    unknown_said: frozenset[str]
    unknown_chosen: frozenset[str]

    @staticmethod
    def about(
        script: Script,
        item: str,
        seed: int,
        visit: int,
        earlier: frozenset[str],
        unknown_said: frozenset[str] = frozenset(),
        unknown_chosen: frozenset[str] = frozenset(),
    ) -> Talk:
        """A talk about an item of a script."""
        names: dict[str, Value] = {"item": item, "visit": float(visit)}
        earlier_bits = bits_of(script.bits.seen, earlier)
        return Talk(prepared(script, item), seed, visit, earlier, earlier_bits, names, unknown_said, unknown_chosen)


Counts = tuple[Mapping[str, int], Mapping[str, int]]


class Log:
    """The nodes passed and the lines spoken so far, step by step; how often is counted when somebody asks."""

    __slots__ = ("_before", "_counted", "_lines", "_nodes", "_talk")

    def __init__(
        self, talk: Talk, before: Log | None, nodes: tuple[str, ...] = (), lines: tuple[Spoken | LineDef, ...] = ()
    ) -> None:
        """nodes, lines: of the last step; before: the log up to there, None where there is none."""
        self._talk, self._before, self._nodes, self._lines = talk, before, nodes, lines
        self._counted: Counts | None = None

    @staticmethod
    def of(talk: Talk, visits: Mapping[str, int], heard: Mapping[str, int], last_lines: Sequence[LineDef]) -> Log:
        """One that goes on from counts."""
        log = Log(talk, None, (), tuple(last_lines))
        log._counted = visits, heard
        return log

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Log) and (self._counts(), self.last_lines) == (other._counts(), other.last_lines)

    @property
    def last_lines(self) -> tuple[str, ...]:
        """The ids of the lines of the last step."""
        return tuple([line.id for line in self._lines])

    @property
    def visits(self) -> Mapping[str, int]:
        """How often each node was passed, in the order of the first times."""
        return self._counts()[0]

    @property
    def heard(self) -> Mapping[str, int]:
        """How often lines that may come again were said."""
        return self._counts()[1]

    def _counts(self) -> Counts:
        if self._counted is None:
            later, log = [self], self._before
            while log is not None and log._counted is None:
                later.append(log)
                log = log._before
            visits, heard = [dict(counts) for counts in (log._counted if log and log._counted else ({}, {}))]
            known = self._talk.ready.script.lines
            for step in reversed(later):
                for name in step._nodes:
                    visits[name] = visits.get(name, 0) + 1
                for line in step._lines:
                    if known[line.id].again:
                        heard[line.id] = heard.get(line.id, 0) + 1
            # What is counted need not be kept.
            self._counted, self._before = (visits, heard), None
        return self._counted


class StoryState(NamedTuple):
    """One talk between two steps, of one script: what a save holds (``game.story.state``).

    ``counter`` is the position in the stream of chance ``seed``; ``turn`` counts the waits; returns: nodes to come back
    to, innermost last, ``after:NODE`` meaning the way on from NODE; past: the bits of what was said, chosen and passed;
    laid: the choices on the table, each with its wording.
    """

    talk: Talk
    node: str
    started: bool
    ended: str | None
    counter: int
    turn: int
    returns: tuple[str, ...]
    past: int
    variables: Mapping[str, Value]
    laid: Laid
    log: Log

    def with_seed(self, seed: int) -> StoryState:
        """The same with other chance from here on."""
        return self._replace(talk=self.talk._replace(seed=seed))

    def with_variable(self, name: str, value: Value) -> StoryState:
        """The same with another value of one of its variables."""
        return self._replace(variables={**self.variables, name: value})

    @property
    def script(self) -> Script:
        """The script that it is a talk of."""
        return self.talk.ready.script

    @property
    def stall(self) -> str:
        """Where."""
        return self.script.stall

    @property
    def item(self) -> str:
        """What is talked about."""
        return self.talk.ready.item

    @property
    def seed(self) -> int:
        """Of its chance."""
        return self.talk.seed

    @property
    def visit(self) -> int:
        """1 on the first one to the stall."""
        return self.talk.visit

    @property
    def earlier(self) -> frozenset[str]:
        """Everything said, chosen and passed on earlier visits."""
        return self.talk.earlier

    @property
    def visits(self) -> Mapping[str, int]:
        """How often each node was passed, in the order of the first times."""
        return self.log.visits

    @property
    def said(self) -> frozenset[str]:
        """The ids of the lines said in this talk, the player's own among them."""
        return self.script.bits.ids(self.script.bits.lines, self.past) | self.talk.unknown_said

    @property
    def chosen(self) -> frozenset[str]:
        """The ids of the choices taken in this talk."""
        return self.script.bits.ids(self.script.bits.choices, self.past) | self.talk.unknown_chosen

    @property
    def heard(self) -> Mapping[str, int]:
        """How often lines that may come again were said."""
        return self.log.heard

    @property
    def offered(self) -> tuple[tuple[str, str], ...]:
        """The ids of the choices on the table, each with that of its wording."""
        return tuple([(choice.id, line.id) for choice, line in self.laid])

    @property
    def last_lines(self) -> tuple[str, ...]:
        """The ids of the lines of the last step."""
        return self.log.last_lines
