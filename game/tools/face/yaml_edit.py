"""Changes to the face's YAML that leave every comment and every line in place that they do not concern.

Each change is made in the text, read back by the game's own reader, and only then written, whole or not at all.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.core import BadInput, Where
from game.face import REGIONS, Face, Parts, load_expressions, load_parts, load_weights
from game.formats import Node, parse_yaml
from game.story.surroundings import load_faces
from game.tools.face.fitting import FaceFit, PartFit
from game.tools.yaml_lines import YamlLines, read_source, write_checked

__all__ = [
    "NEW_EXPRESSIONS",
    "add_expression",
    "add_to_dialogue",
    "check_name",
    "with_gaussians",
    "with_weights",
]

NEW_EXPRESSIONS = (
    "# Named expressions for the dialogue (`face: smirk`): one part per region.\nversion: 1\nexpressions:\n"
)
_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")


def _number(value: float) -> str:
    return f"{value + 0.0:.4f}".rstrip("0").rstrip(".") if abs(value) >= 5e-5 else "0.0"


def _pair(values: NDArray[np.float64]) -> str:
    return f"[{_number(float(values[0]))}, {_number(float(values[1]))}]"


def with_gaussians(path: Path, fit: FaceFit) -> str:
    """The text of parts.yaml with the rated parts' Gaussians, and who rated. Affinities stay the designers'."""
    lines = YamlLines(read_source(path), path)
    lines.replace(lines.root["ratings"], '"' + fit.label.replace('"', "'") + '"')
    for part in fit.parts:
        _put_gaussian(lines, lines.root["parts"][part.region][part.part], part)
    return lines.text()


def _put_gaussian(lines: YamlLines, body: Node, part: PartFit) -> None:
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
    lines = YamlLines(read_source(path), path)
    table = lines.root["weights"]
    for i, region in enumerate(REGIONS):
        for j, axis in enumerate(("valence", "arousal")):
            entry = table[region][axis]
            lines.replace(entry["value"], _number(float(fit.weights[i, j])))
            lines.replace(entry["source"], "fitted")
    return lines.text()


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
