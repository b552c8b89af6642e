"""The command line: one subparser per command, each command in a module of its own, imported when it runs."""

from __future__ import annotations

import argparse
import gc
import importlib
import os
import sys
from collections.abc import Sequence

from game.core.errors import GameError

__all__ = ["COMMANDS", "main"]

# name -> module with ``add_arguments(parser)`` and ``run(args) -> int``, and the line shown in the overview.
COMMANDS: dict[str, tuple[str, str]] = {
    "play": ("game.app.play", "play the game in a window (what run_game.py alone does)"),
    "autoplay": ("game.app.autoplay.command", "play many games without a window, with a policy, into a log"),
    "replay": ("game.app.replay", "play a recording again, exactly: in a window, without, as a picture or a film"),
    "crawl": ("game.app.crawl", "measure everything a stall can show: texts that run out, glyphs, hands"),
    "compare": ("game.app.compare", "pictures, film strips or folders of them side by side: do they look the same?"),
    "snapshot": ("game.app.snapshot", "draw one picture without a display"),
    "film": ("game.app.film", "draw a strip or a sequence of pictures without a display"),
    "turntable": ("game.app.turntable", "draw a person from all sides, or their seven faces"),
    "perform": ("game.app.perform", "let one body live in one feeling: every start with its reason, and shares"),
    "inspect": ("game.app.inspect", "show what is in a BVH, glTF or VRM file"),
    "analyse": ("game.app.analyse", "turn annotated takes into motion units"),
    "annotate": ("game.app.annotate", "mark what is seen in takes, by hand or by program"),
    "retarget": ("game.app.retarget", "bring anyone's motion onto the project's skeleton"),
    "face": ("game.app.face", "propose, rate, fit and author faces"),
    "lint": ("game.app.lint", "check dialogue scripts"),
    "graph": ("game.app.graph", "draw a stall's dialogue as a picture or a page"),
    "bench": ("game.app.bench", "measure speed against floors run beside it"),
    "build": ("game.app.build", "remake the generated assets, or check them"),
}


def build_parser(command: str | None = None) -> argparse.ArgumentParser:
    """The grammar of ``run_game.py``; only the named command's module is imported for its arguments."""
    parser = argparse.ArgumentParser(
        prog="run_game.py",
        description="The Mental Communication Game: a negotiation won by reading a person.",
        epilog="Without a command the game starts. Each command has its own --help with examples.",
    )
    commands = parser.add_subparsers(dest="command", metavar="COMMAND")
    for name, (module, help_line) in COMMANDS.items():
        sub = commands.add_parser(name, help=help_line, formatter_class=argparse.RawDescriptionHelpFormatter)
        if name == command:
            loaded = importlib.import_module(module)
            sub.description = (loaded.__doc__ or "").strip()
            loaded.add_arguments(sub)
            sub.set_defaults(run=loaded.run)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; 0 good, 1 findings, 2 usage or bad input (one clear line, no traceback)."""
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    words = list(sys.argv[1:] if argv is None else argv)
    if not words or (words[0].startswith("-") and words[0] not in {"-h", "--help"}):
        words.insert(0, "play")
    # What is imported stays: looking for garbage among it would take a twentieth of the start.
    gc.disable()
    try:
        try:
            args = build_parser(words[0]).parse_args(words)
        finally:
            gc.enable()
        return int(args.run(args))
    except GameError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        # The reader of our output (head, a pager) has seen enough.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return 2
