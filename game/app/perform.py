"""Let one body live in one feeling, without a picture: which units play, when, why, and how much.

examples:
  run_game.py perform --emotion sadness=1 --minutes 10 --seed 1 --json
  run_game.py perform --emotion joy=1 --line "Take a look at this one!" --minutes 2 --explain
  run_game.py perform --check                   all seven pure emotions against their takes; exit 1 on findings
  run_game.py perform --emotion anger=0.5,joy=0.5 --every-word --pose

The same step as in the game, 30 times a second. A start's reason is the one that decided; its source is the take
and span that plays. Shares (postures) and rates (mannerisms, gestures) stand beside those of the feeling's take.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.app.arguments import add_emotion
from game.app.loading import load_step_assets
from game.app.perform_check import check_means, check_performance
from game.app.performance import (
    Performance,
    Script,
    correlations,
    line_entropy,
    line_motions,
    perform,
    take_rates,
)
from game.app.step import StepAssets
from game.core.emotion_space import EMOTIONS, with_neutral
from game.core.errors import BadInput
from game.embos import LAYERS, UnitLibrary

__all__ = ["add_arguments", "run"]

Floats = NDArray[np.float64]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``perform``."""
    add_emotion(parser)
    parser.add_argument("--minutes", type=float, default=10.0, help="how long (default 10)")
    parser.add_argument("--seed", type=int, default=1, help="one seed, one performance (default 1)")
    parser.add_argument("--mode", choices=["full", "gestures", "body", "face"], default="full", help="what is acted")
    parser.add_argument("--line", default="", metavar="TEXT", help="a line said again and again")
    parser.add_argument("--pause", type=float, default=2.0, help="seconds between two lines (default 2)")
    parser.add_argument("--every-word", action="store_true", help="all gesture words at hand all the time")
    parser.add_argument("--language", choices=["en", "ja"], default="en")
    parser.add_argument("--pose", action="store_true", help="make the poses too and tell the joints' mean speed")
    parser.add_argument("--explain", action="store_true", help="with each start, all candidates with their factors")
    parser.add_argument("--check", action="store_true", help="compare the pure emotions with their takes; exit 1")
    parser.add_argument("--json", action="store_true", help="machine-readable result")


def run(args: argparse.Namespace) -> int:
    """Perform and print."""
    if not 0.0 < args.minutes <= 240.0:
        raise BadInput("--minutes", expected="above 0, at most 240", seen=args.minutes)
    if not 0.0 <= args.pause <= 600.0:
        raise BadInput("--pause", expected="0 to 600 s", seen=args.pause)
    assets = load_step_assets(body=args.pose)
    if args.check:
        return _check(assets, args)
    emotion = np.asarray(args.emotion)
    script = Script(args.line, args.pause, args.every_word)
    done = perform(assets, emotion, args.minutes * 60, args.seed, mode=args.mode, language=args.language, script=script)
    summary = _summary(assets.planner.library, done, emotion)
    if args.json:
        head = {"emotion": _named(emotion), "mode": args.mode, "seed": args.seed, "minutes": args.minutes}
        rows = [event.row(table=args.explain) for event in done.events]
        print(json.dumps(head | summary | {"events": rows}, ensure_ascii=False))
    else:
        _print_events(done, table=args.explain)
        _print_summary(summary)
    return 0


def _named(emotion: Floats) -> dict[str, float]:
    return {name: round(float(v), 4) for name, v in zip(EMOTIONS, emotion, strict=True) if v > 0.0}


def _summary(library: UnitLibrary, done: Performance, emotion: Floats) -> dict[str, Any]:
    """Share or rate of each unit beside the take's (mixed by what is felt), agreement, and what lines brought."""
    weight = emotion / emotion.sum()
    take_share, take_rate = (table @ weight for table in take_rates(library))
    units = {}
    for i, unit in enumerate(library.units):
        if done.share[i] > 0.0 or (take_share[i] > 0.0 and not unit.is_rest):
            mine = {"share": done.share[i], "per_minute": done.rate[i]}
            units[unit.name] = {"layer": unit.layer} | {k: round(float(v), 5) for k, v in mine.items()}
            if not unit.is_rest:
                takes = {"take_share": take_share[i], "take_per_minute": take_rate[i]}
                units[unit.name] |= {k: round(float(v), 5) for k, v in takes.items()}
    result: dict[str, Any] = {"units": units}
    if np.count_nonzero(emotion) == 1:
        r = correlations(library, done, int(emotion.argmax()))
        result["r"] = {layer: round(value, 4) for layer, value in r.items()}
    if done.lines:
        result["same_line"] = line_entropy(line_motions(done))
    if done.speed_rad_s > 0.0:
        result["joint_speed_deg_s"] = round(float(np.rad2deg(done.speed_rad_s)), 2)
    return result


def _print_events(done: Performance, *, table: bool) -> None:
    for event in done.events:
        c = event.chosen
        stroke = "" if event.stroke_s is None else f", stroke at {event.stroke_s:.2f}"
        print(
            f"{event.time_s:8.2f} {c.layer:10} {c.name:18} ω_c {c.continuity:.3f} ω_l {c.linkage:.0f} "
            f"φ_time {c.time:.3f} φ_state {c.state:.3f} = {c.score:.4f}  for {event.duration_s:.2f} s{stroke}; "
            f"{event.source}; {c.reason}"
        )
        for other in event.table[1:] if table else ():
            print(
                f"{'':20}{other.name:18} ω_c {other.continuity:.3f} ω_l {other.linkage:.0f} φ_time {other.time:.4f} "
                f"φ_state {other.state:.3f} = {other.score:.4f}  {other.reason}"
            )


def _print_summary(summary: Mapping[str, Any]) -> None:
    for layer in LAYERS:
        key = "share" if layer == "posture" else "per_minute"
        print(f"{layer:20} {'share' if layer == 'posture' else 'a minute':>10} {'in the take':>12}")
        own = [(name, row) for name, row in summary["units"].items() if row["layer"] == layer]
        for name, row in sorted(own, key=lambda item: -item[1][key]):
            take = f"{row['take_' + key]:12.3f}" if "take_" + key in row else ""
            print(f"  {name:18} {row[key]:10.3f} {take}")
    if "r" in summary:
        print("agreement with the take: " + ", ".join(f"{layer} r = {r:.3f}" for layer, r in summary["r"].items()))
    if "same_line" in summary:
        s = summary["same_line"]
        print(
            f"after the same line, {s['lines']:.0f} times: {s['bits']:.2f} bits of at most {s['most']:.2f}; "
            f"{s['repeated']:.0%} like the one before"
        )
    if "joint_speed_deg_s" in summary:
        print(f"mean speed of a joint: {summary['joint_speed_deg_s']:.1f} °/s")


def _check(assets: StepAssets, args: argparse.Namespace) -> int:
    """Every pure emotion against its take, every word at hand."""
    library, findings = assets.planner.library, []
    r: dict[str, dict[str, float]] = {}
    for k, name in enumerate(EMOTIONS):
        pure = with_neutral(np.eye(7)[k, :6])
        done = perform(assets, pure, args.minutes * 60, args.seed, script=Script(every_word=True))
        findings += check_performance(assets.planner, done, k)
        r[name] = correlations(library, done, k)
    findings += check_means(r)
    if args.json:
        print(json.dumps({"seed": args.seed, "minutes": args.minutes, "r": r, "findings": findings}))
    else:
        print(f"{'':10}" + "".join(f"{layer:>11}" for layer in LAYERS))
        for name, by_layer in r.items():
            print(f"{name:10}" + "".join(f"{by_layer.get(layer, float('nan')):11.3f}" for layer in LAYERS))
        print("\n".join(findings) if findings else "every pure emotion keeps its take's statistics")
    return 1 if findings else 0
