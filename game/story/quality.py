"""Checks of a script that can run: what is never reached, never said, told twice, or gives the feelings away."""

from __future__ import annotations

import itertools

from game.story.checks import plain_targets
from game.story.findings import Findings
from game.story.model import BACK, HOME, NodeDef, Script
from game.story.reach import Reach, choice_conditions, conditions_of, lines_by_way
from game.story.search import Search
from game.story.text import slots
from game.story.translations import check_translations
from game.story.vocabulary import ENV, OUTCOMES, STANDING_ACTS, WHEN
from game.story.winnable import check_winnable

__all__ = ["check_quality"]

# GAME.md's rule for a round: up to four lines to choose from.
_LINES_AT_A_HUB = 4
# Where one of these was found, a part of the script was not read: what it leads to would only seem unreachable.
_HIDES_WAYS = frozenset(
    {
        *("E_MISSING_TARGET", "E_UNKNOWN_POOL", "E_UNKNOWN_OUTCOME", "E_UNKNOWN_ENDING", "E_UNKNOWN_ITEM"),
        *("E_UNKNOWN_KEY", "E_MISSING_KEY", "E_UNKNOWN_ACT", "E_UNKNOWN_NAME", "E_BAD_VALUE", "E_NO_WAY_ON"),
        *("E_MISSING_ID", "E_BAD_ID", "E_DUPLICATE_ID"),
        *("E_EXPR_SYNTAX", "E_EXPR_TYPE", "E_EXPR_FORBIDDEN", "E_EXPR_SIZE"),
    }
)


def check_quality(script: Script, findings: Findings, purse: int | None = None) -> None:
    """Warnings and remarks about one script. purse: what the player can spend, for what costs more than that."""
    if not any(finding.code in _HIDES_WAYS for finding in findings.all if finding.where.path in script.files):
        reach = Reach(script)
        _conditions(script, reach, findings)
        _never_drawn(script, reach, findings)
        _unreached(script, reach, findings)
        _unused(script, findings)
        check_winnable(script, reach, findings, purse)
        _ways_tell(script, findings)
    check_translations(script, findings)
    _outcomes_end(script, findings)
    _hubs(script, findings)
    _reactions(script, findings)
    _repeated(script, findings)


def _conditions(script: Script, reach: Reach, findings: Findings) -> None:
    search = Search(script, reach)
    for condition in conditions_of(script):
        expression = condition.expression
        if not reach.holds(expression):
            findings.add("W_NEVER", condition.where, f"never true: {expression.source!r}, for {condition.what}")
        elif not search.holds(expression):
            message = f"true in no state that a talk can reach: {expression.source!r}, for {condition.what}"
            findings.add("W_NEVER", condition.where, message)
        elif not reach.fails(expression):
            findings.add("I_ALWAYS", condition.where, f"always true: {expression.source!r}, for {condition.what}")


def _never_drawn(script: Script, reach: Reach, findings: Findings) -> None:
    """Choices of a pool whose act stands in no set of lines that may be drawn, whatever else is used up by then."""
    hubs = [node for node in script.nodes.values() if node.id in reach.nodes and node.pools and node.draw]
    for name, choices in script.pools.items():
        drawing = [node for node in hubs if name in node.pools]
        for act in dict.fromkeys(choice.act for choice in choices) if drawing else ():
            if not any(_can_be_drawn(script, act, node) for node in drawing):
                first = next(choice for choice in choices if choice.act == act)
                others = "the others are right for more feelings without it"
                findings.add("W_NEVER_DRAWN", first.where, f"no line of the act {act!r} is ever drawn", others)


def _can_be_drawn(script: Script, act: str, node: NodeDef) -> bool:
    pool = [choice for name in node.pools for choice in script.pools.get(name, ())]
    lasting = {c.act for c in pool if c.once == "never" and c.condition is None and c.needs is None}
    passing = [other for other in dict.fromkeys(c.act for c in pool) if other not in lasting and other != act]
    for size in range(len(passing), -1, -1):
        for there in itertools.combinations(passing, size):
            available = tuple({*lasting, *there, act})
            if any(act in acts for acts in script.acts.fair_sets(available, node.draw)):
                return True
    return False


def _unreached(script: Script, reach: Reach, findings: Findings) -> None:
    for node in script.nodes.values():
        if node.id not in reach.nodes:
            findings.add("W_UNREACHABLE", node.where, f"nothing leads to the node {node.id!r}")


def _outcomes_end(script: Script, findings: Findings) -> None:
    """An outcome that ends the talk must reach an end on every way."""
    for kind, first in script.outcomes.items():
        if not OUTCOMES[kind]:
            continue
        # (node, whether it was called: a called node goes `back` to its caller, which goes on)
        queue: list[tuple[str, bool]] = [(first, False)]
        done: set[tuple[str, bool]] = set()
        while queue:
            name, called = queue.pop()
            if (name, called) in done:
                continue
            done.add((name, called))
            node = script.nodes[name]
            lost = {HOME} if called else {HOME, BACK}
            if node.waits or any(branch.target in lost for branch in node.to):
                findings.add(
                    "W_ENDING_FALLS_BACK", node.where, f"{kind} ends the talk, but {name!r} leads back into it"
                )
            elif node.end is None:
                queue.extend((branch.target, called) for branch in node.to if branch.target in script.nodes)
                if node.call:
                    queue.append((node.call, True))


def _hubs(script: Script, findings: Findings) -> None:
    for node in script.nodes.values():
        if not node.waits:
            continue
        pool = [choice for name in node.pools for choice in script.pools.get(name, ())]
        always = [choice for choice in pool if choice.condition is None and choice.needs is None]
        drawn = min(node.draw, len(pool))
        if drawn + len(node.choices) < _LINES_AT_A_HUB:
            findings.add(
                "W_FEW_CHOICES",
                node.where,
                f"{node.id!r} offers {drawn + len(node.choices)} lines",
                f"at least {_LINES_AT_A_HUB}",
            )
        acts = tuple(dict.fromkeys(choice.act for choice in always))
        if pool and not node.choices and acts:
            best = max(script.acts.coverage(acts_) for acts_ in script.acts.fair_sets(acts, node.draw))
            if best < script.acts.right_for_at_least:
                findings.add(
                    "W_FEW_CHOICES",
                    node.where,
                    f"the lines that {node.id!r} can draw are right for {best} of 7 feelings",
                    "add acts: " + ", ".join(act for act in script.acts.quality if act not in acts)[:120],
                )
        fixed = tuple(dict.fromkeys(c.act for c in node.choices if c.act not in STANDING_ACTS))
        if fixed and not pool and len(script.acts.right_acts(fixed)) == 1:
            findings.add("W_ONE_RIGHT", node.where, f"only one of the lines of {node.id!r} can be right: {fixed[0]}")
    hidden = {name for name, known in ENV.items() if known.hidden}
    for choice in script.all_choices():
        for expression in choice_conditions(choice):
            leaks = sorted(expression.names & hidden)
            if leaks:
                findings.add(
                    "W_LEAK",
                    expression.where,
                    f"the choice {choice.id!r} is on offer by {', '.join(leaks)}: it tells what is felt",
                )


def _ways_tell(script: Script, findings: Findings) -> None:
    """Ways that part by how a line landed and wait at different places tell it, even where her words do not."""
    nodes = script.nodes.values()
    lists = [node.to for node in nodes] + [choice.to for choice in script.all_choices()]
    hidden = {name for name, known in ENV.items() if known.hidden}
    for branches in lists:
        asked = [b for b in branches if b.condition is not None and b.condition.names & hidden]
        asked = [b for b in asked if b.condition is not None and "tells" not in b.condition.names]
        if asked and len({frozenset(_waits_after(script, branch.target)) for branch in branches}) > 1:
            findings.add(
                "W_LEAK",
                asked[0].where,
                "where the talk waits next tells how the line landed, even where her words hide it",
                "lead back to the same place, or ask for `tells` too",
            )


def _waits_after(script: Script, target: str) -> set[str]:
    """The places where a talk can wait next after going to a node."""
    queue, done, waits = [target], set(), set()
    while queue:
        name = queue.pop()
        name = script.home if name == HOME else name
        if name in done:
            continue
        done.add(name)
        node = script.nodes.get(name)
        if node is None or node.waits or node.end is not None:
            waits.add(name)
        else:
            queue.extend(branch.target for branch in node.to)
    return waits


def _reactions(script: Script, findings: Findings) -> None:
    """An answer that depends on how the line landed needs words for each way, said or hidden."""
    for first in dict.fromkeys(branch.target for choice in script.all_choices() for branch in choice.to):
        ways: list[tuple[str | None, bool]] = []
        queue, done = [first], set()
        while queue:
            name = queue.pop()
            if name in done or name not in script.nodes or script.nodes[name].waits:
                continue
            done.add(name)
            ways.extend((way, bound) for way, bound, _ in lines_by_way(script.nodes[name].says))
            queue.extend(plain_targets(script.nodes[name]))
        if not any(way for way, _ in ways) or (None, False) in ways:
            continue
        missing = [way for way in WHEN if (way, False) not in ways]
        if missing:
            findings.add(
                "W_SILENT_REACTION",
                script.nodes[first].where,
                f"{first!r} has nothing to say when: {', '.join(missing)}",
                "a line for each, without a condition, here or where it leads",
            )


def _repeated(script: Script, findings: Findings) -> None:
    for language in ("en", "ja"):
        first: dict[str, str] = {}
        for line in script.all_lines():
            words = " ".join(line.text.get(language).lower().split()) if getattr(line.text, language) else ""
            if words and first.setdefault(words, line.id) != line.id:
                findings.add(
                    "W_REPEATED_TEXT",
                    line.where,
                    f"{line.id!r} says the same as {first[words]!r} ({language})",
                    "use one id for one line, or other words",
                )


def _unused(script: Script, findings: Findings) -> None:
    pools = {name for node in script.nodes.values() for name in node.pools}
    endings = {node.end for node in script.nodes.values()}
    names = {name for condition in conditions_of(script) for name in condition.expression.names}
    for effects in [node.effects for node in script.nodes.values()] + [c.effects for c in script.all_choices()]:
        for effect in effects:
            names |= effect.value.names - {effect.name}
    for line in script.all_lines():
        names |= {name for name, _ in slots(line.text.en)} | {name for name, _ in slots(line.text.ja)}
    for name, choices in script.pools.items():
        if name not in pools and choices:
            findings.add("W_UNUSED", choices[0].where, f"no node draws from the pool {name!r}")
    for name, ending in script.endings.items():
        if name not in endings:
            findings.add("W_UNUSED", ending.where, f"no node ends with {name!r}")
    for name, variable in script.variables.items():
        if name not in names:
            findings.add("W_UNUSED", variable.where, f"nothing asks for the variable {name!r}")
