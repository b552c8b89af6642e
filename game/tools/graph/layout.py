"""Where cards stand: layers from left to right, few crossings, no overlaps (Sugiyama, Tagawa, Toda 1981).

1. circles are cut at the edges that lead back (depth-first search), 2. layers by longest path, 3. long edges get a
stop in every layer they pass, 4. each layer is ordered by the barycentres of its neighbours, in sweeps, 5. boxes are
moved towards their neighbours without overlapping.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

__all__ = ["Box", "Layout", "lay_out"]

GAP_X, GAP_Y = 84.0, 22.0
_SWEEPS = 12
_STOP = 10.0


@dataclass(frozen=True)
class Box:
    """A placed box: left, top, width, height in pixels."""

    x: float
    y: float
    w: float
    h: float


@dataclass(frozen=True)
class Layout:
    """Boxes by name, and the points that each edge passes between its ends."""

    boxes: dict[str, Box]
    bends: dict[tuple[str, str], list[tuple[float, float]]]

    @property
    def width(self) -> float:
        return max((box.x + box.w for box in self.boxes.values()), default=0.0)

    @property
    def height(self) -> float:
        return max((box.y + box.h for box in self.boxes.values()), default=0.0)


def lay_out(
    sizes: Mapping[str, tuple[float, float]],
    edges: Sequence[tuple[str, str]],
    roots: Sequence[str],
    shape: float = 1.5,
) -> Layout:
    """Boxes by name, and for each edge the points between its ends that it should pass.

    sizes: (width, height) by name, in the order in which equals are to stand; roots: what stands first; shape: width
    to height that the whole should come near. What does not hang together is laid out by itself and packed.
    """
    parts = [_layered(part, edges, roots) for part in _components(sizes, edges)]
    parts.sort(key=lambda part: -part.height)
    widest = max((part.width for part in parts), default=0.0)
    total = sum((part.width + GAP_X) * (part.height + GAP_Y) for part in parts)
    limit = max(widest, math.sqrt(total * shape))
    boxes: dict[str, Box] = {}
    bends: dict[tuple[str, str], list[tuple[float, float]]] = {}
    x = y = shelf = 0.0
    for part in parts:
        if x > 0 and x + part.width > limit:
            x, y, shelf = 0.0, y + shelf + 2 * GAP_Y, 0.0
        boxes |= {name: Box(box.x + x, box.y + y, box.w, box.h) for name, box in part.boxes.items()}
        bends |= {edge: [(px + x, py + y) for px, py in points] for edge, points in part.bends.items()}
        x, shelf = x + part.width + GAP_X, max(shelf, part.height)
    return Layout(boxes, bends)


def _components(
    sizes: Mapping[str, tuple[float, float]], edges: Sequence[tuple[str, str]]
) -> list[dict[str, tuple[float, float]]]:
    """What hangs together, each in the order given."""
    links: dict[str, list[str]] = {}
    for source, target in edges:
        links.setdefault(source, []).append(target)
        links.setdefault(target, []).append(source)
    owner: dict[str, int] = {}
    for number, name in enumerate(sizes):
        stack = [name] if name not in owner else []
        while stack:
            found = stack.pop()
            if found not in owner:
                owner[found] = number
                stack.extend(links.get(found, ()))
    parts: dict[int, dict[str, tuple[float, float]]] = {}
    for name, size in sizes.items():
        parts.setdefault(owner[name], {})[name] = size
    return list(parts.values())


def _layered(
    sizes: Mapping[str, tuple[float, float]], edges: Sequence[tuple[str, str]], roots: Sequence[str]
) -> Layout:
    """One connected part, in layers."""
    edges = [edge for edge in edges if edge[0] in sizes]
    forward = _without_circles(sizes, edges, [root for root in roots if root in sizes])
    layer = _layers(sizes, forward)
    chains: dict[tuple[str, str], list[str]] = {}
    heights = {name: size[1] for name, size in sizes.items()}
    rows: list[list[str]] = [[] for _ in range(max(layer.values(), default=0) + 1)]
    for name in sizes:
        rows[layer[name]].append(name)
    neighbours: list[tuple[str, str]] = []
    for source, target in forward:
        chain = [source]
        for level in range(layer[source] + 1, layer[target]):
            stop = f"\0{source}\0{target}\0{level}"
            heights[stop] = _STOP
            rows[level].append(stop)
            chain.append(stop)
        chain.append(target)
        chains[source, target] = chain
        neighbours += itertools.pairwise(chain)
    _order(rows, neighbours)
    tops = _tops(rows, neighbours, heights)
    widths = [max((sizes[name][0] for name in row if name in sizes), default=0.0) for row in rows]
    lefts = [sum(widths[:i]) + GAP_X * i for i in range(len(rows))]
    boxes = {name: Box(lefts[layer[name]], tops[name], *size) for name, size in sizes.items()}
    level_of = {name: i for i, row in enumerate(rows) for name in row}
    bends = {
        edge: [
            point
            for stop in chain[1:-1]
            for point in (
                (lefts[level_of[stop]], tops[stop] + _STOP / 2),
                (lefts[level_of[stop]] + widths[level_of[stop]], tops[stop] + _STOP / 2),
            )
        ]
        for edge, chain in chains.items()
    }
    return Layout(boxes, bends)


def _without_circles(
    names: Mapping[str, object], edges: Sequence[tuple[str, str]], roots: Sequence[str]
) -> list[tuple[str, str]]:
    """The edges, each once, without those that lead back to where a walk came from."""
    out: dict[str, list[str]] = {}
    for source, target in dict.fromkeys(edges):
        if source != target:
            out.setdefault(source, []).append(target)
    kept: list[tuple[str, str]] = []
    state: dict[str, int] = {}
    for root in (*roots, *names):
        if state.get(root):
            continue
        state[root] = 1
        stack = [(root, iter(out.get(root, ())))]
        while stack:
            name, ways = stack[-1]
            way = next(ways, None)
            if way is None:
                state[name] = 2
                stack.pop()
            elif state.get(way) != 1:
                kept.append((name, way))
                if way not in state:
                    state[way] = 1
                    stack.append((way, iter(out.get(way, ()))))
    return kept


def _layers(names: Mapping[str, object], edges: Sequence[tuple[str, str]]) -> dict[str, int]:
    """The longest way to each name; what has no way to it stands just before what it leads to."""
    into: dict[str, list[str]] = {name: [] for name in names}
    out: dict[str, list[str]] = {name: [] for name in names}
    for source, target in edges:
        into[target].append(source)
        out[source].append(target)
    layer: dict[str, int] = {}
    waiting = {name: len(found) for name, found in into.items()}
    ready = [name for name in names if not waiting[name]]
    while ready:
        name = ready.pop(0)
        layer[name] = max((layer[source] + 1 for source in into[name]), default=0)
        for target in out[name]:
            waiting[target] -= 1
            if not waiting[target]:
                ready.append(target)
    for name in names:
        if not into[name] and out[name]:
            layer[name] = max(0, min(layer[target] for target in out[name]) - 1)
    return layer


def _order(rows: list[list[str]], neighbours: Sequence[tuple[str, str]]) -> None:
    """Order every layer by the mean place of its neighbours, forth and back."""
    into: dict[str, list[str]] = {}
    out: dict[str, list[str]] = {}
    for source, target in neighbours:
        into.setdefault(target, []).append(source)
        out.setdefault(source, []).append(target)
    for sweep in range(_SWEEPS):
        links, levels = (into, range(1, len(rows))) if sweep % 2 == 0 else (out, range(len(rows) - 2, -1, -1))
        for level in levels:
            place = {name: i for row in rows for i, name in enumerate(row)}
            keys = {}
            for i, name in enumerate(rows[level]):
                found = links.get(name, ())
                keys[name] = sum(place[other] for other in found) / len(found) if found else float(i)
            rows[level].sort(key=lambda name: keys[name])


def _tops(
    rows: Sequence[Sequence[str]], neighbours: Sequence[tuple[str, str]], heights: Mapping[str, float]
) -> dict[str, float]:
    """The top of every box: stacked first, then pulled towards the middle of the neighbours."""
    links: dict[str, list[str]] = {}
    for source, target in neighbours:
        links.setdefault(source, []).append(target)
        links.setdefault(target, []).append(source)
    top: dict[str, float] = {}
    tallest = max((sum(heights[n] + GAP_Y for n in row) for row in rows), default=0.0)
    for row in rows:
        at = (tallest - sum(heights[name] + GAP_Y for name in row)) / 2
        for name in row:
            top[name] = at
            at += heights[name] + GAP_Y
    for _ in range(_SWEEPS):
        for row in rows:
            wanted = {}
            for name in row:
                found = [top[other] + heights[other] / 2 for other in links.get(name, ())]
                middle = sum(found) / len(found) if found else top[name] + heights[name] / 2
                wanted[name] = middle - heights[name] / 2
            _pull(row, wanted, heights, top)
    least = min(top.values(), default=0.0)
    return {name: value - least for name, value in top.items()}


def _pull(row: Sequence[str], wanted: Mapping[str, float], heights: Mapping[str, float], top: dict[str, float]) -> None:
    """Put a layer's boxes where they want to be, as near as their order allows (isotonic regression by blocks)."""
    blocks: list[tuple[list[str], float, float]] = []  # names, sum of the wanted starts, height
    for name in row:
        names, total, height = [name], wanted[name], heights[name] + GAP_Y
        while blocks and blocks[-1][1] / len(blocks[-1][0]) + blocks[-1][2] > total / len(names):
            before, sum_before, high = blocks.pop()
            total = sum_before + total - high * len(names)
            names, height = before + names, high + height
        blocks.append((names, total, height))
    for names, total, _ in blocks:
        at = total / len(names)
        for name in names:
            top[name] = at
            at += heights[name] + GAP_Y
