"""The picture as a page of its own: pan, zoom, search, and everything about a node at a click. Needs no network."""

from __future__ import annotations

import json
import re
from html import escape
from pathlib import Path

from game.tools.graph.heat import Heat
from game.tools.graph.model import Graph
from game.tools.graph.svg import svg_of

__all__ = ["page_of"]

_TEMPLATE = Path(__file__).with_name("page.html")
_FIELD = re.compile("@(LANGUAGE|TITLE|SVG|DATA)@")


def page_of(graph: Graph, heat: Heat | None = None) -> str:
    """One HTML file with everything in it."""
    data = {
        name: {
            "id": card.id,
            "place": card.place,
            "arrivals": [
                {"en": r.text, "if": r.condition, "act": r.act, "id": r.id, "dead": r.dead} for r in card.arrivals
            ],
            "ways": [{"en": r.text, "if": r.condition, "dead": r.dead} for r in card.ways],
            **card.detail,
        }
        for name, card in graph.cards.items()
    }
    # Nothing in a text may end the script early.
    told = json.dumps(data, ensure_ascii=False).replace("<", "\\u003c").replace("\u2028", " ").replace("\u2029", " ")
    fields = {
        "LANGUAGE": graph.language,
        "TITLE": escape(graph.title),
        "SVG": svg_of(graph, heat),
        "DATA": told,
    }
    # All at once: what a text holds is never taken for a field.
    return _FIELD.sub(lambda match: fields[match[1]], _TEMPLATE.read_text(encoding="utf-8"))
