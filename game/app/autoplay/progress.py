"""How far a long run is: one line on the error stream, rewritten in place."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TextIO

__all__ = ["Progress"]

WIDTH = 30
EVERY_S = 0.2


class Progress:
    """A bar with rate and remaining time. Shown where it is asked for, or on a terminal."""

    def __init__(
        self,
        total: int,
        done: int = 0,
        *,
        what: str = "talks",
        show: bool | None = None,
        out: TextIO | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.out = sys.stderr if out is None else out
        self.total, self.done, self.what, self.clock = total, done, what, clock
        self.shown = self.out.isatty() if show is None else show
        self.begun_s, self.at_start = clock(), done
        self.last_s = -1e9
        self.drawn = False

    def add(self, talks: int) -> None:
        """So many more are done."""
        self.done += talks
        if self.shown and (self.clock() - self.last_s >= EVERY_S or self.done >= self.total):
            self.last_s = self.clock()
            self._draw("\r" + self.text())

    def text(self) -> str:
        """The line as it stands."""
        took = max(self.clock() - self.begun_s, 1e-9)
        rate = (self.done - self.at_start) / took
        left = "–" if rate <= 0 else _span((self.total - self.done) / rate)
        share = self.done / max(self.total, 1)
        full = round(share * WIDTH)
        bar = "█" * full + "·" * (WIDTH - full)
        return f"{bar} {share:4.0%}  {self.done:,}/{self.total:,} {self.what}  {rate:,.0f}/s  {left} left "

    def end(self) -> None:
        """Leave the line as it is."""
        if self.drawn:
            self._draw("\n")

    def _draw(self, text: str) -> None:
        self.drawn = True
        try:
            self.out.write(text)
        except UnicodeEncodeError:
            self.out.write(text.replace("█", "#").replace("·", ".").replace("–", "-"))
        self.out.flush()


def _span(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
