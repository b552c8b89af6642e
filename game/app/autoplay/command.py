"""Play many talks without a window, with policies, and log, count and judge what happens.

examples:
  run_game.py autoplay --episodes 1000 --policy oracle --seed 1 --out log.jsonl
  run_game.py autoplay --stall all --policy all --episodes 2000 --workers auto --report report.html
  run_game.py autoplay --policy random:0.5,reader:0.5 --episodes 400 --json
  run_game.py autoplay --policy my_policy.py --episodes 200      an own policy, see docs/autoplay.md
  run_game.py autoplay --episodes 1000000 --out log.jsonl.gz --workers auto --resume
  run_game.py autoplay --stall toys --visits 4 --episodes 300    come back three times each afternoon
  run_game.py autoplay --stall all --policy explorer:4,oracle:2 --visits 4 --episodes 600 --report r.html    coverage
  run_game.py autoplay --dask tcp://scheduler:8786 --episodes 100000
  run_game.py autoplay --stall all --policy all --require coverage.yaml --junit autoplay.xml
  run_game.py autoplay --search fixed --stall flea --candidates 200

Policies: random fixed words face body reader oracle (all: these seven), explorer (another temper in every talk: comes
everywhere), script:FILE, FILE.py, or a mixture of them with shares. Each sees only what its name allows; body and
reader look at what the body planner really displays. One JSON line per decision goes to the log; one seed gives the
same bytes and figures, however many workers play. Ctrl-C stops with what is done.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from functools import partial
from pathlib import Path
from typing import Any

from game.app.autoplay.comparisons import Comparison, compared
from game.app.autoplay.coverage import covered
from game.app.autoplay.executors import Crew, workers_of
from game.app.autoplay.places import check_places
from game.app.autoplay.progress import Progress
from game.app.autoplay.runs import Plan, Run, play
from game.app.content import load_talk_assets, stall_path
from game.app.policies import COMPARED, mixture_of, seat_exists
from game.core.errors import BadInput
from game.story import shipped_stalls

__all__ = ["add_arguments", "run"]

MOST_VISITS = 20
"""As far as scripts count them."""
INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells have it."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``autoplay``."""
    parser.add_argument("--episodes", type=int, default=100, help="talks per policy and stall (default 100)")
    parser.add_argument("--visits", type=int, default=1, help="talks of an episode: come back so often (default 1)")
    parser.add_argument(
        "--policy", action="append", metavar="WHO", help="who plays (default random); again for more, or all"
    )
    parser.add_argument(
        "--stall", action="append", metavar="NAME", help="stall name, a dialogue file, or all (default flea)"
    )
    parser.add_argument("--seed", type=int, default=1, help="one seed, one result (default 1)")
    parser.add_argument("--out", type=Path, help="write one JSON line per decision here; .gz compresses")
    parser.add_argument("--record", type=Path, metavar="DIR", help="a recording of every talk, for replay")
    parser.add_argument("--resume", action="store_true", help="go on with the stopped run of --out")
    parser.add_argument("--body", action="store_true", help="also run the body planner; log units and why they began")
    parser.add_argument(
        "--mode", choices=["full", "gestures", "body", "face"], default="full", help="which of the body's layers act"
    )
    parser.add_argument("--workers", default="1", help="processes to play in: a number or auto (default 1)")
    parser.add_argument("--dask", default="", metavar="ADDRESS", help="play on Dask: tcp://HOST:PORT or local")
    parser.add_argument("--progress", action="store_true", help="show the bar even where no terminal is")
    parser.add_argument("--report", type=Path, metavar="FILE", help="write a report as one HTML file")
    parser.add_argument("--plots", type=Path, metavar="DIR", help="write the report's plots as SVG and PNG")
    parser.add_argument("--junit", type=Path, metavar="FILE", help="write coverage and requirements as JUnit XML")
    parser.add_argument("--require", type=Path, metavar="FILE", help="thresholds (YAML); exit code 1 if one is missed")
    parser.add_argument("--search", metavar="POLICY", help="search a better strategy for a policy, and print it")
    parser.add_argument("--candidates", type=int, default=100, help="--search: strategies to try (default 100)")
    parser.add_argument("--save", action="store_true", help="--search: keep what is found in assets/autoplay")
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")


def _stalls(names: list[str]) -> tuple[str, ...]:
    found: list[str] = []
    for name in names:
        found += [path.stem for path in shipped_stalls()] if name == "all" else [name]
    for name in found:
        stall_path(name)
    return tuple(dict.fromkeys(found))


def _populations(words: list[str]) -> tuple[str, ...]:
    found: list[str] = []
    for word in words:
        found += list(COMPARED) if word == "all" else [str(mixture_of(word))]
    for population in found:
        for name, _ in mixture_of(population).shares:
            seat_exists(name)
    return tuple(dict.fromkeys(found))


def run(args: argparse.Namespace) -> int:
    """Play, log, summarise, report, judge."""
    if args.episodes < 1:
        raise BadInput("--episodes", expected="at least 1", seen=args.episodes)
    if not 1 <= args.visits <= MOST_VISITS:
        raise BadInput("--visits", expected=f"1 to {MOST_VISITS}", seen=args.visits)
    if args.search and args.visits > 1:
        raise BadInput("--search", expected="first visits alone, without --visits", seen=args.visits)
    if args.resume and args.out is None:
        raise BadInput("--resume", expected="--out with the log to go on with", seen="none")
    stalls = _stalls(args.stall or ["flea"])
    if args.search:
        from game.app.autoplay.search_command import run_search

        return run_search(args, stalls)
    from game.app.autoplay.requirements import check_played, judge, load_requirements

    requirements = None if args.require is None else load_requirements(args.require)
    judged = any(x is not None for x in (args.report, args.plots, args.junit, args.require))
    if args.record is not None and args.visits > 1:
        raise BadInput("--record", expected="talks of first visits (--visits 1)", seen=f"--visits {args.visits}")
    plan = Plan(
        stalls, _populations(args.policy or ["random"]), args.episodes, args.seed, args.body, args.mode,
        "" if args.out is None else "gzip" if args.out.suffix == ".gz" else "plain", judged, visits=args.visits,
        record="" if args.record is None else str(args.record.resolve()),
        # Dask's workers stand elsewhere.
        folder=os.getcwd() if args.dask else "",
    )  # fmt: skip
    if requirements is not None:
        check_played(requirements, plan.populations, plan.visits, plan.stalls)
    check_places(args.out, args.record, args.plots, [args.junit, args.report])
    if args.report is not None or args.plots is not None:
        from game.tools.reports import load_matplotlib

        load_matplotlib()
    crew = Crew(workers_of(args.workers), args.dask)
    bar = partial(Progress, show=True if args.progress else None)
    done = play(plan, crew, out=args.out, resume=args.resume, progress=bar)
    if not done.whole:
        print(f"stopped after {done.talks:,} of {plan.talks:,} talks", file=sys.stderr)
    if done.talks:
        _tell(done, args.json)
    findings = judge(done, requirements)
    _write_reports(done, findings, args)
    for finding in findings:
        if not finding.good:
            print(f"{finding.where}: {finding.text}", file=sys.stderr)
    if not done.whole:
        return INTERRUPTED
    return 1 if any(not finding.good for finding in findings) else 0


def _write_reports(done: Run, findings: list[Any], args: argparse.Namespace) -> None:
    if args.junit is not None:
        from game.app.autoplay.junit import write_junit

        write_junit(args.junit, done, findings)
    if args.report is not None or args.plots is not None:
        from game.tools.reports import write_plots, write_report

        if args.plots is not None:
            write_plots(args.plots, done)
        if args.report is not None:
            write_report(args.report, done, findings)


def summaries(done: Run) -> list[dict[str, Any]]:
    """One summary per population and stall; a mixture's also by policy."""
    rows = []
    for stall in done.plan.stalls:
        for population in done.plan.populations:
            total = done.total(stall, population)
            if not total.talks:
                continue
            row = {"policy": population, "stall": stall, "seed": done.plan.seed} | total.summary()
            later = done.total(stall, population, later=True)
            if later.talks:
                row["later_visits"] = later.summary()
            own = done.policies(stall, population)
            if len(own) > 1:
                row["policies"] = {who: tally.summary() for who, tally in own.items()}
            rows.append(row)
    return rows


def comparisons_at(done: Run, stall: str) -> list[Comparison]:
    """What the policies of a run are worth against each other at a stall."""
    tallies = {name: done.total(stall, name) for name in done.plan.populations}
    return compared(tallies, load_talk_assets(stall_path(stall)).person.mask) if len(tallies) > 1 else []


def _tell(done: Run, as_json: bool) -> None:
    rows = summaries(done)
    against = {stall: comparisons_at(done, stall) for stall in done.plan.stalls}
    if as_json:
        for row in rows:
            if row["policy"] == "oracle" and against[row["stall"]]:
                row["compared"] = [figure.to_dict() for figure in against[row["stall"]]]
        print(json.dumps(rows[0] if len(rows) == 1 else rows, ensure_ascii=False))
        return
    if len(rows) == 1:
        _tell_one(rows[0])
        return
    print(f"{done.plan.episodes} talks each, seed {done.plan.seed}; surplus: share of the possible gain ± 95 %")
    wide = max(len(str(row["policy"])) for row in rows)
    for stall in done.plan.stalls:
        print(f"\n{stall}\n  {'':{wide}}  surplus          deals           moves  right  wrong")
        for row in rows:
            if row["stall"] == stall:
                print(
                    f"  {row['policy']:{wide}}  {row['mean_surplus']:.3f} ± {row['mean_surplus_ci95']:.3f}"
                    f"    {row['deal_rate']:.1%} ± {row['deal_rate_ci95']:.1%}    {row['mean_rounds']:.2f}"
                    f"   {row['lines']['right']:.2f}   {row['lines']['wrong']:.2f}"
                )
        for figure in against[stall]:
            print(f"  {figure.text}")
        if done.plan.cover:
            reached = [f"{kind} {part.reached}/{part.total}" for kind, part in covered(done, stall).items()]
            print(f"  reached: {', '.join(reached)}")


def _tell_one(row: dict[str, Any]) -> None:
    print(f"{row['episodes']} talks at {row['stall']}, policy {row['policy']}, seed {row['seed']}")
    print(f"  deals         {row['deal_rate']:.1%} ± {row['deal_rate_ci95']:.1%}")
    print(f"  mean surplus  {row['mean_surplus']:.3f} ± {row['mean_surplus_ci95']:.3f} of the possible gain")
    print(f"  moves         {row['mean_rounds']:.2f} ± {row['mean_rounds_ci95']:.2f} a talk")
    if "later_visits" in row:
        later = row["later_visits"]
        told = f"deals {later['deal_rate']:.1%}, mean surplus {later['mean_surplus']:.3f}"
        print(f"  later visits  {told} in {later['episodes']}")
    for ending, count in row["endings"].items():
        print(f"  {ending:<14}{count}")
    for who, own in row.get("policies", {}).items():
        print(f"  {who:<14}{own['mean_surplus']:.3f} ± {own['mean_surplus_ci95']:.3f} in {own['episodes']} talks")
