"""How often autoplay passed each node and took each choice: read from its logs (JSON Lines, plain or gzip)."""

from __future__ import annotations

import gzip
import json
import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from game.core.errors import BadInput, Where
from game.formats.files import check_regular
from game.story import Script

__all__ = ["Heat", "read_heat"]

_MAX_ROW = 100_000
_GZIP = b"\x1f\x8b"


@dataclass(frozen=True)
class Heat:
    """Counts of a log. talks: how many there were; nodes and choices: by id."""

    talks: int
    nodes: Counter[str]
    choices: Counter[str]


def read_heat(path: Path, script: Script) -> Heat:
    """Count the talks at this stall in a log of ``run_game.py autoplay --out``; those at other stalls are passed over.

    Each row tells which nodes its decision led through. What led to a talk's first decision is not among them: the
    greeting counts as far as there is but one way, and where the player was asked. Raises BadInput with file:line for
    a row that is no row of a log, and where no talk at this stall is in it.
    """
    nodes: Counter[str] = Counter()
    choices: Counter[str] = Counter()
    talks = 0
    last: tuple[Any, ...] = ()
    elsewhere = ""
    for number, row in _rows(path):
        try:
            move = json.loads(row)
            stall, passed, node, choice = move["stall"], move["nodes"], move["node"], move["choice"]
            talk = (stall, move["policy"], move["episode"], move.get("visit", 0))
            if not isinstance(passed, list) or not all(
                isinstance(name, str) for name in (*passed, stall, node, choice)
            ):
                raise TypeError
        except (ValueError, KeyError, TypeError, RecursionError):
            raise BadInput(
                where=Where(path, number), expected="a row of `run_game.py autoplay --out`", seen=row.strip()[:60]
            ) from None
        if stall != script.stall:
            elsewhere = stall
            continue
        if talk != last:
            talks, last = talks + 1, talk
            came_back = script.outcomes.get("came_back") if talk[3] > 1 else None
            nodes.update({*_greeting(script, came_back or script.start), node} & script.nodes.keys())
        nodes.update(name for name in passed if name in script.nodes)
        choices[choice] += 1
    if not talks:
        raise BadInput(where=Where(path), expected=f"talks at {script.stall}", seen=elsewhere or "none")
    return Heat(talks, nodes, choices)


def _greeting(script: Script, first: str) -> Iterator[str]:
    """The nodes from the talk's first on, as long as there is only one way."""
    seen: set[str] = set()
    while first in script.nodes and first not in seen:
        seen.add(first)
        yield first
        node = script.nodes[first]
        if node.call is not None:
            yield node.call
        first = node.to[0].target if node.to and node.to[0].condition is None else ""


def _rows(path: Path) -> Iterator[tuple[int, str]]:
    """Lines with their numbers, none longer than a row can be."""
    check_regular(path, "log")
    try:
        with path.open("rb") as raw:
            packed = raw.read(2) == _GZIP
        open_ = gzip.open if packed else open
        with open_(path, "rt", encoding="utf-8", errors="replace") as stream:
            yield from enumerate(iter(lambda: stream.readline(_MAX_ROW), ""), 1)
    except (EOFError, zlib.error) as error:
        raise BadInput(f"cannot unpack this log: {error}", where=Where(path)) from None
    except OSError as error:
        raise BadInput(f"cannot read this log: {error.strerror or error}", where=Where(path)) from None
