"""Where a talk stands between two steps, as the next step works on it: whole numbers and tuples.

What was said, chosen and passed is one number (``Script.bits``). Ids and counts are made of them when somebody
looks, which most steps of most talks never do.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from game.story.beat import Spoken
from game.story.bits import bits_of
from game.story.model import LineDef, Script
from game.story.prepared import Prepared, prepared
from game.story.ready import Laid
from game.story.vocabulary import DEFAULTS, Value

__all__ = ["StoryState", "Talk"]


@dataclass(slots=True)
class Talk:
    """What stays the same from the first step of a talk to its last.

    earlier: everything seen on earlier visits, and ``earlier_bits`` what the script knows of it; unknown_said,
    unknown_chosen: what was said and chosen, and the script does not know any more.
    """

    ready: Prepared
    seed: int
    visit: int
    earlier: frozenset[str]
    earlier_bits: int
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
        earlier_bits = bits_of(script.bits.seen, earlier) if earlier else 0
        return Talk(prepared(script, item), seed, visit, earlier, earlier_bits, unknown_said, unknown_chosen)

    def names(self, variables: Mapping[str, Value]) -> dict[str, Value]:
        """What conditions and lines may use, where the game does not say otherwise."""
        return {**DEFAULTS, "item": self.ready.item, "visit": float(self.visit), **variables}


class StoryState(NamedTuple):
    """One talk between two steps, of one script: what a save holds (``game.story.state``).

    ``counter`` is the position in the stream of chance ``seed``; ``turn`` counts the waits; returns: nodes to come back
    to, innermost last, ``after:NODE`` meaning the way on from NODE; past: the bits of what was said, chosen and passed;
    names: the script's variables, and what the names of ``ENV`` mean where the game does not say; laid: the choices on
    the table, each with its wording; nodes, lines: all that were passed and spoken, in order, of the lines ``last`` in
    the last step. States are the same where each came as often, in whatever order.
    """

    talk: Talk
    node: str
    started: bool
    ended: str | None
    counter: int
    turn: int
    returns: tuple[str, ...]
    past: int
    names: Mapping[str, Value]
    laid: Laid
    nodes: tuple[str, ...]
    lines: tuple[Spoken | LineDef, ...]
    last: int

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, StoryState):
            return NotImplemented
        return self[:-3] == other[:-3] and self._counts() == other._counts()

    def __ne__(self, other: object) -> bool:
        return not self == other

    def _counts(self) -> tuple[Mapping[str, int], Mapping[str, int], tuple[str, ...]]:
        return Counter(self.nodes), Counter([line.id for line in self.lines]), self.last_lines

    def with_seed(self, seed: int) -> StoryState:
        """The same with other chance from here on."""
        return self._replace(talk=replace(self.talk, seed=seed))

    def with_variable(self, name: str, value: Value) -> StoryState:
        """The same with another value of one of its variables."""
        return self._replace(names={**self.names, name: value})

    @property
    def variables(self) -> dict[str, Value]:
        """The values of the script's variables."""
        return {name: self.names[name] for name in self.script.variables}

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
        return Counter(self.nodes)

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
        known = self.script.lines
        return Counter([line.id for line in self.lines if known[line.id].again])

    @property
    def offered(self) -> tuple[tuple[str, str], ...]:
        """The ids of the choices on the table, each with that of its wording."""
        return tuple([(choice.id, line.id) for choice, line in self.laid])

    @property
    def last_lines(self) -> tuple[str, ...]:
        """The ids of the lines of the last step."""
        return tuple([line.id for line in self.lines[len(self.lines) - self.last :]])
