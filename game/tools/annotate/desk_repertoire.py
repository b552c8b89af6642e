"""The repertoire as the desk uses it: searching behaviours, and changing what they use and lock, in the file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from game.core.errors import BadInput, Where
from game.core.humanoid import BODY_PARTS
from game.embos.findings import Findings
from game.embos.repertoire import Behaviour, read_repertoire
from game.tools.yaml_lines import YamlLines, read_source, write_checked

__all__ = ["add_behaviour", "behaviours_of", "next_state", "project_behaviours", "put_parts"]

_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")


def behaviours_of(repertoire: Mapping[str, Behaviour], layer: str, search: str = "") -> list[Behaviour]:
    """A layer's behaviours whose name or label holds every word of the search."""
    words = search.lower().split()
    found = []
    for behaviour in repertoire.values():
        text = " ".join([behaviour.name.replace("_", " "), behaviour.name, *behaviour.label.values()]).lower()
        if behaviour.layer == layer and all(word in text for word in words):
            found.append(behaviour)
    return found


def project_behaviours(takes: Iterable[Path], shipped: Path) -> Path:
    """behaviours.yaml in or beside the takes' folder, else the shipped one."""
    for take in takes:
        folder = take.resolve().parent
        for path in (folder / "behaviours.yaml", folder.parent / "behaviours.yaml"):
            if path.is_file():
                return path
    return shipped


def next_state(behaviour: Behaviour, part: str) -> tuple[frozenset[str], frozenset[str]]:
    """uses and locks after a click on a body part: free, used, locked, free."""
    if part in behaviour.uses:
        return behaviour.uses - {part}, behaviour.locks | {part}
    if part in behaviour.locks:
        return behaviour.uses, behaviour.locks - {part}
    return behaviour.uses | {part}, behaviour.locks


def put_parts(path: Path, name: str, uses: frozenset[str], locks: frozenset[str]) -> dict[str, Behaviour]:
    """Change what a behaviour uses and locks in its file -> the repertoire as it reads now. Raises BadInput, the file
    as it was; all comments stay."""
    lines = YamlLines(read_source(path), path)
    body = lines.root["behaviours"][name]
    for key, parts in (("uses", uses), ("locks", locks)):
        node = body.get(key)
        if node is None:
            raise BadInput(name, where=body.where, expected=f"{key}: [] in its line", seen="nothing")
        lines.replace(node, f"[{', '.join(part for part in BODY_PARTS if part in parts)}]")
    write_checked(path, lines.text(), _read)
    return _read(path)


def add_behaviour(path: Path, name: str, layer: str) -> dict[str, Behaviour]:
    """A new behaviour at the end of the file -> the repertoire. Raises BadInput, the file as it was."""
    known = _read(path)
    if not _NAME.fullmatch(name):
        raise BadInput("behaviour", expected="small letters, digits and _, beginning with a letter", seen=name)
    if name in known:
        raise BadInput("behaviour", where=Where(path), expected="a name that is free", seen=name)
    text = read_source(path).rstrip("\n")
    row = f"  {name}: {{layer: {layer}, label: {{en: {name.replace('_', ' ')}}}, uses: [], locks: [], contacts: {{}}}}"
    write_checked(path, f"{text}\n{row}\n", _read)
    return _read(path)


def _read(path: Path) -> dict[str, Behaviour]:
    findings = Findings()
    repertoire = read_repertoire(path, findings)
    findings.raise_first()
    return repertoire
