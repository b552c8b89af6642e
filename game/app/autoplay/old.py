"""Play many talks without a window, with a policy, and log every decision.

examples:
  run_game.py autoplay --episodes 1000 --policy oracle --seed 1 --out log.jsonl
  run_game.py autoplay --episodes 200 --policy random --body --json

One JSON line per decision goes to the log; identical seeds give identical bytes. The summary tells the deal rate
and the mean share of the possible gain with its 95 % interval.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from game.app.content import load_talk_assets, stall_path
from game.app.policies import POLICIES, Policy
from game.app.talk import TalkAssets, TalkState, ask_money, choose, start_talk
from game.core.emotion_space import EMOTIONS
from game.core.errors import BadInput

__all__ = ["Episode", "add_arguments", "play_episode", "run", "summarise"]

MAX_MOVES = 64
"""A talk is over long before this many moves; one that is not is a fault worth stopping for."""


@dataclass(frozen=True)
class Episode:
    """What became of one talk. surplus: share of the possible gain in [0, 1]; rounds: moves made."""

    ending: str
    deal: bool
    surplus: float
    rounds: int


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``autoplay``."""
    parser.add_argument("--episodes", type=int, default=100, help="talks to play (default 100)")
    parser.add_argument("--policy", choices=sorted(POLICIES), default="random", help="who plays (default random)")
    parser.add_argument("--stall", default="flea", help="stall name or a dialogue file (default flea)")
    parser.add_argument("--seed", type=int, default=1, help="one seed, one result (default 1)")
    parser.add_argument("--out", type=Path, help="write one JSON line per decision here")
    parser.add_argument("--body", action="store_true", help="also run the body planner; log units and why they began")
    parser.add_argument(
        "--mode", choices=["full", "gestures", "body", "face"], default="full", help="which of the body's layers act"
    )
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")


def _numbers(values: Any) -> dict[str, float]:
    return {name: round(float(v), 4) for name, v in zip(EMOTIONS, values, strict=True)}


def _row(episode: int, before: TalkState, after: TalkState, choice_id: str, offer: int | None) -> dict[str, Any]:
    record = dict(after.record)
    return {
        "episode": episode,
        "round": after.bargain.round,
        "item": after.item,
        "node": before.beat.node,
        "choice": choice_id,
        "act": record["act"],
        "offer": offer,
        "quality": record["quality"],
        "felt_label": record["felt_label"],
        "felt": _numbers(record["felt"]),
        "shown": _numbers(record["shown"]),
        "result": record["result"],
        "outcome": record["outcome"],
        "ask": ask_money(after.list_price, after.bargain.ask),
        "patience": round(after.bargain.patience, 4),
        "trust": round(after.bargain.trust, 4),
        "lines": [line.id for line in after.beat.lines],
        "ended": after.beat.ended,
    }


def play_episode(
    assets: TalkAssets, policy: Policy, seed: int, episode: int
) -> Iterator[tuple[TalkState, TalkState, str, int | None]]:
    """Play one talk; yields (state before, state after, choice id, offer) for every decision."""
    items = sorted(assets.script.items)
    rng = np.random.default_rng([seed & 0xFFFFFFFF, episode, 0x706C6179])
    item = items[int(rng.integers(len(items)))]
    talk_seed = int(rng.integers(2**31))
    purse = int(assets.script.items[item].list_price * 1.5)
    state = start_talk(assets, item, talk_seed, purse=purse)
    for _ in range(MAX_MOVES):
        if state.ended:
            return
        move = policy(assets, state, rng)
        after = choose(assets, state, move)
        yield state, after, move.id, move.offer
        state = after
    raise BadInput(
        f"episode {episode} (seed {seed})", expected=f"an end within {MAX_MOVES} moves", seen=state.beat.node
    )


def summarise(episodes: list[Episode]) -> dict[str, Any]:
    """Deal rate, mean surplus and their 95 % intervals (normal approximation), endings, mean rounds."""
    count = len(episodes)
    surplus = np.array([e.surplus for e in episodes])
    deals = float(np.mean([e.deal for e in episodes]))
    spread = float(surplus.std(ddof=1)) if count > 1 else 0.0
    return {
        "episodes": count,
        "deal_rate": round(deals, 4),
        "deal_rate_ci95": round(1.96 * math.sqrt(deals * (1 - deals) / count), 4),
        "mean_surplus": round(float(surplus.mean()), 4),
        "mean_surplus_ci95": round(1.96 * spread / math.sqrt(count), 4),
        "mean_rounds": round(float(np.mean([e.rounds for e in episodes])), 3),
        "endings": dict(sorted(Counter(e.ending for e in episodes).items())),
    }


def _play_all(assets: TalkAssets, args: argparse.Namespace, log: TextIO | None) -> list[Episode]:
    """Talks one after the other; bodies, where they are watched, many talks at a time."""
    episodes: list[Episode] = []
    if args.body:
        from game.app.body import BATCH, BodyObserver

        observer, size = BodyObserver.load(args.mode, explain=log is not None), BATCH
    else:
        observer, size = None, 1
    for first in range(0, args.episodes, size):
        talks = [
            list(play_episode(assets, POLICIES[args.policy], args.seed, episode))
            for episode in range(first, min(first + size, args.episodes))
        ]
        watched = None
        if observer is not None:
            watched = observer.watch(assets, [[move[1] for move in talk] for talk in talks], args.seed, first)
        for at, talk in enumerate(talks):
            if not talk:
                raise BadInput(
                    f"episode {first + at}", expected="at least one decision", seen="a talk that ends at once"
                )
            for move, (before, after, choice_id, offer) in enumerate(talk if log is not None else []):
                row = _row(first + at, before, after, choice_id, offer)
                if watched is not None:
                    body = watched[at][move]
                    row |= {"mode": args.mode, "units": list(body.units), "starts": body.starts}
                assert log is not None
                log.write(json.dumps(row, ensure_ascii=False, separators=(",", ":")) + "\n")
            last = talk[-1][1]
            episodes.append(Episode(str(last.beat.ended), last.bargain.outcome == "deal", last.surplus, len(talk)))
    return episodes


def run(args: argparse.Namespace) -> int:
    """Play, log, summarise. The log appears whole or not at all."""
    if args.episodes < 1:
        raise BadInput("--episodes", expected="at least 1", seen=args.episodes)
    assets = load_talk_assets(stall_path(args.stall))
    if args.out is None:
        episodes = _play_all(assets, args, None)
    else:
        folder = args.out.resolve().parent
        if not folder.is_dir():
            raise BadInput("--out", expected="a folder that exists", seen=str(args.out.parent))
        handle, name = tempfile.mkstemp(dir=folder, prefix=f".{args.out.name}.", suffix=".part")
        try:
            with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as log:
                episodes = _play_all(assets, args, log)
            os.replace(name, args.out)
        except BaseException:
            os.unlink(name)
            raise
    summary = {"policy": args.policy, "stall": args.stall, "seed": args.seed} | summarise(episodes)
    if args.json:
        print(json.dumps(summary, ensure_ascii=False))
    else:
        _print_summary(summary, sys.stdout)
    return 0


def _print_summary(summary: dict[str, Any], out: TextIO) -> None:
    print(
        f"{summary['episodes']} talks at {summary['stall']}, policy {summary['policy']}, seed {summary['seed']}",
        file=out,
    )
    print(f"  deals         {summary['deal_rate']:.1%} ± {summary['deal_rate_ci95']:.1%}", file=out)
    print(
        f"  mean surplus  {summary['mean_surplus']:.3f} ± {summary['mean_surplus_ci95']:.3f} of the possible gain",
        file=out,
    )
    print(f"  rounds        {summary['mean_rounds']:.2f} a talk", file=out)
    for ending, count in summary["endings"].items():
        print(f"  {ending:<14}{count}", file=out)
