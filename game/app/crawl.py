"""Look at everything a stall can put on the screen: texts that run out or cannot be read, glyphs missing, hands cut.

examples:
  run_game.py crawl flea --out findings        a page with a picture of every node, faults marked, to be skimmed
  run_game.py crawl toys --language ja --json
  run_game.py crawl antiques --no-pixels       without drawing: layouts and hands only, a tenth of the time
  run_game.py crawl flea --size 1280x720 --level ultra --text 2 --out large

Every node is drawn once or twice, speaking and asking, by the game's own renderer and interface, its person in the
feeling that players meet there; pixels tell what is blank, illegible, at the edge, cut off or covered. Besides, every
node, line and wording of a choice, whatever its conditions, is laid out without drawing in both languages and at the
smallest and largest size of text, and the person's hands are watched in each feeling.
Exit codes: 0 nothing found, 1 findings, 2 bad input.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from game.app.arguments import parse_size
from game.core.errors import BadInput
from game.render import LEVELS

if TYPE_CHECKING:
    from game.app.step import StepAssets
    from game.tools.crawl import ContactSheet, Print

__all__ = ["add_arguments", "run"]

LANGUAGES = {"both": ("en", "ja"), "en": ("en",), "ja": ("ja",)}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``crawl``."""
    parser.add_argument("stall", help="a stall's name, or a dialogue file")
    parser.add_argument(
        "--language", choices=sorted(LANGUAGES), default="both", help="default both; pictures of both are English"
    )
    parser.add_argument(
        "--pixels", action=argparse.BooleanOptionalAction, default=True, help="draw every node (default yes)"
    )
    parser.add_argument(
        "--size", type=parse_size, default=(640, 360), metavar="WxH", help="of the pictures (default 640x360)"
    )
    levels = [level.name for level in LEVELS]
    parser.add_argument("--level", choices=levels, default="low", help="quality of the pictures (default low)")
    parser.add_argument("--text", type=float, default=1.0, help="size of text in the pictures, 1 to 2 (default 1)")
    parser.add_argument("--hands", action=argparse.BooleanOptionalAction, default=True, help="watch the hands too")
    parser.add_argument("--seconds", type=float, default=8.0, help="how long in each feeling (default 8)")
    parser.add_argument("--seed", type=int, default=1, help="of talks and bodies (default 1)")
    parser.add_argument("--out", type=Path, metavar="DIR", help="write a page with pictures and findings there")
    parser.add_argument("--json", action="store_true", help="print the findings as JSON")


def run(args: argparse.Namespace) -> int:
    """Crawl, tell, judge."""
    from game.app.loading import load_step_assets
    from game.tools.crawl import ContactSheet, crawl_stall, hands_outside, write_page

    if not 1.0 <= args.seconds <= 600.0:
        raise BadInput("--seconds", expected="1 to 600", seen=args.seconds)
    if not 1.0 <= args.text <= 2.0:
        raise BadInput("--text", expected="1 to 2", seen=args.text)
    if args.out is not None:
        try:
            args.out.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise BadInput("--out", expected="a folder that can be made", seen=error.strerror) from None
    findings, measured = crawl_stall(args.stall, LANGUAGES[args.language])
    assets = load_step_assets(args.stall) if args.hands or args.pixels else None
    hands = hands_outside(assets, args.seconds, args.seed) if args.hands and assets is not None else []
    sheet = ContactSheet() if args.pixels else None
    seen = [] if sheet is None or assets is None else _draw(assets, args, sheet)
    if args.out is not None:
        write_page(args.out / "crawl.html", args.stall, findings, hands, measured, sheet)
    found = len(findings) + len(hands) + len(seen)
    if args.json:
        rows = [
            {
                "kind": f.fault.kind, "node": f.node, "language": f.look.language, "scale": f.look.scale,
                "text": f.fault.text, "detail": f.fault.detail,
            }
            for f in findings
        ]  # fmt: skip
        outside = [{"kind": "hands", "emotion": h.emotion, "hand": h.hand, "share": round(h.share, 4)} for h in hands]
        drawn = 0 if sheet is None else len(sheet.figures)
        told = {"stall": args.stall, "measured": measured, "drawn": drawn, "findings": [*rows, *outside, *seen]}
        print(json.dumps(told, ensure_ascii=False))
        return 1 if found else 0
    for f in findings:
        place = f"{f.node} ({f.look.language}, {f.look.scale:.0%})"
        print(f"{place}: {f.fault.kind}: {f.fault.detail}: {f.fault.text[:70]!r}")
    for h in hands:
        print(f"{h.emotion}: hands: the {h.hand} one is out of the picture {h.share:.1%} of the time")
    for row in seen:
        print(f"{row['node']} ({row['moment']}): {row['kind']}: {row['detail']}: {row['text'][:70]!r}")
    drawn_too = "" if sheet is None else f", {len(sheet.figures)} pictures drawn"
    print(f"{args.stall}: {measured} layouts measured{drawn_too}, {found} findings")
    return 1 if found else 0


def _draw(assets: StepAssets, args: argparse.Namespace, sheet: ContactSheet) -> list[dict[str, Any]]:
    """Draw every node onto the sheet; the faults as rows for machines."""
    from game.app.autoplay.progress import Progress
    from game.render import level_named
    from game.tools.crawl import Look, develop

    rows: list[dict[str, Any]] = []
    look = Look(LANGUAGES[args.language][0], args.text)
    progress = Progress(len(assets.talk.script.nodes), what="nodes")
    last = ""
    for taken in develop(assets, look, args.size, level_named(args.level), args.seed):
        sheet.add(taken)
        rows += _rows(taken)
        progress.add(int(taken.node != last and taken.kind != "screen"))
        last = taken.node
    progress.end()
    return rows


def _rows(taken: Print) -> list[dict[str, Any]]:
    return [
        {
            "kind": fault.kind, "node": taken.node, "moment": taken.kind, "shot": taken.shot, "drawn": True,
            "language": taken.look.language, "scale": taken.look.scale, "text": fault.text, "detail": fault.detail,
        }
        for fault in taken.faults
    ]  # fmt: skip
