"""Draw a stall's dialogue: nodes, choices, conditions, what can never happen in red, visits from autoplay logs.

The ending of the file tells the kind: .svg (a picture), .html (the same with pan, zoom, search and details), .dot
(for Graphviz).

Examples:
  run_game.py graph flea -o flea.svg
  run_game.py graph flea -o flea.html --language ja
  run_game.py autoplay --episodes 500 --out log.jsonl && run_game.py graph flea -o flea.html --heat log.jsonl
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from game.app.content import stall_path
from game.core.errors import BadInput
from game.formats.files import write_text
from game.story import load_script

__all__ = ["add_arguments", "run"]

ENDINGS = (".svg", ".html", ".dot")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``graph``."""
    parser.add_argument("stall", metavar="STALL", help="stall name or a dialogue file")
    parser.add_argument("-o", "--out", type=Path, required=True, metavar="FILE", help="where to: .svg, .html or .dot")
    parser.add_argument("--heat", type=Path, metavar="LOG", help="a log of `autoplay --out`: how often what was passed")
    parser.add_argument("--language", choices=["en", "ja"], default="en", help="language of the lines (default en)")
    parser.add_argument("--json", action="store_true", help="tell what was drawn as JSON")


def run(args: argparse.Namespace) -> int:
    """Write the picture; it appears whole or not at all."""
    from game.tools.graph import dot_of, graph_of, page_of, read_heat, svg_of

    kind = args.out.suffix.lower()
    if kind not in ENDINGS:
        raise BadInput("--out", expected=" | ".join(f"a name that ends in {e}" for e in ENDINGS), seen=str(args.out))
    script = load_script(stall_path(args.stall))
    heat = None if args.heat is None else read_heat(args.heat, script)
    graph = graph_of(script, args.language)
    draw = {".svg": svg_of, ".html": page_of, ".dot": dot_of}[kind]
    write_text(args.out, draw(graph, heat))
    nodes = [card for card in graph.cards.values() if not card.outcome]
    told: dict[str, Any] = {
        "file": str(args.out),
        "nodes": len(nodes),
        "edges": len(graph.edges),
        "dead": [card.id for card in nodes if card.dead],
        "unvisited": [] if heat is None else [card.id for card in nodes if not heat.nodes[card.id]],
    }
    if args.json:
        print(json.dumps(told, ensure_ascii=False))
    else:
        unvisited = "" if heat is None else f", {len(told['unvisited'])} never visited in {heat.talks:,} talks"
        print(f"{args.out}: {told['nodes']} nodes, {told['edges']} edges, {len(told['dead'])} dead{unvisited}")
    return 0
