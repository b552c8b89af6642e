"""What must hold for a script to run at all: no loops without a wait, no place where the player is stuck."""

from __future__ import annotations

from collections.abc import Iterator

from game.core.errors import Where
from game.story.findings import Findings
from game.story.model import BACK, HOME, ChoiceDef, NodeDef, Script

__all__ = ["check_structure", "plain_targets"]


def plain_targets(node: NodeDef) -> Iterator[str]:
    """Nodes that a node leads to by itself (not by choices), ``back`` and ``home`` left out."""
    for branch in node.to:
        if branch.target not in {BACK, HOME}:
            yield branch.target
    if node.call:
        yield node.call


def check_structure(script: Script, findings: Findings, home: Where, standing: Where) -> None:
    """Errors that concern the script as a whole."""
    hub = script.nodes[script.home]
    if not hub.waits or not hub.standing:
        findings.add("E_BAD_VALUE", home, f"home: {script.home!r} is no hub with standing choices")
    if not any(choice.act == "leave" and _always(choice) for choice in script.standing):
        findings.add(
            "E_NO_EXIT",
            standing,
            "no standing choice that always lets the player go",
            "act: leave with once: false, and neither if: nor needs:",
        )
    for node in script.nodes.values():
        if node.waits and not node.standing and not any(_always(choice) for choice in node.choices):
            findings.add(
                "E_RUNS_DRY",
                node.where,
                f"all choices of {node.id!r} can be used up",
                "leave standing: on, or give one choice once: false and no condition",
            )
    _check_loops(script, findings)


def _always(choice: ChoiceDef) -> bool:
    return choice.once == "never" and choice.condition is None and choice.needs is None


def _check_loops(script: Script, findings: Findings) -> None:
    """Depth-first search for cycles among the nodes that do not wait."""
    done: set[str] = set()
    for first in script.nodes:
        path: list[str] = []
        stack: list[tuple[str, bool]] = [(first, False)]
        while stack:
            name, leaving = stack.pop()
            if leaving:
                path.pop()
                done.add(name)
                continue
            if name in path:
                cycle = " -> ".join([*path[path.index(name) :], name])
                findings.add("E_LOOP", script.nodes[name].where, f"never waits for the player: {cycle}")
                continue
            node = script.nodes[name]
            if name in done or node.waits:
                continue
            path.append(name)
            stack.append((name, True))
            stack.extend((target, False) for target in plain_targets(node) if target in script.nodes)
