"""The outside of a glTF file: GLB chunks or plain JSON, and the buffers it points to.

Nothing is read from outside the file's own folder: a URI must be relative, without "..", and must still lie
inside once links are resolved. Sizes are checked against what is there before anything is allocated.
"""

from __future__ import annotations

import base64
import binascii
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote, unquote_to_bytes

from game.core.errors import BadInput, Where
from game.formats.files import read_bytes
from game.formats.json_shape import parse_json

__all__ = ["Container", "read_container", "resolve_uri"]

_JSON_CHUNK = 0x4E4F534A
_BIN_CHUNK = 0x004E4942


@dataclass(frozen=True)
class Container:
    """The JSON document and, of a GLB, its binary chunk."""

    path: Path
    document: dict[str, Any]
    binary: memoryview | None
    is_glb: bool = False


def read_container(path: Path, *, max_bytes: int) -> Container:
    """Open a .gltf, .glb, .vrm or .vrma by its content. Raises BadInput with the byte offset of a broken chunk."""
    data = read_bytes(path, max_bytes=max_bytes, what="glTF file")
    if not data.startswith(b"glTF"):
        return Container(path, parse_json(data, path), None)
    if len(data) < 12:
        raise BadInput("a GLB header cut short", where=Where(path, byte=len(data)))
    version, declared = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise BadInput("GLB", where=Where(path, byte=4), expected="version 2", seen=version)
    if declared > len(data) or declared < 12:
        raise BadInput(
            "GLB length", where=Where(path, byte=8), expected=f"{len(data)} bytes, the file's size", seen=declared
        )
    document: dict[str, Any] | None = None
    binary: memoryview | None = None
    view, at, chunks = memoryview(data), 12, 0
    while at < declared:
        if at + 8 > declared:
            raise BadInput("a GLB chunk header cut short", where=Where(path, byte=at))
        length, kind = struct.unpack_from("<II", data, at)
        start = at + 8
        if length > declared - start:
            raise BadInput(
                "GLB chunk", where=Where(path, byte=at), expected=f"at most {declared - start} bytes", seen=length
            )
        if length % 4:
            raise BadInput("GLB chunk", where=Where(path, byte=at), expected="a length divisible by 4", seen=length)
        if chunks == 0 and kind != _JSON_CHUNK:
            raise BadInput("GLB", where=Where(path, byte=at), expected="a JSON chunk first", seen=f"0x{kind:08x}")
        if kind == _JSON_CHUNK:
            if document is not None:
                raise BadInput("a second JSON chunk", where=Where(path, byte=at))
            document = parse_json(data[start : start + length], path)
        elif kind == _BIN_CHUNK:
            if chunks != 1:
                raise BadInput("a BIN chunk that is not the second chunk", where=Where(path, byte=at))
            binary = view[start : start + length]
        at, chunks = start + length, chunks + 1
    if document is None:
        raise BadInput("GLB", where=Where(path, byte=12), expected="a JSON chunk", seen="the end of the file")
    return Container(path, document, binary, is_glb=True)


def resolve_uri(path: Path, uri: str, where: Where, *, max_bytes: int, what: str) -> bytes:
    """The bytes behind a URI of the file at path: a data URI or a file in the same folder (or below).

    Raises BadInput for anything else: other schemes, absolute paths, "..", links that lead outside, missing files.
    """
    if uri.startswith("data:"):
        head, comma, body = uri.partition(",")
        if not comma:
            raise BadInput(what, where=where, expected="a data URI with a comma", seen=uri[:40])
        if len(body) > max_bytes * 4 // 3 + 4:
            raise BadInput(what, where=where, expected=f"at most {max_bytes} bytes", seen=f"about {len(body) * 3 // 4}")
        if not head.endswith(";base64"):
            return unquote_to_bytes(body)
        try:
            return base64.b64decode(body, validate=True)
        except (binascii.Error, ValueError) as error:
            raise BadInput(f"{what}: bad base64: {error}", where=where) from None
    name = unquote(uri, errors="strict") if "%" in uri else uri
    parts = name.replace("\\", "/").split("/")
    if not name or ":" in name or "\0" in name or parts[0] == "" or ".." in parts:
        raise BadInput(what, where=where, expected="a relative path inside the file's folder", seen=uri[:80])
    folder = path.parent.resolve()
    try:
        target = (folder / name).resolve()
    except (OSError, RuntimeError):
        raise BadInput(f"{what}: cannot follow {uri[:80]!r}", where=where) from None
    if not target.is_relative_to(folder):
        raise BadInput(
            what, where=where, expected="a path inside the file's folder", seen=uri[:80], hint="a link leads out"
        )
    try:
        return read_bytes(target, max_bytes=max_bytes, what=what)
    except BadInput as error:
        raise BadInput(f"{what}: {error.message.partition(': ')[2] or error.message}", where=where) from None
