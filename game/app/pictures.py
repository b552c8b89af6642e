"""Writing pictures: a PNG whole or not at all, and a place that cannot be written to refused beforehand."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import numpy as np
import pygame
from numpy.typing import NDArray

from game.core.errors import BadInput, Where
from game.render.assets import save_png

__all__ = ["check_png", "write_png"]


def check_png(path: Path) -> None:
    """Refuse a place no picture can be written to, before anything is drawn. Raises BadInput."""
    if path.suffix.lower() != ".png":
        raise BadInput("--out", expected="a file name ending in .png", seen=str(path))
    if not path.resolve().parent.is_dir():
        raise BadInput("--out", expected="a folder that exists", seen=str(path.parent))


def write_png(path: Path, pixels: NDArray[np.uint8]) -> None:
    """Write (h, w, 3) uint8 as a PNG, whole or not at all. Raises BadInput where that is impossible."""
    check_png(path)
    folder = path.resolve().parent
    handle, name = tempfile.mkstemp(dir=folder, prefix=f".{path.stem}.", suffix=".png")
    os.close(handle)
    try:
        save_png(Path(name), pixels)
        os.chmod(name, 0o644)
        os.replace(name, path)
    except (OSError, pygame.error) as error:
        os.unlink(name)
        raise BadInput(where=Where(path), expected="a folder that can be written", seen=str(error)) from None
