"""Other files that a stall takes its nodes, pools and variables from: bounded, inside its folder, never in circles."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from game.core.errors import BadInput
from game.formats.files import decode_utf8, read_bytes
from game.formats.yaml_source import Node
from game.story.findings import Findings
from game.story.grammar import PART
from game.story.source import Source

__all__ = ["included"]

MAX_FILES = 16
MAX_DEPTH = 4
_MAX_BYTES = 2_000_000


def included(path: Path, source: Source, head: Mapping[str, Node], findings: Findings) -> list[Mapping[str, Node]]:
    """The heads of all files that a stall includes, each once, in the order in which they are named.

    Names count from the stall's own folder, also within included files. ``source`` learns the texts of the files,
    so that places inside their scalars can be told.
    """
    gatherer = _Gatherer(path.parent, source, findings)
    gatherer.gather(head, (path,))
    return list(gatherer.heads.values())


class _Gatherer:
    def __init__(self, folder: Path, source: Source, findings: Findings) -> None:
        self.folder = folder
        self.source = source
        self.findings = findings
        self.heads: dict[Path, Mapping[str, Node]] = {}

    def gather(self, head: Mapping[str, Node], chain: tuple[Path, ...]) -> None:
        for node in self.source.items(head.get("include")):
            name = self.source.text(node)
            path = None if name is None else self._path(node, name)
            if path is None:
                continue
            around = [file.name for file in chain[next((i for i, f in enumerate(chain) if _same(f, path)), 99) :]]
            if around:
                self._refuse(node, f"a circle: {' -> '.join([*around, path.name])}")
            elif path in self.heads:
                continue
            elif len(self.heads) >= MAX_FILES or len(chain) > MAX_DEPTH:
                self._refuse(node, f"at most {MAX_FILES} files, {MAX_DEPTH} deep")
            else:
                self._take(node, path, chain)

    def _take(self, node: Node, path: Path, chain: tuple[Path, ...]) -> None:
        try:
            text = decode_utf8(read_bytes(path, max_bytes=_MAX_BYTES, what="YAML file"), path)
        except BadInput as error:
            self._refuse(node, error.message)
            return
        part = Source(path, text, self.findings, traps=self.source.traps)
        self.source.adopt(part)
        self.findings.files.add(path)
        self.heads[path] = {}
        if part.root is not None:
            self.heads[path] = part.mapping(part.root, PART)
            self.gather(self.heads[path], (*chain, path))

    def _path(self, node: Node, name: str) -> Path | None:
        """The file of that name, if it lies within the folder."""
        pure = PurePosixPath(name)
        if "\\" in name or ":" in name or pure.is_absolute() or ".." in pure.parts or pure.suffix != ".yaml":
            self._refuse(node, f"not a .yaml file within the folder: {name!r}", "like shared/weather.yaml")
            return None
        path = self.folder.joinpath(*pure.parts)
        if not path.is_file():
            known = [file.relative_to(self.folder).as_posix() for file in sorted(self.folder.glob("*/*.yaml"))[:500]]
            self._refuse(node, f"no file {name!r}", self.findings.hint(name, known))
            return None
        if not path.resolve().is_relative_to(self.folder.resolve()):
            self._refuse(node, f"{name!r} leads out of the folder")
            return None
        return path

    def _refuse(self, node: Node, message: str, hint: str | None = None) -> None:
        self.findings.add("E_INCLUDE", node.where, message, hint)


def _same(one: Path, other: Path) -> bool:
    return one == other or one.resolve() == other.resolve()
