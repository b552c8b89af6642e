"""``face suggest``: the best faces for an emotion, as a table, as JSON, as a sheet on the real head."""

from __future__ import annotations

import argparse
import json
from typing import Any

import numpy as np

from game.app.pictures import write_png
from game.core import BadInput, parse_emotion
from game.face import load_face
from game.tools.face.sheet import SheetRow, draw_rows, draw_sheet, part_names
from game.tools.face.wanted import COHERENCE, Found, Proposer, Wanted, parse_spread, points_around

__all__ = ["suggest"]

MAX_PROPOSALS = 200
MAX_ON_SHEET = 60


def _wanted(args: argparse.Namespace, places: Any) -> list[Wanted]:
    given = [args.valence is not None or args.arousal is not None, args.emotion is not None, args.around is not None]
    if sum(given) != 1:
        expected = "one of --valence with --arousal, --emotion, --around"
        raise BadInput("suggest", expected=expected, seen="several" if any(given) else "none")
    if args.around is not None:
        return points_around(args.around)
    if args.emotion is not None:
        if args.spread:
            raise BadInput("--spread", expected="--valence and --arousal beside it", seen="--emotion")
        emotion = parse_emotion(args.emotion)
        v, a = emotion @ places / max(float(emotion.sum()), 1.0)
        return [Wanted((float(v), float(a)), emotion=emotion)]
    if args.valence is None or args.arousal is None:
        raise BadInput("suggest", expected="both --valence and --arousal", seen="one of them")
    return [Wanted((args.valence, args.arousal), parse_spread(args.spread) if args.spread else None)]


def suggest(args: argparse.Namespace) -> int:
    """Print the best faces, and draw them where asked to."""
    if not 1 <= args.top <= MAX_PROPOSALS:
        raise BadInput("--top", expected=f"1 to {MAX_PROPOSALS}", seen=args.top)
    if args.sheet is not None and args.top > MAX_ON_SHEET:
        raise BadInput("--top", expected=f"at most {MAX_ON_SHEET} on a sheet", seen=args.top)
    coherence = COHERENCE if args.coherence is None else args.coherence
    if not 0.0 <= coherence <= 100.0:
        raise BadInput("--coherence", expected="0 to 100", seen=coherence)
    asset = load_face(args.face_folder)
    parts = asset.model.parts
    proposer = Proposer(asset.search)
    rows = [
        SheetRow(w, proposer.find(w, args.top, diverse=args.diverse, coherence=coherence))
        for w in _wanted(args, parts.places)
    ]
    if args.sheet is not None:
        _draw(args, rows, parts)
    if args.json:
        shown = [{"wanted": _wanted_json(row.wanted), "faces": [_found_json(f) for f in row.found]} for row in rows]
        print(json.dumps({"ratings": parts.ratings, "proposals": shown}, ensure_ascii=False, indent=2))
        return 0
    print(f"{len(asset.search)} faces; parts: {parts.ratings}")
    for row in rows:
        print(f"\n{row.wanted}")
        print(" rank  valence  arousal   log p    score  face")
        for rank, f in enumerate(row.found, 1):
            v, a = f.proposal.mean
            name = " + ".join(part_names(parts, f.face))
            print(f"{rank:5d}  {v:+7.2f}  {a:+7.2f}  {f.log_density:+6.2f}  {f.proposal.score:+7.2f}  {name}")
    return 0


def _draw(args: argparse.Namespace, rows: list[SheetRow], parts: Any) -> None:
    from game.tools.face.heads import HeadStudio

    studio = HeadStudio(464 if len(rows) == 1 else 304)
    try:
        if len(rows) > 1:
            title = f"The best {args.top} faces for eight points around the circle (parts: {parts.ratings})"
            picture = draw_rows(studio, parts, rows, title=title)
        else:
            picture = draw_sheet(studio, parts, rows[0], source=parts.ratings)
    finally:
        studio.close()
    write_png(args.sheet, picture)


def _wanted_json(wanted: Wanted) -> dict[str, Any]:
    return {
        "valence": wanted.point[0],
        "arousal": wanted.point[1],
        "covariance": None if wanted.spread is None else wanted.spread.tolist(),
        "emotion": None if wanted.emotion is None else wanted.emotion.tolist(),
    }


def _found_json(found: Found) -> dict[str, Any]:
    face, p = found.face, found.proposal
    return {
        "eyes": face.eyes,
        "eyebrows": face.eyebrows,
        "mouth": face.mouth,
        "skin": face.skin,
        "mean": np.round(p.mean, 6).tolist(),
        "covariance": np.round(p.covariance, 6).tolist(),
        "log_density": round(found.log_density, 6),
        "score": round(p.score, 6),
    }
