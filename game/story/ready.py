"""Lines, choices and nodes as talks about one item use them: everything that does not change in a talk is looked up.

What was said and chosen are bits (``Script.bits``), so that what is left of a group is one ``&`` and a look into a
table that fills as talks go on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from game.story.beat import Choice, Spoken, Stimulus
from game.story.chance import Lots
from game.story.expressions import Scope
from game.story.forms import PERSON_SLOTS
from game.story.model import ChoiceDef, EffectDef, LineDef, NodeDef, Order
from game.story.text import Text
from game.story.vocabulary import Value

if TYPE_CHECKING:
    from game.story.prepared import Prepared

__all__ = [
    "FRESH", "STALE", "Few", "Laid", "Left", "ReadyChoice", "ReadyEffect", "ReadyGroup", "ReadyLine", "ReadyNode",
    "ReadySay", "Test", "Way", "never", "offered", "spoken",
]  # fmt: skip

Test = Callable[[Scope], Any]
ReadySay = tuple[Test | None, "ReadyGroup"]
"""What must hold for a group of lines, and its lines."""
Way = tuple[Test | None, str]
"""What must hold for going on to a node."""
ReadyEffect = tuple[str, Callable[[Scope], Value]]
"""A variable and its new value."""
Laid = tuple[tuple["ReadyChoice", "ReadyLine"], ...]
"""Choices on the table, each with its wording."""

_FIXED_NAMES = frozenset({"item", *PERSON_SLOTS})
"""Names in braces that mean the same throughout all talks about an item."""
FRESH, STALE = "fresh:", "stale:"
"""Before the id of a choice: the passage that begins with it, and with its words where they were not yet said."""
_MOST_KEPT = 128
_MOST_WORDS = 16

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


def spoken(line: LineDef, text: Text) -> Spoken:
    """A line with its words filled in."""
    return Spoken(line.id, line.speaker, text.en, text.ja, line.face, line.tone, line.gesture)


def offered(choice: ReadyChoice, text: Text) -> Choice:
    """A choice that can be taken, with its words filled in."""
    return Choice(choice.id, choice.act, text.en, text.ja, True, None, choice.choice.feel)


def never(scope: Scope) -> bool:
    """The test that nothing passes."""
    return False


class ReadyLine:
    """A line in talks about an item.

    bit: its place among everything said; test: what must hold, as far as the item does not settle it; always: the line
    as it is said, where nothing can keep it from being said so, else empty. spoken, option: the line as it is said and
    as it is offered, by the values of the names in its braces (``asks``; ``keeps`` in an option, where the amount of an
    offer is left open); fixed, offered: where it has none.
    """

    __slots__ = (
        "again", "always", "asks", "bit", "fixed", "id", "keeps", "line", "offered", "option", "spoken", "stimulus",
        "test", "weight", "when",
    )  # fmt: skip

    def __init__(self, line: LineDef, bit: int, test: Test | None) -> None:
        self.line, self.id, self.again, self.when, self.bit, self.test = line, line.id, line.again, line.when, bit, test
        self.weight = line.weight
        self.asks = tuple(sorted(line.text.names - _FIXED_NAMES))
        self.keeps = tuple([name for name in self.asks if name != "offer"])
        self.stimulus = Stimulus(line.feel, line.id) if line.feel else None
        self.fixed: tuple[Spoken, ...] = () if line.text.names else (spoken(line, line.text),)
        self.always = self.fixed if line.again and test is None else ()
        self.spoken: Few[tuple[Value | None, ...], tuple[Spoken, ...]] = Few(_MOST_WORDS)
        self.offered: Choice | None = None
        self.option: Few[tuple[Value | None, ...], Choice] = Few(_MOST_WORDS)


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
        self.lots: Few[int, Lots[Item]] = Few()
        self._free = None if self._asked else self._fitting(1)

    def _fitting(self, answers: int) -> Lots[Item]:
        """answers: a one, then a bit for each question."""
        yes = f"{answers:b}"[1:]
        fits = [item for (item, _), at in zip(self.items, self._which, strict=True) if at < 0 or yes[at] == "1"]
        return Lots(self._among(fits))

    def any_usable(self, scope: Scope) -> bool:
        """Whether any of them may be taken."""
        for _, test in self.items:  # noqa: SIM110 - in the innermost loop of all, without a generator
            if test is None or test(scope):
                return True
        return False

    def usable(self, scope: Scope) -> Lots[Item]:
        """Those that may be taken, or said."""
        if self._free is not None:
            return self._free
        answers = 1
        for test in self._asked:
            answers = answers * 2 + (1 if test(scope) else 0)
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

    def left(self, past: int, earlier: int) -> Left[ReadyLine]:
        """Those that may still be said. past, earlier: bits of this talk and of earlier visits."""
        key: int | tuple[int, int] = past & self._mask
        if earlier:
            key = (past & self._mask, earlier & self._mask)
        try:
            return self._left[key]
        except KeyError:
            lines = [(line, line.test) for line in self.lines if line.again or not line.bit & past]
            return self._left.keep(key, Left(lines, partial(self._by_order, earlier)))

    def _by_order(self, earlier: int, lines: Sequence[ReadyLine]) -> Sequence[ReadyLine]:
        """Of lines that fit, those among which chance decides; what was said on earlier visits comes last."""
        if earlier and len(lines) > 1:
            lines = [line for line in lines if not line.bit & earlier] or lines
        return lines[:1] if self.order == "listed" else lines

    def least_heard(self, lots: Lots[ReadyLine], heard: Sequence[str]) -> Lots[ReadyLine]:
        """Those heard least often in this talk. heard: the ids of all lines of it."""
        times = [heard.count(line.id) for line in lots.items]
        return Lots([line for line, count in zip(lots.items, times, strict=True) if count == min(times)])


class ReadyChoice:
    """A choice in talks about an item. used: its bit, where it is not offered again in the talk; gone: those of its
    id, where it is not offered again at the stall; shown, needs: what must hold; hidden, ruled_out: what the item
    settles; always: nothing can keep it from being taken.

    texts: its wordings, the bits of which are ``mask``; fresh: by the bits of those said, the others, where each of
    them fits at any time (``fits``). way: where it leads whatever holds; onward: its own passages (``FRESH``,
    ``STALE``), where nothing but that is open; else empty.
    """

    __slots__ = (
        "act", "always", "bit", "choice", "effects", "fits", "fresh", "gone", "hidden", "id", "mask", "needs",
        "onward", "ruled_out", "shown", "silent", "texts", "used", "way", "ways", "weight",
    )  # fmt: skip

    def __init__(self, choice: ChoiceDef, ready: Prepared) -> None:
        self.choice, self.id, self.bit = choice, choice.id, ready.script.bits.choices[choice.id]
        self.act, self.silent, self.weight = choice.act, choice.silent, choice.weight
        self.used = self.bit if choice.once == "talk" else 0
        self.gone = ready.script.bits.seen[choice.id] if choice.once == "stall" else 0
        shown, needs = ready.open(choice.condition), ready.open(choice.needs)
        self.hidden, self.ruled_out = shown is False, False in (shown, needs)
        # Whoever takes it from a table of other days asks for what the item settles, too.
        self.shown = never if shown is False else shown
        self.needs = never if needs is False else needs
        self.always = self.shown is None and self.needs is None and not (self.used or self.gone)
        self.texts = tuple([ready.line(line) for line in choice.texts])
        self.mask = sum([line.bit for line in self.texts])
        self.fits = all(line.when is None and line.condition is None for line in choice.texts)
        self.fresh: Few[int, Lots[ReadyLine]] = Few()
        self.effects, self.ways = _effects(choice.effects), ready.ways(choice.to)
        self.way = _only_way(self.ways)
        self.onward = (FRESH + self.id, STALE + self.id) if self._settled(ready.script.nodes.get(self.way)) else ()

    def _settled(self, node: NodeDef | None) -> bool:
        """Whether there is one thing to say at most, and a node follows before which nothing can come."""
        if node is None or node.waits or node.end is not None:
            return False
        return self.silent or (len(self.texts) == 1 and bool(self.texts[0].fixed))


class ReadyNode:
    """A node in talks about an item. after: what is kept for coming back from its call; halts: whether the talk waits
    or ends there; says: what it can say, by how the player's line landed; way: where it leads whatever holds; pool:
    what it draws from; laid: its own choices, then the standing ones. table: all that lies on it, and what the player
    sees of it, where that is the same in every talk.
    """

    __slots__ = (
        "after", "bit", "call", "effects", "end", "halts", "id", "laid", "node", "pool", "says", "stimulus", "table",
        "waits", "way", "ways",
    )  # fmt: skip

    def __init__(self, node: NodeDef, ready: Prepared) -> None:
        self.node, self.id, self.waits, self.end, self.call = node, node.id, node.waits, node.end, node.call
        self.bit, self.halts = ready.script.bits.nodes[node.id], node.waits or node.end is not None
        self.after = f"after:{node.id}"
        self.effects = _effects(node.effects)
        self.stimulus = Stimulus(node.feel, node.id) if node.feel else None
        self.ways = ready.ways(node.to)
        self.way = _only_way(self.ways)
        self.says: dict[str, tuple[ReadySay, ...]] = {}
        self.pool = ready.pool(node)
        laid = [ready.choice(choice) for choice in (*node.choices, *(ready.script.standing if node.standing else ()))]
        self.laid = tuple([choice for choice in laid if not choice.hidden])
        self.table = _table(self.laid) if node.choices and not node.pools else None


def _table(choices: Sequence[ReadyChoice]) -> tuple[Laid, tuple[Choice, ...]] | None:
    """Choices, each with its wording, and as the player sees them; None where that can differ from talk to talk."""
    if not choices or not all(choice.always and len(choice.texts) == 1 and choice.texts[0].fixed for choice in choices):
        return None
    laid = tuple([(choice, choice.texts[0]) for choice in choices])
    return laid, tuple([offered(choice, line.line.text) for choice, line in laid])


def _only_way(ways: Sequence[Way]) -> str:
    """Where it goes on whatever holds, "" where that depends."""
    return ways[0][1] if ways[0][0] is None else ""


def _effects(effects: Iterable[EffectDef]) -> tuple[ReadyEffect, ...]:
    return tuple([(effect.name, effect.value.evaluate) for effect in effects])
