"""Turn annotated takes into motion units: units.yaml and clips.npz (EMBOS, section 4).

Examples:
  run_game.py analyse                         remake assets/motion from its takes
  run_game.py analyse --check                 compare with what is there; exit 1 if it differs
  run_game.py analyse my_takes --out my_takes/units.yaml
  run_game.py analyse --learning-curve curve.png --json   how many minutes of takes are enough; writes no units
A folder of takes holds NAME.yaml and NAME.bvh per take; behaviours.yaml stands in it or beside it.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from game.core import ASSETS, EMOTIONS
from game.core.errors import BadInput, Where
from game.embos.analysis import annotated_s, shares, transitions, units_of
from game.embos.annotations import ReadClip, Take, read_takes
from game.embos.clips import KnownClips, TakeClip, pack_clips, same_clips
from game.embos.findings import Findings
from game.embos.repertoire import Behaviour, read_repertoire
from game.embos.statistics import ALPHA
from game.embos.units import LAYERS, MotionUnit
from game.embos.units_file import units_text
from game.formats.files import write_text

__all__ = ["add_arguments", "counted", "run", "write_units"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's grammar."""
    motion = ASSETS / "motion"
    parser.add_argument("takes", nargs="?", type=Path, default=motion / "takes", help="folder of takes")
    parser.add_argument("--behaviours", type=Path, help="the repertoire (default: behaviours.yaml in or beside TAKES)")
    parser.add_argument("--out", type=Path, help="units file (default: units.yaml beside TAKES), clips.npz with it")
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 if the files would change")
    parser.add_argument("--alpha", type=float, default=ALPHA, help="importance against universality in eq. 2")
    parser.add_argument(
        "--learning-curve", type=Path, nargs="?", const=Path(), metavar="PNG",
        help="resample the takes: how far shorter ones are from the whole (a plot needs the `reports` extra)",
    )  # fmt: skip
    parser.add_argument("--draws", type=int, default=8, help="stretches drawn per length of the curve (default 8)")
    parser.add_argument("--seed", type=int, default=1, help="of the curve's draws (default 1)")
    parser.add_argument("--json", action="store_true", help="machine-readable result")


def run(args: argparse.Namespace) -> int:
    """0 good, 1 findings or a difference, 2 a file that cannot be read. Nothing is written unless all is good."""
    folder: Path = args.takes
    out: Path = args.out or folder.resolve().parent / "units.yaml"
    if not 0.0 <= args.alpha <= 1.0:
        raise BadInput("--alpha", expected="a number from 0 to 1", seen=args.alpha)
    findings = Findings()
    inside = folder / "behaviours.yaml"
    beside = folder.resolve().parent / "behaviours.yaml"
    behaviours = args.behaviours or (inside if inside.exists() else beside)
    if args.learning_curve is not None:
        repertoire = read_repertoire(behaviours, findings)
        takes = read_takes(folder, repertoire, findings)
        return _report(findings, as_json=args.json) if len(findings) else _learning_curve(takes, repertoire, args)
    takes, units = counted(folder, behaviours, findings, args.alpha)
    if len(findings):
        return _report(findings, as_json=args.json)
    differs = _differs(out, *_contents(takes, units))
    if differs and not args.check:
        write_units(takes, units, out)
    _summary(takes, units, out, differs, check=args.check, as_json=args.json)
    return 1 if args.check and differs else 0


def counted(
    folder: Path, behaviours: Path, findings: Findings, alpha: float = ALPHA, read_clip: ReadClip | None = None
) -> tuple[list[Take], list[MotionUnit]]:
    """The takes of a folder and their units; what is wrong goes into the findings, and then there are no units."""
    repertoire = read_repertoire(behaviours, findings)
    takes = read_takes(folder, repertoire, findings, read_clip)
    if len(findings):
        return takes, []
    units = units_of(takes, repertoire, alpha)
    for layer in LAYERS:
        if not any(unit.layer == layer for unit in units):
            findings.add(BadInput("takes", where=Where(folder), expected=f"spans of the layer {layer}", seen="none"))
    return takes, units


def _contents(takes: list[Take], units: list[MotionUnit]) -> tuple[str, dict[str, TakeClip]]:
    return units_text(units, transitions(takes)), {take.name: take.clip for take in takes}


def _differs(out: Path, text: str, bank: Mapping[str, TakeClip], known: KnownClips | None = None) -> list[str]:
    clips = out.parent / "clips.npz"
    differs = [str(out)] if not out.exists() or out.read_bytes() != text.encode() else []
    return differs + ([str(clips)] if not same_clips(clips, bank, known) else [])


def write_units(takes: list[Take], units: list[MotionUnit], out: Path, known: KnownClips | None = None) -> list[str]:
    """units.yaml at ``out`` and clips.npz beside it, where they differ from what is there -> the files that did.

    known: the clips file as it was when somebody looked last.
    """
    text, bank = _contents(takes, units)
    clips = out.parent / "clips.npz"
    differs = _differs(out, text, bank, known)
    out.parent.mkdir(parents=True, exist_ok=True)
    if str(clips) in differs:
        temporary = clips.with_name(f".{clips.name}.new")
        temporary.write_bytes(pack_clips(bank))
        # The clips first, the units at once after them: a game that watches both reads them once.
        temporary.replace(clips)
    if str(out) in differs:
        write_text(out, text)
    return differs


def _learning_curve(takes: list[Take], repertoire: Mapping[str, Behaviour], args: argparse.Namespace) -> int:
    from game.tools.annotate.curve_plot import check_plot, plot_curve
    from game.tools.annotate.learning_curve import MEASURES, learning_curve

    if not 2 <= args.draws <= 1000:
        raise BadInput("--draws", expected="2 to 1000", seen=args.draws)
    plot = args.learning_curve if args.learning_curve.name else None
    if plot is not None:
        check_plot(plot)
    curve = learning_curve(takes, repertoire, draws=args.draws, seed=args.seed)
    if plot is not None:
        plot_curve(curve, plot)
    if args.json:
        print(json.dumps(curve.row()))
        return 0
    print(f"{'take length':>12}  " + "  ".join(f"{name:>22}" for name in MEASURES))
    for p in curve.points:
        cells = (f"{p.mean[m]:.3f} [{p.low[m]:.3f}, {p.high[m]:.3f}]" for m in MEASURES)
        print(f"{p.length_s:10.0f} s  " + "  ".join(f"{cell:>22}" for cell in cells))
    print(f"the dice alone make the behaviour differ by {curve.dice:.3f}")
    enough = f"{curve.enough_s:.0f} s a take" if curve.enough_s is not None else "more than these takes have"
    print(f"enough for this repertoire: {enough}")
    return 0


def _report(findings: Findings, *, as_json: bool) -> int:
    if as_json:
        print(json.dumps({"findings": [error.message for error in findings.items]}, ensure_ascii=False))
    for error in findings.items if not as_json else []:
        print(error.message, file=sys.stderr)
    if not as_json:
        print(f"{len(findings)} findings; nothing was written", file=sys.stderr)
    return 2 if findings.broken else 1


def _summary(
    takes: list[Take], units: list[MotionUnit], out: Path, differs: list[str], *, check: bool, as_json: bool
) -> None:
    share = shares(units)
    if as_json:
        result = {
            "out": str(out),
            "differs": differs,
            "takes": {t.name: {"length_s": t.clip.length_s, "annotated_s": annotated_s([t])} for t in takes},
            "units": {
                u.name: {
                    "layer": u.layer,
                    "share": {e: float(round(share[i, k], 6)) for k, e in enumerate(EMOTIONS) if u.exists[k]},
                    "intensity": {e: float(round(u.intensity[k], 6)) for k, e in enumerate(EMOTIONS) if u.exists[k]},
                }
                for i, u in enumerate(units)
            },
        }
        print(json.dumps(result, ensure_ascii=False))
        return
    length = sum(take.clip.length_s for take in takes)
    for layer in LAYERS:
        mine = [u for u in units if u.layer == layer]
        print(f"{layer:10} {len(mine):3} units from {sum(len(u.variants) for u in mine):4} spans")
    for k, emotion in enumerate(EMOTIONS):
        best = np.argsort(-share[:, k], kind="stable")[:4]
        shown = [f"{units[i].name} {100 * share[i, k]:.0f} %" for i in best if share[i, k] > 0]
        print(f"{emotion:10} " + ", ".join(shown))
    verb = ("differs: " + ", ".join(differs)) if check and differs else ("unchanged" if not differs else "written")
    print(f"{len(takes)} takes, {length:.0f} s -> {out}: {verb}")
