"""Bring anyone's motion (BVH, VRMA) onto the project's skeleton, ready to be annotated and analysed.

Examples:
  run_game.py retarget walk.bvh --out my_takes/walk.bvh
  run_game.py retarget wave.vrma --out my_takes/wave.bvh        a VRM animation knows its own bones
  run_game.py retarget walk.bvh --out walk.bvh --map mixamo     a map shipped in assets/motion/maps
  run_game.py retarget walk.bvh --out walk.bvh --map mine.yaml  joints: {leftUpperArm: L_Arm, spine: [S1, S2], …}
  run_game.py retarget walk.bvh --cut 2.5:9 --out stand.bvh     only these seconds
  run_game.py retarget walk.bvh --json                          say what would be done, write nothing

Joints are found by their names and place; lengths, axes, zero pose and heading may be anything. The result stands
behind the table, facing the customer, at 30 frames per second. Mark its spans in NAME.yaml beside it and run
``run_game.py analyse``.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, replace
from pathlib import Path

from game.core.clip import Clip
from game.core.errors import BadInput, Where
from game.formats import JointMap, map_from_bones, read_vrma
from game.formats.bvh import read_bvh, write_bvh
from game.tools.retarget import FPS, Options, find_map, load_map, retarget

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's grammar."""
    parser.add_argument("file", type=Path, metavar="FILE", help="a person's motion: .bvh or .vrma")
    parser.add_argument("--out", type=Path, metavar="TAKE.bvh", help="where to write it (nothing is written without)")
    parser.add_argument("--map", metavar="MAP", help="a joint map: a YAML file, or the name of a shipped one")
    parser.add_argument("--cut", type=_seconds, metavar="FROM:TO", help="only these seconds of the file")
    parser.add_argument("--no-table", action="store_true", help="hands may go where our table stands")
    parser.add_argument("--no-collide", action="store_true", help="hands may enter the body (implies --no-table)")
    parser.add_argument("--directions-only", action="store_true", help="keep arm directions, whatever the hands reach")
    parser.add_argument("--json", action="store_true", help="machine-readable report")


def _seconds(text: str) -> tuple[float, float]:
    try:
        start_s, end_s = (float(part) for part in text.split(":"))
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected FROM:TO in seconds such as 2.5:9 but saw {text!r}") from None
    if not 0.0 <= start_s < end_s:
        raise argparse.ArgumentTypeError(f"expected 0 <= FROM < TO but saw {text!r}")
    return start_s, end_s


def _part(clip: Clip, cut: tuple[float, float] | None, path: Path) -> Clip:
    if cut is None:
        return clip
    first, last = (round(second / clip.frame_time_s) for second in cut)
    if first >= len(clip) - 1:
        raise BadInput("--cut", where=Where(path), expected=f"a start before {clip.length_s:.2f} s", seen=cut[0])
    frames = slice(first, last + 1)
    return replace(clip, rotation=clip.rotation[frames].copy(), translation=clip.translation[frames].copy())


def _read(path: Path) -> tuple[Clip, list[str], JointMap | None]:
    """The motion, what is odd about its file, and which joint is which where the file says so."""
    if path.suffix.lower() != ".vrma":
        file = read_bvh(path)
        return file.clip, file.findings, None
    made = read_vrma(path, fps=FPS)
    names = made.clip.skeleton.names
    return made.clip, made.findings, map_from_bones({b: names[joint] for b, joint in made.bones.items()}, path)


def run(args: argparse.Namespace) -> int:
    """0 good; BadInput for a file that is no person's motion."""
    if args.out is not None:
        if args.out.suffix.lower() != ".bvh":
            raise BadInput("--out", expected="a file name ending in .bvh", seen=str(args.out))
        if args.out.exists() and args.file.exists() and args.out.samefile(args.file):
            raise BadInput("--out", where=Where(args.out), expected="another file than the one that is read", seen="it")
    joints = load_map(find_map(args.map)) if args.map else None
    clip, findings, known = _read(args.file)
    joints = joints or known
    options = Options(
        table=not (args.no_table or args.no_collide),
        collide=not args.no_collide,
        hand_targets=not args.directions_only,
    )
    made = retarget(_part(clip, args.cut, args.file), joints, options, path=str(args.file))
    if args.out is not None:
        write_bvh(made.clip, args.out)
    report = made.report
    notes = [*findings, *report.notes]
    if args.json:
        result = asdict(report) | {"notes": notes, "out": str(args.out) if args.out else None}
        print(json.dumps(result, ensure_ascii=False))
        return 0
    zero = "a standing zero pose" if report.zero_pose else "axes along the bones"
    print(f"{args.file}: {len(clip.skeleton)} joints ({zero}), {made.clip.length_s:.1f} s, map {report.map_name}")
    for target, sources in report.joints.items():
        print(f"  {target:24} {' + '.join(sources) or '–'}")
    worst = max(report.limb_error_deg, key=lambda name: report.limb_error_deg[name])
    print(f"turned by {-report.turned_deg:.0f}°, scaled by {report.scale:.4g}; "
          f"limb directions kept within {report.limb_error_deg[worst]:.0f}° ({worst}, 95 % of frames)")  # fmt: skip
    for note in notes:
        print(f"note: {note}")
    print(f"written: {args.out}" if args.out else "nothing written (no --out)")
    return 0
