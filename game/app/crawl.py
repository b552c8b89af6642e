"""Measure everything a stall can put on the screen: texts that run out, glyphs no font has, hands out of the picture.

examples:
  run_game.py crawl flea
  run_game.py crawl toys --language ja --json
  run_game.py crawl flea --out findings        a page with a sketch of every picture in which something is wrong

Every node, line and wording of a choice, whatever its conditions, is laid out as the game would, in both languages and
at the smallest and largest size of text, without drawing the scene; the hands are those of the stall's own person.
Exit codes: 0 nothing found, 1 findings, 2 bad input.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from game.core.errors import BadInput

__all__ = ["add_arguments", "run"]

LANGUAGES = {"both": ("en", "ja"), "en": ("en",), "ja": ("ja",)}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``crawl``."""
    parser.add_argument("stall", help="a stall's name, or a dialogue file")
    parser.add_argument("--language", choices=sorted(LANGUAGES), default="both", help="default both")
    parser.add_argument("--hands", action=argparse.BooleanOptionalAction, default=True, help="watch the hands too")
    parser.add_argument("--seconds", type=float, default=8.0, help="how long in each feeling (default 8)")
    parser.add_argument("--seed", type=int, default=1, help="of the watched body (default 1)")
    parser.add_argument("--out", type=Path, metavar="DIR", help="write a page with the findings there")
    parser.add_argument("--json", action="store_true", help="print the findings as JSON")


def run(args: argparse.Namespace) -> int:
    """Crawl, tell, judge."""
    from game.app.loading import load_step_assets
    from game.tools.crawl import crawl_stall, hands_outside, write_page

    if not 1.0 <= args.seconds <= 600.0:
        raise BadInput("--seconds", expected="1 to 600", seen=args.seconds)
    if args.out is not None:
        try:
            args.out.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise BadInput("--out", expected="a folder that can be made", seen=error.strerror) from None
    findings, measured = crawl_stall(args.stall, LANGUAGES[args.language])
    hands = hands_outside(load_step_assets(args.stall), args.seconds, args.seed) if args.hands else []
    if args.out is not None:
        write_page(args.out / "crawl.html", args.stall, findings, hands, measured)
    if args.json:
        rows = [
            {
                "kind": f.fault.kind, "node": f.node, "language": f.look.language, "scale": f.look.scale,
                "text": f.fault.text, "detail": f.fault.detail,
            }
            for f in findings
        ]  # fmt: skip
        outside = [{"kind": "hands", "emotion": h.emotion, "hand": h.hand, "share": round(h.share, 4)} for h in hands]
        told = {"stall": args.stall, "measured": measured, "findings": [*rows, *outside]}
        print(json.dumps(told, ensure_ascii=False))
    else:
        for f in findings:
            place = f"{f.node} ({f.look.language}, {f.look.scale:.0%})"
            print(f"{place}: {f.fault.kind}: {f.fault.detail}: {f.fault.text[:70]!r}")
        for h in hands:
            print(f"{h.emotion}: hands: the {h.hand} one is out of the picture {h.share:.1%} of the time")
        print(f"{args.stall}: {measured} pictures measured, {len(findings) + len(hands)} findings")
    return 1 if findings or hands else 0
