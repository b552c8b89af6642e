"""How often autoplay passed each node and took each choice: read from its logs (JSON Lines)."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from game.core.errors import BadInput, Where
from game.story import Script

__all__ = ["Heat", "read_heat"]

_MAX_ROW = 100_000


@dataclass(frozen=True)
class Heat:
    """Counts of a log. talks: how many there were; nodes and choices: by id."""

    talks: int
    nodes: Counter[str]
    choices: Counter[str]


def read_heat(path: Path, script: Script) -> Heat:
    """Count a log of ``run_game.py autoplay --out``. Raises BadInput with file:line for a row that is none of its.

    A node counts for each row in which one of its lines was spoken, to which the choice or its outcome leads, or in
    which the talk waited there.
    """
    node_of = {line.id: node.id for node in script.nodes.values() for say in node.says for line in say.lines}
    nodes: Counter[str] = Counter()
    choices: Counter[str] = Counter()
    talks: set[tuple[str, str]] = set()
    sure = {c.id: c.to[0].target for c in script.all_choices() if c.to[0].condition is None}
    try:
        stream = path.open(encoding="utf-8", errors="replace")
    except OSError as error:
        raise BadInput(f"cannot read this log: {error.strerror or error}", where=Where(path)) from None
    with stream:
        for number, row in enumerate(iter(lambda: stream.readline(_MAX_ROW), ""), 1):
            try:
                move = json.loads(row)
                lines, node, choice = move["lines"], move["node"], move["choice"]
                if not isinstance(lines, list) or not isinstance(node, str) or not isinstance(choice, str):
                    raise TypeError
            except (ValueError, KeyError, TypeError, RecursionError):
                raise BadInput(
                    where=Where(path, number), expected="a row of `run_game.py autoplay --out`", seen=row.strip()[:60]
                ) from None
            talk = (str(move.get("policy", "")), str(move.get("episode")))
            passed = {node_of[line] for line in lines if isinstance(line, str) and line in node_of} | {node}
            # Nodes may say nothing: those a choice or an outcome surely leads to were passed all the same.
            passed |= {sure.get(choice, ""), script.outcomes.get(str(move.get("outcome")), "")}
            if talk not in talks:
                passed.add(script.start)
            talks.add(talk)
            nodes.update(passed & script.nodes.keys())
            choices[choice] += 1
    return Heat(len(talks), nodes, choices)
