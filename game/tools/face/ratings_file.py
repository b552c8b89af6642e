"""Ratings as CSV: rater, face, valence, arousal, name, time. One row per rating, on the disk before the next face.

``face`` names four parts, ``eyes+eyebrows+mouth+skin``, or one expression of a foreign avatar. A rater who rates
a face twice means the later rating.
"""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from game.core import EMOTIONS, BadInput, Where
from game.face import REGIONS, Face, Parts
from game.formats import nearest
from game.formats.files import decode_utf8, read_bytes

__all__ = ["COLUMNS", "Known", "Rating", "RatingLog", "check_rater", "face_code", "parse_face", "read_ratings"]

COLUMNS = ("rater", "face", "valence", "arousal", "name", "time")
MAX_BYTES = 64_000_000
MAX_NAME = 64

Known = Parts | tuple[str, ...]
"""What can be rated: faces made of parts, or the named expressions of an avatar."""


@dataclass(frozen=True)
class Rating:
    """face: drawn, or the name of an avatar's expression; valence, arousal in −1..1; name: one of the seven emotions or
    empty; time: ISO 8601, UTC; line: in its file."""

    rater: str
    face: Face | str
    valence: float
    arousal: float
    name: str = ""
    time: str = ""
    line: int = 0


def face_code(face: Face | str) -> str:
    """``eyes+eyebrows+mouth+skin``, or the expression's name."""
    return face if isinstance(face, str) else "+".join(face.parts)


def parse_expression(text: str, known: Sequence[str], where: Where | None = None) -> str:
    """An avatar's expression by its name. Raises BadInput for an unknown one, offering the nearest."""
    if text not in known:
        near = nearest(text, known)
        hint = f"did you mean {near!r}?" if near else None
        raise BadInput("expression", where=where, expected="one of the avatar's expressions", seen=text, hint=hint)
    return text


def parse_face(text: str, parts: Parts, where: Where | None = None) -> Face:
    """The face of a code. Raises BadInput for unknown parts, offering the nearest."""
    names = text.split("+")
    if len(names) != len(REGIONS):
        raise BadInput("face", where=where, expected="eyes+eyebrows+mouth+skin", seen=text)
    for region, name in zip(parts.regions, names, strict=True):
        if name not in region.names:
            near = nearest(name, region.names)
            raise BadInput(
                f"unknown part of {region.name}",
                where=where,
                expected=" | ".join(region.names),
                seen=name,
                hint=f"did you mean {near!r}?" if near else None,
            )
    return Face(*names)


def check_rater(name: str, where: Where | None = None) -> str:
    """A rater's name that a file can carry. Raises BadInput for an empty, long or unprintable one."""
    if not name.strip() or len(name) > MAX_NAME or not name.isprintable():
        raise BadInput("rater", where=where, expected=f"a printable name of 1 to {MAX_NAME} characters", seen=name)
    return name.strip()


def _number(text: str, column: str, where: Where) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not -1.0 <= value <= 1.0:
        raise BadInput(column, where=where, expected="a number from -1 to 1", seen=text)
    return value


def _rating(row: list[str], parts: Known, where: Where, line: int) -> Rating:
    if len(row) != len(COLUMNS):
        raise BadInput(where=where, expected=f"{len(COLUMNS)} columns ({','.join(COLUMNS)})", seen=len(row))
    rater, code, valence, arousal, name, time = row
    if name and name not in EMOTIONS:
        raise BadInput("name", where=where, expected=" | ".join(EMOTIONS) + " | nothing", seen=name)
    return Rating(
        check_rater(rater, where),
        parse_face(code, parts, where) if isinstance(parts, Parts) else parse_expression(code, parts, where),
        _number(valence, "valence", where),
        _number(arousal, "arousal", where),
        name,
        time,
        line,
    )


def read_ratings(path: Path, parts: Known) -> list[Rating]:
    """All ratings of a file that count, in its order. Raises BadInput with file:line for the first wrong row."""
    return _parse(decode_utf8(read_bytes(path, max_bytes=MAX_BYTES, what="ratings file"), path), path, parts)


def _parse(text: str, path: Path, parts: Known) -> list[Rating]:
    if "\0" in text:
        raise BadInput(where=Where(path), expected="text", seen="a NUL byte")
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    latest: dict[tuple[str, Face | str], Rating] = {}
    started = False
    try:
        for row in reader:
            where = Where(path, reader.line_num)
            if not started:
                if tuple(row) != COLUMNS:
                    raise BadInput("heading", where=where, expected=",".join(COLUMNS), seen=",".join(row))
                started = True
            elif row:
                rating = _rating(row, parts, where, reader.line_num)
                latest[rating.rater, rating.face] = rating
    except csv.Error as error:
        raise BadInput(f"not CSV: {error}", where=Where(path, reader.line_num)) from None
    if not started:
        raise BadInput(where=Where(path, 1), expected=f"the heading {','.join(COLUMNS)}", seen="an empty file")
    return list(latest.values())


def format_row(values: tuple[str, ...]) -> str:
    """One line of CSV."""
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerow(values)
    return out.getvalue()


def format_rating(r: Rating) -> str:
    """A rating as one line of CSV."""
    return format_row((r.rater, face_code(r.face), f"{r.valence:.4f}", f"{r.arousal:.4f}", r.name, r.time))


class RatingLog:
    """Appends ratings to a file; each is on the disk when ``append`` returns.

    Opening checks the whole file and repairs one thing: a last row cut off by a power loss, which nobody confirmed.
    """

    def __init__(self, path: Path, parts: Known) -> None:
        self.path = path
        self.ratings: list[Rating] = []
        self._written: list[tuple[int, int]] = []  # where each row of this sitting starts and ends
        if path.is_dir() or not path.resolve().parent.is_dir():
            raise BadInput(where=Where(path), expected="a file name in a folder that exists", seen="none such")
        keep = None
        if path.exists() and path.stat().st_size:
            data = read_bytes(path, max_bytes=MAX_BYTES, what="ratings file")
            text = decode_utf8(data, path)
            if not data.endswith(b"\n"):
                # The last row was never finished; everything before it stands.
                keep = data.rfind(b"\n") + 1
                text = decode_utf8(data[:keep], path)
            if text:
                self.ratings = _parse(text, path, parts)
        if keep is not None:
            self._cut(keep)
        if not path.exists() or path.stat().st_size == 0:
            self._write(format_row(COLUMNS))

    def _write(self, text: str) -> tuple[int, int]:
        before = self.path.stat().st_size if self.path.exists() else 0
        try:
            with self.path.open("ab") as file:
                start = file.seek(0, os.SEEK_END)
                file.write(text.encode("utf-8"))
                file.flush()
                os.fsync(file.fileno())
                return start, file.tell()
        except OSError as error:
            if self.path.exists() and self.path.stat().st_size > before:
                self._cut(before)  # half a row on a full disk
            raise BadInput(where=Where(self.path), expected="a file that can be written", seen=error.strerror) from None

    def _cut(self, length: int) -> None:
        try:
            with self.path.open("r+b") as file:
                file.truncate(length)
                os.fsync(file.fileno())
        except OSError as error:
            raise BadInput(where=Where(self.path), expected="a file that can be written", seen=error.strerror) from None

    def append(self, rating: Rating) -> None:
        """Write one rating and wait until the disk has it. Raises BadInput where that is impossible."""
        self._written.append(self._write(format_rating(rating)))
        self.ratings.append(rating)

    def withdraw(self) -> Rating | None:
        """Take back the last rating of this sitting; None where there is none, or somebody wrote after it."""
        if not self._written:
            return None
        start, end = self._written[-1]
        if not self.path.exists() or self.path.stat().st_size != end:
            return None
        self._cut(start)
        self._written.pop()
        return self.ratings.pop()
