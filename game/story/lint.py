"""All findings of dialogue files at once: stalls, shopkeepers, rules and faces."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from game.core.errors import BadInput, Where
from game.formats.files import decode_utf8, read_bytes
from game.formats.yaml_source import load_yaml
from game.story.acts import acts_from
from game.story.findings import Finding, Findings
from game.story.quality import check_quality
from game.story.reader import load_faces, load_person, read_script
from game.story.source import Source

__all__ = ["dialogue_files", "lint_files", "lint_text"]

_MAX_BYTES = 2_000_000


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


def lint_files(paths: Iterable[Path]) -> list[Finding]:
    """Findings of all dialogue files at and below some paths, by file and place."""
    findings = Findings()
    for path in dialogue_files(paths):
        try:
            text = decode_utf8(read_bytes(path, max_bytes=_MAX_BYTES, what="YAML file"), path)
        except BadInput as error:
            findings.take("E_YAML", error)
        else:
            lint_text(path, text, findings)
    return findings.ordered()


def lint_text(path: Path, text: str, findings: Findings) -> None:
    """Check one file's text; ``path`` tells which kind of file it is and where the others stand."""
    keys = {row.partition(":")[0] for row in text.split("\n") if row[:1].isalpha()}
    if "person" in keys and "nodes" not in keys:
        _check(path, text, findings, lambda: load_person(path))
    elif "faces" in keys and "nodes" not in keys:
        _check(path, text, findings, lambda: load_faces(path))
    elif "acts" in keys and "nodes" not in keys:
        _check(path, text, findings, lambda: _all_temperaments(path))
    else:
        script = read_script(path, findings, text)
        if script is not None:
            check_quality(script, findings)


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
