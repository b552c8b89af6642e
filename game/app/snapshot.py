"""Draw one picture without a display.

examples:
  run_game.py snapshot --emotion joy=0.8,fear=0.1 --seconds 3 --size 1280x720 --out joy.png
  run_game.py snapshot --emotion anger=0.9 --shown joy=0.5 --overlay --out mask.png
  run_game.py snapshot --avatar somebody.vrm --emotion fear=0.8 --out them.png
"""

from __future__ import annotations

import argparse
from pathlib import Path

from game.app.arguments import parse_size
from game.app.pictures import check_png, write_png
from game.app.studio import Studio, add_studio_arguments
from game.core.errors import BadInput

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``snapshot``."""
    add_studio_arguments(parser)
    parser.add_argument("--seconds", type=float, default=3.0, help="how long it has been going on (default 3)")
    parser.add_argument("--size", type=parse_size, default=(1280, 720), metavar="WxH", help="default 1280x720")
    parser.add_argument("--out", type=Path, required=True, help="the PNG to write")


def run(args: argparse.Namespace) -> int:
    """Simulate, draw, write."""
    if not 0.0 <= args.seconds <= 3600.0:
        raise BadInput("--seconds", expected="0 to 3600", seen=args.seconds)
    check_png(args.out)
    studio = Studio(args, args.size, "hero")
    try:
        studio.run(args.seconds)
        write_png(args.out, studio.picture())
    finally:
        studio.close()
    return 0
