"""Two pictures, film strips or folders of pictures side by side: do they look the same?

examples:
  run_game.py compare before.png after.png --out difference.html
  run_game.py compare tests/goldens/render/strip_talk.png strip.png --cell 320x180 --json
  run_game.py compare frames_before frames_after --out difference.html      pictures of the same name

Every pixel's difference is what an eye sees that flips between the two (ꟻLIP). Exit codes: 0 all look the same,
1 some differ, 2 bad input.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.app.arguments import parse_size
from game.core.errors import BadInput, Where

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``compare``."""
    parser.add_argument("expected", type=Path, help="a PNG, or a folder of them")
    parser.add_argument("got", type=Path, help="the other one")
    parser.add_argument("--cell", type=parse_size, default=None, metavar="WxH", help="of one picture of a film strip")
    parser.add_argument("--mean", type=float, default=0.02, help="allowed on average, 0 to 1 (default 0.02)")
    parser.add_argument("--tile", type=float, default=0.25, help="allowed in the worst 24 px square (default 0.25)")
    parser.add_argument("--out", type=Path, metavar="HTML", help="write a page: expected, got, difference")
    parser.add_argument("--json", action="store_true", help="machine-readable")


def run(args: argparse.Namespace) -> int:
    """Compare, tell, judge."""
    from game.tools.compare import Limits, compare_frames, write_comparison

    if not (0.0 <= args.mean <= 1.0 and 0.0 <= args.tile <= 1.0):
        raise BadInput("--mean, --tile", expected="0 to 1", seen=f"{args.mean}, {args.tile}")
    limits = Limits(args.mean, args.tile)
    frames = compare_frames(_frames(args.expected, args.got, args.cell), limits)
    if args.out is not None:
        write_comparison(args.out, f"{args.expected.name} and {args.got.name}", frames, limits)
    if args.json:
        rows = [
            {"name": f.name, "mean": round(f.mean, 5), "tile": round(f.tile, 5), "same": bool(f.same)} for f in frames
        ]
        print(json.dumps({"same": all(f.same for f in frames), "frames": rows}, ensure_ascii=False))
    else:
        for frame in frames:
            print(f"{'same   ' if frame.same else 'differs'} {frame.told()}")
    return 0 if all(frame.same for frame in frames) else 1


def _frames(
    expected: Path, got: Path, cell: tuple[int, int] | None
) -> Iterator[tuple[str, NDArray[np.uint8], NDArray[np.uint8]]]:
    from game.render import load_picture
    from game.tools.compare import cut_strip

    for name, one, other in _pairs(expected, got):
        a, b = load_picture(one), load_picture(other)
        if cell is None:
            yield name, a, b
            continue
        before, after = cut_strip(a, cell), cut_strip(b, cell)
        if len(before) != len(after):
            raise BadInput("the strips", expected=f"{len(before)} pictures", seen=len(after))
        for i, (left, right) in enumerate(zip(before, after, strict=True), start=1):
            yield f"{name} {i}", left, right


def _pairs(expected: Path, got: Path) -> list[tuple[str, Path, Path]]:
    if not expected.is_dir() and not got.is_dir():
        return [(expected.stem, expected, got)]
    names = [sorted(path.name for path in folder.glob("*.png")) for folder in (expected, got)]
    if names[0] != names[1] or not names[0]:
        only = sorted(set(names[0]) ^ set(names[1]))
        raise BadInput(
            where=Where(got),
            expected="PNGs of the same names in both folders",
            seen=f"only in one: {', '.join(only[:3])}" if only else "none",
        )
    return [(name.removesuffix(".png"), expected / name, got / name) for name in names[0]]
