"""Where a run writes: looked at before hours are played, not after."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from game.core.errors import BadInput
from game.formats.files import check_replaceable

__all__ = ["check_places"]


def check_places(out: Path | None, record: Path | None, plots: Path | None, files: Sequence[Path | None]) -> None:
    """Raises BadInput for a file that is a folder, or a folder in which nothing can be written.

    The folders of recordings and plots are made where they are missing, those of files are not.
    """
    for path in (out, *files):
        if path is not None:
            check_replaceable(path)
            if path.is_dir():
                raise BadInput(f"cannot write {path}", expected="a file", seen="a folder")
            _check_folder(path, path.resolve().parent)
    for path in (record, plots):
        if path is not None:
            try:
                path.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise BadInput(f"cannot write into {path}: {error.strerror}") from None
            _check_folder(path, path)


def _check_folder(path: Path, folder: Path) -> None:
    if not folder.is_dir():
        raise BadInput(f"cannot write {path}", expected="a folder that exists", seen=str(folder))
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise BadInput(f"cannot write into {folder}: {error.strerror}") from None
