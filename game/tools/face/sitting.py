"""One person's sitting: which faces, in which order, the point being set, and what is written. No window in here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from hashlib import sha256

import numpy as np

from game.core import EMOTIONS, BadInput
from game.face import Face, Parts
from game.tools.face.ratings_file import Rating, RatingLog, check_rater

__all__ = ["Sitting", "single_part_faces", "whole_faces"]

NUDGE = 0.05
MAX_WHOLE = 2000


def single_part_faces(parts: Parts) -> list[Face]:
    """The standard face, and for every other part the standard face wearing it: 1 + Σ (n − 1) faces."""
    faces = [Face()]
    for region in parts.regions:
        faces += [replace(Face(), **{region.name: name}) for name in region.names[1:]]
    return faces


def whole_faces(parts: Parts, count: int, seed: int) -> list[Face]:
    """``count`` different faces of two or more parts, drawn with every part equally likely; one seed, one set."""
    if not 1 <= count <= MAX_WHOLE:
        raise BadInput("whole faces", expected=f"1 to {MAX_WHOLE}", seen=count)
    rng = np.random.default_rng([seed, 2])
    found: dict[Face, None] = {}
    possible = int(np.prod(parts.counts)) - 1 - sum(n - 1 for n in parts.counts)
    while len(found) < min(count, possible):
        numbers = [int(rng.integers(n)) for n in parts.counts]
        if sum(i > 0 for i in numbers) >= 2:
            found[parts.face(numbers)] = None
    return list(found)


class Sitting:
    """A rater's way through the faces that this rater has not yet rated.

    ``point``: what has been set for the face now shown, None before the first click. ``name``: one of the seven or "".
    """

    def __init__(self, log: RatingLog, faces: Sequence[Face | str], rater: str, seed: int) -> None:
        self.log = log
        self.rater = check_rater(rater)
        # Everybody gets an order of their own, and the same one again after a break.
        own = int.from_bytes(sha256(self.rater.encode()).digest()[:8], "big")
        order = np.random.default_rng([seed, own]).permutation(len(faces))
        rated = {r.face for r in log.ratings if r.rater == self.rater}
        self.total = len(faces)
        self._left = [faces[i] for i in order if faces[i] not in rated]
        self.point: tuple[float, float] | None = None
        self.name = ""
        self.message = ""

    @property
    def face(self) -> Face | str | None:
        """The face to rate now; None when all are done."""
        return self._left[0] if self._left else None

    @property
    def done(self) -> int:
        """How many of the faces are rated."""
        return self.total - len(self._left)

    def place(self, valence: float, arousal: float) -> None:
        """Set the point, forced into the square."""
        if self.face is not None:
            self.point = (float(np.clip(valence, -1.0, 1.0)), float(np.clip(arousal, -1.0, 1.0)))
            self.message = ""

    def nudge(self, right: int, up: int, fine: bool = False) -> None:
        """Move the point by steps; the first step starts at the middle."""
        v, a = self.point or (0.0, 0.0)
        step = NUDGE / 5.0 if fine else NUDGE
        self.place(v + right * step, a + up * step)

    def call(self, number: int) -> None:
        """Name the emotion, 0..6; the same again takes the name off."""
        if self.face is not None:
            name = EMOTIONS[number]
            self.name = "" if self.name == name else name

    def confirm(self, time: str) -> bool:
        """Write the rating and go on to the next face. False where no point has been set yet, or where it cannot be
        written; then face and point stay, and ``message`` says why."""
        if self.face is None or self.point is None:
            self.message = "Click where this face lies first." if self.face is not None else ""
            return False
        try:
            self.log.append(Rating(self.rater, self.face, *self.point, self.name, time))
        except BadInput as error:
            self.message = f"Not saved! {error}"
            return False
        self._left.pop(0)
        self.point, self.name, self.message = None, "", ""
        return True

    def undo(self) -> bool:
        """Take the last rating of this sitting back and show its face again with the point as it was."""
        rating = self.log.withdraw()
        if rating is None:
            self.message = "Nothing of this sitting to take back."
            return False
        self._left.insert(0, rating.face)
        self.point, self.name, self.message = (rating.valence, rating.arousal), rating.name, ""
        return True
