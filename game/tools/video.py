"""Pictures into a film file with PyAV (the extra ``video``)."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput, MissingPart, Where

__all__ = ["SUFFIXES", "encode_film", "need_av"]

SUFFIXES = (".mp4", ".mkv", ".webm")
_CODECS = {".mp4": "libx264", ".mkv": "libx264", ".webm": "libvpx-vp9"}
_QUALITY = {"libx264": {"crf": "18", "preset": "medium"}, "libvpx-vp9": {"crf": "24", "b": "0"}}


def encode_film(path: Path, pictures: Iterable[NDArray[np.uint8]], fps: int) -> int:
    """Encode pictures (h, w, 3) uint8 of one size; returns how many. The film appears whole or not at all.

    Films need even sides: an odd last row or column is left out. Raises BadInput where it cannot be written.
    """
    av = need_av()
    kind = path.suffix.lower()
    try:
        handle, name = tempfile.mkstemp(dir=path.resolve().parent, prefix=f".{path.stem}.", suffix=kind)
    except OSError as error:
        raise BadInput(where=Where(path), expected="a folder that can be written", seen=error.strerror) from None
    os.close(handle)
    try:
        count = _encode(av, Path(name), pictures, fps, _CODECS[kind])
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException as error:
        os.unlink(name)
        if isinstance(error, OSError):  # PyAV's errors are among these
            raise BadInput(where=Where(path), expected="a film that can be written", seen=str(error)) from None
        raise
    return count


def _encode(av: Any, path: Path, pictures: Iterable[NDArray[np.uint8]], fps: int, codec: str) -> int:
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


def need_av() -> Any:
    """PyAV. Raises MissingPart with what to do."""
    try:
        import av
    except ImportError:
        raise MissingPart(
            "films need PyAV: pip install 'mental-communication-game[video]'; without it, name a folder for PNGs"
        ) from None
    return av
