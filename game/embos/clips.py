"""The takes' motion, packed: one file for all takes, read without pickle and checked before use."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput, Where
from game.core.humanoid import REFERENCE

__all__ = ["MAX_BYTES", "ClipBank", "KnownClips", "TakeClip", "load_clips", "pack_clips", "same_clips"]

MAX_BYTES = 256_000_000
"""No clips file may unpack to more."""

_SCALE = 32767.0
_JOINTS = len(REFERENCE)


@dataclass(frozen=True, eq=False)
class TakeClip:
    """One take on the reference skeleton: rotation (F, 41, 4) local quaternions, root (F, 3) metres of the hips."""

    rotation: NDArray[np.float32]
    root: NDArray[np.float32]
    frame_time_s: float

    def __post_init__(self) -> None:
        frames = len(self.rotation)
        if self.rotation.shape != (frames, _JOINTS, 4) or self.root.shape != (frames, 3) or frames < 1:
            raise BadInput(
                "take",
                expected=f"(F, {_JOINTS}, 4) rotations and (F, 3) root positions",
                seen=f"{self.rotation.shape} and {self.root.shape}",
            )
        if not (np.isfinite(self.rotation).all() and np.isfinite(self.root).all()):
            raise BadInput("take", expected="finite numbers", seen="NaN or infinity")
        if not 0.0 < self.frame_time_s < 10.0:
            raise BadInput("take", expected="a frame time above 0 s", seen=self.frame_time_s)
        self.rotation.setflags(write=False)
        self.root.setflags(write=False)

    @property
    def length_s(self) -> float:
        """Frames times frame time."""
        return len(self.rotation) * self.frame_time_s

    def frame(self, time_s: float) -> int:
        """The nearest frame, clamped to the take."""
        return min(max(round(time_s / self.frame_time_s), 0), len(self.rotation) - 1)


class ClipBank(Mapping[str, TakeClip]):
    """Take name -> TakeClip; immutable."""

    def __init__(self, takes: Mapping[str, TakeClip] | None = None) -> None:
        self._takes = dict(takes or {})

    def __getitem__(self, take: str) -> TakeClip:
        return self._takes[take]

    def __iter__(self) -> Any:
        return iter(self._takes)

    def __len__(self) -> int:
        return len(self._takes)


Mark = tuple[tuple[str, int, int, int], ...]


@dataclass
class KnownClips:
    """The takes of the last clips file that was read, by what tells their bytes apart."""

    takes: dict[Mark, TakeClip] = field(default_factory=dict)


def pack_clips(bank: Mapping[str, TakeClip]) -> bytes:
    """The bytes of a clips file, the same for the same takes on every run (no time stamps inside)."""
    arrays: dict[str, NDArray[Any]] = {}
    for name in sorted(bank):
        take = bank[name]
        arrays[f"{name}/rotation"] = np.round(take.rotation.astype(np.float64) * _SCALE).astype(np.int16)
        arrays[f"{name}/root"] = take.root.astype(np.float32)
        arrays[f"{name}/frame_time"] = np.array(take.frame_time_s)
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as archive:
        for name, array in arrays.items():
            member = io.BytesIO()
            np.lib.format.write_array(member, array, allow_pickle=False)
            entry = zipfile.ZipInfo(f"{name}.npy", date_time=(1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, member.getvalue())
    return buffer.getvalue()


def same_clips(path: Path, bank: Mapping[str, TakeClip], known: KnownClips | None = None) -> bool:
    """Whether a file holds these takes, to within one step of the packing (compressors and libm may differ)."""
    try:
        stored = load_clips(path, known)
    except BadInput:
        return False
    if sorted(stored) != sorted(bank):
        return False
    for name, take in bank.items():
        old = stored[name]
        if old.rotation.shape != take.rotation.shape or abs(old.frame_time_s - take.frame_time_s) > 1e-9:
            return False
        if np.abs(old.rotation - take.rotation).max() > 2.0 / _SCALE or np.abs(old.root - take.root).max() > 1e-5:
            return False
    return True


def load_clips(path: Path, known: KnownClips | None = None) -> ClipBank:
    """Read a clips file. Raises BadInput where it is missing, broken, too large or of another skeleton.

    ``known`` remembers the takes of the last reading: those whose bytes are the same are not unpacked again.
    """
    where = Where(path)
    old: dict[str, TakeClip] = {}
    try:
        with zipfile.ZipFile(path) as archive:
            entries = archive.infolist()
        unpacked = sum(entry.file_size for entry in entries)
        if unpacked > MAX_BYTES:
            raise BadInput("clips", where=where, expected=f"at most {MAX_BYTES} bytes", seen=unpacked)
        marks = _marks(entries)
        if known is not None:
            old = {name: known.takes[mark] for name, mark in marks.items() if mark in known.takes}
        with np.load(path, allow_pickle=False) as data:
            arrays = {name: data[name] for name in data.files if name.rpartition("/")[0] not in old}
    except BadInput:
        raise
    except FileNotFoundError:
        raise BadInput("clips", where=where, expected="a file", seen="nothing", hint="run_game.py analyse") from None
    except Exception as error:  # zipfile, zlib and numpy raise a dozen kinds for a broken archive
        raise BadInput("clips", where=where, expected="an .npz archive", seen=str(error)) from None
    takes: dict[str, TakeClip] = {}
    for name in sorted({key.rpartition("/")[0] for key in arrays}):
        try:
            rotation, root = arrays[f"{name}/rotation"], arrays[f"{name}/root"]
            frame_time = arrays[f"{name}/frame_time"]
        except KeyError as error:
            raise BadInput("clips", where=where, expected=f"{error.args[0]}", seen="nothing") from None
        if (
            rotation.dtype != np.int16
            or root.dtype != np.float32
            or frame_time.dtype.kind != "f"
            or frame_time.size != 1
        ):
            raise BadInput(
                "clips", where=Where(path, pointer=name), expected="int16 rotation, float32 root", seen=rotation.dtype
            )
        try:
            turn = rotation.astype(np.float32) / np.float32(_SCALE)
            if turn.ndim == 3 and turn.shape[-1] == 4:
                # Component by component: a sum over so short an axis takes eight times as long.
                x, y, z, w = (turn[..., axis] for axis in range(4))
                length = np.sqrt(x * x + y * y + z * z + w * w)[..., None]
                if turn.size and length.min() < 0.5:
                    raise BadInput("take", expected="unit quaternions", seen=float(length.min()))
                turn /= length
            takes[name] = TakeClip(turn, root, float(frame_time.reshape(())))
        except BadInput as error:
            raise BadInput(error.message, where=Where(path, pointer=name)) from None
    takes |= old
    if known is not None:
        known.takes = {marks[name]: take for name, take in takes.items()}
    return ClipBank({name: takes[name] for name in sorted(takes)})


def _marks(entries: list[zipfile.ZipInfo]) -> dict[str, Mark]:
    """Take name -> what tells its bytes from others: members, check sums, sizes packed and unpacked."""
    parts: dict[str, list[tuple[str, int, int, int]]] = {}
    for entry in entries:
        take, _, part = entry.filename.rpartition("/")
        parts.setdefault(take, []).append((part, entry.CRC, entry.compress_size, entry.file_size))
    return {take: tuple(sorted(own)) for take, own in parts.items()}
