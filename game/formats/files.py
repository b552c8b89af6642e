"""Bounded reading of files from outside: size checked before a byte is taken, one clear error for each fault."""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path

from game.core.errors import BadInput, Where

__all__ = ["decode_utf8", "read_bytes", "write_text"]


def read_bytes(path: Path | str, *, max_bytes: int, what: str = "file") -> bytes:
    """The bytes of a regular file of at most max_bytes. Raises BadInput (missing, a folder, a device, too big)."""
    path = Path(path)
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            # A pipe or device could block for ever or never end.
            raise BadInput(what, where=Where(path), expected="a regular file", seen=_kind(status.st_mode))
        if status.st_size > max_bytes:
            raise BadInput(what, where=Where(path), expected=f"at most {max_bytes} bytes", seen=status.st_size)
        with path.open("rb") as stream:
            data = stream.read(max_bytes + 1)
    except OSError as error:
        raise BadInput(f"cannot read this {what}: {error.strerror or error}", where=Where(path)) from None
    except ValueError:
        raise BadInput(f"cannot read this {what}: the path holds a NUL byte", where=Where(repr(str(path)))) from None
    if len(data) > max_bytes:
        raise BadInput(what, where=Where(path), expected=f"at most {max_bytes} bytes", seen="more")
    return data


def decode_utf8(data: bytes, path: Path | str) -> str:
    """UTF-8 text without its byte order mark. Raises BadInput with the byte offset of the first bad byte."""
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise BadInput(
            where=Where(path, byte=error.start), expected="UTF-8 text", seen=data[error.start : error.start + 4]
        ) from None
    return text.removeprefix("\ufeff")


def write_text(path: Path, text: str) -> None:
    """Write UTF-8 text so that the file appears whole or not at all. Raises BadInput where that is impossible."""
    temporary = ""
    try:
        handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as stream:
            stream.write(text)
        # mkstemp's 0600 would hide the file from everybody else.
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except OSError as error:
        if temporary:
            Path(temporary).unlink(missing_ok=True)
        raise BadInput(f"cannot write this file: {error.strerror or error}", where=Where(path)) from None


def _kind(mode: int) -> str:
    if stat.S_ISDIR(mode):
        return "a folder"
    return "a device or pipe"
