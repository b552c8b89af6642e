"""Changes to the face's YAML that leave every comment and every line in place that they do not concern.

Each change is made in the text, read back by the game's own reader, and only then written, whole or not at all.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.core import BadInput, Where
from game.face import REGIONS, Face, Parts, load_expressions, load_parts, load_weights
from game.formats import Node, parse_yaml
from game.formats.files import decode_utf8, read_bytes, write_text
from game.story.surroundings import load_faces
from game.tools.face.fitting import FaceFit, PartFit

__all__ = [
    "NEW_EXPRESSIONS",
    "add_expression",
    "add_to_dialogue",
    "check_name",
    "check_text",
    "with_gaussians",
    "with_weights",
    "write_checked",
]

MAX_BYTES = 2_000_000
NEW_EXPRESSIONS = (
    "# Named expressions for the dialogue (`face: smirk`): one part per region.\nversion: 1\nexpressions:\n"
)
_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")
_MARK = re.compile(r"\s*# rated by \d+$")


def read_source(path: Path) -> str:
    """A YAML file's text."""
    return decode_utf8(read_bytes(path, max_bytes=MAX_BYTES, what="YAML file"), path)


class _Lines:
    """A text as lines, with edits at the places that its nodes name (1-based lines and columns)."""

    def __init__(self, text: str, path: Path) -> None:
        self.lines = text.splitlines()
        self.root = parse_yaml(text, path)
        self._edits: list[tuple[int, int, str, Callable[[str], str]]] = []

    def replace(self, node: Node, text: str, mark: str = "") -> None:
        """Put ``text`` in a value's place: a scalar, or a list in brackets on one line. ``mark`` comments the line."""
        line, col = node.where.line or 1, node.where.col or 1

        def change(row: str) -> str:
            before, after = row[: col - 1], row[col - 1 :]
            if node.kind == "sequence":
                if not after.startswith("[") or "]" not in after:
                    raise BadInput(where=node.where, expected="a list in brackets on one line", seen=after)
                rest = after[after.index("]") + 1 :]
            else:
                quoted = re.match(r"\"[^\"]*\"|'[^']*'", after)
                rest = after[quoted.end() :] if quoted else after[len(node.raw) :]
            if mark and (not rest.strip() or _MARK.fullmatch(rest)):
                rest = f"  {mark}"
            return before + text + rest

        self._edits.append((line, col, "", change))

    def insert_after(self, node: Node, key: str, value: str) -> None:
        """A new key behind the value of ``node`` in the same mapping, in the mapping's own style."""
        line, col = node.where.line or 1, node.where.col or 1

        def change(row: str) -> str:
            before = row[: col - 1]
            own_line = re.fullmatch(r"(\s*)[\w]+:\s*", before)
            if own_line:
                return f"{row}\n{own_line[1]}{key}: {value}"
            end = row.index("]", col - 1) + 1
            return f"{row[:end]}, {key}: {value}{row[end:]}"

        self._edits.append((line, col, key, change))

    def text(self) -> str:
        """The text with all edits made, the last place first so that columns stay true."""
        # At one place, the insertion behind a value comes before the value itself changes length.
        for line, _, _, change in sorted(self._edits, key=lambda e: (e[0], e[1], e[2]), reverse=True):
            self.lines[line - 1] = change(self.lines[line - 1])
        return "\n".join(self.lines) + "\n"


def _number(value: float) -> str:
    return f"{value + 0.0:.4f}".rstrip("0").rstrip(".") if abs(value) >= 5e-5 else "0.0"


def _pair(values: NDArray[np.float64]) -> str:
    return f"[{_number(float(values[0]))}, {_number(float(values[1]))}]"


def with_gaussians(path: Path, fit: FaceFit) -> str:
    """The text of parts.yaml with the rated parts' Gaussians, and who rated. Affinities stay the designers'."""
    lines = _Lines(read_source(path), path)
    lines.replace(lines.root["ratings"], '"' + fit.label.replace('"', "'") + '"')
    for part in fit.parts:
        _put_gaussian(lines, lines.root["parts"][part.region][part.part], part)
    return lines.text()


def _put_gaussian(lines: _Lines, body: Node, part: PartFit) -> None:
    deviation = np.sqrt(np.diag(part.covariance))
    together = float(part.covariance[0, 1] / (deviation[0] * deviation[1]))
    lines.replace(body["mean"], _pair(part.mean), f"# rated by {part.ratings}")
    present = body.get("correlation")
    if present is not None:
        lines.replace(present, _number(together))
    elif abs(together) >= 5e-5:
        lines.insert_after(body["deviation"], "correlation", _number(together))
    lines.replace(body["deviation"], _pair(deviation))


def with_weights(path: Path, fit: FaceFit) -> str:
    """The text of weights.yaml with fitted weights. Raises BadInput where too few whole faces were rated."""
    if fit.weights is None:
        raise BadInput("weights", expected="enough rated whole faces", seen="; ".join(fit.lacking))
    lines = _Lines(read_source(path), path)
    table = lines.root["weights"]
    for i, region in enumerate(REGIONS):
        for j, axis in enumerate(("valence", "arousal")):
            entry = table[region][axis]
            lines.replace(entry["value"], _number(float(fit.weights[i, j])))
            lines.replace(entry["source"], "fitted")
    return lines.text()


def check_text(path: Path, text: str, check: Callable[[Path], object]) -> None:
    """Raise the BadInput of ``check`` where it cannot read a text that is to be written to ``path``."""
    if not path.resolve().parent.is_dir() or path.is_dir():
        raise BadInput(where=Where(path), expected="a file name in a folder that exists", seen="none such")
    with tempfile.TemporaryDirectory() as folder:
        trial = Path(folder) / path.name
        write_text(trial, text)
        try:
            check(trial)
        except BadInput as error:
            raise BadInput(str(error).replace(str(trial), f"what would be in {path.name}")) from None


def write_checked(path: Path, text: str, check: Callable[[Path], object]) -> None:
    """Write a text that ``check`` can read, or raise its BadInput and leave the file as it was."""
    check_text(path, text, check)
    write_text(path, text)


def check_parts(path: Path) -> object:
    """Read parts as the game does."""
    return load_parts(path)


def check_weights(path: Path) -> object:
    """Read weights as the game does."""
    return load_weights(path)


def check_name(name: str, taken: Sequence[str], where: Where | None = None) -> str:
    """A name a dialogue can use, not yet taken. Raises BadInput."""
    if not _NAME.fullmatch(name):
        expected = "a name of small letters, digits and _ that begins with a letter, at most 40"
        raise BadInput("expression", where=where, expected=expected, seen=name)
    if name in taken:
        raise BadInput("expression", where=where, expected="a name that is free", seen=name)
    return name


def add_expression(
    path: Path, name: str, label: str, face: Face, parts: Parts, change: Sequence[tuple[str, float]] = ()
) -> None:
    """Append a named expression behind the others; a missing file is begun. change: numbers that differ from the
    parts'. Raises BadInput, the file as it was."""
    text = read_source(path) if path.exists() else NEW_EXPRESSIONS
    if not text.endswith("\n"):
        text += "\n"
    taken: list[str] = []
    if path.exists():
        listed = parse_yaml(text, path).get("expressions")
        taken = [key.raw for key in listed.keys()] if listed is not None else []  # noqa: SIM118 - Node iterates values
    check_name(name, taken, Where(path))
    shown = " ".join(label.replace('"', "'").replace("\\", "/").split())[:60] or name
    rows = [f"  {name}:", f'    label: {{en: "{shown}"}}']
    rows += [f"    {region}: {part}" for region, part in zip(REGIONS, face.parts, strict=True)]
    if change:
        rows.append(f"    change: {{{', '.join(f'{field}: {value:.10g}' for field, value in change)}}}")
    lines = text.splitlines()
    place = _end_of_block(lines, "expressions", path)
    merged = "\n".join([*lines[:place], *rows, *lines[place:]]) + "\n"
    write_checked(path, merged, lambda trial: load_expressions(trial, parts))


def add_to_dialogue(path: Path, name: str) -> None:
    """List a name among the faces that dialogue lines may ask for, with no nudge on what is shown. A name that is
    listed stays as it is. Raises BadInput, the file as it was."""
    if name in load_faces(path):
        return
    lines = read_source(path).splitlines()
    place = _end_of_block(lines, "faces", path)
    merged = "\n".join([*lines[:place], f"  {name}: {{}}", *lines[place:]]) + "\n"
    write_checked(path, merged, load_faces)


def _end_of_block(lines: list[str], key: str, path: Path) -> int:
    """Number of the line behind the last entry of a block at the left edge."""
    start = next((i for i, row in enumerate(lines) if re.fullmatch(rf"{key}:\s*(#.*)?", row)), None)
    if start is None:
        raise BadInput(where=Where(path), expected=f"a block '{key}:' at the left edge", seen="none")
    end = start + 1
    for i in range(start + 1, len(lines)):
        if lines[i].strip() and not lines[i].lstrip().startswith("#"):
            if not lines[i].startswith(" "):
                break
            end = i + 1
    return end
