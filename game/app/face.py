"""The face's workshop: propose faces for an emotion, rate faces, fit the model to ratings; alone, the authoring window.

examples:
  run_game.py face                                                   the authoring window
  run_game.py face suggest --valence -0.7 --arousal 0.6 --top 12 --sheet out.png
  run_game.py face suggest --emotion joy=0.8,fear=0.2 --diverse --json
  run_game.py face sheet seven --out seven.png
  run_game.py face rate --rater yuki --out ratings.csv
  run_game.py face fit ratings.csv --plots plots --out-parts parts.yaml --out-weights weights.yaml
  run_game.py face rate --avatar somebody.vrm --rater yuki --out theirs.csv    then: face fit theirs.csv --avatar …
  run_game.py face simulate --raters 32 --out simulated.csv

The window needs the `tools` extra (pip install -e '.[tools]'), plots the `reports` extra.
"""

from __future__ import annotations

import argparse
import importlib.util
from pathlib import Path

from game.app.arguments import add_avatar, parse_size
from game.core.errors import MissingPart
from game.core.paths import ASSETS

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``face`` and of its own commands."""
    _folder(parser, ASSETS / "face")
    _size(parser, (1280, 720))
    parser.add_argument("--save-to", type=Path, metavar="FILE", help="where the window saves named expressions")
    commands = parser.add_subparsers(dest="face_command", metavar="WHAT")
    _suggest(commands.add_parser("suggest", help="faces for an emotion, best first"))
    _sheet(commands.add_parser("sheet", help="a picture of all emotions, parts or named expressions"))
    _rate(commands.add_parser("rate", help="a window in which a person rates faces"))
    _fit(commands.add_parser("fit", help="part Gaussians and weights from ratings"))
    _simulate(commands.add_parser("simulate", help="ratings by simulated people, and how many people are enough"))


def _folder(parser: argparse.ArgumentParser, default: object = argparse.SUPPRESS) -> None:
    # Understood before and after the command's name; what is not given there must not hide what was given before it.
    parser.add_argument("--face-folder", type=Path, default=default, metavar="DIR", help="parts, weights, …")


def _size(parser: argparse.ArgumentParser, default: object = argparse.SUPPRESS) -> None:
    parser.add_argument("--size", type=parse_size, default=default, metavar="WxH", help="window size (1280x720)")


def _suggest(parser: argparse.ArgumentParser) -> None:
    _folder(parser)
    parser.add_argument("--valence", type=float, help="unpleasant -1 … pleasant 1")
    parser.add_argument("--arousal", type=float, help="sleepy -1 … awake 1")
    parser.add_argument("--spread", metavar="SD[,SD[,R]]", help="want a Gaussian: deviations, correlation")
    parser.add_argument("--emotion", metavar="NAME=X,…", help="want seven values instead: joy=0.8,fear=0.2")
    parser.add_argument("--around", type=float, metavar="RADIUS", help="eight points around the circle instead")
    parser.add_argument("--top", type=int, default=12, help="how many (default 12)")
    parser.add_argument("--diverse", action="store_true", help="prefer faces that differ from those above them")
    parser.add_argument("--coherence", type=float, help="score for parts that say one emotion (0: the pure model)")
    parser.add_argument("--sheet", type=Path, metavar="PNG", help="draw them on the real head")
    parser.add_argument("--json", action="store_true", help="machine-readable")


def _sheet(parser: argparse.ArgumentParser) -> None:
    _folder(parser)
    parser.add_argument("of", choices=["seven", "parts", "expressions"], help="what is drawn")
    parser.add_argument("--out", type=Path, required=True, metavar="PNG")


def _rate(parser: argparse.ArgumentParser) -> None:
    _folder(parser)
    _size(parser)
    parser.add_argument("--rater", required=True, metavar="NAME", help="who rates")
    parser.add_argument("--out", type=Path, required=True, metavar="CSV", help="appended to; resumes where it stopped")
    add_avatar(parser)
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--faces", type=int, metavar="N", help="N whole faces only")
    which.add_argument("--parts", action="store_true", help="only the standard face and those that wear one part")
    parser.add_argument("--seed", type=int, default=1, help="which whole faces, and everybody's order (default 1)")


def _fit(parser: argparse.ArgumentParser) -> None:
    _folder(parser)
    parser.add_argument("ratings", type=Path, metavar="RATINGS.csv")
    parser.add_argument("--out-parts", type=Path, metavar="YAML", help="write parts with the rated Gaussians")
    parser.add_argument("--out-weights", type=Path, metavar="YAML", help="write the fitted weights")
    add_avatar(parser)
    parser.add_argument("--out-faces", type=Path, metavar="YAML", help="an avatar's rated expressions (beside the CSV)")
    parser.add_argument("--plots", type=Path, metavar="DIR", help="draw Gaussians, weights, predicted against rated")
    parser.add_argument("--held-out", type=float, default=0.2, metavar="SHARE", help="of the whole faces (default 0.2)")
    parser.add_argument("--seed", type=int, default=1, help="of the split (default 1)")
    parser.add_argument("--json", action="store_true", help="machine-readable")


def _simulate(parser: argparse.ArgumentParser) -> None:
    _folder(parser)
    parser.add_argument("--raters", type=int, default=32, help="how many simulated people (default 32)")
    parser.add_argument("--faces", type=int, default=81, metavar="N", help="whole faces each rates (default 81)")
    parser.add_argument("--out", type=Path, metavar="CSV", help="write their ratings")
    parser.add_argument("--plots", type=Path, metavar="DIR", help="draw the error against the number of raters")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", action="store_true", help="machine-readable")


def run(args: argparse.Namespace) -> int:
    """Hand over to the workshop, which is imported only now: the game itself never needs it."""
    if args.face_command == "suggest":
        from game.tools.face.suggest import suggest

        return suggest(args)
    if args.face_command == "sheet":
        from game.tools.face.overview import overview

        return overview(args)
    if args.face_command in {"fit", "simulate"}:
        from game.tools.face import fit_command

        if getattr(args, "avatar", None) is not None:
            from game.tools.face.avatar_ratings import fit_avatar

            return fit_avatar(args)
        return fit_command.fit(args) if args.face_command == "fit" else fit_command.simulate(args)
    if args.face_command == "rate":
        from game.tools.face.rate_window import run_rating

        return run_rating(args)
    if importlib.util.find_spec("imgui_bundle") is None:
        raise MissingPart("the authoring window needs imgui-bundle: pip install -e '.[tools]'")
    from game.tools.face.author_window import open_author

    return open_author(args)
