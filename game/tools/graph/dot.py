"""The same graph for Graphviz and its friends: DOT text."""

from __future__ import annotations

from game.tools.graph.heat import Heat
from game.tools.graph.model import Graph
from game.tools.graph.svg import ACT_COLOURS

__all__ = ["dot_of"]


def dot_of(graph: Graph, heat: Heat | None = None) -> str:
    """Nodes, edges with their conditions, frames as clusters; red is dead."""
    rows = [
        "digraph talk {",
        f'  graph [rankdir=LR, label={_quoted(graph.title)}, labelloc=t, fontname="sans-serif"];',
        '  node [shape=box, style="rounded,filled", fillcolor=white, fontname="sans-serif"];',
        '  edge [fontname="sans-serif", fontsize=10];',
    ]
    for name, card in graph.cards.items():
        label = card.id if not card.says else f"{card.id}\n{card.says[0]}"
        if heat is not None and not card.outcome:
            label += f"\n{heat.nodes[card.id]} visits"
        colour = ", color=red, fontcolor=red" if card.dead else ", penwidth=2" if card.waits else ""
        rows.append(f"  {_quoted(name)} [label={_quoted(label)}{colour}];")
    for number, ((source, act), names) in enumerate(graph.groups.items()):
        inside = " ".join(_quoted(name) for name in names)
        rows.append(f"  subgraph cluster_{number} {{ label={_quoted(f'{act}, from {source}')}; {inside} }}")
    for edge in graph.edges:
        colour = "red" if edge.dead else ACT_COLOURS.get(edge.act, "#9a9184")
        style = ", style=dashed" if edge.kind in {"call", "outcome"} else ""
        label = f", label={_quoted(edge.condition)}" if edge.condition else ""
        rows.append(f"  {_quoted(edge.source)} -> {_quoted(edge.target)} [color={_quoted(colour)}{style}{label}];")
    return "\n".join([*rows, "}", ""])


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'
