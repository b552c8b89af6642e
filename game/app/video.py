"""Films: pictures one after the other into a film file (the extra ``video``), or into a folder of PNGs."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.app.pictures import write_png
from game.core.errors import BadInput

__all__ = ["check_film", "is_film", "write_film"]


def is_film(path: Path) -> bool:
    """Whether a name is that of a film file, by its ending."""
    from game.tools.video import SUFFIXES

    return path.suffix.lower() in SUFFIXES


def check_film(path: Path) -> None:
    """Refuse a place no film can go to, before anything is drawn. Raises BadInput, MissingPart without PyAV."""
    from game.tools.video import SUFFIXES, need_av

    if is_film(path):
        if not path.resolve().parent.is_dir():
            raise BadInput("film", expected="a folder that exists", seen=str(path.parent))
        need_av()
    elif path.suffix or (path.exists() and not path.is_dir()):
        raise BadInput("--out", expected=f"a folder, or a film ending in {' '.join(SUFFIXES)}", seen=str(path))


def write_film(path: Path, pictures: Iterable[NDArray[np.uint8]], fps: int) -> int:
    """Write pictures (h, w, 3) uint8 of one size; returns how many. Raises BadInput where it cannot be written."""
    check_film(path)
    if is_film(path):
        from game.tools.video import encode_film

        return encode_film(path, pictures, fps)
    path.mkdir(parents=True, exist_ok=True)
    count = 0
    for picture in pictures:
        write_png(path / f"{count:05d}.png", picture)
        count += 1
    return count
