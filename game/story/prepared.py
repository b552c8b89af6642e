"""What the item of a talk settles beforehand, worked out once, so that a step asks only what can still change.

Most conditions of a stall ask about the item, most lines have no names in braces, and each ``when:`` belongs to one
way in which the player's line landed: for a given item and landing only a few lines and choices are left to try.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable
from typing import Any, Literal

from game.story.beat import Choice, Spoken
from game.story.expressions import Expression, Scope
from game.story.forms import PERSON_SLOTS
from game.story.model import ChoiceDef, LineDef, NodeDef, Script
from game.story.text import Text
from game.story.vocabulary import ACTS

__all__ = [
    "FIXED_NAMES", "Fixed", "Group", "Offered", "Prepared", "ReadyChoice", "ReadyLine", "ReadySay", "Table", "Test",
    "prepared",
]  # fmt: skip

Test = Callable[[Scope], Any]
ReadyLine = tuple[LineDef, Test | None]
"""A line, and what must still be asked before it may be said; None: nothing."""
ReadySay = tuple[Test | None, str, tuple[ReadyLine, ...]]
"""What must hold for a group of lines, in which order it is said, and its lines."""
ReadyChoice = tuple[ChoiceDef, bool, bool, Test | None]
"""A choice, whether it is used up in a talk, and at the stall, and what must hold for it."""
Group = tuple[str, tuple[ReadyChoice, ...]]
"""An act and the choices that perform it."""
Offered = tuple[ChoiceDef, LineDef, Choice | None]
"""A choice on the table, its wording, and itself as the player sees it where that is the same in every talk."""

Fixed = tuple[Offered, ...] | None
"""Choices that are on the table in the same way in every talk; None where they are not."""
Table = tuple[tuple[Offered, ...], tuple[tuple[str, str], ...], tuple[Choice, ...]]
"""Everything on the table of a node: as offered, by the ids of choice and wording, and as the player sees it."""

FIXED_NAMES = frozenset({"item", *PERSON_SLOTS})
"""Names in braces that mean the same throughout all talks about an item."""
_MOST_SEEN = 3
_MOST_AMOUNTS = 4096


def prepared(script: Script, item: str) -> Prepared:
    """The tables of one item of a script, made at the first call."""
    tables = script.tables
    found = tables.get(item)
    if found is None:
        found = tables[item] = Prepared(script, item)
    return found


class Prepared:
    """Tables of one script for talks about one item; they fill as nodes are passed and never change what is told.

    tables: by node, where nothing on the table can change; whoever lays it keeps it here.
    spoken, options: lines by id, and available choices by the ids of choice and wording, whose words are the same in
    every talk about the item (the amount of an offer is left open); whoever fills words in keeps them here.
    """

    def __init__(self, script: Script, item: str, *, settle: bool = True) -> None:
        """settle: leave out what the item rules out; without, every condition is asked in the talk."""
        self.script, self.item, self.settle = script, item, settle
        self._says: dict[str, dict[str, tuple[ReadySay, ...]]] = {}
        self._groups: dict[str, tuple[Group, ...]] = {}
        self.spoken: dict[str, Spoken] = {}
        self.options: dict[tuple[str, str], Choice] = {}
        self._money: dict[int, Text] = {}
        self._wordings: dict[str, tuple[LineDef, ...] | None] = {}
        self._fixed: dict[str, Fixed] = {}
        self.tables: dict[str, Table] = {}

    def told(self, told: str) -> dict[str, tuple[ReadySay, ...]]:
        """By node, what ``says`` has worked out where the player's line landed so."""
        return self._says.setdefault(told, {})

    def says(self, node: NodeDef, told: str) -> tuple[ReadySay, ...]:
        """What a node can say where the player's line landed so (``veiled`` where the words hide it)."""
        by_node = self.told(told)
        found = by_node.get(node.id)
        if found is None:
            found = by_node[node.id] = tuple(self._ready_says(node, told))
        return found

    def _ready_says(self, node: NodeDef, told: str) -> Iterable[ReadySay]:
        for say in node.says:
            test = self._open(say.condition)
            if say.when not in (None, told) or test is False:
                continue
            tried = ((line, self._open(line.condition)) for line in say.lines if line.when in (None, told))
            lines = tuple((line, own) for line, own in tried if own is not False)
            if lines:
                yield test, say.order, lines

    def groups(self, node: NodeDef) -> tuple[Group, ...]:
        """The choices of a node's pools by act, in the order of ACTS; those that the item rules out are left out."""
        found = self._groups.get(node.id)
        if found is None:
            by_act: dict[str, list[ReadyChoice]] = {act: [] for act in ACTS}
            for choice in itertools.chain.from_iterable(self.script.pools[name] for name in node.pools):
                tests = [self._open(condition) for condition in (choice.condition, choice.needs)]
                if False not in tests:
                    asked = _both([test for test in tests if callable(test)])
                    ready = (choice, choice.once == "talk", choice.once == "stall", asked)
                    by_act.setdefault(choice.act, []).append(ready)
            found = self._groups[node.id] = tuple((act, tuple(ready)) for act, ready in by_act.items() if ready)
        return found

    def fixed(self, key: str, choices: Iterable[ChoiceDef], make: Callable[[ChoiceDef, LineDef], Choice]) -> Fixed:
        """What choices of one place (``key``) come to where nothing can change them in any talk about the item: never
        used up, no condition left to ask, one wording with fixed names. None where something can."""
        try:
            return self._fixed[key]
        except KeyError:
            found: list[Offered] = []
            for choice in choices:
                settled = self._open(choice.condition) is None and self._open(choice.needs) is None
                plain = len(choice.texts) == 1 and choice.texts[0].text.names <= {*FIXED_NAMES, "offer"}
                if not (settled and plain and choice.once == "never"):
                    self._fixed[key] = None
                    return None
                found.append((choice, choice.texts[0], make(choice, choice.texts[0])))
            return self._fixed.setdefault(key, tuple(found))

    def wordings(self, choice: ChoiceDef) -> tuple[LineDef, ...] | None:
        """The wordings of a choice where all of them fit at any time; None where some ask for more."""
        try:
            return self._wordings[choice.id]
        except KeyError:
            plain = all(line.when is None and line.condition is None for line in choice.texts)
            found = self._wordings[choice.id] = choice.texts if plain else None
            return found

    def money(self, amount: float) -> Text:
        """An amount as the stall writes it; the same few come up again and again."""
        whole = round(amount)
        found = self._money.get(whole)
        if found is None:
            if len(self._money) >= _MOST_AMOUNTS:
                self._money.clear()
            found = self._money[whole] = self.script.currency.text(whole)
        return found

    def _open(self, condition: Expression | None) -> Test | Literal[False] | None:
        """None or False for a condition that the item alone decides, else what has to be asked."""
        if condition is None:
            return None
        if not self.settle or condition.visits or not condition.names <= {"item"} or len(condition.seen) > _MOST_SEEN:
            return condition.evaluate
        names, seen = {"item": self.item}, sorted(condition.seen)
        told = itertools.chain.from_iterable(itertools.combinations(seen, n) for n in range(len(seen) + 1))
        results = {bool(condition.evaluate(Scope(names, {}, ids))) for ids in told}
        if len(results) == 2:
            return condition.evaluate
        return None if results == {True} else False


def _both(tests: list[Test]) -> Test | None:
    if len(tests) < 2:
        return tests[0] if tests else None
    first, second = tests
    return lambda scope: first(scope) and second(scope)
