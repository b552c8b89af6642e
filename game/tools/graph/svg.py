"""The picture itself: cards in frames, joined by curves, as one SVG without scripts or outside files."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

from game.tools.graph.heat import Heat
from game.tools.graph.layout import Box, lay_out
from game.tools.graph.model import Card, Edge, Graph, Row

__all__ = ["ACT_COLOURS", "svg_of"]

CARD_W, FRAME_GAP, FRAME_PAD, FRAME_HEAD = 258.0, 14.0, 16.0, 34.0
MARGIN, TOP = 48.0, 132.0
_ASPECT = 1.5
_ROWS_SHOWN = 3
ACT_COLOURS: Mapping[str, str] = {
    "praise": "#c9742b",
    "joke": "#b8960c",
    "empathise": "#2f7f79",
    "story": "#6a4fa3",
    "press": "#b23a48",
    "flaw": "#7b5b45",
    "apologise": "#3b6fb6",
    "small_talk": "#5b8a3a",
    "offer": "#2b2b2b",
    "wait": "#8a8a8a",
    "leave": "#8a8a8a",
}
_INK, _FAINT, _PAPER, _LINE, _DEAD, _HUB = "#2d2a26", "#746d62", "#fbf8f1", "#d5ccba", "#c4291c", "#34507e"
_FONT = "'Source Sans 3','Source Sans Pro','Hiragino Sans','Noto Sans CJK JP','IPAexGothic',sans-serif"
_MONO = "'JetBrains Mono','DejaVu Sans Mono',Menlo,Consolas,monospace"


@dataclass(frozen=True)
class _Piece:
    """A row of text on a card: its height includes the room above it."""

    text: str
    size: float
    colour: str
    height: float
    bold: bool = False
    mono: bool = False
    bar: str = ""
    title: str = ""
    indent: float = 0.0


def svg_of(graph: Graph, heat: Heat | None = None) -> str:
    """The picture as text. Frames get as many columns as bring the whole nearest to a page's shape."""
    bodies = {name: _pieces(card, graph.language, heat, name == graph.start) for name, card in graph.cards.items()}
    heights = {name: 12.0 + sum(piece.height for piece in pieces) for name, pieces in bodies.items()}
    best = min((_arranged(graph, heights, columns) for columns in range(2, 11)), key=lambda found: found.shape)
    out = [_head(graph, heat, best.width, best.height)]
    for key, box in best.frames.items():
        out.append(_frame(key, box, len(graph.groups[key])))
    out += [_curve(edge, points) for edge, points in best.curves]
    out += [_card(name, graph.cards[name], best.cards[name], bodies[name], heat) for name in graph.cards]
    return "\n".join([*out, "</g></svg>\n"])


# --- arranging -------------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class _Arranged:
    cards: Mapping[str, Box]
    frames: Mapping[tuple[str, str], Box]
    curves: Sequence[tuple[Edge, list[tuple[float, float]]]]
    width: float
    height: float

    @property
    def shape(self) -> float:
        """How far the page is from the wanted shape, larger pages a little worse."""
        return abs(math.log(self.width / self.height / _ASPECT)) + self.width * self.height / 4e7


def _arranged(graph: Graph, heights: Mapping[str, float], columns: int) -> _Arranged:
    inside: dict[str, Box] = {}
    sizes: dict[str, tuple[float, float]] = {}
    holder = {name: f"\1{key[0]}\1{key[1]}" for key, names in graph.groups.items() for name in names}
    for key, names in graph.groups.items():
        boxes, size = _grid(names, heights, min(columns, len(names)))
        inside |= boxes
        sizes[f"\1{key[0]}\1{key[1]}"] = size
    sizes |= {name: (CARD_W, heights[name]) for name in graph.cards if name not in holder}
    # Frames first, in the order of the file: equals keep it.
    links = [(holder.get(e.source, e.source), holder.get(e.target, e.target)) for e in graph.edges]
    roots = [graph.start, *(name for name in graph.cards if graph.cards[name].outcome)]
    layout = lay_out(sizes, links, roots, _ASPECT)
    placed, bends = layout.boxes, layout.bends
    frames = {key: _moved(placed[f"\1{key[0]}\1{key[1]}"]) for key in graph.groups}
    cards = {name: _moved(box) for name, box in placed.items() if not name.startswith("\1")}
    for key, names in graph.groups.items():
        for name in names:
            box = inside[name]
            cards[name] = Box(frames[key].x + box.x, frames[key].y + box.y, box.w, box.h)
    curves = _curves(graph, cards, frames, holder, bends)
    width = max(box.x + box.w for box in (*cards.values(), *frames.values())) + MARGIN
    height = max(box.y + box.h for box in (*cards.values(), *frames.values())) + MARGIN
    return _Arranged(cards, frames, curves, max(width, 900.0), height)


def _moved(box: Box) -> Box:
    return Box(box.x + MARGIN, box.y + TOP, box.w, box.h)


def _grid(
    names: Sequence[str], heights: Mapping[str, float], columns: int
) -> tuple[dict[str, Box], tuple[float, float]]:
    """Cards of a frame in columns, each where there is most room left: in reading order, as far as that goes."""
    ends = [0.0] * columns
    boxes: dict[str, Box] = {}
    for name in names:
        column = min(range(columns), key=lambda i: (round(ends[i] / 20.0), i))
        boxes[name] = Box(FRAME_PAD + column * (CARD_W + FRAME_GAP), FRAME_HEAD + ends[column], CARD_W, heights[name])
        ends[column] += heights[name] + FRAME_GAP
    width = 2 * FRAME_PAD + columns * CARD_W + (columns - 1) * FRAME_GAP
    return boxes, (width, FRAME_HEAD + max(ends) - FRAME_GAP + FRAME_PAD)


def _curves(
    graph: Graph,
    cards: Mapping[str, Box],
    frames: Mapping[tuple[str, str], Box],
    holder: Mapping[str, str],
    bends: Mapping[tuple[str, str], list[tuple[float, float]]],
) -> list[tuple[Edge, list[tuple[float, float]]]]:
    """One curve to a frame stands for all the choices that lead into it, one out of it for all that go the same way."""
    out: dict[tuple[object, object], tuple[Edge, list[tuple[float, float]]]] = {}
    framed = {name: key for key, names in graph.groups.items() for name in names}
    for edge in graph.edges:
        key, held = framed.get(edge.target), framed.get(edge.source)
        start = frames[held] if held is not None and held != key else cards[edge.source]
        end = frames[key] if key is not None and held != key else cards[edge.target]
        points = [
            (start.x + start.w, start.y + min(start.h / 2, 40.0)),
            *((x + MARGIN, y + TOP) for x, y in _bends(edge, holder, bends)),
            (end.x, end.y + (FRAME_HEAD / 2 if key is not None else min(end.h / 2, 24.0))),
        ]
        where = (held or edge.source, key or edge.target)
        known = out.get(where)
        # Alive wins over dead: the curve is red only where none of its choices can be taken.
        if known is None or (known[0].dead and not edge.dead):
            out[where] = (edge, points)
    return list(out.values())


def _bends(
    edge: Edge, holder: Mapping[str, str], bends: Mapping[tuple[str, str], list[tuple[float, float]]]
) -> list[tuple[float, float]]:
    return bends.get((holder.get(edge.source, edge.source), holder.get(edge.target, edge.target)), [])


# --- drawing ---------------------------------------------------------------------------------------------------------
def _head(graph: Graph, heat: Heat | None, width: float, height: float) -> str:
    cards = sum(not card.outcome for card in graph.cards.values())
    told = f"{cards} nodes · {sum(card.dead for card in graph.cards.values())} that nothing leads to"
    if heat is not None:
        told += f" · visits in {heat.talks:,} talks: number and warmth of each card"
    legend, x = [], MARGIN
    for act, colour in ACT_COLOURS.items():
        legend.append(f'<rect x="{x:.0f}" y="88" width="12" height="12" rx="3" fill="{colour}"/>')
        legend.append(_text(x + 18, 98, act.replace("_", " "), 13, _FAINT))
        x += 34 + _width(act, 13)
    signs = (("▶", "start", _INK), ("◆", "waits for the player", _HUB), ("■", "can never happen", _DEAD))
    for mark, meaning, colour in signs:
        legend.append(_text(x + 10, 98, f"{mark} {meaning}", 13, colour, bold=True))
        x += 40 + _width(meaning, 13)
    width = max(width, x + MARGIN)
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" '
            f'width="{width:.0f}" height="{height:.0f}" font-family={quoteattr(_FONT)}>',
            f'<rect width="100%" height="100%" fill="{_PAPER}"/>',
            '<g id="all">',
            _text(MARGIN, 48, graph.title, 30, _INK, bold=True),
            _text(MARGIN, 72, told, 15, _FAINT),
            *legend,
        ]
    )


def _frame(key: tuple[str, str], box: Box, count: int) -> str:
    colour = ACT_COLOURS.get(key[1], _FAINT)
    title = f"{key[1].replace('_', ' ')} · {count} answers, from {key[0]}"
    return (
        f'<rect x="{box.x:.1f}" y="{box.y:.1f}" width="{box.w:.1f}" height="{box.h:.1f}" rx="16" fill="{colour}" '
        f'fill-opacity="0.07" stroke="{colour}" stroke-opacity="0.55"/>'
        + _text(box.x + FRAME_PAD, box.y + 22, title, 15, colour, bold=True)
    )


def _curve(edge: Edge, points: Sequence[tuple[float, float]]) -> str:
    colour = _DEAD if edge.dead else ACT_COLOURS.get(edge.act, "#9a9184")
    path = f"M{points[0][0]:.1f},{points[0][1]:.1f}"
    for (x0, y0), (x1, y1) in itertools.pairwise(points):
        if x1 > x0 + 1:
            middle = (x0 + x1) / 2
            path += f" C{middle:.1f},{y0:.1f} {middle:.1f},{y1:.1f} {x1:.1f},{y1:.1f}"
        else:
            # Back to the left: around, not straight through what stands between.
            path += f" C{x0 + 70:.1f},{y0:.1f} {x1 - 70:.1f},{y1:.1f} {x1:.1f},{y1:.1f}"
    dash = ' stroke-dasharray="6 5"' if edge.kind in {"call", "outcome"} else ""
    x, y = points[-1]
    title = f"{edge.source} → {edge.target}" + (f" if {edge.condition}" if edge.condition else "")
    return (
        f'<g class="edge" data-from={quoteattr(edge.source)} data-to={quoteattr(edge.target)}>'
        f"<title>{escape(title)}</title>"
        f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="2" stroke-opacity="0.6"{dash}/>'
        f'<path d="M{x - 9:.1f},{y - 5:.1f} L{x:.1f},{y:.1f} L{x - 9:.1f},{y + 5:.1f} z" fill="{colour}"/></g>'
    )


def _pieces(card: Card, language: str, heat: Heat | None, first: bool) -> list[_Piece]:
    """The rows of a card from top to bottom."""
    pieces: list[_Piece] = []
    shown = sorted(card.arrivals, key=lambda row: not row.dead)[:_ROWS_SHOWN]
    for row in shown:
        colour = _DEAD if row.dead else ACT_COLOURS.get(row.act, _FAINT)
        said = f"“{row.text}”" if language == "en" else f"「{row.text}」"
        count = f"  ×{heat.choices[row.id]:,}" if heat is not None and row.id else ""
        pieces.append(
            _Piece(_cut(said, 12, CARD_W - 30 - _width(count, 12)) + count, 12, colour, 17, bar=colour, title=row.id)
        )
        pieces += _condition(row, 18.0)
    if len(card.arrivals) > len(shown):
        pieces.append(_Piece(_more(len(card.arrivals) - len(shown), "choice"), 11, _FAINT, 15, indent=6))
    ink = _DEAD if card.dead else _HUB if card.waits else _INK
    visits = f"  {heat.nodes[card.id]:,}" if heat is not None and not card.outcome else ""
    name = ("▶ " if first else "◆ " if card.waits else "") + card.id
    pieces.append(
        _Piece(_cut(name, 16, CARD_W - 24 - _width(visits, 14)), 16, ink, 24, bold=True, title=visits.strip())
    )
    for line in card.says[:2]:
        pieces.append(_Piece(_cut(line, 13, CARD_W - 24), 13, _FAINT, 17))
    if len(card.says) > 2:
        pieces.append(_Piece(_more(len(card.says) - 2, "line"), 11, "#a59c8d", 15))
    for row in card.ways[:6]:
        pieces.append(_Piece(_cut(row.text, 12, CARD_W - 30), 12, _DEAD if row.dead else _INK, 17, indent=6))
        pieces += _condition(row, 18.0)
    if card.marks:
        signs = {"home": "→ home", "back": "← back"}
        pieces.append(_Piece(_cut(" · ".join(signs.get(m, m) for m in card.marks), 12, CARD_W - 24), 12, ink, 18))
    return pieces


def _more(count: int, what: str) -> str:
    return f"and {count} more {what}{'s' * (count != 1)}"


def _condition(row: Row, indent: float) -> Iterable[_Piece]:
    if row.condition:
        text = f"if {row.condition}"
        yield _Piece(
            _cut(text, 10.5, CARD_W - indent - 14, mono=True),
            10.5,
            _DEAD if row.dead else "#8c7f6b",
            14,
            mono=True,
            indent=indent,
            title=row.condition,
        )


def _card(name: str, card: Card, box: Box, pieces: Sequence[_Piece], heat: Heat | None) -> str:
    visits = heat.nodes[card.id] if heat is not None and not card.outcome else None
    fill, stroke, width = "#ffffff", _LINE, 1.2
    if card.waits:
        stroke, width = _HUB, 2.4
    if card.outcome:
        fill = "#efe9dc"
    if visits is not None and heat is not None:
        fill = _warm(visits / max(heat.talks, 1))
    if card.dead:
        fill, stroke, width = "#fde7e4", _DEAD, 2.4
    dash = ' stroke-dasharray="7 5"' if visits == 0 else ""
    out = [
        f'<g class="card" data-id={quoteattr(name)}><title>{escape(card.place or card.id)}</title>',
        f'<rect x="{box.x:.1f}" y="{box.y:.1f}" width="{box.w:.1f}" height="{box.h:.1f}" '
        f'rx="{20 if card.outcome else 9}" fill="{fill}" stroke="{stroke}" stroke-width="{width}"{dash}/>',
    ]
    y = box.y + 6
    for piece in pieces:
        y += piece.height
        x = box.x + 12 + piece.indent
        if piece.bar:
            out.append(f'<rect x="{x:.1f}" y="{y - 11:.1f}" width="3" height="12" rx="1.5" fill="{piece.bar}"/>')
            x += 8
        out.append(_text(x, y - 1, piece.text, piece.size, piece.colour, bold=piece.bold, mono=piece.mono))
        if piece.bold and piece.title:
            right = box.x + box.w - 12 - _width(piece.title, 14)
            out.append(_text(right, y - 1, piece.title, 14, _DEAD if visits == 0 else "#8a4b12", bold=True))
    return "\n".join([*out, "</g>"])


def _warm(share: float) -> str:
    """White where nobody came, to orange where every talk does; small shares told apart by a square root."""
    strength = math.sqrt(min(share, 1.0))
    mixed = [round(255 + (c - 255) * strength) for c in (248, 176, 92)]
    return "#" + "".join(f"{c:02x}" for c in mixed)


def _text(x: float, y: float, text: str, size: float, colour: str, *, bold: bool = False, mono: bool = False) -> str:
    more = ' font-weight="700"' if bold else ""
    more += f" font-family={quoteattr(_MONO)}" if mono else ""
    return f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size:g}" fill="{colour}"{more}>{escape(text)}</text>'


def _width(text: str, size: float, *, mono: bool = False) -> float:
    """About how wide a text is: letters half as wide as high, Japanese as wide as high."""
    latin = 0.63 if mono else 0.5
    return sum(size * (1.0 if ord(char) > 0x2E80 or char in "…—“”" else latin) for char in text)


def _cut(text: str, size: float, room: float, *, mono: bool = False) -> str:
    text = " ".join(text.split())
    if _width(text, size, mono=mono) <= room:
        return text
    while text and _width(text + "…", size, mono=mono) > room:
        text = text[:-1]
    return text.rstrip() + "…"
