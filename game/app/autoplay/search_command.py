"""``autoplay --search POLICY``: look for a better strategy, and keep it with how it was found."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import yaml

from game.app.autoplay.progress import Progress
from game.app.autoplay.search import CHECK_SEED, TRAIN_SEED, Found, search, sign_bank
from game.app.body import BodyObserver
from game.app.content import load_talk_assets, stall_path
from game.app.policies import COMPARED, TUNED, FixedPlan, load_tuned
from game.core.errors import BadInput
from game.formats.files import write_text
from game.formats.yaml_source import nearest

__all__ = ["keep", "run_search"]

_HEAD = """\
# Strategies that searches found, by policy and temperament: what autoplay's players bargain with, so that they compare
# fairly. Made by `run_game.py autoplay --search POLICY --stall NAME --save`; the words behind the numbers stand in
# game/app/policies/strategy.py. `found` tells for each how many strategies were tried on how many talks each, and the
# mean surplus on fresh talks before and after.
"""


def run_search(args: argparse.Namespace, stalls: tuple[str, ...]) -> int:
    """Search for one policy at each stall, print what is found, and keep it where ``--save`` says so."""
    searchable = [name for name in COMPARED if name != "random"]
    if args.search not in searchable:
        raise BadInput(
            "--search", expected=" | ".join(searchable), seen=args.search, hint=nearest(args.search, searchable)
        )
    for stall in stalls:
        assets = load_talk_assets(stall_path(stall))
        observer = bank = None
        if args.search in {"body", "reader"}:
            observer = BodyObserver.load(explain=False)
            bank = sign_bank(assets, observer)
        bar = Progress(args.candidates, show=True if args.progress else None)
        found = search(
            assets, args.search, candidates=args.candidates, episodes=args.episodes, seed=args.seed,
            observer=observer, bank=bank, tell=bar.add,
        )  # fmt: skip
        bar.end()
        if args.save:
            keep([found])
        if args.json:
            print(json.dumps({"stall": stall} | found.to_dict(), ensure_ascii=False))
        else:
            print(
                f"{stall}: {args.search} for a {found.temperament}: surplus {found.before:.3f} -> {found.surplus:.3f} "
                f"on fresh talks, after {found.candidates} strategies on {found.episodes} talks each",
                file=sys.stdout,
            )
            for name, value in asdict(found.strategy).items():
                print(f"  {name}: {value}")
    return 0


def keep(findings: list[Found], path: Path = TUNED) -> None:
    """Write findings into the file of strategies."""
    known = load_tuned(path)
    notes: dict[str, Any] = dict(yaml.safe_load(path.read_text(encoding="utf-8"))["found"])
    fixed = {name: _plain(plan) for name, plan in known.fixed.items()}
    others = {who: {name: _plain(s) for name, s in own.items()} for who, own in known.strategies.items()}
    for found in findings:
        own = fixed if isinstance(found.strategy, FixedPlan) else others.setdefault(found.policy, {})
        own[found.temperament] = _plain(found.strategy)
        notes[f"{found.policy} {found.temperament}"] = {
            "candidates": found.candidates, "talks": found.episodes, "before": found.before, "after": found.surplus,
            "seeds": [TRAIN_SEED, CHECK_SEED],
        }  # fmt: skip
    rows = ["version: 1", "found:"]
    rows += [f"  {name}: {_flow(note)}" for name, note in sorted(notes.items())]
    for who, own in (("fixed", fixed), *others.items()):
        if own:
            rows += [f"{who}:"] + [f"  {name}: {_flow(values)}" for name, values in own.items()]
    write_text(path, _HEAD + "\n".join(rows) + "\n")


def _plain(strategy: Any) -> dict[str, Any]:
    return {name: list(v) if isinstance(v, tuple) else v for name, v in asdict(strategy).items()}


def _flow(values: dict[str, Any]) -> str:
    return json.dumps(values, ensure_ascii=False).replace('"', "")
