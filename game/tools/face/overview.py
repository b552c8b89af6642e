"""``face sheet``: the seven emotions at two strengths as the game shows them, every part, every named expression."""

from __future__ import annotations

import argparse

from game.app.pictures import write_png
from game.app.ui import FEELING_COLOURS
from game.core import EMOTIONS, emotion_vector
from game.face import FaceAsset, load_face
from game.tools.face.heads import HeadStudio
from game.tools.face.sheet import SheetCell, draw_grid, part_names
from game.tools.face.sitting import single_part_faces

__all__ = ["overview"]

STRENGTHS = (0.45, 1.0)
PARTS_A_ROW = 14
PARTS_WIDTH = 2100


def seven(asset: FaceAsset) -> list[list[SheetCell]]:
    """The face that the game picks for each of the seven, weak above strong."""
    parts, rows = asset.model.parts, []
    for strength in STRENGTHS:
        row = []
        for name in EMOTIONS:
            values = emotion_vector({} if name == "neutral" else {name: strength})
            numbers = asset.search.numbers(asset.search.best(asset.search.score_emotion(values)))
            note = " · ".join(part_names(parts, parts.face(numbers)))
            shown = parts.params(numbers, float(values[:6].sum()))
            title = name if name == "neutral" else f"{name} {strength:g}"
            row.append(SheetCell(shown, title, note, FEELING_COLOURS[name]))
        rows.append(row)
    return rows


def every_part(asset: FaceAsset) -> list[list[SheetCell]]:
    """The standard face wearing one part after the other, a new row for every region."""
    parts = asset.model.parts
    faces = single_part_faces(parts)
    cells: list[list[SheetCell]] = []
    for region in parts.regions:
        worn = [f for f in faces if getattr(f, region.name) != "standard"]
        row = []
        for face in worn:
            i = region.index(getattr(face, region.name))
            mean, params = region.mean[i], parts.params(parts.numbers(face))
            row.append(SheetCell(params, f"{region.names[i]}", f"{region.name} {mean[0]:+.2f} {mean[1]:+.2f}"))
        cells += [row[k : k + PARTS_A_ROW] for k in range(0, len(row), PARTS_A_ROW)]
    return cells


def named(asset: FaceAsset) -> list[list[SheetCell]]:
    """Every named expression."""
    cells = [
        SheetCell(e.params, name, " · ".join(part_names(asset.model.parts, e.face)))
        for name, e in asset.expressions.items()
    ]
    return [cells[k : k + 6] for k in range(0, len(cells), 6)]


def overview(args: argparse.Namespace) -> int:
    """Draw one of the three."""
    asset = load_face(args.face_folder)
    draw, title = {
        "seven": (seven, "Seven emotions, weak and strong"),
        "parts": (every_part, "Every part on the standard face"),
        "expressions": (named, "Named expressions"),
    }[args.of]
    studio = HeadStudio(400)
    try:
        title = f"{title} (parts: {asset.model.parts.ratings})"
        width = PARTS_WIDTH if args.of == "parts" else 1280
        picture = draw_grid(studio, asset.model.parts, draw(asset), title=title, width=width)
    finally:
        studio.close()
    write_png(args.out, picture)
    return 0
