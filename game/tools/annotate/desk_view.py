"""The desk's clock and its window on the time line: playing, stepping, loops; seconds to pixels and back."""

from __future__ import annotations

import math
from dataclasses import dataclass

__all__ = ["SPEEDS", "Clock", "TimeView"]

SPEEDS: tuple[float, ...] = (0.125, 0.25, 0.5, 1.0)
"""Slow motion down to an eighth."""
_LEAST_PX_S, _MOST_PX_S = 0.5, 3000.0
_TICKS_S = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0, 120.0, 300.0, 600.0)


@dataclass
class Clock:
    """Where the play head stands, seconds; all takes on the desk share it. loop: the span that is played over and
    over."""

    length_s: float
    fps: float
    time_s: float = 0.0
    playing: bool = False
    speed: float = 1.0
    loop: tuple[float, float] | None = None

    @property
    def frame(self) -> int:
        """The frame that is shown."""
        return round(self.time_s * self.fps)

    def go_to(self, time_s: float) -> None:
        """Put the play head somewhere; it stays within the motion."""
        self.time_s = min(max(time_s, 0.0), max(self.length_s - 1.0 / self.fps, 0.0))

    def step(self, frames: int) -> None:
        """Whole frames on or back; playing stops."""
        self.playing = False
        self.go_to((self.frame + frames) / self.fps)

    def toggle(self) -> None:
        """Play or pause; from the end it begins again."""
        self.playing = not self.playing
        last = self.length_s - 1.0 / self.fps
        if self.playing and self.time_s >= last - 1e-6:
            self.time_s = 0.0
        if self.playing and self.loop is not None and not self.loop[0] <= self.time_s < self.loop[1]:
            self.time_s = self.loop[0]

    def slower(self, steps: int) -> None:
        """Another of SPEEDS: positive is slower."""
        at = min(range(len(SPEEDS)), key=lambda i: abs(SPEEDS[i] - self.speed))
        self.speed = SPEEDS[min(max(at - steps, 0), len(SPEEDS) - 1)]

    def advance(self, elapsed_s: float) -> None:
        """Let real time pass."""
        if not self.playing:
            return
        time_s = self.time_s + elapsed_s * self.speed
        if self.loop is not None:
            start, end = self.loop
            if time_s >= end:
                time_s = start + math.fmod(time_s - end, max(end - start, 1e-3))
        elif time_s >= self.length_s - 1.0 / self.fps:
            self.playing = False
        self.go_to(time_s)


@dataclass
class TimeView:
    """Which stretch of the motion the time line shows. px_s: pixels a second; width: pixels."""

    length_s: float
    start_s: float = 0.0
    px_s: float = 0.0
    width: float = 800.0

    def resize(self, width: float) -> None:
        """The line has another width; the first time, everything is shown."""
        self.width = max(width, 1.0)
        if self.px_s <= 0.0:
            self.fit()
        self._settle()

    def fit(self, start_s: float = 0.0, end_s: float | None = None) -> None:
        """Show a stretch, or everything."""
        end = self.length_s if end_s is None else end_s
        self.px_s = min(max(self.width / max(end - start_s, 1e-3), _LEAST_PX_S), _MOST_PX_S)
        self.start_s = start_s
        self._settle()

    def x(self, time_s: float) -> float:
        """Pixels from the line's left edge."""
        return (time_s - self.start_s) * self.px_s

    def time(self, x: float) -> float:
        """Seconds at a pixel."""
        return self.start_s + x / self.px_s

    def zoom(self, factor: float, x: float) -> None:
        """Closer (factor > 1) or further, the moment under ``x`` stays where it is."""
        held = self.time(x)
        self.px_s = min(max(self.px_s * factor, _LEAST_PX_S), _MOST_PX_S)
        self.start_s = held - x / self.px_s
        self._settle()

    def pan(self, pixels: float) -> None:
        """Shift the stretch."""
        self.start_s += pixels / self.px_s
        self._settle()

    def follow(self, time_s: float) -> None:
        """See that a moment is in sight: turn a page where it is not."""
        if not 0.0 <= self.x(time_s) <= self.width:
            self.start_s = time_s - 0.1 * self.width / self.px_s
            self._settle()

    def ticks(self, least_px: float = 70.0) -> list[float]:
        """Round times for the ruler, at least so far apart."""
        step = next((t for t in _TICKS_S if t * self.px_s >= least_px), _TICKS_S[-1])
        first = math.floor(self.start_s / step)
        count = math.ceil(self.width / self.px_s / step) + 2
        return [(first + i) * step for i in range(count) if -1e-9 <= (first + i) * step <= self.length_s + 1e-9]

    def _settle(self) -> None:
        seen = self.width / self.px_s
        slack = 0.05 * seen if seen < self.length_s else 0.0
        self.start_s = min(max(self.start_s, -slack), max(self.length_s - seen, 0.0) + slack)
