"""Draw a strip of pictures, or a sequence, without a display.

examples:
  run_game.py film --emotion anger=0.9 --seconds 10 --every 0.5 --strip --out strip.png
  run_game.py film --emotion joy=0.8 --say "This one here? Oh, it is big!" --seconds 6 --every 0.0333 --out frames
  run_game.py film --emotion joy=0.8 --seconds 6 --out joy.mp4   at --fps, with the extra `video`
  run_game.py film --figure6 --seed 6 --out fig6.png     the paper's rows: gestures only, success, failure
  run_game.py film --avatar somebody.vrm --emotion joy=0.8 --seconds 6 --strip --out them.png
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.app.arguments import parse_size
from game.app.pictures import check_png, write_png
from game.app.studio import Studio, add_studio_arguments
from game.app.video import check_film, is_film, write_film
from game.core.errors import BadInput

__all__ = ["add_arguments", "run", "sheet"]

MAX_PICTURES = 20_000
MAX_CELLS = 200


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``film``."""
    add_studio_arguments(parser)
    parser.add_argument("--seconds", type=float, default=8.0, help="length (default 8)")
    parser.add_argument("--every", type=float, default=None, help="seconds between pictures (default 0.5)")
    parser.add_argument("--fps", type=int, default=30, help="pictures a second of a film file (default 30)")
    parser.add_argument("--strip", action="store_true", help="one PNG with all pictures side by side")
    parser.add_argument("--figure6", action="store_true", help="one talk in three rows, as in the paper's figure 6")
    parser.add_argument("--item", default="teapot_gold", help="what figure 6 is talked about (default teapot_gold)")
    parser.add_argument("--columns", type=int, default=4, help="pictures in a row of the strip (default 4)")
    parser.add_argument("--size", type=parse_size, default=None, metavar="WxH", help="of one picture")
    parser.add_argument("--out", type=Path, required=True, help="a PNG (strip), a folder (sequence) or a film (.mp4 …)")


def sheet(pictures: list[NDArray[np.uint8]], columns: int) -> NDArray[np.uint8]:
    """Pictures of one size in rows of ``columns``; empty places stay dark."""
    height, width = pictures[0].shape[:2]
    rows = math.ceil(len(pictures) / columns)
    out = np.full((rows * height, columns * width, 3), 24, np.uint8)
    for i, picture in enumerate(pictures):
        y, x = (i // columns) * height, (i % columns) * width
        out[y : y + height, x : x + width] = picture
    return out


def _figure6(args: argparse.Namespace) -> int:
    from game.app.figure6 import SIZE_PX, draw_figure6

    check_png(args.out)
    studio = Studio(args, args.size or SIZE_PX, "body")
    try:
        items = studio.session.assets.talk.script.items
        if args.item not in items:
            raise BadInput("--item", expected=" | ".join(items), seen=args.item)
        write_png(args.out, draw_figure6(studio, args.seed, args.item))
    finally:
        studio.close()
    return 0


def run(args: argparse.Namespace) -> int:
    """Simulate and draw."""
    if args.figure6:
        return _figure6(args)
    if not 0.0 < args.seconds <= 3600.0:
        raise BadInput("--seconds", expected="above 0, at most 3600", seen=args.seconds)
    if args.every is None:
        args.every = 1.0 / args.fps if is_film(args.out) else 0.5
    if not 1 <= args.fps <= 120:
        raise BadInput("--fps", expected="1 to 120", seen=args.fps)
    if not 1 / 120 <= args.every <= args.seconds:
        raise BadInput("--every", expected="1/120 s to the length", seen=args.every)
    count = round(args.seconds / args.every)
    limit = MAX_CELLS if args.strip else MAX_PICTURES
    if count > limit or not 1 <= args.columns <= 20:
        raise BadInput("film", expected=f"at most {limit} pictures in 1 to 20 columns", seen=f"{count}, {args.columns}")
    if args.strip:
        check_png(args.out)
    else:
        check_film(args.out)
    studio = Studio(args, args.size or ((400, 440) if args.strip else (1280, 720)), "body" if args.strip else "hero")
    try:
        if args.strip:
            write_png(args.out, sheet(list(studio.pictures(args.seconds, args.every)), args.columns))
            return 0
        write_film(args.out, studio.pictures(args.seconds, args.every, labels=False), args.fps)
    finally:
        studio.close()
    return 0
