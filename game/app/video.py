"""Films: pictures one after the other into a file with PyAV (the extra ``video``), or into a folder of PNGs."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.app.pictures import write_png
from game.core.errors import BadInput, MissingPart, Where

__all__ = ["SUFFIXES", "check_film", "write_film"]

SUFFIXES = (".mp4", ".mkv", ".webm")
_CODECS = {".mp4": "libx264", ".mkv": "libx264", ".webm": "libvpx-vp9"}
_QUALITY = {"libx264": {"crf": "18", "preset": "medium"}, "libvpx-vp9": {"crf": "24", "b": "0"}}

Picture = NDArray[np.uint8]


def check_film(path: Path) -> None:
    """Refuse a place no film can go to, before anything is drawn. Raises BadInput, MissingPart without PyAV."""
    if path.suffix.lower() in SUFFIXES:
        if not path.resolve().parent.is_dir():
            raise BadInput("film", expected="a folder that exists", seen=str(path.parent))
        _av()
    elif path.suffix or (path.exists() and not path.is_dir()):
        raise BadInput("film", expected=f"a file ending in {' '.join(SUFFIXES)}, or a folder", seen=str(path))


def write_film(path: Path, pictures: Iterable[Picture], fps: int) -> int:
    """Write pictures (h, w, 3) uint8 of one size; returns how many. A film appears whole or not at all.

    Films need even sides: an odd last row or column is left out. Raises BadInput where it cannot be written.
    """
    check_film(path)
    if path.suffix.lower() not in SUFFIXES:
        path.mkdir(parents=True, exist_ok=True)
        count = 0
        for picture in pictures:
            write_png(path / f"{count:05d}.png", picture)
            count += 1
        return count
    folder = path.resolve().parent
    try:
        handle, name = tempfile.mkstemp(dir=folder, prefix=f".{path.stem}.", suffix=path.suffix.lower())
    except OSError as error:
        raise BadInput(where=Where(path), expected="a folder that can be written", seen=error.strerror) from None
    os.close(handle)
    av = _av()
    try:
        count = _encode(av, Path(name), pictures, fps, _CODECS[path.suffix.lower()])
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException as error:
        os.unlink(name)
        if isinstance(error, OSError):  # PyAV's errors are among these
            raise BadInput(where=Where(path), expected="a film that can be written", seen=str(error)) from None
        raise
    return count


def _encode(av: Any, path: Path, pictures: Iterable[Picture], fps: int, codec: str) -> int:
    count, stream = 0, None
    with av.open(str(path), "w") as container:
        for picture in pictures:
            height, width = (side // 2 * 2 for side in picture.shape[:2])
            if stream is None:
                stream = container.add_stream(codec, rate=Fraction(fps), options=_QUALITY[codec])
                stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
            frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture[:height, :width]), format="rgb24")
            container.mux(stream.encode(frame))
            count += 1
        if stream is not None:
            container.mux(stream.encode(None))
    return count


def _av() -> Any:
    try:
        import av
    except ImportError:
        raise MissingPart(
            "films need PyAV: pip install 'mental-communication-game[video]'; without it, name a folder for PNGs"
        ) from None
    return av
