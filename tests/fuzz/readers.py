"""Every reader of files from outside, as a function of bytes: what it may raise is GameError, and nothing else."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

from game.app.bazaar import load_bazaar
from game.app.content import load_talk_assets, stall_path
from game.app.policies.scripted import load_moves
from game.app.recording import read_recording
from game.app.saves import load_game
from game.core.errors import GameError
from game.formats import load_map, load_yaml, read_bvh, read_gltf, read_vrm, read_vrma
from game.story.findings import Findings
from game.story.reader import read_script
from game.tools.annotate.elan import read_eaf
from game.tools.annotate.files import read_document
from game.tools.face.ratings_file import read_ratings

__all__ = ["READERS", "feed"]

BAZAAR = load_bazaar()
TALKS = {"flea": load_talk_assets(stall_path("flea"))}


def _script(path: Path) -> None:
    read_script(path, Findings())


READERS: dict[str, tuple[str, Callable[[Path], object]]] = {
    "yaml": (".yaml", load_yaml),
    "script": (".yaml", _script),
    "annotation": (".yaml", read_document),
    "map": (".yaml", load_map),
    "bvh": (".bvh", read_bvh),
    "gltf": (".glb", read_gltf),
    "vrm": (".vrm", read_vrm),
    "vrma": (".vrma", read_vrma),
    "save": (".json", lambda path: load_game(path, BAZAAR, TALKS)),
    "recording": (".jsonl", read_recording),
    "moves": (".yaml", load_moves),
    "ratings": (".csv", lambda path: read_ratings(path, ("smile", "frown"))),
    "eaf": (".eaf", read_eaf),
}
"""Name -> the ending its files have, and the reader."""


def feed(name: str, data: bytes, folder: Path) -> bool:
    """Let a reader read; whether it took it. Any error but a GameError, of one line, is a fault and gets through."""
    ending, read = READERS[name]
    path = folder / f"fuzz{ending}"
    path.write_bytes(data)
    try:
        read(path)
    except GameError as error:
        message = str(error)
        assert message
        assert "\n" not in message, message
        return False
    return True


def scratch() -> Path:
    """A folder in memory where there is one."""
    memory = Path("/dev/shm")
    return Path(tempfile.mkdtemp(dir=memory if memory.is_dir() else None))
