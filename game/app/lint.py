"""Check dialogue scripts: every finding at once, as ``file:line:col: CODE message (hint)``.

Codes that begin with E are errors (the stall cannot be played), W warnings, I remarks. Exit code 1 where there are
errors or warnings, 0 where there are none.

Examples:
  run_game.py lint
  run_game.py lint dialogue/flea.yaml --json
  run_game.py lint --fix
  run_game.py lint dialogue/toys.yaml --walks 500 --seed 7
  run_game.py lint --codes
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from pathlib import Path

from game.app.afternoon import PURSE
from game.core.errors import BadInput
from game.core.paths import DIALOGUE
from game.formats.files import write_text
from game.story import CODES, Script, fix_file, lint_files, load_script, write_lock
from game.story.lint import dialogue_files
from game.story.reader import is_stall
from game.story.schema import schema_text
from game.story.translations import LOCK_NAME

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The grammar of ``lint``."""
    parser.add_argument(
        "paths", metavar="PATH", nargs="*", type=Path, default=[DIALOGUE], help="files or folders (default: dialogue/)"
    )
    parser.add_argument("--json", action="store_true", help="the findings as one JSON object")
    parser.add_argument("--fix", action="store_true", help="write missing ids, and the lock of translations")
    parser.add_argument(
        "--accept", action="store_true", help="like --fix, and take stale Japanese as checked against the new English"
    )
    parser.add_argument(
        "--schema", action="store_true", help="write dialogue/schema.json (editor completion and hover), and stop"
    )
    parser.add_argument(
        "--walks", type=int, default=0, metavar="N", help="also play N random talks through each stall (default 0)"
    )
    parser.add_argument("--seed", type=int, default=1, help="seed of the random talks (default 1)")
    parser.add_argument("--purse", type=int, default=PURSE, help=f"what the player can spend (default {PURSE})")
    parser.add_argument("--codes", action="store_true", help="list the codes and what they mean, and stop")


def run(args: argparse.Namespace) -> int:
    """Print the findings; 1 where there are errors or warnings."""
    if args.codes:
        for code, meaning in CODES.items():
            print(f"{code:24} {meaning}")
        return 0
    if args.schema:
        write_text(DIALOGUE / "schema.json", schema_text())
        print(_short(DIALOGUE / "schema.json"))
        return 0
    paths = [_short(path) for path in args.paths]
    fixed = _fix(paths, accept=args.accept) if args.fix or args.accept else {}
    findings = lint_files(paths, args.purse, walks=min(args.walks, 100_000), seed=args.seed)
    counts = Counter(finding.severity for finding in findings)
    if args.json:
        print(
            json.dumps(
                {
                    "findings": [finding.to_dict() for finding in findings],
                    "errors": counts["error"],
                    "warnings": counts["warning"],
                    "infos": counts["info"],
                    "fixed": fixed,
                },
                ensure_ascii=False,
                indent=1,
            )
        )
    else:
        for place, count in fixed.items():
            print(f"{place}: {count} written")
        for finding in findings:
            print(finding)
        told = ", ".join(f"{counts[name]} {name}{'s' * (counts[name] != 1)}" for name in ("error", "warning", "info"))
        print(told if findings else "no findings")
    return 1 if counts["error"] or counts["warning"] else 0


def _fix(paths: list[Path], *, accept: bool) -> dict[str, int]:
    """Missing ids of the files, then the lock of translations of the folders they stand in; how many of each."""
    fixed: dict[str, int] = {}
    folders: dict[Path, list[Script]] = {}
    for path in dialogue_files(paths):
        if path.name == LOCK_NAME:
            continue
        try:
            ids = fix_file(path)
            if ids:
                fixed[f"{path} ids"] = len(ids)
            if is_stall(path):
                folders.setdefault(path.parent, []).append(load_script(path))
        except BadInput:
            continue  # what cannot be read or has errors is told by the findings
    for folder, scripts in folders.items():
        changed = write_lock(folder / LOCK_NAME, scripts, accept=[s.stall for s in scripts] if accept else ())
        if changed:
            fixed[f"{folder / LOCK_NAME} lines"] = changed
    return fixed


def _short(path: Path) -> Path:
    """A path below the working folder, without what leads there."""
    try:
        return path.resolve().relative_to(Path.cwd())
    except ValueError:
        return path
