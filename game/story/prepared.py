"""A script made ready for talks about one item: each node, choice and line resolved once, so that a step asks only
what can still change.

Most conditions of a stall ask about the item, most lines have no names in braces, and each ``when:`` belongs to one
way in which the player's line landed: for a given item and landing only a few lines and choices are left to try. What
was said and chosen are bits (``Script.bits``), so that what is left of a group is one ``&`` and a look into a table.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any, Generic, Literal, TypeVar

from game.story.acts import ActTable
from game.story.beat import Choice, Spoken, Stimulus
from game.story.chance import Lots
from game.story.expressions import Expression, Scope
from game.story.forms import PERSON_SLOTS
from game.story.model import HOME, Branch, ChoiceDef, EffectDef, LineDef, NodeDef, Order, SayDef, Script
from game.story.text import Text
from game.story.vocabulary import ACTS, Value

__all__ = [
    "Act", "Left", "Pair", "Prepared", "ReadyChoice", "ReadyEffect", "ReadyGroup", "ReadyLine", "ReadyNode", "ReadySay",
    "Test", "Way", "prepared",
]  # fmt: skip

Test = Callable[[Scope], Any]
ReadySay = tuple[Test | None, "ReadyGroup"]
"""What must hold for a group of lines, and its lines."""
Way = tuple[Test | None, str]
"""What must hold for going on to a node."""
ReadyEffect = tuple[str, Callable[[Scope], Value]]
"""A variable and its new value."""
Pair = tuple[str, str]
"""The ids of a choice on the table and of its wording."""

_FIXED_NAMES = frozenset({"item", *PERSON_SLOTS})
"""Names in braces that mean the same throughout all talks about an item."""
_MOST_SEEN = 3
_MOST_KEPT = 256

Key = TypeVar("Key")
Kept = TypeVar("Kept")
Item = TypeVar("Item", bound="ReadyLine | ReadyChoice")


class Few(dict[Key, Kept]):
    """What was worked out, by what it depends on; begins anew where there would be too much of it."""

    __slots__ = ("_most",)

    def __init__(self, most: int = _MOST_KEPT) -> None:
        super().__init__()
        self._most = most

    def keep(self, key: Key, value: Kept) -> Kept:
        """Remember a value and give it back."""
        if len(self) >= self._most:
            self.clear()
        self[key] = value
        return value


def prepared(script: Script, item: str) -> Prepared:
    """The tables of one item of a script, made at the first call."""
    tables = script.tables
    found = tables.get(item)
    if found is None:
        found = tables[item] = Prepared(script, item)
    return found


class ReadyLine:
    """A line in talks about an item.

    bit: its place among everything said; test: what must hold, as far as the item does not settle it; pair: the ids of
    a choice and of this, its wording. spoken, option: the line as it is said and as it is offered, by the values of the
    names in its braces (``asks``; ``keeps`` in an option, where the amount of an offer is left open).
    """

    __slots__ = (
        "again", "asks", "bit", "id", "keeps", "line", "option", "pair", "spoken", "stimulus", "test", "weight", "when",
    )  # fmt: skip

    def __init__(self, line: LineDef, bit: int, test: Test | None, choice: str) -> None:
        self.line, self.id, self.again, self.when, self.bit, self.test = line, line.id, line.again, line.when, bit, test
        self.weight = line.weight
        self.asks = tuple(sorted(line.text.names - _FIXED_NAMES))
        self.keeps = tuple([name for name in self.asks if name != "offer"])
        self.stimulus = Stimulus(line.feel, line.id) if line.feel else None
        self.pair = (choice, line.id)
        self.spoken: Few[tuple[Value | None, ...], Spoken] = Few()
        self.option: Few[tuple[Value | None, ...], Choice] = Few()


class Left(Generic[Item]):
    """Lines or choices that are not used up, each with what must hold for it. open: whether the first of them is there
    without a question; lots: what there is to draw from, by the answers to all their questions."""

    __slots__ = ("_among", "_asked", "_free", "_which", "items", "lots", "open")

    def __init__(
        self, items: Sequence[tuple[Item, Test | None]], among: Callable[[list[Item]], Sequence[Item]] = lambda all: all
    ) -> None:
        """among: of those that fit, those among which chance decides."""
        self.items, self._among = tuple(items), among
        self.open = bool(items) and items[0][1] is None
        self._asked = tuple(dict.fromkeys([test for _, test in items if test is not None]))
        self._which = tuple([-1 if test is None else self._asked.index(test) for _, test in items])
        self.lots: Few[tuple[bool, ...], Lots[Item]] = Few()
        self._free = None if self._asked else self._fitting(())

    def _fitting(self, answers: Sequence[bool]) -> Lots[Item]:
        fits = [item for (item, _), at in zip(self.items, self._which, strict=True) if at < 0 or answers[at]]
        return Lots(self._among(fits))

    def any_usable(self, scope: Scope) -> bool:
        """Whether any of them may be taken."""
        return self.open or any(test is None or test(scope) for _, test in self.items)

    def usable(self, scope: Scope) -> Lots[Item]:
        """Those that may be taken, or said."""
        if self._free is not None:
            return self._free
        answers = tuple([bool(test(scope)) for test in self._asked])
        try:
            return self.lots[answers]
        except KeyError:
            return self.lots.keep(answers, self._fitting(answers))


class ReadyGroup:
    """Lines of which one is said. only: the line where there is no other; recalls: whether it counts how often they
    were heard."""

    __slots__ = ("_left", "_mask", "lines", "only", "order", "recalls")

    def __init__(self, lines: Sequence[ReadyLine], order: Order) -> None:
        self.lines, self.order = tuple(lines), order
        self.only = lines[0] if len(lines) == 1 else None
        self.recalls = order == "shuffled" and any(line.again for line in lines)
        self._mask = sum([line.bit for line in lines])
        self._left: Few[int | tuple[int, int], Left[ReadyLine]] = Few()

    def left(self, said: int, earlier: int) -> Left[ReadyLine]:
        """Those that may still be said. said, earlier: bits of what was said in this talk and on earlier visits."""
        key: int | tuple[int, int] = said & self._mask
        if earlier:
            key = (said & self._mask, earlier & self._mask)
        try:
            return self._left[key]
        except KeyError:
            lines = [(line, line.test) for line in self.lines if line.again or not line.bit & said]
            return self._left.keep(key, Left(lines, partial(self._by_order, earlier)))

    def _by_order(self, earlier: int, lines: Sequence[ReadyLine]) -> Sequence[ReadyLine]:
        """Of lines that fit, those among which chance decides; what was said on earlier visits comes last."""
        if earlier and len(lines) > 1:
            lines = [line for line in lines if not line.bit & earlier] or lines
        return lines[:1] if self.order == "listed" else lines

    def least_heard(self, lots: Lots[ReadyLine], heard: Mapping[str, int]) -> Lots[ReadyLine]:
        """Those heard least often in this talk. heard: how often, by id."""
        least = min([heard.get(line.id, 0) for line in lots.items], default=0)
        return Lots([line for line in lots.items if heard.get(line.id, 0) == least])


class ReadyChoice:
    """A choice in talks about an item. used: its bit, where it is not offered again in the talk; gone: the same, where
    it is not offered again at the stall; shown, needs: what must hold; hidden, ruled_out: what the item settles; always: nothing
    can keep it from being taken.

    texts: its wordings, the bits of which are ``mask``; fresh: by the bits of those said, the others, where each of them
    fits at any time (``fits``).
    """

    __slots__ = (
        "act", "always", "bit", "choice", "effects", "fits", "fresh", "gone", "hidden", "id", "mask", "needs",
        "ruled_out", "shown", "silent", "texts", "used", "ways", "weight",
    )  # fmt: skip

    def __init__(self, choice: ChoiceDef, ready: Prepared) -> None:
        self.choice, self.id, self.bit = choice, choice.id, ready.script.bits[choice.id]
        self.act, self.silent, self.weight = choice.act, choice.silent, choice.weight
        self.used = self.bit if choice.once == "talk" else 0
        self.gone = self.bit if choice.once == "stall" else 0
        shown, needs = ready.open(choice.condition), ready.open(choice.needs)
        self.hidden, self.ruled_out = shown is False, False in (shown, needs)
        # Whoever takes it from a table of other days asks for what the item settles, too.
        self.shown = _never if shown is False else shown
        self.needs = _never if needs is False else needs
        self.always = self.shown is None and self.needs is None and not (self.used or self.gone)
        self.texts = tuple([ready.line(line, choice.id) for line in choice.texts])
        self.mask = sum([line.bit for line in self.texts])
        self.fits = all(line.when is None and line.condition is None for line in choice.texts)
        self.fresh: Few[int, Lots[ReadyLine]] = Few()
        self.effects, self.ways = _effects(choice.effects), ready.ways(choice.to)


class Act:
    """The choices of a pool that perform one act."""

    __slots__ = ("_left", "choices", "gone", "name", "used")

    def __init__(self, name: str, choices: Sequence[tuple[ReadyChoice, Test | None]]) -> None:
        self.name, self.choices = name, tuple(choices)
        self.used = sum([choice.used for choice, _ in choices])
        self.gone = sum([choice.gone for choice, _ in choices])
        self._left: Few[int, Left[ReadyChoice]] = Few()

    def left(self, chosen: int, seen: int) -> Left[ReadyChoice]:
        """What is left of it where so much was chosen in the talk and seen at the stall."""
        used = chosen & self.used | seen & self.gone
        try:
            return self._left[used]
        except KeyError:
            rest = [(choice, test) for choice, test in self.choices if not (choice.used | choice.gone) & used]
            return self._left.keep(used, Left(rest))


class Pool:
    """The choices that a node draws from, by act; count: how many it draws."""

    __slots__ = ("_gone", "_rounds", "_used", "acts", "count", "fair")

    def __init__(self, acts: Sequence[Act], count: int, fair: ActTable) -> None:
        self.acts, self.count, self.fair = tuple(acts), count, fair
        self._used = sum([act.used for act in acts])
        self._gone = sum([act.gone for act in acts])
        self._rounds: Few[int, Round] = Few(1024)

    def round(self, chosen: int, seen: int) -> Round:
        """What is left of it where so much was chosen in the talk and seen at the stall."""
        used = chosen & self._used | seen & self._gone
        try:
            return self._rounds[used]
        except KeyError:
            lefts = {act.name: act.left(chosen, seen) for act in self.acts}
            return self._rounds.keep(used, Round({name: left for name, left in lefts.items() if left.items}, self))


class Round:
    """What is left of a pool, by act; sets: those of its acts that may be on offer together, where each of them is
    there without a question."""

    __slots__ = ("_lefts", "_pool", "_sets")

    def __init__(self, lefts: Mapping[str, Left[ReadyChoice]], pool: Pool) -> None:
        self._lefts, self._pool = lefts, pool
        self._sets = self._fair(lefts) if all(left.open for left in lefts.values()) else None

    def _fair(self, lefts: Mapping[str, Left[ReadyChoice]]) -> Sequence[Sequence[str]]:
        return self._pool.fair.fair_sets(tuple(lefts), self._pool.count) if lefts and self._pool.count > 0 else ()

    def sets(self, scope: Scope) -> tuple[Mapping[str, Left[ReadyChoice]], Sequence[Sequence[str]]]:
        """By act, choices of which some can be taken, and the sets of acts that may be on offer together."""
        if self._sets is not None:
            return self._lefts, self._sets
        here = {name: left for name, left in self._lefts.items() if left.any_usable(scope)}
        return here, self._fair(here)


class ReadyNode:
    """A node in talks about an item. after: what is kept for coming back from its call; says: what it can say, by how
    the player's line landed; pool: what it draws from; laid: its own choices, then the standing ones. table: all that lies
    on it where that is the same in every talk; whoever lays it keeps it here."""

    __slots__ = (
        "after", "call", "effects", "end", "id", "laid", "node", "pool", "says", "stimulus", "table", "waits", "ways",
    )  # fmt: skip

    def __init__(self, node: NodeDef, ready: Prepared) -> None:
        self.node, self.id, self.waits, self.end, self.call = node, node.id, node.waits, node.end, node.call
        self.after = f"after:{node.id}"
        self.effects = _effects(node.effects)
        self.stimulus = Stimulus(node.feel, node.id) if node.feel else None
        self.ways = ready.ways(node.to)
        self.says: dict[str, tuple[ReadySay, ...]] = {}
        acts = ready.acts(node)
        self.pool = Pool(acts, node.draw, ready.script.acts) if acts else None
        laid = [ready.choice(choice) for choice in (*node.choices, *(ready.script.standing if node.standing else ()))]
        self.laid = tuple([choice for choice in laid if not choice.hidden])
        self.table: tuple[tuple[Pair, ...], tuple[Choice, ...]] | None = None

    @property
    def always(self) -> bool:
        """Whether the same lies on the table in every talk about the item."""
        same = [len(choice.texts) == 1 and not choice.texts[0].keeps and choice.always for choice in self.laid]
        return not self.node.pools and bool(same) and all(same)


def _effects(effects: Iterable[EffectDef]) -> tuple[ReadyEffect, ...]:
    return tuple([(effect.name, effect.value.evaluate) for effect in effects])


class Prepared:
    """One script for talks about one item; fills as nodes are passed and never changes what is told."""

    def __init__(self, script: Script, item: str, *, settle: bool = True) -> None:
        """settle: leave out what the item rules out; without, every condition is asked in the talk."""
        self.script, self.item, self.settle = script, item, settle
        self.nodes: dict[str, ReadyNode] = {}
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

    def line(self, line: LineDef, choice: str = "") -> ReadyLine:
        """A line, and the choice that it words."""
        found = self._lines.get(line.id)
        if found is None:
            test = self.open(line.condition)
            test = _never if test is False else test
            found = self._lines[line.id] = ReadyLine(line, self.script.bits[line.id], test, choice)
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

    def acts(self, node: NodeDef) -> tuple[Act, ...]:
        """The choices of a node's pools by act, in the order of ACTS; those that the item rules out are left out."""
        by_act: dict[str, list[tuple[ReadyChoice, Test | None]]] = {act: [] for act in ACTS}
        for definition in itertools.chain.from_iterable(self.script.pools[name] for name in node.pools):
            choice = self.choice(definition)
            if not choice.ruled_out:
                by_act.setdefault(choice.act, []).append((choice, self._question(choice)))
        return tuple([Act(act, choices) for act, choices in by_act.items() if choices])

    def _question(self, choice: ReadyChoice) -> Test | None:
        """What must hold for a choice to be taken, besides that it is not used up."""
        tests = [test for test in (choice.shown, choice.needs) if test is not None]
        if choice.gone and choice.id in self.script.nodes:
            # A node of the same name counts as seen, and nodes have no bits.
            tests.insert(0, lambda scope: choice.id not in scope.visits)
        return _all_of(tests)

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


def _never(scope: Scope) -> bool:
    return False


def _all_of(tests: Sequence[Test]) -> Test | None:
    if len(tests) < 2:
        return tests[0] if tests else None
    first, rest = tests[0], _all_of(tests[1:])
    assert rest is not None
    return lambda scope: first(scope) and rest(scope)
