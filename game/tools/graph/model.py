"""What a picture of a dialogue shows: cards for nodes, what leads to them, where they go, what is dead."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from game.story import OUTCOMES, Script
from game.story.expressions import Expression
from game.story.model import BACK, HOME, Branch, ChoiceDef, NodeDef
from game.story.reach import Reach, conditions_of
from game.story.search import Search

__all__ = ["Card", "Edge", "Graph", "Row", "graph_of"]


@dataclass(frozen=True)
class Row:
    """A row on a card: a choice that leads here, or a way on. dead: it can never be taken."""

    text: str
    condition: str = ""
    act: str = ""
    dead: bool = False
    id: str = ""


@dataclass(frozen=True)
class Edge:
    """source and target: names of cards. kind: choice, way, call or outcome; act: of a choice."""

    source: str
    target: str
    kind: str
    act: str = ""
    condition: str = ""
    dead: bool = False


@dataclass(frozen=True)
class Card:
    """One node. says: its lines in the picture's language; detail: everything, for the page's side panel."""

    id: str
    says: tuple[str, ...]
    arrivals: tuple[Row, ...]
    ways: tuple[Row, ...]
    marks: tuple[str, ...]
    waits: bool
    dead: bool
    place: str
    detail: Mapping[str, object] = field(default_factory=dict)
    outcome: bool = False


@dataclass(frozen=True)
class Graph:
    """The whole picture's content. start: the first node; groups: cards that one hub's choices of one act reach."""

    title: str
    language: str
    start: str
    cards: Mapping[str, Card]
    edges: tuple[Edge, ...]
    groups: Mapping[tuple[str, str], tuple[str, ...]]


def graph_of(script: Script, language: str = "en") -> Graph:
    """Cards and edges of a script. Raises BadInput for an unknown language."""
    reach = Reach(script)
    search = Search(script, reach)
    dead = {
        id(condition.expression)
        for condition in conditions_of(script)
        if not reach.holds(condition.expression) or not search.holds(condition.expression)
    }
    edges = tuple(_edges(script, dead))
    arrivals = _arrivals(script, language, dead)
    cards = {
        node.id: _card(script, node, language, arrivals.get(node.id, ()), node.id not in reach.nodes, dead)
        for node in script.nodes.values()
    }
    for kind, target in script.outcomes.items():
        ends = "ends the talk" if OUTCOMES[kind] else "the talk goes on"
        row = Row(f"→ {target}", id=target)
        cards[f"outcome {kind}"] = Card(kind, (ends,), (), (row,), (), False, False, "", {}, outcome=True)
    return Graph(
        f"{script.title.get(language)} · {script.person.name.get(language)}",
        language,
        script.start,
        cards,
        edges,
        _groups(script, edges),
    )


def _edges(script: Script, dead: set[int]) -> Iterable[Edge]:
    for kind, target in script.outcomes.items():
        yield Edge(f"outcome {kind}", target, "outcome")
    for node in script.nodes.values():
        for branch in node.to:
            yield from _way(script, node.id, branch, "way", "", dead)
        if node.call:
            yield Edge(node.id, node.call, "call")
        for choice in script.choices_at(node) if node.waits else ():
            if choice in script.standing and node.id != script.home:
                continue  # the same everywhere: drawn once, from the main hub
            for branch in choice.to:
                off = _never(choice, dead)
                yield from _way(script, node.id, branch, "choice", choice.act, dead, off)


def _way(
    script: Script, source: str, branch: Branch, kind: str, act: str, dead: set[int], off: bool = False
) -> Iterable[Edge]:
    target = script.home if branch.target == HOME else branch.target
    if target == BACK or (target == script.home and source != script.start):
        return  # a mark on the card says it
    off = off or (branch.condition is not None and id(branch.condition) in dead)
    yield Edge(source, target, kind, act, "" if branch.condition is None else branch.condition.source, off)


def _never(choice: ChoiceDef, dead: set[int]) -> bool:
    return any(guard is not None and id(guard) in dead for guard in (choice.condition, choice.needs))


def _arrivals(script: Script, language: str, dead: set[int]) -> dict[str, list[Row]]:
    """The choices that lead to each node, in the words the player says."""
    out: dict[str, list[Row]] = {}
    for choice in script.all_choices():
        conditions = [guard.source for guard in (choice.condition, choice.needs) if guard is not None]
        for branch in choice.to:
            if branch.target not in script.nodes:
                continue
            asked = [*conditions, *([branch.condition.source] if branch.condition is not None else [])]
            text = choice.texts[0].text.get(language)
            more = f" (+{len(choice.texts) - 1})" if len(choice.texts) > 1 else ""
            off = _never(choice, dead) or (branch.condition is not None and id(branch.condition) in dead)
            row = Row(text + more, " and ".join(asked), choice.act, off, choice.id)
            out.setdefault(branch.target, []).append(row)
    return out


def _card(
    script: Script, node: NodeDef, language: str, arrivals: Sequence[Row], unreached: bool, dead: set[int]
) -> Card:
    lines = [line for say in node.says for line in say.lines]
    ways: list[Row] = []
    marks: list[str] = []
    for branch in node.to:
        condition = "" if branch.condition is None else branch.condition.source
        if not condition and branch.target in {HOME, script.home}:
            marks.append("home")
        elif not condition and branch.target == BACK:
            marks.append("back")
        else:
            off = branch.condition is not None and id(branch.condition) in dead
            ways.append(Row(f"→ {branch.target}", condition, "", off, branch.target))
    if node.call:
        ways.insert(0, Row(f"calls {node.call}", id=node.call))
    if node.end:
        marks.append(f"end: {node.end}")
    if node.waits:
        pools = ", ".join(node.pools)
        marks.append(f"waits: {pools}" if pools else "waits")
    if node.timer:
        marks.append(f"{node.timer.seconds:g} s")
    sets = ", ".join(f"{effect.name} = {effect.value.source}" for effect in node.effects)
    if sets:
        ways.append(Row(f"set {sets}"))
    return Card(
        id=node.id,
        says=tuple(line.text.get(language) for line in lines),
        arrivals=tuple(arrivals),
        ways=tuple(ways),
        marks=tuple(marks),
        waits=node.waits,
        dead=unreached,
        place=str(node.where),
        detail={
            "lines": [
                {
                    "id": line.id,
                    "en": line.text.en,
                    "ja": line.text.ja,
                    "if": _source(line.condition),
                    "when": line.when or "",
                    "dead": line.condition is not None and id(line.condition) in dead,
                }
                for line in lines
            ],
            "here": [
                {
                    "id": choice.id,
                    "act": choice.act,
                    "en": choice.texts[0].text.en,
                    "ja": choice.texts[0].text.ja,
                    "if": " and ".join(g.source for g in (choice.condition, choice.needs) if g is not None),
                    "dead": _never(choice, dead),
                }
                for choice in (script.choices_at(node) if node.waits else ())
            ],
        },
    )


def _source(expression: Expression | None) -> str:
    return "" if expression is None else expression.source


def _groups(script: Script, edges: Sequence[Edge]) -> dict[tuple[str, str], tuple[str, ...]]:
    """Cards that are reached only by one place's choices of one act: drawn together, with one edge for all."""
    sources: dict[str, set[tuple[str, str, str]]] = {}
    for edge in edges:
        sources.setdefault(edge.target, set()).add((edge.kind, edge.source, edge.act))
    out: dict[tuple[str, str], list[str]] = {}
    for name in script.nodes:
        found = sources.get(name, set())
        if len(found) == 1 and name != script.start and name != script.home:
            kind, source, act = next(iter(found))
            if kind == "choice":
                out.setdefault((source, act), []).append(name)
    return {key: tuple(names) for key, names in out.items() if len(names) > 1}
