"""All findings of dialogue files at once: stalls, shopkeepers, rules and faces."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable
from pathlib import Path

from game.core.errors import BadInput, Where
from game.formats.files import decode_utf8, read_bytes
from game.formats.yaml_source import load_yaml
from game.story.acts import acts_from
from game.story.findings import Finding, Findings
from game.story.grammar import PART
from game.story.model import Script
from game.story.quality import check_quality
from game.story.reader import is_stall, read_script
from game.story.source import Source
from game.story.surroundings import load_faces, load_person
from game.story.translations import read_lock
from game.story.walks import walk_script

__all__ = ["dialogue_files", "lint_files", "lint_text"]

_MAX_BYTES = 2_000_000
# A part stands beside its stalls or in a folder below them.
_STALLS_ABOVE = 3


def dialogue_files(paths: Iterable[Path]) -> list[Path]:
    """The YAML files at and below some paths, each once. Raises BadInput for a path that does not exist."""
    out: dict[Path, None] = {}
    for path in paths:
        if path.is_dir():
            out.update(dict.fromkeys(sorted(path.rglob("*.yaml"))))
        elif path.is_file():
            out[path] = None
        else:
            raise BadInput("no such file or folder", where=Where(path))
    return list(out)


def lint_files(paths: Iterable[Path], purse: int | None = None, *, walks: int = 0, seed: int = 1) -> list[Finding]:
    """Findings of all dialogue files at and below some paths, by file and place.

    purse: what the player can spend in an afternoon, to find what nobody can buy. walks: so many random talks, by
    ``seed``, are played through each stall without errors.
    """
    findings = Findings()
    parts: list[tuple[Path, str]] = []
    for path in dialogue_files(paths):
        try:
            text = _text(path)
        except BadInput as error:
            findings.take("E_YAML", error)
            continue
        if _kind(text) == "part":
            parts.append((path, text))
        else:
            script = lint_text(path, text, findings, purse)
            faulty = {finding.where.path for finding in findings.errors}
            if walks > 0 and script is not None and not faulty & {*script.files}:
                walk_script(script, findings, walks, seed)
    known = {path.resolve() for path in findings.files}
    for path, text in parts:
        if path.resolve() not in known:
            _lint_part(path, text, findings)
    return findings.ordered()


def _text(path: Path) -> str:
    return decode_utf8(read_bytes(path, max_bytes=_MAX_BYTES, what="YAML file"), path)


def _kind(text: str) -> str:
    """What a file is, told by the keys that begin its rows."""
    keys = {row.partition(":")[0] for row in text.split("\n") if row[:1].isalpha()}
    for key, kind in (("stall", "stall"), ("part", "part"), ("nodes", "stall")):
        if key in keys:
            return kind
    return next((key for key in ("person", "faces", "acts", "locked") if key in keys), "stall")


def _lint_part(path: Path, text: str, findings: Findings) -> None:
    """A part by itself: its findings are those of the stalls that include it."""
    found = False
    for folder in path.absolute().parents[:_STALLS_ABOVE]:
        for stall in sorted(folder.glob("*.yaml")):
            of_stall = Findings()
            # A neighbour that cannot be read is no stall that includes it, and nobody asked about it.
            with contextlib.suppress(BadInput):
                if is_stall(stall) and "include" in (whole := _text(stall)):
                    lint_text(stall, whole, of_stall)
            if any(file.resolve() == path.resolve() for file in of_stall.files):
                found = True
                for finding in of_stall.all:
                    if Path(finding.where.path).resolve() == path.resolve():
                        where = Where(path, finding.where.line, finding.where.col)
                        findings.add(finding.code, where, finding.message, finding.hint)
    if not found:
        source = Source(path, text, findings)
        if source.root is not None:
            source.mapping(source.root, PART)
            findings.add("I_NOT_INCLUDED", source.root.where, "no stall includes this part; its lines are not checked")


def lint_text(path: Path, text: str, findings: Findings, purse: int | None = None) -> Script | None:
    """Check one file's text; ``path`` tells which kind of file it is and where the others stand.

    Returns the script, where the file is a stall that could be read.
    """
    kind = _kind(text)
    if kind == "person":
        _check(path, text, findings, lambda: load_person(path))
    elif kind == "faces":
        _check(path, text, findings, lambda: load_faces(path))
    elif kind == "locked":
        _check(path, text, findings, lambda: read_lock(path))
    elif kind == "acts":
        _check(path, text, findings, lambda: _all_temperaments(path))
    else:
        script = read_script(path, findings, text)
        if script is not None:
            check_quality(script, findings, purse)
        return script
    return None


def _check(path: Path, text: str, findings: Findings, read: Callable[[], object]) -> None:
    """A file that is read as a whole: its YAML first, then the first thing its reader refuses."""
    if Source(path, text, findings).root is None:
        return
    try:
        read()
    except BadInput as error:
        findings.take("E_BAD_VALUE", error)


def _all_temperaments(path: Path) -> None:
    root = load_yaml(path)
    for name in root["people"].as_mapping():
        acts_from(root, name)
