"""Shader files with includes: one text per stage, ``#line`` around every include, errors mapped back to file:line.

Three directives beyond GLSL, each alone on its line:

- ``#include "light.glsl"`` – the file's text, once per stage;
- ``#needs TAPS KIND_FACE`` – names the program must be given; each becomes a ``#define``.

A missing file, a missing define or a define that no file asks for is an error (ShaderError), never a silent default.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

from game.core.errors import GameError

__all__ = ["SHADER_FOLDER", "ShaderError", "ShaderSource", "explain_log", "load_stage"]

SHADER_FOLDER = Path(__file__).parent / "shaders"

_INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"\s*$')
_NEEDS = re.compile(r"^\s*#needs\s+(.+?)\s*$")
# Mesa "0:20014(7): error: …", NVIDIA "0(20014) : error C1008: …", Apple/AMD/Intel "ERROR: 0:20014: …"
_LOG_LINE = re.compile(r"^(?:ERROR:\s*|WARNING:\s*)?\d+(?::(\d+)(?:\(\d+\))?|\((\d+)\))\s*:?\s*(.*)$")
# A file's number times this is added to its line numbers: drivers lose GLSL's own source string numbers in part.
_FILE_STEP = 10_000


class ShaderError(GameError):
    """A shader file that cannot be assembled or compiled; the message is one line and starts with file:line."""


@dataclass
class ShaderSource:
    """The assembled text of one stage and the files behind its ``#line`` numbers."""

    text: str
    files: list[str] = field(default_factory=list)  # number -> name, shared by the stages of one program
    used: set[str] = field(default_factory=set)  # defines asked for by any file


def load_stage(
    name: str,
    defines: Mapping[str, str | int | float],
    files: list[str],
    *,
    version: int = 330,
    folder: Path = SHADER_FOLDER,
) -> ShaderSource:
    """Assemble the stage in file ``name``.

    ``files`` collects the file names; hand the same list to all stages of a program so that numbers stay unique.
    Raises ShaderError for missing files and defines.
    """
    source = ShaderSource("", files)
    lines = [f"#version {version} core"]
    _append(name, defines, lines, source, folder, set(), came_from=None)
    source.text = "\n".join(lines) + "\n"
    return source


def _append(
    name: str,
    defines: Mapping[str, str | int | float],
    lines: list[str],
    source: ShaderSource,
    folder: Path,
    seen: set[str],
    came_from: str | None,
) -> None:
    seen.add(name)
    text = _read(folder / name)
    if text is None:
        raise ShaderError(f"{came_from or name}: no shader file {name} in {folder.name}/")
    number = len(source.files)
    source.files.append(name)
    lines.append(f"#line {number * _FILE_STEP + 1}")
    for row, line in enumerate(text.splitlines(), start=1):
        include, needs = (_INCLUDE.match(line), _NEEDS.match(line)) if "#" in line else (None, None)
        if include:
            if include[1] not in seen:
                _append(include[1], defines, lines, source, folder, seen, came_from=f"{name}:{row}")
            lines.append(f"#line {number * _FILE_STEP + row + 1}")
        elif needs:
            for define in needs[1].split():
                if define not in defines:
                    raise ShaderError(f"{name}:{row}: needs the define {define}, which the program was not given")
                if define not in source.used:
                    lines.append(f"#define {define} {defines[define]}")
                source.used.add(define)
            lines.append(f"#line {number * _FILE_STEP + row + 1}")
        else:
            lines.append(line)


@lru_cache(maxsize=256)
def _read(path: Path) -> str | None:
    """A file's text, None where there is none; the same few files are included by every program."""
    return path.read_text(encoding="utf-8") if path.is_file() else None


def explain_log(log: str, files: list[str]) -> str:
    """The compiler's messages with file numbers replaced by names, joined to one line; the first message leads."""
    messages = []
    for line in log.splitlines():
        match = _LOG_LINE.match(line.strip())
        number, row = divmod(int(match[1] or match[2]), _FILE_STEP) if match else (len(files), 0)
        if match and number < len(files):
            messages.append(f"{files[number]}:{row}: {match[3]}")
    return "; ".join(messages[:4]) if messages else " ".join(log.split())
