"""The command line: one subparser per command, each command in a module of its own, imported when it runs."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from game.core.errors import GameError

__all__ = ["main"]


def build_parser() -> argparse.ArgumentParser:
    """The whole grammar of ``run_game.py``."""
    parser = argparse.ArgumentParser(prog="run_game.py", description=__doc__)
    parser.add_subparsers(dest="command")
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; 0 good, 1 findings, 2 usage or bad input (one clear line, no traceback)."""
    args = build_parser().parse_args(argv)
    try:
        return int(args.run(args))
    except GameError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
