"""Annotations as CSV: one row per span or spoken word, tidy, for spreadsheets and statistics programs."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from pathlib import Path

from game.core.emotion_space import EMOTIONS
from game.core.errors import BadInput, Where
from game.embos.findings import Findings
from game.embos.units import LAYERS
from game.formats.files import decode_utf8, read_bytes, write_text
from game.tools.annotate.document import Document, Mark, Word, check_overlaps, on_grid

__all__ = ["COLUMNS", "csv_text", "read_csv", "write_csv"]

COLUMNS = (
    "take", "emotion", "bvh", "author", "version", "fps", "frames", "take_note", "licence",
    "layer", "behaviour", "start_s", "end_s", "start_frame", "end_frame", "stroke_s", "words", "note", "confidence",
)  # fmt: skip
MAX_BYTES = 32_000_000
MAX_ROWS = 200_000
_SPOKEN = "spoken"


def write_csv(document: Document, path: Path) -> None:
    """Write a document as CSV. Raises BadInput."""
    write_text(path, csv_text(document))


def csv_text(document: Document) -> str:
    """The rows of a document; what belongs to the take stands in every row. A take without any span has one row."""
    out = io.StringIO()
    table = csv.writer(out, lineterminator="\n")
    table.writerow(COLUMNS)
    d = document
    head = [d.take, d.emotion, d.bvh, d.author, d.version, repr(d.fps), d.frames, d.note, d.licence]
    rows: list[list[object]] = [
        [
            m.layer, m.behaviour, *_places(d, m),
            "" if m.stroke_s is None else f"{m.stroke_s:.3f}", m.words, m.note,
            "" if m.confidence is None else repr(m.confidence),
        ]
        for m in d.marks
    ]  # fmt: skip
    rows += [[_SPOKEN, "", *_places(d, w), "", w.text, "", ""] for w in d.spoken]
    for row in rows or [[""] * 10]:
        table.writerow([*head, *row])
    return out.getvalue()


def _places(document: Document, what: Mark | Word) -> list[object]:
    frames = [round(t * document.fps) for t in (what.start_s, what.end_s)]
    return [f"{what.start_s:.3f}", f"{what.end_s:.3f}", *frames]


def read_csv(path: Path) -> Document:
    """A document from CSV. Raises a BadInput with the line that holds all that is wrong in its rows."""
    text = decode_utf8(read_bytes(path, max_bytes=MAX_BYTES, what="CSV file"), path)
    document: Document | None = None
    marks: list[Mark] = []
    words: list[Word] = []
    places: dict[Mark, Where] = {}
    findings = Findings()
    rows = csv.reader(io.StringIO(text, newline=""), strict=True)
    try:
        header = next(rows, [])
        if tuple(header) != COLUMNS:
            raise BadInput("CSV header", where=Where(path, 1), expected=",".join(COLUMNS), seen=",".join(header))
        for row in rows:
            where = Where(path, rows.line_num)
            if len(marks) + len(words) + len(findings) > MAX_ROWS:
                raise BadInput("CSV file", where=where, expected=f"at most {MAX_ROWS} rows", seen="more")
            with findings.collect():
                if len(row) != len(COLUMNS):
                    raise BadInput("row", where=where, expected=f"{len(COLUMNS)} columns", seen=len(row))
                cell = dict(zip(COLUMNS, row, strict=True))
                own = _head(cell, where)
                if document is not None and own != document:
                    raise BadInput("row", where=where, expected=f"the take {document.take} as above", seen=own.take)
                document = own
                if cell["layer"] == _SPOKEN:
                    words.append(Word(*_times(cell, where), cell["words"]))
                elif cell["layer"]:
                    marks.append(_mark(cell, where))
                    places[marks[-1]] = where
    except csv.Error as error:
        raise BadInput(f"CSV: {error}", where=Where(path, rows.line_num)) from None
    if document is None:
        findings.raise_first()
        raise BadInput("CSV file", where=Where(path), expected="at least one row", seen="none")
    document = replace(document, spoken=tuple(sorted(words))).with_marks(marks)
    check_overlaps(document, places, findings)
    findings.raise_first()
    return document


def _head(cell: dict[str, str], where: Where) -> Document:
    if cell["emotion"] and cell["emotion"] not in EMOTIONS:
        raise BadInput("emotion", where=where, expected=" | ".join(EMOTIONS), seen=cell["emotion"])
    if Path(cell["bvh"]).name != cell["bvh"]:
        raise BadInput("bvh", where=where, expected="a file name", seen=cell["bvh"])
    return Document(
        take=cell["take"], bvh=cell["bvh"], fps=_number(cell, "fps", where, 1.0, 1000.0),
        frames=int(_number(cell, "frames", where, 1, 1e7)), emotion=cell["emotion"], author=cell["author"],
        version=int(_number(cell, "version", where, 1, 1e6)), note=cell["take_note"], licence=cell["licence"],
    )  # fmt: skip


def _times(cell: dict[str, str], where: Where) -> tuple[float, float]:
    start, end = (on_grid(_number(cell, key, where, 0.0, 1e6)) for key in ("start_s", "end_s"))
    if end <= start:
        raise BadInput("row", where=where, expected=f"an end after the start at {start:g} s", seen=end)
    return start, end


def _mark(cell: dict[str, str], where: Where) -> Mark:
    start, end = _times(cell, where)
    if cell["layer"] not in LAYERS:
        raise BadInput("layer", where=where, expected=" | ".join((*LAYERS, _SPOKEN)), seen=cell["layer"])
    if not cell["behaviour"]:
        raise BadInput("behaviour", where=where, expected="a name", seen="")
    stroke = on_grid(_number(cell, "stroke_s", where, start, end)) if cell["stroke_s"] else None
    sure = _number(cell, "confidence", where, 0.0, 1.0) if cell["confidence"] else None
    return Mark(start, end, cell["layer"], cell["behaviour"], stroke, cell["words"], cell["note"], sure)


def _number(cell: dict[str, str], key: str, where: Where, low: float, high: float) -> float:
    try:
        value = float(cell[key])
    except ValueError:
        value = float("nan")
    if not low <= value <= high:
        raise BadInput(key, where=where, expected=f"a number from {low:g} to {high:g}", seen=cell[key])
    return value
