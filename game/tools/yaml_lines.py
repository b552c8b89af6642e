"""Changes to YAML files that leave every comment and every line in place that they do not concern.

Each change is made in the text, read back by the game's own reader, and only then written, whole or not at all.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable
from pathlib import Path

from game.core import BadInput, Where
from game.formats import Node, parse_yaml
from game.formats.files import decode_utf8, read_bytes, write_text

__all__ = ["YamlLines", "check_text", "read_source", "write_checked"]

MAX_BYTES = 2_000_000
_MARK = re.compile(r"\s*# rated by \d+$")


def read_source(path: Path) -> str:
    """A YAML file's text."""
    return decode_utf8(read_bytes(path, max_bytes=MAX_BYTES, what="YAML file"), path)


class YamlLines:
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
