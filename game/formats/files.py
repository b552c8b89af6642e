"""Bounded reading of files from outside (size checked before a byte is taken), and writing that is whole or not at all;
one clear error for each fault."""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path

from game.core.errors import BadInput, Where

__all__ = ["check_regular", "check_replaceable", "decode_utf8", "read_bytes", "write_bytes", "write_text"]


def read_bytes(path: Path | str, *, max_bytes: int, what: str = "file") -> bytes:
    """The bytes of a regular file of at most max_bytes. Raises BadInput (missing, a folder, a device, too big)."""
    path = Path(path)
    size = check_regular(path, what)
    if size > max_bytes:
        raise BadInput(what, where=Where(path), expected=f"at most {max_bytes} bytes", seen=size)
    try:
        with path.open("rb") as stream:
            data = stream.read(max_bytes + 1)
    except OSError as error:
        raise BadInput(f"cannot read this {what}: {error.strerror or error}", where=Where(path)) from None
    if len(data) > max_bytes:
        raise BadInput(what, where=Where(path), expected=f"at most {max_bytes} bytes", seen="more")
    return data


def check_regular(path: Path, what: str = "file") -> int:
    """Size of a file that can be opened without waiting. Raises BadInput (missing, a folder, a device, a pipe)."""
    try:
        status = path.stat()
    except OSError as error:
        raise BadInput(f"cannot read this {what}: {error.strerror or error}", where=Where(path)) from None
    except ValueError:
        raise BadInput(f"cannot read this {what}: the path holds a NUL byte", where=Where(repr(str(path)))) from None
    if not stat.S_ISREG(status.st_mode):
        # A pipe or device could block for ever or never end.
        raise BadInput(what, where=Where(path), expected="a regular file", seen=_kind(status.st_mode))
    return status.st_size


def decode_utf8(data: bytes, path: Path | str) -> str:
    """UTF-8 text without its byte order mark. Raises BadInput with the byte offset of the first bad byte."""
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise BadInput(
            where=Where(path, byte=error.start), expected="UTF-8 text", seen=data[error.start : error.start + 4]
        ) from None
    return text.removeprefix("\ufeff")


def check_replaceable(path: Path) -> None:
    """Raises BadInput for a device or pipe: writing whole would put a file in its place (``/dev/stdout`` for root)."""
    if (path.exists() and not path.is_file() and not path.is_dir()) or str(path.absolute().parent) == "/dev":
        raise BadInput("cannot write this file", where=Where(path), expected="a regular file", seen="a device or pipe")


def write_text(path: Path, text: str, *, make_folder: bool = False, durable: bool = False) -> None:
    """write_bytes of UTF-8 text."""
    write_bytes(path, text.encode("utf-8"), make_folder=make_folder, durable=durable)


def write_bytes(
    path: Path, data: bytes, *, make_folder: bool = False, durable: bool = False, keep_rights: bool = False
) -> None:
    """Write so that the file appears whole or not at all; raises BadInput where that is impossible.

    make_folder: make the folders that are missing; durable: on the disk before the old file goes, so that a power cut
    leaves one of them; keep_rights: the file stands already, and stays as open as it was.
    """
    check_replaceable(path)
    temporary = ""
    try:
        if make_folder:
            path.parent.mkdir(parents=True, exist_ok=True)
        # mkstemp's 0600 would hide the file from everybody else.
        rights = stat.S_IMODE(path.stat().st_mode) if keep_rights else 0o644
        handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
            if durable:
                stream.flush()
                os.fsync(stream.fileno())
        os.chmod(temporary, rights)
        os.replace(temporary, path)
    except BaseException as error:
        if temporary:
            Path(temporary).unlink(missing_ok=True)
        if not isinstance(error, OSError):
            raise
        raise BadInput(f"cannot write this file: {error.strerror or error}", where=Where(path)) from None


def _kind(mode: int) -> str:
    if stat.S_ISDIR(mode):
        return "a folder"
    return "a device or pipe"
