"""The circumplex as a square: where a point lies on it, and how it is drawn with the game's own brush."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.app.ui import FEELING_COLOURS, INK, PALETTE, Canvas, Rect, fade
from game.core import EMOTIONS

__all__ = ["Pad", "ellipse"]

Floats = NDArray[np.float64]


def ellipse(mean: Floats, covariance: Floats, deviations: float = 1.0, corners: int = 40) -> Floats:
    """Points (corners + 1, 2) of the ellipse of so many standard deviations, closed."""
    values, vectors = np.linalg.eigh(covariance)
    angle = np.linspace(0.0, 2.0 * np.pi, corners + 1)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1) * np.sqrt(np.maximum(values, 0.0)) * deviations
    return np.asarray(mean + circle @ vectors.T)


@dataclass(frozen=True)
class Pad:
    """A square of side ``size`` with its left top corner at (x, y); valence to the right, arousal up, −1..1 each."""

    x: float
    y: float
    size: float

    @property
    def rect(self) -> Rect:
        return Rect(self.x, self.y, self.size, self.size)

    def to_screen(self, valence: float, arousal: float) -> tuple[float, float]:
        """Where a point lies."""
        half = self.size / 2.0
        return self.x + half * (1.0 + valence), self.y + half * (1.0 - arousal)

    def to_point(self, at: tuple[float, float]) -> tuple[float, float]:
        """The point under a place; beyond the edge, the nearest on it."""
        half = self.size / 2.0
        valence, arousal = (at[0] - self.x) / half - 1.0, 1.0 - (at[1] - self.y) / half
        return float(np.clip(valence, -1.0, 1.0)), float(np.clip(arousal, -1.0, 1.0))

    def draw(self, canvas: Canvas, places: Floats | None = None, text: float = 13.0) -> None:
        """Frame, circle, axes with their ends named; with ``places`` (7, 2) the seven emotions where they stand."""
        canvas.panel(self.rect, PALETTE["white"], radius=8, border=2)
        middle = self.to_screen(0.0, 0.0)
        circle = ellipse(np.zeros(2), np.eye(2), 0.985, 72)
        canvas.lines([self.to_screen(v, a) for v, a in circle], 1.2, fade(PALETTE["faint"], 0.45))
        for a, b in (((-1.0, 0.0), (1.0, 0.0)), ((0.0, -1.0), (0.0, 1.0))):
            canvas.lines([self.to_screen(*a), self.to_screen(*b)], 1.2, fade(PALETTE["faint"], 0.6))
        if self.size < 200:
            return
        soft = PALETTE["faint"]
        canvas.text(self.x + 7, middle[1] + 3, "unpleasant", text, soft)
        canvas.text(self.x + self.size - 7, middle[1] + 3, "pleasant", text, soft, align="right")
        canvas.text(middle[0] + 6, self.y + 4, "awake", text, soft)
        canvas.text(middle[0] + 6, self.y + self.size - text * 1.5 - 2, "sleepy", text, soft)
        if places is not None:
            for name, (valence, arousal) in zip(EMOTIONS, places, strict=True):
                self._place(canvas, name, valence, arousal, text)

    def _place(self, canvas: Canvas, name: str, valence: float, arousal: float, text: float) -> None:
        x, y = self.to_screen(valence, arousal)
        colour = FEELING_COLOURS[name]
        canvas.dot(x, y, text * 0.26, colour)
        # Fear and anger stand almost on one spot: names go outward to their own side.
        left = name == "fear"
        canvas.text(
            x + (-6 if left else 6), y - text * (0.75 if name != "disgust" else 0.3), name, text, colour,
            font="bold", align="right" if left else "left",
        )  # fmt: skip

    def outline(self, canvas: Canvas, mean: Floats, covariance: Floats, colour: tuple[float, float, float, float],
                width: float = 1.6) -> None:  # fmt: skip
        """A Gaussian's ellipse of one standard deviation, kept inside the square."""
        points = np.clip(ellipse(mean, covariance), -1.0, 1.0)
        canvas.lines([self.to_screen(v, a) for v, a in points], width, colour)

    def cross(self, canvas: Canvas, valence: float, arousal: float, radius: float = 8.0) -> None:
        """The point that is meant: a ring with a dot."""
        x, y = self.to_screen(valence, arousal)
        canvas.dot(x, y, radius, PALETTE["red"])
        canvas.dot(x, y, radius * 0.62, PALETTE["white"])
        canvas.dot(x, y, radius * 0.34, INK)
