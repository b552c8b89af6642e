"""What `run_game.py annotate` does without a window: proposals, exchange of files, comparison, trial."""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from game.core.errors import BadInput
from game.core.paths import ASSETS
from game.embos.annotations import Take, read_takes, reference_clip
from game.embos.clips import TakeClip
from game.embos.findings import Findings
from game.embos.repertoire import Behaviour, read_repertoire
from game.embos.units import LAYERS
from game.formats.bvh import read_bvh
from game.tools.annotate import elan, table
from game.tools.annotate.agreement import agreement
from game.tools.annotate.automatic import Annotator, Example, propose
from game.tools.annotate.desk_repertoire import project_behaviours
from game.tools.annotate.document import Document
from game.tools.annotate.files import open_document, read_document, save
from game.tools.annotate.trial import Score, leave_one_out

__all__ = ["automatic", "checked_takes", "clip_of", "compare", "export", "import_from", "repertoire_of", "trial"]

FOREIGN = (".eaf", ".csv")


def checked_takes(args: argparse.Namespace) -> list[Path]:
    """The BVH files that were named, by themselves or by their annotation. Raises BadInput."""
    if not args.takes:
        raise BadInput("annotate", expected="a take, NAME.bvh", seen="nothing", hint="run_game.py annotate --help")
    for path in args.takes:
        if path.suffix not in {".bvh", ".yaml"}:
            raise BadInput("take", expected="a .bvh or its .yaml", seen=str(path))
    return [path.with_suffix(".bvh") for path in args.takes]


def repertoire_of(args: argparse.Namespace) -> dict[str, Behaviour]:
    """The behaviours spans may carry. Raises a BadInput that also says how many more there are."""
    findings = Findings()
    shipped = ASSETS / "motion" / "behaviours.yaml"
    repertoire = read_repertoire(args.behaviours or project_behaviours(args.takes, shipped), findings)
    findings.raise_first()
    return repertoire


def clip_of(bvh: Path) -> TakeClip:
    """A take's motion on the reference skeleton. Raises BadInput with a hint to retarget."""
    return reference_clip(bvh)


def automatic(args: argparse.Namespace, takes: Sequence[Path]) -> int:
    """Proposals for every take, learnt from the others of the folder."""
    repertoire = repertoire_of(args)
    learnt = _learnt(args.learn, repertoire)
    results = []
    for bvh in takes:
        clip = clip_of(bvh)
        document = open_document(bvh, args.author, clip)
        # Learning a take from itself would only repeat what is already there.
        examples = [e for path, e in learnt if path.resolve() != bvh.with_suffix(".yaml").resolve()]
        proposed = propose(Annotator(examples), document, clip)
        save(proposed, bvh.with_suffix(".yaml"))
        new = [m for m in proposed.marks if m.confidence is not None]
        counts = {layer: sum(m.layer == layer for m in new) for layer in LAYERS}
        sure = round(float(np.mean([m.confidence or 0.0 for m in new] or [0.0])), 3)
        results.append((bvh, counts, sure))
    if args.json:
        rows = [{"take": str(bvh), "proposals": counts, "mean_confidence": sure} for bvh, counts, sure in results]
        print(json.dumps({"learnt_from": len(learnt), "takes": rows}))
    for bvh, counts, sure in results if not args.json else []:
        found = ", ".join(f"{count} {layer}s" for layer, count in counts.items())
        print(f"{bvh}: {found}; mean confidence {sure}; accept or correct them at the desk")
    return 0


def _learnt(folder: Path, repertoire: dict[str, Behaviour]) -> list[tuple[Path, Example]]:
    paths = sorted(p for p in folder.glob("[!.]*.yaml") if p.with_suffix(".bvh").exists()) if folder.is_dir() else []
    if not paths:
        raise BadInput("--learn", expected="a folder of annotated takes (NAME.yaml and NAME.bvh)", seen=str(folder))
    learnt = []
    for path in paths:
        document = read_document(path)
        known = document.with_marks([m for m in document.marks if m.behaviour in repertoire])
        learnt.append((path, Example.of(known, clip_of(path.with_suffix(".bvh")))))
    return learnt


def export(args: argparse.Namespace, takes: Sequence[Path]) -> int:
    """One take's annotation for other programs."""
    bvh = _only(takes)
    document = open_document(bvh, args.author)
    if args.export.suffix == ".eaf":
        elan.write_eaf(document, args.export)
    elif args.export.suffix == ".csv":
        table.write_csv(document, args.export)
    else:
        raise BadInput("--export", expected=" or ".join(FOREIGN), seen=str(args.export))
    print(f"{len(document.marks)} spans -> {args.export}")
    return 0


def import_from(args: argparse.Namespace, takes: Sequence[Path]) -> int:
    """One take's annotation from another program; what stood there before is kept beside as .yaml.before."""
    bvh = _only(takes)
    clip = read_bvh(bvh).clip
    like = Document(take=bvh.stem, bvh=bvh.name, fps=round(1.0 / clip.frame_time_s, 6), frames=len(clip))
    path: Path = args.import_from
    if path.suffix == ".eaf":
        document = elan.read_eaf(path, like)
    elif path.suffix == ".csv":
        document = table.read_csv(path)
    else:
        raise BadInput("--import", expected=" or ".join(FOREIGN), seen=str(path))
    last = max((m.end_s for m in document.marks), default=0.0)
    if last > like.length_s + 0.5 / like.fps:
        raise BadInput(f"{path}", expected=f"spans within the motion's {like.length_s:g} s", seen=f"{last:g} s")
    notes = bvh.with_suffix(".yaml")
    if notes.exists():
        notes.replace(notes.with_suffix(".yaml.before"))
    save(document, notes)
    print(f"{len(document.marks)} spans -> {notes}")
    return 0


def _only(takes: Sequence[Path]) -> Path:
    if len(takes) != 1:
        raise BadInput("annotate", expected="one take", seen=len(takes))
    return takes[0]


def compare(args: argparse.Namespace, takes: Sequence[Path]) -> int:
    """Two annotators of one take. 0 where they agree everywhere, 1 where they differ."""
    first, second = read_document(_only(takes).with_suffix(".yaml")), read_document(args.compare)
    result = agreement(first, second)
    if args.json:
        kappa = {k: None if math.isnan(v) else round(v, 4) for k, v in result.kappa.items()}
        rows = [vars(d) for d in result.differences]
        print(json.dumps({"kappa": kappa, "observed": result.observed, "differences": rows}, ensure_ascii=False))
        return 1 if rows else 0
    for layer in LAYERS:
        print(f"{layer:10} kappa {result.kappa[layer]:6.3f}  equal {100 * result.observed[layer]:5.1f} % of the frames")
    for d in result.differences:
        print(f"{d.start_s:8.2f} to {d.end_s:8.2f} s  {d.layer:10} {d.first or '–'} / {d.second or '–'}")
    return 1 if result.differences else 0


def trial(args: argparse.Namespace) -> int:
    """Each annotated take from all the others."""
    repertoire = repertoire_of(args)
    findings = Findings()
    takes: list[Take] = read_takes(args.learn, repertoire, findings)
    findings.raise_first()
    documents = [read_document(args.learn / f"{take.name}.yaml") for take in takes]
    result, _ = leave_one_out(documents, {take.name: take.clip for take in takes}, repertoire)
    if args.json:
        head = {"kappa": result.kappa, "intensity_error": result.intensity_error, "share_r": result.share_r}
        tables = {
            "layers": {k: _row(v) for k, v in result.layers.items()},
            "behaviours": {k: _row(v) for k, v in result.scores.items()},
        }
        print(json.dumps(head | tables))
        return 0
    for layer in LAYERS:
        print(f"{layer:22} {_line(result.layers[layer])}  kappa {result.kappa[layer]:.3f}")
        for name, score in sorted(result.scores.items(), key=lambda item: -item[1].frames):
            if repertoire[name].layer == layer:
                print(f"  {name:20} {_line(score)}")
    print(f"intensities are off by {result.intensity_error:.3f} on average; shares of time: r = {result.share_r:.3f}")
    return 0


def _row(score: Score) -> dict[str, float | int | None]:
    return {k: None if isinstance(v, float) and math.isnan(v) else v for k, v in vars(score).items()}


def _line(score: Score) -> str:
    return (
        f"precision {score.precision:5.2f}  recall {score.recall:5.2f}  {score.frames:6} frames, "
        f"{100 * score.known:3.0f} % in takes whose others show it"
    )
