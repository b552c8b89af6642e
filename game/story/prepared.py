"""A script made ready for talks about one item: each node, choice and line resolved once, so that a step asks only
what can still change.

Most conditions of a stall ask about the item, most lines have no names in braces, and each ``when:`` belongs to one
way in which the player's line landed: for a given item and landing only a few lines and choices are left to try.
"""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import Literal

from game.story.expressions import Expression, Scope
from game.story.model import HOME, Branch, ChoiceDef, LineDef, NodeDef, SayDef, Script
from game.story.passages import Passage, Stretch, passage_from
from game.story.pools import Act, Pool
from game.story.ready import (
    FRESH,
    STALE,
    Few,
    ReadyChoice,
    ReadyGroup,
    ReadyLine,
    ReadyNode,
    ReadySay,
    Test,
    Way,
    never,
)
from game.story.text import Text
from game.story.vocabulary import ACTS

__all__ = ["Prepared", "prepared"]

_MOST_SEEN = 3


def prepared(script: Script, item: str) -> Prepared:
    """The tables of one item of a script, made at the first call."""
    tables = script.tables
    found = tables.get(item)
    if found is None:
        found = tables[item] = Prepared(script, item)
    return found


class Prepared:
    """One script for talks about one item; fills as nodes are passed and never changes what is told.

    passages: those made so far, by how the player's line landed and by the names of the ways that lead to them.
    """

    def __init__(self, script: Script, item: str, *, settle: bool = True) -> None:
        """settle: leave out what the item rules out; without, every condition is asked in the talk."""
        self.script, self.item, self.settle = script, item, settle
        self.nodes: dict[str, ReadyNode] = {}
        self.timers = {node.id: node.timer for node in script.nodes.values() if node.timer is not None}
        self.passages: defaultdict[str, dict[str, Passage]] = defaultdict(dict)
        self._lines: dict[str, ReadyLine] = {}
        self._choices: dict[str, ReadyChoice] = {}
        self._offers: dict[str, ReadyGroup | None] = {}
        self._asked: dict[str, Test] = {}
        self._money: Few[int, Text] = Few(4096)

    def node(self, name: str) -> ReadyNode:
        """A node by its name."""
        found = self.nodes.get(name)
        if found is None:
            found = self.nodes[name] = ReadyNode(self.script.nodes[name], self)
        return found

    def passage(self, name: str, told: str) -> Passage:
        """The passage that begins with a node, or one of a choice's own, where the player's line landed so."""
        known = self.passages[told]
        found = known.get(name)
        if found is None:
            beginning, first = self._beginning(name)
            found = passage_from(beginning, self.node(first), self._way_to, lambda node: self.says(node, told))
            known[name] = found
            if name == self.script.home:
                known[HOME] = found
        return found

    def _beginning(self, name: str) -> tuple[Stretch, str]:
        """What a passage begins with, and the node that follows."""
        if not name.startswith((FRESH, STALE)):
            return Stretch(), name
        choice = self._choices[name.partition(":")[2]]
        return Stretch.taking(choice, said=name.startswith(STALE)), choice.way

    def _way_to(self, target: str) -> ReadyNode | None:
        return self.node(target) if target in self.script.nodes else None

    def laid(self, choice: ChoiceDef, text: str) -> tuple[ReadyChoice, ReadyLine]:
        """A choice in one of its wordings by its id, the first where it has none such."""
        ready = self.choice(choice)
        return ready, next((line for line in ready.texts if line.id == text), ready.texts[0])

    def line(self, line: LineDef) -> ReadyLine:
        """A line."""
        found = self._lines.get(line.id)
        if found is None:
            test = self.open(line.condition)
            test = never if test is False else test
            found = self._lines[line.id] = ReadyLine(line, self.script.bits.lines[line.id], test)
        return found

    def choice(self, choice: ChoiceDef) -> ReadyChoice:
        """A choice."""
        found = self._choices.get(choice.id)
        if found is None:
            found = self._choices[choice.id] = ReadyChoice(choice, self)
        return found

    def says(self, node: ReadyNode, told: str) -> tuple[ReadySay, ...]:
        """What a node can say where the player's line landed so (``veiled`` where the words hide it)."""
        found = node.says.get(told)
        if found is None:
            found = node.says[told] = tuple(self._ready_says(node.node.says, told))
        return found

    def _ready_says(self, says: Iterable[SayDef], told: str) -> Iterable[ReadySay]:
        for say in says:
            test = self.open(say.condition)
            if say.when not in (None, told) or test is False:
                continue
            lines = self._fitting(say.lines, told)
            if lines:
                yield test, ReadyGroup(lines, say.order)

    def _fitting(self, lines: Iterable[LineDef], told: str) -> list[ReadyLine]:
        """Lines that neither the landing nor the item rules out."""
        fits = [line for line in lines if line.when in (None, told)]
        return [self.line(line) for line in fits if self.open(line.condition) is not False]

    def offer(self, told: str) -> ReadyGroup | None:
        """The words of an offer, for a line of another act that carries one."""
        try:
            return self._offers[told]
        except KeyError:
            choices = [self.choice(choice) for choice in self.script.standing if choice.act == "offer"]
            lines = self._fitting([line.line for line in choices[0].texts], told) if choices else []
            found = self._offers[told] = ReadyGroup(lines, "weighted") if lines else None
            return found

    def pool(self, node: NodeDef) -> Pool | None:
        """What a node draws from by act, in the order of ACTS; choices that the item rules out are left out."""
        by_act: dict[str, list[tuple[ReadyChoice, Test | None]]] = {act: [] for act in ACTS}
        for definition in itertools.chain.from_iterable(self.script.pools[name] for name in node.pools):
            choice = self.choice(definition)
            if not choice.ruled_out:
                by_act.setdefault(choice.act, []).append((choice, self._question(choice)))
        acts = [Act(act, choices) for act, choices in by_act.items() if choices]
        return Pool(acts, node.draw, self.script.acts) if acts else None

    def _question(self, choice: ReadyChoice) -> Test | None:
        """What must hold for a choice to be taken, besides that it is not used up."""
        return _all_of([test for test in (choice.shown, choice.needs) if test is not None])

    def ways(self, branches: Iterable[Branch]) -> tuple[Way, ...]:
        """Where to go on, up to the first way that is always open."""
        ways: list[Way] = []
        for branch in branches:
            test = self.open(branch.condition)
            if test is not False:
                ways.append((test, branch.target))
                if test is None:
                    return tuple(ways)
        return (*ways, (None, HOME))

    def money(self, amount: float) -> Text:
        """An amount as the stall writes it; the same few come up again and again."""
        whole = round(amount)
        found = self._money.get(whole)
        return self._money.keep(whole, self.script.currency.text(whole)) if found is None else found

    def open(self, condition: Expression | None) -> Test | Literal[False] | None:
        """None or False for a condition that the item alone decides, else what has to be asked."""
        if condition is None:
            return None
        if not self.settle:
            return condition.evaluate
        # Conditions in the same words are one question.
        asked = self._asked.setdefault(condition.source, condition.evaluate)
        if condition.visits or not condition.names <= {"item"} or len(condition.seen) > _MOST_SEEN:
            return asked
        names, seen = {"item": self.item}, sorted(condition.seen)
        told = itertools.chain.from_iterable(itertools.combinations(seen, n) for n in range(len(seen) + 1))
        results = {bool(condition.evaluate(Scope(names, {}, ids))) for ids in told}
        if len(results) == 2:
            return asked
        return None if results == {True} else False


def _all_of(tests: Sequence[Test]) -> Test | None:
    if len(tests) < 2:
        return tests[0] if tests else None
    first, rest = tests[0], _all_of(tests[1:])
    assert rest is not None
    return lambda scope: first(scope) and rest(scope)
