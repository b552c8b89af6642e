"""A dialogue script as an immutable asset: every part knows where it stands in the file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Literal

from game.core.errors import Where
from game.story.acts import ActTable
from game.story.bits import Bits
from game.story.expressions import Expression, Names
from game.story.text import Pronoun, Text
from game.story.vocabulary import Type, Value

if TYPE_CHECKING:
    from game.story.prepared import Prepared

__all__ = [
    "BACK",
    "HOME",
    "Branch",
    "ChoiceDef",
    "Currency",
    "EffectDef",
    "EndingDef",
    "Item",
    "LineDef",
    "NodeDef",
    "Order",
    "Person",
    "SayDef",
    "Script",
    "Speaker",
    "TimerDef",
    "Variable",
]

BACK = "back"
HOME = "home"

Speaker = Literal["shopkeeper", "player", "narrator"]
VariableScope = Literal["talk", "stall", "afternoon"]
Order = Literal["weighted", "shuffled", "listed"]


@dataclass(frozen=True, eq=False)
class Item:
    """A thing on the table. ``list_price`` in whole units of the stall's currency; about: what one sees of it."""

    id: str
    name: Text
    list_price: int
    where: Where
    about: Text | None = None


@dataclass(frozen=True, eq=False)
class Person:
    """Who stands behind the stall; how they feel and bargain is told by the rules under ``temperament``."""

    id: str
    name: Text
    temperament: str
    notes: str
    where: Where
    pronoun: Pronoun = "they"


@dataclass(frozen=True)
class Currency:
    """How an amount is written: ``{n}`` stands for the number with thousands separated."""

    pattern: Text

    def text(self, amount: float) -> Text:
        number = f"{round(amount):,}"
        return Text(self.pattern.en.replace("{n}", number), self.pattern.ja.replace("{n}", number))


@dataclass(frozen=True, eq=False)
class Variable:
    """A variable with the scope it lives in; its type is that of its initial value."""

    name: str
    scope: VariableScope
    type: Type
    initial: Value
    where: Where


@dataclass(frozen=True, eq=False)
class EffectDef:
    """``set: {name: expression}``."""

    name: str
    value: Expression
    where: Where


@dataclass(frozen=True, eq=False)
class LineDef:
    """One spoken line.

    when: how the player's line landed (right, neutral, wrong), or ``veiled`` where the words hide it.
    """

    id: str
    text: Text
    where: Where
    speaker: Speaker = "shopkeeper"
    condition: Expression | None = None
    when: str | None = None
    face: str | None = None
    gesture: str | None = None
    tone: str | None = None
    note: str | None = None
    weight: float = 1.0
    again: bool = False
    feel: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class SayDef:
    """A place in a node where one line is said: the only one, or one of ``any`` that fits and was not yet said.

    order: weighted, by chance; shuffled, those heard least often first; listed, the first.
    """

    lines: tuple[LineDef, ...]
    where: Where
    condition: Expression | None = None
    when: str | None = None
    order: Order = "weighted"


@dataclass(frozen=True, eq=False)
class Branch:
    """Where to go on, if the condition holds; ``back`` returns to the caller, ``home`` is the stall's main hub."""

    target: str
    where: Where
    condition: Expression | None = None


@dataclass(frozen=True, eq=False)
class ChoiceDef:
    """What the player may say or do. Several ``texts`` are variants of it, none spoken twice in a talk.

    once: not offered again in this ``talk``, at this ``stall``, or ``never`` used up.
    """

    id: str
    act: str
    texts: tuple[LineDef, ...]
    where: Where
    to: tuple[Branch, ...]
    feel: Mapping[str, float]
    effects: tuple[EffectDef, ...]
    condition: Expression | None = None
    needs: Expression | None = None
    reason: Text | None = None
    once: Literal["talk", "stall", "never"] = "talk"
    silent: bool = False
    weight: float = 1.0


@dataclass(frozen=True, eq=False)
class TimerDef:
    """A timed choice: after so many seconds the choice ``default`` is taken."""

    seconds: float
    default: str
    where: Where


@dataclass(frozen=True, eq=False)
class NodeDef:
    """A place in the talk: lines, then choices to wait at, a way on, or an end."""

    id: str
    where: Where
    says: tuple[SayDef, ...]
    to: tuple[Branch, ...]
    choices: tuple[ChoiceDef, ...]
    pools: tuple[str, ...]
    draw: int
    standing: bool
    call: str | None
    end: str | None
    effects: tuple[EffectDef, ...]
    feel: Mapping[str, float]
    timer: TimerDef | None = None

    @cached_property
    def waits(self) -> bool:
        """Whether the talk stops here for the player."""
        return bool(self.choices or self.pools)


@dataclass(frozen=True, eq=False)
class EndingDef:
    """How a talk can end: a name, and a caption for the outcome screen."""

    id: str
    caption: Text
    where: Where


@dataclass(frozen=True, eq=False)
class Script:
    """One stall's dialogue. path: the stall's own file; files: all that its nodes stand in, it first."""

    stall: str
    path: str
    where: Where
    files: tuple[str, ...]
    title: Text
    person: Person
    currency: Currency
    items: Mapping[str, Item]
    start: str
    home: str
    outcomes: Mapping[str, str]
    endings: Mapping[str, EndingDef]
    variables: Mapping[str, Variable]
    pools: Mapping[str, tuple[ChoiceDef, ...]]
    standing: tuple[ChoiceDef, ...]
    nodes: Mapping[str, NodeDef]
    faces: Mapping[str, Mapping[str, float]]
    acts: ActTable
    names: Names
    lowest_share: float = 0.0
    """The least a thing can cost, as a share of its list price (rules.yaml)."""

    def choices_at(self, node: NodeDef) -> Iterator[ChoiceDef]:
        """Every choice that can be offered at a node: drawn, fixed and standing."""
        for pool in node.pools:
            yield from self.pools.get(pool, ())
        yield from node.choices
        if node.standing:
            yield from self.standing

    def all_choices(self) -> Iterator[ChoiceDef]:
        """Every choice of the script, each once."""
        for pool in self.pools.values():
            yield from pool
        for node in self.nodes.values():
            yield from node.choices
        yield from self.standing

    def all_lines(self) -> Iterator[LineDef]:
        """Every spoken line: of nodes, then the player's own."""
        for node in self.nodes.values():
            for say in node.says:
                yield from say.lines
        for choice in self.all_choices():
            yield from choice.texts

    @cached_property
    def tables(self) -> dict[str, Prepared]:
        """By item, what ``game.story.prepared`` has worked out; empty at first."""
        return {}

    @cached_property
    def bits(self) -> Bits:
        """A bit of a whole number for every line, choice and node."""
        return Bits(tuple(self.lines), tuple(self.choices), tuple(self.nodes))

    @cached_property
    def lines(self) -> Mapping[str, LineDef]:
        """Every spoken line by its id."""
        return {line.id: line for line in self.all_lines()}

    @cached_property
    def choices(self) -> Mapping[str, ChoiceDef]:
        """Every choice by its id."""
        return {choice.id: choice for choice in self.all_choices()}
