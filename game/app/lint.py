"""Check dialogue scripts: every finding at once, as ``file:line:col: CODE message (hint)``.

Codes that begin with E are errors (the stall cannot be played), W warnings, I remarks. Exit code 1 where there are
errors or warnings, 0 where there are none.

Examples:
  run_game.py lint
  run_game.py lint dialogue/flea.yaml --json
  run_game.py lint --codes
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from pathlib import Path

from game.core.paths import DIALOGUE
from game.story import CODES, lint_files

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The grammar of ``lint``."""
    parser.add_argument(
        "paths", metavar="PATH", nargs="*", type=Path, default=[DIALOGUE], help="files or folders (default: dialogue/)"
    )
    parser.add_argument("--json", action="store_true", help="the findings as one JSON object")
    parser.add_argument("--codes", action="store_true", help="list the codes and what they mean, and stop")


def run(args: argparse.Namespace) -> int:
    """Print the findings; 1 where there are errors or warnings."""
    if args.codes:
        for code, meaning in CODES.items():
            print(f"{code:24} {meaning}")
        return 0
    findings = lint_files([_short(path) for path in args.paths])
    counts = Counter(finding.severity for finding in findings)
    if args.json:
        print(
            json.dumps(
                {
                    "findings": [finding.to_dict() for finding in findings],
                    "errors": counts["error"],
                    "warnings": counts["warning"],
                    "infos": counts["info"],
                },
                ensure_ascii=False,
                indent=1,
            )
        )
    else:
        for finding in findings:
            print(finding)
        told = ", ".join(f"{counts[name]} {name}{'s' * (counts[name] != 1)}" for name in ("error", "warning", "info"))
        print(told if findings else "no findings")
    return 1 if counts["error"] or counts["warning"] else 0


def _short(path: Path) -> Path:
    """A path below the working folder, without what leads there."""
    try:
        return path.resolve().relative_to(Path.cwd())
    except ValueError:
        return path
