"""The annotation desk: mark what is seen in a take, by hand or by program, and see what it makes of a character.

examples:
  run_game.py annotate my_take.bvh                          the desk (needs the `tools` extra)
  run_game.py annotate a.bvh b.bvh                          several takes side by side
  run_game.py annotate my_take.bvh --auto                   proposals learnt from the shipped takes, into my_take.yaml
  run_game.py annotate my_take.bvh --export my_take.eaf     for ELAN (or .csv)
  run_game.py annotate my_take.bvh --import corrected.eaf   from ELAN (or .csv) into my_take.yaml
  run_game.py annotate first.yaml --compare second.yaml     Cohen's kappa per layer, and where two annotators differ
  run_game.py annotate --trial                              how good --auto is: each take from all the others

A take is NAME.bvh on the project's skeleton (run_game.py retarget brings others onto it); its annotation NAME.yaml
stands beside it. Proposals carry a confidence and count for nothing until somebody has accepted them.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from game.app.arguments import parse_size
from game.core.errors import BadInput, MissingPart
from game.core.paths import ASSETS

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``annotate``."""
    motion = ASSETS / "motion"
    parser.add_argument("takes", nargs="*", type=Path, metavar="TAKE", help="BVH files, or their annotations")
    parser.add_argument(
        "--behaviours",
        type=Path,
        help="the repertoire (default: behaviours.yaml in or beside the takes' folder, else the shipped one)",
    )
    parser.add_argument("--learn", type=Path, default=motion / "takes", metavar="DIR", help="annotated takes")
    parser.add_argument("--author", default="", help="who annotates (kept in the file)")
    parser.add_argument("--size", type=parse_size, default=(1440, 900), metavar="WxH", help="window size")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--auto", action="store_true", help="add proposals where nothing is marked yet")
    what.add_argument("--export", type=Path, metavar="FILE", help="write the annotation as .eaf or .csv")
    what.add_argument("--import", type=Path, metavar="FILE", dest="import_from", help="take it from .eaf or .csv")
    what.add_argument("--compare", type=Path, metavar="YAML", help="a second annotation of the same take")
    what.add_argument("--trial", action="store_true", help="leave one take out: precision, recall, kappa, intensities")
    parser.add_argument("--json", action="store_true", help="machine-readable result")


FINDINGS_SHOWN = 200


def run(args: argparse.Namespace) -> int:
    """Hand over to the desk. Whatever is wrong with a file is told at once, a line each; nothing is written then."""
    try:
        return _run(args)
    except BadInput as error:
        if not error.findings:
            raise
        for finding in error.findings[:FINDINGS_SHOWN]:
            print(finding, file=sys.stderr)
        print(f"{len(error.findings)} findings; nothing was changed", file=sys.stderr)
        return 2


def _run(args: argparse.Namespace) -> int:
    # Imported only now: the game itself never needs it.
    from game.tools.annotate import command

    if args.trial:
        return command.trial(args)
    takes = command.checked_takes(args)
    if args.auto:
        return command.automatic(args, takes)
    if args.export is not None:
        return command.export(args, takes)
    if args.import_from is not None:
        return command.import_from(args, takes)
    if args.compare is not None:
        return command.compare(args, takes)
    try:
        from game.tools.annotate.desk_window import open_desk
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != "imgui_bundle":
            raise
        raise MissingPart("the desk needs imgui-bundle: pip install 'mental-communication-game[tools]'") from None
    return open_desk(args, takes)
