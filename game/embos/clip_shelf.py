"""Motions of BVH files that are asked for again and again: each content is read once while a program runs."""

from __future__ import annotations

import hashlib
import threading
from pathlib import Path

from game.core.errors import BadInput
from game.embos.annotations import check_fps, reference_clip
from game.embos.clips import KnownClips, TakeClip
from game.formats.bvh import MAX_BYTES
from game.formats.files import read_bytes
from game.formats.yaml_source import Node

__all__ = ["ClipShelf"]


class ClipShelf:
    """Known by content, so that copies and renamed files are the same motion. Threads may share it.

    packed: the takes of the clips file that was looked at last.
    """

    def __init__(self) -> None:
        self.packed = KnownClips()
        self._clips: dict[bytes, TakeClip] = {}
        self._lock = threading.Lock()

    def clip(self, path: Path, fps: Node | None = None) -> TakeClip:
        """What game.embos.annotations.reference_clip gives. Raises BadInput."""
        try:
            content = read_bytes(path, max_bytes=MAX_BYTES, what="BVH file")
        except BadInput:
            return reference_clip(path, fps)  # which knows how to say it
        digest = hashlib.sha256(content).digest()
        with self._lock:
            clip = self._clips.get(digest)
            if clip is None:
                clip = self._clips[digest] = reference_clip(path)
        check_fps(path, clip.frame_time_s, fps)
        return clip

    def fill(self, paths: list[Path]) -> None:
        """Read motions before they are asked for; what is wrong with one is told to whoever asks."""
        for path in paths:
            try:
                self.clip(path)
            except BadInput:
                continue
